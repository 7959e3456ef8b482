"""The tooth is a cantilever of changing section, held in an elastic rim.

Bending, shear and axial compression of the transverse elements (Q_b), and the give of the rim
(Q_f).
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from gearpoly.mesh.compliance.beam import LoadPoints, beam_integrals
from gearpoly.mesh.compliance.law import Blank, ComplianceLaw
from gearpoly.mesh.compliance.outline import ToothSection
from gearpoly.units import BoolArray, FloatArray

Form = Literal["symmetric", "published"]
"""Of the beam integrals: which of two ways the moment of the load is written in."""

PLANE_STRAIN_FROM = 5.0
"""Face width over pitch-point thickness above which a tooth is in plane strain; Cornell (1981)."""


def is_wide(section: ToothSection, blank: Blank) -> BoolArray:
    """Whether the gear is in plane strain, (1, 1): one answer for all its teeth, by their mean thickness.

    Judged tooth by tooth, a thinner tooth near the limit would count as wide and come out stiffer than its neighbours.
    """
    return np.full((1, 1), blank.b / float(np.mean(section.H_p)) > PLANE_STRAIN_FROM)


def foundation(
    *,
    arm: FloatArray,
    h: FloatArray,
    beta: FloatArray,
    wide: BoolArray,
    blank: Blank,
) -> FloatArray:
    """Give of the rim under the beam's end, mm/N along the load, (z, k).

    ``arm`` (z, k) mm: Cornell's l, from the beam's end to where the line of load meets the centre
    line; ``h`` (z, 1) mm: thickness at that end. Source: Cornell (1981), rotation term 16.67/pi
    after O'Donnell (1960).
    """
    nu = blank.nu
    lever = arm / h
    squeeze = 1.534 * (1.0 + np.tan(beta) ** 2 / (2.4 * (1.0 + nu)))
    strain = (1.0 - nu**2) * (5.306 * lever**2 + 2.0 * (1.0 - nu - 2.0 * nu**2) / (1.0 - nu**2) * lever + squeeze)
    stress = 5.306 * lever**2 + 2.0 * (1.0 - nu) * lever + squeeze
    return np.cos(beta) ** 2 / (blank.E * blank.b) * np.where(wide, strain, stress)


def compliance(
    section: ToothSection,
    load: LoadPoints,
    blank: Blank,
    *,
    form: Form = "symmetric",
) -> FloatArray:
    """Q_b + Q_f in mm/N along the line of action, (z, k).

    ``form="symmetric"`` follows from the strain energy (Castigliano): per unit load a section at x
    carries the moment cos(beta) [(x_j - x) - tan(beta) Y_j], the shear cos(beta) and the thrust
    sin(beta); Q_b is the sum of the three energies, so it cannot be negative, and moving the load
    up its own line to the centre line leaves the bending as it is. Shear uses the true G =
    E/(2(1+nu)) in plane strain as well.

    ``form="published"`` is Eqs. 8-11 of the study in docs/explanation/paper.md in the limit of fine elements:
    half of that coupling in tan(beta) Y, no term in tan^2(beta) Y^2, and shear divided by
    E/(1-nu^2) where wide. On a uniform beam under a transverse load (beta = 0) its bending is
    L^3/(3 E_e I), as it should be.

    Source: Tavakoli and Houser (1986), Cornell (1981); symmetric form derived here.
    """
    wide = is_wide(section, blank)
    E_e = np.where(wide, blank.E / (1.0 - blank.nu**2), blank.E)
    tan = np.tan(load.beta)
    along = beam_integrals(section, start=section.x_e, stop=load.x)
    shear = 2.4 * (1.0 + blank.nu)
    if form == "published":
        bracket = along.I_2 - tan * load.y * along.I_1 + (shear + tan**2) * along.A
        beam = bracket / E_e
    else:
        bending = along.I_2 - 2.0 * tan * load.y * along.I_1 + (tan * load.y) ** 2 * along.I_0
        beam = (bending + tan**2 * along.A) / E_e + shear * along.A / blank.E
    Q_b = np.cos(load.beta) ** 2 * beam / blank.b
    Q_f = foundation(
        arm=load.u - section.x_e[:, None],
        h=section.h_e[:, None],
        beta=load.beta,
        wide=wide,
        blank=blank,
    )
    return Q_b + Q_f


LAW = ComplianceLaw(
    name="cantilever",
    compliance=compliance,
    source="Tavakoli and Houser (1986), Cornell (1981); energy-consistent coupling derived here",
)
