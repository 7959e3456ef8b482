"""What every compliance law is given and what it hands back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.compliance.beam import LoadPoints
from gearpoly.mesh.compliance.outline import ToothSection
from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True)
class Blank:
    """Width and material of the tooth: face width b in mm, Young's modulus E in MPa, Poisson's
    ratio nu.

    Raises ``OutOfRangeError`` where b or E is not positive or nu is that of no isotropic solid.
    """

    b: float
    E: float
    nu: float

    def __post_init__(self) -> None:
        # Written as "not (value > 0)" so that nan is refused too.
        if not self.b > 0.0:
            raise OutOfRangeError(f"face width {self.b} mm: a tooth that bends needs more than 0")
        if not self.E > 0.0:
            raise OutOfRangeError(f"Young's modulus {self.E} MPa: must be more than 0")
        if not -1.0 < self.nu < 0.5:
            raise OutOfRangeError(f"Poisson's ratio {self.nu}: must lie between -1 and 0.5")


@dataclass(frozen=True, kw_only=True)
class ComplianceLaw:
    """One way to say how far a tooth gives under a load on its flank.

    ``compliance(section, load, blank)`` returns mm/N along the line of action, shape (z, k).
    ``includes_contact`` is true where the law's number already holds the contact deflection, so
    that no contact law is to be added.
    """

    name: str
    compliance: Callable[[ToothSection, LoadPoints, Blank], FloatArray]
    source: str
    includes_contact: bool = False
