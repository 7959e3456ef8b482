"""The autoregressive whitening of columns and the same run backward, compiled.

Of columns side by side every sample is finished before the next, while its past lies in the cache; one column alone is
gone through once per coefficient, samples side by side. Either way sums are taken in one order.
"""

from __future__ import annotations

import numpy as np

from gearpoly.mesh.radial_search import compiled
from gearpoly.units import FloatArray


@compiled
def forward(values: FloatArray, ar: FloatArray, innovation: float) -> FloatArray:
    """Columns (n, m) less what the coefficients ``ar`` (p,) foretell of them from earlier samples, over ``innovation``
    in the columns' unit; the first p samples are 0."""
    n, m = values.shape
    p = ar.size
    by = ar / innovation
    out = np.zeros((n, m))
    if m == 1:
        for i in range(p, n):
            out[i, 0] = values[i, 0] / innovation
        for k in range(p):
            for i in range(p, n):
                out[i, 0] -= by[k] * values[i - 1 - k, 0]
        return out
    for i in range(p, n):
        for j in range(m):
            out[i, j] = values[i, j] / innovation
        for k in range(p):
            for j in range(m):
                out[i, j] -= by[k] * values[i - 1 - k, j]
    return out


@compiled
def backward(values: FloatArray, ar: FloatArray, innovation: float) -> FloatArray:
    """The same from later samples: the transpose of ``forward``, but for the first p samples of what comes in."""
    n, m = values.shape
    by = ar / innovation
    out = np.empty((n, m))
    if m == 1:
        for i in range(n):
            out[i, 0] = values[i, 0] / innovation
        for k in range(min(ar.size, n - 1)):
            for i in range(n - 1 - k):
                out[i, 0] -= by[k] * values[i + 1 + k, 0]
        return out
    for i in range(n):
        for j in range(m):
            out[i, j] = values[i, j] / innovation
        for k in range(min(ar.size, n - 1 - i)):
            for j in range(m):
                out[i, j] -= by[k] * values[i + 1 + k, j]
    return out
