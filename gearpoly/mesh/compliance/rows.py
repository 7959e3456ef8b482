"""Straight lines between points, of many teeth at once, compiled: a gear has some tens of teeth, each with a table of
its own."""

from __future__ import annotations

import numpy as np

from gearpoly.units import FloatArray


def interpolated(x: FloatArray, at: FloatArray, values: FloatArray) -> FloatArray:
    """What ``numpy.interp`` makes of every row: (z, k) at ``x`` (z, k), of ``values`` (z, n) at places ``at`` (z, n)
    that rise along each row and may repeat."""
    from gearpoly.mesh.compliance.row_loops import interpolate  # not before a tooth bends: it imports numba

    here, places, heights = (np.ascontiguousarray(one, dtype=np.float64) for one in (x, at, values))
    out = np.empty(x.shape)
    interpolate(here, places, heights, out)
    return out
