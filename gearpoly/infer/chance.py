"""How often noise alone gives a sum of squares as large.

Of scipy.special, which everything else loads anyway: every command that compares would wait for scipy.stats.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import chdtrc


def log_tail(square: float, freedoms: int) -> float:
    """Log of the chance that ``freedoms`` normal numbers of variance 1 have a sum of squares above ``square``, both
    without dimension; -inf where it is no longer a number (Abramowitz and Stegun 1964, 26.4)."""
    with np.errstate(divide="ignore"):
        return float(np.log(chdtrc(freedoms, square)))


def probability_by_chance(p: float) -> float:
    """Probability that something is there of which noise alone gives as much with a chance ``p``, both without
    dimension, where either was as likely beforehand: at most this, whatever its size may be (Sellke, Bayarri and
    Berger, Calibration of p values for testing precise null hypotheses, The American Statistician 55, 2001, 62)."""
    if p <= 0.0:
        return 1.0
    if p >= math.exp(-1.0):
        return 0.5
    return 1.0 / (1.0 - math.e * p * math.log(p))
