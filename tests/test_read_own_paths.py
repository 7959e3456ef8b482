"""Columns under the contract's names in groups: a map may call them by their paths too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.recording.read import read_recording
from tests.made_texts import DEGREE, OWN, chart, run, same
from tests.test_read_paths import EVERY, UNITS, saved

RUN = run(1200)


@pytest.mark.parametrize("form", EVERY)
def test_a_column_of_the_contract_is_found_by_its_path(tmp_path: Path, form: str) -> None:
    """It was found by its name alone, where the paths of all other channels were."""
    group = "rig" if form == "tdms" else "rig/run"
    series = {name: (values, unit) for (name, values), unit in zip(RUN.items(), UNITS, strict=True)}
    file, joint = saved(tmp_path, form, {group: series, "aside": {"x": (np.arange(5.0), "")}})
    path = joint.join([*group.split("/"), OWN[1]])
    for name in (path, OWN[1], *([f"/{path}"] if form == "hdf5" else [])):
        lines = f'columns.driving_angle_deg = {{ from = "{name}", unit = "deg", sign = -1 }}\n'
        recording = read_recording(file, chart=chart(tmp_path, lines))
        assert recording.driving_direction == -1
        same(recording.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=0.0)
        same(recording.time_s, RUN["time_s"], half=0.0)
