"""When an encoder was read that is read less often than it is logged, and what it would have read at other instants.

Derived here. A reading that is new in a row was taken after the row before and not after its own: its instant is known
to one row. An encoder that is read by a clock of its own was read at ``a + n T``, and the rows in which its readings
are new bound both numbers far closer than to one row. Whether it is the clock or the logger that sets the instants is
told by the motion, which is smooth: of two times that may lie between readings, the true ones leave the speed more
even from reading to reading. A counter is new where a count passes, which no clock sets; its rows are kept.

The age of a reading beats where two clocks run beside each other. At 30 rpm and rows of 1 ms it is 53 um of a base
radius of 17 mm, up to one row old, and the beat of two such ages stands in the transmission error as a line.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.recording.spikes import single_spikes
from gearpoly.recording.unwrapping import continuous, without_turns
from gearpoly.units import TURN, BoolArray, FloatArray, IntArray

EQUAL_SHARE, EQUAL_STEP_PART = 0.8, 1e-3
"""A counter goes on by one count wherever it is new: so many of its steps are the usual one to this part of it. Its
repeats say that it turns by less than a count from row to row."""

WHOLE_COUNTS_PART = 1e-3
"""Counts of a turn are whole to this part of one; steps that do not divide a turn so are those of an even motion."""

INTERPOLATION_READINGS = 6
"""Readings through which a course is laid. Of a wave of eight readings it misses 0.1 % midway, through four 0.9 %."""

CLOCK_FIT_MOST_STEPS = 60
"""Steps of the fit of a clock at most; it ends where no row contradicts it."""

CLOCK_WINDOW_READINGS = (65, 33, 17, 9, 5, 3)
"""Readings around each over which a clock that wanders is told from the rows: a loop that waits so long after each of
its rounds. Each is half of the one before."""

MORE_EVEN_SPEED_PART = 1e-6
"""Part by which the speed must be more even under a clock of the encoder's own: less is rounding."""


def instants_of(position: FloatArray, before: FloatArray, reading: FloatArray) -> FloatArray:
    """When new readings (c,) in rad were taken, in the unit of ``position`` (c,), where each was first logged; the
    row ``before`` (c,) was still without it."""
    steps = without_turns(np.diff(reading))
    if position.size < 8 or np.all(before[1:] == position[:-1]) or _is_counter(steps):
        return position
    even = _clock(position, before)
    off = 0.5 * (position + before) - even
    tried = [even, *(even + _mean_around(off, width) for width in CLOCK_WINDOW_READINGS if width < position.size)]
    best, least = position, (1.0 - MORE_EVEN_SPEED_PART) * _roughness(steps, position)
    for one in tried:
        inside = np.clip(one, before, position)
        if np.all(np.diff(inside) > 0.0) and (rough := _roughness(steps, inside)) < least:
            best, least = inside, rough
    return best


@dataclass(frozen=True, kw_only=True, eq=False)
class ReadingsElsewhere:
    """Readings (k,) in rad at other instants than their own, which of them are ``known``, and the rms ``doubt`` in rad
    of what lies between readings."""

    reading: FloatArray
    known: BoolArray
    doubt: float


