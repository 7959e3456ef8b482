"""How large a coordinate of a physics may be, beyond which it would be something else.

Each takes what is known before any search and a place, and gives a size in the coordinate's own unit. Bounds are wide:
they keep a fit where its equations mean something, and tell no likely size from an unlikely one.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from gearpoly.physics.base import Scope
from gearpoly.physics.place import Place
from gearpoly.units import UM, URAD

Bound = Callable[[Scope, Place], float]


def always(size: float) -> Bound:
    """The same ``size`` for every pair and recording."""
    return lambda scope, place: size


def _module(scope: Scope, place: Place) -> float:
    """mm. The module of the place's gear, or the smaller of both."""
    return min(gear.m for gear in scope.gears) if place.gear is None else scope.gears[place.gear].m


def module(scope: Scope, place: Place) -> float:
    """um. One module: gears whose axes are off by more have left each other's teeth, or jam."""
    return _module(scope, place) / UM


def half_tooth(scope: Scope, place: Place) -> float:
    """um. Half the thickness of a tooth, pi m/4: of a flank that is off by more, nothing is left."""
    return 0.25 * math.pi * _module(scope, place) / UM


def half_pitch(scope: Scope, place: Place) -> float:
    """urad. Half the angular pitch of the place's gear, or the lesser of both: a shaft that is read wrong by more has
    its teeth counted wrong."""
    z = max(gear.z for gear in scope.gears) if place.gear is None else scope.gears[place.gear].z
    return math.pi / z / URAD


def recorded(scope: Scope, place: Place) -> float:
    """um. How far the transmission error ranges in the place's recordings, at most: nothing in it is larger. One module
    where nothing was recorded yet."""
    these = [size for k, size in enumerate(scope.ranges) if not place.recordings or k in place.recordings]
    return max(these, default=module(scope, Place()))
