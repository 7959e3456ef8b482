"""A pair from a file: its polygons, its contacts, and the same gears five times worse as a drawing."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import gearpoly

PAIR = Path(__file__).parents[1] / "data" / "pairs" / "graded_18_25.toml"


def main(folder: Path) -> dict[str, float]:
    """Write the drawings to ``folder`` and give what was found: areas in mm^2, transmission error in um."""
    pair = gearpoly.load(PAIR, seed=7)
    area = pair.driving.polygon.area

    # One pitch of the driven gear in forty steps: which teeth touch, and what the pair transmits.
    theta_2 = np.arange(40) * pair.driven.nominal.tau / 40
    found = pair.contacts(theta_2)
    te_um = found.te * pair.mesh.r_b2 * 1e3

    pair.export(folder / "pair.svg", theta_2=0.1)
    written = pair.export(folder / "pair_x5.svg", theta_2=0.1, magnify=5.0)
    return {
        "area": area,
        "te_pp_um": float(np.ptp(te_um)),
        "pairs": float(np.mean(found.pairs)),
        "chord_um": written.chord_error * 1e3,
    }


if __name__ == "__main__":
    for name, value in main(Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp())).items():
        print(f"{name} = {value:.4f}")