def read_beside(instants: FloatArray, reading: FloatArray, wanted: FloatArray) -> ReadingsElsewhere:
    """The readings at the instants ``wanted`` (k,), from those (c,) at ``instants`` (c,); both instants rise.

    A course of the fifth order is laid through six readings, three to either side; that of the third through the middle
    four differs from it by more than it is off. Single spikes are no readings, and nothing is put into gaps or before
    the first and after the last.
    """
    none = ReadingsElsewhere(
        reading=np.full(wanted.size, np.nan), known=np.zeros(wanted.size, dtype=np.bool_), doubt=math.inf
    )
    if instants.size < INTERPOLATION_READINGS:
        return none
    one = continuous(reading, instants, np.arange(instants.size))
    good = np.flatnonzero(~single_spikes(one.angle, moving=True))
    if good.size < INTERPOLATION_READINGS:
        return none
    angle, at = one.angle[good], instants[good]
    # One number for all readings between two gaps or spikes.
    broken = np.concatenate([[0], np.cumsum(~one.ordinary)])[good] + np.concatenate([[0], np.cumsum(np.diff(good) > 1)])
    i = np.clip(np.searchsorted(at, wanted, side="right") - 1, 0, at.size - 2)
    first = np.clip(i - 2, 0, at.size - INTERPOLATION_READINGS)
    fifth, third = (
        _through(at, angle, first, wanted, INTERPOLATION_READINGS),
        _through(at, angle, first + 1, wanted, INTERPOLATION_READINGS - 2),
    )
    whole = (broken[first] == broken[first + INTERPOLATION_READINGS - 1]) & (first == i - 2)
    share = (wanted - at[i]) / (at[i + 1] - at[i])
    value = np.where(whole, fifth, angle[i] + share * (angle[i + 1] - angle[i]))
    exact = (wanted == at[i]) | (wanted == at[i + 1])
    known = (exact | (broken[i] == broken[i + 1])) & (wanted >= at[0]) & (wanted <= at[-1])
    off = (fifth - third)[whole & known]
    if one.wrapped and one.wraps.any():
        low = float(np.min(reading))
        value = low + np.mod(value - low, TURN)
    return ReadingsElsewhere(
        reading=value, known=known, doubt=float(np.sqrt(np.mean(off * off))) if off.size else math.inf
    )


def _through(at: FloatArray, angle: FloatArray, first: IntArray, wanted: FloatArray, points: int) -> FloatArray:
    """Values (k,) at ``wanted`` (k,) of the polynomials through so many ``points`` each, from ``first`` (k,) on
    (Lagrange)."""
    away = [at[first + j] - wanted for j in range(points)]
    base, total = angle[first], np.zeros(wanted.size)
    for j in range(1, points):
        weight = np.ones(wanted.size)
        for m in range(points):
            if m != j:
                weight *= away[m] / (away[m] - away[j])
        total += weight * (angle[first + j] - base)
    return base + total


def _is_counter(steps: FloatArray) -> bool:
    """Whether steps (c-1,) in rad between new readings are those of a counter: one count each."""
    size = np.abs(steps)
    count = float(np.median(size))
    if count <= 0.0 or np.mean(np.abs(size - count) <= EQUAL_STEP_PART * count) < EQUAL_SHARE:
        return False
    turn = TURN / count
    return abs(turn - round(turn)) <= max(WHOLE_COUNTS_PART, EQUAL_STEP_PART * turn)


def _clock(position: FloatArray, before: FloatArray) -> FloatArray:
    """Instants ``a + n T`` (c,) that lie in the rows (c,) after ``before`` and up to ``position``, or miss them by the
    least squares."""
    pause = np.diff(position)
    row = float(np.median(position - before))
    usual = float(np.mean(pause[pause <= 2.0 * np.median(pause) + row]))
    # A pause that may be one period is one; longer ones hold readings that were missed or equal.
    more = np.where(pause < usual + row, 1.0, np.maximum(1.0, np.rint(pause / usual)))
    n = np.concatenate([[0.0], np.cumsum(more)])
    u = 2.0 * n / n[-1] - 1.0
    forms = np.column_stack([np.ones(u.size), u])
    sizes = np.linalg.lstsq(forms, 0.5 * (position + before), rcond=None)[0]
    slack = 1e-6 * row
    for _ in range(CLOCK_FIT_MOST_STEPS):
        line = forms @ sizes
        off = line - np.clip(line, before + slack, position - slack)
        out = off != 0.0
        if not out.any():
            break
        held = forms[out]
        damped = held.T @ held + 1e-6 * np.eye(2) * np.count_nonzero(out)
        sizes = sizes - np.linalg.solve(damped, held.T @ off[out])
    return np.asarray(forms @ sizes)


def _mean_around(values: FloatArray, width: int) -> FloatArray:
    """The means of so many ``values`` (c,) around each; of fewer at the ends."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    i = np.arange(values.size)
    begin, end = np.maximum(i - width // 2, 0), np.minimum(i + width // 2 + 1, values.size)
    return np.asarray((total[end] - total[begin]) / (end - begin))


def _roughness(steps: FloatArray, instants: FloatArray) -> float:
    """How unevenly a shaft runs that goes on by ``steps`` (c-1,) in rad between ``instants`` (c,)."""
    return float(np.sum(np.abs(np.diff(steps / np.diff(instants)))))
