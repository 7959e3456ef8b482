"""Single-flank composite deviations of each gear of a pair, read off the pair's TE, and the grade that allows them.

A rig would roll each gear on a master. Here the mate stands for one: over a whole hunting cycle every tooth of a gear
meets every tooth of its mate, so the mean over all mates of the TE that belongs to one tooth leaves the gear's own
curve over one revolution, beside a part with the period of one mesh that both gears share.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from gearpoly.errors import OutOfRangeError
from gearpoly.gear.tolerances import RANGES, tolerances
from gearpoly.units import UM, FloatArray


def own_curve(te: FloatArray, *, z: int, per_mesh: int) -> FloatArray:
    """TE over one revolution (z per_mesh,) of the gear with ``z`` teeth, mean over all its mates' teeth.

    ``te`` (N,) over a whole hunting cycle at ``per_mesh`` positions a pitch, any unit. Derived here.
    """
    by_mesh = te.reshape(-1, per_mesh)
    return np.asarray(by_mesh.reshape(-1, z, per_mesh).mean(axis=0).ravel())


def total_composite(curve: FloatArray) -> float:
    """F_i' of a gear's ``curve`` over one revolution: its range (ISO 1328-1:1995, 3.3.1)."""
    return float(np.ptp(curve))


def tooth_composite(curve: FloatArray, *, per_mesh: int) -> float:
    """f_i' of a gear's ``curve`` over one revolution: its greatest range within one pitch (ISO 1328-1:1995, 3.3.2)."""
    size = per_mesh + 1
    span = maximum_filter1d(curve, size, mode="wrap") - minimum_filter1d(curve, size, mode="wrap")
    return float(np.max(span))


def composite_tolerances(*, d: float, m: float, grade: int, edition: int, eps_alpha: float) -> tuple[float, float]:
    """F_i' and f_i' in mm that a ``grade`` allows a gear of reference diameter ``d`` and module ``m`` in mm, unrounded.

    1995, Annex A: f_i' = K (4.3 um at grade 5 + f_pt + F_alpha), K = 0.2 (eps + 4)/eps below eps = 4, else 0.4.
    2013, Annex D: f_is = (0.375 m + 5) um at class 5, for a gear whose design transmits evenly. Both: F_i' = F_p +
    f_i'. Formulas quoted from works that cite the standards, not read in print. Raises ``OutOfRangeError`` outside the
    edition's ranges.
    """
    limit = tolerances(d=d, m=m, grade=grade, edition=edition, rounded=False)
    step = math.sqrt(2.0) ** (grade - 5)
    if edition == 2013:
        f_i = (0.375 * m + 5.0) * step * UM
    else:
        K = 0.2 * (eps_alpha + 4.0) / eps_alpha if eps_alpha < 4.0 else 0.4
        f_i = K * (4.3 * step * UM + limit.f_pT + limit.F_alphaT)
    return limit.F_pT + f_i, f_i


def grade_of(value: float, which: int, *, d: float, m: float, edition: int, eps_alpha: float) -> float:
    """The finest grade whose F_i' (``which`` 0) or f_i' (1) is at least ``value`` in mm.

    One more than the edition's last grade where none is; nan where the edition does not hold for such a gear.
    """
    low, high = (int(bound) for bound in RANGES[edition]["grade"])
    try:
        for grade in range(low, high + 1):
            if value <= composite_tolerances(d=d, m=m, grade=grade, edition=edition, eps_alpha=eps_alpha)[which]:
                return float(grade)
    except OutOfRangeError:
        return math.nan
    return float(high + 1)
