"""A place on one tooth where material has broken away."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from gearpoly.gear.deviations import Deviations, Pit
from gearpoly.gear.gear import Gear
from gearpoly.keys.edit import gear_section, on_gear
from gearpoly.keys.kinds import Length, Section, UmSize, broken, field
from gearpoly.keys.sections import GearSection, PairFile
from gearpoly.physics.base import WORN, Physics, Quantity, Scope
from gearpoly.physics.bounds import always, half_tooth
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported, plain, tooth_of
from gearpoly.units import UM, FloatArray

SPALL_PARTS_OF_FLANK = 8
"""Parts of the active flank on which a spall is first looked for."""

WINDOWS = tuple(
    (i, i + wide)
    for wide, by in ((1, 1), (2, 1), (4, 2), (8, 8))
    for i in range(0, SPALL_PARTS_OF_FLANK - wide + 1, by)
)
"""Where it is looked for: single parts, two neighbours, halves, all of it (a tooth worn down, which is all but a pitch
error); its edges are found later."""

WALL = 0.05
"""Modules over which the walls of a spall rise at first."""

LEAST_WALL_MM = 0.01
"""mm. Walls steeper than this show no more, nor one this near the tip circle."""

SHALLOWER = (0.1, 0.2, 0.3)
"""Parts of its depth at which a pit's bottom may lie as well: where teeth lose touch over it, a deep bowl with walls
that rise slowly looks like a shallow pit whose walls are steep where the bowl is as deep."""

PIT_REACHES_TIP_MODULES = 0.1
"""Modules from the tip circle within which a pit that ends there may as well reach over the tip: the step between is no
small one, since the tip's corner then lies as deep. Of 9 um off the upper half a pit was made that ended 0.1 mm below
the tip, and a missing tip beside it. A judgement."""

BOWL = 12.0
"""Walls that the edges of such a bowl are apart at most: at twelve its bottom is flat to 1e-5, and it is a pit,
however little of its depth teeth see."""


class Spall(Section):
    """A place on one tooth's drive flank where material has broken away."""

    tooth: int = Field(ge=0, description="number of the tooth, from 0")
    depth_um: UmSize = Field(description="depth in um, 0 or more")
    from_mm: Length = Field(description="radius in mm where it begins")
    to_mm: Length = Field(
        description="radius in mm where it ends, above from_mm; that of the tip circle: it reaches over the tip"
    )
    wall_mm: Length = field("length in mm over which its walls rise, as tanh(r/wall)", 0.05)

    @model_validator(mode="after")
    def _rises(self) -> Self:
        if self.to_mm <= self.from_mm:
            broken("to_mm", f"{self.to_mm}, not above from_mm = {self.from_mm}", "want the larger radius in to_mm")
        return self


class GearKeys(Section):
    """What a gear says of it."""

    spall: tuple[Spall, ...] = field("spalls, tables", (), strict=False, fail_fast=True)


def _shapes(section: GearSection, gear: Gear, which: int) -> Deviations:
    spalls: tuple[Spall, ...] = section.spall
    return Deviations(
        drive=tuple(
            Pit(one.depth_um * UM, one.tooth, gear.z, gear.r_b, one.from_mm, _end(gear, one.to_mm), one.wall_mm)
            for one in spalls
        )
    )


def _end(gear: Gear, r_to: float) -> float:
    """Radius in mm where a spall ends; none where it reaches the tip circle: it has no wall there, and the tip's corner
    lies as deep as its bottom. With half the depth there a missing tip was named beside 9 um off the upper half."""
    return r_to if r_to < gear.r_a - LEAST_WALL_MM else math.inf


def _places(scope: Scope) -> Iterable[Place]:
    if "drive" not in scope.flanks:
        return
    for gear in (0, 1):
        ideal, (low, high) = scope.gears[gear], scope.reach[gear]
        edges = np.hypot(np.linspace(low, high, SPALL_PARTS_OF_FLANK + 1), ideal.r_b)
        for tooth in range(ideal.z):
            for i, j in WINDOWS:
                yield Place(gear=gear, tooth=tooth, shape=(float(edges[i]), float(edges[j]), WALL * ideal.m))


