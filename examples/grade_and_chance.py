"""How much transmission error a grade leaves to chance: twenty pairs of grade 5, and twenty of grade 6."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

import gearpoly


def te_pp_um(grade: int, seed: int) -> float:
    """Transmission error peak to peak of one drawn pair, over a turn of the driven gear."""
    gear = {"module_mm": 2.0, "points_per_flank": 150, "grade": grade}
    known = {"pair": {"centre_distance_mm": 43.05}, "driving": {"teeth": 18, **gear}, "driven": {"teeth": 25, **gear}}
    return gearpoly.Pair.of(known, seed=seed).simulate(turns=1, points_per_mesh=12, fast=True).te_pp_um


drawn = {grade: [te_pp_um(grade, seed) for seed in range(20)] for grade in (5, 6)}
mean = {grade: float(np.mean(values)) for grade, values in drawn.items()}
for grade, values in drawn.items():
    print(f"grade {grade}: {mean[grade]:.1f} um on average, {min(values):.1f} to {max(values):.1f} um")
# Every limit grows by the root of two from grade to grade (ISO 1328-1); means of twenty scatter by some 5 % each.
assert abs(mean[6] / mean[5] - 2**0.5) < 0.2

figure = Figure(layout="constrained")
axis = figure.subplots()
for grade, values in drawn.items():
    axis.ecdf(values, label=f"grade {grade}")
axis.set_xlabel("transmission error, peak to peak / um")
axis.set_ylabel("share of pairs at or below")
axis.legend()
figure.savefig("grade_and_chance.png")
