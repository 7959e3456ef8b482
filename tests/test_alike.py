"""Gears whose teeth are all alike do in every mesh what they do in one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gearpoly.mesh.alike import alike, repeated
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.mesh.transmission import contacts
from tests.pair_files import made as assembled
from tests.pair_files import pair_file


def drawn(**driven: Any) -> GearPair:
    return assembled(pair_file((12, 17), driving={"profile_shift": 0.1}, driven=driven, points=200)).pair


@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_every_mesh_is_the_first_one_with_the_next_teeth(flank: Flank) -> None:
    """Against contacts that are found anew everywhere, whose poses are rounded otherwise: 1e-11 mm is a hundred times
    what the kernel's own roundings add up to."""
    pair = drawn()
    assert alike(pair)
    theta_2 = np.arange(pair.meshes_per_cycle * 8) * (pair.driven.gear.tau / 8.0) + 1e-3
    whole = contacts(pair, theta_2, flank=flank, near=0.04, fast=True)
    made = repeated(contacts(pair, theta_2[:8], flank=flank, near=0.04, fast=True), pair, theta_2=theta_2)
    for name in ("position", "driving", "driven", "feature", "touching", "pairs"):
        assert np.array_equal(getattr(made, name), getattr(whole, name)), name
    assert made.te * pair.r_b2 == pytest.approx(whole.te * pair.r_b2, abs=1e-11)
    for name in ("theta_2", "gap", "point", "normal", "overrun"):
        assert getattr(made, name) == pytest.approx(getattr(whole, name), abs=1e-9), name


def test_one_tooth_off_its_place_or_an_axis_off_its_centre_is_enough_to_look_everywhere() -> None:
    assert not alike(drawn(inspection={"pitch_um": [0.0] * 16 + [0.01]}))
    assert not alike(drawn(eccentricity={"amplitude_um": 0.01}))
    assert alike(drawn(profile_shift=0.2))
