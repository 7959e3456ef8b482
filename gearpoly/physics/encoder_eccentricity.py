"""An encoder disc or coupling that runs off its axis: an error of reading once per turn."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from gearpoly.keys.edit import changed, gear_section, on_gear, table
from gearpoly.keys.kinds import Section, field
from gearpoly.keys.sections import Encoder, PairFile
from gearpoly.physics.base import READ, Physics, Quantity, Scope
from gearpoly.physics.bounds import half_pitch
from gearpoly.physics.encoder import misread, misreading
from gearpoly.physics.parts import EncoderErrors
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import own_of, vector
from gearpoly.units import DEG, URAD, FloatArray


class EncoderKeys(Section):
    """What an encoder says of it."""

    eccentricity_urad: float = field("amplitude in urad of an error once per turn, 0 or more", 0.0, ge=0.0, le=1e6)
    eccentricity_deg: float = field("reading in deg at which that error is largest", 0.0, ge=-1e4, le=1e4)


def _errors(stated: Encoder, errors: EncoderErrors) -> EncoderErrors:
    if not stated.eccentricity_urad:
        return errors
    wave = (1, stated.eccentricity_urad * URAD, -stated.eccentricity_deg * DEG)
    return replace(errors, waves=(*errors.waves, wave))


def _places(scope: Scope) -> Iterable[Place]:
    for gear in (0, 1):
        # Nothing reads the shafts before the worm of a telescope mount: their angles are time and guiding pulses.
        if scope.encoders[gear] and scope.file.worm is None:
            yield Place(gear=gear)


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    return misread(scene, place.gear, 1, values)


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    held = table(gear_section(file, place.gear), "encoder")
    x = values[0] + held.eccentricity_urad * math.cos(math.radians(held.eccentricity_deg))
    y = values[1] + held.eccentricity_urad * math.sin(math.radians(held.eccentricity_deg))
    told = changed(held, eccentricity_urad=math.hypot(x, y), eccentricity_deg=math.degrees(math.atan2(y, x)) % 360.0)
    return on_gear(file, place.gear, encoder=told)


PHYSICS = Physics(
    name="encoder_eccentricity",
    rank=READ + 1,
    source="a disc off its axis, to first order in its offset; derived here",
    stands="[driving.encoder]: eccentricity_urad, eccentricity_deg",
    parameters=("amplitude_urad",),
    case=(Place(gear=1), (120.0, 200.0)),
    keys={"encoder": EncoderKeys},
    build=misreading(_errors),
    coordinates=tuple(
        Quantity(name=name, unit="urad", most=half_pitch, why="an encoder that is wrong by more counts the teeth wrong")
        for name in ("cos_urad", "sin_urad")
    ),
    amplitudes=2,
    once_per_turn=True,
    ordinary=(100.0, 0.0),
    common=4.0,
    places=_places,
    effect=_effect,
    write=_write,
    report=vector("amplitude_urad"),
    says=lambda place, v: (
        f"The encoder on the {own_of(place)}'s shaft reads {math.hypot(v[0], v[1]):.0f} urad wrong "
        "once per turn: it sits off its axis."
    ),
    equation="reading = truth + A cos(reading - phi), the same on both flanks and at every load",
)
