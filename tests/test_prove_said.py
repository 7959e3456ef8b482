"""What was to be named or located, short and long recordings, unseen data and time: rows on verdicts of known worth."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from gearpoly.errors import InputFileError
from gearpoly.prove import page as pages
from gearpoly.prove.board import board_json
from gearpoly.prove.page import board_text, page, read_board
from gearpoly.prove.row import Row
from gearpoly.prove.rows import rows
from gearpoly.prove.run import prove_folder
from gearpoly.prove.said import by_class, by_length, time_of
from gearpoly.prove.score import CaseScore, score
from gearpoly.prove.thresholds import read_thresholds
from gearpoly.prove.truth import Truth, read_truth
from gearpoly.prove.wanted import to_be_located, to_be_named, unsaid
from tests.made_prove import BENCH, PAIR, claim, fake, verdict, write_cases

LIMITS = read_thresholds()
OFF = {"physics": "eccentricity", "gear": 1, "amplitude_um": 5.0, "over_limit": 20.0, "rivals": []}
NAMED = verdict(claim("eccentricity", "driving", amplitude_um=(5.0, 0.1)))


def truth(folder: Path, *items: dict[str, Any], kind: str = "missing", **more: Any) -> Truth:
    (folder / "pair.toml").write_text(PAIR)
    told = {"kind": kind if items else "none", "truth": list(items), "noise_um": 1.0, **more}
    (folder / "x.truth.json").write_text(json.dumps(told))
    return read_truth(folder / "x.truth.json", pair=folder / "pair.toml")


def beside_unknown(separability: float, left: float = 1.0, **more: Any) -> dict[str, Any]:
    return OFF | {"unknown": {"physics": "unknown", "separability": separability, "left": left}} | more


def row(scores: list[CaseScore], key: str) -> Row:
    return next(one for one in rows(scores, LIMITS) if one.key == key)


# To be named, or located and no more


@pytest.mark.parametrize(
    ("separability", "over", "named"),
    [
        (0.26, 20.0, True),  # 5.2 standard deviations from the unknown
        (0.24, 20.0, False),  # 4.8
        (1.0, 4.9, False),  # too small, however unlike
        (0.0, 1e4, False),  # a pure wave is never told from a free one
    ],
)
def test_an_effect_is_to_be_named_where_the_unknown_is_five_sigma_away(
    tmp_path: Path, separability: float, over: float, named: bool
) -> None:
    known = truth(tmp_path, beside_unknown(separability, over_limit=over))
    assert bool(to_be_named(known, LIMITS)) is named
    places = to_be_located(known, LIMITS)
    assert bool(places) is (not named and over >= LIMITS.detected_from)
    if places:
        assert (places[0].kind, places[0].order, places[0].gear) == ("shaft_order", 1.0, "driving")


def test_a_near_rival_or_unknown_either_keeps_a_name_back(tmp_path: Path) -> None:
    rival = {"physics": "encoder_eccentricity", "gear": 1, "separability": 0.1, "apart_um": 1.0}
    assert not to_be_named(truth(tmp_path, beside_unknown(0.9, rivals=[rival])), LIMITS)
    assert to_be_named(truth(tmp_path, beside_unknown(0.9, rivals=[rival | {"separability": 0.6}])), LIMITS)


def test_three_definitions_of_the_right_physics_first(tmp_path: Path) -> None:
    """Rivals only, the unknown by its odds, the unknown by distance alone: each asks of fewer cases."""
    scores = [
        score(name, NAMED, truth(tmp_path, item), LIMITS)
        for name, item in (
            ("a", beside_unknown(0.9, left=0.6)), ("b", beside_unknown(0.9, left=0.1)), ("c", beside_unknown(0.1)),
            ("d", OFF),
        )
    ]  # fmt: skip
    keys = ("named_first", "named_first_unknown", "named_first_shape")
    found = [row(scores, key).share for key in keys]
    assert [(one.hits, one.of) for one in found if one is not None] == [(4, 4), (2, 2), (1, 1)]
    silent = [score("a", verdict(), truth(tmp_path, beside_unknown(0.9)), LIMITS)]
    assert row(silent, "named_first_unknown").reached is False


def test_old_truths_without_the_unknown_are_told_of_and_asked_for_no_name(tmp_path: Path) -> None:
    for unknown in ({}, {"unknown": {"physics": "unknown", "separability": 0.9, "log_odds": 30.0}}):
        known = truth(tmp_path, OFF | unknown)
        assert (unsaid(known), to_be_named(known, LIMITS)) == (1, ())
        assert len(to_be_located(known, LIMITS)) == 1
    bench = write_cases(tmp_path / "bench", BENCH)
    board = board_json(prove_folder(bench, out=tmp_path / "out", diagnoser=fake, say=lambda _: None))
    assert board["without_unknown"] == 2
    assert "2 concealed effects whose truths do not say how near an unknown comes" in page([board])


PLACES = [
    ({"physics": "tooth_pitch", "gear": 2, "tooth": 7, "teeth": 25, "encoder_deg": 100.8}, "tooth"),
    ({"physics": "tooth_crack", "gear": 2, "tooth": None, "teeth": 25}, "tooth"),
    ({"physics": "undulation", "gear": 1, "order": 44}, "shaft_order"),
    ({"physics": "wear", "gear": 1}, "mesh_order"),
    ({"physics": "friction"}, "any"),
    ({"physics": "thermal_drift"}, "any"),
]


@pytest.mark.parametrize(("item", "kind"), PLACES, ids=lambda one: one if isinstance(one, str) else one["physics"])
def test_every_physics_has_its_place(tmp_path: Path, item: dict[str, Any], kind: str) -> None:
    (place,) = to_be_located(truth(tmp_path, item | {"over_limit": 8.0}), LIMITS)
    assert place.kind == kind


def test_strangers_and_loud_backgrounds_are_to_be_located(tmp_path: Path) -> None:
    hum = {"shape": "hum", "hz": 50.0, "over_limit": 20.0}
    faint = {"shape": "line", "order": 3.3, "gear": 1, "over_limit": 2.0}
    pulse = {"shape": "pulse", "order": 0.4, "gear": 1, "over_limit": 9.0}
    known = truth(tmp_path, pulse, kind="unknown", background=[hum, faint])
    assert [place.kind for place in to_be_located(known, LIMITS)] == ["shaft_order", "time"]
    # A pulse has harmonics; a line has not.
    third = verdict(unexplained=[{"kind": "shaft_order", "gear": "driving", "order": 1.2}])
    assert score("a", third, known, LIMITS).expert.located == (True, False)
    line = truth(tmp_path, pulse | {"shape": "line"}, kind="unknown")
    assert score("a", third, line, LIMITS).expert.located == (False,)


def test_nothing_is_to_be_known_of_a_wrong_file(tmp_path: Path) -> None:
    known = truth(tmp_path, beside_unknown(1.0), kind="wrong_file")
    assert (to_be_named(known, LIMITS), to_be_located(known, LIMITS)) == ((), ())


# Groups


def test_two_hunting_cycles_are_short_and_more_are_long(tmp_path: Path) -> None:
    scores = [
        score(f"{k}", NAMED, truth(tmp_path, beside_unknown(0.9), hunting_cycles=cycles), LIMITS, seconds=float(k))
        for k, cycles in enumerate((0.5, 2.0, 2.2, 10.0, None), start=1)
    ]
    found = by_length(scores, LIMITS)
    assert {key: one["cases"] for key, one in found.items()} == {"short": 2, "long": 2}
    assert found["short"]["named"]["hits"] == 2
    spent = time_of(scores, LIMITS)
    assert spent["short"] == {"median": 1.5, "q95": pytest.approx(1.95), "all": 3.0}
    assert (spent["long"]["all"], spent["all"]["all"]) == (7.0, 15.0)
    assert by_class(scores, LIMITS)["all"]["cases"] == 5


def test_unseen_data_are_told_by_their_ratio_and_rises_where_something_was_named(tmp_path: Path) -> None:
    known = truth(tmp_path, beside_unknown(0.9))
    worse = score("a", verdict(claim("wear", "driving"), before=2.0, after=3.0), known, LIMITS)
    better = score("b", verdict(claim("wear", "driving"), before=2.0, after=1.0), known, LIMITS)
    silent = score("c", verdict(before=2.0, after=2.2), known, LIMITS)  # nothing named: no rise of a name's
    broken = score("d", None, known, LIMITS, error="ZeroDivisionError", failure="traceback")
    some = [worse, better, silent, broken]
    assert row(some, "unseen_ratio").value == pytest.approx(1.1)
    assert row(some, "unseen_ratio_95").value == pytest.approx(1.1 + 0.9 * 0.4)  # of 0.5, 1.1, 1.5
    rises = row(some, "unseen_rises")
    assert rises.share is not None and (rises.share.hits, rises.share.of, rises.cases) == (1, 2, ("a",))
    assert row(some, "traceback").cases == ("d",)
    assert row(some, "silent").cases == ("c",)  # one that fails is counted as such
    assert row(some, "false_name_cases").cases == ("a", "b")


# The page


def board_of(folder: Path, name: str) -> dict[str, Any]:
    bench = write_cases(folder / name, {key: one | {"hunting_cycles": 1.0} for key, one in BENCH.items()})
    return board_json(prove_folder(bench, out=folder / f"out-{name}", diagnoser=fake, say=lambda _: None))


@pytest.mark.long
def test_runs_stand_side_by_side(tmp_path: Path) -> None:
    one = board_of(tmp_path, "one")
    two = one | {"seed": 7, "ground": "real-life", "of": "real-life ground of seed 7"}
    files = [tmp_path / "a.json", tmp_path / "b.json"]
    for path, board in zip(files, (one, two), strict=True):
        path.write_text(board_text(board))
    pages.main(files, tmp_path / "proof.md")
    text = (tmp_path / "proof.md").read_text()
    assert f"| figure | {one['of']} | real-life 7 | goal |" in text
    assert "| real-life 7, short | 4 |" in text
    assert "## Real-life 7" in text and "- repeat it: `gearpoly prove --ground real-life --seed 7`" in text
    for name in ("proof_size.png", "proof_size_2.png", "reliability.png"):
        assert (tmp_path / "figures" / name).stat().st_size > 5000  # an empty canvas has less
        assert f"(figures/{name})" in text
    # Every table has as many cells in each line as in its head.
    lines = text.splitlines()
    for above, line in pairwise(lines):
        if above.startswith("|") and line.startswith("|"):
            assert above.count("|") == line.count("|"), line


@pytest.mark.parametrize(
    ("text", "words"), [("{", "no JSON"), ("[]", "a scoreboard without rows"), ('{"rows": []}', "without by_expert")]
)
def test_what_is_no_scoreboard_is_refused(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(InputFileError, match=words) as caught:
        read_board(tmp_path / "a.json")
    assert "run gearpoly prove again" in str(caught.value) or "want what prove --json wrote" in str(caught.value)


def test_the_board_holds_every_figure(tmp_path: Path) -> None:
    board = board_of(tmp_path, "one")
    stated = board["by_expert"]["all"]["reliability"]
    assert set(stated) == {"names", "places", "log_score", "log_score_std", "entries"}
    assert len(stated["names"]) == LIMITS.bins
    assert board["by_length"]["short"]["cases"] == 4
    case = next(one for one in board["by_case"] if one["case"] == "beta")
    assert {"stated", "chance_of_what_was_true", "length", "false_names"} <= set(case)
    assert case["items"][0]["to_be_named"] is None
    assert not math.isnan(board["seconds"]["seconds_all"])
