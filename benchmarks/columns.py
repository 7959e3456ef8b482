"""Columns of teeth as built in blocks, against the same as full arrays: 21 000 samples, 30 to the mesh, in one run.

Run from the repository's root: python -m benchmarks.columns
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from dataclasses import replace

import numpy as np

from benchmarks.timing import seconds
from gearpoly.assemble import assemble
from gearpoly.compare.whitening import forward
from gearpoly.diagnose.as_built import make_as_built
from gearpoly.diagnose.prepare import gear_priors
from gearpoly.diagnose.tooth_forms import HALF_WAVES
from gearpoly.files.models import PairFile
from gearpoly.physics.samples import Samples
from gearpoly.scene import stage
from gearpoly.units import NM

SAMPLES, PER_MESH, TAPS = 21_000, 30.0, 12
PAIRS = ((18, 25), (23, 38), (31, 43), (60, 81))


def measured(z: tuple[int, int]) -> str:
    """One row of the table."""
    ar = np.full(TAPS, 0.5 / TAPS)
    sections = [{"teeth": one, "module_mm": 2.0, "face_width_mm": 20.0, "grade": 6} for one in z]
    file = PairFile.model_validate({"driving": sections[0], "driven": sections[1]})
    theta_2 = np.arange(SAMPLES) / PER_MESH * 2.0 * np.pi / z[1]
    theta_1 = theta_2 * z[1] / z[0]
    samples = Samples(
        number=0, flank="drive", torque=30.0 * NM, speed=3.0, theta_1=theta_1, theta_2=theta_2, time=None,
        reading_1=theta_1, reading_2=theta_2, direction_1=1, direction_2=1, counted=True,
    )  # fmt: skip
    scene = stage(assemble(file, path="pair.toml", seed=0), samples)
    first, second = (replace(one, form=(1.0,) * HALF_WAVES) for one in gear_priors(file)[1])
    blocks = make_as_built((first, second), ["drive"]).columns(scene)
    full = blocks.dense()
    white = blocks.forward(ar, 1.0)
    whole = forward(full, ar, 1.0)
    assert np.allclose(white.gram(), whole.T @ whole)
    held = blocks.values.nbytes / 1e6
    return (
        f"| {z[0]}/{z[1]} | {full.shape[1]} | {held:.0f} | {full.nbytes / 1e6:.0f} "
        f"| {1e3 * seconds(white.gram):.0f} | {1e3 * seconds(lambda: whole.T @ whole):.0f} "
        f"| {1e3 * seconds(lambda: blocks.forward(ar, 1.0)):.0f} "
        f"| {1e3 * seconds(lambda: forward(full, ar, 1.0)):.0f} |"
    )


def main() -> None:
    """Print the table."""
    print("| teeth | columns | memory, MB | as full arrays | normal matrix, ms | full | whitening, ms | full |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for z in PAIRS:
        print(measured(z))


if __name__ == "__main__":
    main()
