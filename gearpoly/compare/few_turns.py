"""Order 1 of a shaft of which a recording holds one turn and a half, or order 2 of less: a drift may be as well.

It is no noise, however little can be said of it: a worm's error is what a guide log of ten minutes shows first. So it
is fitted from the start, beside the slow curves, and told where more is in it than noise, with the drift as its rival.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from gearpoly.compare.families import SHARES, log_tail_line
from gearpoly.compare.noise import Noise
from gearpoly.compare.peak import Peak
from gearpoly.compare.sampling import SLOWEST, Sampling
from gearpoly.compare.slow import slow_curves
from gearpoly.units import FloatArray

FEWEST_WAVES = 0.5 * SLOWEST
"""Waves that a recording holds from which one is fitted beside ramp, bow and S: so order 1 is, from where order 2 is a
line like all others. Of 8 arcsec 9 to 15 were told in 0.95 turns, 6.6 to 7.8 in 1.15, 7.8 to 8.1 in 1.6."""

FIRST_ORDERS = 3
"""Orders of that shaft that are kept out of the noise: their lines are so wide that they reach between the orders, from
where it is taken. With order 1 alone a worm of 8, 2 and 0.7 arcsec in orders 1 to 3 left 6 arcsec of noise, of 0.6."""


def first_order(sampling: Sampling) -> Peak | None:
    """Order 1 or 2 of a shaft of which a recording holds ``FEWEST_WAVES`` to ``SLOWEST`` waves, of several the fastest;
    None where there is none. The others would be no longer apart from the drift."""
    held = {(z, order): order * sampling.span / z for z in (sampling.z_1, sampling.z_2) for order in (1, 2)}
    within = {place: waves for place, waves in held.items() if FEWEST_WAVES < waves <= SLOWEST}
    return _order(*max(within, key=lambda place: within[place])) if within else None


def first_orders(searches: Sequence[Sampling]) -> list[Peak | None]:
    """The same of each recording of a set; None where another one holds turns enough of that shaft to tell the order
    from a drift. It is then looked for there, and what is fixed to a shaft is fitted in all."""
    firsts = [first_order(sampling) for sampling in searches]
    longest = max(sampling.span for sampling in searches)
    return [None if one is None or longest * one.frequency > SLOWEST else one for one in firsts]


@lru_cache
def _order(z: int, order: int) -> Peak:
    """The same of all recordings of a set."""
    return Peak(domain="order", frequency=order / z, std=0.0, gain=0.0, log_false=0.0, known=True, few=order)


def without_first(u: FloatArray, residual: FloatArray, peak: Peak | None) -> FloatArray:
    """A ``residual`` (n,) in mm at ``u`` (n,) meshes less the wave, if there is one, the next orders and the slow
    curves that fit it best: else they would be noise that wanders, in which nothing weighs, least of all themselves."""
    if peak is None:
        return residual
    columns = np.column_stack((slow_curves(u), *_waves(u, peak)))
    return np.asarray(residual - columns @ np.linalg.lstsq(columns, residual, rcond=None)[0])


def beside_order(sampling: Sampling, gear: str | None, order: int) -> tuple[str, ...]:
    """What an ``order`` of the shaft of ``gear`` may be as well: a drift, and the same of the other where the recording
    does not tell both apart, which are less than a line from each other."""
    apart = order * abs(sampling.span / sampling.z_1 - sampling.span / sampling.z_2)
    other = "driven" if gear == "driving" else "driving"
    return (*((f"order {order} of the {other} shaft",) if 0.0 < apart < 1.0 else ()), "a slow drift")


def beside_first(u: FloatArray, slow: FloatArray, peak: Peak) -> FloatArray:
    """Variances (terms - 1,) of the amplitudes of ``slow`` curves (n, terms) but the mean in white noise of variance 1,
    fitted beside the wave: they and a wave of so few turns take from each other."""
    columns = np.column_stack((slow, *_waves(u, peak)))
    return np.asarray(np.diag(np.linalg.pinv(columns.T @ columns))[1 : slow.shape[1]])


def _waves(u: FloatArray, peak: Peak) -> list[FloatArray]:
    """The wave and the next orders of its shaft, which are kept out of the noise, as columns (n,) of 1 mm."""
    angle = 2.0 * math.pi * peak.frequency / peak.few * u
    return [wave(order * angle) for order in range(peak.few, peak.few + FIRST_ORDERS) for wave in (np.cos, np.sin)]


def log_false(sampling: Sampling, noise: Noise, peak: Peak, *, gain: float, recordings: int) -> float:
    """Log of the expected number of waves in noise that ``gain`` as much at this order in one of so many recordings,
    over the search's share of chance."""
    _, count = sampling.rest_at(peak.domain, np.array([peak.frequency]), noise)
    return math.log(recordings / SHARES.orders) + float(log_tail_line(np.array([0.5 * gain]), count)[0])
