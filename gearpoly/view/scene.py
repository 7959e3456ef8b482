"""What the contact debugger shows: a simulated hunting cycle, and a recording beside it where there is one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.compare.beside import Comparison
from gearpoly.errors import OutOfRangeError, blamed
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.pair import GearPair
from gearpoly.mesh.transmission import Progress
from gearpoly.positions import USUAL_POINTS_PER_MESH, cycle_positions
from gearpoly.simulate import Simulation, simulate, strength_remarks
from gearpoly.units import DEG

MOST_POSITIONS = 50_000
"""Positions over a cycle from which fewer are taken per pitch: they cost time and bytes, and the page finds the
contacts between them itself."""

LEAST_VIEWED_PER_MESH = 4
"""Positions per pitch of the longest cycles; below, the curve of the whole cycle would miss whole hand-overs."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ViewScene:
    """One run of one pair, ready to be shown.

    ``simulation`` holds evenly spaced positions of a whole hunting cycle, ``per_mesh`` a pitch. ``theta_2`` is the
    driven rotation in rad at which the page opens. ``comparison`` lays a recording beside it, where there is one;
    ``remarks`` say what had to be assumed.
    """

    name: str
    simulation: Simulation
    per_mesh: int
    theta_2: float
    comparison: Comparison | None
    remarks: tuple[str, ...]


def positions(pair: GearPair) -> int:
    """How many positions a page's simulation has over the hunting cycle, for those who show its progress."""
    return pair.meshes_per_cycle * points_per_mesh(pair)


def points_per_mesh(pair: GearPair) -> int:
    """Positions per pitch at which the page's curves are simulated: ``simulate``'s own, fewer for very long cycles."""
    return max(LEAST_VIEWED_PER_MESH, min(USUAL_POINTS_PER_MESH, MOST_POSITIONS // pair.meshes_per_cycle))


def opening_angle(pair: GearPair, theta_2: float) -> float:
    """Driven rotation in rad within the hunting cycle for one ``theta_2`` in rad that a user asked for.

    Raises ``OutOfRangeError`` for an angle that is none.
    """
    if not np.isfinite(theta_2):
        raise OutOfRangeError(f"--at {theta_2 / DEG}: want a driven angle in deg, such as 12.5")
    return float(np.mod(theta_2, pair.cycle))


def scene_of(
    assembled: Assembled,
    *,
    name: str,
    path: Path | str,
    condition: Condition,
    theta_2: float = 0.0,
    seed: int = 0,
    progress: Progress,
) -> ViewScene:
    """``assembled`` (of the file at ``path``, with ``seed``) over its hunting cycle under ``condition``.

    Raises what ``simulate`` does, and ``OutOfRangeError`` for an angle ``theta_2`` that is none.
    """
    opened = opening_angle(assembled.pair, theta_2)
    simulation = _simulated(assembled, condition, path=path, seed=seed, progress=progress)
    return ViewScene(
        name=name,
        simulation=simulation,
        per_mesh=points_per_mesh(assembled.pair),
        theta_2=opened,
        comparison=None,
        remarks=tuple(strength_remarks(simulation)),
    )


def scene_beside(comparison: Comparison, *, path: Path | str, theta_2: float = 0.0, progress: Progress) -> ViewScene:
    """The pair of ``comparison`` (its file read from ``path``) under its first recording's condition, with that
    recording's mismatch.

    Raises what ``simulate`` does.
    """
    one = comparison.aligned[0]
    pair = comparison.assembled.pair
    opened = opening_angle(pair, theta_2)
    condition = Condition(flank=one.flank, torque=one.torque)
    simulation = _simulated(comparison.assembled, condition, path=path, seed=0, progress=progress)
    return ViewScene(
        name=comparison.name,
        simulation=simulation,
        per_mesh=points_per_mesh(pair),
        theta_2=opened,
        comparison=comparison,
        remarks=(*comparison.remarks, *strength_remarks(simulation)),
    )


def _simulated(
    assembled: Assembled, condition: Condition, *, path: Path | str, seed: int, progress: Progress
) -> Simulation:
    theta_2 = cycle_positions(assembled.pair, points_per_mesh=points_per_mesh(assembled.pair))
    with blamed(path, "driving, driven, pair"):
        return simulate(assembled, theta_2, condition, seed=seed, evenly=False, fast=True, progress=progress)
