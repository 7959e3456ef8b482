"""Lines of an encoder finer than two samples, where the samples do not come evenly."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

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
    return frozenset(count for one in samples for count in _told(one, gear, counts))


def _told(samples: Samples, gear: int, counts: Sequence[int]) -> Iterator[int]:
    """Those of line ``counts`` that one recording tells from slower orders, and from hum."""
    angle, time = samples.theta_1 if gear == 0 else samples.theta_2, samples.time
    by_number = _off(angle, np.arange(angle.size, dtype=np.float64))
    duration = 0.0 if time is None else float(np.ptp(time))
    by_time = by_number if time is None or duration <= 0.0 else _off(angle, time)
    turns = float(np.ptp(angle)) / (2.0 * math.pi)
    for count in counts:
        hums = duration > 0.0 and is_hum(count * turns / duration, std=1.0 / duration)
        if _phasor(by_number, count) < ALIKE and not (hums and _phasor(by_time, count) >= ALIKE):
            yield count


def _off(angle: FloatArray, even: FloatArray) -> FloatArray:
    """By how much an ``angle`` (n,) in rad is off the straight line over ``even`` (n,) that fits best."""
    return np.asarray(angle - np.polynomial.Polynomial.fit(even, angle, 1)(even))


def _phasor(off: FloatArray, order: int) -> float:
    """Length of the mean phasor, 0 to 1, of a wave of an ``order`` over an angle that is so far ``off`` (n,) in rad."""
    return float(abs(np.mean(np.exp(1j * order * off))))
