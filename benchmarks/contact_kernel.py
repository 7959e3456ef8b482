"""The certified contact kernel beside an exhaustive search and the published one: one run, one table of ratios.

Times are processor times of one core, medians over repeats that take turns, so that a busy machine troubles all alike.
The pair is the paper's 18/25, m 2 mm, 2000 points per flank, drawn at grade 5, both axes where they belong.

Run from the repository's root: python -m benchmarks.contact_kernel
"""

from __future__ import annotations

import argparse
import math
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from gearpoly.gear.draw import draw_deviations, streams
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.gear.root import form_point
from gearpoly.gear.tolerances import limits_for, tolerances
from gearpoly.mesh.bodies import Body
from gearpoly.mesh.contact import closing_rotations
from gearpoly.mesh.pair import GearPair, active_start, mount
from gearpoly.mesh.transmission import NEAR_PAIR_MM
from gearpoly.units import FloatArray
from tests.oracles.paper_stepping import ARCSEC, DEPTH, START, candidates, chords, step_until_contact
from tests.oracles.radial_gap import closing_rotations as radial_gap

COUNTS = (361, 3600, 36_000)
STEPS = round(START / ARCSEC)  # 920, as the paper's search begins that far before contact


def make_pair(points: int = 2000) -> GearPair:
    """The pair of the benchmark: 18/25 teeth, m 2 mm, drawn at grade 5 of 1995, thinned so that it turns."""
    gears = [Gear(z=z, m=2.0) for z in (18, 25)]
    flanks = []
    for k, which in ((0, "driving"), (1, "driven")):
        gear, mate = gears[k], gears[1 - k]
        limits = limits_for(
            gear, grade=tolerances(d=2.0 * gear.r, m=gear.m, grade=5, edition=1995), thickness=(-0.04, -0.1)
        )
        drawn = draw_deviations(gear, limits, rng=streams(0)[k], which="driving" if which == "driving" else "driven")
        l_start = active_start(gear, mate, l_form=form_point(gear)[1])
        flanks.append(draw_flanks(gear, drawn.deviations, l_start=l_start, points=points))
    return mount(flanks[0], flanks[1])


def kernel(bodies: list[Body], pair: GearPair, theta_2: FloatArray) -> FloatArray:
    """Closing rotations (N,) beyond the guess of the certified kernel; near pairs, points and normals come with it."""
    parts = closing_rotations(
        bodies[0],
        bodies[1],
        axis_distance=pair.a,
        poses=-theta_2,
        guesses=theta_2 / pair.ratio,
        near=NEAR_PAIR_MM / pair.r_b1,
    )
    return np.concatenate([part.rotation[part.first()] for part in parts])


def make_bodies(pair: GearPair) -> list[Body]:
    """Both bodies with all that the kernel keeps of them, worked at one position."""
    bodies = [pair.driving.body("drive"), pair.driven.body("drive")]
    kernel(bodies, pair, np.zeros(1))
    return bodies


def exhaustive(turning: FloatArray, fixed: FloatArray, pair: GearPair, theta_2: FloatArray) -> FloatArray:
    """The same from the compiled radial gap of every vertex."""
    return radial_gap(turning, fixed, axis_distance=pair.a, poses=-theta_2, guesses=theta_2 / pair.ratio).offset


def all_quadrants(turning: FloatArray, fixed: FloatArray, pairs: list[tuple[int, int]], a: float, pose: float,
                  rotation: float) -> bool:  # fmt: skip
    """One step of the published check without any search: every driving point against every driven point's quadrant."""
    c, s = math.cos(rotation), math.sin(rotation)
    touch = False
    for i, j in pairs:
        points = turning[i]
        p = np.stack((c * points[:, 0] - s * points[:, 1] - a, s * points[:, 0] + c * points[:, 1]))
        radius2, x, y, normal_x, normal_y = chords(fixed[j], pose)
        along_x, along_y = -normal_y, normal_x
        length = np.sqrt(np.diff(radius2) ** 2 / np.maximum(1e-300, 4.0 * (x * along_x + y * along_y) ** 2))
        for part in np.array_split(np.arange(x.size), 16):  # blocks that stay in the cache
            along = np.outer(along_x[part], p[0]) + np.outer(along_y[part], p[1])
            along -= (x[part] * along_x[part] + y[part] * along_y[part])[:, None]
            inward = np.outer(normal_x[part], p[0]) + np.outer(normal_y[part], p[1])
            inward -= (x[part] * normal_x[part] + y[part] * normal_y[part])[:, None]
            inside = (np.abs(along) <= length[part, None]) & (inward >= 0.0) & (inward <= DEPTH)
            touch |= bool(np.any(inside))
    return touch


def all_teeth(turning: FloatArray, flanks: list[tuple[FloatArray, ...]], a: float, rotation: float) -> bool:
    """One step with a binary search per point, but no choice of teeth: every driving flank against every driven one."""
    c, s = math.cos(rotation), math.sin(rotation)
    touch = False
    for points in turning:
        x, y = c * points[:, 0] - s * points[:, 1] - a, s * points[:, 0] + c * points[:, 1]
        squared = x * x + y * y
        for radius2, qx, qy, normal_x, normal_y in flanks:
            at = np.searchsorted(radius2, squared) - 1
            near = (at >= 0) & (at < qx.size)
            at, px, py = at[near], x[near], y[near]
            inward = (px - qx[at]) * normal_x[at] + (py - qy[at]) * normal_y[at]
            touch |= bool(np.any((inward >= 0.0) & (inward <= DEPTH)))
    return touch


