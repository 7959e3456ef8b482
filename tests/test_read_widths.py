"""Text in columns of fixed width: numbers that touch are parted where nothing else can be meant, else asked for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.map_text import map_text
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.recording.survey import survey
from tests.made_texts import DEGREE, RATIO, FloatArray, chart, written

TIME_S = 0.01 * np.arange(1500)
WHOLE = 180.0 * TIME_S
DRIVING, DRIVEN = np.mod(WHOLE, 360.0) - 180.0, np.mod(RATIO * WHOLE, 360.0) - 180.0
NAMES = "  Time [s]  Angle_In [deg]  Angle_Out [deg]\n"


def rows(form: str, *columns: FloatArray, names: str = NAMES) -> str:
    return names + "".join(form.format(*row) + "\n" for row in zip(*columns, strict=True))


def holds(read: Recording, driving: FloatArray, driven: FloatArray, *, half: float, rows: int = 1500) -> None:
    assert read.size == rows
    assert read.time_s is not None and read.driving_angle_rad is not None and read.driven_angle_rad is not None
    np.testing.assert_allclose(read.time_s, TIME_S[-rows:], atol=0.0051)
    np.testing.assert_allclose(read.driving_angle_rad / DEGREE, driving[-rows:], atol=1.01 * half)
    np.testing.assert_allclose(read.driven_angle_rad / DEGREE, driven[-rows:], atol=1.01 * half)


@pytest.mark.parametrize(
    ("form", "half"),
    [
        ("{:8.3f}{:8.3f}{:8.3f}", 0.5e-3),
        ("{:8.3f}{:9.4f}{:10.5f}", 0.5e-4),
        ("{:6.2f}{:7.2f}{:7.2f}", 0.5e-2),
        ("{:.3f}{:+.4f}{:+.5f}", 0.5e-4),  # no widths, and a sign before each number
        ("{:11.3E}{:11.3E}{:11.3E}", 0.05),
    ],
)
def test_signs_that_touch_the_number_before_them(tmp_path: Path, form: str, half: float) -> None:
    file = written(tmp_path, rows(form, TIME_S, DRIVING, DRIVEN), name="run.dat")
    holds(read_recording(file), DRIVING, DRIVEN, half=half)
    mapped = read_recording(file, chart=chart(tmp_path, map_text(survey(file)[0])))
    holds(mapped, DRIVING, DRIVEN, half=half)


@pytest.mark.parametrize("width", [6, 7])
def test_numbers_that_fill_their_width(tmp_path: Path, width: int) -> None:
    """Two figures behind the mark, seen where a short number follows: 0.56100.80 is 0.56 and 100.80."""
    form = f"{{:{width}.2f}}" * 3
    driving, driven = np.mod(WHOLE, 360.0), np.mod(RATIO * WHOLE, 360.0)
    read = read_recording(written(tmp_path, rows(form, TIME_S, driving, driven), name="run.dat"))
    holds(read, driving, driven, half=0.5e-2)


def test_numbers_that_touch_late_in_a_file(tmp_path: Path) -> None:
    """Below the first rows, which parted by blanks look like any table."""
    driving = WHOLE[::-1] - 1000.0
    driven = RATIO * driving
    read = read_recording(written(tmp_path, rows("{:8.3f}{:9.3f}{:9.3f}", TIME_S, driving, driven), name="run.dat"))
    holds(read, driving, driven, half=0.5e-3)


def test_decimal_commas_in_columns(tmp_path: Path) -> None:
    text = rows("{:8.3f}{:8.3f}{:8.3f}", TIME_S, DRIVING, DRIVEN).replace(".", ",")
    holds(read_recording(written(tmp_path, text, name="run.dat")), DRIVING, DRIVEN, half=0.5e-3)


def cured(file: Path, folder: Path) -> Recording:
    with pytest.raises(InputFileError, match="numbers that touch, such as") as caught:
        read_recording(file)
    return read_recording(file, chart=chart(folder, caught.value.wish.partition("such as: ")[2]))


def test_columns_that_always_touch_are_asked_for_and_the_cure_works(tmp_path: Path) -> None:
    """Nothing shows how many figures of 0.00010000.000 are the first number's."""
    driving, driven = 10_000.0 + WHOLE, 10_000.0 + RATIO * WHOLE
    file = written(tmp_path, rows("{:6.3f}{:9.3f}{:9.3f}", TIME_S, driving, driven), name="run.dat")
    holds(cured(file, tmp_path), driving, driven, half=0.5e-3)


def test_empty_cells_are_asked_for_and_the_cure_works(tmp_path: Path) -> None:
    text = rows("{:8.3f}{:8.3f}{:8.3f}", TIME_S, DRIVING, DRIVEN).replace(f"{DRIVING[7]:8.3f}", " " * 8)
    read = cured(written(tmp_path, text, name="run.dat"), tmp_path)
    assert read.size == 1500 and read.driving_angle_rad is not None
    assert np.flatnonzero(np.isnan(read.driving_angle_rad)).tolist() == list(
        np.flatnonzero(np.round(DRIVING, 3) == round(DRIVING[7], 3))
    )


def test_widths_of_a_map_part_whole_numbers(tmp_path: Path) -> None:
    """Counts without a mark: 100000100000 is two numbers to nobody who was not told."""
    driving, driven = np.rint(100_000.0 + 10.0 * WHOLE), np.rint(100_000.0 + 10.0 * RATIO * WHOLE)
    form = "{:6.2f}{:6.0f}{:6.0f}"
    file = written(tmp_path, rows(form, TIME_S, driving, driven), name="run.dat")
    with pytest.raises(InputFileError):
        read_recording(file)
    holds(read_recording(file, chart=chart(tmp_path, "text.widths = [6, 6, 6]")), driving, driven, half=1e-6)


@pytest.mark.parametrize(
    ("text", "where", "found"),
    [
        ("text.widths = [8]", "text.widths", "[8]"),
        ("text.widths = [8, 0]", "text.widths", "[8, 0]"),
        ("text.widths = [8, true]", "text.widths", "[8, True]"),
        ('text.widths = "8 8"', "text.widths", '"8 8"'),
        ('text.widths = [8, 8]\ntext.separator = ";"', "text.widths", "widths, and separator too"),
    ],
)
def test_widths_that_are_none(tmp_path: Path, text: str, where: str, found: str) -> None:
    with pytest.raises(InputFileError) as caught:
        chart(tmp_path, text)
    assert caught.value.where == where
    assert found.replace(" ", "") in caught.value.found.replace(" ", "")


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("change", ["x", "1,2,3,4,5"])
def test_a_bad_row_of_other_texts_is_told_as_before(tmp_path: Path, separator: str, change: str) -> None:
    """Cells that something else parts do not touch."""
    cells: Sequence[str] = [
        separator.join(f"{one:.3f}" for one in row) for row in zip(TIME_S, DRIVING, DRIVEN, strict=True)
    ]
    lines = [separator.join(("Time [s]", "Angle In [deg]", "Angle Out [deg]")), *cells]
    lines[500] = change.replace(",", separator)
    with pytest.raises(InputFileError, match="line 501"):
        read_recording(written(tmp_path, "\n".join(lines) + "\n"))
