"""A tooth that gives more than its neighbours."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from pydantic import Field

from gearpoly.keys.edit import gear_section, on_gear
from gearpoly.keys.kinds import Section, field
from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import WORN, Physics, Quantity, Scope
from gearpoly.physics.bounds import always
from gearpoly.physics.parts import Parts
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported, tooth_of
from gearpoly.units import FloatArray


class Crack(Section):
    """A tooth that gives more than its neighbours when its drive flank is loaded."""

    tooth: int = Field(ge=0, description="number of the tooth, from 0")
    compliance_factor: float = Field(
        ge=0.1, le=1000.0, description="compliance over that of the sound tooth, contact not counted"
    )


class GearKeys(Section):
    """What a gear says of it."""

    crack: tuple[Crack, ...] = field("cracked teeth, tables", (), strict=False, fail_fast=True)


def _build(file: PairFile, parts: Parts) -> Parts:
    cracks = tuple(
        (k, one.tooth, one.compliance_factor)
        for k, section in enumerate((file.driving, file.driven))
        for one in section.crack
    )
    return replace(parts, elasticity=replace(parts.elasticity, cracks=(*parts.elasticity.cracks, *cracks)))


def _places(scope: Scope) -> Iterable[Place]:
    if not scope.loaded or "drive" not in scope.flanks:
        return
    for gear in (0, 1):
        for tooth in range(scope.gears[gear].z):
            yield Place(gear=gear, tooth=tooth)


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    """A pair whose compliance grows by dc gives F dc more, and the mesh the share of it that the pair carries."""
    if scene.samples.coast or not scene.bends:
        return np.zeros(scene.samples.size)
    gear = place.gear or 0
    mine = scene.teeth(gear) == place.tooth
    return scene.moved_by(-values[0] * scene.force * np.where(mine, scene.tooth_compliance(gear), 0.0))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    crack = Crack.model_construct(tooth=place.tooth or 0, compliance_factor=max(0.1, 1.0 + values[0]))
    return on_gear(file, place.gear, crack=(*gear_section(file, place.gear).crack, crack))


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    return {"compliance_factor": (1.0 + float(values[0]), float(np.sqrt(max(covariance[0, 0], 0.0))))}


SHARE_DOUBT = 0.15
"""Half the range over all laws, in parts, of a tooth's own share in the compliance of its pair (0.35 to 0.48 at the
pitch point of 18/25 teeth): the same loss of stiffness is a larger crack of a smaller share."""

PHYSICS = Physics(
    name="tooth_crack",
    rank=WORN + 4,
    source="a factor on the compliance of one tooth, as the pair file has it; derived here",
    stands="[[driving.crack]]: tooth, compliance_factor",
    parameters=("compliance_factor",),
    case=(Place(gear=0, tooth=3), (0.6,)),
    keys={"gear": GearKeys},
    build=_build,
    coordinates=(
        Quantity(
            name="more",
            unit="1",
            low=0.0,
            most=always(100.0),
            why="a root cracked through to a fifth gives (1/0.2)^3 = 125 times as much, and breaks",
            step=0.1,
        ),
    ),
    amplitudes=1,
    ordinary=(0.3,),
    places=_places,
    law_doubt=SHARE_DOUBT,
    effect=_effect,
    write=_write,
    report=_report,
    says=lambda place, v: f"{tooth_of(place)} gives {1.0 + v[0]:.2f} times as much as it should: a crack at its root.",
    equation="the tooth's compliance times a factor, contact not counted",
)
