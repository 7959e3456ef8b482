"""What every process of the tests would compile for itself on a fresh clone, compiled once before they begin.

``make test`` runs it while types are checked. Python's own compiled modules spare each start of a command 0.5 s, what
numba compiles spares a worker 15 s for the search of closing pairs, 12 s for the contacts of the bench and 10 s for the
oracle of the kernel.
"""

from __future__ import annotations

import compileall
import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import gearpoly
from gearpoly.proving.samples import SAMPLE_SET_UPS, files
from gearpoly.study.read import read_study
from gearpoly.study.run import run_study
from tests.oracles.radial_gap import closing_rotations
from tests.study_files import GRADES, write_study

ROOT = Path(__file__).parents[1]


def main() -> None:
    """Also where Python is told not to keep what it compiles: commands that tests start read what is there."""
    compileall.compile_dir(ROOT / "gearpoly", quiet=1)
    graded = gearpoly.load(ROOT / "data" / "pairs" / "graded_18_25.toml")
    graded.simulate(turns=0.01, fast=True)
    list(files(next(one for one in SAMPLE_SET_UPS if one.name == "encoder_off_centre")))
    recorded = ROOT / "data" / "recordings" / "healthy"
    gearpoly.load(recorded / "pair.toml").compare(recorded / "rec_0.csv")
    bodies = graded.mesh.driving.body("drive"), graded.mesh.driven.body("drive")
    at = np.zeros(1)
    closing_rotations(*(one.faces for one in bodies), axis_distance=graded.mesh.a, poses=at, guesses=at)
    if find_spec("pyarrow") is not None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder)
            run_study(read_study(write_study(path, GRADES, pairs=1)), out=path / "out")


if __name__ == "__main__":
    main()
