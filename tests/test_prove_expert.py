"""A verdict beside what a careful expert could know: names, places, wrong files, and how a diagnosis fails."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from gearpoly.cli import app
from gearpoly.errors import GearpolyError
from gearpoly.prove.board import board_json
from gearpoly.prove.diagnoser import How
from gearpoly.prove.expert import Expert, expert
from gearpoly.prove.page import page
from gearpoly.prove.run import prove_folder
from gearpoly.prove.said import by_class
from gearpoly.prove.score import NO_ANSWER, CaseScore, score
from gearpoly.prove.thresholds import read_thresholds
from gearpoly.prove.truth import Truth, read_truth
from gearpoly.proving.grounds import GROUNDS
from tests.made_prove import PAIR, claim, verdict, write_cases

LIMITS = read_thresholds()
PITCH = {"physics": "tooth_pitch", "gear": 2, "tooth": 7, "teeth": 25, "encoder_deg": 100.8}
ALIASED = {"kind": "shaft_order", "gear": 2, "order": 1024, "aliases": [16.0, 152.0], "over_limit": 30.0}


def truth(folder: Path, **keys: Any) -> Truth:
    (folder / "pair.toml").write_text(PAIR)
    told = {"kind": "none", "truth": [], "noise_um": 1.0, "may_name": [], **keys}
    (folder / "x.truth.json").write_text(json.dumps(told))
    return read_truth(folder / "x.truth.json", pair=folder / "pair.toml")


def asked(said: dict[str, Any], of: Truth, *, error: str = "", failure: str = "") -> Expert:
    return expert(said, of, LIMITS, error=error, failure=failure)


def test_a_name_that_may_not_stand_is_false_whatever_else_is_right(tmp_path: Path) -> None:
    known = truth(tmp_path, may_name=[{"physics": "eccentricity", "gear": 1}])
    right, wrong = claim("eccentricity", "driving"), claim("tooth_pitch", "driven", tooth=3, encoder_deg=43.2)
    assert asked(verdict(right), known).false_names == 0
    assert asked(verdict(right, wrong), known).false_names == 1
    assert asked(verdict(claim("eccentricity", "driven")), known).false_names == 1


@pytest.mark.parametrize(("reading", "right"), [(100.8, True), (107.0, True), (115.2, False)])
def test_a_tooth_is_named_where_it_is(tmp_path: Path, reading: float, right: bool) -> None:
    """To half of a tooth of 14.4 deg."""
    known = truth(tmp_path, may_name=[PITCH], must_name=[PITCH])
    found = asked(verdict(claim("tooth_pitch", "driven", tooth=7, encoder_deg=reading)), known)
    assert found.named == (right,)
    assert found.false_names == (0 if right else 1)


@pytest.mark.parametrize(
    ("entry", "there"),
    [
        ({"kind": "shaft_order", "gear": "driven", "order": 1024}, True),
        ({"kind": "shaft_order", "gear": "driven", "order": 16}, True),  # an alias is the same wave
        ({"kind": "shaft_order", "gear": "driving", "order": 16 * 18 / 25}, True),  # as the other shaft counts it
        ({"kind": "shaft_order", "gear": "driven", "order": 17}, False),
        ({"kind": "mesh_order", "order": 1}, False),
    ],
)
def test_a_wave_is_located_at_its_order_or_an_alias(tmp_path: Path, entry: dict[str, Any], there: bool) -> None:
    known = truth(tmp_path, must_locate=[ALIASED])
    assert asked(verdict(unexplained=[entry]), known).located == (there,)


@pytest.mark.parametrize(
    ("order", "entry", "there"),
    [
        (3.0, {"kind": "shaft_order", "gear": "driven", "order": 3.2}, True),  # half a line is 0.25
        (3.0, {"kind": "shaft_order", "gear": "driven", "order": 3.3}, False),
        (0.3, {"kind": "drift", "label": "drift"}, True),
        (0.6, {"kind": "drift", "label": "drift"}, False),  # of 1.2 waves the order can be told
        (0.3, {"kind": "mesh_order", "order": 1}, False),
    ],
)
def test_a_line_is_located_to_half_its_width(tmp_path: Path, order: float, entry: dict[str, Any], there: bool) -> None:
    """Two turns of 25 teeth on 18 (18 turns of the driven gear are a hunting cycle): lines are half an order wide, and
    of less than a wave nobody can tell more than that it is slow."""
    place = {"kind": "shaft_order", "gear": 2, "order": order, "over_limit": 30.0}
    known = truth(tmp_path, must_locate=[place], hunting_cycles=2.0 / 18.0)
    assert asked(verdict(unexplained=[entry]), known).located == (there,)


def test_the_right_name_locates_what_it_stands_for(tmp_path: Path) -> None:
    """Once per turn, on a tooth, at every mesh."""
    places = [
        {"kind": "shaft_order", "gear": 1, "order": 1, "over_limit": 9.0},
        {"kind": "tooth", "gear": 2, "tooth": 7, "teeth": 25, "encoder_deg": 100.8, "over_limit": 9.0},
        {"kind": "mesh_order", "order": 1, "over_limit": 9.0},
    ]
    known = truth(tmp_path, must_locate=places)
    off, pitch = claim("eccentricity", "driving"), claim("tooth_pitch", "driven", tooth=7, encoder_deg=100.8)
    crown = claim("profile_crowning", "driving")
    assert asked(verdict(off, pitch, crown), known).located == (True, True, True)
    assert asked(verdict(pitch), known).located == (False, True, False)


def test_silence_counts_where_something_could_be_known(tmp_path: Path) -> None:
    assert asked(verdict(), truth(tmp_path, must_locate=[ALIASED])).silent
    assert not asked(verdict(), truth(tmp_path)).silent
    elsewhere = [{"kind": "mesh_order", "order": 1}]
    assert not asked(verdict(unexplained=elsewhere), truth(tmp_path, must_locate=[ALIASED])).silent


def test_a_wrong_file_is_to_be_told_of_or_refused(tmp_path: Path) -> None:
    file = {"wrong": "radians", "says": ["rad"], "over_limit": None}
    known = truth(tmp_path, kind="wrong_file", file=file)
    told = verdict() | {"remarks": ["The angles look like radians, not degrees."]}
    assert asked(told, known).said is True
    assert asked(verdict(), known).said is False
    refused = asked(NO_ANSWER, known, error="InputFileError: driven_angle_deg: are these radians?", failure="refused")
    assert (refused.said, refused.failure) == (True, "")
    broken = asked(NO_ANSWER, known, error="ZeroDivisionError: radians", failure="traceback")
    assert (broken.said, broken.failure) == (False, "traceback")
    faint = truth(tmp_path, kind="wrong_file", file=file | {"over_limit": 3.0})
    assert asked(verdict(), faint).said is None  # nobody could know
    assert asked(verdict(claim("friction")), faint).false_names == 1


def failing(pair: Path, recordings: Sequence[Path], how: How) -> dict[str, Any]:
    """Refuses one case, breaks on the next, and comes to no end on the third."""
    name = pair.parent.name
    if name == "alpha":
        raise GearpolyError("not so")
    if name == "beta":
        raise ZeroDivisionError("no such luck")
    while name == "gamma":
        pass
    return verdict()


def test_refusals_tracebacks_and_time_outs_are_told_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from gearpoly.prove import work

    monkeypatch.setattr(work, "LONGEST_DIAGNOSIS_S", 0.2)
    names = ("alpha", "beta", "gamma", "delta")
    bench = write_cases(tmp_path / "bench", {name: {"kind": "none", "truth": [], "class": "wander"} for name in names})
    proof = prove_folder(bench, out=tmp_path / "out", diagnoser=failing, say=lambda what: None)
    board = board_json(proof)
    found = board["by_expert"]["wander"]
    assert (found["refused"], found["traceback"], found["time_out"], found["cases"]) == (1, 1, 1, 4)
    assert "| wander | 4 |" in page([board])
    assert board["by_expert"]["all"] == found


def test_figures_are_counted_by_class_and_over_all(tmp_path: Path) -> None:
    one = Expert(false_names=1, named=(True, False), located=(True,), silent=False, said=None, failure="")
    two = Expert(false_names=0, named=(), located=(), silent=False, said=True, failure="refused")

    def case(klass: str, of: Expert) -> CaseScore:
        plain = score("x", verdict(), truth(tmp_path, **{"class": klass}), LIMITS)
        return replace(plain, expert=of)

    found = by_class([case("a", one), case("b", two), case("a", one)], LIMITS)
    assert (found["a"]["false_names"]["hits"], found["all"]["false_names"]["of"]) == (2, 3)
    assert (found["a"]["named"]["hits"], found["a"]["named"]["of"]) == (2, 4)
    assert found["b"]["said"]["hits"] == 1
    assert found["all"]["refused"] == 1


def test_the_command_knows_the_grounds(tmp_path: Path) -> None:
    assert set(GROUNDS) == {"bench", "short", "real-life"}
    wrong = CliRunner().invoke(app, ["prove", "--ground", "moon", "--out", str(tmp_path)])
    assert isinstance(wrong.exception, GearpolyError)
    assert "--ground moon: want one of bench, short, real-life" in str(wrong.exception)
    both = CliRunner().invoke(app, ["prove", "--ground", "short", "--on", str(tmp_path)])
    assert "--ground is for seeded cases" in str(both.exception)
