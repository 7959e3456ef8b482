"""One tooth that stands off its place, beyond what its inspection or its grade explains."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import MADE, Physics, Quantity, Scope
from gearpoly.physics.bounds import half_tooth
from gearpoly.physics.place import Place, Values
from gearpoly.physics.sheet import pitched, pitched_flanks, pitched_sense
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import plain, tooth_of
from gearpoly.units import UM, FloatArray


def _places(scope: Scope) -> Iterable[Place]:
    for gear in (0, 1):
        for tooth in range(scope.gears[gear].z):
            for flank in pitched_flanks(scope):
                yield Place(gear=gear, tooth=tooth, flank=flank)


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    by = pitched_sense(scene, place) * values[0] * UM
    return scene.deviated_tooth(place.gear or 0, place.tooth, lambda l: np.full(l.size, by))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    z = (file.driving if place.gear == 0 else file.driven).teeth
    return pitched(file, place, values[0] * (np.arange(z) == place.tooth))


PHYSICS = Physics(
    name="tooth_pitch",
    rank=MADE + 5,
    source="ISO 1328-1:2013, index deviation of one tooth",
    stands="[driving.inspection]: pitch_um",
    parameters=("deviation_um",),
    case=(Place(gear=1, tooth=5, flank="drive"), (4.0,)),
    coordinates=(
        Quantity(
            name="deviation_um", unit="um", most=half_tooth, why="a tooth farther off stands in its neighbour's gap"
        ),
    ),
    amplitudes=1,
    ordinary=(4.0,),
    common=3.0,
    places=_places,
    effect=_effect,
    write=_write,
    report=plain("deviation_um"),
    says=lambda place, v: (
        f"{tooth_of(place)} stands {abs(v[0]):.1f} um {'ahead of' if v[0] > 0 else 'behind'} its declared place."
    ),
    equation="p_n = f on one tooth: x moves by f where its pair carries alone, by its share where two do",
)
