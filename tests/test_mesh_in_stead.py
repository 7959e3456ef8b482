"""Several physics of all teeth against one curve of no cause at every mesh."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.fit import joined, settled
from gearpoly.diagnose.in_stead import _log_evidence, _of_values, mesh_in_stead
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.units import UM
from tests.physics_cases import Condition, recorded, rough, scope_of

RELIEF, LENGTH = 15.0, 0.9


def relieved(gear: int) -> Claim:
    physics = catalogue()["tip_relief"]
    place = next(one for one in physics.places(scope_of(rough((12, 16)))) if one.gear == gear)
    return Claim(physics=physics, place=place, values=(RELIEF, LENGTH))


@pytest.mark.slow
@pytest.mark.parametrize("hidden", ["reliefs", "line"])
def test_two_reliefs_have_a_name_only_where_they_are_more_than_one_wave(hidden: str, tmp_path: Path) -> None:
    """15 um off the tips of both gears, or 1.3 um at mesh order 2 that another wheel on the shaft has made. Either is
    fitted with two reliefs, each needed beside the other."""
    known, rng = rough((12, 16), bends=False), np.random.default_rng(4)
    true = known
    if hidden == "reliefs":
        for one in (relieved(0), relieved(1)):
            true = one.written(true)
    (one,) = recorded(true, (Condition(torque_nm=0.0),), rng, cycles=4.0, per_mesh=16)
    assert one.driven_angle_rad is not None and one.driving_angle_rad is not None
    if hidden == "line":
        wave = 1.3 * UM / scope_of(known).gears[1].r_b * np.cos(2 * 12 * one.driving_angle_rad)
        one = replace(one, driven_angle_rad=one.driven_angle_rad + wave)
    path = tmp_path / "pair.toml"
    model = prepare(known, compare(known, [one], path=path), path=path)
    search = from_declared(model, [np.zeros((one.samples.size, 0)) for one in model.observed], lambda _: None)
    search = settled(joined(search, [relieved(0), relieved(1)]))
    before, misfit = [claim.values for claim in search.model.claims], search.linear.system.misfit
    unknown = mesh_in_stead(search, search.model.claims)
    assert unknown < 0.01 if hidden == "reliefs" else unknown > 0.99
    assert [claim.values for claim in search.model.claims] == before
    assert search.linear.system.misfit == misfit


def test_a_state_that_gears_could_not_reach_is_weighed_by_the_values_its_misfit_is_of() -> None:
    """A tooth of which 1 um was reached and the straight line leads on to 42 um: of these it has its misfit, and these
    are as unlikely as 42 um of any tooth. Weighed as 1 um, a curve of no cause took the name of 40 um of pitch."""
    one = Claim(physics=catalogue()["tooth_pitch"], place=Place(gear=0, tooth=3), values=(1.0,))
    system = SimpleNamespace(misfit=10.0, solution=np.array([42.0]), covariance=np.array([[0.25]]))
    linear: Any = SimpleNamespace(system=system, layout=SimpleNamespace(claims=[slice(0, 1)]))
    inspected = SimpleNamespace(gears=(SimpleNamespace(graded=False),) * 2)
    search: Any = SimpleNamespace(model=SimpleNamespace(claims=[one], scope=None, as_built=inspected))
    size = one.physics.ordinary[0]
    as_it_is = -5.0 + _of_values(np.array([42.0]), np.array([[0.25]]), np.array([[size**2]]), 1)
    assert _log_evidence(search, linear, [one], 1.0) == pytest.approx(as_it_is)
    assert as_it_is < -5.0 + _of_values(np.array([1.0]), np.array([[0.25]]), np.array([[size**2]]), 1)
