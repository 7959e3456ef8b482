"""The autoregressive whitening of columns and the same run backward, compiled.

A few columns are gone through one by one, once per coefficient; of many every sample is finished before the next, while
its past lies in the cache. Either way sums are taken in one order, and over slices: places that might be negative, for
all that the compiler knows, are taken one at a time, which costs five times as much.
"""

from __future__ import annotations

import numpy as np

from gearpoly.mesh.radial_search import compiled
from gearpoly.units import FloatArray

FEW = 40
"""Columns from which on they are gone through together. Of 10 000 samples and 24 coefficients 30 columns take 0.23 ms
each one by one and 0.30 together, a hundred 0.33 and 0.20."""


@compiled
def forward(values: FloatArray, ar: FloatArray, innovation: float) -> FloatArray:
    """Columns (n, m) less what the coefficients ``ar`` (p,) foretell of them from earlier samples, over ``innovation``
    in the columns' unit; the first p samples are 0."""
    n, m = values.shape
    p = ar.size
    by = ar / innovation
    out = np.zeros((n, m))
    if m < FEW:
        column, left = np.empty(n), np.empty(max(n - p, 0))
        for j in range(m):
            for i in range(n):
                column[i] = values[i, j]
            now = column[p:]
            for i in range(left.size):
                left[i] = now[i] / innovation
            for k in range(p):
                past = column[p - 1 - k : n - 1 - k]
                for i in range(left.size):
                    left[i] -= by[k] * past[i]
            for i in range(left.size):
                out[p + i, j] = left[i]
        return out
    for i in range(p, n):
        row, mine = out[i], values[i]
        for j in range(m):
            row[j] = mine[j] / innovation
        for k in range(p):
            before = values[i - 1 - k]
            for j in range(m):
                row[j] -= by[k] * before[j]
    return out


@compiled
def backward(values: FloatArray, ar: FloatArray, innovation: float) -> FloatArray:
    """The same from later samples: the transpose of ``forward``, but for the first p samples of what comes in."""
    n, m = values.shape
    by = ar / innovation
    out = np.empty((n, m))
    if m < FEW:
        column, left = np.empty(n), np.empty(n)
        for j in range(m):
            for i in range(n):
                column[i] = values[i, j]
                left[i] = values[i, j] / innovation
            for k in range(min(ar.size, n - 1)):
                later = column[k + 1 :]
                for i in range(later.size):
                    left[i] -= by[k] * later[i]
            for i in range(n):
                out[i, j] = left[i]
        return out
    for i in range(n):
        row, mine = out[i], values[i]
        for j in range(m):
            row[j] = mine[j] / innovation
        for k in range(min(ar.size, n - 1 - i)):
            after = values[i + 1 + k]
            for j in range(m):
                row[j] -= by[k] * after[j]
    return out
