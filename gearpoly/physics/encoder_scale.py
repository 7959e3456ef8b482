"""An encoder whose counts per turn are set wrong, or a coupling that slips: a ramp."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from gearpoly.keys.edit import changed, gear_section, on_gear, table
from gearpoly.keys.kinds import Section, field
from gearpoly.keys.sections import Encoder, PairFile
from gearpoly.physics.base import READ, Physics, Quantity, Scope
from gearpoly.physics.bounds import recorded
from gearpoly.physics.encoder import misreading
from gearpoly.physics.parts import EncoderErrors
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported, own_of
from gearpoly.units import UM, FloatArray

PPM = 1e-6

LARGE = 1e3
"""Millionths from which a scale is said as the factor that it is: no rounding of counts makes as much."""


class EncoderKeys(Section):
    """What an encoder says of it."""

    scale: float = field("reading over truth, where the counts per turn are set wrong", 1.0, gt=0.01, lt=100.0)


def _errors(stated: Encoder, errors: EncoderErrors) -> EncoderErrors:
    return replace(errors, scale=errors.scale * stated.scale)


def _places(scope: Scope) -> Iterable[Place]:
    for gear in (0, 1):
        if scope.encoders[gear] and not (scope.wanders and all(scope.wanders)):
            yield Place(gear=gear)


def _most(scope: Scope, place: Place) -> float:
    """Millionths. What makes a ramp as large as the recordings range, and half of what one tooth more or less makes of
    the ratio, from where on another pair of teeth fits better."""
    another = 0.5 / max(gear.z for gear in scope.gears) / PPM
    turned = 2.0 * math.pi * scope.span * scope.gears[0].z / scope.gears[1].z
    return min(another, recorded(scope, place) * UM / (turned * scope.gears[1].r_b * PPM)) if turned > 0.0 else another


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    driving = place.gear in (0, None)
    theta = scene.samples.theta_1 if driving else scene.samples.theta_2
    part = -scene.pair.ratio if driving else 1.0
    return np.asarray(part * values[0] * PPM * theta * scene.pair.r_b2)


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    held = table(gear_section(file, place.gear), "encoder")
    return on_gear(file, place.gear, encoder=changed(held, scale=held.scale * (1.0 + values[0] * PPM)))


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    return {"ratio": (1.0 + float(values[0]) * PPM, math.sqrt(max(float(covariance[0, 0]), 0.0)) * PPM)}


def _says(place: Place, values: Values) -> str:
    if abs(values[0]) > LARGE:
        reads = f"reads {1.0 + values[0] * PPM:.7g} times what it turns: its counts per turn are set wrong"
    else:
        reads = f"counts {values[0]:+.1f} millionths too {'much' if values[0] > 0 else 'little'} per turn"
    return f"The encoder on the {own_of(place)}'s shaft {reads}, or its coupling slips."


PHYSICS = Physics(
    name="encoder_scale",
    rank=READ + 2,
    source="counts per turn stated wrong, or slip in step with the turns; derived here",
    stands="[driving.encoder]: scale",
    parameters=("ratio",),
    case=(Place(gear=0), (4.0,)),
    keys={"encoder": EncoderKeys},
    build=misreading(_errors),
    coordinates=(
        Quantity(
            name="ppm",
            unit="1e-6",
            most=_most,
            why="a larger one is a ramp beyond the recordings, or another pair of teeth",
        ),
    ),
    amplitudes=1,
    ordinary=(5.0,),
    places=_places,
    effect=_effect,
    slow=True,
    write=_write,
    report=_report,
    says=_says,
    equation="reading = ratio times truth: a ramp in x",
)
