"""Spur gears and pairs as closed formulas in the roll length of the involute.

A point of an involute is fixed by the roll length `l`, the length of the string between the base circle and the
point. Formulas: ISO 21771:2007 (tooth thickness, tight-mesh centre distance), form circle from the rounded rack,
derived here."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import acos, cos, pi, sin, sqrt, tan

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]

MM_PER_UM = 1e-3
"""mm per um."""
RAD_PER_DEG = pi / 180.0
"""rad per degree."""


def inv(alpha: float) -> float:
    """Involute function of an angle in rad."""
    return tan(alpha) - alpha


@dataclass(frozen=True, kw_only=True)
class IdealGear:
    """An external spur gear without deviations.

    z teeth, m module in mm, alpha_deg pressure angle, x profile shift; h_a, h_f, rho_f addendum, dedendum and root
    radius of the rack over the module; b face width and bore diameter in mm.
    """

    z: int
    m: float
    alpha_deg: float = 20.0
    x: float = 0.0
    h_a: float = 1.0
    h_f: float = 1.25
    rho_f: float = 0.38
    b: float = 20.0
    bore: float = 20.0

    @property
    def alpha(self) -> float:
        """Pressure angle in rad."""
        return self.alpha_deg * RAD_PER_DEG

    @property
    def r(self) -> float:
        """Reference radius in mm."""
        return self.z * self.m / 2

    @property
    def r_b(self) -> float:
        """Base radius in mm."""
        return self.r * cos(self.alpha)

    @property
    def r_a(self) -> float:
        """Tip radius in mm, without shortening."""
        return self.r + (self.h_a + self.x) * self.m

    @property
    def r_f(self) -> float:
        """Root radius in mm."""
        return self.r - (self.h_f - self.x) * self.m

    @property
    def tau(self) -> float:
        """Pitch angle in rad."""
        return 2 * pi / self.z

    def roll(self, radius: float) -> float:
        """Roll length in mm of the flank point at a radius in mm."""
        return sqrt(max(radius * radius - self.r_b * self.r_b, 0.0))

    @property
    def l_ref(self) -> float:
        """Roll length at the reference circle in mm."""
        return self.r * sin(self.alpha)

    @property
    def l_tip(self) -> float:
        """Roll length at the tip corner in mm."""
        return self.roll(self.r_a)

    @property
    def l_form(self) -> float:
        """Roll length in mm where the rack's straight flank ends: below it lies the fillet."""
        straight = self.h_f - self.rho_f * (1 - sin(self.alpha))
        return self.l_ref - (straight - self.x) * self.m / sin(self.alpha)

    def half_angle(self, radius: float) -> float:
        """Half the angle in rad that a tooth spans at a radius in mm."""
        s = self.m * (pi / 2 + 2 * self.x * tan(self.alpha))
        alpha_y = acos(min(self.r_b / radius, 1.0))
        return s / (2 * self.r) + inv(self.alpha) - inv(alpha_y)


@dataclass(frozen=True, kw_only=True)
class IdealPair:
    """Two gears on parallel axes; `offset` in mm is added to the tight-mesh centre distance."""

    driving: IdealGear
    driven: IdealGear
    offset: float = 0.0

    @cached_property
    def alpha_w(self) -> float:
        """Working pressure angle in rad at the tight-mesh centre distance."""
        g, h = self.driving, self.driven
        wanted = inv(g.alpha) + 2 * tan(g.alpha) * (g.x + h.x) / (g.z + h.z)
        return float(brentq(lambda alpha: inv(alpha) - wanted, 0.01, 1.2, xtol=1e-15))

    @property
    def a_w(self) -> float:
        """Tight-mesh centre distance in mm."""
        return (self.driving.r_b + self.driven.r_b) / cos(self.alpha_w)

    @property
    def a(self) -> float:
        """Centre distance of the axes in mm."""
        return self.a_w + self.offset

    @property
    def p_b(self) -> float:
        """Base pitch in mm."""
        return self.driving.r_b * self.driving.tau

    def gear(self, index: int) -> IdealGear:
        """The driving gear for 1, the driven one for 2."""
        return self.driving if index == 1 else self.driven

    def l_work(self, index: int) -> float:
        """Roll length in mm at the working pitch circle of the tight mesh."""
        return self.gear(index).r_b * tan(self.alpha_w)

    def l_start(self, index: int) -> float:
        """Roll length in mm where the active profile starts: the mate's tip at tight mesh, not below the form
        circle."""
        reached = self.a_w * sin(self.alpha_w) - self.gear(3 - index).l_tip
        return max(reached, self.gear(index).l_form)

    def thickness_angle(self, index: int) -> float:
        """Angle in rad that a tooth spans at its working pitch circle."""
        gear = self.gear(index)
        return 2 * gear.half_angle(gear.r_b / cos(self.alpha_w))

    @property
    def eps(self) -> float:
        """Contact ratio of the deviation-free pair at tight mesh."""
        return (self.driving.l_tip + self.driven.l_tip - self.a_w * sin(self.alpha_w)) / self.p_b

    @property
    def hunting_turns(self) -> int:
        """Driving turns after which the same teeth meet again."""
        return int(np.lcm(self.driving.z, self.driven.z)) // self.driving.z
