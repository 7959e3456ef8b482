"""Whether the travels of both shafts fit the tooth ratio, by how much they do not, and which ratio would fit.

Derived here: the slope of the transmission error over the driving angle, fitted together with the first two orders of
both shafts, as far as they turned, which a slope over a broken number of turns would otherwise swallow. Its standard
error is a jackknife over a dozen stretches of the recording, so that coloured leftovers count; a wander that holds
together for longer than a stretch cannot be told from a slope by any error.
"""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from gearpoly.recording.recording import Recording
from gearpoly.recording.unwrapping import continuous, settle_gaps
from gearpoly.units import TURN, FloatArray, IntArray

BLOCKS_PER_TURN = 64
"""Means per driving turn that enter the fit; enough for the second orders."""
BLOCKS_LIMIT = 100_000
"""Most means in all, for speed; very long recordings get fewer per turn."""
STRETCHES = 12
"""Stretches whose scatter gives the standard error: long enough to hold slow wander, enough to be counted."""
FEWEST_SAMPLES_FOR_RATIO = 64
"""Samples below which no ratio is asked for."""
HOLDS = 1.5
"""Turns of a shaft from which its first orders are fitted beside a slope. Of less they are a slope, and each makes the
other: a worm's error of 8 arcsec in half a turn made a slope of 12 % of the ratio."""
TEETH_LIMIT = 400
"""Largest tooth count of a ratio that is offered as an explanation."""


def whole_angles(recording: Recording) -> tuple[IntArray, FloatArray, FloatArray, float] | None:
    """Samples (m,) of a recording with both angles, these angles (m,) in rad, forward positive and continuous, and the
    ratio of their travels from sample to sample; None where both were not read, or hardly."""
    first, second = recording.driving_angle_rad, recording.driven_angle_rad
    if first is None or second is None or recording.computed:
        return None
    good = np.isfinite(first) & np.isfinite(second)
    if recording.time_s is not None:
        good &= np.isfinite(recording.time_s)
    rows = np.flatnonzero(good)
    position = rows.astype(np.float64) if recording.time_s is None else recording.time_s[rows]
    if rows.size < FEWEST_SAMPLES_FOR_RATIO or np.any(np.diff(position) < 0.0):
        return None
    one, other = (
        continuous(way * angle[rows], position, rows)
        for way, angle in ((recording.driving_direction, first), (recording.driven_direction, second))
    )
    both = one.ordinary & other.ordinary
    travel = float(np.sum(np.diff(one.angle)[both]))
    ratio = float(np.sum(np.diff(other.angle)[both])) / travel if travel else 0.0
    if not ratio > 0.0:
        return None
    # Gaps are settled with a ratio, and it has to be that of these readings.
    theta_1, theta_2, _ = settle_gaps(one, other, ratio)
    return rows, theta_1, theta_2, ratio


def slope(theta_1: FloatArray, theta_2: FloatArray, te: FloatArray) -> tuple[float, float]:
    """Slope of the transmission error (rad per rad of driving rotation) and its standard error.

    All arrays (N,) in rad, in the order of the recording.
    """
    turns = max(1.0, abs(theta_1[-1] - theta_1[0]) / TURN)
    width = TURN / max(8.0, min(BLOCKS_PER_TURN, BLOCKS_LIMIT / turns))
    block = np.floor((theta_1 - theta_1[0]) / width)
    begin = np.flatnonzero(np.concatenate([[True], block[1:] != block[:-1]]))
    held = np.diff(np.concatenate([begin, [te.size]]))
    a_1, a_2, y = (np.add.reduceat(x - x[0], begin) / held for x in (theta_1, theta_2, te))
    apart = [angle for angle in (a_1, a_2) if float(np.ptp(angle)) > HOLDS * TURN]
    waves = [wave(order * angle) for angle in apart for order in (1, 2) for wave in (np.cos, np.sin)]
    if y.size < 4 * (len(waves) + 2):
        waves = []
    reach = float(np.ptp(a_1))
    if reach <= 0.0:
        return 0.0, math.inf
    design = np.stack([a_1 / reach, np.ones_like(y), *waves], axis=1)
    pieces = np.array_split(np.arange(y.size), STRETCHES)
    squares = np.array([design[piece].T @ design[piece] for piece in pieces])
    products = np.array([design[piece].T @ y[piece] for piece in pieces])
    value = np.linalg.lstsq(design, y, rcond=None)[0][0] / reach
    # Leaving out one stretch after the other (jackknife) counts whatever holds together within a stretch. Least
    # squares, since a short recording may leave the equations singular.
    fewer = zip(squares.sum(axis=0) - squares, products.sum(axis=0) - products, strict=True)
    left_out = [np.linalg.lstsq(square, product, rcond=1e-10)[0][0] / reach for square, product in fewer]
    error = math.sqrt((STRETCHES - 1) * float(np.var(left_out)))
    return float(value), error


def nearest_teeth(ratio: float, tolerance: float) -> Fraction:
    """The ratio of the fewest teeth within ``tolerance`` (relative), or the best within the limit of tooth counts."""
    for driven in range(1, TEETH_LIMIT + 1):
        driving = round(ratio * driven)
        if 1 <= driving <= TEETH_LIMIT and abs(driving / driven - ratio) <= tolerance * ratio:
            return Fraction(driving, driven)
    return Fraction(ratio).limit_denominator(TEETH_LIMIT)
