"""An encoder disc or coupling that runs off its axis: an error of reading once per turn."""

from __future__ import annotations

import math
from collections.abc import Iterable

from gearpoly.files.models import Encoder, PairFile
from gearpoly.physics.base import (
    Physics,
    Place,
    Quantity,
    Scope,
    Values,
    changed,
    gear_section,
    on_gear,
    own_of,
    vector,
)
from gearpoly.physics.bounds import half_pitch
from gearpoly.physics.encoder import misread
from gearpoly.physics.scene import Scene
from gearpoly.units import FloatArray


def _places(scope: Scope) -> Iterable[Place]:
    for gear in (0, 1):
        if scope.encoders[gear]:
            yield Place(gear=gear)


def _effect(scene: Scene, place: Place, values: Values) -> FloatArray:
    return misread(scene, place.gear, 1, values)


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    held = gear_section(file, place.gear).encoder or Encoder()
    x = values[0] + held.eccentricity_urad * math.cos(math.radians(held.eccentricity_deg))
    y = values[1] + held.eccentricity_urad * math.sin(math.radians(held.eccentricity_deg))
    table = changed(held, eccentricity_urad=math.hypot(x, y), eccentricity_deg=math.degrees(math.atan2(y, x)) % 360.0)
    return on_gear(file, place.gear, encoder=table)


PHYSICS = Physics(
    name="encoder_eccentricity",
    coordinates=tuple(
        Quantity(name=name, unit="urad", most=half_pitch, why="an encoder that is wrong by more counts the teeth wrong")
        for name in ("cos_urad", "sin_urad")
    ),
    amplitudes=2,
    once_per_turn=True,
    ordinary=(100.0, 0.0),
    places=_places,
    effect=_effect,
    measures=True,
    write=_write,
    report=vector("amplitude_urad"),
    says=lambda place, v: (
        f"The encoder on the {own_of(place)}'s shaft reads {math.hypot(v[0], v[1]):.0f} urad wrong "
        "once per turn: it sits off its axis."
    ),
    equation="reading = truth + A cos(reading - phi), the same on both flanks and at every load",
)
