"""The catalogue: what a simulation may leave out. One physics, one file, found without registration.

A module of this package that holds ``PHYSICS`` is a physics: a change of the pair file that the ordinary exact kernel
then predicts, and, where many places are to be searched, a fast first-order effect of the same change. Other installed
packages bring theirs by entry points of the group ``gearpoly.physics``.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable
from functools import cache

from gearpoly.physics.base import Physics
from gearpoly.physics.brought import brought


@cache
def catalogue() -> dict[str, Physics]:
    """All physics by name, in the order of their names."""
    modules = (importlib.import_module(f"{__name__}.{info.name}") for info in pkgutil.iter_modules(__path__))
    found = (getattr(module, "PHYSICS", None) for module in modules)
    own = {physics.name: physics for physics in found if isinstance(physics, Physics)}
    return dict(sorted((own | brought(own)).items()))


def in_order(known: Iterable[Physics]) -> list[Physics]:
    """Physics in the order in which they come in the life of a pair."""
    return sorted(known, key=lambda one: (one.rank, one.name))
