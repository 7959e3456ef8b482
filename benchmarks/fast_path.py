"""What the fast exact path costs beside a bare search, the exhaustive oracle and the certified polygons, in one run.

18/25 teeth, module 2 mm, 2000 points per flank; all near pairs means within 30 um along the line of action. Times are
of the processor, warm, the least of a few runs; the ratios hold from machine to machine. From the root:
python -m benchmarks.fast_path

Two bare searches stand for "nothing but the first touch":

- *scan*: every 32nd vertex of every pair of teeth that can meet, then every vertex between the neighbours of the best.
  No bound, so nothing says that the scan did not step over the first touch; how often it did is printed.
- *first touch*: the fast path's own search, asked for no neighbours and told to describe nothing. It prunes the second
  pair by the first, so it solves one pair per position where "all near pairs" solves nearly two.
"""

# numba ships no type information and infers the types of compiled functions from their arguments.
# mypy: disable-error-code="import-untyped, untyped-decorator, no-untyped-def, no-untyped-call"

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numba import njit

from gearpoly.gear.deviations import Deviations
from gearpoly.gear.draw import draw_deviations, streams
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.gear.root import form_point
from gearpoly.gear.tolerances import default_thickness, limits_for, tolerances
from gearpoly.mesh.contact import closing_rotations
from gearpoly.mesh.pair import GearPair, active_start, mount, tight_centre_distance
from gearpoly.mesh.radial import closing_rotations_fast, spot_check
from gearpoly.mesh.radial_search import search
from gearpoly.units import UM, FloatArray
from tests.oracles.radial_gap import closing_rotations_of_pairs

POSITIONS = 18_000
NEAR = 30.0 * UM
STRIDE = 32


def pair_of(grade: int | None, *, rough: bool = False, points: int = 2000, m: float = 2.0) -> GearPair:
    """18/25 teeth, perfect or drawn within ``grade``."""
    gears = [Gear(z=18, m=m), Gear(z=25, m=m)]
    a = tight_centre_distance(*gears)
    flanks = []
    for k, gear in enumerate(gears):
        l_start = active_start(gear, gears[1 - k], l_form=form_point(gear)[1])
        shapes = Deviations()
        if grade is not None:
            limit = tolerances(d=gear.z * m, m=m, grade=grade)
            shapes = draw_deviations(
                gear,
                limits_for(gear, grade=limit, thickness=default_thickness(a=a, m=m, alpha=gear.alpha, F_pT=limit.F_pT)),
                rng=streams(1)[k],
                which="driving" if k == 0 else "driven",
                profile_errors="scatter" if rough else "smooth",
                roll_lengths=np.linspace(l_start, gear.l_a, points),
            ).deviations
        flanks.append(draw_flanks(gear, shapes, l_start=l_start, points=points))
    return mount(*flanks, a=a)


@njit(nogil=True)
def _angle(x, y, r2, face, radii2):
    """Angle from ``face`` (radius rising) to the point x, y on the circle r2, or inf off its radii."""
    low, high = 0, radii2.size - 1
    if r2 < radii2[low] or r2 > radii2[high]:
        return np.inf
    while high - low > 1:
        middle = (low + high) // 2
        if radii2[middle] <= r2:
            low = middle
        else:
            high = middle
    ax, ay = face[low, 0], face[low, 1]
    dx, dy = face[high, 0] - ax, face[high, 1] - ay
    half, rest = ax * dx + ay * dy, r2 - radii2[low]
    t = rest / (half + math.sqrt(half * half + (dx * dx + dy * dy) * rest))
    px, py = ax + t * dx, ay + t * dy
    return math.atan2(px * y - py * x, px * x + py * y)


@njit(nogil=True)
def _scan(turning, fixed, working, axis_distance, poses, guesses):
    """First touches (N,) by scanning; ``turning`` (z, n, 2) and ``fixed`` (z, m, 2) from vertex ``working`` on."""
    z_1, n, _ = turning.shape
    z_2, m, _ = fixed.shape
    radii2 = turning[:, :, 0] ** 2 + turning[:, :, 1] ** 2
    reach2 = radii2.max()
    moved = np.empty((m, 2))
    moved_radii2 = np.empty(m)
    out = np.full(poses.size, np.inf)
    for p in range(poses.size):
        cw, sw = math.cos(poses[p] - guesses[p]), math.sin(poses[p] - guesses[p])
        sx, sy = axis_distance * math.cos(guesses[p]), -axis_distance * math.sin(guesses[p])
        for j in range(z_2):
            tip = fixed[j, m - 1]
            x, y = cw * tip[0] - sw * tip[1] + sx, sw * tip[0] + cw * tip[1] + sy
            if x * x + y * y > reach2:
                continue
            for i in range(z_1):
                u, v = turning[i, n - 1]
                ahead = math.atan2(u * y - v * x, u * x + v * y) * z_1 / (2.0 * math.pi)
                if ahead < -0.7 or ahead > 1.0:
                    continue  # passed, or a pitch away
                best, at = np.inf, m - 1
                for k in range(m - 1, working, -STRIDE):
                    x_k = cw * fixed[j, k, 0] - sw * fixed[j, k, 1] + sx
                    y_k = sw * fixed[j, k, 0] + cw * fixed[j, k, 1] + sy
                    r2 = x_k * x_k + y_k * y_k
                    if r2 > reach2:
                        break
                    angle = _angle(x_k, y_k, r2, turning[i], radii2[i])
                    if angle < best:
                        best, at = angle, k
                if best < -0.25 * 2.0 * math.pi / z_1 or best > out[p] + 0.01:
                    continue
                begin, end = max(at - STRIDE, 0), min(at + STRIDE, m - 1)
                for k in range(begin, end + 1):
                    x_k = cw * fixed[j, k, 0] - sw * fixed[j, k, 1] + sx
                    y_k = sw * fixed[j, k, 0] + cw * fixed[j, k, 1] + sy
                    r2 = x_k * x_k + y_k * y_k
                    l = end - k  # radius rising
                    moved[l, 0], moved[l, 1], moved_radii2[l] = x_k, y_k, r2
                    best = min(best, _angle(x_k, y_k, r2, turning[i], radii2[i]))
                count = end - begin + 1
                for k in range(np.searchsorted(radii2[i], moved_radii2[0]), n):
                    if radii2[i, k] > moved_radii2[count - 1]:
                        break
                    angle = _angle(
                        turning[i, k, 0], turning[i, k, 1], radii2[i, k], moved[:count], moved_radii2[:count]
                    )
                    if not math.isinf(angle):
                        best = min(best, -angle)
                out[p] = min(out[p], best)
    return out


