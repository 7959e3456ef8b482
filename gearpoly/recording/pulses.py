"""Edges and counts in the channels of an encoder: levels, hysteresis, quadrature, single pulses, counters.

Derived here, except the quadrature cycle, which is common practice: A leads B (00, 10, 11, 01) when the encoder counts
up. Nothing here knows files; ``raw`` puts the pieces together and reports.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearpoly.units import BoolArray, FloatArray, IntArray

HYSTERESIS = 0.2
"""Half width of the dead band about the middle level, as a share of the step between the levels. Less lets noise
toggle an edge; more loses pulses whose height varies.
"""

LEVEL_ROUNDS = 8
"""Rounds to find the two levels; they settle in two or three."""

LOST_TOLERANCE = 0.2
"""How near to a whole number of usual intervals a long interval must be to count as lost pulses, in intervals."""

STEADY_RATIO = 1.3
"""Largest ratio between the intervals about a suspected gap; where they differ more, the speed itself changes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Edges:
    """The changes of one two-level channel.

    ``sample`` (m,) is the first sample in the new state, ``time`` (m,) the crossing of the middle level, interpolated
    linearly between samples, ``rising`` (m,); ``state`` (n,) is the state at every sample. ``sharp`` is the share of
    edges that pass from one level to the other within one sample, so that interpolation cannot place them better than
    to half a sample.
    """

    sample: IntArray
    time: FloatArray
    rising: BoolArray
    state: BoolArray
    low: float
    high: float
    sharp: float


def find_levels(x: FloatArray) -> tuple[float, float]:
    """The two levels about which the samples of a channel lie, low and high; equal where it does not move.

    Medians on both sides of the middle, repeated: rare index pulses, sine signals and unequal duty all give levels
    between which the middle parts the samples.
    """
    low, high = float(x.min()), float(x.max())
    for _ in range(LEVEL_ROUNDS):
        above = x >= 0.5 * (low + high)
        if above.all() or not above.any():
            break
        found = float(np.median(x[~above])), float(np.median(x[above]))
        if found == (low, high):
            break
        low, high = found
    return low, high


def find_edges(x: FloatArray, time: FloatArray) -> Edges:
    """The edges of one channel (n,) of volts or logic values at rising ``time`` (n,)."""
    low, high = find_levels(x)
    middle, band = 0.5 * (low + high), HYSTERESIS * (high - low)
    clear = np.flatnonzero(np.abs(x - middle) >= max(band, np.finfo(np.float64).tiny))
    if not clear.size:
        empty = np.empty(0, dtype=np.int64)
        return Edges(
            sample=empty,
            time=np.empty(0),
            rising=np.empty(0, dtype=np.bool_),
            state=np.zeros(x.size, dtype=np.bool_),
            low=low,
            high=high,
            sharp=0.0,
        )
    up = x[clear] > middle
    turn = np.flatnonzero(up[1:] != up[:-1]) + 1
    sample, rising = clear[turn], up[turn]
    # The last crossing of the middle before the new state was clear: bounces before it are the old state's noise.
    crossing = np.flatnonzero((x[1:] > middle) != (x[:-1] > middle)) + 1
    at = crossing[np.searchsorted(crossing, sample, side="right") - 1]
    before, after = x[at - 1], x[at]
    share = (middle - before) / (after - before)
    times = time[at - 1] + share * (time[at] - time[at - 1])
    state = np.repeat(np.concatenate([up[:1], rising]), np.diff(np.concatenate([[0], sample, [x.size]])))
    sharp = float(np.mean(np.abs(after - before) > 0.9 * (high - low))) if sample.size else 0.0
    return Edges(sample=sample, time=times, rising=rising, state=state, low=low, high=high, sharp=sharp)


@dataclass(frozen=True, kw_only=True, eq=False)
class Counts:
    """Readings of an encoder: at ``time`` (m,) it stands at ``count`` (m,) counts, at sample ``sample`` (m,).

    ``illegal`` (k,) are samples where both channels change at once, ``against`` (k,) those of steps against the run,
    ``lost`` pairs of a sample and a number of pulses that are missing there by their time.
    """

    time: FloatArray
    count: FloatArray
    sample: IntArray
    illegal: IntArray
    against: IntArray
    lost: tuple[tuple[int, int], ...] = ()


def quadrature(a: Edges, b: Edges) -> Counts:
    """Decode two channels, four counts a line, up where A leads B.

    A reading is the place of the edge that was passed, which is the same from either side. Where both channels change
    within one sample the direction of the last step is kept and two counts are made, with one reading.
    """
    phase = np.where(b.state, np.int8(3) - a.state, a.state.astype(np.int8))
    change = (np.diff(phase) & 3).astype(np.int8)
    sample = np.flatnonzero(change) + 1
    step = np.where(change[sample - 1] == 3, -1, change[sample - 1]).astype(np.int64)
    illegal = change[sample - 1] == 2
    legal = np.flatnonzero(~illegal)
    run = 1 if not legal.size or int(np.sum(step[legal])) >= 0 else -1
    if legal.size and illegal.any():
        last = legal[np.maximum(np.searchsorted(legal, np.flatnonzero(illegal)) - 1, 0)]
        step[illegal] = 2 * step[last]
    elif illegal.any():
        step[illegal] = 2
    after = np.cumsum(step)
    # The edge between counts c and c + 1 is called c + 1, whichever way it is passed.
    count = np.where(step > 0, after, after + 1).astype(np.float64)
    times = np.full(sample.size, -np.inf)
    for channel in (a, b):
        held = np.searchsorted(sample, channel.sample)
        np.maximum.at(times, held, channel.time)
    times = np.maximum.accumulate(times)
    return Counts(time=times, count=count, sample=sample, illegal=sample[illegal], against=sample[step * run < 0])


