"""A tooth whose tip has broken off."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated

import numpy as np
from pydantic import Field

from gearpoly.gear.deviations import Deviations, MissingTip
from gearpoly.gear.gear import Gear
from gearpoly.gear.root import form_point
from gearpoly.keys.edit import gear_section, on_gear
from gearpoly.keys.kinds import Section, field
from gearpoly.keys.sections import GearSection, PairFile
from gearpoly.mesh.corner import corner_gap
from gearpoly.physics.base import WORN, Physics, Quantity, Scope
from gearpoly.physics.bounds import always
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported, tooth_of
from gearpoly.units import FloatArray

CHIP_PARTS_OF_FLANK = 8
"""Parts of the active flank, of which the upper ones are looked at as missing: one, two, up to all but two. Where
between them the tooth ends is found later."""

LEAST_FLANK_LEFT_MM = 0.01
"""mm. What is left of a flank above its form circle at least, so that every size within the bounds can be drawn."""


class Chip(Section):
    """The tip of one tooth is missing, on both flanks and over the whole face width; of several the highest counts."""

    tooth: int = Field(ge=0, description="number of the tooth, from 0")
    height_mm: Annotated[float, Field(ge=0.0, le=1e5)] = Field(
        description="radial height of what is missing, down from the tip circle, in mm, 0 or more"
    )


class GearKeys(Section):
    """What a gear says of it."""

    chip: tuple[Chip, ...] = field("teeth whose tip has broken off, tables", (), strict=False, fail_fast=True)


def _shapes(section: GearSection, gear: Gear, which: int) -> Deviations:
    chips: tuple[Chip, ...] = section.chip
    return Deviations(chips=tuple(MissingTip(one.tooth, one.height_mm) for one in chips))


def _places(scope: Scope) -> Iterable[Place]:
    for gear in (0, 1):
        ideal, (low, high) = scope.gears[gear], scope.reach[gear]
        ends = np.hypot(np.linspace(high, low, CHIP_PARTS_OF_FLANK + 1)[1 : CHIP_PARTS_OF_FLANK - 1], ideal.r_b)
        stated: set[int] = {one.tooth for one in scope.section(gear).chip}
        for tooth in sorted(set(range(ideal.z)) - stated):
            for end in ends.tolist():
                yield Place(gear=gear, tooth=tooth, shape=(ideal.r_a - end,), probe=(1.0,))


def _whole_flank(scope: Scope, place: Place) -> float:
    """mm. From the tip down to the form circle."""
    gear = scope.gears[place.gear or 0]
    return gear.r_a - math.hypot(gear.r_b, form_point(gear)[1]) - LEAST_FLANK_LEFT_MM


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    if values[0] <= 0.0 or values[1] <= 0.0 or place.tooth is None:
        return np.zeros(scene.samples.size)
    gear = place.gear or 0
    ends, gaps = corner_gap(scene.pair, gear, scene.gear(gear).r_a - values[1])
    return scene.standing_off(gear, place.tooth, lambda l: np.interp(l, ends, gaps, left=0.0))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    if values[0] <= 0.0:
        return file
    chip = Chip.model_construct(tooth=place.tooth or 0, height_mm=max(0.0, values[1]))
    return on_gear(file, place.gear, chip=(*gear_section(file, place.gear).chip, chip))


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    return {"height_mm": (float(values[1]), math.sqrt(max(float(covariance[1, 1]), 0.0)))}


PHYSICS = Physics(
    name="tooth_chip",
    rank=WORN + 5,
    source="ISO 21771:2007, path of contact to a lower tip circle; the corner beyond it derived here",
    stands="[[driving.chip]]: tooth, height_mm",
    parameters=("height_mm",),
    case=(Place(gear=0, tooth=3), (1.0, 0.7)),
    keys={"gear": GearKeys},
    shapes=_shapes,
    coordinates=(
        Quantity(name="present", unit="1", low=0.0, most=always(1.0), why="it is there, or it is not", switch=True),
        Quantity(
            name="height_mm",
            unit="mm",
            low=0.0,
            most=_whole_flank,
            why="a tooth without flanks above its form circle does not mesh",
            step=0.005,
        ),
    ),
    amplitudes=1,
    ordinary=(1.0,),
    common=0.5,
    places=_places,
    effect=_effect,
    write=_write,
    report=_report,
    says=lambda place, v: f"{tooth_of(place)} ends {v[1]:.2f} mm below its tip circle: its tip has broken off.",
    equation="both flanks of one tooth end at r_a - h: its path of contact at sqrt((r_a - h)^2 - r_b^2)",
)
