"""Angles that no encoder read: a rig or a guide log may state a shaft's angle as time at one rate."""

from __future__ import annotations

import numpy as np

from gearpoly.recording.unwrapping import continuous, only_goes_on
from gearpoly.units import DEG, FloatArray

OFF_TIME_LINE_PART = 1e-6
"""Part of the angle's range by which it may be off a straight line over time and still be nothing but time: readings to
six places over a turn are as fine, and no shaft with an encoder turns as evenly for a hundred samples (the steadiest
of the recordings at hand wobbles by 1e-4)."""

SAMPLES_FOR_STRAIGHT_LINE = 64
"""Samples that are looked at first, since nearly all encoders are told by them."""

WRAP_DEG = 360.0


def is_from_time(time: FloatArray, angle: FloatArray) -> bool:
    """Whether an ``angle`` (n,) in deg, wrapped or not, is nothing but ``time`` (n,) in s at one rate."""
    if time.size < SAMPLES_FOR_STRAIGHT_LINE:
        return False
    return _is_line(time[:SAMPLES_FOR_STRAIGHT_LINE], angle[:SAMPLES_FOR_STRAIGHT_LINE]) and _is_line(time, angle)


def _is_line(time: FloatArray, angle: FloatArray) -> bool:
    held = np.isfinite(time) & np.isfinite(angle)
    if np.count_nonzero(held) < SAMPLES_FOR_STRAIGHT_LINE // 2:
        return False
    t, turned = time[held], _whole(time[held], angle[held])
    span, far = float(np.ptp(t)), float(np.ptp(turned))
    if not (span > 0.0 and far > 0.0):
        return False
    line = np.polynomial.Polynomial.fit(t, turned, 1)(t)
    return bool(np.max(np.abs(turned - line)) <= OFF_TIME_LINE_PART * max(far, WRAP_DEG))


def _whole(t: FloatArray, angle: FloatArray) -> FloatArray:
    """An ``angle`` (n,) in deg without wraps, with as many turns in each gap of ``t`` (n,) in s as fit the usual
    rate."""
    if only_goes_on(angle):
        return angle
    return continuous(angle * DEG, t, np.arange(t.size)).angle / DEG
