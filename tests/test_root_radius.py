"""The root of US full-depth gears: how round it may be without standing in the way of the mate's tip."""

from __future__ import annotations

import math
from typing import Any

import pytest

import gearpoly
from gearpoly.assemble import root_remarks
from gearpoly.errors import GeometryError, InputFileError, JammedError
from gearpoly.files.models import PairFile
from gearpoly.gear.gear import Gear
from gearpoly.gear.nominal import nominal_gears
from gearpoly.gear.rack import Rack, usual_round
from gearpoly.gear.root import form_point
from gearpoly.mesh.pair import active_start
from gearpoly.units import DEG


def sides(*, z: tuple[int, int] = (40, 60), **rack: float) -> dict[str, Any]:
    """A pair file of two gears with the same rack, module 2, 2 um thin so that only roots can jam."""
    thin = {"inspection": {"tooth_thickness_um": -2.0}, "chord_error_um": 0.1}
    return {
        name: {"teeth": teeth, "module_mm": 2.0, **thin, **rack}
        for name, teeth in zip(("driving", "driven"), z, strict=True)
    }


def radius(**known: float) -> float:
    return nominal_gears(PairFile.model_validate(sides(**known)))[0].rack.rho_fP


@pytest.mark.parametrize(("angle", "right"), [(20.0, 0.2386), (14.5, 0.2094)])
def test_full_depth_gears_get_the_largest_root_that_leaves_the_mates_tip_free(angle: float, right: float) -> None:
    """0.157/(1 - sin(alpha)), worked by hand to four digits."""
    known = {"dedendum": 1.157, "pressure_angle_deg": angle}
    assert radius(**known) == pytest.approx(right, abs=5e-5)
    # A file that writes the default out says the same.
    assert radius(**known, root_radius=0.38) == radius(**known)
    file = PairFile.model_validate(sides(**known))
    assert f"root_radius is {right}" in root_remarks(file)[0]


def test_the_standard_profile_keeps_its_round() -> None:
    assert radius() == 0.38
    assert root_remarks(PairFile.model_validate(sides())) == []


def test_it_is_the_mates_addendum_that_counts() -> None:
    known = sides(dedendum=1.25)
    known["driven"]["addendum"] = 1.1
    driving, driven = nominal_gears(PairFile.model_validate(known))
    assert driving.rack.rho_fP == pytest.approx(0.15 / (1.0 - math.sin(20.0 * DEG)), rel=1e-12)
    assert driven.rack.rho_fP == 0.38


@pytest.mark.parametrize("angle", [14.5, 20.0, 25.0])
def test_the_bound_is_where_drawn_roots_begin_to_reach_the_mates_tip(angle: float) -> None:
    """The largest round whose true form circle lies where the mate's tip reaches comes down to the bound as teeth grow
    in number, by a part that falls as 1/z: a rack is the limit."""
    alpha, h_fP = angle * DEG, 1.157

    def free(z: int) -> float:
        low, high = 0.0, 0.38
        for _ in range(40):
            middle = 0.5 * (low + high)
            gear = Gear(z=z, m=2.0, rack=Rack(alpha=alpha, h_fP=h_fP, rho_fP=middle))
            l_form = form_point(gear)[1]
            reached = active_start(gear, gear, l_form=l_form) == l_form
            low, high = (low, middle) if reached else (middle, high)
        return low

    bound = 0.157 / (1.0 - math.sin(alpha))
    over = [free(z) - bound for z in (200, 400, 800, 1600)]
    assert all(part > 0.0 for part in over)
    # Each doubling halves the excess: 5 % for the terms of 1/z^2 at 400 teeth.
    assert over[2] / over[1] == pytest.approx(0.5, rel=0.05)
    assert over[3] / over[2] == pytest.approx(0.5, rel=0.05)
    assert usual_round(alpha=alpha, h_fP=h_fP, h_aP=1.0) == pytest.approx(bound, rel=1e-12)


def test_full_depth_gears_turn_as_they_stand_and_a_rounder_root_is_named_where_they_jam() -> None:
    known = sides(z=(120, 160), dedendum=1.157, pressure_angle_deg=14.5)
    run = gearpoly.Pair.of(known).simulate(turns=0.007, points_per_mesh=30, fast=True)
    assert run.summary["backlash_least_um"] > 0.0
    round_ = sides(z=(120, 160), dedendum=1.157, pressure_angle_deg=14.5, root_radius=0.37)
    with pytest.raises(JammedError, match=r"root_radius = 0\.37 .* at most 0\.2094 leaves it free"):
        gearpoly.Pair.of(round_).simulate(turns=0.007, points_per_mesh=30, fast=True)


def test_above_32_deg_it_is_the_dedendum_that_has_to_give() -> None:
    known = sides(pressure_angle_deg=35.0)
    with pytest.raises(InputFileError, match=r"dedendum = 1\.25.* at most 1\.1216 would do") as refusal:
        gearpoly.Pair.of(known)
    assert "root_radius" not in str(refusal.value)
    # The cure works: (pi/4)/tan(35 deg) = 1.12166.
    assert gearpoly.Pair.of(sides(pressure_angle_deg=35.0, dedendum=1.1216)).driving.nominal.rack.rho_fP >= 0.0
    with pytest.raises(GeometryError, match="at most"):
        Rack(alpha=35.0 * DEG, h_fP=1.1217, rho_fP=0.0)
