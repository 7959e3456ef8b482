"""Axes that stand farther apart, or nearer, than declared."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from gearpoly.gear.nominal import nominal_gears
from gearpoly.keys.edit import on_pair
from gearpoly.keys.sections import PairFile
from gearpoly.mesh.pair import tight_centre_distance
from gearpoly.physics.base import MOUNTED, Physics, Quantity, Scope
from gearpoly.physics.bounds import module
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import plain
from gearpoly.units import UM, FloatArray


def _places(scope: Scope) -> Iterable[Place]:
    yield Place()


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    moved = np.full(scene.samples.size, values[0] * UM)
    return scene.displaced(1, moved, np.zeros(scene.samples.size))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    a = file.pair.centre_distance_mm
    if a is None:
        a = tight_centre_distance(*nominal_gears(file))
    return on_pair(file, centre_distance_mm=a + values[0] * UM)


PHYSICS = Physics(
    name="centre_distance",
    rank=MOUNTED + 2,
    source="ISO 21771:2007, working pressure angle and backlash",
    stands="pair.centre_distance_mm",
    parameters=("offset_um",),
    case=(Place(), (40.0,)),
    coordinates=(
        Quantity(
            name="offset_um",
            unit="um",
            most=module,
            why="teeth of gears farther apart do not reach each other, nearer they jam",
            step=5.0,
        ),
    ),
    amplitudes=1,
    ordinary=(20.0,),
    places=_places,
    mean_tooth=True,
    effect=_effect,
    write=_write,
    report=plain("offset_um"),
    says=lambda place, v: (
        f"The axes stand {abs(v[0]):.0f} um {'farther apart' if v[0] > 0 else 'nearer'} than declared."
    ),
    equation="each side opens by (r_b1 + r_b2)(inv alpha' - inv alpha)",
)
