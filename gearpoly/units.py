"""Units: mm, rad, N, N.mm and s inside; um, urad, deg, arcmin and N.m at the edge.

Multiply by a constant to come in (``8.0 * UM`` is 8 um in mm), divide by it to go out.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]

UM = 1e-3
"""mm per um."""
URAD = 1e-6
"""rad per urad."""
DEG = math.pi / 180.0
"""rad per degree."""
ARCMIN = DEG / 60.0
"""rad per minute of arc."""
ARCSEC = DEG / 3600.0
"""rad per second of arc."""
NM = 1e3
"""N.mm per N.m."""
GPA = 1e3
"""MPa (N/mm^2) per GPa."""
TURN = 2.0 * math.pi
"""rad per revolution."""
TURN_DEG = 360.0
"""Degrees per revolution."""
RPM = TURN / 60.0
"""rad/s per revolution per minute."""


def read_only(values: npt.ArrayLike) -> FloatArray:
    """A float64 copy of ``values`` that nobody can write to; frozen dataclasses hold these."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array
