"""The tooth stores bending, shear and compression energy; its body is an elastic ring."""

from __future__ import annotations

import numpy as np

from gearpoly.errors import GeometryError
from gearpoly.mesh.compliance.beam import LoadPoints, beam_integrals
from gearpoly.mesh.compliance.law import Blank, ComplianceLaw
from gearpoly.mesh.compliance.outline import ToothSection
from gearpoly.units import FloatArray

# Rows L*, M*, P*, Q*; columns A..F of A/theta^2 + B h^2 + C h/theta + D/theta + E h + F.
COEFFICIENTS = np.array(
    [
        [-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045],
        [60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086],
        [-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236],
        [-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904],
    ]
)
COEFFICIENTS.setflags(write=False)

H_RANGE = (1.4, 7.0)
"""Root over bore radius for which the polynomials were fitted."""
THETA_RANGE = (0.01, 0.12)
"""Root half angle in rad for which the polynomials were fitted (down to about 26 teeth)."""


def ring_coefficients(h: float, theta_f: FloatArray) -> FloatArray:
    """L*, M*, P*, Q* of the ring, (4, ...), for root over bore radius ``h`` and root half angle
    ``theta_f`` in rad.

    Source: Sainsot, Velex and Duverger (2004), Table 1.
    """
    one = np.ones_like(theta_f)
    terms = np.stack((one / theta_f**2, one * h**2, h / theta_f, one / theta_f, one * h, one))
    return np.asarray(np.tensordot(COEFFICIENTS, terms, axes=1))


def compliance(section: ToothSection, load: LoadPoints, blank: Blank) -> FloatArray:
    """Tooth and ring in mm/N along the line of action, (z, k); E as it stands (plane stress), as
    the method is published.

    The tooth is integrated on its true section from where the fillet touches the root circle. Ring:
    ``cos^2(beta)/(E b) [L* (u/S)^2 + M* u/S + P* (1 + Q* tan^2(beta))]``, u from the root circle
    along the centre line, S = 2 r_f theta_f. Below about 26 teeth theta_f leaves the fitted range;
    the polynomials are smooth there and are used. Above, at very many
    teeth, they fail, so coefficients that are not positive are refused.

    Raises ``GeometryError`` without a bore radius or where the polynomials have lost their meaning.
    Source: Yang and Lin (1987), Sainsot, Velex and Duverger (2004).
    """
    if section.bore_radius is None:
        raise GeometryError("the potential energy law needs the bore radius: its ring foundation depends on it")
    h = section.r_f / section.bore_radius
    stars = ring_coefficients(h, section.theta_f[:, None])
    if (stars <= 0.0).any():
        raise GeometryError(
            f"the ring polynomials fail at root half angle {section.theta_f.min():.4g} rad "
            f"and root/bore ratio {h:.4g}: "
            f"fitted for {THETA_RANGE} rad and {H_RANGE}; take the cantilever law"
        )
    L, M, P, Q = stars
    tan = np.tan(load.beta)
    along = beam_integrals(section, start=section.x_f, stop=load.x)
    bending = along.I_2 - 2.0 * tan * load.y * along.I_1 + (tan * load.y) ** 2 * along.I_0
    tooth = bending + (2.4 * (1.0 + blank.nu) + tan**2) * along.A
    arm = (load.u - section.r_f) / (2.0 * section.r_f * section.theta_f[:, None])
    ring = L * arm**2 + M * arm + P * (1.0 + Q * tan**2)
    values: FloatArray = np.cos(load.beta) ** 2 / (blank.E * blank.b) * (tooth + ring)
    return values


LAW = ComplianceLaw(
    name="potential_energy",
    compliance=compliance,
    source="Yang and Lin (1987), Sainsot, Velex and Duverger (2004)",
)
