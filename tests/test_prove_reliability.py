"""Stated chances: bins, and a log score whose value is known."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest

from gearpoly.prove.judgement import read_judgement
from gearpoly.prove.real import PeriodsAt, real_json
from gearpoly.prove.real import score as real_score
from gearpoly.prove.reliability import (
    Forecast,
    StatedChances,
    bins,
    chances,
    claimed,
    figures,
    joined,
    log_score,
    stated,
)
from gearpoly.prove.thresholds import read_thresholds
from gearpoly.prove.truth import Truth, read_truth
from tests.made_prove import PAIR, claim, verdict

LIMITS = read_thresholds()
OFF = {"physics": "eccentricity", "gear": 1, "amplitude_um": 5.0, "over_limit": 20.0}
LINE = {"shape": "line", "order": 1.0, "gear": 1, "over_limit": 20.0}
PITCH = {"physics": "tooth_pitch", "gear": 2, "tooth": 7, "teeth": 25, "encoder_deg": 100.8, "over_limit": 20.0}
CROWN = {"physics": "profile_crowning", "gear": 1, "crowning_um": 2.0, "over_limit": 20.0}


def truth(folder: Path, *items: dict[str, Any], kind: str = "missing", **more: Any) -> Truth:
    (folder / "pair.toml").write_text(PAIR)
    told = {"kind": kind if items or kind != "missing" else "none", "truth": list(items), "noise_um": 1.0, **more}
    (folder / "x.truth.json").write_text(json.dumps(told))
    return read_truth(folder / "x.truth.json", pair=folder / "pair.toml")


def once_a_turn(p: float, q: float, unknown: float) -> dict[str, Any]:
    """An eccentricity, its look-alike and the unknown, with their chances."""
    rival = {"physics": "encoder_eccentricity", "gear": "driving", "probability": q}
    return claim("eccentricity", "driving", rivals=[rival]) | {"probability": p, "unknown_probability": unknown}


def of(said: dict[str, Any], known: Truth) -> StatedChances:
    return stated(said, known, LIMITS)


# The log score


def test_who_knows_how_sure_it_is_scores_its_entropy(tmp_path: Path) -> None:
    """0.5, 0.3 and 0.2, each true so often: the mean log probability is -sum p log p, 0 below nothing better."""
    chance = (0.5, 0.3, 0.2)
    said = verdict(once_a_turn(*chance))
    encoder = {"physics": "encoder_eccentricity", "gear": 1, "amplitude_urad": 40.0, "over_limit": 20.0}
    truths = [truth(tmp_path, OFF), truth(tmp_path, encoder), truth(tmp_path, LINE, kind="unknown")]
    cases = [one for one, count in zip(truths, (50, 30, 20), strict=True) for _ in range(count)]
    all_of_it = joined(of(said, one) for one in cases)
    entropy = -sum(p * math.log(p) for p in chance)
    found = log_score(all_of_it.true, LIMITS)
    assert found["entries"] == 100
    assert found["log_score"] == pytest.approx(-entropy, rel=1e-12)
    # Calibrated: of each chance stated, that part is right.
    for one in bins(all_of_it.forecasts, 5):
        if one["right"]["of"]:
            assert one["right"]["rate"] == pytest.approx(one["stated"], abs=1e-12)
    # Whoever is surer of the same cases loses, and so does who hedges: Gibbs' inequality.
    for other in ((0.98, 0.01, 0.01), (0.34, 0.33, 0.33)):
        worse = log_score([p for one in cases for p in of(verdict(once_a_turn(*other)), one).true], LIMITS)
        assert worse["log_score"] < found["log_score"] - 0.05


def test_a_false_name_costs_what_it_was_sure_of(tmp_path: Path) -> None:
    """Nothing is there: true was what is left to 1."""
    found = of(verdict(once_a_turn(0.90, 0.05, 0.03)), truth(tmp_path))
    assert found.true == (pytest.approx(0.02),)
    assert [one.right for one in found.forecasts] == [False, False, False]
    wrong = figures(found, LIMITS)["names"][-1]
    assert (wrong["stated"], wrong["right"]["hits"], wrong["right"]["of"]) == (0.90, 0, 1)
    sure = of(verdict(once_a_turn(1.0, 0.0, 0.0)), truth(tmp_path))
    assert log_score(sure.true, LIMITS)["log_score"] == pytest.approx(math.log(LIMITS.least_chance))


def test_a_name_on_the_wrong_tooth_is_wrong(tmp_path: Path) -> None:
    known = truth(tmp_path, PITCH)
    for reading, right in ((100.8, True), (115.2, False)):
        said = claim("tooth_pitch", "driven", tooth=7, encoder_deg=reading) | {"probability": 0.97}
        found = of(verdict(said), known)
        assert found.forecasts == (Forecast(of="names", stated=0.97, right=right),)
        assert found.true == (pytest.approx(0.97 if right else 0.03),)


# Today's verdicts


@pytest.mark.parametrize(("rivals", "each"), [(0, 0.98), (1, 0.49), (3, 0.245)])
def test_a_p_value_is_shared_among_a_name_and_its_rivals(rivals: int, each: float) -> None:
    others = [{"physics": "wear", "gear": "driven", "parameters": {}}] * rivals
    said = claim("profile_crowning", "driving", rivals=others) | {"p_value": 0.02}
    assert chances(said) == (*[pytest.approx(each)] * (rivals + 1), 0.0)


def test_what_states_no_chance_is_not_scored(tmp_path: Path) -> None:
    assert of(verdict(claim("wear", "driving"), unexplained=[{"kind": "mesh_order", "order": 1}]), truth(tmp_path)) == (
        StatedChances()
    )
    assert log_score((), LIMITS) == {"log_score": None, "log_score_std": None, "entries": 0}


# Places without a name


def place(p: float, *could_be: tuple[str, float], **at: Any) -> dict[str, Any]:
    may = [{"physics": name, "gear": "driving", "probability": chance} for name, chance in could_be]
    return {"probability": p, "could_be": may, **at}


MESH = {"kind": "mesh_order", "order": 1}


@pytest.mark.parametrize(
    ("items", "true", "rights"),
    [
        ((CROWN,), 0.3, [True, False, True]),  # one of what it could be
        (({"physics": "friction", "coefficient": 0.1, "over_limit": 9.0},), 0.5, [False, False, True]),  # none of them
        ((PITCH,), 0.1, [False, False, False]),  # nothing of the mesh
        ((), 0.1, [False, False, False]),
    ],
)
def test_a_place_states_that_it_is_there_and_what_it_could_be(
    tmp_path: Path, items: tuple[dict[str, Any], ...], true: float, rights: list[bool]
) -> None:
    """0.9 that it is there: 0.3 a crowning, 0.1 a wear, 0.5 something else."""
    entry = place(0.9, ("profile_crowning", 0.3), ("wear", 0.1), **MESH)
    found = of(verdict(unexplained=[entry]), truth(tmp_path, *items))
    assert found.true == (pytest.approx(true),)
    assert [one.right for one in found.forecasts] == rights
    assert [one.of for one in found.forecasts] == ["names", "names", "places"]


@pytest.mark.parametrize(
    ("entry", "there"),
    [
        ({"kind": "shaft_order", "gear": "driving", "order": 1.0}, True),
        ({"kind": "shaft_order", "gear": "driven", "order": 25 / 18}, True),
        ({"kind": "shaft_order", "gear": "driving", "order": 3.0}, False),
        ({"kind": "mesh_order", "order": 1}, False),
        ({"kind": "drift"}, False),
    ],
)
def test_a_place_is_right_where_something_is(tmp_path: Path, entry: dict[str, Any], there: bool) -> None:
    (chance,) = of(verdict(unexplained=[place(0.8, **entry)]), truth(tmp_path, OFF)).forecasts
    assert (chance.of, chance.right) == ("places", there)


def test_a_background_and_a_jump_are_there_too(tmp_path: Path) -> None:
    hum = {"shape": "hum", "hz": 50.0, "over_limit": 20.0}
    heard = place(0.8, kind="time", hz=50.2)
    assert of(verdict(unexplained=[heard]), truth(tmp_path, OFF, background=[hum])).forecasts[0].right
    jump = truth(tmp_path, {"shape": "jump", "over_limit": 20.0}, kind="unknown")
    assert of(verdict(unexplained=[place(0.8, kind="step")]), jump).forecasts[0].right
    assert not of(verdict(unexplained=[heard]), jump).forecasts[0].right
    # A tone of no frequency is a course; a stranger of no order may show in the mesh.
    assert of(verdict(unexplained=[place(0.8, kind="step")]), jump).forecasts[0].right
    softens = truth(tmp_path, {"shape": "course", "over_limit": 20.0}, kind="unknown")
    assert of(verdict(unexplained=[place(0.8, **MESH)]), softens).forecasts[0].right
    assert not of(verdict(unexplained=[place(0.8, **MESH)]), jump).forecasts[0].right
    # Called a drift, with something unknown beside it.
    drift = claim("thermal_drift") | {"probability": 0.6, "unknown_probability": 0.3}
    assert of(verdict(drift), jump).true == (0.3,)


def test_beside_a_wrong_file_names_are_scored_and_places_are_not(tmp_path: Path) -> None:
    """What is recorded differs from such a file everywhere, and its truth is no list of places."""
    wrong = truth(tmp_path, kind="wrong_file")
    said = verdict(claim("wear", "driving") | {"probability": 0.9}, unexplained=[place(0.9, **MESH)])
    names = of(said, wrong).forecasts
    assert {one.of for one in names} == {"names"} and not any(one.right for one in names)
    assert {one.of for one in of(said, truth(tmp_path)).forecasts} == {"names", "places"}


# Bins


def test_chances_of_one_are_in_the_last_bin_and_means_are_those_stated() -> None:
    some = [Forecast(of="names", stated=p, right=p > 0.5) for p in (0.0, 0.19, 0.2, 0.81, 1.0)]
    found = bins(some, 5)
    assert [one["right"]["of"] for one in found] == [2, 1, 0, 0, 2]
    assert found[4]["stated"] == pytest.approx(0.905)
    assert found[4]["right"]["rate"] == 1.0
    assert found[2]["stated"] is None


def test_rights_go_with_their_entries_in_order() -> None:
    """A planted fault, rights in another order, changes what was true."""
    said = once_a_turn(0.6, 0.3, 0.1)
    assert claimed(said, [True, False, False]).true == (0.6,)
    assert claimed(said, [False, True, False]).true == (0.3,)
    assert claimed(said, [False, False, True]).true == (0.1,)


# Real recordings


def test_on_real_recordings_a_name_is_right_where_the_judgement_lets_it_stand(tmp_path: Path) -> None:
    pair = Path(__file__).parents[1] / "data" / "real" / "eq6.toml"
    (tmp_path / "eq6.toml").write_text(pair.read_text())
    (tmp_path / "log.txt").write_text("")
    held = {"pair": "eq6.toml", "recordings": ["log.txt"], "may_name": [{"physics": "eccentricity", "gear": "driving"}],
            "must_locate": []}  # fmt: skip
    path = tmp_path / "log.judgement.json"
    path.write_text(json.dumps(held))
    said = {"missing": [once_a_turn(0.7, 0.2, 0.1), claim("wear", "driving") | {"p_value": 0.1}], "where": [],
            "unexplained": [], "fit": {"heldout_rms_um": {"before": 4.0, "after": 5.0}}}  # fmt: skip
    found = real_score(read_judgement(path), said, PeriodsAt(z_1=12, z_2=47, turns=4.0, seconds=480.0), seconds=3.0)
    sums = real_json((found,))
    # Of the wear nothing may stand: something else did it, to which the verdict left nothing.
    logs = [math.log(0.7), math.log(LIMITS.least_chance)]
    assert sums["reliability"]["log_score"] == pytest.approx(sum(logs) / 2)
    assert sums["reliability"]["names"][4]["right"]["of"] == 1
    assert sums["unseen_ratio"]["median"] == 1.25
    assert sums["unseen_rises_where_named"]["hits"] == 1
    assert sums["seconds"] == {"median": 3.0, "q95": 3.0, "all": 3.0}
