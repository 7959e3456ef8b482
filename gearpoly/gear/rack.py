"""The basic rack with its rounded tip, after ISO 53: the tool that gives every gear its shape."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearpoly.errors import GeometryError, told_at_most
from gearpoly.units import DEG

FULL_ROUND_LEAVES = 1e-9
"""Part that a full round leaves, so that rounding never makes its land negative."""


@dataclass(frozen=True, kw_only=True)
class Rack:
    """A standard basic rack tooth profile, in multiples of the module.

    Profile A of ISO 53:1998, Table 2, is the default. ``alpha`` is the pressure angle in rad, ``h_aP`` the addendum
    and ``h_fP`` the dedendum of the gear that the rack makes, ``rho_fP`` the radius of its root fillet, that is, of
    the tip of the cutting rack (all dimensionless, times m).

    Raises ``GeometryError`` where the tip round does not fit between the two flanks of the cutting tooth.
    """

    alpha: float = 20.0 * DEG
    h_aP: float = 1.0
    h_fP: float = 1.25
    rho_fP: float = 0.38

    def __post_init__(self) -> None:
        if self.rho_fP_max < 0.0:
            raise GeometryError(
                f"dedendum = {self.h_fP:g}: at this pressure angle the flanks of the cutting rack's tooth meet before "
                f"that depth; a dedendum of at most {told_at_most(self.h_fP_max, 4)} would do"
            )
        if self.half_land < 0.0:
            raise GeometryError(
                f"the cutting rack's tip round root_radius = {self.rho_fP:g} does not fit its tooth; at this pressure "
                "angle "
                f"and dedendum at most {told_at_most(self.rho_fP_max, 4)} would do"
            )
        if self.depth_round < -self.h_aP:
            raise GeometryError(
                f"root_radius = {self.rho_fP:g} is larger than the whole rack tooth; use at most "
                f"{told_at_most(self.rho_fP_max, 4)}"
            )

    @property
    def depth_round(self) -> float:
        """Depth of the centre of the tip round below the datum line, h_fP - rho_fP, in modules."""
        return self.h_fP - self.rho_fP

    @property
    def half_land(self) -> float:
        """Half the width of the flat between the two tip rounds of the cutting tooth, in modules (0: full radius)."""
        width = math.pi / 4.0 - self.depth_round * math.tan(self.alpha) - self.rho_fP / math.cos(self.alpha)
        # A full radius leaves 0 up to rounding of 1e-16; no tool is made to 1e-12 of its module.
        return 0.0 if abs(width) < 1e-12 else width

    @property
    def rho_fP_max(self) -> float:
        """The largest tip round that fits, in modules."""
        return largest_round(alpha=self.alpha, h_fP=self.h_fP)

    @property
    def h_fP_max(self) -> float:
        """The largest dedendum of a rack whose tip is sharp, in modules: (pi/4)/tan(alpha), cut a little short."""
        return math.floor(1e4 * math.pi / 4.0 / math.tan(self.alpha)) / 1e4


def largest_round(*, alpha: float, h_fP: float) -> float:
    """The largest tip round of a rack of pressure angle ``alpha`` in rad and dedendum ``h_fP``, in modules: full
    radius, no land left (derived here)."""
    return (math.pi / 4.0 - h_fP * math.tan(alpha)) * math.cos(alpha) / (1.0 - math.sin(alpha))


def free_round(*, alpha: float, h_fP: float, h_aP: float) -> float:
    """The largest tip round of a rack that leaves the mate's tip free, in modules, below 0 where none does.

    The straight flank of a rack of dedendum ``h_fP`` ends (1 - sin(alpha)) rho above its tip, and the mate's tip, of
    addendum ``h_aP``, must not work below that: rho <= (h_fP - h_aP)/(1 - sin(alpha)). Exact for racks; teeth of finite
    number have some room left, since the path of contact ends before the mate's tip is as deep (derived here).
    """
    return (h_fP - h_aP) / (1.0 - math.sin(alpha))


STANDARD = 1e-4
"""In modules. Profile A of ISO 53 has a round of 0.38 where 0.25/(1 - sin(20 deg)) = 0.37995 is free: the standard's
two decimals, which no default is to lose."""


def usual_round(*, alpha: float, h_fP: float, h_aP: float | None = None) -> float:
    """The tip round where none is stated, in modules: that of ISO 53 profile A, or the largest that fits and leaves the
    tip of a mate of addendum ``h_aP`` free (None: whatever the mate). Never below 0."""
    usual = Rack.rho_fP
    if h_aP is not None:
        free = free_round(alpha=alpha, h_fP=h_fP, h_aP=h_aP)
        usual = usual if free >= usual - STANDARD else free
    return max(0.0, min(usual, (1.0 - FULL_ROUND_LEAVES) * largest_round(alpha=alpha, h_fP=h_fP)))
