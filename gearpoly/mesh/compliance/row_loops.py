"""The loop of ``rows``, compiled; importing this imports numba."""

from __future__ import annotations

from gearpoly.mesh.radial_search import compiled
from gearpoly.units import FloatArray


@compiled
def interpolate(x: FloatArray, at: FloatArray, values: FloatArray, out: FloatArray) -> None:
    """Fill ``out`` (z, k) with ``values`` (z, n) at ``at`` (z, n), rising, as they are at ``x`` (z, k); beyond the ends
    with those there."""
    last = at.shape[1] - 1
    for row in range(x.shape[0]):
        j = 0
        for k in range(x.shape[1]):
            here = x[row, k]
            if here <= at[row, 0]:
                out[row, k] = values[row, 0]
                continue
            if here >= at[row, last]:
                out[row, k] = values[row, last]
                continue
            # Places mostly rise: the last one found is near. Else it is sought by halving.
            if at[row, j] > here or at[row, min(j + 8, last)] <= here:
                low, high = 0, last
                while high - low > 1:
                    middle = (low + high) // 2
                    if at[row, middle] <= here:
                        low = middle
                    else:
                        high = middle
                j = low
            while at[row, j + 1] <= here:
                j += 1
            slope = (values[row, j + 1] - values[row, j]) / (at[row, j + 1] - at[row, j])
            out[row, k] = slope * (here - at[row, j]) + values[row, j]
