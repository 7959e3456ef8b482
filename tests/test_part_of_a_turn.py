"""Figures over a part of a turn do not depend on where in a mesh the part ends."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gearpoly
from gearpoly.positions import cycle_positions

SIDES: dict[str, Any] = {
    name: {"teeth": z, "module_mm": 2.0, "face_width_mm": 20.0, "chord_error_um": 0.05}
    for name, z in (("driving", 18), ("driven", 25))
}
PAIR = gearpoly.Pair.of(SIDES | {"pair": {"centre_distance_mm": 43.02}})
FIGURES = (
    "te_pp_um", "te_mean_um", "backlash_mean_um", "backlash_least_um", "contact_ratio", "mesh_stiffness_mean_n_per_um",
    "deflection_mean_um", "share_largest", "force_largest_n",
)  # fmt: skip


def figures(turns: float, *, torque_nm: float) -> dict[str, float]:
    summary = PAIR.simulate(turns=turns, points_per_mesh=12, torque_nm=torque_nm, fast=True).summary
    return {key: summary[key] for key in FIGURES if key in summary}


@pytest.mark.long
@settings(max_examples=6, deadline=None, derandomize=True)
@given(turns=st.floats(0.001, 0.2), torque_nm=st.sampled_from([0.0, 25.0]))
def test_any_part_of_a_turn_of_equal_teeth_gives_the_figures_of_one_mesh(turns: float, torque_nm: float) -> None:
    one = figures(1.0 / 25.0, torque_nm=torque_nm)
    # Every mesh is the same: sums of hundreds of values round by 1e-13, the place of a change of pairs is found to
    # 2e-3 of a pitch, each time from other digits.
    for key, value in figures(turns, torque_nm=torque_nm).items():
        assert value == pytest.approx(one[key], rel=1e-6, abs=1e-9 if key != "contact_ratio" else 4e-3), key


@pytest.mark.parametrize(("turns", "meshes"), [(0.1, 3), (0.04, 1), (0.0400001, 2), (0.0, 1), (0.12, 3), (1.0, 25)])
def test_positions_end_with_a_mesh(turns: float, meshes: int) -> None:
    theta_2 = cycle_positions(PAIR.mesh, turns=turns, points_per_mesh=8)
    assert theta_2.size == 8 * meshes
    assert np.ptp(theta_2) == pytest.approx((meshes - 1 / 8) * 2.0 * np.pi / 25, rel=1e-12)
