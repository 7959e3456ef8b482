"""What the simulation foretells of every mesh, or a sheet of every tooth, may not be in the recordings at all: they are
of another pair or gear, of another column, of a mesh without load. Whatever cancels it all then explains as much as its
absence does, and is no name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.teeth_scale import INDEX_DEVIATION_PHYSICS
from gearpoly.keys.edit import gear_section
from gearpoly.physics.base import Claim
from gearpoly.physics.sheet import column
from gearpoly.scene import Scene
from gearpoly.units import FloatArray

MESH_HARMONICS_TAKEN = 24
"""Harmonics of the mesh that are taken for what comes with every mesh: of a smooth 18/25 at 40 N.m, whose mesh has 2.6
um peak to peak, the others have 0.024 um rms; of a 12/16 with 4.6 um, 0.085 um."""

SHAFT_ORDERS_TOLD_APART = 3
"""Orders of both shafts that are told apart from it, so that a part of a turn does not leak into the mesh: eccentric
gears make the first two. A judgement."""


def misfit_without_mesh(model: Model, scenes: Sequence[Scene], linear: Linear, *, leave: Sequence[int]) -> float:
    """Misfit where nothing of what is simulated alike of every mesh is in the recordings, neither of the declared pair
    nor of what is claimed of all teeth, nor the parameters ``leave``; all else is fitted again."""
    layout, system = linear.layout, linear.system
    places = list(leave)
    held = np.zeros(system.size)
    for claim, at in zip(model.claims, layout.claims, strict=True):
        if claim.physics.mean_tooth:
            # Amplitudes count from nothing, shapes from where they are.
            held[at.start : at.start + claim.physics.amplitudes] = claim.values[: claim.physics.amplitudes]
            places += range(at.start, at.stop)
    # Teeth as built stay open: what they have settled to do at every mesh counts as theirs.
    built = [columns.times(layout.built, model.built) for columns in linear.columns]
    target = [
        y - white @ held + noise.whitened(_of_every_mesh(scene, scene.te - own))
        for scene, own, noise, white, y in zip(scenes, built, linear.noises, system.white, system.target, strict=True)
    ]
    return replace(system, target=target).without(places).misfit


def of_the_sheet(model: Model, claim: Claim) -> list[int]:
    """Numbers of the claims that may be the likeness of what a sheet lists in vain of the gear of a ``claim``: itself,
    and all pitch errors of that gear; none where no sheet lists its teeth."""
    gear = claim.place.gear
    if gear is None or not model.scope.inspected[gear] or not np.ptp(column(model.scope.section(gear), "pitch_um")):
        return []
    return [
        k
        for k, one in enumerate(model.claims)
        if one.key == claim.key or (one.physics.name in INDEX_DEVIATION_PHYSICS and one.place.gear == gear)
    ]


def misfit_without_sheet(
    model: Model, linear: Linear, gear: int, claims: Sequence[int], *, leave: Sequence[int]
) -> float:
    """Misfit where nothing of what the sheet of an inspected ``gear`` lists of its pitches is in the recordings, nor
    these ``claims``, nor the parameters ``leave``: they are of another gear. All else is fitted again."""
    layout, built = linear.layout, model.as_built
    places = [*leave, *(place for k in claims for place in layout.places(k))]
    off = np.zeros(built.size)
    for flank in built.flanks:
        key = "pitch_coast_um" if flank == "coast" else "pitch_um"
        built.pitch(off, flank, gear)[:] = -column(gear_section(model.declared, gear), key)
    prior = linear.system.prior.copy()
    prior[layout.built] += off
    return replace(linear.system, prior=prior).without(places).misfit


def _of_every_mesh(scene: Scene, te: FloatArray) -> FloatArray:
    """The part (n,) in mm of a transmission error ``te`` (n,) in mm that comes with every mesh, without its mean."""
    mesh = scene.samples.theta_2 * scene.gear(1).z
    turns = [
        order * angle
        for angle in (scene.samples.theta_1, scene.samples.theta_2)
        for order in range(1, SHAFT_ORDERS_TOLD_APART + 1)
    ]
    waves = [h * mesh for h in range(1, MESH_HARMONICS_TAKEN + 1)]
    columns = np.empty((mesh.size, 2 * (MESH_HARMONICS_TAKEN + len(turns)) + 1))
    columns[:, -1] = 1.0
    for k, angle in enumerate((*waves, *turns)):
        columns[:, 2 * k], columns[:, 2 * k + 1] = np.cos(angle), np.sin(angle)
    size = math.sqrt(mesh.size)
    sizes = np.linalg.lstsq(columns / size, te / size)[0]
    return np.asarray(columns[:, : 2 * MESH_HARMONICS_TAKEN] @ sizes[: 2 * MESH_HARMONICS_TAKEN])
