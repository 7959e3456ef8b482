"""Encoder readings made continuous: wraps taken out in either direction, across drop-outs by time and by the ratio.

Derived here. Between neighbouring samples a shaft moves less than half a turn, so a larger step is a wrap. Across a gap
it may have made several turns: their number is predicted from the usual speed, and where both shafts are read the pair
of numbers is taken that fits the tooth ratio.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.units import TURN, BoolArray, FloatArray, IntArray

WRAPPED_SPAN = 1.01
"""Span of all but the outermost readings, in turns, up to which a channel counts as wrapped at one turn; the excess
leaves room for noise.
"""

GAP_STEPS = 3.0
"""A step of more than so many usual time steps is a gap, as a drop-out is."""

GAP_TURNS = 0.4
"""Gaps in which a shaft is expected to turn further than this, in turns, are settled by both shafts together. A smaller
gap is safe for each alone: its prediction would have to be off by more than its own length.
"""

SPEED_DOUBT = 0.1
"""How far the mean speed in a gap may lie off the usual one, as a share; it bounds the numbers of turns tried."""

TRIED_MOST = 1000.0
"""Numbers of turns that are tried at most to either side of the predicted one: of so many six fit the ratio by chance
(2 SAME_FIT out of a turn), and a clock that was set may state a gap of years.
"""

SAME_FIT = 0.02
"""Fits to the ratio in rad within which the number of turns nearest the prediction is taken. Transmission errors and
encoder errors stay below, other numbers of turns are off by a tooth of the driven gear or more.
"""


STEPS_FOR_USUAL_STEP = 100_000
"""Steps from which the usual one is told: a median of so many is off by a third of a hundredth of their spread
(sqrt(pi / 2 n)), and it is needed to half a turn."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Continuous:
    """A continuous angle (m,) in rad, the wraps undone forward and backward, and the ordinary steps (m-1,)."""

    angle: FloatArray
    wraps: IntArray
    ordinary: BoolArray
    wrapped: bool
    expected: FloatArray


def continuous(reading: FloatArray, position: FloatArray, sample: IntArray) -> Continuous:
    """Undo the wraps of one encoder.

    ``reading`` (m,) in rad without drop-outs, ``position`` (m,) the time in s (or the sample's number), rising,
    ``sample`` (m,) the number of each sample in the recording, rising or falling, so that drop-outs show as gaps.
    """
    step, pause = np.diff(reading), np.diff(position)
    usual = float(np.median(thinned(pause)))
    ordinary = ~gaps(pause, usual)
    if abs(int(sample[-1]) - int(sample[0])) >= sample.size:  # none is left out elsewhere
        ordinary &= np.abs(np.diff(sample)) == 1
    if not ordinary.any():
        ordinary = np.ones(step.size, dtype=np.bool_)
    whole = bool(ordinary.all())
    usually = thinned(step if whole else step[ordinary]), thinned(pause if whole else pause[ordinary])
    expected = _speed(*usually) * pause
    slow = np.flatnonzero(ordinary & (pause > GAP_STEPS * usual))
    if slow.size:  # the shaft was slower there: it went on as by the steps beside, not at its usual speed
        beside = np.clip(slow + np.array([[-1], [1]]), 0, step.size - 1)
        expected[slow] = np.median(without_turns(step[beside]), axis=0)
    off = np.subtract(expected, step, out=step)
    low, high = np.quantile(thinned(reading), [0.005, 0.995])
    wrapped = bool(high - low <= WRAPPED_SPAN * TURN)
    far = np.flatnonzero((off > 0.5 * TURN) | (off < -0.5 * TURN))
    # A reading that is not wrapped tells the way across a gap by itself.
    far = far if wrapped else far[ordinary[far]]
    turns = np.zeros(step.size, dtype=np.int64)
    turns[far] = np.clip(np.rint(off[far] / TURN), -(2.0**53), 2.0**53)  # a clock that was set may state any gap
    angle = reading
    if far.size:
        angle = reading.copy()
        angle[far[0] + 1 :] += np.repeat(TURN * np.cumsum(turns[far]), np.diff(far, append=step.size))
    return Continuous(angle=angle, wraps=turns, ordinary=ordinary, wrapped=wrapped, expected=expected)


