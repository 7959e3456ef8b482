"""A declared pair that cannot turn is said to, although a recording of one flank never asks for the other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.stand_in import known_pair
from gearpoly.compare.turns import jam_remarks
from gearpoly.files.models import PairFile
from tests.pair_files import made
from tests.physics_cases import Condition, recorded


def pair(thickness_um: float) -> PairFile:
    """Small gears of which each has teeth of that thickness beside the nominal."""
    sheet = {"tooth_thickness_um": thickness_um, "uncertainty_um": 0.2}
    gear = {"module_mm": 1.0, "face_width_mm": 5.0, "points_per_flank": 200, "inspection": sheet}
    gears = {"driving": {"teeth": 14, **gear}, "driven": {"teeth": 21, **gear}}
    return PairFile.model_validate({"model": {"tooth_deflection": False}, **gears})


def test_gears_that_turn_need_no_word() -> None:
    assert list(jam_remarks(made(pair(-40.0)).pair)) == []


def test_overlapping_teeth_are_told_with_their_overlap() -> None:
    """Each of two gears is 15 um too thick: along the line of action 30 um times the cosine of 20 deg too much."""
    (remark,) = jam_remarks(made(pair(15.0)).pair)
    overlap = float(remark.split("overlap by ")[1].split(" um")[0])
    # Polygons of 200 points stand in by less than 0.1 um.
    assert abs(overlap - 30.0 * np.cos(np.radians(20.0))) < 0.1
    assert "Each flank is compared by itself" in remark


@pytest.mark.long
def test_a_recording_of_one_flank_is_compared_all_the_same(tmp_path: Path) -> None:
    recordings = recorded(pair(-40.0), (Condition(torque_nm=0.0),), np.random.default_rng(3), cycles=2.0)
    comparison = compare(pair(15.0), recordings, path=tmp_path / "pair.toml")
    assert comparison.remarks[0].startswith("as declared, the gears jam")
    assert list(jam_remarks(known_pair(pair(-40.0), path=tmp_path / "pair.toml").pair)) == []
