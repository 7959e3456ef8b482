"""The fast exact path: closing rotations as ``contact`` defines them, from the radial gap of the same polylines.

It needs no windows and no iteration, and its answers are exact to rounding (see ``radial_search``). The polygon kernel
stays the definition: ``spot_check`` certifies a sample of any fast run with it. numba is imported at the first call,
not before.
"""

from __future__ import annotations

import numpy as np

from gearpoly.errors import SelfCheckError
from gearpoly.mesh.bodies import Body, coordinates
from gearpoly.mesh.contact import Closings, all_certified, closing_rotations
from gearpoly.mesh.features import describe
from gearpoly.units import FloatArray, IntArray

AGREEMENT = 1e-12
"""rad. What both kernels promise: the polygon kernel certifies within 2.5e-13, the radial gap rounds to 1e-15. Less
would fail for no geometric reason, more would break the promise."""


def closing_rotations_fast(
    turning: Body,
    fixed: Body,
    *,
    axis_distance: float,
    poses: FloatArray,
    guesses: FloatArray,
    near: float,
) -> Closings:
    """First touches of all near pairs, with the meaning of ``contact.closing_rotations``, all poses at once.

    ``axis_distance`` in mm from the turning body's axis (the origin) to the fixed body's, along +x. ``poses`` (N,):
    angle of the fixed body in rad. ``guesses`` (N,): rotation of the turning body in rad near which it touches,
    within a fifth of its pitch. ``near`` in rad: pairs that close within this of the first are returned too. Poses
    at which nothing touches have no row, and no row is ever ``repaired``.

    The turning teeth must stand a pitch apart to about a tenth, and no face may span more than a quarter turn about
    the turning axis. Derived here.
    """
    from gearpoly.mesh.radial_search import search

    teeth, values, vertex = search(
        turning.faces, fixed.faces, axis_distance=axis_distance, poses=poses, guesses=guesses, near=near
    )
    pose, mine, mate = (np.ascontiguousarray(column) for column in teeth.T)
    rotation = values[:, 0].copy()
    turn, forward = np.exp(1j * poses)[pose], np.exp(1j * guesses)[pose] * np.exp(1j * rotation)
    normal, feature, overrun = describe(
        turning,
        fixed,
        teeth=(mine, mate),
        places=(values[:, 1], values[:, 2]),
        turning_is_vertex=vertex,
        spin=turn * forward.conj(),
    )
    return Closings(
        positions=poses.size,
        pose=pose,
        turning=mine,
        fixed=mate,
        rotation=rotation,
        point=coordinates((values[:, 3] + 1j * values[:, 4]) * forward),
        normal=coordinates(normal * forward),
        feature=feature,
        overrun=overrun,
        repaired=np.zeros(pose.size, dtype=bool),
    )


def spot_check(
    turning: Body,
    fixed: Body,
    closings: Closings,
    *,
    axis_distance: float,
    poses: FloatArray,
    guesses: FloatArray,
    near: float,
    samples: int = 64,
    rng: np.random.Generator | None = None,
) -> float:
    """Certify ``samples`` positions of a fast run with the polygon kernel; returns the worst difference in rad, 0 where
    all pass its certificate as they stand. Where one does not, the kernel solves them itself.

    ``closings`` of ``closing_rotations_fast`` with the same other arguments. The positions are evenly spaced over the
    run, or drawn by ``rng``. Raises ``SelfCheckError`` where a closing differs by more than ``AGREEMENT`` or where
    one kernel has a near pair that the other lacks (but for pairs that stand at ``near`` to within that),
    ``NotConvergedError`` where the polygon kernel itself finds no certificate.
    """
    count = min(samples, poses.size)
    if count == 0:
        return 0.0
    chosen = (
        np.unique(np.linspace(0, poses.size - 1, count).astype(np.int64))
        if rng is None
        else np.sort(rng.choice(poses.size, count, replace=False))
    )
    known = closings.at(chosen)
    if all_certified(
        turning, fixed, known, axis_distance=axis_distance, poses=poses[chosen], guesses=guesses[chosen], near=near
    ):
        return 0.0
    worst = 0.0
    start = 0
    for part in closing_rotations(
        turning, fixed, axis_distance=axis_distance, poses=poses[chosen], guesses=guesses[chosen], near=near
    ):
        for k in range(start, start + part.positions):
            worst = max(worst, _worst(closings, int(chosen[k]), part, k, near))
        start += part.positions
    return worst


def _worst(fast: Closings, at_fast: int, certified: Closings, at_certified: int, near: float) -> float:
    """Greatest difference in rad between both kernels at one position; raises ``SelfCheckError`` above
    ``AGREEMENT``."""
    mine, theirs = _closings_at(fast, at_fast), _closings_at(certified, at_certified)
    worst = 0.0
    for pair in mine.keys() | theirs.keys():
        if pair in mine and pair in theirs:
            difference = abs(mine[pair] - theirs[pair])
        else:
            # A pair may fall to either side of the limit itself.
            one = mine if pair in mine else theirs
            difference = max(0.0, min(one.values()) + near - one[pair])
        if not difference <= AGREEMENT:
            raise SelfCheckError(
                f"the fast path and the certified polygons differ by {difference:.3g} rad at position {at_fast}, "
                f"turning tooth {pair[0]} on fixed tooth {pair[1]}"
            )
        worst = max(worst, difference)
    return worst


def _closings_at(closings: Closings, pose: int) -> dict[tuple[int, int], float]:
    low, high = np.searchsorted(closings.pose, (pose, pose + 1))
    rows = slice(int(low), int(high))
    teeth: tuple[IntArray, IntArray] = closings.turning[rows], closings.fixed[rows]
    return {(int(i), int(j)): float(rotation) for i, j, rotation in zip(*teeth, closings.rotation[rows], strict=True)}
