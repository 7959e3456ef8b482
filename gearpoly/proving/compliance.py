"""Three compliance laws of a tooth and its contact, so that no case rests on one of them.

`sainsot`: potential energy of a tapered beam on the true involute outline with a rounded fillet, elastic gear body
after Sainsot, Velex and Duverger (J. Mech. Des. 126, 2004), contact linear in load (4 (1 - nu^2) / (pi E b)).
`weber`: bending, shear and compression of the same outline in plane strain with the half-plane body of Weber and
Banaschek (1953), contact by their logarithm. `palmgren`: a trapezoid from root to tip, Weber's body, contact after
Palmgren."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import asin, atan2, cos, log, pi, sin, sqrt, tan

import numpy as np
from scipy.interpolate import CubicSpline

from gearpoly.proving.gears import FloatArray, IdealGear, IdealPair

BENCH_LAWS = ("sainsot", "weber", "palmgren")
NODES = 161
"""Nodes of the table of compliance over the roll length; linear between them is right to 1e-4 of the value."""

_SAINSOT = {  # polynomials in theta_f (rad) and h = r_f / bore radius; table 1 of the 2004 paper
    "L": (-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045),
    "M": (60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086),
    "P": (-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236),
    "Q": (-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904),
}


@dataclass(frozen=True, kw_only=True)
class Compliance:
    """Compliance of one pair of teeth.

    l_1, c_1 and l_2, c_2: roll length in mm and compliance of a single tooth along the line of action in mm/N
    (bending and body). Contact: deflection / force = h_0 F^-q + h_1 ln(h_2 / (F rho)), rho the relative radius of
    curvature in mm."""

    l_1: FloatArray
    c_1: FloatArray
    l_2: FloatArray
    c_2: FloatArray
    h_0: float
    q: float
    h_1: float
    h_2: float

    def contact(self, force: float, rho: float) -> float:
        """Compliance in mm/N of the contact under a force in N."""
        return float(self.h_0 * force**-self.q + self.h_1 * log(self.h_2 / (force * rho)))

    def single(self, l_1: float, l_2: float, force: float) -> float:
        """Compliance in mm/N of one pair touching at roll lengths in mm, under a force in N."""
        teeth = np.interp(l_1, self.l_1, self.c_1) + np.interp(l_2, self.l_2, self.c_2)
        return float(teeth) + self.contact(force, l_1 * l_2 / (l_1 + l_2))


def beam(x: FloatArray, half: FloatArray, *, y_load: float, slant: float, b: float, E: float, nu: float) -> float:
    """Deflection along the load per unit load (mm/N) of a cantilever of varying depth, by its potential energy.

    x (mm) runs from the clamped end to the load; half: half the depth there (mm); y_load: height of the load's point
    above the centre line (mm); slant: angle of the load to the transverse axis (rad), its axial part pressing towards
    the clamp."""
    arm = (x[-1] - x) * cos(slant) - y_load * sin(slant)
    area, inertia = 2 * half * b, b * (2 * half) ** 3 / 12
    density = arm**2 / (E * inertia) + 1.2 * 2 * (1 + nu) * cos(slant) ** 2 / (E * area) + sin(slant) ** 2 / (E * area)
    return float(np.trapezoid(density, x))


@lru_cache(maxsize=64)
def _outline(gear: IdealGear, trapezoid: bool) -> tuple[FloatArray, FloatArray]:
    """Height over the gear's centre and half depth (mm) of a tooth from the root circle to the tip."""
    low = max(gear.r_b, sqrt(gear.r_b**2 + max(gear.l_form, 0.0) ** 2))
    radius = np.linspace(low, gear.r_a, 120)
    angle = np.array([gear.half_angle(float(r)) for r in radius])
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    rho = gear.rho_f * gear.m
    root = np.linspace(gear.r_f, x[0], 60)[:-1]
    above = np.minimum(root - gear.r_f, rho)
    fillet = y[0] + rho - np.sqrt(np.maximum(rho**2 - (rho - above) ** 2, 0.0))
    x, y = np.concatenate([root, x]), np.concatenate([fillet, y])
    if trapezoid:
        foot = gear.r_f + 0.5 * rho
        width = float(np.interp(foot, x, y))
        y = width + (y[-1] - width) * (x - foot) / (x[-1] - foot)
        x, y = np.append(foot, x[x > foot]), np.append(width, y[x > foot])
    return x, y


