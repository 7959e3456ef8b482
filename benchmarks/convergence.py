"""Transmission error of perfect gears against points per flank: the chords' share, its bound and its rate.

Run from the repository's root: python -m benchmarks.convergence [target.png]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.mesh.pair import mount
from gearpoly.mesh.transmission import contacts

COUNTS = (50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000)
POSITIONS = 1500
NM = 1e-6
FIGURE = Path(__file__).parents[1] / "docs" / "explanation" / "figures" / "convergence.png"


def measure() -> tuple[list[float], list[float]]:
    """Largest |TE| in nm at r_b over one pitch and the sum of both sagittas in nm, per count of points."""
    worst, bound = [], []
    for n in COUNTS:
        pair = mount(*(draw_flanks(Gear(z=z, m=2.0), points=n) for z in (18, 25)))
        theta_2 = np.arange(POSITIONS) / POSITIONS * pair.driven.gear.tau
        worst.append(float(np.max(np.abs(contacts(pair, theta_2).te))) * pair.r_b2 / NM)
        bound.append(pair.chord_noise / NM)
    return worst, bound


def main() -> None:
    """Print the table and draw the figure."""
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else FIGURE
    worst, bound = measure()
    n = np.array(COUNTS, dtype=float)
    rate = float(np.polyfit(np.log(n), np.log(worst), 1)[0])
    print("| points per flank | largest TE, nm at r_b | times (n/1000)^2 | both sagittas, nm |")
    print("| --- | --- | --- | --- |")
    for count, w, b in zip(COUNTS, worst, bound, strict=True):
        print(f"| {count} | {w:.3g} | {w * (count / 1000) ** 2:.3f} | {b:.3g} |")
    print(f"\nrate: n^{rate:.3f}")
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axis = figure.subplots()
    axis.loglog(n, 0.6 * (1000.0 / n) ** 2, color="#777777", linestyle="--", label=r"goal: 0.6 nm $(1000/n)^2$")
    axis.loglog(n, bound, color="#0072B2", linewidth=1.0, label="bound: both sagittas")
    axis.loglog(n, worst, color="#D55E00", marker="o", linestyle="none", label=f"certified contact, rate {rate:.2f}")
    axis.set_xlabel("points per flank $n$")
    axis.set_ylabel("largest |TE| of perfect 18/25 gears, nm at $r_b$")
    axis.set_title("Chords are the only error left (m = 2 mm, one pitch)", loc="left", fontsize=10)
    axis.grid(which="both", color="#777777", alpha=0.2, linewidth=0.5)
    axis.legend(frameon=False)
    target.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(target, dpi=110)


if __name__ == "__main__":
    main()
