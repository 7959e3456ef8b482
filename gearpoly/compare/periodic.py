"""A periodic curve between its points, compiled; importing this imports numba."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.mesh.radial_search import compiled
from gearpoly.units import FloatArray

NEAR = 64
"""Points ahead within which the next is looked for one by one; farther, by halves. It decides nothing but speed."""


def periodic(x: FloatArray, points: FloatArray, values: FloatArray) -> FloatArray:
    """Values at ``x`` of the curve drawn straight between ``points`` (m,), rising from 0 to the period, where it has
    ``values`` (m,). Samples of a recording follow one another, so each is looked for from where the last one was."""
    x = np.asarray(x, dtype=np.float64)
    return _periodic(x.ravel(), points, values).reshape(x.shape)


@compiled
def _periodic(x: FloatArray, points: FloatArray, values: FloatArray) -> FloatArray:
    out = np.empty(x.size)
    last = points.size - 2
    period = points[last + 1]
    j = 0
    for k in range(x.size):
        place = x[k] - period * math.floor(x[k] / period)
        if place < points[j] or (j < last and place > points[min(j + NEAR, last)]):
            low, high = 0, last
            while low < high:
                middle = (low + high + 1) // 2
                if points[middle] <= place:
                    low = middle
                else:
                    high = middle - 1
            j = low
        while j < last and place >= points[j + 1]:
            j += 1
        share = (place - points[j]) / (points[j + 1] - points[j])
        out[k] = values[j] + share * (values[j + 1] - values[j])
    return out
