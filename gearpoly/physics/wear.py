"""Flanks worn where they slide: two dips about the pitch point."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from gearpoly.gear.deviations import Deviations, Wear
from gearpoly.gear.gear import Gear
from gearpoly.keys.edit import gear_section, on_gear
from gearpoly.keys.kinds import Section, UmSize, field
from gearpoly.keys.sections import GearSection, PairFile
from gearpoly.physics.base import WORN, Physics, Quantity, Scope
from gearpoly.physics.bounds import half_tooth
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import own_of, plain
from gearpoly.units import UM, FloatArray


class GearKeys(Section):
    """What a gear says of it."""

    wear_um: UmSize = field("wear in um at the tip, none at the reference circle, 0 or more", 0.0)


def _shapes(section: GearSection, gear: Gear, which: int) -> Deviations:
    if not section.wear_um:
        return Deviations()
    worn = (Wear(section.wear_um * UM, gear.l_pitch),)
    return Deviations(drive=worn, coast=worn)


def _places(scope: Scope) -> Iterable[Place]:
    return [Place(gear=0), Place(gear=1)]


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    gear = place.gear or 0
    ideal = scene.gear(gear)
    reach = ideal.l_a - ideal.l_pitch
    return scene.deviated(gear, lambda tooth, l: -values[0] * UM * np.abs(l - ideal.l_pitch) / reach)


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    return on_gear(file, place.gear, wear_um=max(0.0, gear_section(file, place.gear).wear_um + values[0]))


PHYSICS = Physics(
    name="wear",
    rank=WORN + 1,
    source="sliding in proportion to the distance from the pitch point (Archard 1953), normalised at the tip",
    stands="driving.wear_um",
    parameters=("depth_um",),
    case=(Place(gear=0), (10.0,)),
    keys={"gear": GearKeys},
    shapes=_shapes,
    coordinates=(
        Quantity(
            name="depth_um",
            unit="um",
            low=0.0,
            most=half_tooth,
            why="more than half a tooth is not there to be worn off",
        ),
    ),
    amplitudes=1,
    ordinary=(3.0,),
    places=_places,
    mean_tooth=True,
    law_doubt=0.05,
    effect=_effect,
    write=_write,
    report=plain("depth_um"),
    says=lambda place, v: f"The flanks of the {own_of(place)} are worn by {v[0]:.1f} um at the tip.",
    equation="d = -w |l - l_pitch|/(l_tip - l_pitch)",
)
