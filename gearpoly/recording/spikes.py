"""Single spikes: isolated samples far off their neighbours that come once and never again.

Derived here. A spike is one wrong sample. What is real in a gear pair lasts or repeats: steps, spalls and chipped
tips span several samples or return every turn of their shaft, and both are kept.
"""

from __future__ import annotations

import math

import numpy as np

from gearpoly.units import TURN, BoolArray, FloatArray, IntArray

SPIKE_SIGMAS = 12.0
"""Distance from the local median, in robust standard deviations of all such distances, from which a sample may be a
spike. Gaussian noise does not get there (10^-32), noise of heavy tails hardly.
"""

USUAL_SHARE, USUAL_TIMES = 0.95, 3.0
"""A spike is so many times as far off as all but one sample in twenty are. Where readings are rounded to an arcmin most
samples are equal, and the few that are a digit or two off are no spikes. In Gaussian noise it is half of the distance
above.
"""

QUIET_SHARE = 0.25
"""Largest spread of the two neighbours on each side, as a share of the distance: beside a step or in a dip of several
samples it is at least 1, at a peak of two slopes 2/3.
"""

LATE_STEPS = 1.5
"""Steps of an even motion beyond which a sample beside it is a spike: a reading that was published late repeats the one
before, one step off.
"""

PLACES_BESIDE_SPIKE: IntArray = np.array([-2, -1, 1, 2])
"""Places of the neighbours."""

REPEAT_SHARE = 1.0 / 3.0
"""A spike repeats in another turn where a sample at that place is off by this share of it, to the same side; and it is
real where it repeats in this share of the other turns.
"""

FEW_PEAKS = 0.05
"""Part of all samples up to which those above or below both neighbours are looked at by themselves: a sort of four
beside each takes ten times as long as exchanges along all of them.
"""

REPEAT_STEPS = 1.5
"""How far from the place, in usual sample steps, another turn's samples are looked at; sampling is not in step with the
shaft.
"""


def single_spikes(x: FloatArray, *shafts: FloatArray, moving: bool = False) -> BoolArray:
    """Which samples (m,) of ``x`` are single spikes; ``shafts`` are angles (m,) in rad on which real ones repeat. A
    ``moving`` x runs on as the angle of a shaft does."""
    spikes = np.zeros(x.size, dtype=np.bool_)
    if x.size < 7:
        return spikes
    if not _may_hold_spikes(x, moving=moving):
        return spikes
    lower, upper = _middle_beside(x)
    off = x - 0.5 * (lower + upper)
    size = np.abs(off)
    # Numbers of few digits may be equal in most samples, so the scale is never below the smallest step there is.
    finest = 16.0 * np.finfo(np.float64).eps * max(float(np.max(x)), -float(np.min(x)))
    smallest = float(np.min(size, where=size > finest, initial=math.inf))
    if smallest == math.inf:
        return spikes
    sigma = max(1.4826 * float(np.median(size)), smallest)
    usual = float(np.partition(size, k := int(USUAL_SHARE * (size.size - 1)))[k])
    found = np.flatnonzero(size > max(SPIKE_SIGMAS * sigma, USUAL_TIMES * usual))
    found = found[_are_quiet(_beside(x, found), size[found], moving=moving)]
    spikes[found] = True
    for shaft in shafts:
        spikes[found[_repeats(off, found, shaft)]] = False
    return spikes


def _may_hold_spikes(x: FloatArray, *, moving: bool) -> bool:
    """Whether any of the samples (m,) is as far off quiet neighbours as a spike, whatever its size.

    Such a sample is above all of its neighbours or below them. Where few samples are, as in an angle that runs on, they
    alone are looked at.
    """
    falls = x[1:] < x[:-1]
    peaks = np.concatenate([[0], np.flatnonzero(falls[1:] != falls[:-1]) + 1, [x.size - 1]])
    if peaks.size > FEW_PEAKS * x.size:
        return True
    beside = _beside(x, peaks)
    ordered = np.sort(beside, axis=1)
    return bool(np.any(_are_quiet(beside, np.abs(x[peaks] - 0.5 * (ordered[:, 1] + ordered[:, 2])), moving=moving)))


def _beside(x: FloatArray, at: IntArray) -> FloatArray:
    """The two samples before and the two after each of those ``at`` (k,), in their order (k, 4); mirrored at the
    ends."""
    numbers = np.abs(at[:, None] + PLACES_BESIDE_SPIKE)
    held: FloatArray = x[np.where(numbers < x.size, numbers, 2 * (x.size - 1) - numbers)]
    return held


def _are_quiet(beside: FloatArray, size: FloatArray, *, moving: bool) -> BoolArray:
    """Whether the four neighbours (k, 4) of each sample differ little beside its distance (k,) from them; where all are
    ``moving``, but for their even motion."""
    spread = np.ptp(beside, axis=1)
    quiet: BoolArray = spread < QUIET_SHARE * size
    if not moving:
        return quiet
    even = (beside[:, 3:] - beside[:, :1]) * (PLACES_BESIDE_SPIKE / 4.0)
    settled: BoolArray = (np.ptp(beside - even, axis=1) < QUIET_SHARE * size) & (size > LATE_STEPS * spread / 4.0)
    return quiet | settled


def _middle_beside(x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The middle two of the two samples before and the two after each of ``x`` (m,); by exchanges of two, since a sort
    of three million columns of four takes ten times as long."""
    padded = np.pad(x, 2, mode="reflect")
    a, b, c, d = padded[:-4], padded[1:-3], padded[3:-1], padded[4:]
    a, b = np.minimum(a, b), np.maximum(a, b)
    c, d = np.minimum(c, d), np.maximum(c, d)
    b, c = np.minimum(b, d), np.maximum(a, c)
    return np.minimum(b, c), np.maximum(b, c)


def _repeats(off: FloatArray, found: IntArray, shaft: FloatArray) -> BoolArray:
    """Which of the samples ``found`` return in other turns of the shaft."""
    repeats = np.zeros(found.size, dtype=np.bool_)
    if not found.size:
        return repeats
    reach = REPEAT_STEPS * float(np.median(np.abs(np.diff(shaft))))
    place = np.mod(shaft, TURN)
    order = np.argsort(place)
    sorted_place = place[order]
    for k, i in enumerate(found):
        beside = []
        for shift in (-TURN, 0.0, TURN):  # the window may lie across the end of the turn
            begin, end = np.searchsorted(sorted_place, [place[i] + shift - reach, place[i] + shift + reach])
            beside.append(order[begin:end])
        others = np.concatenate(beside)
        turn = np.rint((shaft[others] - shaft[i]) / TURN).astype(np.int64)
        others, turn = others[turn != 0], turn[turn != 0]
        same = off[others] * np.sign(off[i]) >= REPEAT_SHARE * abs(off[i])
        seen, returned = np.unique(turn).size, np.unique(turn[same]).size
        repeats[k] = returned >= max(1.0, REPEAT_SHARE * seen)
    return repeats
