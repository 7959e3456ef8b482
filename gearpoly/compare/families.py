"""How large a find must be before it counts, when so many places were searched.

Each search has its share of the 2 % that a healthy set of recordings may raise any false entry at all. Where many
places are looked at, their chances add up (union bound); where the places run into one another, as frequencies do, the
expected number of upcrossings stands for their number. The noise was itself estimated from so many lines, so the tails
are those of ratios (Fisher's F), not of the exponential.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import log_ndtr

from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True)
class Shares:
    """Chance of a false entry that each search may have; their sum is the family's."""

    orders: float = 0.003
    between: float = 0.003
    time: float = 0.002
    teeth: float = 0.003
    drift: float = 0.0015
    condition: float = 0.0015
    jump: float = 0.001
    faint: float = 0.001

    @property
    def total(self) -> float:
        """The family's chance."""
        own = (self.orders, self.between, self.time, self.teeth, self.drift, self.condition, self.jump, self.faint)
        return sum(own)


SHARES = Shares()
"""1.6 % together; the rest of the 2 % is for what the noise model gets wrong, above all where noise wanders."""


def log_tail_line(z: FloatArray, count: FloatArray) -> FloatArray:
    """Log chance that a line of noise exceeds ``z`` times a level estimated from ``count`` other lines: the mean of
    count exponentials leaves (1 + z/count)^-count (exact)."""
    return np.asarray(-count * np.log1p(z / count))


def log_false_any(z: FloatArray, count: FloatArray, *, lines: float) -> FloatArray:
    """Log of the expected number of false peaks above ``z`` at any frequency of a band that holds ``lines``
    independent ones (Baluev 2008, eq. 5, for evenly spread samples: W sqrt(z) exp(-z) with W = sqrt(pi/3) lines)."""
    return np.asarray(np.log(np.sqrt(np.pi / 3.0) * lines) + 0.5 * np.log(np.maximum(z, 1.0)) + log_tail_line(z, count))


def log_tail_square(chi2: FloatArray) -> FloatArray:
    """Log chance that the square of a standard normal exceeds ``chi2``."""
    return np.asarray(np.log(2.0) + log_ndtr(-np.sqrt(np.maximum(chi2, 0.0))))


def line_threshold(count: float, *, places: float, share: float) -> float:
    """z that a line at one of ``places`` known places has to exceed."""
    return float(count * np.expm1(np.log(places / share) / count))
