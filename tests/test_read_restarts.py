"""Recordings one below the other under one line of names: each is its own where its time begins again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recordings
from tests.made_texts import DEGREE, chart, table, written

FIRST, SECOND = np.arange(1500) / 50.0, np.arange(900) / 50.0
NAMES = ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]")


def angles(time: np.ndarray, begin: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    return np.mod(begin + 170.0 * time, 360.0), np.mod(0.72 * (begin + 170.0 * time), 360.0)


def rows(time: np.ndarray, begin: float = 0.0, *, clock: float = 0.0) -> str:
    return table((time + clock, *angles(time, begin)), NAMES).partition("\n")[2]


HEAD = ";".join(NAMES) + "\n"


@pytest.mark.parametrize("offset", [0.0, 0.02, 7.5])
@pytest.mark.parametrize("between", ["", "Messung 2\n", "\n", "\n\nMessung 2\n\n", "# 2\n"])
def test_a_time_that_begins_again_begins_a_recording(tmp_path: Path, between: str, offset: float) -> None:
    """Two recordings without a second line of names were refused, or read as one with its clock set back."""
    text = HEAD + rows(FIRST, clock=offset) + between + rows(SECOND, 77.0, clock=1.02 * offset)
    read = read_recordings(written(tmp_path, text))
    assert [one.time_s.size for one in read if one.time_s is not None] == [1500, 900]
    for one, time, begin in zip(read, (FIRST, SECOND), (0.0, 77.0), strict=True):
        assert one.driving_angle_rad is not None and one.driven_angle_rad is not None
        for angle, wanted in zip((one.driving_angle_rad, one.driven_angle_rad), angles(time, begin), strict=True):
            assert np.max(np.abs(np.angle(np.exp(1j * (angle - wanted * DEGREE))))) < 1e-6
    assert any("recording 2 of 2 in the file" in remark for remark in read[1].remarks)


def test_three_recordings_are_parted_in_two_places(tmp_path: Path) -> None:
    text = HEAD + rows(SECOND) + rows(FIRST, 10.0) + "Messung 3\n" + rows(SECOND[:50], 20.0)
    read = read_recordings(written(tmp_path, text))
    assert [one.time_s.size for one in read if one.time_s is not None] == [900, 1500, 50]


@pytest.mark.parametrize("kind", ["a bad row", "a clock of minutes", "an angle alone", "a clock set back"])
def test_what_falls_back_else_begins_no_recording(tmp_path: Path, kind: str) -> None:
    """One bad row, seconds that begin again each minute while the shafts turn on, an angle that goes round, and a
    clock set back by a third."""
    time = np.arange(4200) / 50.0
    told = {
        "a bad row": np.where(np.arange(4200) == 3000, 0.0, time),
        "a clock of minutes": np.mod(time, 60.0),
        "an angle alone": time,
        "a clock set back": np.where(time > 60.0, time - 20.0, time),
    }[kind]
    text = HEAD + table((told, *angles(time)), NAMES).partition("\n")[2]
    try:
        assert len(read_recordings(written(tmp_path, text))) == 1
    except InputFileError as error:
        assert kind != "an angle alone", error


def test_a_line_among_rows_whose_time_goes_on_is_refused(tmp_path: Path) -> None:
    text = HEAD + rows(FIRST) + "Messung 2\n" + rows(SECOND + FIRST[-1] + 0.02, 77.0)
    with pytest.raises(InputFileError, match="Messung 2"):
        read_recordings(written(tmp_path, text))


def test_a_torn_row_between_two_recordings_is_refused(tmp_path: Path) -> None:
    """With the line that the refusal names it is left out, and both are read."""
    file = written(tmp_path, HEAD + rows(FIRST) + "30,00;12\n" + rows(SECOND, 77.0))
    with pytest.raises(InputFileError, match="torn_lines") as caught:
        read_recordings(file)
    assert "30,00;12" in str(caught.value)
    read = read_recordings(file, chart=chart(tmp_path, 'text.torn_lines = "left out"'))
    assert [one.time_s.size for one in read if one.time_s is not None] == [1500, 900]
