"""Flanks that rise or fall towards the tip, all teeth alike, beyond what was declared."""

from __future__ import annotations

from collections.abc import Iterable

from gearpoly.keys.edit import on_gear
from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import MADE, Physics, Quantity, Scope
from gearpoly.physics.bounds import half_tooth
from gearpoly.physics.place import Place, Values
from gearpoly.physics.sheet import added_on_both
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import own_of, plain
from gearpoly.units import UM, FloatArray


def _places(scope: Scope) -> Iterable[Place]:
    return [Place(gear=gear) for gear in (0, 1)]


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    gear = place.gear or 0
    return scene.deviated(gear, lambda tooth, l: values[0] * UM * (scene.spans[gear].u(l) - 0.5))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    return on_gear(file, place.gear, inspection=added_on_both(file, place.gear, "profile_slope", values[0]))


PHYSICS = Physics(
    name="profile_slope",
    rank=MADE + 2,
    source="ISO 1328-1:2013, profile slope deviation",
    stands="[driving.inspection]: profile_slope_um",
    parameters=("slope_um",),
    case=(Place(gear=1), (5.0,)),
    coordinates=(
        Quantity(
            name="slope_um", unit="um", most=half_tooth, why="more than half a tooth is not there to be taken off"
        ),
    ),
    amplitudes=1,
    ordinary=(3.0,),
    places=_places,
    mean_tooth=True,
    law_doubt=0.05,
    effect=_effect,
    write=_write,
    report=plain("slope_um"),
    says=lambda place, v: (
        f"All flanks of the {own_of(place)} {'rise' if v[0] > 0 else 'fall'} by {abs(v[0]):.1f} um "
        "towards the tip, beyond what was declared."
    ),
    equation="d = s (u - 1/2), u from 0 at the start of the active profile to 1 at the tip",
)
