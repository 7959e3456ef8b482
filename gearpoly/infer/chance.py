"""How often noise alone gives a sum of squares as large.

Of scipy.special, which everything else loads anyway: every command that compares would wait for scipy.stats.
"""

from __future__ import annotations

import numpy as np
from scipy.special import chdtrc


def log_tail(square: float, freedoms: int) -> float:
    """Log of the chance that ``freedoms`` normal numbers of variance 1 have a sum of squares above ``square``, both
    without dimension; -inf where it is no longer a number (Abramowitz and Stegun 1964, 26.4)."""
    with np.errstate(divide="ignore"):
        return float(np.log(chdtrc(freedoms, square)))
