"""Shafts that twist between the encoders."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from gearpoly.keys.edit import on_pair
from gearpoly.keys.kinds import Section, field
from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import RUN, Physics, Quantity, Scope
from gearpoly.physics.bounds import half_pitch
from gearpoly.physics.parts import Parts
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import plain
from gearpoly.units import NM, URAD, FloatArray


class PairKeys(Section):
    """What a pair says of it."""

    windup_urad_per_nm: float = field(
        "twist of the shafts between the encoders in urad per N.m of driven torque", 0.0, ge=-1e6, le=1e6
    )


def _build(file: PairFile, parts: Parts) -> Parts:
    windup = parts.shafts.windup + file.pair.windup_urad_per_nm * URAD / NM
    return replace(parts, shafts=replace(parts.shafts, windup=windup))


def _places(scope: Scope) -> Iterable[Place]:
    if scope.torque_changes:
        yield Place()


def _most(scope: Scope, place: Place) -> float:
    """urad/(N.m). Half a pitch under the largest torque, or under 1 N.m where all are less."""
    return half_pitch(scope, place) / max(1.0, max(scope.torques, default=0.0) / NM)


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    twist = -scene.samples.sense * values[0] * URAD / NM * scene.samples.torque * scene.pair.r_b2
    return np.full(scene.samples.size, twist) * scene.samples.loaded


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    return on_pair(file, windup_urad_per_nm=file.pair.windup_urad_per_nm + values[0])


PHYSICS = Physics(
    name="shaft_windup",
    rank=RUN + 3,
    source="Hooke's law of a shaft in torsion",
    stands="pair.windup_urad_per_nm",
    parameters=("compliance_urad_per_nm",),
    case=(Place(), (9.0,)),
    keys={"pair": PairKeys},
    build=_build,
    coordinates=(
        Quantity(
            name="compliance_urad_per_nm",
            unit="urad/(N.m)",
            low=0.0,
            most=_most,
            why="shafts that wind up by more than half a pitch have their teeth counted wrong",
            step=0.1,
        ),
    ),
    amplitudes=1,
    ordinary=(1.0,),
    common=3.0,
    places=_places,
    effect=_effect,
    write=_write,
    report=plain("compliance_urad_per_nm"),
    says=lambda place, v: f"The shafts between the encoders twist by {v[0]:.2f} urad per N.m of driven torque.",
    equation="x falls by r_b2 c T on the drive flank and rises on the coast flank",
)
