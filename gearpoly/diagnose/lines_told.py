"""Lines of an encoder finer than two samples, where the samples do not come evenly."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gearpoly.compare.peak import is_hum
from gearpoly.infer.prior import LINE_COUNTS
from gearpoly.physics.samples import Samples
from gearpoly.units import FloatArray

ALIKE = 0.5
"""Length of the mean phasor between two waves over the samples, below which they are told apart: one has less than a
quarter of the other's power then. A judgement. Samples that came up to 0.3 of a step early or late leave 0.2 of order
720 at 288 a turn, whose lines had been found nowhere."""

NONE_TOLD: tuple[frozenset[int], frozenset[int]] = (frozenset(), frozenset())


def lines_told(samples: Sequence[Samples], gear: int, *, finest: float) -> frozenset[int]:
    """Line counts of encoders on the shaft of a ``gear``, from ``finest`` waves per turn on, that any recording tells
    from slower orders, since its ``samples`` do not come evenly, and from hum, since its speed or its mains do not fit.
    """
    counts = [count for count in sorted(LINE_COUNTS) if count >= finest]
    return frozenset(count for count in counts if any(_tells(one, gear, count) for one in samples))


def _tells(samples: Samples, gear: int, order: int) -> bool:
    angle = samples.theta_1 if gear == 0 else samples.theta_2
    if _alike(angle, np.arange(angle.size, dtype=np.float64), order) >= ALIKE:
        return False
    time = samples.time
    if time is None or np.ptp(time) <= 0.0:
        return True
    turns, duration = float(np.ptp(angle)) / (2.0 * math.pi), float(np.ptp(time))
    return not is_hum(order * turns / duration, std=1.0 / duration) or _alike(angle, time, order) < ALIKE


def _alike(angle: FloatArray, even: FloatArray, order: int) -> float:
    """Length of the mean phasor of a wave of an ``order`` over ``angle`` (n,) in rad about the same wave over what
    passes as evenly as the angle at best, ``even`` (n,)."""
    off = angle - np.polynomial.Polynomial.fit(even, angle, 1)(even)
    return float(abs(np.mean(np.exp(1j * order * off))))
