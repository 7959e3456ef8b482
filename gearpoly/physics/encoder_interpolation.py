"""An encoder that errs a whole number of times per turn: interpolation between its lines."""

from __future__ import annotations

import math
from collections.abc import Iterable

from gearpoly.files.models import Encoder, Interpolation, PairFile
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
    phased,
    wave,
)
from gearpoly.physics.encoder import misread
from gearpoly.physics.scene import Scene
from gearpoly.units import URAD, FloatArray

LOWEST = 2
"""Errors per turn: once is eccentricity; a disc out of round errs twice, a marred one a few times, lines hundreds of
times."""

HIGHEST = 8192
"""The same: more lines than most discs have. Above half the sampling an order may be the alias of another."""

FEW = 32
"""Errors per turn below which not many encoders have as few lines, or poles."""

MESH_ORDERS = 7
"""Mesh orders up to which mean teeth have a say. At those from 4 to 24, 34 healthy pairs of another bench, loaded or
not, left no line that is more than the noise's highest of so many; what laws of compliance leave is weighed apart."""


def _places(scope: Scope) -> Iterable[Place]:
    for gear in (0, 1):
        if scope.encoders[gear] and not scope.from_time[gear]:
            z = scope.gears[gear].z
            for order in range(LOWEST, HIGHEST + 1):
                # At a low mesh order every mean tooth errs: nothing tells an encoder from it.
                if order % z or order > MESH_ORDERS * z:
                    yield Place(gear=gear, order=order)


def _forward(scope: Scope, place: Place) -> float:
    """urad. The amplitude from which a reading with so many errors per turn no longer grows with its shaft."""
    return 1.0 / ((place.order or 1) * URAD)


def _effect(scene: Scene, place: Place, values: Values) -> FloatArray:
    return misread(scene, place.gear, place.order or 1, values)


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    held = gear_section(file, place.gear).encoder or Encoder()
    amplitude, angle = wave(values[0], values[1])
    one = Interpolation.model_construct(order=place.order or 1, amplitude_urad=amplitude, angle_deg=angle % 360.0)
    return on_gear(file, place.gear, encoder=changed(held, interpolation=(*held.interpolation, one)))


def _reason(place: Place) -> str:
    if (place.order or 1) < FEW:
        return "its own, or of something else that turns with that shaft, such as a worm or a coupling"
    return "interpolation between its lines"


PHYSICS = Physics(
    name="encoder_interpolation",
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
    measures=True,
    write=_write,
    report=phased("amplitude_urad"),
    says=lambda place, v: (
        f"The encoder on the {own_of(place)}'s shaft errs by {math.hypot(v[0], v[1]):.1f} urad, "
        f"{place.order} times per turn: {_reason(place)}."
    ),
    equation="reading = truth + A cos(n reading + phase), n the line count or a multiple",
)
