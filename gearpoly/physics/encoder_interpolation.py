"""An encoder that errs a whole number of times per turn: interpolation between its lines."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from pydantic import Field

from gearpoly.keys.edit import changed, gear_section, on_gear, table
from gearpoly.keys.kinds import Section, field
from gearpoly.keys.sections import Encoder, PairFile
from gearpoly.physics.base import READ, Physics, Quantity, Scope
from gearpoly.physics.encoder import misread, misreading
from gearpoly.physics.parts import EncoderErrors
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import own_of, phased, wave
from gearpoly.units import DEG, URAD, FloatArray

LOWEST_ERRORS_PER_TURN = 2
"""Errors per turn: once is eccentricity; a disc out of round errs twice, a marred one a few times, lines hundreds of
times."""

HIGHEST_ERRORS_PER_TURN = 8192
"""The same: more lines than most discs have. Above half the sampling an order may be the alias of another."""

FEW_ERRORS_PER_TURN = 32
"""Errors per turn below which not many encoders have as few lines, or poles."""

ORDERS_OF_MEAN_TEETH = 7
"""Mesh orders up to which mean teeth have a say. At those from 4 to 24, 34 healthy pairs of another bench, loaded or
not, left no line that is more than the noise's highest of so many; what laws of compliance leave is weighed apart."""


class Interpolation(Section):
    """An error of reading that recurs a whole number of times per turn of a shaft: interpolation, or lines."""

    order: int = Field(ge=1, le=10_000_000, description="waves per turn of the encoder, a whole number from 1")
    amplitude_urad: float = Field(ge=0.0, le=1e6, description="amplitude in urad of the shaft, 0 or more")
    angle_deg: float = field("phase in deg: error = amplitude cos(order reading + angle)", 0.0, ge=-1e4, le=1e4)


class EncoderKeys(Section):
    """What an encoder says of it."""

    interpolation: tuple[Interpolation, ...] = field("errors that recur within a turn, tables", (), strict=False)


def _errors(stated: Encoder, errors: EncoderErrors) -> EncoderErrors:
    waves = ((one.order, one.amplitude_urad * URAD, one.angle_deg * DEG) for one in stated.interpolation)
    return replace(errors, waves=(*errors.waves, *waves))


def _places(scope: Scope) -> Iterable[Place]:
    for gear in (0, 1):
        if scope.encoders[gear] and not scope.from_time[gear]:
            z = scope.gears[gear].z
            for order in range(LOWEST_ERRORS_PER_TURN, HIGHEST_ERRORS_PER_TURN + 1):
                # At a low mesh order every mean tooth errs: nothing tells an encoder from it.
                if order % z or order > ORDERS_OF_MEAN_TEETH * z:
                    yield Place(gear=gear, order=order)


def _forward(scope: Scope, place: Place) -> float:
    """urad. The amplitude from which a reading with so many errors per turn no longer grows with its shaft."""
    return 1.0 / ((place.order or 1) * URAD)


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    return misread(scene, place.gear, place.order or 1, values)


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    held = table(gear_section(file, place.gear), "encoder")
    amplitude, angle = wave(values[0], values[1])
    one = Interpolation.model_construct(order=place.order or 1, amplitude_urad=amplitude, angle_deg=angle % 360.0)
    return on_gear(file, place.gear, encoder=changed(held, interpolation=(*held.interpolation, one)))


def _reason(place: Place) -> str:
    if (place.order or 1) < FEW_ERRORS_PER_TURN:
        return "its own, or of something else that turns with that shaft, such as a worm or a coupling"
    return "interpolation between its lines"


PHYSICS = Physics(
    name="encoder_interpolation",
    rank=READ + 3,
    source="errors fixed to the reading, as a Fourier series of it; derived here",
    stands="[[driving.encoder.interpolation]]: order, amplitude_urad, angle_deg",
    parameters=("amplitude_urad", "order"),
    case=(Place(gear=0, order=200), (30.0, -12.0)),
    keys={"encoder": EncoderKeys},
    build=misreading(_errors),
    coordinates=tuple(
        Quantity(
            name=name,
            unit="urad",
            most=_forward,
            why="a reading with larger errors would run backwards within each of them",
        )
        for name in ("cos_urad", "sin_urad")
    ),
    amplitudes=2,
    ordinary=(20.0, 0.0),
    # A disc out of round, and lines as many as the waves of a ghost order.
    ordinary_orders=lambda gear: (2, 5 * gear.z // 2),
    places=_places,
    effect=_effect,
    wavelike=True,
    write=_write,
    report=phased("amplitude_urad"),
    says=lambda place, v: (
        f"The encoder on the {own_of(place)}'s shaft errs by {math.hypot(v[0], v[1]):.1f} urad, "
        f"{place.order} times per turn: {_reason(place)}."
    ),
    equation="reading = truth + A cos(n reading + phase), n the line count or a multiple",
)
