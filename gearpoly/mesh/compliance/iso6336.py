"""ISO 6336-1 knows one stiffness of a tooth pair, from tooth numbers and profile shifts only."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.errors import GeometryError, OutOfRangeError
from gearpoly.mesh.compliance.beam import LoadPoints
from gearpoly.mesh.compliance.law import Blank, ComplianceLaw
from gearpoly.mesh.compliance.outline import Mate, ToothSection
from gearpoly.units import DEG, UM, FloatArray

E_STEEL = 206000.0
"""MPa; the standard's stiffnesses are for steel on steel and go with E."""

C_M = 0.8
"""The standard's correction from theory to measured gears; not applied unless asked for."""


def single_stiffness(
    *,
    z_1: int,
    z_2: int,
    x_1: float = 0.0,
    x_2: float = 0.0,
    h_fP: float = 1.25,
    alpha_P: float = 20.0 * DEG,
    E: float = E_STEEL,
    correction: float = 1.0,
) -> float:
    """Stiffness of one spur tooth pair per face width, about its greatest over the path, in N/(mm
    um).

    ``z_1 <= z_2``; ``h_fP`` is the mean dedendum over the module, ``alpha_P`` the rack's pressure
    angle in rad, ``correction`` is ``C_M`` for the standard's rating value. Holds above 100 N/mm.
    With the rack factor C_B: 18/25 gives 15.11 * 0.975 = 14.73.

    Raises ``OutOfRangeError`` where the standard's fit was not made (x_1 >= x_2, -0.5 <= x_1 + x_2
    <= 2). Source: ISO 6336-1:2006, 9.3 (method B): q', C_B; C_R = 1 (solid disc).
    """
    if z_1 > z_2 or min(z_1, z_2) < 1:
        raise OutOfRangeError(f"tooth numbers {z_1}/{z_2}: the pinion, z_1, is the smaller one")
    if x_1 < x_2 or not -0.5 <= x_1 + x_2 <= 2.0:
        raise OutOfRangeError(
            f"profile_shift {x_1:g} of the pinion and {x_2:g} of the wheel: the stiffness of ISO 6336-1 holds where "
            "the pinion's is not below the wheel's and their sum lies between -0.5 and 2; another law of compliance "
            "would do"
        )
    q = 0.04723 + 0.15551 / z_1 + 0.25791 / z_2 - 0.00635 * x_1 - 0.11654 * x_1 / z_1
    q += -0.00193 * x_2 - 0.24188 * x_2 / z_2 + 0.00529 * x_1**2 + 0.00182 * x_2**2
    C_B = (1.0 + 0.5 * (1.2 - h_fP)) * (1.0 - 0.02 * (20.0 - alpha_P / DEG))
    return correction * C_B * E / E_STEEL / q


def compliance(section: ToothSection, load: LoadPoints, blank: Blank) -> FloatArray:
    """Half of a pair of such gears, in mm/N, (z, k): **one number, the same at every contact point
    and for every tooth**.

    It holds the contact deflection (about a quarter of it), at no stated load, so no contact law is
    to be added. Both halves of a pair are equal and add up to the standard's pair; dedenda that
    differ count by their mean, as C_B does. The pinion is the gear with fewer teeth, of equal ones
    that with more profile shift.

    Raises ``GeometryError`` where the section does not know its gear's tooth number and
    ``OutOfRangeError`` where the standard's fit was not made.
    """
    if section.teeth is None:
        raise GeometryError("the ISO 6336 law needs the number of teeth of the gear")
    m = 2.0 * section.r / section.teeth
    own = Mate(
        teeth=section.teeth,
        profile_shift=section.profile_shift,
        dedendum=(section.r - section.r_f) / m + section.profile_shift,
    )
    mate = section.mate or own
    pinion, wheel = sorted((own, mate), key=lambda gear: (gear.teeth, -gear.profile_shift))
    c_th = single_stiffness(
        z_1=pinion.teeth,
        z_2=wheel.teeth,
        x_1=pinion.profile_shift,
        x_2=wheel.profile_shift,
        h_fP=0.5 * (own.dedendum + mate.dedendum),
        alpha_P=math.acos(section.r_b / section.r),
        E=blank.E,
    )
    return np.full(load.x.shape, 0.5 * UM / (c_th * blank.b))


LAW = ComplianceLaw(
    name="iso6336",
    compliance=compliance,
    source="ISO 6336-1:2006, 9.3, without C_M",
    includes_contact=True,
)
