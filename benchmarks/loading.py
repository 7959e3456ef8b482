"""What load sharing adds to the fast contact path: 18 000 positions of 18/25 at 2000 points per flank, in one run.

Run from the repository's root: python -m benchmarks.loading
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.timing import seconds
from gearpoly.assemble import assemble
from gearpoly.files.pairfile import read_pair
from gearpoly.mesh.deflection import Elasticity, pair_compliance
from gearpoly.mesh.loaded import load_reach, loaded
from gearpoly.mesh.transmission import NEAR_PAIR_MM, contacts
from gearpoly.units import NM

PAIR = Path(__file__).parents[1] / "data" / "pairs" / "graded_18_25.toml"
POSITIONS = 18_000


def main() -> None:
    """Print the table."""
    pair = assemble(read_pair(PAIR), path=PAIR, seed=1).pair
    theta_2 = np.arange(POSITIONS) * pair.cycle / POSITIONS
    print("| torque / N.m | contacts, us/position | load sharing, us/position | adds |")
    print("| --- | --- | --- | --- |")
    compliance = pair_compliance(pair, Elasticity())
    for torque in (5.0 * NM, 25.0 * NM, 120.0 * NM):
        near = NEAR_PAIR_MM + load_reach(compliance, torque)
        found = contacts(pair, theta_2, near=near, fast=True)
        bare = seconds(partial(contacts, pair, theta_2, near=near, fast=True)) / POSITIONS * 1e6
        load = seconds(partial(loaded, found, compliance, torque=torque)) / POSITIONS * 1e6
        print(f"| {torque / NM:g} | {bare:.1f} | {load:.1f} | {load / bare:.0%} |")


if __name__ == "__main__":
    main()
