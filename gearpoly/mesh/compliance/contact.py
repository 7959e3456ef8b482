"""How far two flanks flatten against each other: once per pair, not in proportion to the load."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.compliance.law import Blank
from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True)
class ContactPair:
    """Two flanks in contact over a common face width ``b`` in mm.

    ``E_1, E_2`` in MPa, ``nu_1, nu_2``; ``rho_1, rho_2`` radii of curvature and ``depth_1,
    depth_2`` distances from contact to tooth centre line along the load, in mm, numbers or arrays
    that fit the load; only the law ``weber_banaschek`` asks for these four.
    """

    b: float
    E_1: float
    E_2: float
    nu_1: float = 0.3
    nu_2: float = 0.3
    rho_1: npt.ArrayLike | None = None
    rho_2: npt.ArrayLike | None = None
    depth_1: npt.ArrayLike | None = None
    depth_2: npt.ArrayLike | None = None

    def __post_init__(self) -> None:
        Blank(b=self.b, E=self.E_1, nu=self.nu_1)
        Blank(b=self.b, E=self.E_2, nu=self.nu_2)


def _softness(pair: ContactPair) -> float:
    """(1-nu_1^2)/E_1 + (1-nu_2^2)/E_2 in 1/MPa."""
    return (1.0 - pair.nu_1**2) / pair.E_1 + (1.0 - pair.nu_2**2) / pair.E_2


@dataclass(frozen=True, kw_only=True)
class Flattening:
    """How far two flanks give per unit of their load W in N: level + power W^-0.1 + logarithm ln W, mm/N.

    Every law of flattening is of this form, so what shares a load knows no law by name. Numbers, or ``level`` an array
    over contacts.
    """

    level: FloatArray
    power: float = 0.0
    logarithm: float = 0.0

    def under(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Deflection in mm and its slope in mm/N under ``load`` in N.

        Unloaded, flanks touch in a line: the deflection is 0 and its slope unbounded but for a linear law.
        """
        if self.power == 0.0 and self.logarithm == 0.0:
            return self.level * load, np.broadcast_to(self.level, load.shape).copy()
        with np.errstate(divide="ignore", invalid="ignore"):
            power = self.power * load**-0.1 if self.power != 0.0 else 0.0
            log = self.logarithm * np.log(load) if self.logarithm != 0.0 else 0.0
            secant = self.level + power + log
            slope = self.level + 0.9 * power + log + self.logarithm
            return np.where(load > 0.0, secant * load, 0.0), np.where(load > 0.0, slope, np.inf)


def palmgren(pair: ContactPair) -> Flattening:
    """Deflection Q_h W, mm: Q_h = 1.275/(E_12^0.9 b^0.8 W^0.1), E_12 = 2 E_1 E_2/(E_1 + E_2).

    The slope grows without bound as the load goes to nought; the deflection does not. Palmgren's
    own roller on a flat raceway (3.84e-5 W^0.9/b^0.8 mm for steel) comes out with E_1 E_2/(E_1 +
    E_2) in place of E_12, so the published form is 0.55 of it. Source: Eq. 14 of the study in
    docs/explanation/paper.md; Palmgren (1959).
    """
    E_12 = 2.0 * pair.E_1 * pair.E_2 / (pair.E_1 + pair.E_2)
    return Flattening(level=np.zeros(()), power=1.275 / (E_12**0.9 * pair.b**0.8))


def linear(pair: ContactPair) -> Flattening:
    """Deflection in proportion to the load, 2/(pi b) [(1-nu_1^2)/E_1 + (1-nu_2^2)/E_2] W.

    Source: Yang and Sun (1985); for equal gears 4(1-nu^2)/(pi E b).
    """
    return Flattening(level=np.asarray(2.0 / (math.pi * pair.b) * _softness(pair)))


def weber_banaschek(pair: ContactPair) -> Flattening:
    """Each flank's surface moves towards a point at ``depth`` under a Hertz pressure, as in a half
    plane.

    Sum over both of 2 W (1-nu^2)/(pi E b) [ln(2 depth/a) - nu/(2(1-nu))], a the half width of the
    contact, which grows with the root of the load. Source: Weber and Banaschek (1953); the same as
    Johnson (1985), Eq. 5.57, from Hertz's pressure on a half plane.
    """
    given = (pair.rho_1, pair.rho_2, pair.depth_1, pair.depth_2)
    if any(value is None for value in given):
        raise OutOfRangeError("the contact law weber_banaschek needs rho_1, rho_2, depth_1 and depth_2")
    rho_1, rho_2, depth_1, depth_2 = (np.asarray(value, dtype=np.float64) for value in given)
    curvature = 1.0 / rho_1 + 1.0 / rho_2
    a = np.sqrt(4.0 / (math.pi * pair.b * curvature) * _softness(pair))  # half width under 1 N
    level, logarithm = np.zeros(a.shape), 0.0
    for depth, E, nu in ((depth_1, pair.E_1, pair.nu_1), (depth_2, pair.E_2, pair.nu_2)):
        unit = 2.0 * (1.0 - nu**2) / (math.pi * E * pair.b)
        level = level + unit * (np.log(2.0 * depth / a) - nu / (2.0 * (1.0 - nu)))
        logarithm -= 0.5 * unit
    return Flattening(level=level, logarithm=logarithm)


CONTACT_LAWS: dict[str, Callable[[ContactPair], Flattening]] = {
    "palmgren": palmgren,
    "linear": linear,
    "weber_banaschek": weber_banaschek,
}


def find_flattening(pair: ContactPair, *, law: str) -> Flattening:
    """How the flanks of ``pair`` flatten by the ``law`` of that name.

    Raises ``OutOfRangeError`` for a law that does not exist, or that asks for more than ``pair`` holds.
    """
    if law not in CONTACT_LAWS:
        raise OutOfRangeError(f"no contact law {law!r}; there are {', '.join(sorted(CONTACT_LAWS))}")
    return CONTACT_LAWS[law](pair)


def contact_deflection(
    load: npt.ArrayLike, pair: ContactPair, *, law: str = "palmgren"
) -> tuple[FloatArray, FloatArray]:
    """How far a pair's flanks approach under ``load`` in N (any shape): deflection in mm and slope
    in mm/N, same shape.

    Once per pair, not per tooth. The slope is what Newton's method wants; deflection over load is
    the Q_h of the study.

    Raises ``OutOfRangeError`` for a negative load or a law that does not exist.
    """
    W = np.asarray(load, dtype=np.float64)
    if not (W >= 0.0).all():
        raise OutOfRangeError("a contact only pushes: every load must be a number from 0 upwards")
    return find_flattening(pair, law=law).under(W)
