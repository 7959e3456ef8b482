"""A wave of index deviations round a gear, beyond what was declared."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import MADE, Physics, Quantity, Scope
from gearpoly.physics.bounds import half_tooth
from gearpoly.physics.place import Place, Values
from gearpoly.physics.sheet import pitched, pitched_flanks, pitched_sense
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported, own_of, polar
from gearpoly.units import UM, FloatArray

HIGHEST_PITCH_WAVE = 8
"""Waves per turn that are looked for: cutting errors are slow; faster ones are single teeth."""


def _places(scope: Scope) -> Iterable[Place]:
    for gear in (0, 1):
        for order in range(1, min(HIGHEST_PITCH_WAVE, (scope.gears[gear].z - 1) // 2) + 1):
            for flank in pitched_flanks(scope):
                yield Place(gear=gear, order=order, flank=flank)


def _wave(place: Place, values: Values, z: int) -> FloatArray:
    angle = (place.order or 1) * 2.0 * math.pi * np.arange(z) / z
    return values[0] * np.cos(angle) + values[1] * np.sin(angle)


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    gear = place.gear or 0
    z = (scene.pair.driving if gear == 0 else scene.pair.driven).gear.z
    wave = pitched_sense(scene, place) * UM * _wave(place, values, z)
    return scene.deviated(gear, lambda tooth, l: wave[tooth])


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    z = (file.driving if place.gear == 0 else file.driven).teeth
    return pitched(file, place, _wave(place, values, z))


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    amplitude, angle = polar(float(values[0]), float(values[1]), covariance)
    return {"amplitude_um": amplitude, "order": (float(place.order or 1), 0.0), "angle_deg": angle}


PHYSICS = Physics(
    name="cumulative_pitch",
    rank=MADE + 6,
    source="ISO 1328-1:2013, index deviations; a wave of them, derived here",
    stands="[driving.inspection]: pitch_um",
    parameters=("amplitude_um", "order"),
    case=(Place(gear=1, order=3, flank="drive"), (4.0, -2.0)),
    coordinates=tuple(
        Quantity(name=name, unit="um", most=half_tooth, why="a tooth farther off stands in its neighbour's gap")
        for name in ("x_um", "y_um")
    ),
    amplitudes=2,
    ordinary=(5.0, 0.0),
    ordinary_orders=lambda gear: (1, 2),
    places=_places,
    effect=_effect,
    write=_write,
    report=_report,
    says=lambda place, v: (
        f"The {own_of(place)}'s pitch waves {math.hypot(v[0], v[1]):.1f} um, {place.order} times per turn, beyond what "
        "its inspection or grade says."
    ),
    equation="p_k = A cos(2 pi n k/z - phi), a staircase in x",
)
