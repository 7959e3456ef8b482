"""How much memory a comparison takes, over the numbers that it compares."""

from __future__ import annotations

import importlib
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.template import make_template
from gearpoly.mesh.condition import Condition
from gearpoly.recording.recording import Recording
from gearpoly.units import UM
from tests.made_recordings import TURN, inspected

MOST = 10.0
"""Times the recording's numbers that may be held at once, by the issue."""


@pytest.mark.slow
def test_a_million_samples_take_ten_times_their_numbers(tmp_path: Path) -> None:
    """Time and two angles, 24 MB; what does not grow with the recording (three hunting cycles searched at a time, some
    70 MB) is in it. numpy reports every array to tracemalloc."""
    rng = np.random.default_rng(1)
    file, path, made = inspected(tmp_path, rng, gauge=0.2)
    template = make_template(made, Condition(flank="drive", torque=0.0))
    pair, n, per_mesh = made.pair, 1_000_000, 200
    theta_2 = 3.0 + (np.arange(n) + rng.uniform(-0.3, 0.3, n)) * (TURN / pair.driven.gear.z / per_mesh)
    theta_1 = (theta_2 - (template.at(theta_2) + rng.normal(0.0, 0.3 * UM, n)) / pair.r_b2) / pair.ratio
    recording = Recording(
        source=Path("long.csv"),
        time_s=np.arange(n) * 5e-5,
        driving_angle_rad=np.mod(theta_1 + 1.0, TURN),
        driven_angle_rad=np.mod(theta_2 + 2.0, TURN),
        torque_nm=0.0,
    )
    del theta_1, theta_2
    arrays = [recording.time_s, recording.driving_angle_rad, recording.driven_angle_rad]
    numbers = sum(array.nbytes for array in arrays if array is not None)
    # What is imported and compiled at the first comparison is no part of it.
    few = [None if array is None else array[:20_000] for array in arrays]
    compare(
        file, [replace(recording, time_s=few[0], driving_angle_rad=few[1], driven_angle_rad=few[2])], path=path
    )  # fmt: skip
    tracemalloc = importlib.import_module("tracemalloc")
    tracemalloc.start()
    found = compare(file, [recording], path=path)
    peak = numbers + tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert not found.located.entries
    assert math.isclose(found.located.noise_level, 0.3 * UM, rel_tol=0.02)  # a million samples, all of them used
    assert peak < MOST * numbers
