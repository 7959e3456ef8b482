"""How far a tooth gives under the load on its flank, by one of several laws.

A law is a module of this package that holds ``LAW``, a ``ComplianceLaw`` of the module's own name:
a new law is a new file and nothing else. ``law_names`` lists them; ``tooth_compliance`` applies
one.
"""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache
from typing import Literal

import numpy.typing as npt

from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.compliance.beam import LoadPoints, load_points
from gearpoly.mesh.compliance.contact import ContactPair, Flattening, contact_deflection, find_flattening
from gearpoly.mesh.compliance.law import Blank, ComplianceLaw
from gearpoly.mesh.compliance.outline import Mate, ToothSection, tooth_section
from gearpoly.units import FloatArray

__all__ = [
    "Blank",
    "ComplianceLaw",
    "ContactPair",
    "Flattening",
    "LoadPoints",
    "Mate",
    "ToothSection",
    "contact_deflection",
    "find_flattening",
    "find_law",
    "law_names",
    "load_points",
    "tooth_compliance",
    "tooth_section",
]


@cache
def _laws() -> dict[str, ComplianceLaw]:
    modules = (importlib.import_module(f"{__name__}.{info.name}") for info in pkgutil.iter_modules(__path__))
    found = (getattr(module, "LAW", None) for module in modules)
    return {law.name: law for law in found if isinstance(law, ComplianceLaw)}


def law_names() -> tuple[str, ...]:
    """Names of the laws that there are, sorted."""
    return tuple(sorted(_laws()))


def find_law(name: str) -> ComplianceLaw:
    """The law of that name; ``OutOfRangeError`` names the others where there is none."""
    try:
        return _laws()[name]
    except KeyError:
        raise OutOfRangeError(f"no compliance law {name!r}; there are {', '.join(law_names())}") from None


def tooth_compliance(
    section: ToothSection,
    *,
    radius: npt.ArrayLike,
    face_width: float,
    youngs_modulus: float,
    poisson_ratio: float,
    law: str = "cantilever",
    flank: Literal["drive", "coast"] = "drive",
) -> FloatArray:
    """How far the load point gives along the line of action per unit load on one tooth, contact not
    included.

    ``radius`` (k,) in mm on the flank named; ``face_width`` in mm, ``youngs_modulus`` in MPa.
    Returns mm/N, (k,) for a section of one tooth and (z, k) for a section of z teeth. Where
    ``find_law(law).includes_contact``, the number is half a pair's with contact.

    Raises ``OutOfRangeError`` for a width, a material or a radius that is none, ``GeometryError``
    where the law wants to know more of the gear.
    """
    chosen = find_law(law)
    blank = Blank(b=face_width, E=youngs_modulus, nu=poisson_ratio)
    values = chosen.compliance(section, load_points(section, radius, flank), blank)
    return values[0] if section.single else values
