"""Which way a shaft turns: told quickly where it turns one way, and its angle without wraps for a look at the rest.

Derived here. Between neighbouring samples a shaft moves less than half a turn, so a larger step is a wrap.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gearpoly.recording.finite import all_finite
from gearpoly.recording.unwrapping import GAP_STEPS, GAP_TURNS, WRAPPED_SPAN, gaps, thinned
from gearpoly.units import TURN, BoolArray, FloatArray, IntArray

FEWEST_SAMPLES_FOR_RUNS = 8
"""Samples below which nothing is said of runs."""

SAMPLES_PER_BLOCK = 2**15
"""Samples that are looked at in one go: what is made of them stays in the processor's own memory (256 kB)."""

STEPS_FOR_USUAL_PAUSE = 10_000
"""Steps from which the usual one is told at first: their median is right to a hundredth of their spread, and
``GAP_STEPS`` is three of it."""

FASTEST_STEP_QUANTILE = 0.99
"""Part of all steps that are slower than the speed by which a gap is bridged at most."""


class Pauses(NamedTuple):
    """What lies between neighbouring samples: the ``length`` (m-1,) in s, or in samples, and whether it is an
    ``ordinary`` one (m-1,), in which a shaft turns by less than half a turn."""

    length: FloatArray
    ordinary: BoolArray


def turns_one_way(time: FloatArray | None, leader: FloatArray, *others: FloatArray) -> bool:
    """Whether nothing is missing, and the ``leader`` (n,) in rad, wrapped or not, turns one way from sample to sample:
    the commonest case, told from one look at millions of numbers."""
    if leader.size < FEWEST_SAMPLES_FOR_RUNS or not all(all_finite(one) for one in others):
        return False
    longest = np.inf
    if time is not None:
        every = max(1, time.size // STEPS_FOR_USUAL_PAUSE)
        longest = GAP_STEPS * float(np.median(time[1::every] - time[:-1:every]))
    forward = backward = True
    held = np.empty(min(SAMPLES_PER_BLOCK, leader.size - 1))
    for at in range(0, leader.size - 1, SAMPLES_PER_BLOCK):
        if time is not None and not np.max(_steps(time, at, held)) <= longest:  # nan too
            return False
        step = _steps(leader, at, held)
        least, largest = float(np.min(step)), float(np.max(step))
        forward = forward and _is_forward(step, least, largest)
        backward = backward and _is_forward(-step, -largest, -least)
        if not forward and not backward:
            return False
    return True


def _steps(values: FloatArray, at: int, held: FloatArray) -> FloatArray:
    """The steps (m,) between the values (n,) from ``at`` on, as many as there are and ``held`` has room for. New memory
    for every block would take five times as long."""
    later = values[at + 1 : at + held.size + 1]
    return np.subtract(later, values[at : at + later.size], out=held[: later.size])


def _is_forward(step: FloatArray, least: float, largest: float) -> bool:
    """Whether every step (m,) in rad, from the ``least`` to the ``largest``, is forward by at most half a turn, or a
    wrap."""
    if not largest <= 0.5 * TURN:  # nan too
        return False
    return least >= 0.0 or bool(np.count_nonzero(step < 0.0) == np.count_nonzero(step < -0.5 * TURN))


def pauses_between(time: FloatArray | None, rows: IntArray) -> Pauses:
    """What lies between the samples at ``rows`` (m,) of a recording with ``time`` (n,) in s, or with none."""
    position = rows.astype(np.float64)
    if time is not None:
        held = time[rows] if rows.size < time.size else time
        position = np.nan_to_num(held, nan=0.0, posinf=0.0, neginf=0.0) if not np.isfinite(held).all() else held
    length = np.diff(position)
    ordinary = ~gaps(length, float(np.median(thinned(length))))
    if int(rows[-1]) - int(rows[0]) >= rows.size:  # some were left out between
        ordinary &= np.diff(rows) == 1
    return Pauses(length, ordinary)


def without_wraps(reading: FloatArray, pauses: Pauses) -> tuple[FloatArray, BoolArray]:
    """The angle (m,) in rad without wraps of a ``reading`` (m,) in rad, and the steps (m-1,) across which nobody knows
    how many turns were made."""
    length, ordinary = pauses
    step = np.diff(reading)
    low, high = np.quantile(thinned(reading), [0.005, 0.995])
    wrapped = bool(high - low <= WRAPPED_SPAN * TURN)
    far = np.flatnonzero(np.abs(step) > 0.5 * TURN)
    far = far if wrapped else far[ordinary[far]]
    step[far] -= TURN * np.rint(step[far] / TURN)
    cuts = np.zeros(length.size, dtype=np.bool_)
    if wrapped and ordinary.any() and not ordinary.all():
        moves = ordinary & (length > 0.0)
        speed = float(np.quantile(np.abs(step[moves]) / length[moves], FASTEST_STEP_QUANTILE)) if moves.any() else 0.0
        cuts = ~ordinary & (speed * length > GAP_TURNS * TURN)
    angle = np.empty(reading.size)
    angle[0] = 0.0
    np.cumsum(step, out=angle[1:])
    angle += reading[0]
    return angle, cuts
