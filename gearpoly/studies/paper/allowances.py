"""The tooth thickness deviations that a designer of the time would have taken for each grade.

The paper's own are lost with its Table 1. Its text keeps that the lower ones are nearly equal over grades 4 to 6.
"""

from __future__ import annotations

import math
from itertools import pairwise

from gearpoly.errors import OutOfRangeError
from gearpoly.gear.gear import Gear
from gearpoly.gear.tolerances import default_thickness, tolerances
from gearpoly.units import UM

SIZE_BANDS_MM = (3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0, 180.0, 250.0, 315.0, 400.0, 500.0)
"""mm. Size bands of ISO 286-1, Table 1."""

FEED: dict[int, tuple[float, int]] = {4: (1.26, 7), 5: (1.0, 8), 6: (1.26, 8)}
"""Radial feed tolerance b_r of each grade as a factor of an IT grade."""


def it_tolerance(size: float, grade: int) -> float:
    """Standard tolerance in mm of ``size`` mm: 16 i for IT7 and 25 i for IT8, i = 0.45 D^(1/3) + 0.001 D in um (ISO
    286-1, unrounded)."""
    for low, high in pairwise(SIZE_BANDS_MM):
        if size <= high:
            D = math.sqrt(low * high)
            return {7: 16.0, 8: 25.0}[grade] * (0.45 * math.cbrt(D) + 0.001 * D) * UM
    raise OutOfRangeError(f"{size:g} mm lies above the last size band, {SIZE_BANDS_MM[-1]:g} mm")


def handbook_thickness(gear: Gear, *, a: float, grade: int, edition: int) -> tuple[float, float]:
    """Upper and lower tooth thickness deviation E_sns, E_sni in mm for grades 4 to 6, ``a`` centre distance in mm.

    E_sns is half the least recommended backlash of ISO/TR 10064-2 along the tooth; E_sni = E_sns - 2 tan(alpha)
    sqrt(F_r^2 + b_r^2), runout F_r = 0.8 F_p (ISO 1328-2:1997) and radial feed b_r by grade. This is the usual rule of
    the textbooks that go with these standards, quoted and not read in print.
    """
    F_pT = tolerances(d=2.0 * gear.r, m=gear.m, grade=grade, edition=edition).F_pT
    factor, it = FEED[grade]
    E_sns, _ = default_thickness(a=a, m=gear.m, alpha=gear.alpha, F_pT=F_pT)
    T_sn = 2.0 * math.tan(gear.alpha) * math.hypot(0.8 * F_pT, factor * it_tolerance(2.0 * gear.r, it))
    return E_sns, E_sns - T_sn