def tooth(gear: IdealGear, l: float, *, law: str, E: float, nu: float) -> float:
    """Compliance in mm/N of one tooth and its body, loaded along the line of action at roll length l in mm."""
    radius = sqrt(gear.r_b**2 + l * l)
    alpha = atan2(l, gear.r_b)
    psi = gear.half_angle(radius)
    slant = alpha - psi  # the normal leaves the transverse axis by this angle
    x_load, y_load = radius * cos(psi), radius * sin(psi)
    x, y = _outline(gear, law == "palmgren")
    fine = np.linspace(x[0], x_load, 400)
    half = np.interp(fine, x, y)
    foot = float(half[0])
    # Where the load's line meets the centre line, above the root.
    u = x_load - y_load * tan(slant) - x[0]
    if law == "sainsot":
        bending = beam(fine, half, y_load=y_load, slant=slant, b=gear.b, E=E, nu=nu)
        theta, h = asin(foot / gear.r_f), gear.r_f / (gear.bore / 2)
        s = {
            name: A / theta**2 + B * h * h + C * h / theta + D / theta + G * h + F
            for name, (A, B, C, D, G, F) in _SAINSOT.items()
        }
        ratio = u / (2 * foot)
        body = s["L"] * ratio**2 + s["M"] * ratio + s["P"] * (1 + s["Q"] * tan(slant) ** 2)
        return float(bending + cos(slant) ** 2 / (E * gear.b) * body)
    strain = (1 - nu * nu) / (E * gear.b) * cos(slant) ** 2
    reach = x_load - y_load * tan(slant) - fine
    depth = 2 * half
    bend = float(np.trapezoid(12 * reach**2 / depth**3, fine))
    shear = (2.4 / (1 - nu) + tan(slant) ** 2) * float(np.trapezoid(1 / depth, fine))
    ratio = u / (2 * foot)
    body = 18 / pi * ratio**2 + 2 * (1 - 2 * nu) / (1 - nu) * ratio
    body += 4.8 / pi * (1 + (1 - nu) / 2.4 * tan(slant) ** 2)
    return float(strain * (bend + shear + body))


def compliance(
    pair: IdealPair, *, law: str = "sainsot", scale: float = 1.0, E: float = 206000.0, nu: float = 0.3
) -> Compliance:
    """The compliance of a pair after one of `BENCH_LAWS`; scale multiplies the teeth, not the contact. E in MPa."""
    tables: list[FloatArray] = []
    for index in (1, 2):
        gear = pair.gear(index)
        l = np.linspace(0.9 * pair.l_start(index), gear.l_tip, NODES)
        coarse = l[::8]
        c = np.array([tooth(gear, float(v), law=law, E=E, nu=nu) for v in coarse])
        tables += [l, scale * np.asarray(CubicSpline(coarse, c)(l))]
    b = min(pair.driving.b, pair.driven.b)
    h_0 = q = h_1 = 0.0
    h_2 = 1.0
    if law == "sainsot":
        h_0 = 4 * (1 - nu * nu) / (pi * E * b)
    elif law == "weber":
        h_1 = 2 * (1 - nu * nu) / (pi * E * b)
        width = 8 * (1 - nu * nu) / (pi * b * E)  # half contact width squared over (F rho)
        depths = [g.half_angle(g.r) * g.r for g in (pair.driving, pair.driven)]
        h_2 = 4 * depths[0] * depths[1] / width * float(np.exp(-nu / (1 - nu)))
    elif law == "palmgren":
        h_0, q = 1.275 / (E**0.9 * b**0.8), 0.1
    else:
        raise ValueError(f"no compliance law {law!r}; there are {', '.join(BENCH_LAWS)}")
    return Compliance(l_1=tables[0], c_1=tables[1], l_2=tables[2], c_2=tables[3], h_0=h_0, q=q, h_1=h_1, h_2=h_2)
