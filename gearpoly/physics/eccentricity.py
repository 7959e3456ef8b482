"""A gear that runs off its axis."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from pydantic import Field

from gearpoly.keys.edit import gear_section, on_gear
from gearpoly.keys.kinds import Section, UmSize, field
from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import MOUNTED, Physics, Quantity, Scope
from gearpoly.physics.bounds import module
from gearpoly.physics.parts import Parts
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import own_of, vector
from gearpoly.units import DEG, UM, FloatArray


class Eccentricity(Section):
    """The gear's own centre as seen from its axis of rotation."""

    amplitude_um: UmSize = Field(description="distance of the gear's centre from its axis in um, 0 or more")
    angle_deg: float = field(
        "angle in deg from the pitch point of tooth 0's drive flank, in the order of meshing",
        0.0,
        ge=-1e4,
        le=1e4,
    )


class GearKeys(Section):
    """What a gear says of it."""

    eccentricity: Eccentricity | None = field("eccentricity, a table")


def _build(file: PairFile, parts: Parts) -> Parts:
    off = [
        (one.amplitude_um * UM, one.angle_deg * DEG) if one is not None else (0.0, 0.0)
        for one in (file.driving.eccentricity, file.driven.eccentricity)
    ]
    return replace(parts, eccentricity=(off[0], off[1]))


def _places(scope: Scope) -> Iterable[Place]:
    # Of a gear that is declared eccentric, what is missing is the difference.
    return (Place(gear=gear) for gear in (0, 1))


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    """The gear's centre moves round its axis and carries all flanks along."""
    gear = place.gear or 0
    mounted = scene.pair.driving if gear == 0 else scene.pair.driven
    # At rotation 0 the centre stands at origin + sign angle; the driving gear turns counter-clockwise, the driven
    # clockwise.
    turned = scene.samples.theta_1 if gear == 0 else -scene.samples.theta_2
    direction = np.exp(1j * (mounted.origin + turned))
    centre = direction * (values[0] + 1j * mounted.sign * values[1]) * UM
    return scene.displaced(gear, centre.real, centre.imag)


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    x, y = values
    declared = gear_section(file, place.gear).eccentricity
    if declared is not None:
        x += declared.amplitude_um * math.cos(math.radians(declared.angle_deg))
        y += declared.amplitude_um * math.sin(math.radians(declared.angle_deg))
    table = Eccentricity(amplitude_um=math.hypot(x, y), angle_deg=math.degrees(math.atan2(y, x)) % 360.0)
    return on_gear(file, place.gear, eccentricity=table)


PHYSICS = Physics(
    name="eccentricity",
    rank=MOUNTED + 1,
    source="geometry of a centre off its axis, derived here; the contact kernel turns it exactly",
    stands="[driving.eccentricity]",
    parameters=("amplitude_um", "angle_deg"),
    case=(Place(gear=0), (5.0, -7.0)),
    keys={"gear": GearKeys},
    build=_build,
    coordinates=tuple(
        Quantity(
            name=name,
            unit="um",
            most=module,
            why="farther off its axis a gear leaves its mate's teeth, or jams, once per turn",
        )
        for name in ("x_um", "y_um")
    ),
    amplitudes=2,
    once_per_turn=True,
    ordinary=(5.0, 0.0),
    common=5.0,
    places=_places,
    effect=_effect,
    write=_write,
    report=vector("amplitude_um"),
    says=lambda place, v: f"The {own_of(place)} runs {math.hypot(v[0], v[1]):.1f} um off its axis.",
    equation="x = e cos(theta - phi) along the line of action, exact: the gear's centre moves round its axis",
)
