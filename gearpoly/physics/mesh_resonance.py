"""A torsional resonance that magnifies the harmonics near it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from pydantic import Field

from gearpoly.keys.edit import on_pair
from gearpoly.keys.kinds import Section, field
from gearpoly.keys.sections import PairFile
from gearpoly.mesh.shafts import Shafts
from gearpoly.physics.base import RUN, Physics, Quantity, Scope
from gearpoly.physics.bounds import always
from gearpoly.physics.parts import Parts
from gearpoly.physics.place import Place, Values
from gearpoly.physics.shown import ContactsAtSamples
from gearpoly.physics.words import Reported
from gearpoly.units import FloatArray

LOWEST_NATURAL_FREQUENCY, HIGHEST_NATURAL_FREQUENCY, NATURAL_FREQUENCIES_TRIED = 0.4, 40.0, 60
"""Natural frequencies that are tried, in mesh frequencies of the fastest recording: every 8 %. Below, the mesh hardly
gets through; above, it hardly swings."""

DAMPINGS = (0.03, 0.1)

DAMPED_IN_MESH_PART = 0.5
"""Part of the damping in the mesh to begin with: nobody knows it, and near the resonance it hardly shows."""

HIGHEST_DAMPING = 0.3
"""Shafts and gears of steel hardly reach a tenth; more is no resonance."""


class Resonance(Section):
    """A torsional resonance of the mesh: harmonics of the static transmission error near it are magnified."""

    frequency_hz: float = Field(gt=0.0, le=1e6, description="natural frequency in Hz, above 0")
    damping_ratio: float = field("damping over its critical value, above 0 to 1", 0.05, gt=0.0, le=1.0)
    damped_in_mesh: float = field(
        "part of the damping that acts between the teeth, 0 (all in bearings and shafts) to 1",
        0.0,
        ge=0.0,
        le=1.0,
    )


class PairKeys(Section):
    """What a pair says of it."""

    resonance: Resonance | None = field("torsional resonance of the mesh, a table")


def _build(file: PairFile, parts: Parts) -> Parts:
    stated: Resonance | None = file.pair.resonance
    if stated is None:
        return parts
    shafts = replace(
        parts.shafts, frequency=stated.frequency_hz, damping=stated.damping_ratio, in_mesh=stated.damped_in_mesh
    )
    return replace(parts, shafts=shafts)


def _places(scope: Scope) -> Iterable[Place]:
    speeds = [speed for speed in scope.speeds if speed is not None]
    if len(speeds) < len(scope.speeds) or scope.file.pair.resonance is not None:
        return
    speeds += [end for ends in scope.run_ups for end in ends]
    if not scope.several_speeds:
        return  # at one speed it would stand for whatever a law of compliance leaves of the mean tooth
    mesh = max(speeds) * scope.gears[0].z / (2.0 * math.pi)
    for part in np.geomspace(LOWEST_NATURAL_FREQUENCY, HIGHEST_NATURAL_FREQUENCY, NATURAL_FREQUENCIES_TRIED).tolist():
        for damping in DAMPINGS:
            yield Place(shape=(math.log(part * mesh), damping, DAMPED_IN_MESH_PART), probe=(1.0,))


def _effect(scene: ContactsAtSamples, place: Place, values: Values) -> FloatArray:
    if scene.samples.speed is None or values[0] <= 0.0:
        return np.zeros(scene.samples.size)
    shafts = Shafts(frequency=math.exp(values[1]), damping=min(1.0, max(values[2], 1e-3)), in_mesh=values[3])
    return np.asarray(scene.swings(shafts) * (scene.pair.r_b2 * values[0]))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    if values[0] <= 0.0:
        return file
    table = Resonance(
        frequency_hz=math.exp(values[1]), damping_ratio=min(1.0, max(values[2], 1e-3)), damped_in_mesh=values[3]
    )
    return on_pair(file, resonance=table)


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    std = [math.sqrt(max(float(covariance[k, k]), 0.0)) for k in range(4)]
    hz = math.exp(values[1])
    return {
        "frequency_hz": (hz, hz * std[1]),
        "damping_ratio": (float(values[2]), std[2]),
        "damped_in_mesh": (float(values[3]), std[3]),
    }


PHYSICS = Physics(
    name="mesh_resonance",
    rank=RUN + 4,
    source="Tuplin 1953; Ozguven and Houser 1988",
    stands="[pair.resonance]: frequency_hz, damping_ratio, damped_in_mesh",
    parameters=("frequency_hz", "damping_ratio"),
    case=(Place(), (1.0, math.log(150.0), 0.08, 0.3)),
    keys={"pair": PairKeys},
    build=_build,
    coordinates=(
        Quantity(name="present", unit="1", low=0.0, most=always(1.0), why="it is there, or it is not", switch=True),
        Quantity(
            name="ln_frequency",
            unit="ln(Hz)",
            low=-4.0,
            most=always(12.0),
            why="nothing of a gear pair swings at 160 kHz",
            step=0.003,
        ),
        Quantity(
            name="damping_ratio",
            unit="1",
            low=0.001,
            most=always(HIGHEST_DAMPING),
            why="shafts and gears of steel hardly reach a tenth",
            step=0.01,
        ),
        Quantity(name="damped_in_mesh", unit="1", low=0.0, most=always(1.0), why="a part of the damping", step=0.1),
    ),
    amplitudes=1,
    ordinary=(1.0,),
    places=_places,
    mean_tooth=True,
    effect=_effect,
    write=_write,
    report=_report,
    says=lambda place, v: (
        f"The mesh swings at {math.exp(v[1]):.0f} Hz (damping {v[2]:.3f}) and magnifies what comes near it."
    ),
    equation="each harmonic times (1 + 2 i e D f/f_n)/(1 - (f/f_n)^2 + 2 i D f/f_n), e of the damping in the mesh",
)
