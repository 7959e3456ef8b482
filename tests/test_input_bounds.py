"""Inputs without bound, and paths that lead nowhere: refused in words, with the limit where size is the reason."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from gearpoly.errors import InputFileError
from gearpoly.files.gde_read import read_gde
from gearpoly.files.output import check_target, check_targets, write_text
from gearpoly.files.pairfile import read_pair
from gearpoly.files.toml import DEPTH_LIMIT, KEYS_LIMIT, TOML_SIZE_LIMIT, VALUES_LIMIT, load
from gearpoly.files.traces import COMPARED_NAME_LIMIT, TRACE_LINE_LIMIT, nearest, read_traces
from gearpoly.recording.csv_reader import read_csv
from gearpoly.study.read import read_study
from tests.fuzz.judge import bounded
from tests.made_command import Command
from tests.made_pairfile import SMALLEST, refusal

READERS: list[Callable[[Path], object]] = [read_pair, read_study, read_gde, lambda path: read_traces(path, 18)]


@pytest.mark.parametrize(
    ("text", "limit"),
    [
        (f"{'a.' * 50_000}a = 1", DEPTH_LIMIT),
        (f"[{'a . ' * 50_000}a]", DEPTH_LIMIT),
        ("x = {" + "'a'.\"b\"." * 20_000 + "c = 1}", DEPTH_LIMIT),
        ("\n".join(f"unknown_key_{k} = 1" for k in range(KEYS_LIMIT + 1)), KEYS_LIMIT),
        ("[[a]]\n" * KEYS_LIMIT, KEYS_LIMIT),
        ("[driving]\nspall = [" + "{}," * KEYS_LIMIT + "]", KEYS_LIMIT),
        ("a = [" + "1," * (VALUES_LIMIT + 1) + "]", VALUES_LIMIT),
        ("#" * (TOML_SIZE_LIMIT + 1), TOML_SIZE_LIMIT),
    ],
)
def test_toml_without_bound_is_refused_before_it_is_parsed(tmp_path: Path, text: str, limit: int) -> None:
    with bounded():
        fault = refusal(tmp_path, text)
    assert str(limit) in fault.found
    assert "no more than that" in fault.wish


@pytest.mark.long
def test_toml_at_its_bounds_is_read() -> None:
    """The largest file that a person can need: every tooth of two gears of 10 000 with its lists."""
    row = ", ".join(["-12.25"] * 10_000)
    with bounded():
        read = load(".".join("a" * DEPTH_LIMIT) + " = 1\n" + "".join(f"k{i} = [{row}]\n" for i in range(24)))
    assert len(read["k23"]) == 10_000


@pytest.mark.long
@pytest.mark.parametrize("keys", ["unknown_key_{k} = 1\n", "{k} = {{}}\n"])
def test_as_many_unknown_keys_as_are_read_are_told_at_once(tmp_path: Path, keys: str) -> None:
    with bounded():
        fault = refusal(tmp_path, SMALLEST + "".join(keys.format(k=k) for k in range(20_000)))
    assert fault.where in ("driven.unknown_key_0", "driven.0")
    assert fault.found == "unknown key"


@pytest.mark.long
def test_a_list_of_wrong_values_is_told_by_its_first(tmp_path: Path) -> None:
    with bounded():
        fault = refusal(tmp_path, f"{SMALLEST}[driving.inspection]\npitch_um = [{'1e9, ' * 200_000}]\n")
    assert fault.where == "driving.inspection.pitch_um[0]"


def test_the_nearest_key_of_a_huge_one_is_found_in_its_beginning() -> None:
    with bounded():
        assert (
            nearest("torque_nm" + "x" * 900_000, ["speed_rpm", "torque_nm" + "x" * (COMPARED_NAME_LIMIT - 9)])
            is not None
        )


def test_a_line_without_end_is_no_trace(tmp_path: Path) -> None:
    file = tmp_path / "flanks.csv"
    for text in ("a," * 2_000_000, "tooth,flank,roll_length_mm,deviation_um\n" + "1," * 2_000_000):
        file.write_text(text)
        with pytest.raises(InputFileError, match=f"at most {TRACE_LINE_LIMIT}"), bounded():
            read_traces(file, 18)


@pytest.mark.parametrize(
    "comment",
    [
        "torque_nm" + ".a" * 1000 + " = 1",
        "torque_nm = {" + "a." * 1000 + "a = 1}",
        "torque_nm = " + "[" * 900 + "]" * 900,
        "torque_nm = 0x" + "f" * 9000,
        "torque_nm = " + "{a = " * 300 + "1" + "}" * 300,
        'flank = "' + "x" * 90_000 + '"',
    ],
)
def test_a_comment_key_of_any_depth_is_a_remark_or_refused(tmp_path: Path, comment: str) -> None:
    file = tmp_path / "rec.csv"
    rows = "".join(f"{k},{0.72 * k}\n" for k in range(50))
    file.write_text(f"# {comment}\ndriving_angle_deg,driven_angle_deg\n{rows}")
    with bounded():
        try:
            assert read_csv(file).torque_nm is None
        except InputFileError as error:
            assert "line 1" in error.where


@pytest.mark.parametrize("read", READERS)
def test_a_pipe_or_a_device_is_no_input(tmp_path: Path, read: Callable[[Path], object]) -> None:
    """A pipe that nobody writes to would be waited for; a device has no end."""
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    for path in (pipe, Path("/dev/zero")):
        with pytest.raises(InputFileError, match="a pipe or a device"), bounded():
            read(path)


@pytest.mark.parametrize("read", READERS)
def test_loops_of_links_and_endless_names_are_told(tmp_path: Path, read: Callable[[Path], object]) -> None:
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    for path, says in (
        (loop, "round in a circle"), (loop / "a.toml", "round in a circle"), (tmp_path / ("n" * 300), "shorter name"),
        (tmp_path / "a\0b", "null"), (tmp_path / "file" / "below", "no such file"),
    ):  # fmt: skip
        (tmp_path / "file").write_text("")
        with pytest.raises(InputFileError, match=says):
            read(path)


def test_targets_that_lead_nowhere_are_told(tmp_path: Path) -> None:
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    for path in (loop, loop / "v.json", tmp_path / f"{'n' * 300}.json", tmp_path / "a\0b.json"):
        for check in (check_target, lambda path: check_targets([path], inputs=[]), lambda path: write_text(path, "x")):
            with pytest.raises(InputFileError):
                check(path)
    with pytest.raises(InputFileError, match="round in a circle"):
        check_targets([tmp_path / "v.json"], inputs=[loop])
    assert sorted(tmp_path.iterdir()) == [loop]


LOOP_COMMANDS = (
    """
