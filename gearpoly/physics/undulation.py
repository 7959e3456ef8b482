"""A wave that goes on from flank to flank: a ghost order."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Literal

import numpy as np
from pydantic import Field

from gearpoly.gear.deviations import Deviations, Wave
from gearpoly.gear.gear import Gear
from gearpoly.keys.edit import gear_section, on_gear
from gearpoly.keys.kinds import Section, UmSize, field
from gearpoly.keys.sections import GearSection, PairFile
from gearpoly.physics.base import WORN, Physics, Quantity, Scope
from gearpoly.physics.bounds import half_tooth
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import own_of, phased, wave
from gearpoly.units import DEG, UM, FloatArray

LOWEST_WAVES_PER_PITCH, HIGHEST_WAVES_PER_PITCH = 1.2, 8.0
"""Waves per pitch. Slower waves are pitch or eccentricity; waves shorter than an eighth of one are hardly met."""

MOST_WAVES_PER_PITCH = 32.0
"""Waves per pitch beyond which a wave is roughness. Up to there a wave that was found may be one of the flanks, though
nobody would look for it."""


class Undulation(Section):
    """A wave on the flanks that goes on from tooth to tooth, A cos(order phi + angle): a ghost order."""

    order: int = Field(ge=1, le=100_000, description="waves per turn of the gear, a whole number from 1")
    amplitude_um: UmSize = Field(description="amplitude in um, 0 or more")
    angle_deg: float = field("phase in deg at the reference circle of tooth 0", 0.0, ge=-1e4, le=1e4)
    flank: Literal["both", "drive", "coast"] = field("which flanks carry the wave", "drive")


class GearKeys(Section):
    """What a gear says of it."""

    undulation: tuple[Undulation, ...] = field("waves on the flanks, tables", (), strict=False, fail_fast=True)


def _shapes(section: GearSection, gear: Gear, which: int) -> Deviations:
    waves: tuple[Undulation, ...] = section.undulation

    def side(name: str, turn: float) -> tuple[Wave, ...]:
        return tuple(
            Wave(
                a=wave.amplitude_um * UM,
                order=wave.order,
                phase=wave.angle_deg * DEG,
                tau=gear.tau,
                r_b=gear.r_b,
                l_pitch=gear.l_pitch,
                sense=turn * (1.0 if which == 0 else -1.0),
            )
            for wave in waves
            if wave.flank in (name, "both")
        )

    return Deviations(drive=side("drive", 1.0), coast=side("coast", -1.0))


def _places(scope: Scope) -> Iterable[Place]:
    for gear in (0, 1):
        z = scope.gears[gear].z
        for order in range(math.ceil(LOWEST_WAVES_PER_PITCH * z), math.floor(HIGHEST_WAVES_PER_PITCH * z) + 1):
            if order % z:
                for flank in sorted(set(scope.flanks), reverse=True):
                    yield Place(gear=gear, order=order, flank=flank)


def _instead(scope: Scope, place: Place) -> Iterable[Place]:
    if place.order is None or place.gear is None:
        return
    z = scope.gears[place.gear].z
    if HIGHEST_WAVES_PER_PITCH * z <= place.order <= MOST_WAVES_PER_PITCH * z:
        for flank in sorted(set(scope.flanks), reverse=True):
            yield Place(gear=place.gear, order=place.order, flank=flank)


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    if scene.samples.flank != place.flank:
        return np.zeros(scene.samples.size)
    gear, order = place.gear or 0, place.order or 1
    ideal = scene.gear(gear)
    # Contact runs up the driving flank and down the driven one; on the coast flank the other way.
    sense = scene.samples.sense * (1.0 if gear == 0 else -1.0)
    phi = scene.teeth(gear) * ideal.tau + sense * (scene.roll(gear) - ideal.l_pitch) / ideal.r_b
    return scene.moved_by(UM * (values[0] * np.cos(order * phi) + values[1] * np.sin(order * phi)))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    amplitude, angle = wave(values[0], values[1])
    flank = place.flank or "drive"
    one = Undulation.model_construct(
        order=place.order or 1, amplitude_um=amplitude, angle_deg=angle % 360.0, flank=flank
    )
    return on_gear(file, place.gear, undulation=(*gear_section(file, place.gear).undulation, one))


PHYSICS = Physics(
    name="undulation",
    rank=WORN + 2,
    source="a wave of the cutting machine that goes on from tooth to tooth, derived here",
    stands="[[driving.undulation]]: order, amplitude_um, angle_deg, flank",
    parameters=("amplitude_um", "order"),
    case=(Place(gear=0, order=29, flank="drive"), (0.7, 0.5)),
    keys={"gear": GearKeys},
    shapes=_shapes,
    coordinates=tuple(
        Quantity(name=name, unit="um", most=half_tooth, why="more than half a tooth is not there to be taken off")
        for name in ("cos_um", "sin_um")
    ),
    amplitudes=2,
    ordinary=(0.5, 0.0),
    # Between two mesh orders, where the index wheel of a cutting machine may leave a ghost.
    ordinary_orders=lambda gear: (5 * gear.z // 2,),
    places=_places,
    effect=_effect,
    instead=_instead,
    wavelike=True,
    write=_write,
    report=phased("amplitude_um"),
    says=lambda place, v: (
        f"The flanks of the {own_of(place)} carry a wave of {math.hypot(v[0], v[1]):.2f} um, "
        f"{place.order} times per turn (a ghost order)."
    ),
    equation="d = A cos(n phi + phase), phi the rotation at which a point of the flank is in contact",
)
