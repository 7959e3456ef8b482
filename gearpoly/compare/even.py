"""Whether samples come evenly, in time or over a shaft's turn: then a wave and its aliases are one.

Samples that come ``rate`` times per unit show waves of frequencies f, rate - f, rate + f ... alike, whatever their
noise. The lowest is reported, and the next two are told with it (Nyquist; Shannon 1949).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.recording.rounding import reading_step
from gearpoly.units import FloatArray

STRAY = 0.016
"""Steps, rms, by which samples may stray and still be even: an alias then keeps exp(-(2 pi 0.016)^2) = 99 % of its
power. Clocks of a microsecond at 10 kHz stray by 0.003; rigs that do not sample in step with anything by 0.1 and more.
"""


GAP_MIDDLE_STEPS = 1.5
"""Middle steps from which on a step is a gap."""


@dataclass(frozen=True, kw_only=True)
class Even:
    """Samples per s, per turn of the driving and per turn of the driven shaft, each ``None`` where they are uneven."""

    time: float | None = None
    driving: float | None = None
    driven: float | None = None


def even_rate(x: FloatArray, *, rounding: float = 0.0) -> float | None:
    """Samples per unit of ``x`` (n,), rising, where they come evenly, some of them perhaps left out, but for the
    ``rounding`` of ``x``, rms; else ``None``."""
    step = np.diff(x)
    usual = float(np.median(step)) if step.size else 0.0
    if usual <= 0.0:
        return None
    # Of rounded steps none is the true one, and none of them tells how many a gap holds.
    usual = float(np.mean(step[step < GAP_MIDDLE_STEPS * usual]))
    number = np.concatenate([[0.0], np.cumsum(np.rint(step / usual))])
    along = x - np.mean(x)
    rate = float(along @ number) / float(along @ along)
    stray = number - np.mean(number) - rate * along
    return rate if math.sqrt(float(stray @ stray) / x.size) <= math.hypot(STRAY, rounding / usual) else None


def even_in_time(time_s: FloatArray) -> float | None:
    """Samples per s where they come evenly, by times (n,) that may be rounded to a step of their own."""
    step = np.diff(time_s)
    # A gap is no step from which one tells the next: without it the differences that rounding makes are seen.
    ordinary = step[step < GAP_MIDDLE_STEPS * np.median(step)] if step.size else step
    return even_rate(time_s, rounding=(reading_step(np.cumsum(ordinary)) or 0.0) / math.sqrt(12.0))


def even_in(theta_1: FloatArray, theta_2: FloatArray, time_s: FloatArray | None) -> Even:
    """What is even of samples at angles (n,) in rad and times (n,) in s."""
    turn = 2.0 * math.pi
    driving, driven = (None if (rate := even_rate(angle)) is None else rate * turn for angle in (theta_1, theta_2))
    return Even(time=None if time_s is None else even_in_time(time_s), driving=driving, driven=driven)


def aliases(frequency: float, rate: float | None) -> tuple[float, ...]:
    """The lowest two frequencies above half the ``rate`` that even samples show as they show ``frequency``."""
    return () if rate is None else (rate - frequency, rate + frequency)