simulate LOOP | simulate PAIR --csv LOOP | simulate PAIR --at LOOP | compare LOOP LOOP | compare PAIR LOOP | plan LOOP
diagnose PAIR LOOP | view LOOP | plot LOOP --to x.png | plot PAIR --to LOOP | export LOOP --to x.svg
export PAIR --apart --to LOOP | study LOOP --out o | study STUDY --out LOOP | study-report LOOP | prove --on LOOP
prove --quick --out LOOP | prove --on CASES --json LOOP
""".strip()
    .replace("\n", "|")
    .split("|")
)


@pytest.mark.parametrize("name", ["loop.svg", "n" * 300 + ".svg"])
@pytest.mark.parametrize("words", LOOP_COMMANDS)
def test_every_command_tells_a_path_that_leads_nowhere(
    gearpoly_command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: str, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("pair.toml").write_text(SMALLEST)
    Path("study.toml").write_text('pair = "pair.toml"\n')
    if len(name) < 255:
        Path(name).symlink_to(name)
    before = sorted(tmp_path.iterdir())
    places = {"LOOP": name, "PAIR": "pair.toml", "STUDY": "study.toml", "CASES": "."}
    ran = gearpoly_command(*(places.get(word, word) for word in words.split()))
    assert ran.code == 2, ran.err
    assert ran.err.startswith("gearpoly: ")
    assert ran.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before
