"""Whether columns of millions of numbers are finite, told quickly where they are."""

from __future__ import annotations

import numpy as np

from gearpoly.units import FloatArray


@np.errstate(over="ignore", invalid="ignore")  # a damaged file may hold anything
def all_finite(values: FloatArray) -> bool:
    """Whether every number (n,) is finite, which a sum tells in half the time in nearly all columns."""
    return bool(np.isfinite(values.sum()) or np.isfinite(values).all())


def has_infinite(values: FloatArray) -> bool:
    """Whether any number (n,) is infinite; ``nan``, which marks a drop-out, is not."""
    return not all_finite(values) and bool(np.isinf(values).any())
