"""The published contact search, as a yardstick: points in a quadrant, one arc second at a time.

Liu, Shi, Cura, Mura (J. Cent. South Univ. 27, 2020, 3334-3349): the driven gear is set at theta_2
and held, the driving gear turns towards it in steps of 1 arcsec until a point of one flank lies in
the quadrant formed by neighbouring points of the other.

The equations of the published text were not available. This is a reading of its words:

- The points are those of the driving flanks, the neighbours those of the driven flanks, and every
  point of every driving flank that can touch is tested at every step.
- The neighbours of point P are the two driven points between whose radii about the driven axis P
  lies. At each neighbour the chord towards the other and the inward normal of the chord form a
  quadrant; P touches when it lies in both, that is, behind the chord. So the check is as exact as
  the polyline and only the step errs. (The other reading, a quadrant along the radius and the
  circle at one neighbour, replaces the flank by stairs and would add an error of the size of the
  point spacing.)
- The radii choose the strip, by one binary search per point, so only the inward coordinate is left
  to test. A point counts as behind the chord down to DEPTH.
- A driven tip corner that enters between two driving points is seen only when a driving point
  passes the last chord. Measured on 18/25, m 2, with deviations of grade 5: late by up to 0.6
  arcsec at 2000 points per flank and 1.9 arcsec at 1000, on top of the step. On flanks and at
  driving tips the points themselves add under 0.01 arcsec.
- The caller says where the steps begin; main() takes 920 arcsec before contact.

The point arrays are vectorised over all points of all candidate pairs; the steps are not, because
the method stops at the first that touches. Run from the repository's root:
python -m tests.oracles.paper_stepping
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

ARCSEC = math.pi / 648000.0
START = 920 * ARCSEC  # rad before the expected contact

# mm behind the chord up to which a point counts as inside. More than one step moves a point
# (1e-4 mm), so no first touch is jumped over; less than half a tooth, so the far side is no touch.
DEPTH = 0.2


def step_until_contact(
    turning_faces: FloatArray,
    fixed_faces: FloatArray,
    *,
    axis_distance: float,
    pose: float,
    start: float,
    step: float = ARCSEC,
    max_steps: int = 4000,
) -> tuple[float, int]:
    """The first rotation start + k step at which a driving point is inside a driven tooth, and k.

    turning_faces (z1, n, 2) about the origin, fixed_faces (z2, m, 2) about their own axis at
    (axis_distance, 0), root to tip, mm; pose, start and step rad, counter-clockwise. (nan,
    max_steps) where nothing touches. Late by less than one step except at driven tip corners
    (see above), never early beyond rounding.
    """
    pairs = candidates(turning_faces, fixed_faces, axis_distance, pose, start)
    if not pairs:
        return math.nan, max_steps
    flanks = [(turning_faces[i], chords(fixed_faces[j], pose)) for i, j in pairs]
    for k in range(max_steps + 1):
        rotation = start + k * step
        c, s = math.cos(rotation), math.sin(rotation)
        for points, (radius2, x, y, normal_x, normal_y) in flanks:
            # Driving points in the frame of the driven axis, which the held flank never leaves.
            px = c * points[:, 0] - s * points[:, 1] - axis_distance
            py = s * points[:, 0] + c * points[:, 1]
            at = np.searchsorted(radius2, px * px + py * py) - 1
            near = (at >= 0) & (at < x.size)
            at, px, py = at[near], px[near], py[near]
            inward = (px - x[at]) * normal_x[at] + (py - y[at]) * normal_y[at]
            if np.any((inward >= 0.0) & (inward <= DEPTH)):
                return rotation, k
    return math.nan, max_steps


def candidates(
    turning_faces: FloatArray,
    fixed_faces: FloatArray,
    axis_distance: float,
    pose: float,
    start: float,
) -> list[tuple[int, int]]:
    """Pairs that can touch: a driven tip within reach, and the driving face behind it."""
    reach = float(np.hypot(turning_faces[..., 0], turning_faces[..., 1]).max())
    pitch = 2.0 * math.pi / turning_faces.shape[0]
    c, s = math.cos(pose), math.sin(pose)
    x = c * fixed_faces[..., 0] - s * fixed_faces[..., 1] + axis_distance
    y = s * fixed_faces[..., 0] + c * fixed_faces[..., 1]
    nearest = np.hypot(x, y).argmin(axis=1)
    tip_1 = np.arctan2(turning_faces[:, -1, 1], turning_faces[:, -1, 0]) + start
    pairs = []
    for j, k in enumerate(nearest):
        if math.hypot(x[j, k], y[j, k]) < reach:
            ahead = (math.atan2(y[j, k], x[j, k]) - tip_1 + pitch / 4) % (2.0 * math.pi)
            pairs.append((int(np.argmin(ahead)), j))
    return pairs


def chords(face: FloatArray, pose: float) -> tuple[FloatArray, ...]:
    """The held flank about its own axis: squared radii, first points, inward unit normals."""
    c, s = math.cos(pose), math.sin(pose)
    x = c * face[:, 0] - s * face[:, 1]
    y = s * face[:, 0] + c * face[:, 1]
    radius2 = x * x + y * y
    # The root land keeps one radius: begin where the radius rises for good.
    falls = np.nonzero(np.diff(radius2) <= 0.0)[0]
    first = int(falls[-1]) + 1 if falls.size else 0
    x, y, radius2 = x[first:], y[first:], radius2[first:]
    dx, dy = np.diff(x), np.diff(y)
    length = np.hypot(dx, dy)
    # Root to tip along a counter-clockwise side the material lies on the clockwise (right) hand.
    return radius2, x[:-1], y[:-1], dy / length, -dx / length


def main() -> None:
    """Time stepping and exhaustive radial gap: 18/25, m 2, 2000 points per flank."""
    from tests.oracles.involute_pair import pair_faces
    from tests.oracles.radial_gap import closing_rotations

    rng = np.random.default_rng(5)
    index = (rng.uniform(-5e-3, 5e-3, 18), rng.uniform(-5e-3, 5e-3, 25))  # mm, about grade 5
    slope = (rng.uniform(-4e-3, 4e-3, 18), rng.uniform(-4e-3, 4e-3, 25))
    turning, fixed, pair = pair_faces(18, 25, 2.0, math.radians(20), 2000, index=index, slope=slope)
    theta_2 = np.linspace(0.0, 2.0 * math.pi, 361)
    guesses = pair.guesses(theta_2)

    def exact() -> FloatArray:
        return closing_rotations(turning, fixed, axis_distance=pair.a, poses=-theta_2, guesses=guesses).rotation

    exact_rotation = exact()  # compiles, too
    chosen = np.arange(0, 361, 40)

    # Starts fall anywhere between two steps, or the answer would always be a whole step away.
    starts = exact_rotation - START + rng.uniform(0.0, ARCSEC, theta_2.size)

    def stepped() -> list[float]:
        return [
            step_until_contact(
                turning,
                fixed,
                axis_distance=pair.a,
                pose=-float(theta_2[k]),
                start=float(starts[k]),
            )[0]
            for k in chosen
        ]

    def best_of_three(run: Callable[[], object], positions: int) -> float:
        times = []
        for _ in range(3):
            begin = time.perf_counter()
            run()
            times.append(time.perf_counter() - begin)
        return min(times) / positions * 1e6

    late = (np.array(stepped()) - exact_rotation[chosen]) * pair.driving.r_b * 1e6
    slow = best_of_three(stepped, chosen.size)
    fast = best_of_three(exact, theta_2.size)
    print(f"stepping by 1 arcsec: {slow:.0f} us/position")
    print(f"late by {late.min():.1f}..{late.max():.1f} nm at r_b")
    print(f"radial gap, every vertex: {fast:8.1f} us/position, ratio {slow / fast:.0f}")


if __name__ == "__main__":
    main()
