"""Real recordings beside judgements: what may be named, what has to be located, and what is said of bad files."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from gearpoly.errors import InputFileError
from gearpoly.prove.judgement import read_judgement
from gearpoly.prove.real import PeriodsAt, prove_real, score
from tests.made_command import Command
from tests.test_guide_logs import LOGS, made_log

REAL = Path(__file__).parents[1] / "data" / "real"
SPAN = PeriodsAt(z_1=12, z_2=47, turns=4.0, seconds=480.0)


def judged(folder: Path, name: str = "log", **changes: Any) -> Path:
    """A judgement beside a made guide log of an EQ6."""
    shutil.copy(REAL / "eq6.toml", folder / "eq6.toml")
    (folder / "log.txt").write_text(made_log(frames=700)[0], encoding="utf-8")
    held = {
        "pair": "eq6.toml", "recordings": ["log.txt"], "control": False,
        "may_name": [{"physics": "eccentricity", "gear": "driving"}],
        "must_locate": [{"kind": "mesh_order", "order": 1, "amplitude_um": 4.0, "tolerance": 0.2}],
    }  # fmt: skip
    path = folder / f"{name}.judgement.json"
    path.write_text(json.dumps({**held, **changes}), encoding="utf-8")
    return path


def verdict(*, missing: tuple[dict[str, Any], ...] = (), where: tuple[dict[str, Any], ...] = ()) -> dict[str, Any]:
    return {
        "missing": list(missing), "where": list(where), "unexplained": [],
        "fit": {"heldout_rms_um": {"before": 5.0, "after": 5.5}},
    }  # fmt: skip


@pytest.mark.parametrize(
    ("entry", "there"),
    [
        ({"kind": "mesh_order", "order": 1.0, "amplitude_um": 4.7}, True),
        ({"kind": "mesh_order", "order": 1.0, "amplitude_um": 4.9}, False),  # a fifth of 4.0 is 0.8
        ({"kind": "shaft_order", "gear": "driving", "order": 12.02, "amplitude_um": 4.0}, True),  # 47.08 driven
        ({"kind": "shaft_order", "gear": "driving", "order": 12.05, "amplitude_um": 4.0}, False),  # 47.20: 1/8 is wide
        ({"kind": "time", "hz": 47.0 / 480.0, "amplitude_um": 4.0}, True),
        ({"kind": "tooth", "gear": "driven", "tooth": 3, "rms_um": 4.0}, False),
    ],
)
def test_a_line_is_located_to_half_its_width_by_whichever_shaft(
    tmp_path: Path, entry: dict[str, Any], there: bool
) -> None:
    found = score(read_judgement(judged(tmp_path)), verdict(where=(entry,)), SPAN)
    assert bool(found.located) == there
    assert bool(found.lost) != there


def test_what_may_not_be_named_is_false_whatever_else_is_right(tmp_path: Path) -> None:
    right = {"physics": "eccentricity", "gear": "driving"}
    wrong = ({"physics": "eccentricity", "gear": "driven"}, {"physics": "tooth_pitch", "gear": "driven", "tooth": 4})
    found = score(read_judgement(judged(tmp_path)), verdict(missing=(right, *wrong)), SPAN)
    assert found.false == ("eccentricity driven", "tooth_pitch driven tooth 4")
    assert found.rises
    assert not score(read_judgement(judged(tmp_path)), verdict(), SPAN).rises  # nothing was named
    control = score(read_judgement(judged(tmp_path, control=True, may_name=[])), verdict(missing=(right,)), SPAN)
    assert control.false == ("eccentricity driving",)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"may_name": [{"physics": "worn"}]}, "worn"),
        ({"may_name": [{"physics": "wear", "gear": "left"}]}, "gear is not driving or driven"),
        ({"must_locate": [{"kind": "mesh_order", "order": -1}]}, "order or hz is no number above 0"),
        ({"must_locate": [{"kind": "place", "order": 1}]}, "kind is none of"),
        ({"recordings": ["none.txt"]}, "there is no such file"),
        ({"control": True}, "names of a control"),
        ({"recordings": []}, "recordings: none"),
    ],
)
def test_a_bad_judgement_is_one_message(tmp_path: Path, changes: dict[str, Any], says: str) -> None:
    with pytest.raises(InputFileError, match=says):
        read_judgement(judged(tmp_path, **changes))


def diagnoser(pair: Path, recordings: list[Path], how: object) -> dict[str, Any]:
    """Says nothing of whatever it is given."""
    return verdict()


def test_a_bad_one_does_not_stop_the_others(tmp_path: Path) -> None:
    judged(tmp_path, "bad", may_name=[{"physics": "worn"}])
    judged(tmp_path, "good")
    scores, wrong = prove_real(tmp_path, out=tmp_path / "out", diagnoser=diagnoser, say=lambda _: None)
    assert [one.name for one in scores] == ["good"]
    assert len(wrong) == 1
    assert "worn" in wrong[0]


def test_a_folder_without_judgements_is_refused(tmp_path: Path, gearpoly_command: Command) -> None:
    ran = gearpoly_command("prove", "--real", tmp_path)
    assert ran.code == 2
    assert "no judgement" in ran.err


def test_the_shipped_judgements_read(tmp_path: Path) -> None:
    for path in (*REAL.glob("*.judgement.json"), REAL / "eq6.toml"):
        shutil.copy(path, tmp_path / path.name)
    for name in ("log01", "log02", "log03", "log04", "log07"):
        (tmp_path / f"{name}.txt").write_text("", encoding="utf-8")
    read = [read_judgement(path) for path in sorted(tmp_path.glob("*.judgement.json"))]
    assert [one.control for one in read] == [False, False, True, True, True]


@pytest.mark.slow
@pytest.mark.skipif(not LOGS.is_dir(), reason="the real guide logs are not beside this checkout")
def test_no_control_is_named_and_lines_are_located(tmp_path: Path) -> None:
    """Of 19 lines in five logs at most two are lost; no name on another maker's mount."""
    for path in (*REAL.glob("*.judgement.json"), REAL / "eq6.toml", *LOGS.glob("*.txt")):
        shutil.copy(path, tmp_path / path.name)
    scores, wrong = prove_real(tmp_path, out=tmp_path / "out", say=lambda _: None)
    assert wrong == ()
    assert [one.error for one in scores] == [""] * 5
    assert [one.name for one in scores if one.control and one.named] == []
    assert not any(one.rises for one in scores)
    assert sum(len(one.lost) for one in scores) <= 2
