"""What every process of the tests would compile for itself on a fresh clone, compiled once before they begin.

``make test`` runs it while types are checked. Python's own compiled modules spare each start of a command 0.5 s, what
numba compiles spares a worker 15 s for the search of closing pairs and 12 s for the contacts of the bench.
"""

from __future__ import annotations

import compileall
from pathlib import Path

import gearpoly
from gearpoly.proving.samples import SAMPLES, files

ROOT = Path(__file__).parents[1]


def main() -> None:
    """Also where Python is told not to keep what it compiles: commands that tests start read what is there."""
    compileall.compile_dir(ROOT / "gearpoly", quiet=1)
    gearpoly.load(ROOT / "data" / "pairs" / "graded_18_25.toml").simulate(turns=0.01, fast=True)
    list(files(next(one for one in SAMPLES if one.name == "encoder_off_centre")))


if __name__ == "__main__":
    main()
