"""What the simulate command refuses, and how it says so."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.made_command import PAIR, Command, Ran, recording

ROOT = Path(__file__).parents[1]


def assert_refused(ran: Ran, folder: Path, *words: str) -> None:
    assert ran.code == 2, ran.err
    assert ran.out == ""
    assert ran.err.startswith("gearpoly: ")
    assert ran.err.count("\n") == 1, ran.err
    for word in words:
        assert word in ran.err
    assert {path.name for path in folder.iterdir()} <= {"pair.toml", "rec.csv", "traces.csv", "folder"}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("teeth = 18", 'teeth = "18"', ("driving.teeth", '"18"', "number of teeth")),
        ("teeth = 18", "teeth = 18.5", ("driving.teeth", "18.5", "whole number")),
        ("teeth = 18", "teeth = 3", ("driving.teeth", "3", "5 or more")),
        ("teeth = 18", "tooth = 18", ("driving.tooth", "unknown key", '"teeth"')),
        ("teeth = 18\n", "", ("driving.teeth", "missing")),
        ("module_mm = 2.0", "module_mm = -2.0", ("module_mm", "-2.0", "0.05 or more")),
        ("module_mm = 2.0", "module_mm = nan", ("module_mm", "nan", "finite")),
        ("centre_distance_mm = 43.05", "centre_distance_mm = inf", ("pair.centre_distance_mm", "inf", "finite")),
        ("centre_distance_mm = 43.05", "centre_distance_mm = 60", ("centre_distance_mm", "60", "cannot reach")),
        ("centre_distance_mm = 43.05", "centre_distance_mm = 42.0", ("centre_distance_mm", "42", "larger centre")),
        ("grade = 6", "addendum = -1.5", ("driving.addendum", "-1.5", "more than 0")),
        ("grade = 6", "profile_shift = -3.0", ("driving", "x = -3", "profile shift")),
        ("grade = 6", "profile_shift = 2.0", ("driving", "x = 2", "comes to a point")),
        ("grade = 6", "root_radius = 0.9", ("driving", "0.9", "would do")),
        ("grade = 6", "bore_mm = 40.0", ("driving", "40", "bore")),
        ("grade = 6", "grade = 13", ("driving.grade", "13", "12 or less")),
        (
            "grade = 6",
            "[driving.inspection]\npitch_um = [1.0, 2.0]",
            ("driving.inspection.pitch_um", "2 values", "want 18"),
        ),
        (
            "grade = 6",
            "[driving.inspection]\nprofile_csv = 'none.csv'",
            ("driving.inspection.profile_csv", "none.csv", "no such file"),
        ),
        (
            "grade = 6",
            "grade = 6\n[driving.limits]\nE_sns_um = -40.0\nE_sni_um = -41.0\nF_p_um = 200.0\nf_pt_um = 100.0",
            ("driving", "E_s", "would do"),
        ),
        (
            "grade = 6",
            "[driving.tip_relief]\namount_um = 8.0\nlength_mm = 5.0",
            ("driving", "length 5", "would do"),
        ),
    ],
)
def test_bad_pairs_are_refused(
    gearpoly_command: Command, tmp_path: Path, old: str, new: str, words: tuple[str, ...]
) -> None:
    file = tmp_path / "pair.toml"
    assert old in PAIR
    file.write_text(PAIR.replace(old, new, 1), encoding="utf-8")
    ran = gearpoly_command(
        "simulate", file, "--csv", tmp_path / "a.csv", "--json", tmp_path / "a.json", "--plot", tmp_path / "a.png"
    )
    assert_refused(ran, tmp_path, str(file), *words)


def test_gears_that_jam_say_where(gearpoly_command: Command, tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    file.write_text(PAIR.replace("43.05", "42.7"), encoding="utf-8")
    ran = gearpoly_command("simulate", file, "--turns", "1", "--csv", tmp_path / "a.csv", "--json", tmp_path / "a.json")
    assert_refused(ran, tmp_path, "jam", "driven angle", "driving tooth", "centre_distance_mm", str(file))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"tooth,flank,roll_length_mm,deviation_um\n0,drive,5.0,abc\n", ("line 2", "abc")),
        (b"tooth,flank,roll_length_mm,deviation_um\n0,drive,5.0,nan\n", ("line 2", "nan")),
        (b"tooth,flank,roll_length_mm\n", ("line 1", "deviation_um")),
        (b"tooth,flank,roll_length_mm,deviation_um\n18,drive,5.0,1.0\n", ("line 2", "18", "0 to 17")),
        (b"\xff\xfe\x00", ("UTF-8",)),
        (b"", ("empty",)),
    ],
)
def test_bad_traces_are_refused(gearpoly_command: Command, tmp_path: Path, text: bytes, words: tuple[str, ...]) -> None:
    (tmp_path / "traces.csv").write_bytes(text)
    file = tmp_path / "pair.toml"
    file.write_text(PAIR.replace("grade = 6", '[driving.inspection]\nprofile_csv = "traces.csv"', 1), encoding="utf-8")
    ran = gearpoly_command("simulate", file, "--csv", tmp_path / "a.csv")
    assert_refused(ran, tmp_path, "traces.csv", *words)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ("empty",)),
        ("driving_angle_deg,driven_angle_deg\n1.0,x\n", ("line 2", "x")),
        ("driving_angle_deg\n1.0\n", ("driven_angle_deg",)),
        ('# flank = "left"\ndriving_angle_deg,driven_angle_deg\n1.0,2.0\n', ("line 1", "left", '"coast"')),
        ("driving_angle_deg,driven_angle_deg\n1.0\n", ("line 2", "1 cells")),
    ],
)
def test_bad_recordings_are_refused(
    gearpoly_command: Command, pair_file: Path, tmp_path: Path, text: str, words: tuple[str, ...]
) -> None:
    file = recording(tmp_path, text)
    ran = gearpoly_command("simulate", pair_file, "--at", file, "--csv", tmp_path / "a.csv")
    assert_refused(ran, tmp_path, "rec.csv", *words)


@pytest.mark.parametrize(
    "arguments",
    [
        ("--csv", "missing/folder/a.csv"),
        ("--plot", "run.bmp"),
        ("--csv", "folder"),
        ("--csv", "-", "--json", "-"),
        ("--at", "nowhere.csv"),
        ("--at", "pair.toml", "--turns", "2"),
    ],
)
def test_bad_outputs_are_refused_before_any_work(
    gearpoly_command: Command,
    pair_file: Path,
    tmp_path: Path,
    arguments: tuple[str, ...],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (tmp_path / "folder").mkdir()
    monkeypatch.chdir(tmp_path)
    assert_refused(gearpoly_command("simulate", pair_file, *arguments), tmp_path)


@pytest.mark.parametrize(
    "arguments",
    [("--turns", "-1"), ("--points-per-mesh", "0"), ("--flank", "left"), ("--seed", "x"), ("--turns", "nan")],
)
def test_bad_options_are_refused(gearpoly_command: Command, pair_file: Path, arguments: tuple[str, ...]) -> None:
    ran = gearpoly_command("simulate", pair_file, *arguments)
    assert ran.code == 2
    assert ran.out == ""
    assert arguments[0] in ran.err


def test_a_missing_pair_file(gearpoly_command: Command, tmp_path: Path) -> None:
    assert_refused(gearpoly_command("simulate", tmp_path / "none.toml"), tmp_path, "none.toml", "no such file")


def test_a_bug_is_no_bad_input(pair_file: Path) -> None:
    code = (
        "import sys\nimport gearpoly.positions as run\nrun.cycle_positions = None\n"
        f"sys.argv = ['gearpoly', 'simulate', {str(pair_file)!r}]\nfrom gearpoly.__main__ import main\nmain()\n"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ran.returncode == 1
