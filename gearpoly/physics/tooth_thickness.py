"""Teeth that are thinner or thicker than declared: their coast flanks stand elsewhere."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from gearpoly.keys.edit import gear_section, on_gear
from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import MADE, Physics, Quantity, Scope
from gearpoly.physics.bounds import half_tooth
from gearpoly.physics.place import Place, Values
from gearpoly.physics.sheet import added
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import own_of, plain
from gearpoly.units import UM, FloatArray


def _places(scope: Scope) -> Iterable[Place]:
    if "coast" in scope.flanks and "drive" in scope.flanks:
        yield Place(gear=0)
        yield Place(gear=1)


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    if not scene.samples.coast:
        return np.zeros(scene.samples.size)
    gear = place.gear or 0
    more = values[0] * UM * math.cos(scene.gear(gear).alpha)
    return scene.deviated(gear, lambda tooth, l: np.full(tooth.shape, more))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    section = gear_section(file, place.gear)
    more = values[0] * math.cos(math.radians(section.pressure_angle_deg))
    return on_gear(file, place.gear, inspection=added(file, place.gear, "pitch_coast_um", more))


PHYSICS = Physics(
    name="tooth_thickness",
    rank=MADE + 4,
    source="ISO 1328-1 and ISO 21771: deviation along the reference circle",
    stands="[driving.inspection]: tooth_thickness_um, pitch_coast_um",
    parameters=("deviation_um",),
    case=(Place(gear=1), (9.0,)),
    coordinates=(
        Quantity(
            name="deviation_um",
            unit="um",
            most=half_tooth,
            why="of a tooth thinner by more on either side nothing is left",
        ),
    ),
    amplitudes=1,
    ordinary=(5.0,),
    places=_places,
    whole_gear=True,
    effect=_effect,
    write=_write,
    report=plain("deviation_um"),
    says=lambda place, v: (
        f"The teeth of the {own_of(place)} are {abs(v[0]):.1f} um {'thicker' if v[0] > 0 else 'thinner'} than declared."
    ),
    equation="the coast flank moves by E_s cos(alpha)",
)
