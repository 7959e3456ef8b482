"""Material taken off towards the tips that nobody declared."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Literal

import numpy as np
from pydantic import Field

from gearpoly.gear.deviations import Deviations, Relief, tip_relief
from gearpoly.gear.gear import Gear
from gearpoly.keys.edit import changed, gear_section, on_gear
from gearpoly.keys.kinds import Length, Section, UmSize, field
from gearpoly.keys.sections import GearSection, PairFile
from gearpoly.physics.base import MADE, Physics, Quantity, Scope
from gearpoly.physics.bounds import half_tooth
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported, own_of, plain
from gearpoly.units import UM, FloatArray

RELIEF_POWERS = {None: 1, "linear": 1, "parabolic": 2}
"""Exponent p of -C t^p by the contract's shapes, a straight line where none is stated."""

AS_CURVE = 1.1, 1.4
"""Amount and length of the parabola that comes nearest to a line, over those of the line."""

RELIEF_LENGTHS_MODULES = (0.15, 0.25, 0.4, 0.6, 0.8)
"""Modules. Reliefs begin between the very tip and about the highest point of single contact."""

SHORTEST_RELIEF_MODULES = 0.05
"""Modules. What is taken off less of a tip is a chamfer, a burr or a smaller tip circle: only where teeth take over
would it show, as all that a simulation lacks about corners does."""

STEEPEST = 0.1
"""mm per mm of radial length. What falls steeper is a chamfer, or a tip that ends sooner than the file says: designed
reliefs come to 0.06 (60 um over 1 mm). A pair whose ``profile_shift`` the file did not know came out at 0.17."""


class TipRelief(Section):
    """Material taken off towards the tip on purpose."""

    amount_um: UmSize = Field(description="relief at the tip in um, 0 or more")
    length_mm: Length = Field(description="radial length down from the tip in mm, above 0")
    shape: Literal["linear", "parabolic"] = field("how the relief grows towards the tip", "linear")
    flank: Literal["both", "drive", "coast"] = field("which flanks are relieved", "both")


class GearKeys(Section):
    """What a gear says of it."""

    tip_relief: TipRelief | None = field("tip relief, a table")


def _shapes(section: GearSection, gear: Gear, which: int) -> Deviations:
    relief: TipRelief | None = section.tip_relief
    if relief is None:
        return Deviations()
    shape = (tip_relief(gear, amount=relief.amount_um * UM, length=relief.length_mm, shape=relief.shape),)
    return Deviations(drive=shape if relief.flank != "coast" else (), coast=shape if relief.flank != "drive" else ())


def _places(scope: Scope) -> Iterable[Place]:
    for gear in (0, 1):
        declared = scope.section(gear).tip_relief
        if declared is not None:
            # How much is off, not where it begins: the drawing's length stays.
            yield Place(gear=gear, form=declared.shape, shape=(declared.length_mm,))
            continue
        m, room = scope.gears[gear].m, scope.gears[gear].r_a - scope.gears[gear].r_b
        for length in RELIEF_LENGTHS_MODULES:
            if length * m < 0.95 * room:
                yield Place(gear=gear, form="linear", shape=(length * m,))


def _whole_flank(scope: Scope, place: Place) -> float:
    """mm. From the tip down to the base circle."""
    gear = scope.gears[place.gear or 0]
    return gear.r_a - gear.r_b


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    gear = place.gear or 0
    ideal = scene.gear(gear)
    made = scene.deviations[gear]
    mine, other = (made.coast, made.drive) if scene.samples.coast else (made.drive, made.coast)
    # What the drawing says of the flank stays; without a drawing both flanks are relieved.
    held = next((shape for shape in mine if isinstance(shape, Relief)), None)
    if held is None and any(isinstance(shape, Relief) for shape in other):
        return np.zeros(scene.samples.size)
    power = RELIEF_POWERS[place.form] if place.form or held is None else held.power
    relief = Relief(values[0] * UM, ideal.roll_length(ideal.r_a - values[1]), power)
    return scene.deviated(gear, lambda tooth, l: relief(l, scene.spans[gear]))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    declared = gear_section(file, place.gear).tip_relief
    amount = values[0] + (declared.amount_um if declared is not None else 0.0)
    plain = TipRelief.model_construct(amount_um=0.0, length_mm=values[1])
    table = changed(declared or plain, amount_um=max(amount, 0.0), length_mm=values[1])
    if place.form:
        table = changed(table, shape=place.form)
    return on_gear(file, place.gear, tip_relief=table)


def _otherwise(scope: Scope, place: Place, values: Values) -> Iterable[tuple[Place, Values]]:
    if scope.section(place.gear or 0).tip_relief is None:
        more, longer = AS_CURVE
        if place.form == "parabolic":
            yield replace(place, form="linear"), (values[0] / more, values[1] / longer)
        else:
            yield replace(place, form="parabolic"), (values[0] * more, values[1] * longer)


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    found = plain("amount_um", "length_mm")(place, values, covariance)
    return {**found, "exponent": (float(RELIEF_POWERS[place.form]), 0.0)}


def _says(place: Place, values: Values) -> str:
    curve = ", on a parabola" if place.form == "parabolic" else ""
    return f"The tips of the {own_of(place)} are relieved by {values[0]:.1f} um over {values[1]:.2f} mm{curve}."


def _sensible(scope: Scope, place: Place, values: Values) -> bool:
    return (
        values[1] > SHORTEST_RELIEF_MODULES * scope.gears[place.gear or 0].m and values[0] * UM <= STEEPEST * values[1]
    )


PHYSICS = Physics(
    name="tip_relief",
    rank=MADE + 1,
    source="ISO 21771:2007, tip relief; linear or parabolic in roll length",
    stands="[driving.tip_relief]",
    parameters=("amount_um", "length_mm"),
    case=(Place(gear=0, form="linear"), (8.0, 0.6)),
    keys={"gear": GearKeys},
    shapes=_shapes,
    coordinates=(
        Quantity(
            name="amount_um",
            unit="um",
            low=0.0,
            most=half_tooth,
            why="more than half a tooth is not there to be taken off",
        ),
        Quantity(
            name="length_mm", unit="mm", low=0.02, most=_whole_flank, why="a flank ends at the base circle", step=0.01
        ),
    ),
    amplitudes=1,
    ordinary=(5.0,),
    places=_places,
    mean_tooth=True,
    law_doubt=0.05,
    effect=_effect,
    otherwise=_otherwise,
    sensible=_sensible,
    write=_write,
    report=_report,
    says=_says,
    equation="d = -C t^p, t from 0 where the relief begins to 1 at the tip, in roll length; p 1 (line), 2 (parabola)",
)
