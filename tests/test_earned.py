"""A name is earned against causes that nobody knows, and the verdict says how probable each is."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.diagnose import earned as earned_module
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.earned import _Weighing, _with_both, earned
from gearpoly.diagnose.judge import Judged
from gearpoly.diagnose.scan import Candidate, Looked
from gearpoly.diagnose.turn_in_stead import Turn
from gearpoly.infer.posterior import Posterior
from gearpoly.infer.prior import (
    LINE_COUNTS,
    ONCE_PER_TURN,
    SIDE_BAND,
    TURNS_WITH_IT,
    TWISTS_WITH_PULSES,
    of_another_part,
    same_place,
    share_of_causes,
    twist,
    unknown_share,
)
from gearpoly.infer.unknown import UNKNOWN_TOOTH_KNOTS, Unknown, harmonics_of, mesh_std
from gearpoly.keys.sections import AlsoTurns
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.prove.diagnoser import How, gearpoly
from gearpoly.recording.recording import Recording
from gearpoly.report.diagnosis_report import verdict_json
from gearpoly.units import UM
from tests.at_hand import SHIPPED
from tests.made_fits import MadeFit
from tests.physics_cases import Condition, claim_of, recorded, rough, scope_of

TO = 0.011
"""What is below 0.01 is left out of the verdict."""


def shipped(name: str) -> dict[str, Any]:
    folder = SHIPPED / name
    return gearpoly(folder / "pair.toml", sorted(folder.glob("rec_*")), How())


def claim(name: str, **place: Any) -> Claim:
    return Claim(physics=catalogue()[name], place=Place(**place), values=())


@pytest.mark.slow
def test_probabilities_of_a_name_its_look_alikes_and_the_unknown_add_up_to_one() -> None:
    (one,) = shipped("encoder_off_centre")["missing"]
    assert one["physics"] == "encoder_eccentricity"
    alike = sum(rival["probability"] for rival in one["indistinguishable_from"])
    assert one["probability"] + alike + one["unknown_probability"] == pytest.approx(1.0, abs=TO)
    # A wave of no cause predicts the same to the last figure, so the share of such causes is all that decides.
    assert 0.0 < one["unknown_probability"] < ONCE_PER_TURN / 0.4


def with_waves(*waves: tuple[float, float], seed: int = 2) -> dict[str, Any]:
    """The verdict on a pair as declared whose rig adds waves per turn of the driving shaft, each an order and um."""
    file, path = rough(points=300), Path("pair.toml")
    (one,) = recorded(file, (Condition(torque_nm=20.0),), np.random.default_rng(seed), per_mesh=24)
    assert one.driving_angle_rad is not None and one.driven_angle_rad is not None
    r_b2 = 0.5 * 16 * file.driven.module_mm * math.cos(math.radians(20.0))
    wave = sum(size * UM / r_b2 * np.cos(order * one.driving_angle_rad + 0.7) for order, size in waves)
    changed = Recording(**{**vars(one), "driven_angle_rad": one.driven_angle_rad + wave})
    return verdict_json(diagnose(file, [changed], path=path))


def test_what_lost_its_place_to_another_is_tried_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wave of the other shaft is no other name of a tooth: both are fitted together, and the tooth stands again where
    that pays. What is of one place is one or the other."""
    asked: list[Claim] = []

    def claimed(fit: Any, one: Candidate, found: list[Candidate]) -> Any:
        asked.append(one.claim)
        return fit

    monkeypatch.setattr("gearpoly.diagnose.earned.claimed", claimed)
    search: Any = MadeFit()
    tooth, wave = claim("tooth_pitch", gear=1, tooth=4), claim("encoder_eccentricity", gear=0)
    assert _with_both(search, tooth, wave, gain=120.0) is search
    assert asked == [tooth]
    assert _with_both(search, tooth, claim("tooth_spall", gear=1, tooth=4), gain=120.0) is None
    assert asked == [tooth]


