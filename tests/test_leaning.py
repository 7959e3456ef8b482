"""Flanks that all lean far beyond their grade are found where unloaded teeth touch elsewhere because of it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.fit import BETTER_STATE_GAIN, Fit
from gearpoly.diagnose.kept import kept
from gearpoly.diagnose.leaning import leaning
from gearpoly.diagnose.prepare import prepare
from gearpoly.files.models import PairFile
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from tests.physics_cases import ZEROS, Condition, recorded

Z = 18, 25


@cache
def begun(slope_um: float, *, torque_nm: float = 0.0) -> Fit:
    """Teeth as built of an 18/25 of grade 6 whose driving flanks all lean by ``slope_um``, fitted; zeros were read."""
    rng = np.random.default_rng(5)
    true: dict[str, Any] = {"model": {"tooth_deflection": torque_nm > 0.0}}
    known: dict[str, Any] = {"model": {"tooth_deflection": torque_nm > 0.0}}
    for name, z, slope in zip(("driving", "driven"), Z, (slope_um, 0.0), strict=True):
        basis: dict[str, Any] = {"teeth": z, "module_mm": 2.0, "face_width_mm": 20.0, "points_per_flank": 400}
        sheet = {
            "pitch_um": np.round(np.cumsum(rng.normal(0.0, 1.2, z)), 3).tolist(),
            "profile_slope_um": (slope + rng.normal(0.0, 0.7, z)).round(3).tolist(),
            "tooth_thickness_um": -60.0,
        }
        true[name] = {**basis, "inspection": sheet}
        known[name] = {**basis, "grade": 6, "limits": {"E_sns_um": -50, "E_sni_um": -70}}
    file = PairFile.model_validate(known)
    condition = Condition(torque_nm=torque_nm)
    (one,) = recorded(PairFile.model_validate(true), (condition,), rng, cycles=0.6, per_mesh=14, noise_um=0.5)
    one = replace(one, driving_zero_rad=ZEROS[0], driven_zero_rad=ZEROS[1])
    path = Path("pair.toml")
    model = prepare(file, compare(file, [one], path=path), path=path)
    return Fit.begun(model, [np.zeros((each.samples.size, 0)) for each in model.observed], lambda _: None)


@pytest.mark.long
def test_a_slope_of_three_limits_is_found_from_a_start_of_its_own() -> None:
    """f_Halpha of grade 6 is 7 um for both gears (ISO 1328-1:2013), so 19 um on one are more than both may have."""
    fit = begun(19.0)
    there = leaning(fit, kept(fit))
    assert there is not None
    (slope,) = there.model.claims
    assert slope.physics.name == "profile_slope"
    assert slope.place.gear == 0
    # What the mates' slopes may have too, 1.75 um each beforehand, is told by corners alone.
    assert slope.values[0] == pytest.approx(19.0, abs=5.0)
    assert there.linear.under(fit.noises).system.misfit < fit.linear.system.misfit - BETTER_STATE_GAIN


@pytest.mark.slow
def test_nothing_leans_that_keeps_its_grade() -> None:
    """Where a claim of nothing leads to a lower minimum of unloaded teeth, it is small; else no state is better."""
    there = leaning(begun(0.0), kept(begun(0.0)))
    assert there is None or abs(there.model.claims[0].values[0]) < 7.0


@pytest.mark.long
def test_nothing_is_begun_anew_where_it_is_claimed_or_time_is_over() -> None:
    fit = begun(19.0)
    slope = Claim(physics=catalogue()["profile_slope"], place=Place(gear=0), values=(5.0,))
    claimed = fit.believing(claims=(slope,))
    assert leaning(claimed, kept(claimed)) is None
    assert leaning(fit.believing(budget=replace(fit.model.budget, seconds=0.0)), kept(fit)) is None
