"""The tooth root as the rack's rounded tip leaves it: the exact trochoid, undercut included.

While the gear rolls on the rack, the normal at every point of contact passes through the pitch point. For the tip
round (centre C, radius rho, at the depth ``v_c`` below the rolling line) this gives each point of the fillet in
closed form from the direction gamma of its normal: no iteration, no approximation (derived here; ISO 6336-3:2019, 6.2
uses the same construction at one point).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from gearpoly.errors import GeometryError
from gearpoly.gear.gear import Gear
from gearpoly.units import UM, FloatArray, read_only

FILLET_CHORD_ERROR = 0.05 * UM
"""mm. How far a chord of the drawn fillet may stand off the true trochoid: half of the 0.1 um that the root is
promised to. Smaller costs points on every flank that contact never uses; larger breaks that promise."""


HIDDEN_UNDERCUT_RAD = 1e-14
"""rad. Undercut so slight (below 3e-5 of the base radius) that rounding of angles hides where trochoid and involute
cross."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Root:
    """One side of a tooth root, from the middle of the tooth space up to the true form circle.

    ``r`` (n,) radii in mm and ``psi`` (n,) angles in rad from the tooth's centre line, rising from the root circle to
    ``r_form``; ``l_form`` roll length of the true form circle in mm; ``undercut`` says that the trochoid cuts into
    the involute.
    """

    r: FloatArray
    psi: FloatArray
    l_form: float
    undercut: bool

    @property
    def n(self) -> int:
        """Points, the true form point included."""
        return int(self.r.size)


def fillet_point(gear: Gear, gamma: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The fillet where its normal stands at ``gamma`` (any shape, rad, 0 at the root circle, pi/2 - alpha at the
    flank's end).

    Returns radius in mm and the angle from the tooth's centre line in rad. Derived here.
    """
    rack, m, r = gear.rack, gear.m, gear.r
    rho = rack.rho_fP * m
    v_c = (rack.depth_round - gear.x) * m
    u_c = rack.half_land * m
    # Distance from the pitch point along the normal to the point of contact.
    q = v_c / np.cos(gamma) + rho
    roll = (v_c * np.tan(gamma) - u_c) / r
    x, y = r - q * np.cos(gamma), q * np.sin(gamma)
    # In the gear's own frame the space's middle is at angle 0, so the tooth's centre line is half a pitch away.
    return np.hypot(x, y), 0.5 * gear.tau - (np.arctan2(y, x) - roll)


def _involute_psi(gear: Gear, r: float) -> float:
    xi = gear.roll_length(r) / gear.r_b
    return gear.psi_b - (xi - math.atan(xi))


@lru_cache(maxsize=64)
def form_point(gear: Gear) -> tuple[float, float, bool]:
    """Where fillet and involute meet: the fillet's normal direction gamma in rad, the roll length l_form in mm, and
    undercut or not.

    Without undercut the two are tangent at the end of the rack's straight flank (ISO 21771:2007, 5.3 d_Ff); with
    undercut they cross, and the crossing is found to the float64 floor. Raises ``GeometryError`` where nothing of the
    involute is left.
    """
    rack, m = gear.rack, gear.m
    gamma_end = 0.5 * math.pi - gear.alpha
    v_c = (rack.depth_round - gear.x) * m
    l_tangent = gear.r * math.sin(gear.alpha) - (v_c / math.sin(gear.alpha) + rack.rho_fP * m)
    if l_tangent >= 0.0:
        gamma, l_form = gamma_end, l_tangent
    else:
        from scipy.optimize import brentq  # slow to import, and few gears are undercut

        def stands_off(gamma: float) -> float:
            radius, psi = fillet_point(gear, np.array(gamma))
            return float(psi) - _involute_psi(gear, float(radius))

        def above_base(gamma: float) -> float:
            return float(fillet_point(gear, np.array(gamma))[0]) - gear.r_b

        low = float(brentq(above_base, 0.0, gamma_end)) if above_base(gamma_end) > 0.0 else gamma_end
        if stands_off(gamma_end) <= HIDDEN_UNDERCUT_RAD:
            # They still meet where the rack's straight flank ends.
            return gamma_end, -l_tangent, True
        if stands_off(low) > 0.0:
            raise GeometryError(
                f"z = {gear.z}, x = {gear.x:g}: the root fillet and the involute do not meet; such a gear cannot be cut"
            )
        gamma = float(brentq(stands_off, low, gamma_end, xtol=1e-15, rtol=8.9e-16))
        l_form = gear.roll_length(float(fillet_point(gear, np.array(gamma))[0]))
    if l_form >= gear.l_a:
        raise GeometryError(
            f"z = {gear.z}, x = {gear.x:g}: the root fillet reaches the tip, so no involute is left; such a gear "
            "cannot be cut"
        )
    return gamma, l_form, l_tangent < 0.0


@lru_cache(maxsize=64)
def draw_root(gear: Gear, *, chord_error: float = FILLET_CHORD_ERROR) -> Root:
    """The root of ``gear`` as points that stay within ``chord_error`` (mm) of the true trochoid and of the root circle.

    Kept, since deviations of the flanks leave it as it is. Raises ``GeometryError`` where the root pinches the tooth
    to nothing.
    """
    gamma_form, l_form, undercut = form_point(gear)
    # 4000 steps resolve the curvature of every fillet to 1e-3, which only sets the density of points.
    gamma = np.linspace(0.0, gamma_form, 4001)
    radius, psi = fillet_point(gear, gamma)
    x, y = radius * np.cos(psi), radius * np.sin(psi)
    dx, dy = np.gradient(x, gamma), np.gradient(y, gamma)
    bend = np.abs(dx * np.gradient(dy, gamma) - dy * np.gradient(dx, gamma))
    speed = np.hypot(dx, dy)
    # A chord h on curvature k stands off by k h^2/8: points go as sqrt(k/8e) ds.
    density = np.sqrt(bend / np.maximum(speed, 1e-12 * gear.m) / (8.0 * chord_error))
    count = np.concatenate(([0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(gamma))))
    n = max(4, math.ceil(count[-1]) + 1)
    nodes = np.interp(np.linspace(0.0, count[-1], n), count, gamma)
    nodes[-1] = gamma_form
    radius, psi = fillet_point(gear, nodes)
    if np.min(psi) <= 0.0:
        raise GeometryError(
            f"z = {gear.z}, x = {gear.x:g}: undercut leaves no tooth at its waist; such a gear cannot be cut"
        )
    land = gear.rack.half_land * gear.m / gear.r
    psi[0] = 0.5 * gear.tau - land
    n_land = max(1, math.ceil(land / math.sqrt(8.0 * chord_error / gear.r_f)))
    angle = np.linspace(0.5 * gear.tau, float(psi[0]), n_land + 1)[:-1] if land > 0.0 else np.empty(0)
    radius = np.concatenate((np.full(angle.size, gear.r_f), radius))
    psi = np.concatenate((angle, psi))
    # The trochoid's own end carries 1e-16 of rounding; the flank starts at exactly this point.
    radius[-1] = math.hypot(gear.r_b, l_form)
    return Root(r=read_only(radius), psi=read_only(psi), l_form=l_form, undercut=undercut)