def peak_mb() -> float:
    """Largest memory of this process so far in MB; Linux counts KB, macOS bytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)


def child_peak_mb(count: int) -> float:
    """Peak memory in MB of a fresh process that works ``count`` positions with the kernel."""
    command = [sys.executable, "-m", "benchmarks.contact_kernel", "--memory", str(count)]
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def clock(run: Callable[[], object]) -> float:
    """Processor seconds of one call."""
    begin = time.process_time()
    run()
    return time.process_time() - begin


def main() -> None:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--memory", type=int, help="only work so many positions and print the peak memory in MB")
    parser.add_argument("--repeats", type=int, default=9)
    options = parser.parse_args()
    pair = make_pair()
    if options.memory:
        kernel(make_bodies(pair), pair, np.arange(options.memory) / options.memory * pair.cycle)
        print(f"{peak_mb():.1f}")
        return
    bodies = make_bodies(pair)
    turning, fixed = (np.ascontiguousarray(body.faces) for body in bodies)
    places = {count: np.arange(count) / count * pair.cycle for count in COUNTS}
    few = places[COUNTS[0]][:: COUNTS[0] // 6][:6]
    exact = exhaustive(turning, fixed, pair, few)  # compiles, too
    rng = np.random.default_rng(0)
    # Starts fall anywhere between two steps, or the answer would always be a whole step away.
    starts = few / pair.ratio + exact - START + rng.uniform(0.0, ARCSEC, few.size)

    def stepped() -> FloatArray:
        found = [
            step_until_contact(turning, fixed, axis_distance=pair.a, pose=-float(t), start=float(start))[0]
            for t, start in zip(few, starts, strict=True)
        ]
        return np.array(found) - few / pair.ratio - exact

    def literal() -> float:
        """us per position of 920 steps, from two steps at one place."""
        pose, start = -float(few[1]), float(starts[1])
        pairs = candidates(turning, fixed, pair.a, pose, start)
        run = [clock(partial(all_quadrants, turning, fixed, pairs, pair.a, pose, start + k * ARCSEC)) for k in (0, 1)]
        return statistics.mean(run) * STEPS * 1e6

    def every_tooth() -> float:
        """us per position of 920 steps, from three steps at one place."""
        pose, start = -float(few[1]), float(starts[1])
        flanks = [chords(face, pose) for face in fixed]
        run = [clock(partial(all_teeth, turning, flanks, pair.a, start + k * ARCSEC)) for k in range(3)]
        return statistics.mean(run) * STEPS * 1e6

    times: dict[str, list[float]] = {}

    def note(name: str, value: float) -> None:
        times.setdefault(name, []).append(value)

    late = stepped() * pair.r_b1 * 1e6
    for repeat in range(options.repeats):
        if repeat < 3:
            note("stepping", clock(stepped) / few.size * 1e6)
        for count in COUNTS:
            if count < 36_000 or repeat < 3:
                note(f"kernel {count}", clock(partial(kernel, bodies, pair, places[count])) / count * 1e6)
            if count < 36_000:
                note(
                    "radial gap",
                    clock(partial(exhaustive, turning, fixed, pair, places[count])) / count * 1e6,
                )
        if repeat < 2:
            note("stepping, every tooth", every_tooth())
            note("stepping, every quadrant", literal())

    once = [1e3 * clock(lambda: make_bodies(pair)) for _ in range(5)]
    middle = {name: statistics.median(values) for name, values in times.items()}
    base = middle["kernel 3600"]
    worst = float(np.max(np.abs(kernel(bodies, pair, places[3600]) - exhaustive(turning, fixed, pair, places[3600]))))
    print("| method | us/position | spread | over the kernel at 3600 |")
    print("| --- | --- | --- | --- |")
    for name, value in middle.items():
        spread = f"{min(times[name]):.0f} to {max(times[name]):.0f}" if len(times[name]) > 1 else "one run"
        print(f"| {name} | {value:.0f} | {spread} | {value / base:.3g} |")
    flat = [middle[f"kernel {count}"] for count in COUNTS]
    print()
    print(f"bodies, prepared once per pair and flank: {statistics.median(once):.0f} ms")
    print(f"kernel against radial gap at 3600 positions: {worst:.1e} rad at most")
    print(f"stepping is late by {late.min():.1f} to {late.max():.1f} nm at r_b")
    print(f"kernel over radial gap: {base / middle['radial gap']:.2f} (goal: at most 2.5)")
    for name in ("stepping", "stepping, every tooth", "stepping, every quadrant"):
        print(f"{name} over kernel: {middle[name] / base:.0f} (goal: at least 3000)")
    print(f"cost per position from 361 to 36000: {100 * (max(flat) / min(flat) - 1):.0f} % apart (goal: 20)")
    for count in COUNTS:
        print(f"peak memory at {count} positions: {child_peak_mb(count):.0f} MB (goal: below 1000)")


if __name__ == "__main__":
    main()
