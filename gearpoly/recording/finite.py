"""Whether columns of millions of numbers are finite, told quickly where they are."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.units import FloatArray


@np.errstate(over="ignore", invalid="ignore")  # a damaged file may hold anything
def all_finite(values: FloatArray) -> bool:
    """Whether every number (n,) is finite, which a sum tells in half the time in nearly all columns."""
    return bool(np.isfinite(values.sum()) or np.isfinite(values).all())


def has_infinite(values: FloatArray) -> bool:
    """Whether any number (n,) is infinite; ``nan``, which marks a drop-out, is not."""
    return not all_finite(values) and bool(np.isinf(values).any())


def first_read(values: FloatArray, count: int) -> FloatArray:
    """The first so many finite numbers of a column (n,); where nothing is missing among them, without a look at the
    others."""
    some = values[:count]
    return some if np.isfinite(some).all() else values[np.isfinite(values)][:count]


NUMBERS_PER_BLOCK = 32_768
"""Numbers of which the steps are looked at together: they stay in the processor's second store."""


def steps_between(values: FloatArray) -> tuple[float, float]:
    """The least and the largest step between neighbouring finite numbers (n,), two at least. New memory for all
    steps would take three times as long."""
    held = np.empty(min(NUMBERS_PER_BLOCK, values.size - 1))
    least, largest = math.inf, -math.inf
    for at in range(0, values.size - 1, NUMBERS_PER_BLOCK):
        later = values[at + 1 : at + held.size + 1]
        step = np.subtract(later, values[at : at + later.size], out=held[: later.size])
        least, largest = min(least, float(step.min())), max(largest, float(step.max()))
    return least, largest