@pytest.mark.parametrize(
    ("unknown", "of_turn", "named"), [(0.02, 0.0, ["undulation"]), (0.9, 0.0, []), (0.02, 0.9, [])]
)
def test_where_time_is_over_waves_alone_are_named(
    unknown: float, of_turn: float, named: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing has to be fitted to its end to weigh a wave of a whole order, and a curve over the turn that may have
    made it; what turns once with a shaft, a tooth and what all teeth have is told as a place."""
    claims = (
        claim("undulation", gear=1, order=40, flank="drive"),
        claim("eccentricity", gear=0),
        claim("tooth_pitch", gear=0, tooth=3),
        claim("wear", gear=0),
    )
    model = SimpleNamespace(claims=claims, unnamed=(), scope=scope_of(rough((18, 25))), rms_of=lambda scenes, one: 1e-4)
    search: Any = MadeFit(model=model, over=True, looked=Looked())

    def judge(model: Any, scenes: Any, linear: Any, k: int, **_: Any) -> Judged:
        own = ((claims[k], 1.0 - unknown),)
        return Judged(gain=900.0, posterior=Posterior(claims=own, unknown=unknown, nothing=0.0))

    monkeypatch.setattr("gearpoly.diagnose.earned.judge", judge)
    turn = Turn(unknown=of_turn, curve=Unknown(name="", columns=[], std=np.zeros(0), weight=1.0), waves=[])
    monkeypatch.setattr("gearpoly.diagnose.earned.turn_in_stead", lambda search, claims, gear: turn)
    _, judged, gone = earned(search, {})
    assert [key[0] for key in judged] == named
    places = {one.claim.physics.name: one.posterior for one in gone}
    assert set(places) == {one.physics.name for one in claims} - set(named)
    assert places["wear"] is None and places["tooth_pitch"] is None


@pytest.mark.slow
def test_a_wave_five_times_per_turn_is_located_and_not_named() -> None:
    """Worms, couplings and poles of a motor make whole low orders; an encoder may, and is told as one of them."""
    found = with_waves((5.0, 1.5))
    assert not found["missing"]
    (one,) = [e for e in found["unexplained"] if e["kind"] == "shaft_order" and e.get("order") == 5]
    assert one["amplitude_um"] == pytest.approx(1.5, rel=0.1)
    assert one["probability"] > 0.99
    named = {cause["physics"]: cause["probability"] for cause in one["could_be"]}
    assert 0.05 < named["encoder_interpolation"] < 0.95


@pytest.mark.slow
@pytest.mark.parametrize("wheel", [True, False])
def test_once_per_turn_has_no_name_where_another_wheel_turns_with_the_shaft(wheel: bool) -> None:
    """A line at order 17 beside 12 teeth is another wheel's, which may be off its axis as the gear may be. Without it
    the gear or its encoder is named."""
    found = with_waves((1.0, 6.0), *([(17.0, 0.8)] if wheel else []))
    if not wheel:
        assert {one["gear"] for one in found["missing"]} == {"driving"}
        return
    assert not found["missing"]
    once = [e for e in found["unexplained"] if e["kind"] == "shaft_order" and e.get("order") == 1]
    assert [e["gear"] for e in once] == ["driving"]
    assert {cause["physics"] for cause in once[0]["could_be"]} >= {"eccentricity", "encoder_eccentricity"}
    assert sum(cause["probability"] for cause in once[0]["could_be"]) == pytest.approx(0.5, abs=0.1)


def test_what_shows_another_part_is_no_wave_of_the_pair() -> None:
    """Of 12 teeth: half a wave per tooth and less may be pitch, 12 and three beside it are the mesh, above 24 comes a
    cutting machine, and encoders have 60 lines."""
    scope = scope_of(rough(points=120))
    ones = [claim("undulation", gear=0, order=order) for order in (2, 6, 7, 9, 12, 15, 16, 20, 21, 25, 60)]
    assert [one.place.order for one in ones if of_another_part(one, scope)] == [7, 16, 20]
    assert not of_another_part(claim("tooth_pitch", gear=0, tooth=7), scope)
    once = claim("eccentricity", gear=0)
    assert unknown_share(once, scope) == ONCE_PER_TURN
    assert unknown_share(once, replace(scope, others_turn=(True, False))) == TURNS_WITH_IT
    assert unknown_share(once, replace(scope, others_turn=(False, True))) == ONCE_PER_TURN
    wheel = AlsoTurns(name="wheel beside it", turns_per_driving=1.0, teeth=31)
    beside = replace(scope, file=scope.file.model_copy(update={"also_turns": [wheel]}))
    assert unknown_share(once, beside) == TURNS_WITH_IT
    assert unknown_share(claim("eccentricity", gear=1), beside) == ONCE_PER_TURN


def test_shafts_twist_by_a_torque_that_pulses_at_its_order_only() -> None:
    """Of 0.9 um of what teeth give, shafts may give five times as much, one standard deviation, and nearly always do
    something; a tooth does not turn with it."""
    scope = replace(scope_of(rough(points=120)), pulses=((0, 1, 0.9 * UM),))
    once = claim("encoder_eccentricity", gear=0)
    assert twist(once, scope) == pytest.approx(4.5 * UM)
    assert unknown_share(once, scope) == TWISTS_WITH_PULSES
    for other in (claim("eccentricity", gear=1), claim("undulation", gear=0, order=2), claim("tooth_pitch", gear=0)):
        assert twist(other, scope) == 0.0
        assert unknown_share(other, scope) != TWISTS_WITH_PULSES


@pytest.mark.slow
def test_a_pitch_wave_is_told_by_its_steps() -> None:
    """The same order, made by the index deviations of all teeth: its steps are seen, so it has its name."""
    known, claimed = rough(points=300), claim_of("cumulative_pitch")
    recordings = recorded(claimed.written(known), (Condition(torque_nm=20.0),), np.random.default_rng(3), per_mesh=24)
    found = verdict_json(diagnose(known, recordings, path=Path("pair.toml")))
    assert [one["physics"] for one in found["missing"]] == ["cumulative_pitch"]
    assert found["missing"][0]["unknown_probability"] < 0.01


def test_shares_of_causes_at_a_place_add_up_to_one() -> None:
    ones = [
        claim("eccentricity", gear=0),
        claim("encoder_eccentricity", gear=0),
        claim("cumulative_pitch", gear=0, order=1),
    ]
    shares = share_of_causes(ones[0], [*ones, claim("cumulative_pitch", gear=0, order=1, flank="coast")])
    assert sum(shares.values()) == pytest.approx(1.0)
    assert shares["eccentricity", 0] > shares["encoder_eccentricity", 0] > shares["cumulative_pitch", 0]
    others = [claim("eccentricity", gear=1), claim("cumulative_pitch", gear=0, order=2), claim("wear", gear=0)]
    assert not any(same_place(ones[0], other) for other in others)


def test_encoders_have_as_many_lines_as_encoders_on_sale() -> None:
    assert {1024, 2048, 2500, 3600, 360} <= LINE_COUNTS
    assert not {2, 3, 5, 7, 12, 25, 31, 47} & LINE_COUNTS
    # Wheels, pulleys and motors have as many teeth and poles.
    assert not {36, 48, 60, 72, 96, 120} & LINE_COUNTS


def test_a_side_band_of_an_unknown_wave_is_as_unknown() -> None:
    """A whole number of teeth from it, on the same shaft; but teeth off their places have such waves themselves."""
    scope = scope_of(rough((18, 25)))
    z = scope.gears[0].z
    near = replace(scope, unknown_waves=((0, 3 * z + 4),))
    for order in (2 * z + 4, 3 * z - 4):
        assert unknown_share(claim("undulation", gear=0, order=order), near) == SIDE_BAND
    assert unknown_share(claim("cumulative_pitch", gear=0, order=4), near) != SIDE_BAND
    assert unknown_share(claim("undulation", gear=0, order=2 * z + 5), near) != SIDE_BAND
    assert unknown_share(claim("undulation", gear=0, order=3 * z + 4), near) != SIDE_BAND
    assert unknown_share(claim("undulation", gear=1, order=2 * z + 4), near) != SIDE_BAND


def test_a_harmonic_of_a_wave_of_no_known_cause_is_no_encoder_s_line() -> None:
    """Of a motor's cogging, 180 and 360 times per turn, the latter is as unknown as the former; on the other shaft, or
    at five times an order, it tells nothing."""
    scope, line = scope_of(rough((18, 25))), claim("encoder_interpolation", gear=0, order=360)
    assert unknown_share(line, scope) < 0.1
    for low in (90, 120, 180):
        assert unknown_share(line, replace(scope, unknown_waves=((0, low),))) > 0.5
    assert unknown_share(line, replace(scope, unknown_waves=((1, 180), (0, 72)))) < 0.1


def test_a_curve_of_no_cause_has_the_harmonics_of_a_corner() -> None:
    """A step's harmonics fall off as 1/h (Fourier series of a sawtooth)."""
    std = mesh_std()
    assert std[0] / std[6] == pytest.approx(4.0)
    assert harmonics_of(12) == [12, 24, 36]
    assert UNKNOWN_TOOTH_KNOTS >= 8


def test_what_was_judged_to_its_end_has_its_name_when_time_is_over() -> None:
    """Of a tooth once a curve was fitted in its stead; nothing where another is likelier, or one was not judged."""
    wave = claim("undulation", gear=1, order=84)
    tooth, spall = (claim(name, gear=0, tooth=3) for name in ("tooth_pitch", "tooth_spall"))
    search: Any = SimpleNamespace(model=SimpleNamespace(claims=(wave, tooth)))

    def sure(*chances: tuple[Claim, float]) -> Judged:
        return Judged(gain=100.0, posterior=Posterior(claims=chances, unknown=0.01, nothing=0.0))

    plain = {wave.key: sure((wave, 0.99)), tooth.key: sure((tooth, 0.99))}

    def weighed(plain: dict[Any, Judged], doubts: dict[tuple[int, int], float]) -> set[Any]:
        return set(_Weighing(search=search, refitted={}, gone=[], plain=plain, doubts=doubts).weighed())

    assert weighed(plain, {}) == {wave.key}
    assert weighed(plain, {(0, 3): 0.001}) == {wave.key, tooth.key}
    assert weighed(plain, {(0, 3): 0.9}) == {wave.key}
    assert weighed({wave.key: plain[wave.key]}, {(0, 3): 0.001}) == set()
    likelier = {**plain, tooth.key: sure((spall, 0.7), (tooth, 0.29))}
    assert weighed(likelier, {(0, 3): 0.001}) == {wave.key}


@pytest.mark.parametrize("name", ["tooth_spall", "wear"])
def test_what_is_like_a_name_was_fitted_in_its_stead_when_time_is_over(name: str) -> None:
    """A pitch of 40 um had been named a spall at 0.997: straight lines tell nothing of a tooth that its neighbours
    carry over."""
    one = claim(name, gear=0, tooth=3) if name == "tooth_spall" else claim(name, gear=0)
    search: Any = SimpleNamespace(model=SimpleNamespace(claims=(one,)))
    sure = Judged(gain=100.0, posterior=Posterior(claims=((one, 0.99),), unknown=0.01, nothing=0.0))

    def named(refitted: dict[Any, Any]) -> set[Any]:
        weighing = _Weighing(search=search, refitted=refitted, gone=[], plain={one.key: sure}, doubts={(0, 3): 0.001})
        return set(weighing.weighed())

    assert named({}) == set()
    assert named({one.key: ()}) == {one.key}


@pytest.mark.parametrize(("chance", "stands"), [(0.54, False), (0.40, True)])
def test_of_two_that_fit_alike_the_likelier_beforehand_stands(
    chance: float, stands: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An encoder off its axis fitted 0.4 better in misfit than the eccentric gear, which is 1.26 times as common: what
    stands is told by both together."""
    encoder, gear = claim("encoder_eccentricity", gear=0), claim("eccentricity", gear=0)

    def judged(of_gear: float) -> Judged:
        chances = sorted(((gear, of_gear), (encoder, 0.98 - of_gear)), key=lambda one: -one[1])
        return Judged(gain=50.0, posterior=Posterior(claims=tuple(chances), unknown=0.02, nothing=0.0))

    search: Any = SimpleNamespace(model=SimpleNamespace(claims=(encoder,)), name="encoder")
    there: Any = SimpleNamespace(model=SimpleNamespace(claims=(gear,)), name="gear")
    monkeypatch.setattr(earned_module, "_exchanged", lambda *_: there)
    monkeypatch.setattr(earned_module, "gained_since", lambda *_: -0.4)
    monkeypatch.setattr(earned_module, "rise_without", lambda *_: None)
    monkeypatch.setattr(earned_module, "withdrawn", lambda fit: fit)
    monkeypatch.setattr(_Weighing, "_judge", lambda *_, **__: judged(chance))
    plain = {encoder.key: judged(0.7)}
    weighing = _Weighing(search=search, refitted={}, gone=[], plain=dict(plain))
    assert weighing.exchanged(plain)
    assert weighing.search.name == ("encoder" if stands else "gear")
    (other,) = weighing.fitted[encoder.key]
    assert (other.claim.key, other.behind) == (gear.key, 0.4)