def _tip(scope: Scope, place: Place) -> float:
    """mm. The tip radius."""
    return scope.gears[place.gear or 0].r_a


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    if scene.samples.coast:
        return np.zeros(scene.samples.size)
    gear = place.gear or 0
    ideal = scene.gear(gear)
    low, high = sorted(values[1:3])
    pit = Pit(
        values[0] * UM, place.tooth or 0, ideal.z, ideal.r_b, low, _end(ideal, high), max(values[3], LEAST_WALL_MM)
    )
    return scene.deviated_tooth(gear, place.tooth, pit.along)


def _otherwise(scope: Scope, place: Place, values: Values) -> Iterable[tuple[Place, Values]]:
    """A pit that ends near the tip circle as one that reaches over it; a bowl as pits with a flat bottom, whose edges
    lie where it is half as deep as they are, and rise as it does."""
    low, high, tip = *sorted(values[1:3]), _tip(scope, place)
    if tip - PIT_REACHES_TIP_MODULES * scope.gears[place.gear or 0].m < high < tip:
        yield place, (values[0], low, tip, values[3])
    depth, wall = values[0], max(values[3], values[0] * UM, LEAST_WALL_MM)  # no steeper than a pit is drawn
    middle, half = 0.5 * (values[1] + values[2]), 0.5 * abs(values[2] - values[1])
    if depth <= 0.0 or 2.0 * half > BOWL * wall:
        return
    # depth sinh(2 u) / (cosh(2 u) + cosh(2 v)), with u = half / wall and v = (r - middle) / wall.
    u = 2.0 * half / wall
    for part in SHALLOWER:
        level = 2.0 / part * math.sinh(u) - math.cosh(u)
        if level <= 1.0:
            continue  # the bowl is nowhere as deep
        v = math.acosh(level)
        steep = 2.0 * depth * math.sinh(u) * math.sinh(v) / (math.cosh(u) + level) ** 2 / wall
        edge = 0.5 * v * wall
        rise = min(max(0.5 * part * depth / steep, LEAST_WALL_MM), 1.0)
        yield place, (part * depth, middle - edge, middle + edge, rise)


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    low, high = sorted(values[1:3])
    spall = Spall.model_construct(
        tooth=place.tooth or 0,
        depth_um=max(values[0], 0.0),
        from_mm=low,
        to_mm=max(high, low + 1e-3),
        wall_mm=max(values[3], LEAST_WALL_MM),
    )
    return on_gear(file, place.gear, spall=(*gear_section(file, place.gear).spall, spall))


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    # A fit may have moved one edge past the other: the pit is between them.
    low, high = (1, 2) if values[1] <= values[2] else (2, 1)
    index = np.array([0, low, high, 3])
    return plain("depth_um", "from_mm", "to_mm", "wall_mm")(place, values[index], covariance[np.ix_(index, index)])


PHYSICS = Physics(
    name="tooth_spall",
    rank=WORN + 3,
    source="a pit with a flat bottom and walls as tanh, derived here",
    stands="[[driving.spall]]: tooth, depth_um, from_mm, to_mm, wall_mm",
    parameters=("depth_um", "from_mm", "to_mm"),
    case=(Place(gear=0, tooth=4), (6.0, 11.7, 12.5, 0.06)),
    keys={"gear": GearKeys},
    shapes=_shapes,
    coordinates=(
        Quantity(
            name="depth_um", unit="um", low=0.0, most=half_tooth, why="more than half a tooth is not there to break off"
        ),
        Quantity(name="from_mm", unit="mm", low=0.0, most=_tip, why="a flank ends at the tip", step=0.02),
        Quantity(name="to_mm", unit="mm", low=0.0, most=_tip, why="a flank ends at the tip", step=0.02),
        Quantity(
            name="wall_mm",
            unit="mm",
            low=LEAST_WALL_MM,
            most=always(1.0),
            why="a wall that rises over more is no wall of a pit",
            step=0.01,
        ),
    ),
    amplitudes=1,
    ordinary=(5.0,),
    places=_places,
    effect=_effect,
    otherwise=_otherwise,
    write=_write,
    report=_report,
    says=lambda place, v: (
        f"{tooth_of(place)} has lost {v[0]:.1f} um between the radii {min(v[1:3]):.2f} and {max(v[1:3]):.2f} mm."
    ),
    equation="d = -depth/2 [tanh((r - from)/wall) - tanh((r - to)/wall)] on one tooth",
)
