"""Whole orders of the shafts that nothing explains, as large as the recordings have them.

Beside a wave that no gear makes, teeth as built take what part of it their grade allows, and a fit leaves the rest. Of
a resolver's 19.5 um of order 8, two graded gears of 19 and 37 teeth left 9.7 um, which is the size of nothing. So the
size is read off what recordings and declared simulation differ by, less what is claimed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.division import DIFFERS, beyond_all
from gearpoly.compare.entries import Entry
from gearpoly.compare.noise import Noise
from gearpoly.compare.sinusoids import cosine_and_sine
from gearpoly.compare.slow import slow_curves
from gearpoly.diagnose.fit import Fit
from gearpoly.units import UM, FloatArray

RECORDED_PART_OF_LEFT = 0.5
"""Part of what a fit leaves at an order that the recordings have there, below which the fit made it: teeth that took
one order leave its images at sums with and differences from the numbers of teeth. Of 15 um of order 8 of 19 teeth they
left 4.4 um of order 11, of which the recording had 0.3. Teeth hide more than half of another wave by chance only."""

CLOSE = 1.0
"""Independent lines below which two orders are too near each other for two sizes."""

SINGULAR = 1e-10
"""Part of the largest power below which a mixture of waves is nothing: a hundred thousandth of their size, where
doubles hold products of columns to 1e-13."""


def as_recorded(search: Fit, comparison: Comparison, entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """The ``entries``, those at whole orders of a shaft with the size and phase that the recordings have there, less
    what claims make of it, where that differs from what the teeth as built leave; without those that the fit made."""
    whole = [one.residual for one in comparison.aligned]
    entries = [one for one in entries if not beyond_all(one, whole)]
    if not any(map(_whole_order, entries)):
        return tuple(entries)
    z = search.model.scope.gears[0].z, search.model.scope.gears[1].z
    beside = [_frequency(one, z) for one in comparison.located.where if _whole_order(one)]
    every = list(dict.fromkeys([*(_frequency(one, z) for one in entries if _whole_order(one)), *beside]))
    sums = [_sums(search, k, rest, every) for k, rest in enumerate(_less_claims(search, comparison))]
    out = []
    for entry in entries:
        if not _whole_order(entry):
            out.append(entry)
            continue
        sizes = {k: sums[k].wave([_frequency(entry, z), *beside]) for k in entry.recordings}
        out += _as_large(entry, sizes)
    return tuple(out)


def _whole_order(entry: Entry) -> bool:
    return entry.kind == "shaft_order" and entry.order_std is None and entry.amplitude_um is not None


def _frequency(entry: Entry, z: tuple[int, int]) -> float:
    """Cycles per mesh."""
    return (entry.order or 0.0) / z[1 if entry.gear == "driven" else 0]


def _less_claims(search: Fit, comparison: Comparison) -> list[FloatArray]:
    """What recordings and declared simulation differ by, less what the claims change (n_k,), in mm."""
    out = [one.residual.copy() for one in comparison.aligned]
    for claim in search.model.claims:
        for rest, changed in zip(out, search.model.change(search.scenes, claim, claim.values, but=claim), strict=True):
            rest -= changed
    return out


@dataclass(frozen=True, kw_only=True, eq=False)
class _Sums:
    """Sums over a recording of ``span`` meshes: products (q, q) of waves of the ``frequencies`` in cycles per mesh,
    cosine and sine of each, and of a slow curve, ``square``, and theirs (q,) with what is to be told, ``score``."""

    frequencies: list[float]
    span: float
    square: FloatArray
    score: FloatArray
    noise: Noise

    def wave(self, frequencies: Sequence[float]) -> tuple[float, float, float]:
        """Size in mm, its standard error and phase in rad of the first of these waves, fitted beside the others and
        the slow curve."""
        taken: list[float] = []
        for frequency in frequencies:
            if all(abs(frequency - one) * self.span >= CLOSE for one in taken):
                taken.append(frequency)
        at = [2 * self.frequencies.index(one) + part for one in taken for part in (0, 1)]
        at += range(2 * len(self.frequencies), self.score.size)
        inverse = np.linalg.pinv(self.square[np.ix_(at, at)], rcond=SINGULAR, hermitian=True)[:2]
        heights = inverse @ self.score[at]
        level = float(np.interp(frequencies[0], self.noise.frequency, self.noise.density))
        size = float(np.hypot(*heights))
        # A wave that hardly comes round is known as well as it is told from the slow curve beside it.
        along = heights / size if size > 0.0 else np.full(2, math.sqrt(0.5))
        return size, math.sqrt(level * float(along @ inverse[:, :2] @ along)), math.atan2(heights[1], heights[0])


def _sums(search: Fit, k: int, values: FloatArray, frequencies: list[float]) -> _Sums:
    """The sums over recording ``k`` for what it holds of waves, ``values`` (n,) in mm."""
    u = search.scenes[k].samples.theta_2 / search.model.scope.gears[1].tau
    columns = np.concatenate([cosine_and_sine(u, np.array(frequencies)), slow_curves(u)], axis=1)
    return _Sums(
        frequencies=frequencies, span=float(np.ptp(u)), square=columns.T @ columns, score=columns.T @ values,
        noise=search.noises[k],
    )  # fmt: skip


def _as_large(entry: Entry, sizes: dict[int, tuple[float, float, float]]) -> tuple[Entry, ...]:
    """The entry with its size where it stands out most, if that differs from the one it has; none where the recordings
    have hardly anything there."""
    size, std, phase = max(sizes.values(), key=lambda one: one[0] / one[1])
    before = entry.amplitude_um or 0.0
    if abs(size / UM - before) < DIFFERS * (entry.std_um or 0.0):
        return (entry,)
    if size / UM < RECORDED_PART_OF_LEFT * before:
        return ()
    each = tuple(sizes[k][0] / UM for k in sorted(sizes)) if len(sizes) > 1 else None
    like = replace(entry, amplitude_um=size / UM, std_um=std / UM, phase_deg=math.degrees(phase))
    return (replace(like, amplitude_um_by_recording=each),)