def pulses(a: Edges) -> Counts:
    """Count the rising edges of one channel; the direction cannot be seen and is taken as up.

    A gap of a whole number of usual intervals between steady neighbours is lost pulses, which are counted on; pulses
    that come much too early are only told (in ``against``), since which of them is wrong cannot be seen.
    """
    sample, time = a.sample[a.rising], a.time[a.rising]
    step = np.ones(sample.size, dtype=np.int64)
    lost: list[tuple[int, int]] = []
    early = np.zeros(sample.size, dtype=np.bool_)
    if sample.size > 6:
        interval = np.diff(time)
        padded = np.pad(interval, 2, mode="reflect")
        beside = np.stack([padded[:-4], padded[1:-3], padded[3:-1], padded[4:]])
        usual = np.median(beside, axis=0)
        steady = beside.max(axis=0) < STEADY_RATIO * beside.min(axis=0)
        ratio = interval / np.where(usual > 0.0, usual, np.inf)
        gap = steady & (ratio > 1.5) & (np.abs(ratio - np.rint(ratio)) < LOST_TOLERANCE)
        step[1:][gap] = np.rint(ratio[gap]).astype(np.int64)
        lost = [(int(sample[i + 1]), int(step[i + 1]) - 1) for i in np.flatnonzero(gap)]
        early[1:] = ratio < 0.5
    count = np.cumsum(step).astype(np.float64)
    none = np.empty(0, dtype=np.int64)
    return Counts(time=time, count=count, sample=sample, illegal=none, against=sample[early], lost=tuple(lost))


def unwrap_counter(count: FloatArray, modulus: float) -> FloatArray:
    """The readings (n,) of a counter without its wraps at ``modulus``; ``nan`` stays."""
    good = np.flatnonzero(np.isfinite(count))
    out = count.copy()
    if good.size:
        step = np.diff(count[good])
        step -= modulus * np.rint(step / modulus)
        out[good[1:]] = count[good[0]] + np.cumsum(step)
    return out


@dataclass(frozen=True, kw_only=True, eq=False)
class IndexCheck:
    """What the index pulse says of the counts between its passings.

    ``count`` (m,) are the counts from the first index on, put right after every turn that lost some, with ``nan``
    within such a turn. ``lost`` holds, per faulty turn, its begin and end in time and the counts that were lost
    (negative: too many). ``ignored`` are the times of index pulses that fit no turn, ``turns`` the turns checked.
    ``always`` is the number of counts that every turn has in common beyond the stated line count, or 0.
    """

    count: FloatArray
    lost: tuple[tuple[float, float, int], ...]
    ignored: tuple[float, ...]
    turns: int
    always: int


def check_index(time: FloatArray, count: FloatArray, index_time: FloatArray, per_turn: float) -> IndexCheck:
    """Compare the counts between index pulses with the counts of a turn.

    The count at an index pulse is interpolated in time, so that an index that falls on an edge does not come out one
    count off by chance.
    """
    inside = (index_time >= time[0]) & (index_time <= time[-1])
    times = index_time[inside]
    at = np.interp(times, time, count)
    times, at = times[np.isfinite(at)], at[np.isfinite(at)]
    fixed = count.copy()
    if times.size < 2:
        if times.size:
            fixed -= at[0]
        return IndexCheck(count=fixed, lost=(), ignored=(), turns=0, always=0)
    # A line count that is wrongly stated shows as the same excess in most turns.
    excess = np.rint(np.abs(np.diff(at)) - per_turn).astype(np.int64)
    common = int(np.median(excess))
    agree = int(np.sum(excess == common))
    if common != 0 and agree >= 2 and 2 * agree > excess.size:
        return IndexCheck(count=fixed, lost=(), ignored=(), turns=int(excess.size), always=common)

    def turns_between(i: int, j: int) -> tuple[float, float]:
        """Whole turns from index i to j, and the counts beyond them."""
        whole = np.rint((at[j] - at[i]) / per_turn)
        return float(whole), float(at[j] - at[i] - whole * per_turn)

    limit = 0.125 * per_turn  # beyond an eighth of a turn the index pulse is the likelier fault
    first = next((i for i in range(times.size - 1) if _fits(turns_between(i, i + 1), limit)), 0)
    ignored = [float(t) for t in times[:first]]
    lost: list[tuple[float, float, int]] = []
    anchor, turns = first, 0
    fixed -= at[first]
    for i in range(first + 1, times.size):
        whole, beyond = turns_between(anchor, i)
        if not _fits((whole, beyond), limit):
            ignored.append(float(times[i]))
            continue
        turns += int(abs(whole))
        off = round(beyond)
        if off:
            lost.append((float(times[anchor]), float(times[i]), -off if whole > 0 else off))
            begin, end = np.searchsorted(time, [times[anchor], times[i]])
            fixed[begin:end] = np.nan
            fixed[end:] -= off
        anchor = i
    return IndexCheck(count=fixed, lost=tuple(lost), ignored=tuple(ignored), turns=turns, always=0)


def _fits(found: tuple[float, float], limit: float) -> bool:
    return abs(found[0]) >= 1.0 and abs(found[1]) <= limit
