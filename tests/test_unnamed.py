"""Places that are left without a name before anything is claimed there."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.diagnose.at_place import PlaceWeighed
from gearpoly.diagnose.scan import Candidate
from gearpoly.diagnose.unnamed import left_unnamed, slow_unnamed, waves_unnamed
from gearpoly.infer.load_wave import LOAD_WAVE
from gearpoly.infer.posterior import Posterior
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from tests.made_fits import MadeFit
from tests.physics_cases import rough, scope_of

N = 400


def fit(monkeypatch: pytest.MonkeyPatch, *, coincidental: set[int], clear: set[int]) -> Any:
    """A fit of a 30/45 whose waves of these orders may be of those that no pair makes, and stand out."""
    theta = np.linspace(0.0, 40.0, N)
    samples = SimpleNamespace(theta_1=1.5 * theta, theta_2=theta, reading_1=1.5 * theta, reading_2=theta, number=0)
    gears = [SimpleNamespace(z=30), SimpleNamespace(z=45)]
    scene = SimpleNamespace(samples=SimpleNamespace(**vars(samples), flank="drive"), gear=lambda k: gears[k])
    module = "gearpoly.diagnose.unnamed"
    monkeypatch.setattr(f"{module}.beyond_floors", lambda fit, one: one.claim.place.order in clear)
    monkeypatch.setattr(f"{module}.by_coincidence", lambda fit, one: one.claim.place.order in coincidental)
    monkeypatch.setattr(f"{module}.size_of", lambda fit, one: 1e-4)
    return MadeFit(
        model=SimpleNamespace(unnamed=(), strangers=(), slow_courses=0, scope=SimpleNamespace(gears=gears)),
        foreign=[np.zeros((N, 0))],
        scenes=[scene],
    )


def wave(gear: int, order: int) -> Candidate:
    physics = catalogue()["encoder_interpolation"]
    return Candidate(
        claim=Claim(physics=physics, place=Place(gear=gear, order=order), values=(1.0, 0.0)), gain=100.0, freedoms=2
    )


def test_waves_that_may_be_any_are_fitted_once_and_never_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Order 28 of the driving shaft is order 42 of the driven one. Order 11 is the pair's own and larger than any
    stranger, order 7 does not stand out, and a tooth is no wave."""
    one = fit(monkeypatch, coincidental={28, 42, 7}, clear={28, 42, 11})
    pitch = Candidate(
        claim=Claim(physics=catalogue()["tooth_pitch"], place=Place(gear=0, tooth=3), values=(9.0,)),
        gain=50.0,
        freedoms=1,
    )
    found = [wave(0, 28), wave(1, 42), wave(0, 7), wave(0, 11), pitch]
    one = waves_unnamed(one, found)
    (place,) = one.model.unnamed
    assert place.claim.place.order == 28
    assert (place.posterior.unknown, place.seen) == (1.0, True)
    (columns,) = one.foreign
    angle = 28 * one.scenes[0].samples.theta_1
    assert columns == pytest.approx(np.column_stack((np.cos(angle), np.sin(angle))))
    assert one.model.strangers == ((0, 1),)
    none = fit(monkeypatch, coincidental=set(), clear={28})
    assert waves_unnamed(none, found) is none


@pytest.mark.parametrize(("order", "left"), [(42, False), (40, True)])
def test_no_wave_of_no_cause_stands_beside_a_claim_of_its_order(order: int, left: bool) -> None:
    """It would take over what the claim does, and neither could be weighed."""
    model = SimpleNamespace(
        unnamed=(), strangers=(), slow_courses=0, claims=(wave(1, 42).claim,),
        change=lambda scenes, claim, values: [np.full(N, 1e-3)],
    )  # fmt: skip
    one = MadeFit(model=model, foreign=[np.zeros((N, 0))], scenes=[None])
    surely = PlaceWeighed(posterior=Posterior(claims=(), unknown=1.0, nothing=0.0), unknown=[np.ones((N, 2))])
    there = left_unnamed(one, wave(1, order).claim, surely)  # type: ignore[arg-type]
    assert (there is not None) == left


@pytest.mark.parametrize(("given", "left"), [(1.0, True), (0.1, False)])
def test_a_torque_that_pulses_stands_beside_what_it_may_twist_shafts_by(given: float, left: bool) -> None:
    """Shafts give five times what teeth do: beside 3 um of an encoder 1 um of what teeth give is weighed with it, 0.1
    um says nothing of it. Which order of which shaft pulses is known from then on."""
    encoder = Claim(physics=catalogue()["encoder_eccentricity"], place=Place(gear=1), values=(3.0, 0.0))
    pulses = Claim(physics=LOAD_WAVE, place=Place(gear=1, order=1), values=(0.1, 0.0))
    scope = scope_of(rough(points=120))
    model = SimpleNamespace(
        unnamed=(), strangers=(), slow_courses=0, claims=(encoder,), scope=scope,
        change=lambda scenes, claim, values: [np.full(N, given * 1e-3)],
        rms_of=lambda scenes, claim: (3.0 if claim is encoder else given) * 1e-3,
    )  # fmt: skip
    one = MadeFit(model=model, foreign=[np.zeros((N, 0))], scenes=[None])
    surely = PlaceWeighed(posterior=Posterior(claims=(), unknown=1.0, nothing=0.0), unknown=[np.ones((N, 2))])
    there = left_unnamed(one, pulses, surely)  # type: ignore[arg-type]
    assert (there is not None) == left
    if there is not None:
        assert there.model.scope.pulses == ((1, 1, pytest.approx(given * 1e-3)),)


@pytest.mark.parametrize(("unknown", "left"), [(0.97, True), (0.8, False)])
def test_a_slow_course_of_no_cause_is_fitted_and_goes_on(
    unknown: float, left: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where a drift of no cause is surely likelier than one of the catalogue, its curve stands in the fit as the last
    of the columns; where it is not sure, or nothing slow is left, nothing is changed."""
    physics = catalogue()["thermal_drift"]
    drift = Candidate(
        claim=Claim(physics=physics, place=Place(recordings=(0,)), values=(1.0, 0.2, 0.1)), gain=90.0, freedoms=3
    )
    curve = np.linspace(-1.0, 1.0, N)[:, None]
    weighed = PlaceWeighed(posterior=Posterior(claims=(), unknown=unknown, nothing=0.0), unknown=[curve])
    monkeypatch.setattr("gearpoly.diagnose.unnamed._weighed_at", lambda fit, claim: weighed)
    model = SimpleNamespace(
        unnamed=(), strangers=((0, 1),), slow_courses=0, change=lambda scenes, claim, values: [np.full(N, 1e-3)]
    )
    one: Any = MadeFit(model=model, foreign=[np.ones((N, 2))], scenes=[None])
    there = slow_unnamed(one, [wave(0, 11), drift])
    assert (there is not one) == left
    assert slow_unnamed(one, [wave(0, 11)]) is one
    if left:
        np.testing.assert_array_equal(there.foreign[0], np.concatenate((np.ones((N, 2)), curve), axis=1))
        assert (there.model.slow_courses, there.model.strangers) == (1, ((0, 1),))
        assert there.model.unnamed[0].claim is drift.claim
