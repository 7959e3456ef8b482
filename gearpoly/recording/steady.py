"""Which samples of a recording were made while the pair turned as usual, by the speed of its driving shaft.

Derived here. Slow ends are the ramps of a start and a stop, and so are both sides of a stop in the middle; slow parts
that hold a good part of the way are what was to be recorded, and only standing still is left out of them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gearpoly.recording.unwrapping import weighted_median
from gearpoly.units import DEG, BoolArray, FloatArray

RAMP_SHARE = 0.75
"""Share of the usual speed below which both ends of a recording are ramps; speed may wobble within it."""

CREEP_SHARE = 0.1
"""The same below which a shaft in the middle of a recording stops, be it that it creeps: a drive that is to run slowly
runs at a tenth for longer than ``RUN_UP_SHARE`` allows."""

STANDS_SHARE = 0.02
"""The same below which it stands still."""

RUN_UP_SHARE = 0.1
"""Part of all driving turns that a slow end, or a slow part, may hold and still be a ramp."""

RAMP_WINDOW = 5.0 * DEG
"""Driving rotation in rad over which that speed is taken, above the noise of single readings."""


class Steady(NamedTuple):
    """The first sample between both ramps and the end of them, and which samples (n,) lie in ``stops`` between."""

    begin: int
    end: int
    stops: BoolArray


def steady(theta_1: FloatArray, position: FloatArray) -> Steady:
    """What of a rising driving rotation (n,) in rad was made at speed; ``position`` (n,) is the time, or the sample."""
    travel = np.abs(np.diff(theta_1))
    moving = weighted_median(travel, travel)
    span = min(max(1, math.ceil(RAMP_WINDOW / moving)) if moving > 0.0 else 1, theta_1.size - 1)
    pause = position[span:] - position[:-span]
    advance = theta_1[span:] - theta_1[:-span]
    speed = np.divide(advance, pause, out=np.zeros_like(advance), where=pause > 0.0)
    usual = weighted_median(speed, np.abs(advance))
    fast, moves = (np.flatnonzero(speed >= share * usual) for share in (RAMP_SHARE, STANDS_SHARE))
    stops = np.zeros(theta_1.size, dtype=np.bool_)
    if not fast.size:
        return Steady(0, 0, stops)
    begin, end, way = int(fast[0]), int(fast[-1]) + span + 1, RUN_UP_SHARE * (theta_1[-1] - theta_1[0])
    if theta_1[begin] - theta_1[moves[0]] > way:
        begin = int(moves[0])
    if theta_1[moves[-1] + span] - theta_1[end - 1] > way:
        end = int(moves[-1]) + span + 1
    for places in (fast, moves):
        for k in np.flatnonzero(np.diff(places) > 1):
            # Places are begins of windows, so what moved last lies a window on.
            before, last = int(places[k]), int(places[k + 1])
            first = before + span + 1
            slow = speed[before + 1 : last]
            if first < last and np.min(slow) < CREEP_SHARE * usual and theta_1[last] - theta_1[first - 1] <= way:
                stops[first:last] = True
    stops[:begin] = stops[end:] = False
    return Steady(begin, end, stops)
