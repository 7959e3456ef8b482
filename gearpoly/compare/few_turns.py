"""Order 1 of a shaft of which a recording holds one turn and a half, or order 2 of less: a drift may be as well.

It is no noise, however little can be said of it: a worm's error is what a guide log of ten minutes shows first. So it
is fitted from the start, beside the slow curves, and told where more is in it than noise, with the drift as its rival.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from gearpoly.compare.families import SHARES, log_tail_line
from gearpoly.compare.lines import SLOWEST, LineSearch, Peak
from gearpoly.compare.noise import Noise
from gearpoly.compare.slow import slow_curves
from gearpoly.units import FloatArray

FEWEST_WAVES = 0.5 * SLOWEST
"""Waves that a recording holds from which one is fitted beside ramp, bow and S: so order 1 is, from where order 2 is a
line like all others. Of 8 arcsec 9 to 15 were told in 0.95 turns, 6.6 to 7.8 in 1.15, 7.8 to 8.1 in 1.6."""

FIRST_ORDERS = 3
"""Orders of that shaft that are kept out of the noise: their lines are so wide that they reach between the orders, from
where it is taken. With order 1 alone a worm of 8, 2 and 0.7 arcsec in orders 1 to 3 left 6 arcsec of noise, of 0.6."""


def first_order(search: LineSearch) -> Peak | None:
    """Order 1 or 2 of a shaft of which a recording holds ``FEWEST_WAVES`` to ``SLOWEST`` waves, of several the fastest;
    None where there is none. The others would be no longer apart from the drift."""
    place = _place(search)
    return None if place is None else _wave_at(*place)


def _place(search: LineSearch) -> tuple[int, int] | None:
    """The teeth of that shaft, and the order."""
    held = {(z, order): order * search.span / z for z in (search.z_1, search.z_2) for order in (1, 2)}
    within = {place: waves for place, waves in held.items() if FEWEST_WAVES < waves <= SLOWEST}
    return max(within, key=lambda place: within[place]) if within else None


@lru_cache
def _wave_at(z: int, order: int) -> Peak:
    """The same of all recordings of a set."""
    return Peak(domain="order", frequency=order / z, std=0.0, gain=0.0, log_false=0.0, known=True, few=True)


def without_first(search: LineSearch, residual: FloatArray) -> FloatArray:
    """A ``residual`` (n,) in mm less that wave, if there is one, the next orders of its shaft and the slow curves that
    fit it best: else they would be noise that wanders, in which nothing weighs, they themselves least of all."""
    place = _place(search)
    if place is None:
        return residual
    z, first = place
    angle = 2.0 * math.pi * search.u / z
    waves = [wave(order * angle) for order in range(first, first + FIRST_ORDERS) for wave in (np.cos, np.sin)]
    columns = np.column_stack((slow_curves(search.u), *waves))
    return np.asarray(residual - columns @ np.linalg.lstsq(columns, residual, rcond=None)[0])


def log_false(search: LineSearch, noise: Noise, peak: Peak, *, gain: float, recordings: int) -> float:
    """Log of the expected number of waves in noise that ``gain`` as much at this order in one of so many recordings,
    over the search's share of chance."""
    _, count = search.rest_at(peak.domain, np.array([peak.frequency]), noise)
    return math.log(recordings / SHARES.orders) + float(log_tail_line(np.array([0.5 * gain]), count)[0])