def least(run: Callable[[], Any], times: int) -> tuple[float, Any]:
    """Least processor time in s of several runs, and what the last one gave."""
    best, result = math.inf, None
    for _ in range(times):
        start = time.process_time()
        result = run()
        best = min(best, time.process_time() - start)
    return best, result


def measure(pair: GearPair) -> tuple[dict[str, float], str]:
    """us/position of every method, and what was found beside."""
    turning, fixed = pair.driving.body("drive"), pair.driven.body("drive")

    def how(positions: int) -> dict[str, Any]:
        theta_2 = 2.0 * math.pi * (np.arange(positions) + 0.37) / positions
        return {
            "axis_distance": pair.a,
            "poses": -theta_2,
            "guesses": theta_2 / pair.ratio,
            "near": NEAR / pair.r_b1,
        }

    many, few, fewest = how(POSITIONS), how(600), how(200)
    working = fixed.working
    above = np.ascontiguousarray(turning.faces[:, turning.working :])
    faces: tuple[FloatArray, FloatArray] = (turning.faces, fixed.faces)
    scanned = (above, fixed.faces, working, pair.a)

    def exhaust(k: dict[str, Any]) -> Any:
        return closing_rotations_of_pairs(*faces, **{key: value for key, value in k.items() if key != "near"})

    methods: dict[str, tuple[Callable[[dict[str, Any]], Any], dict[str, Any], int]] = {
        "bare scan": (lambda k: _scan(*scanned, k["poses"], k["guesses"]), many, 3),
        "first touch": (lambda k: search(*faces, **{**k, "near": 0.0}), many, 3),
        "all near pairs": (lambda k: search(*faces, **k), many, 3),
        "fast path": (lambda k: closing_rotations_fast(turning, fixed, **k), many, 3),
        "oracle": (exhaust, few, 2),
        "polygons": (lambda k: list(closing_rotations(turning, fixed, **k)), fewest, 1),
    }
    costs, results = {}, {}
    for name, (method, args, times) in methods.items():
        method(how(3))  # compile
        seconds, results[name] = least(partial(method, args), times)
        costs[name] = seconds / args["poses"].size / UM**2
    found = results["fast path"]
    first = found.rotation[found.first()]
    missed = np.count_nonzero(results["bare scan"] - first > 1e-12)
    worst = spot_check(turning, fixed, found, samples=100, **many)
    notes = (
        f"{found.pose.size / POSITIONS:.2f} near pairs a position; 100 positions certified, worst {worst:.1e} rad; "
        f"the scan missed the first touch at {missed} of {POSITIONS}"
    )
    return costs, notes


def main() -> None:
    names = ("bare scan", "first touch", "all near pairs", "fast path", "oracle", "polygons")
    print(f"us/position, {POSITIONS} positions of 18/25 at 2000 points per flank, one core, warm")
    print(
        f"{'pair':>18} | " + " | ".join(f"{name:>14}" for name in names) + " | fast path/scan | fast path/first touch"
    )
    notes = []
    for label, pair in (
        ("perfect", pair_of(None)),
        ("grade 5", pair_of(5)),
        ("grade 8", pair_of(8)),
        ("grade 5, scatter", pair_of(5, rough=True)),
    ):
        cost, note = measure(pair)
        ratios = [cost["fast path"] / cost["bare scan"], cost["fast path"] / cost["first touch"]]
        print(
            f"{label:>18} | " + " | ".join(f"{cost[name]:14.1f}" for name in names)
            + f" | {ratios[0]:14.2f} | {ratios[1]:21.2f}",
            flush=True,
        )  # fmt: skip
        notes.append(f"{label}: {note}")
    print("\n".join(notes))


if __name__ == "__main__":
    main()
