"""The last row of a logger that was stopped: told and left out where it is not whole, and kept where it is."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from gearpoly.recording.read import read_recording
from gearpoly.recording.text import parsed
from tests.made_guide_log import EQ6, made_log
from tests.made_texts import DEGREE, GERMAN, OWN, own, run, same, table, written
from tests.test_periodic_error import CURVE_TURNS, ROWS, eqmod

RUN = run(300)
COLUMNS = list(RUN.values())
TEXTS = {
    "own": own(RUN),
    "own, in columns that the plain path does not know": own(RUN).replace(OWN[3], "Drehmoment Abtrieb [Nm]"),
    "German": table(COLUMNS, GERMAN),
    "German, tabs": table(COLUMNS, GERMAN, separator="\t"),
    "blanks": table(COLUMNS, OWN, separator="   ", decimal="."),
    "commas twice": table(COLUMNS, GERMAN, separator=","),
    "quoted": table(COLUMNS, GERMAN, separator=",", quoted=True),
    "powers": "\n".join(
        [",".join(OWN), *(",".join(f"{v:.6E}" for v in row) for row in zip(*COLUMNS, strict=True)), ""]
    ),
}


def said(file: Path, *, rows: int) -> bool:
    """Whether the last line is told to break off; the rows that are read are those of the run."""
    recording = read_recording(file)
    assert recording.time_s is not None
    np.testing.assert_allclose(recording.time_s, RUN["time_s"][:rows], rtol=0.0, atol=1.1e-5)
    same(recording.driven_angle_rad, RUN["driven_angle_deg"][:rows] * DEGREE, half=2e-4 * DEGREE)
    return any("the last line breaks off" in one for one in recording.remarks)


@pytest.mark.parametrize("name", TEXTS)
def test_a_whole_file_without_its_last_line_end_stays_as_it_is(tmp_path: Path, name: str) -> None:
    assert not said(written(tmp_path, TEXTS[name][:-1]), rows=300)


@pytest.mark.parametrize("name", TEXTS)
@pytest.mark.parametrize("less", [2, 3, 5, 8, 12, 15, 25])
def test_a_last_row_that_breaks_off_is_told_and_left_out(tmp_path: Path, name: str, less: int) -> None:
    """Where a number is cut its last digits lack, which nothing else shows: 25.19 was read for 25.19981."""
    whole = name == "quoted" and less == 2  # of the row only the quote behind it lacks
    assert said(written(tmp_path, TEXTS[name][:-less]), rows=299 + whole) is not whole


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-be", "cp1252"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_in_every_encoding_and_with_every_line_end(tmp_path: Path, encoding: str, end: str) -> None:
    text = TEXTS["German"].replace("\n", end)
    assert not said(written(tmp_path, text[: -len(end)], encoding=encoding), rows=300)
    assert said(written(tmp_path, text[: -len(end) - 2], encoding=encoding), rows=299)


def test_zeros_of_a_disk_that_lost_its_power_are_no_line_end(tmp_path: Path) -> None:
    assert said(written(tmp_path, TEXTS["German"][:-4] + 50 * "\0"), rows=299)
    assert not said(written(tmp_path, TEXTS["German"] + 50 * "\0"), rows=300)


@pytest.mark.parametrize("name", ["own", "German"])
def test_the_quick_parser_stops_there_too(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pyarrow")
    monkeypatch.setattr(parsed, "LARGE_BYTES", 1)
    assert said(written(tmp_path, TEXTS[name][:-3]), rows=299)


def test_numbers_of_any_length_are_short_by_three_digits(tmp_path: Path) -> None:
    """As ``repr`` writes them; of a number that lacks one digit nobody knows."""
    torque = np.pi * RUN["torque_nm"]
    rows = [",".join(map(repr, map(float, row))) for row in zip(*COLUMNS[:3], torque, strict=True)]
    text = "\n".join([",".join(OWN), *rows])
    last = len(repr(float(torque[-1])))
    assert text.endswith(repr(float(torque[-1])))
    for less, cut in ((0, False), (1, False), (last - 5, True), (last - 2, True)):
        assert said(written(tmp_path, text[: len(text) - less]), rows=300 - cut) is cut


def test_a_column_of_whole_numbers_says_nothing(tmp_path: Path) -> None:
    """9 is no 95 that was cut: numbers of a counter have any length."""
    count = np.arange(300.0) % 100
    text = table([*COLUMNS, count], (*GERMAN, "Zyklus"), digits=[5, 5, 5, 5, 0])
    assert text.endswith(";99\n")
    assert not said(written(tmp_path, text[:-2]), rows=300)


def test_an_object_of_json_without_its_end(tmp_path: Path) -> None:
    rows = [json.dumps(dict(zip(OWN, map(float, row), strict=True))) for row in zip(*COLUMNS, strict=True)]
    assert not said(written(tmp_path, "\n".join(rows)), rows=300)
    for less in (1, 4, 30):
        assert said(written(tmp_path, "\n".join(rows)[:-less]), rows=299)


def test_a_text_below_the_rows_is_no_row(tmp_path: Path) -> None:
    assert not said(written(tmp_path, TEXTS["German"] + "\nMittelwert;;;25,00000"), rows=300)


@pytest.mark.long
def test_the_last_frame_of_a_guide_log(tmp_path: Path) -> None:
    """Cut behind the duration of its pulse it had no direction, and the whole section could not be used."""
    text = made_log(frames=200)[0]
    head, _, last = text.rstrip("\n").rpartition("\nFrame,")
    begin = text.rstrip("\n").rfind("\n200,")
    assert head and last and begin > 0 and text[begin:].count(",") == 11
    for end in range(begin + 2, len(text) - 2):
        file = written(tmp_path, text[:end], name="log.txt")
        assert read_recording(file, worm=EQ6).size == (200 if text[begin:end].count(",") == 11 else 199)


def test_a_curve_of_periodic_error(tmp_path: Path) -> None:
    text = eqmod()
    assert read_recording(written(tmp_path, text[:-1], name="pec.txt"), worm=EQ6).size == CURVE_TURNS * ROWS
    for less in (2, 4, 9):
        recording = read_recording(written(tmp_path, text[:-less], name="pec.txt"), worm=EQ6)
        assert any("the last line breaks off" in one for one in recording.remarks)
        assert recording.size == CURVE_TURNS * (ROWS - 1)
