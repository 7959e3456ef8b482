"""Shafts and bearings that give way: the axes stand farther apart under torque."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from gearpoly.keys.edit import on_pair
from gearpoly.keys.kinds import Section, field
from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import MOUNTED, Physics, Quantity, Scope
from gearpoly.physics.bounds import module
from gearpoly.physics.parts import Parts
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import plain
from gearpoly.units import NM, UM, FloatArray


class PairKeys(Section):
    """What a pair says of it."""

    support_um_per_nm: float = field(
        "growth of the centre distance in um per N.m of driven torque, of shafts and bearings, 0 or more",
        0.0,
        ge=0.0,
        le=1e4,
    )


def _build(file: PairFile, parts: Parts) -> Parts:
    return replace(parts, support=parts.support + file.pair.support_um_per_nm * UM / NM)


def _places(scope: Scope) -> Iterable[Place]:
    if scope.torque_changes:
        yield Place()


def _most(scope: Scope, place: Place) -> float:
    """um/(N.m). One module under the largest torque, or under 1 N.m where all are less."""
    return module(scope, place) / max(1.0, max(scope.torques, default=0.0) / NM)


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    apart = np.full(scene.samples.size, values[0] * UM / NM * scene.samples.torque) * scene.samples.loaded
    return scene.displaced(1, apart, np.zeros(scene.samples.size))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    return on_pair(file, support_um_per_nm=max(0.0, file.pair.support_um_per_nm + values[0]))


PHYSICS = Physics(
    name="support_compliance",
    rank=MOUNTED + 3,
    source="Hooke's law of shafts and bearings; ISO 21771:2007, working pressure angle",
    stands="pair.support_um_per_nm",
    parameters=("um_per_nm",),
    case=(Place(), (1.0,)),
    keys={"pair": PairKeys},
    build=_build,
    coordinates=(
        Quantity(
            name="um_per_nm",
            unit="um/(N.m)",
            low=0.0,
            most=_most,
            why="teeth of gears farther apart do not reach each other",
            step=0.1,
        ),
    ),
    amplitudes=1,
    ordinary=(0.5,),
    common=3.0,
    places=_places,
    effect=_effect,
    write=_write,
    report=plain("um_per_nm"),
    says=lambda place, v: f"Shafts and bearings let the axes move apart by {v[0]:.2f} um per N.m of driven torque.",
    equation="a = a_0 + c T, each side opens by (r_b1 + r_b2)(inv alpha' - inv alpha)",
)
