"""Sizes that a fit cannot leave: what is larger would be something else."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from gearpoly.diagnose.built import contradicted
from gearpoly.diagnose.gathered import gathered
from gearpoly.diagnose.linear import within
from gearpoly.diagnose.scan import Candidate, _allowed
from gearpoly.diagnose.weigh import gain_without
from gearpoly.files.models import PairFile
from gearpoly.keys.edit import on_gear
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim, Scope
from gearpoly.physics.place import Place
from tests.made_diagnosis import findings
from tests.pair_files import pair_file
from tests.physics_cases import rough, scope_of

Z = 12, 16


def scope(*ranges: float) -> Scope:
    return replace(scope_of(rough(Z, points=120)), ranges=ranges)


@pytest.mark.parametrize("gear", [0, 1])
def test_a_fit_does_not_run_a_scale_beyond_the_next_pair_of_teeth(gear: int) -> None:
    """Both encoders' scales together take away the whole signal: v theta_2 - v (z_1/z_2) theta_1 is v times what was
    recorded. From half a tooth in 16 on, 12/15 or 12/17 fits better than 12/16."""
    claim = Claim(physics=catalogue()["encoder_scale"], place=Place(gear=gear), values=(0.0,))
    assert within(claim, np.array([-1e6]), scope(1e9)) == pytest.approx((-0.5e6 / 16,))


def test_a_scale_makes_no_ramp_beyond_what_was_recorded() -> None:
    """20 um over the recording's driving turns, at the base circle of the driven gear."""
    known = scope(20.0)
    claim = Claim(physics=catalogue()["encoder_scale"], place=Place(gear=1), values=(0.0,))
    (ppm,) = within(claim, np.array([1e6]), known)
    turned_mm = 2.0 * np.pi * known.span * (12 / 16) * known.gears[1].r_b
    assert ppm * 1e-6 * turned_mm == pytest.approx(20e-3)


def test_a_drift_is_no_larger_than_its_recording() -> None:
    """385 um of drift were told of a record of 292: each term keeps within the recording that it is about, and what
    all of them make together has to, or it is no drift."""
    drift, known = catalogue()["thermal_drift"], scope(292.0, 10.0)
    place = Place(recordings=(0,))
    claim = Claim(physics=drift, place=place, values=(0.0, 0.0, 0.0))
    assert within(claim, np.array([385.0, -385.0, 3.0]), known) == (292.0, -292.0, 3.0)
    # A ramp of Legendre's first polynomial runs from -c to c.
    assert drift.sensible(known, place, (145.0, 0.0, 0.0))
    assert not drift.sensible(known, place, (147.0, 0.0, 0.0))
    assert not drift.sensible(known, replace(place, recordings=(1,)), (6.0, 0.0, 0.0))


@pytest.mark.parametrize(("size", "gains"), [(0.5, True), (0.0, False), (1.0, False), (1.2, False)])
def test_what_the_fit_wants_at_a_bound_is_no_claim(size: float, gains: bool) -> None:
    """A coefficient of friction of nothing, or of 1 and more: something else is fitted with it."""
    claim = Claim(physics=catalogue()["friction"], place=Place(), values=(size,))
    without = SimpleNamespace(misfit=200.0)
    system = SimpleNamespace(solution=np.array([size]), misfit=100.0, without=lambda places: without)
    linear = SimpleNamespace(system=system, layout=SimpleNamespace(places=lambda k: [0]))
    search = SimpleNamespace(linear=linear, model=SimpleNamespace(claims=[claim], scope=scope()))
    assert (gain_without(cast(Any, search), 0) > 0.0) == gains


def test_the_scales_of_two_encoders_are_two_findings() -> None:
    """Each is about all recordings, so nothing is told recording by recording."""
    one = findings()[2]
    scales = [
        replace(one, claim=Claim(physics=catalogue()["encoder_scale"], place=Place(gear=gear), values=(9.0,)))
        for gear in (0, 1)
    ]
    assert gathered(cast(Any, None), list(enumerate(scales)), hold=[]) == tuple(scales)


def plain(sheet: dict[str, object] | None) -> PairFile:
    """The plainest pair file, or with the same measured of all driving teeth."""
    file = pair_file(Z, driving={"inspection": sheet or {}})
    return on_gear(file, 0, inspection=None) if sheet is None else file


@pytest.mark.parametrize("measured", [True, False])
def test_slopes_that_nobody_measured_contradict_no_inspection(measured: bool) -> None:
    """A slope of 4 um at a standard deviation of 0.5 um."""
    prior = SimpleNamespace(graded=False, pitch=np.array([[1.0]]), slope=0.5, slope_measured=measured)
    as_built = SimpleNamespace(
        gears=[prior] * 2, flanks=("drive",), pitch=lambda built, flank, gear: np.zeros(Z[gear]),
        slope=lambda built, flank, gear: 4.0 * (np.arange(Z[gear]) == 3),
    )  # fmt: skip
    model = SimpleNamespace(as_built=as_built, declared=plain({}), built=None)
    assert len(contradicted(cast(Any, SimpleNamespace(model=model)))) == (2 if measured else 0)


def test_a_candidate_far_beyond_its_bounds_is_none() -> None:
    """To first order a candidate may be half as large again as the physics can be, not more."""
    claim = Claim(physics=catalogue()["friction"], place=Place(), values=(0.0,))
    assert Candidate(claim=claim, gain=1.0, freedoms=1).log_chance(tests=1) < 0.0  # one sign only
    assert [_allowed(scope(), claim, np.array([a])) for a in (-0.1, 0.0, 1.4, 1.6)] == [False, True, True, False]


@pytest.mark.parametrize(("sheet", "says"), [(None, "from the ideal gear"), ({}, "from the inspection")])
def test_a_gear_that_nobody_inspected_contradicts_no_inspection(sheet: dict[str, object] | None, says: str) -> None:
    """Driving tooth 2 stands 3 um off what is known to 0.01."""
    prior = SimpleNamespace(graded=False, pitch=np.array([[1e-4]]), slope=0.01, slope_measured=True)
    pitch = [3.0 * (np.arange(12) == 2), np.zeros(16)]
    as_built = SimpleNamespace(
        gears=[prior] * 2, flanks=("drive",), pitch=lambda built, flank, gear: pitch[gear],
        slope=lambda built, flank, gear: np.zeros(Z[gear]),
    )  # fmt: skip
    model = SimpleNamespace(as_built=as_built, declared=plain(sheet), built=None)
    (words,) = contradicted(cast(Any, SimpleNamespace(model=model)))
    assert "driving tooth 2" in words and "3.0 um" in words and says in words
    (hurried,) = contradicted(cast(Any, SimpleNamespace(model=model)), stopped=True)
    assert ("give it longer before you inspect again" in hurried) == (sheet is not None)