def gaps(pause: FloatArray, usual: float) -> BoolArray:
    """Which steps (m,) of a time are gaps: more than ``GAP_STEPS`` of the ``usual`` one, unless the steps beside lead
    up to them by less than as much from one to the next. Pulses of a shaft that runs up come so, and none is
    missing."""
    wide = np.asarray(pause > GAP_STEPS * usual)
    if not wide.any() or wide.all():
        return wide
    large, small = np.maximum(pause[1:], pause[:-1]), np.minimum(pause[1:], pause[:-1])
    broken = np.concatenate([[0], np.cumsum(large > GAP_STEPS * small)])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], wide.astype(np.int8), [0]])))
    begin, end = edges[::2], edges[1::2]
    smooth = broken[np.minimum(end, pause.size - 1)] == broken[np.maximum(begin - 1, 0)]
    for first, last in zip(begin[smooth].tolist(), end[smooth].tolist(), strict=True):
        wide[first:last] = False
    return wide


def only_goes_on(angle: FloatArray) -> bool:
    """Whether an ``angle`` (n,) only rises or only falls: it was never wrapped, and may go on by more than half a turn
    from one reading to the next."""
    steps = np.diff(angle)
    return bool(np.all(steps >= 0.0) or np.all(steps <= 0.0))


def thinned(values: FloatArray) -> FloatArray:
    """Every so-many-th of values (n,), ``STEPS_FOR_USUAL_STEP`` of them or a few more: as many as a usual one is told
    from."""
    return values[:: max(1, values.size // STEPS_FOR_USUAL_STEP)]


def _speed(step: FloatArray, pause: FloatArray) -> float:
    """The usual speed in rad per unit of position; of the travel, not of the time, so that standing still is not it."""
    least = without_turns(step)
    speed = np.divide(least, pause, out=np.zeros_like(least), where=pause > 0.0)
    return weighted_median(speed, np.abs(least))


def without_turns(step: FloatArray) -> FloatArray:
    """Steps (k,) in rad less the whole turns in them: half a turn at most, either way."""
    return step - TURN * np.rint(step / TURN)


def weighted_median(values: FloatArray, weights: FloatArray) -> float:
    """The value below which half of the weight lies; 0 without weight."""
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    if not total.size or total[-1] <= 0.0:
        return 0.0
    return float(values[order[np.searchsorted(total, 0.5 * total[-1])]])


def settle_gaps(first: Continuous, second: Continuous, ratio: float) -> tuple[FloatArray, FloatArray, int]:
    """Both angles (m,) with the turns in long gaps chosen to fit ``ratio``, and in how many gaps that changed them."""
    doubtful = first.wrapped | second.wrapped
    long = (np.abs(first.expected) > GAP_TURNS * TURN) | (np.abs(second.expected) > GAP_TURNS * TURN)
    gaps = np.flatnonzero(~first.ordinary & long) if doubtful else np.empty(0, dtype=np.int64)
    more = np.zeros((2, first.angle.size))
    moved = 0
    step_1, step_2 = np.diff(first.angle), np.diff(second.angle)
    for gap in gaps:
        doubt = np.fmin(SPEED_DOUBT * np.abs(first.expected[gap]) / TURN, TRIED_MOST)
        reach = math.ceil(doubt) + 1 if first.wrapped else 0
        tried = np.arange(-reach, reach + 1)
        beyond = step_2[gap] - ratio * (step_1[gap] + TURN * tried)
        back = -np.rint(beyond / TURN) if second.wrapped else np.zeros(tried.size)
        off = np.abs(beyond + TURN * back)
        near = np.flatnonzero(off <= off.min() + SAME_FIT)
        best = near[np.argmin(np.abs(tried[near]))]
        more[0, gap + 1], more[1, gap + 1] = tried[best], back[best]
        moved += bool(tried[best] or back[best])
    turns = TURN * np.cumsum(more, axis=1)
    return first.angle + turns[0], second.angle + turns[1], moved
