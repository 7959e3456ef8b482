"""Single teeth: every tooth of both gears is tried with every stretch of its contact.

A find is a constant more or less of material over a stretch of one tooth's contact, weighed by the tooth's share. Its
score comes from the whitened residual by bins; its information from the noise's memory and from what the tooth's own
pitch and slope would explain as well as the find (they are as-built and have their prior).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.compare.columns import tooth_numbers
from gearpoly.compare.families import SHARES, log_tail_square
from gearpoly.compare.noise import Noise
from gearpoly.compare.sharing import Carried
from gearpoly.units import FloatArray, IntArray

BEYOND_PATH_PITCHES = 0.1
"""Pitches that a contact may reach beyond the true path at either end (corner contact)."""

CELL_PITCHES = 1.0 / 16.0
"""Pitches per cell: twenty to thirty over a contact, finer than any bench samples a tooth."""

INFORMATION_SAMPLES = 131072
"""Samples from which information is taken (it depends on the sampling only); scores come from all."""

INFORMATION_KEPT_PART = 0.05
"""Part of a stretch's information that has to be left beside the tooth's pitch and slope; below, the two are one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Cells:
    """Cells of one gear in one recording: ``cell`` (P, n) index tooth * bins + bin, ``weight`` (P, n) the tooth's share
    (0 outside), ``edges`` (bins + 1,) in pitches from the pitch point."""

    gear: int
    z: int
    bins: int
    edges: FloatArray
    cell: IntArray
    weight: FloatArray

    def sums(self, values: FloatArray) -> FloatArray:
        """Sums (z, bins) of ``values`` (n,) by cell."""
        out: FloatArray = np.zeros(self.z * self.bins)
        for cell, weight in zip(self.cell, self.weight, strict=True):
            out += np.bincount(cell, weights=weight * values, minlength=out.size)
        return out.reshape(self.z, self.bins)

    def information(self, noise: Noise) -> FloatArray:
        """Normal matrices (z, bins, bins) of each tooth's cells in this noise."""
        n = self.cell.shape[1]
        part = min(n, INFORMATION_SAMPLES)
        taps = np.concatenate([[1.0], -noise.ar]) / noise.innovation
        memory = np.correlate(taps, taps, mode="full")[taps.size - 1 :]
        size = self.z * self.bins * self.bins
        out: FloatArray = np.zeros(size)
        live = [(c[:part], w[:part]) for c, w in zip(self.cell, self.weight, strict=True) if np.any(w[:part])]
        for lag, q in enumerate(memory):
            factor = q if lag == 0 else 0.5 * q
            for cell, weight in live:
                for other, other_weight in live:
                    a, b = cell[: part - lag], other[lag:part]
                    w = weight[: part - lag] * other_weight[lag:part]
                    same = (w != 0.0) & (a // self.bins == b // self.bins)
                    a, b, w = a[same], b[same], factor * w[same]
                    if a.size:
                        out += np.bincount(a * self.bins + b % self.bins, weights=w, minlength=size)
                        if lag:
                            out += np.bincount(b * self.bins + a % self.bins, weights=w, minlength=size)
        return np.asarray(out.reshape(self.z, self.bins, self.bins) * (n / part), dtype=np.float64)


def make_cells(
    carried: Carried, weight: FloatArray, *, gear: int, coast: bool, samples: int, contact: tuple[float, float]
) -> Cells:
    """Cells of ``gear`` with each pair's ``weight`` (P, n) in the transmission error, over the ``contact`` of all
    recordings that share them, as wide as the shortest of these needs, of so many ``samples``."""
    low, high = contact[0] - BEYOND_PATH_PITCHES, contact[1] + BEYOND_PATH_PITCHES
    z = carried.z_1 if gear == 1 else carried.z_2
    # At least eight samples to a cell, so that short records do not search cells that hold nothing.
    per_pitch = samples / z
    width = max(CELL_PITCHES, 8.0 / max(per_pitch, 1.0))
    bins = max(4, round((high - low) / width))
    edges = np.linspace(low, high, bins + 1)
    place = np.floor((carried.phase - low) / (high - low) * bins).astype(np.int64)
    inside = (place >= 0) & (place < bins)
    tooth = tooth_numbers(carried, gear=gear, coast=coast)
    return Cells(
        gear=gear,
        z=z,
        bins=bins,
        edges=edges,
        cell=tooth * bins + np.clip(place, 0, bins - 1),
        weight=np.where(inside, weight, 0.0) * (-1.0 if coast else 1.0),
    )


@dataclass(frozen=True, kw_only=True)
class ToothFind:
    """A stretch ``phase`` of one tooth that stands out: ``amplitude`` in mm of material, ``std``; ``gain`` its chi
    square; ``log_false`` log of the expected number of such finds in noise; ``recording`` or ``None`` for all alike;
    ``rival`` a tooth of the other gear that would explain nearly as much (gear, tooth)."""

    gear: int
    tooth: int
    phase: tuple[float, float]
    amplitude: float
    std: float
    gain: float
    log_false: float
    recording: int | None
    flank: str = "drive"
    rival: tuple[int, int] | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class ToothInformation:
    """Information of one gear's cells in every recording: ``raw`` per recording (z, bins, bins); ``own`` per recording
    (z, bins, 2) its product with the tooth's pitch and slope; ``inverse`` (z, 2, 2) of those two's own information,
    prior included, over all recordings."""

    raw: list[FloatArray]
    own: list[FloatArray]
    inverse: FloatArray


def tooth_information(cells: list[Cells], noises: list[Noise], *, precision: tuple[float, float]) -> ToothInformation:
    """Information of one gear in all recordings of one flank; prior ``precision`` of pitch and slope in 1/mm^2."""
    first = cells[0]
    middle = 0.5 * (first.edges[1:] + first.edges[:-1])
    along = np.clip((middle - middle[0]) / (middle[-1] - middle[0]), 0.0, 1.0) - 0.5
    shape = np.stack([np.ones(first.bins), along], axis=1)
    raw = [c.information(noise) for c, noise in zip(cells, noises, strict=True)]
    own = [g @ shape for g in raw]
    total = sum((np.einsum("bi,zbj->zij", shape, v) for v in own), np.zeros((first.z, 2, 2)))
    total = total + np.diag(np.maximum(precision, 1e-12))
    return ToothInformation(raw=raw, own=own, inverse=np.linalg.inv(total))


def _over_stretches(
    sums: FloatArray, raw: FloatArray, own: FloatArray, inverse: FloatArray, *, low: IntArray, high: IntArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of every tooth over stretches (w,) from edges ``low`` to ``high``: scores (z, w), their information, and what is
    left of that beside the tooth's own pitch and slope; ``sums`` (z, bins) of the scores, the rest as
    ``ToothInformation`` has it."""
    z, bins = sums.shape
    along = np.zeros((z, bins + 1))
    along[:, 1:] = np.cumsum(sums, axis=1)
    score = along[:, high] - along[:, low]
    square = np.zeros((z, bins + 1, bins + 1))
    square[:, 1:, 1:] = np.cumsum(np.cumsum(raw, axis=1), axis=2)
    whole = square[:, high, high] - square[:, low, high] - square[:, high, low] + square[:, low, low]
    edge = np.zeros((z, bins + 1, 2))
    edge[:, 1:] = np.cumsum(own, axis=1)
    v = edge[:, high] - edge[:, low]
    return score, whole, whole - np.einsum("zwi,zij,zwj->zw", v, inverse, v)


def scan_teeth(
    cells: list[Cells],
    scores: list[FloatArray],
    information: ToothInformation,
    *,
    tests_beside: int,
) -> list[ToothFind]:
    """Teeth of one gear that stand out, strongest first; ``scores`` (n,) of each recording, ``tests_beside`` teeth that
    are searched elsewhere."""
    first = cells[0]
    bins, z = first.bins, first.z
    sums = [c.sums(s) for c, s in zip(cells, scores, strict=True)]
    sets: list[tuple[int | None, FloatArray, FloatArray, FloatArray]] = [
        (k, sums[k], information.raw[k], information.own[k]) for k in range(len(cells))
    ]
    if len(cells) > 1:
        every = (
            None,
            np.sum(sums, axis=0),
            np.sum(information.raw, axis=0),
            np.sum(information.own, axis=0),
        )
        sets.append(every)
    low, high = np.triu_indices(bins + 1, k=1)
    # Beyond the path only corners of tips touch: what stands out there alone is how contacts move, no flank's shape.
    edges, width = first.edges, first.edges[1] - first.edges[0]
    on_path = np.minimum(edges[high], edges[-1] - BEYOND_PATH_PITCHES) - np.maximum(
        edges[low], edges[0] + BEYOND_PATH_PITCHES
    )
    low, high = low[on_path >= width], high[on_path >= width]
    tests = len(sets) * (z + tests_beside) * low.size
    out: list[ToothFind] = []
    for which, s, raw, own in sets:
        score, whole, left = _over_stretches(s, raw, own, information.inverse, low=low, high=high)
        good = left > INFORMATION_KEPT_PART * np.maximum(whole, 1e-300)
        chi2 = np.where(good, score**2 / np.where(good, left, 1.0), 0.0)
        best = np.argmax(chi2, axis=1)
        for tooth in range(z):
            w = int(best[tooth])
            gain = float(chi2[tooth, w])
            log_false = math.log(tests / SHARES.teeth) + float(log_tail_square(np.asarray(gain)))
            if log_false >= 0.0:
                continue
            out.append(
                ToothFind(
                    gear=first.gear,
                    tooth=tooth,
                    phase=(float(first.edges[low[w]]), float(first.edges[high[w]])),
                    amplitude=float(score[tooth, w] / left[tooth, w]),
                    std=float(1.0 / math.sqrt(left[tooth, w])),
                    gain=gain,
                    log_false=log_false,
                    recording=which,
                )
            )
    return sorted(out, key=lambda f: -f.gain)
