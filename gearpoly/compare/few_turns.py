"""Order 1 of a shaft of which a recording holds one turn and a half: a wave that a drift may be as well.

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

ONE_TURN = 1.0
"""Turns of a shaft from which its order 1 is fitted beside ramp, bow and S: of a single wave these leave a tenth, of
less nothing that stands out."""

FIRST_ORDERS = 3
"""Orders of that shaft that are kept out of the noise: their lines are so wide that they reach between the orders, from
where it is taken. With order 1 alone a worm of 8, 2 and 0.7 arcsec in orders 1 to 3 left 6 arcsec of noise, of 0.6."""


def first_order(search: LineSearch) -> Peak | None:
    """Order 1 of the shaft of which a recording holds most turns, more than ``ONE_TURN`` and no more than ``SLOWEST``;
    None where there is no such shaft. Of two such shafts the other's would be no longer apart from the drift."""
    within = [z for z in (search.z_1, search.z_2) if ONE_TURN < search.span / z <= SLOWEST]
    return _order_1(min(within)) if within else None


@lru_cache
def _order_1(z: int) -> Peak:
    """The same of all recordings of a set."""
    return Peak(domain="order", frequency=1.0 / z, std=0.0, gain=0.0, log_false=0.0, known=True, few=True)


def without_first(u: FloatArray, residual: FloatArray, peak: Peak | None) -> FloatArray:
    """A ``residual`` (n,) in mm at ``u`` (n,) meshes less the wave, if there is one, its harmonics and the slow curves
    that fit it best: else they would be noise that wanders, in which nothing weighs, they themselves least of all."""
    if peak is None:
        return residual
    angle = 2.0 * math.pi * peak.frequency * u
    waves = [wave(order * angle) for order in range(1, FIRST_ORDERS + 1) for wave in (np.cos, np.sin)]
    columns = np.column_stack((slow_curves(u), *waves))
    return np.asarray(residual - columns @ np.linalg.lstsq(columns, residual, rcond=None)[0])


def log_false(search: LineSearch, noise: Noise, peak: Peak, *, gain: float, recordings: int) -> float:
    """Log of the expected number of waves in noise that ``gain`` as much at this order in one of so many recordings,
    over the search's share of chance."""
    _, count = search.rest_at(peak.domain, np.array([peak.frequency]), noise)
    return math.log(recordings / SHARES.orders) + float(log_tail_line(np.array([0.5 * gain]), count)[0])
