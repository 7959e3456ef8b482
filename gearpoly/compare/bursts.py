"""Bursts: a knock, or anything else that shakes a recording for a while and never again."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.entries import Entry
from gearpoly.compare.noise import Noise
from gearpoly.compare.set_up import AlignedResidual
from gearpoly.infer.chance import log_tail
from gearpoly.units import UM, FloatArray

SHORTEST_BURST, LONGEST_BURST = 32, 16
"""Samples of the shortest stretch that is looked at, and the part of a recording of the longest: what shakes longer is
noise of this recording."""

STARTS_PER_LENGTH = 4
"""Places within its length at which a stretch begins."""

LOUDER, OUTSTANDING = 1.3, 8.0
"""Mean square of a burst over that of the median stretch, and how far it stands out of all stretches of its length, in
their own spread: noise that wanders has many such stretches, a burst is one of few."""

MEDIAN_OF_SQUARE = 0.455
"""Median of the square of a standard normal number."""

MOST_BURSTS = 3
"""Bursts of a recording beyond which its noise wanders, and none is told."""

BURST_LOG_FALSE = math.log(1e-6)
"""Log of the expected number of as loud stretches in a recording of noise, at most: tails of real noise are heavier
than those of normal numbers, and of 53 healthy recordings of a bench three had a stretch of one in 1e5 to 1e12 that
corners make as teeth meet."""

BURST_SIGMAS = 3.0
"""Standard errors that a burst's amplitude has to be: where noise is coloured, stretches are loud once white whose own
mean square is no more than usual."""

TONE = 8.0
"""Power of the strongest line of a burst over the mean of all its lines from which it rings at that frequency: of 200
lines of noise one in 15 bursts has such a one."""


MEETING = 2.0
"""Meshes for which two teeth are in contact at most: the contact ratio of involute spur gears is below two. Of teeth
with forms of their own, each fitted with its mean over all mates, 2 to 4 um were left of single pairs of teeth."""


@dataclass(frozen=True, kw_only=True)
class _Stretch:
    """Samples ``first`` to ``last`` (not included) with the log of the expected number of as loud ones in noise."""

    first: int
    last: int
    log_false: float


def burst_entries(k: int, data: AlignedResidual, left: FloatArray, noise: Noise, *, period: float) -> list[Entry]:
    """The bursts of recording ``k``, of which the fit leaves ``left`` (n,) in mm, loudest first; ``period`` of the
    hunting cycle in meshes: what comes again with it is the gears'."""
    white = noise.whitened(left)
    square = white**2
    free = np.ones(white.size, dtype=np.bool_)
    found: list[_Stretch] = []
    while (one := _loudest(square, free)) is not None:
        around = (one.last - one.first) // 2
        free[max(0, one.first - around) : one.last + around] = False
        if _comes_again(data.u, square, one, period=period):
            continue
        if len(found) == MOST_BURSTS:
            return []
        found.append(one)
    entries = [
        replace(_entry(k, data, left, white, noise, one), rivals=_meeting(data.u, one, period=period)) for one in found
    ]
    return [e for e in entries if (e.amplitude_um or 0.0) > BURST_SIGMAS * (e.std_um or 0.0)]


def _loudest(square: FloatArray, free: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> _Stretch | None:
    """The stretch of ``free`` samples that chance makes least likely, if it is hardly chance."""
    sums = np.concatenate(([0.0], np.cumsum(np.where(free, square, 0.0))))
    kept = np.concatenate(([0], np.cumsum(free)))
    lengths = [SHORTEST_BURST * 2**i for i in range(64) if SHORTEST_BURST * 2**i <= square.size // LONGEST_BURST]
    best: _Stretch | None = None
    tests = sum(STARTS_PER_LENGTH * square.size / length for length in lengths)
    for length in lengths:
        starts = np.arange(0, square.size - length + 1, length // STARTS_PER_LENGTH)
        starts = starts[kept[starts + length] - kept[starts] == length]
        if starts.size < LONGEST_BURST:
            continue
        loud = (sums[starts + length] - sums[starts]) / length
        middle = float(np.median(loud))
        spread = 1.4826 * float(np.median(np.abs(loud - middle)))
        at = int(np.argmax(loud))
        if loud[at] < LOUDER * middle or loud[at] - middle < OUTSTANDING * spread:
            continue
        log_false = math.log(tests) + log_tail(length * loud[at] / max(1.0, middle), length)
        if log_false < BURST_LOG_FALSE and (best is None or log_false < best.log_false):
            best = _Stretch(first=int(starts[at]), last=int(starts[at]) + length, log_false=log_false)
    return best


def _comes_again(u: FloatArray, square: FloatArray, one: _Stretch, *, period: float) -> bool:
    """Whether a recording with samples at ``u`` (n,) meshes, of white ``square`` (n,), is loud at the same place of the
    hunting cycle before or after too; ``period`` in meshes."""
    usual = float(np.median(square)) / MEDIAN_OF_SQUARE
    for later in (period, -period):
        first, last = np.searchsorted(u, (u[one.first] + later, u[one.last - 1] + later))
        if last - first > SHORTEST_BURST // 2 and float(np.mean(square[first:last])) > LOUDER * usual:
            return True
    return False


def _meeting(u: FloatArray, one: _Stretch, *, period: float) -> tuple[str, ...]:
    """A word of two teeth that meet in a stretch, if it is as short as their contact and a recording with samples at
    ``u`` (n,) meshes has no other meeting of them, a ``period`` of meshes before or after."""
    begin, end = float(u[one.first]), float(u[one.last - 1])
    once = begin - period < u[0] and end + period > u[-1]
    return ("the two teeth that meet there, once in this recording",) if once and end - begin < MEETING else ()


def _entry(k: int, data: AlignedResidual, left: FloatArray, white: FloatArray, noise: Noise, one: _Stretch) -> Entry:
    """The stretch as an entry, its size beyond the noise as that of a steady wave of the same power."""
    here = slice(one.first, one.last)
    beyond = max(float(np.mean(left[here] ** 2)) - noise.level**2, 0.0)
    length = one.last - one.first
    turns = (data.theta_1 - data.theta_1[0]) / (2.0 * math.pi)
    during = turns if data.time_s is None else data.time_s
    ends = float(during[here][0]), float(during[here][-1])
    amplitude = math.sqrt(2.0 * beyond)
    return Entry(
        kind="time",
        p_value=math.exp(min(0.0, one.log_false)),
        recordings=(k,),
        hz=None if data.time_s is None else _tone(white[here], ends[1] - ends[0]),
        amplitude_um=amplitude / UM,
        std_um=(beyond + noise.level**2) / max(amplitude, noise.level) * math.sqrt(2.0 / length) / UM,
        rms_um=math.sqrt(beyond) / UM,
        during_s=None if data.time_s is None else ends,
        during_turns=ends if data.time_s is None else None,
        label="burst",
        gain=float(np.sum(white[here] ** 2)) - length,
    )


def _tone(white: FloatArray, seconds: float) -> float | None:
    """Frequency in Hz at which a burst rings, to a line of its length; None where no line stands out."""
    power = np.abs(np.fft.rfft(white * np.hanning(white.size)))[1:] ** 2
    line = int(np.argmax(power))
    return (line + 1) / seconds if power[line] > TONE * float(np.mean(power)) else None
