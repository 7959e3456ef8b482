"""Whole orders of the shafts that nothing explains, as large as the recordings have them.

Beside a wave that no gear makes, teeth as built take what part of it their grade allows, and a fit leaves the rest. Of
a resolver's 19.5 um of order 8, two graded gears of 19 and 37 teeth left 9.7 um, which is the size of nothing. So the
size is read off what recordings and declared simulation differ by, less what is claimed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.division import DIFFERS, beyond_all
from gearpoly.compare.entries import Entry
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


def as_recorded(search: Fit, comparison: Comparison, entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """The ``entries``, those at whole orders of a shaft with the size and phase that the recordings have there, less
    what claims make of it, where that differs from what the teeth as built leave; without those that the fit made."""
    whole = [one.residual for one in comparison.aligned]
    entries = [one for one in entries if not beyond_all(one, whole)]
    if not any(map(_whole_order, entries)):
        return tuple(entries)
    z = search.model.scope.gears[0].z, search.model.scope.gears[1].z
    beside = [_frequency(one, z) for one in comparison.located.where if _whole_order(one)]
    less_claims = _less_claims(search, comparison)
    out = []
    for entry in entries:
        if not _whole_order(entry):
            out.append(entry)
            continue
        sizes = {k: _wave(search, k, less_claims[k], [_frequency(entry, z), *beside]) for k in entry.recordings}
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


def _wave(search: Fit, k: int, values: FloatArray, frequencies: Sequence[float]) -> tuple[float, float, float]:
    """Size in mm, its standard error and phase in rad of the first of these waves in ``values`` (n,) of recording
    ``k``, fitted beside the others and a slow curve."""
    u = search.scenes[k].samples.theta_2 / search.model.scope.gears[1].tau
    span = float(np.ptp(u))
    taken: list[float] = []
    for frequency in frequencies:
        if all(abs(frequency - one) * span >= CLOSE for one in taken):
            taken.append(frequency)
    columns = np.concatenate([cosine_and_sine(u, np.array(taken)), slow_curves(u)], axis=1)
    heights = np.linalg.lstsq(columns, values, rcond=None)[0][:2]
    noise = search.noises[k]
    level = float(np.interp(frequencies[0], noise.frequency, noise.density))
    # A wave that hardly comes round is known as well as it is told from the slow curve beside it.
    root = np.linalg.pinv(columns)[:2]
    size = float(np.hypot(*heights))
    along = heights / size if size > 0.0 else np.full(2, math.sqrt(0.5))
    return size, math.sqrt(level) * float(np.linalg.norm(along @ root)), math.atan2(heights[1], heights[0])


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
