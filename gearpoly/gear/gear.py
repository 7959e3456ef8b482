"""What a spur gear is, before anybody made it: ISO 21771 quantities of one deviation-free gear."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

from gearpoly.errors import GeometryError
from gearpoly.gear.rack import Rack


def inv(alpha: float) -> float:
    """The involute function inv(alpha) = tan(alpha) - alpha, in rad (ISO 21771:2007, 4.3.2)."""
    return math.tan(alpha) - alpha


def inv_inverse(value: float) -> float:
    """The pressure angle in rad whose involute function is ``value`` >= 0.

    Newton on tan(alpha) - alpha; converges from above everywhere because inv is convex. Raises ``GeometryError``
    below 0, where no pressure angle exists.
    """
    if value < 0.0:
        raise GeometryError(f"no pressure angle has the involute function {value:g}")
    if value == 0.0:
        return 0.0
    # Cheng's series is within 1e-3 for small values; pi/2 bounds large ones.
    alpha = min(math.cbrt(3.0 * value), 1.5)
    for _ in range(60):
        step = (inv(alpha) - value) / math.tan(alpha) ** 2
        alpha = min(max(alpha - step, 0.1 * alpha), 0.5 * (alpha + 0.5 * math.pi))
        # 1e-16 relative is the float64 floor; one more step cannot change the result.
        if abs(step) <= 1e-16 * alpha:
            break
    return alpha


@dataclass(frozen=True, kw_only=True)
class Gear:
    """An external involute spur gear as ISO 21771 defines it; lengths in mm, angles in rad.

    ``z`` teeth, module ``m``, profile shift coefficient ``x``, face width ``b`` (None where nothing needs it),
    ``d_bore`` the bore's diameter (None: half the root diameter).

    Raises ``GeometryError`` where such a gear has no tooth left.
    """

    z: int
    m: float
    x: float = 0.0
    rack: Rack = field(default_factory=Rack)
    b: float | None = None
    d_bore: float | None = None

    def __post_init__(self) -> None:
        if self.r_f <= 0.0:
            raise GeometryError(
                f"z = {self.z}, x = {self.x:g}: the root circle has no radius left (r_f = {self.r_f:.3f} mm); "
                "use more teeth, more profile shift or less dedendum"
            )
        if self.r_a <= self.r_f:
            raise GeometryError(
                f"the root circle (r_f = {self.r_f:.3f} mm) lies above the tip (r_a = {self.r_a:.3f} mm); "
                "addendum + dedendum must be positive"
            )
        if self.r_a <= self.r_b:
            raise GeometryError(
                f"z = {self.z}, x = {self.x:g}: the tip circle (r_a = {self.r_a:.3f} mm) lies inside the base circle "
                f"(r_b = {self.r_b:.3f} mm), so no involute is left; use more profile shift or addendum"
            )
        if self.psi(self.r_a) <= 0.0:
            raise GeometryError(
                f"z = {self.z}, x = {self.x:g}: the tooth comes to a point below the tip circle "
                f"(d_a = {2 * self.r_a:.3f} mm); use less profile shift or addendum"
            )
        if self.d_bore is not None and self.d_bore >= 2.0 * self.r_f:
            raise GeometryError(
                f"the bore ({self.d_bore:g} mm) cuts through the root circle (d_f = {2 * self.r_f:.3f} mm)"
            )

    @property
    def alpha(self) -> float:
        """Pressure angle at the reference circle."""
        return self.rack.alpha

    @property
    def r(self) -> float:
        """Reference radius, d/2 = z m / 2 (ISO 21771:2007, 4.2.4)."""
        return 0.5 * self.z * self.m

    @property
    def r_b(self) -> float:
        """Base radius, r cos(alpha)."""
        return self.r * math.cos(self.alpha)

    @property
    def r_a(self) -> float:
        """Tip radius, r + (h_aP + x) m: no shortening."""
        return self.r + (self.rack.h_aP + self.x) * self.m

    @property
    def r_f(self) -> float:
        """Root radius, r - (h_fP - x) m."""
        return self.r - (self.rack.h_fP - self.x) * self.m

    @property
    def tau(self) -> float:
        """Angular pitch, 2 pi / z."""
        return 2.0 * math.pi / self.z

    @property
    def p_b(self) -> float:
        """Base pitch, pi m cos(alpha)."""
        return math.pi * self.m * math.cos(self.alpha)

    @property
    def s(self) -> float:
        """Tooth thickness along the reference circle, m (pi/2 + 2 x tan(alpha))."""
        return self.m * (0.5 * math.pi + 2.0 * self.x * math.tan(self.alpha))

    @property
    def psi_b(self) -> float:
        """Half the angular tooth thickness at the base circle, s/d + inv(alpha)."""
        return self.s / (2.0 * self.r) + inv(self.alpha)

    @property
    def l_a(self) -> float:
        """Roll length at the tip, sqrt(r_a^2 - r_b^2)."""
        return self.roll_length(self.r_a)

    @property
    def l_pitch(self) -> float:
        """Roll length at the reference circle, r sin(alpha)."""
        return self.r * math.sin(self.alpha)

    @cached_property
    def k_span(self) -> int:
        """Teeth spanned by the base tangent length, round(z alpha_y/pi + 1/2) near the flank's middle (ISO
        21771:2007, 7.3)."""
        r_y = self.r + self.x * self.m
        alpha_y = math.acos(min(1.0, self.r_b / r_y))
        k = self.z / math.pi * (math.tan(alpha_y) - 2.0 * self.x * math.tan(self.alpha) / self.z - inv(self.alpha))
        # Halves go up, as in the handbooks' tables (3 teeth for z = 18); 1e-9 keeps them from falling in binary.
        return max(2, min(self.z - 1, math.floor(k + 1.0 + 1e-9)))

    @property
    def W_k(self) -> float:
        """Base tangent length over ``k_span`` teeth, (k - 1) p_b + s_b (ISO 21771:2007, 7.3)."""
        return (self.k_span - 1) * self.p_b + 2.0 * self.r_b * self.psi_b

    def roll_length(self, r_y: float) -> float:
        """Length in mm of the generating base tangent at radius ``r_y`` in mm, sqrt(r_y^2 - r_b^2); 0 at and below
        the base circle."""
        return math.sqrt(max(0.0, (r_y - self.r_b) * (r_y + self.r_b)))

    def psi(self, r_y: float) -> float:
        """Half the angular tooth thickness in rad at radius ``r_y`` >= r_b in mm, psi_b - inv(alpha_y)."""
        xi = self.roll_length(r_y) / self.r_b
        return self.psi_b - (xi - math.atan(xi))
