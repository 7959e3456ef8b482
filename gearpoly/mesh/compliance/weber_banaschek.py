"""The tooth bends and its root turns in a half plane, with the load moved to the centre line."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.mesh.compliance.beam import LoadPoints, beam_integrals
from gearpoly.mesh.compliance.law import Blank, ComplianceLaw
from gearpoly.mesh.compliance.outline import ToothSection
from gearpoly.units import FloatArray


def compliance(section: ToothSection, load: LoadPoints, blank: Blank) -> FloatArray:
    """Tooth and foundation in mm/N along the line of action, (z, k); plane strain at any face
    width.

    With u the height of the load on the centre line above the root section, where the fillet
    touches the root circle, and s = h_f that section's thickness:

    ``cos^2(beta)/(E b) { int [12 (1-nu^2) (u-y)^2/h^3 + (2.4 (1+nu) + (1-nu^2) tan^2(beta))/h] dy``
    ``+ (1-nu^2) [18/pi (u/s)^2 + 2(1-2nu)/(1-nu) u/s + 4.8/pi (1 + (1-nu)/2.4 tan^2(beta))] }``

    At nu = 0.3 these are the printed numbers 10.92, 3.1 (1 + 0.294 tan^2), 5.2, 1 and 1.4 (1 +
    0.294 tan^2). The bending integral ends at the load's point on the centre line, as printed.

    Source: Weber and Banaschek (1953), "Formaenderung und Profilruecknahme bei gerad- und
    schraegverzahnten Raedern".
    """
    nu = blank.nu
    strain = 1.0 - nu**2
    tan2 = np.tan(load.beta) ** 2
    # Above u a section carries no moment in this model; a low load may meet the centre line below
    # the root section.
    top = np.maximum(load.u, section.x_f[:, None])
    along = beam_integrals(section, start=section.x_f, stop=top)
    tooth = strain * along.I_2 + (2.4 * (1.0 + nu) + strain * tan2) * along.A
    arm = (load.u - section.x_f[:, None]) / section.h_f[:, None]
    turn = 18.0 / math.pi * arm**2 + 2.0 * (1.0 - 2.0 * nu) / (1.0 - nu) * arm
    shift = 4.8 / math.pi * (1.0 + (1.0 - nu) / 2.4 * tan2)
    return np.cos(load.beta) ** 2 / (blank.E * blank.b) * (tooth + strain * (turn + shift))


LAW = ComplianceLaw(name="weber_banaschek", compliance=compliance, source="Weber and Banaschek (1953)")
