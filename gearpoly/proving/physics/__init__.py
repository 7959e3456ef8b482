"""Every physics that the bench knows, one file each; a further file here is found without another edit."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules

from gearpoly.proving.physics.base import ConcealedPhysics

PHYSICS_BY_NAME: dict[str, ConcealedPhysics] = {
    found.PHYSICS.name: found.PHYSICS
    for found in (import_module(f"gearpoly.proving.physics.{info.name}") for info in iter_modules(__path__))
    if hasattr(found, "PHYSICS")
}
"""By name."""

CATALOGUE = tuple(name for name, one in PHYSICS_BY_NAME.items() if not one.outside)
"""Names of the contract's catalogue."""
