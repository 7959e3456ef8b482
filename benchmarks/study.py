"""What a study costs: a row and its parts, the paper's Table 3, scaling beside bare processes, 1000 workers on paper.

Processor time decides (CPU), since a machine may be busy; wall time is printed beside it. From the root:
python -m benchmarks.study            # about two minutes on two free cores
"""

from __future__ import annotations

import math
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.assemble import Assembled
from gearpoly.positions import cycle_positions
from gearpoly.study.pipeline import _assembled, first_touch, make_row
from gearpoly.study.plan import StudyPlan
from gearpoly.study.read import read_study
from gearpoly.study.run import plan_study, run_study
from gearpoly.study.store import Store, opened

DATA = Path(__file__).parents[1] / "data" / "studies"
ROWS = 30
"""Rows of each scaling run; 5 s of work."""


def cpu() -> float:
    """Processor time in s of this process and of its children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def timed(run: Callable[[], Any]) -> tuple[float, float, Any]:
    """CPU and wall time in s of a call, and what it gave."""
    c, w = cpu(), time.monotonic()
    result = run()
    return cpu() - c, time.monotonic() - w, result


def bare(text: str, start: int, stop: int, barrier: Any, out: Any) -> None:
    """Rows in a process that shares nothing with anybody: no pool, no queue, no file."""
    plan = StudyPlan(text)
    make_row(plan, 0)  # imports and compiled code are not what scales
    barrier.wait()
    c, w = time.process_time(), time.monotonic()
    for index in range(start, stop):
        make_row(plan, index)
    out.put((time.process_time() - c, w, time.monotonic()))


def bare_processes(plan: StudyPlan, count: int) -> tuple[float, float]:
    """CPU in all and wall time in s of ROWS rows split over ``count`` bare processes."""
    context = get_context("spawn")
    barrier, out = context.Barrier(count), context.Queue()
    edges = np.linspace(1, ROWS + 1, count + 1).astype(int).tolist()
    workers = [context.Process(target=bare, args=(plan.text, a, b, barrier, out)) for a, b in pairwise(edges)]
    for worker in workers:
        worker.start()
    found = [out.get() for _ in workers]
    for worker in workers:
        worker.join()
    return sum(f[0] for f in found), max(f[2] for f in found) - min(f[1] for f in found)


def engine(plan: StudyPlan, workers: int) -> tuple[float, float]:
    """Wall time in s that the engine takes from its first row kept to its last of ROWS, and rows between them, so that
    starting processes, which a long study does once, is left out; returns (rows per second, rows)."""
    from gearpoly.study.local import in_processes

    stamps: list[tuple[float, int]] = []
    with tempfile.TemporaryDirectory() as folder, opened(Path(folder) / "out", plan) as store:
        kept = 0
        for rows in in_processes(plan, iter([(k, k + 1) for k in range(ROWS + 2 * workers)]), workers=workers):
            store.write(rows)
            kept += len(rows)
            stamps.append((time.monotonic(), kept))
    first = stamps[2 * workers - 1]
    return (stamps[-1][1] - first[1]) / (stamps[-1][0] - first[0]), stamps[-1][1] - first[1]


def parts(plan: StudyPlan) -> None:
    """What one row costs, part by part."""
    assembled: list[Assembled] = []
    make_row(plan, 1)
    c, _, _ = timed(lambda: assembled.extend(_assembled(plan, 0, seed) for seed in range(10)))
    theta_2 = cycle_positions(assembled[0].pair, points_per_mesh=plan.file.positions_per_mesh)
    d, _, _ = timed(lambda: [first_touch(one.pair, theta_2, flank="drive") for one in assembled])
    e, _, _ = timed(lambda: [first_touch(one.pair, theta_2, flank="coast") for one in assembled])
    f, _, _ = timed(lambda: [make_row(plan, index) for index in range(1, 11)])
    print(f"a row: {100 * f:.1f} ms CPU; drawing and flanks {100 * c:.1f}, drive {100 * d:.1f}, coast {100 * e:.1f}")
    positions = 2 * theta_2.size
    rates = positions / (0.1 * (d + e)), positions / (0.1 * f)
    print(f"  {positions} searches a row: {rates[0]:.0f} a second in the search, {rates[1]:.0f} in all")
    print(f"  10 000 pairs: {1000 * f:.0f} s CPU, {500 * f / 60:.1f} min on two free cores")


def serial(plan: StudyPlan) -> float:
    """CPU in s that the one writing process spends on a row: hand out, take in, write."""
    rows = [make_row(plan, index) for index in range(1)]
    per_part = {}
    with tempfile.TemporaryDirectory() as folder, opened(Path(folder) / "out", plan) as store:
        for size in (1, 25, 250):
            chunk = [rows[0].__class__(**{**rows[0].__dict__, "index": k}) for k in range(size)]
            store.write(chunk)
            c, _, _ = timed(partial(_twenty, store, chunk))
            per_part[size] = c / 20
    print("writing a part: " + ", ".join(f"{size} rows {1e3 * s:.2f} ms" for size, s in per_part.items()))
    return per_part[250] / 250


def _twenty(store: Store, chunk: Any) -> None:
    """Write a part twenty times: once is over too soon for the clock."""
    for _ in range(20):
        store.write(chunk)


def main() -> None:
    plan = plan_study(read_study(DATA / "tolerance.toml"))
    print(f"{sys.version.split()[0]}, 18/25 teeth, 500 points per flank, whole hunting cycle at 20 positions per mesh")
    parts(plan)
    if "--parts" in sys.argv:
        return
    with tempfile.TemporaryDirectory() as folder:
        c, w, _ = timed(lambda: run_study(read_study(DATA / "grades.toml"), out=Path(folder) / "out", workers=2))
    print(f"Table 3, 60 pairs, two workers started and ended: {w:.1f} s wall, {c:.1f} s CPU")
    # Bare and engine take turns, so that a busy machine disturbs both alike.
    rates: dict[str, list[float]] = {"bare 1": [], "bare 2": [], "engine 1": [], "engine 2": []}
    for _ in range(3):
        for count in (1, 2):
            rates[f"bare {count}"].append(ROWS / bare_processes(plan, count)[1])
            rates[f"engine {count}"].append(engine(plan, count)[0])
    best = {name: max(found) for name, found in rates.items()}
    print("rows/s, best of 3: " + ", ".join(f"{name} {rate:.2f}" for name, rate in best.items()))
    gain, could = best["engine 2"] / best["engine 1"], best["bare 2"] / best["bare 1"]
    print(f"two workers over one {gain:.2f}, two bare processes over one {could:.2f}: {100 * gain / could:.0f} % of it")
    s = serial(plan)
    p = sum(timed(partial(make_row, plan, k))[0] for k in range(1, 11)) / 10
    for workers in (2, 100, 1000):
        rate = min(workers / p, 1.0 / s)
        print(f"{workers} workers: {rate:.0f} rows/s of {workers / p:.0f}; writer busy {100 * rate * s:.1f} %")
    print(f"the writer would be full at {math.floor(p / s)} workers")


if __name__ == "__main__":
    main()
