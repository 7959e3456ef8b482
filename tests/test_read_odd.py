"""Text files as spreadsheets, meters and stopped loggers leave them: read right, to the last place that was written."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.recording.text.cells import FILL_MARKS, MISSING, Marks, is_missing
from tests.made_texts import DEGREE, GERMAN, OWN, chart, run, same, table, written

RUN = run(600)
COMMAS, SEMICOLONS = table(list(RUN.values()), OWN, separator=",", decimal="."), table(list(RUN.values()), GERMAN)
BEGUN = datetime(2026, 11, 25, 23, 59, 57)
STAMPS = [BEGUN + timedelta(seconds=float(t)) for t in RUN["time_s"]]


def right(recording: Recording, *, missing: Sequence[int] = ()) -> None:
    """All readings of the run are there, but the driven angles of those rows."""
    driven = RUN["driven_angle_deg"].copy()
    driven[list(missing)] = np.nan
    same(recording.time_s, RUN["time_s"], half=0.5e-5)
    same(recording.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=0.5e-5 * DEGREE)
    same(recording.driven_angle_rad, driven * DEGREE, half=0.5e-5 * DEGREE)


def ended(text: str, mark: str) -> str:
    return text.replace("\n", f"{mark}\n")


def spoilt(text: str, word: str, *, row: int = 300) -> str:
    """The text with a word in the place of a driven angle."""
    lines = text.split("\n")
    mark = ";" if ";" in lines[0] else ","
    cells = lines[row + 1].split(mark)
    lines[row + 1] = mark.join([*cells[:2], word, *cells[3:]])
    return "\n".join(lines)


@pytest.mark.parametrize("text", [COMMAS, SEMICOLONS])
@pytest.mark.parametrize(
    "change",
    [
        lambda text: f"sep={';' if ';' in text else ','}\n{text}",
        lambda text: ended(text, ";" if ";" in text else ","),
        lambda text: ended(text, ";;;" if ";" in text else ",,,"),
        lambda text: text.replace("\n", "\r"),
        lambda text: text.replace("\n", "\r\r\n"),
        lambda text: text.replace("\n", "\n\n"),
        lambda text: text + "\0" * 512,
        lambda text: text + "\x1a",
        lambda text: "\n".join([*text.split("\n")[:200], "# oil refilled", *text.split("\n")[200:]]),
    ],
    ids=["sep=", "end marks", "empty columns", "CR", "CR CR LF", "blank lines", "zeros", "DOS", "comment"],
)
def test_what_programs_put_about_the_rows(tmp_path: Path, text: str, change: object) -> None:
    right(read_recording(written(tmp_path, change(text))))  # type: ignore[operator]


def test_a_key_among_the_rows_is_no_comment_to_pass_over(tmp_path: Path) -> None:
    """The condition would change on the way."""
    lines = COMMAS.split("\n")
    text = "\n".join([*lines[:200], "# torque_nm = 30.0", *lines[200:]])
    with pytest.raises(InputFileError, match="want comment lines before the header row only"):
        read_recording(written(tmp_path, text))


def test_numbers_of_rows_without_a_name(tmp_path: Path) -> None:
    """As pandas writes its index; a column of readings without a name is refused all the same."""
    lines = COMMAS.rstrip("\n").split("\n")
    indexed = "\n".join(f"{k - 1 if k else ''},{line}" for k, line in enumerate(lines))
    right(read_recording(written(tmp_path, indexed + "\n")))
    other = "\n".join(f"{k % 7 if k else ''},{line}" for k, line in enumerate(lines))
    with pytest.raises(InputFileError, match="column 1 has no name"):
        read_recording(written(tmp_path, other + "\n"))


@pytest.mark.parametrize("text", [COMMAS, SEMICOLONS], ids=["own", "German"])
@pytest.mark.parametrize(
    "word",
    ["-", "#N/A", "#DIV/0!", "#WERT!", "OL", "OVERLOAD", "Überlast", "*****", "####", "1.#QNAN", "nan(ind)", "?"],
)
def test_words_for_no_reading(tmp_path: Path, text: str, word: str) -> None:
    recording = read_recording(written(tmp_path, spoilt(text, word)))
    right(recording, missing=[300])
    assert any("without a reading" in one and word in one for one in recording.remarks)


@pytest.mark.parametrize("text", [COMMAS, SEMICOLONS], ids=["own", "German"])
@pytest.mark.parametrize("word", ["Not A Read", "-9999", "inf", "n. def."])
def test_a_map_names_words_for_no_reading(tmp_path: Path, text: str, word: str) -> None:
    """Numbers too; they count where they are a whole cell, not where another number holds them."""
    file = written(tmp_path, spoilt(text, word))
    right(read_recording(file, chart=chart(tmp_path, f'text.missing = ["x", "{word}", "99"]')), missing=[300])


def test_words_for_no_reading_are_no_numbers() -> None:
    marks = Marks(decimal=".")
    assert all(np.isnan(marks.value(one)) for one in (*MISSING, "***", "#"))
    assert not any(is_missing(one) for one in ("0", "5", "1e5", "-1", "Zeit", "x#1", "column", "±"))
    assert set(FILL_MARKS) == {"*", "#"}


def test_powers_as_fortran_writes_them(tmp_path: Path) -> None:
    text = "time_s,driving_angle_deg,driven_angle_deg\n" + "".join(
        f"{t:.9E},{a:.9E},{b:.9e}\n".replace("E", "D").replace("e", "d")
        for t, a, b in zip(*list(RUN.values())[:3], strict=True)
    ).replace("drivDn", "driven")
    right(read_recording(written(tmp_path, text)))


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("time", lambda t: t.strftime("%H:%M:%S.%f")[:-3]),
        ("time", lambda t: t.strftime("%Y-%m-%dT%H:%M:%S.%f+01:00")),
        ("time_s", lambda t: t.strftime("%M:%S.%f")[:-3]),
        ("time", lambda t: t.strftime("%M:%S,%f")[:-3]),
    ],
    ids=["over midnight", "zone", "minutes over the hour", "decimal comma"],
)
def test_clocks_beside_names_of_the_contract(tmp_path: Path, name: str, write: object) -> None:
    """A spreadsheet shows minutes and seconds alone, and these begin again at the hour."""
    stamps = [write(one) for one in STAMPS]  # type: ignore[operator]
    mark = ";" if any("," in one for one in stamps) else ","
    rows = [
        mark.join([one, f"{a:.5f}", f"{b:.5f}"])
        for one, a, b in zip(stamps, RUN["driving_angle_deg"], RUN["driven_angle_deg"], strict=True)
    ]
    text = "\n".join([mark.join([name, "driving_angle_deg", "driven_angle_deg"]), *rows]) + "\n"
    right(read_recording(written(tmp_path, text)))


def test_dates_as_spreadsheets_count_them(tmp_path: Path) -> None:
    """In days, which is asked for with the line that makes seconds of them."""
    days = 46_351.75 + RUN["time_s"] / 86_400.0
    held = [days, RUN["driving_angle_deg"], RUN["driven_angle_deg"]]
    text = table(held, ("Datum", "Winkel Antrieb [°]", "Winkel Abtrieb [°]"), digits=[11, 5, 5])
    line = 'columns.time_s = { from = "Datum", unit = "d" }'
    with pytest.raises(InputFileError, match="a date as spreadsheets count them, in days") as caught:
        read_recording(written(tmp_path, text))
    assert line in str(caught.value)
    recording = read_recording(written(tmp_path, text), chart=chart(tmp_path, line))
    assert recording.time_s is not None
    # 46 352 days are kept to 7e-12 days, 0.6 us, and were written to 1e-11.
    np.testing.assert_allclose(recording.time_s - recording.time_s[0], RUN["time_s"], rtol=0.0, atol=3e-6)


@pytest.mark.parametrize("ending", [".csv", ".txt", ".log", ".dat", ".asc", ".tsv", ".tab", ""])
def test_text_under_any_ending(tmp_path: Path, ending: str) -> None:
    right(read_recording(written(tmp_path, COMMAS, name=f"rec{ending}")))
