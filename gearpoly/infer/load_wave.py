"""A torque that pulses with a shaft: teeth give more and less, whatever makes it pulse.

It is no physics of the catalogue, and names nothing. It is looked for beside them so that what a pulsing torque does to
teeth in mesh one after the other is not taken for teeth that are damaged one beside the other.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import RUN, Physics, Quantity, Scope
from gearpoly.physics.bounds import always
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported
from gearpoly.scene import Scene
from gearpoly.units import FloatArray

PULSES_PER_TURN = (1, 2, 3)
"""Pulses per turn that are looked for: a shaft out of line or a coupling gives one or two, a three-armed one three."""

LOAD_WAVE_PRIOR = 0.05
"""How often it is met, to the physics of the catalogue. A judgement: what is driven mostly turns evenly."""


def _places(scope: Scope) -> Iterable[Place]:
    if scope.loaded:
        yield from (Place(gear=gear, order=order) for gear in (0, 1) for order in PULSES_PER_TURN)


def given(scene: Scene) -> FloatArray:
    """Change (n,) in mm of the transmission error per relative change of the torque, pairs sharing it as they do."""
    return np.asarray(-scene.samples.sense * scene.samples.torque * scene.soft / scene.pair.r_b2)


def columns(scene: Scene, place: Place) -> FloatArray:
    """Effects (n, 2) in mm of a torque that varies by all of itself as a cosine and as a sine of its shaft."""
    samples = scene.samples
    angle = (place.order or 1) * (samples.theta_1 if place.gear == 0 else samples.theta_2)
    return np.asarray(given(scene)[:, None] * np.column_stack((np.cos(angle), np.sin(angle))))


def apart(scenes: Sequence[Scene], place: Place) -> list[FloatArray]:
    """The same (n_k, 2 K), every recording with a wave of its own: each is made under a torque of its own."""
    out = []
    for k, scene in enumerate(scenes):
        wide = np.zeros((scene.samples.size, 2 * len(scenes)))
        wide[:, 2 * k : 2 * k + 2] = columns(scene, place)
        out.append(wide)
    return out


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    assert isinstance(scene, Scene)
    return np.asarray(columns(scene, place) @ np.asarray(values))


def _written(file: PairFile, place: Place, values: Values) -> PairFile:
    return file


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    return {}


LOAD_WAVE = Physics(
    name="load_wave",
    rank=RUN + 9,
    source="the stiffness of the mesh as simulated; derived here",
    stands="nothing in the pair file",
    parameters=(),
    case=(Place(gear=1, order=1), (0.1, 0.0)),
    coordinates=tuple(
        Quantity(name=name, unit="1", most=always(1.0), why="a torque that turns back leaves the flank", step=0.01)
        for name in ("cosine", "sine")
    ),
    amplitudes=2,
    ordinary=(0.05, 0.05),
    common=LOAD_WAVE_PRIOR,
    places=_places,
    wavelike=True,
    effect=_effect,
    write=_written,
    report=_report,
    says=lambda place, v: f"The torque varies by {100.0 * math.hypot(*v):.1f} % with the shaft.",
    equation="dT/T = c cos(n theta) + s sin(n theta)",
)
