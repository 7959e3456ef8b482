"""What nothing explains is told as large as the recordings have it, not as what graded teeth leave of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.files.models import PairFile
from gearpoly.units import UM
from tests.pair_files import made
from tests.physics_cases import Condition, recorded, rough

TEETH, ORDERS, SIZE = (19, 37), (8, 16), 15.0


def graded() -> PairFile:
    """The pair as its owner knows it."""
    one, two = ({"teeth": z, "module_mm": 2.0, "face_width_mm": 20.0, "grade": 6} for z in TEETH)
    return PairFile.model_validate({"model": {"tooth_deflection": False}, "driving": one, "driven": two})


@pytest.mark.slow
def test_waves_of_a_resolver_beside_graded_gears_have_their_own_size() -> None:
    """Graded teeth take half of an order near half their number, and leave its image on the other side. The true teeth
    (3 um rms) make 0.5 um of each order; that, and noise (0.02 um), is what the sizes may be off."""
    true, rng = rough(TEETH, bends=False, points=300), np.random.default_rng(8)
    (one,) = recorded(true, (Condition(torque_nm=0.0),), rng, cycles=1.04, noise_um=0.4)
    assert one.driving_angle_rad is not None
    assert one.driven_angle_rad is not None
    read_wrong = sum(SIZE * UM * np.cos(order * one.driving_angle_rad - 0.7) for order in ORDERS)
    driven = one.driven_angle_rad + read_wrong / made(true).pair.r_b2
    told = diagnose(graded(), [replace(one, driven_angle_rad=driven)], path=Path("pair.toml"), within=5.0)
    found = {e.order: e.amplitude_um for e in told.unexplained if e.gear == "driving"}
    for order in ORDERS:
        assert found.pop(order) == pytest.approx(SIZE, abs=1.0)
        assert TEETH[0] - order not in found


@pytest.mark.long
def test_what_no_time_was_left_to_ask_is_told_where_it_was_located() -> None:
    """An encoder off its axis, of 8 times the least size that shows, was told nowhere: teeth that nobody inspected had
    taken it, and time was over before anything else was asked. The true teeth make 1.2 um of order 1, noise 0.2 um."""
    true, rng = rough(TEETH, bends=False, points=300), np.random.default_rng(8)
    (one,) = recorded(true, (Condition(torque_nm=0.0),), rng, cycles=1.2, noise_um=6.0)
    assert one.driven_angle_rad is not None
    read_wrong = 9.0 * UM * np.cos(one.driven_angle_rad - 0.7) / made(true).pair.r_b2
    read = replace(one, driven_angle_rad=one.driven_angle_rad + read_wrong)
    told = diagnose(graded(), [read], path=Path("pair.toml"), within=0.001)
    assert not told.findings
    (turn,) = (e for e in told.unexplained if e.order == 1.0)
    assert turn.gear == "driven"
    assert turn.amplitude_um == pytest.approx(9.0, abs=3.0 * 0.2 + 1.2)
