"""Text whose rows hold more than numbers: words of a state, torn lines of a serial port, degrees with minutes."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.map_text import map_text
from gearpoly.recording.read import read_recording
from gearpoly.recording.survey import survey
from gearpoly.units import FloatArray
from tests.made_texts import DEGREE, GERMAN, chart, run, same, table, written

RUN = run(600)
NAMES = ("Time [s]", "Input angle [deg]", "Output angle [deg]", "Output torque [Nm]")


def rows(separator: str, *, decimal: str = ".") -> list[str]:
    return table(list(RUN.values()), NAMES, separator=separator, decimal=decimal).splitlines()


def right(file: Path, **more: object) -> list[str]:
    """All readings of the run are there; the remarks."""
    found = read_recording(file, **more)  # type: ignore[arg-type]
    same(found.time_s, RUN["time_s"], half=0.5e-5)
    same(found.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=0.5e-5 * DEGREE)
    same(found.driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=0.5e-5 * DEGREE)
    return list(found.remarks)


@pytest.mark.parametrize(("separator", "decimal"), [(";", ","), (",", "."), ("\t", "."), ("|", ",")])
@pytest.mark.parametrize("at", [0, 2, 4])
def test_columns_of_words_are_passed_over(tmp_path: Path, separator: str, decimal: str, at: int) -> None:
    """A state in every row, and a message in some: first, in the middle, and last."""
    head, *held = rows(separator, decimal=decimal)
    names = head.split(separator)
    lines = [separator.join([*names[:at], "State", *names[at:], "Alarm"])]
    for k, row in enumerate(held):
        cells = row.split(separator)
        lines.append(separator.join([*cells[:at], "RUN", *cells[at:], "OIL COLD" if k < 40 else ""]))
    said = right(written(tmp_path, "\n".join(lines) + "\n"))
    assert any('"State" holds words, such as "RUN"' in one for one in said)
    assert any('"Alarm" holds words, such as "OIL COLD"' in one for one in said)


def test_words_parted_by_blanks(tmp_path: Path) -> None:
    """Names with units would be parted too, so that they stand without."""
    lines = ["time_s input_angle_deg output_angle_deg mode", *(f"{row} auto" for row in rows(" ")[1:])]
    lines = [" ".join([*line.split(" ")[:3], line.rsplit(" ", 1)[1]]) for line in lines]
    lines[0] = "time_s driving_angle_deg driven_angle_deg mode"
    right(written(tmp_path, "\n".join(lines) + "\n"))


def test_settings_beside_the_first_rows_of_an_oscilloscope(tmp_path: Path) -> None:
    """Some write the settings beside the first rows, and nothing there further down."""
    settings = [f"Setting {k},{'V' if k % 2 else 5}," for k in range(18)]
    held = rows(",")[1:]
    lines = [(settings[k] if k < len(settings) else ",,") + "," + row for k, row in enumerate(held)]
    text = "\n".join(lines) + "\n"
    columns = zip(("time_s", "driving_angle_deg", "driven_angle_deg"), (4, 5, 6), ("s", "deg", "deg"), strict=True)
    layout = "\n".join(f'columns.{name} = {{ from = "column {k}", unit = "{unit}" }}' for name, k, unit in columns)
    right(written(tmp_path, text), chart=chart(tmp_path, layout))


def test_one_bad_cell_is_no_column_of_words(tmp_path: Path) -> None:
    lines = rows(";")
    lines[300] = lines[300].replace(lines[300].split(";")[1], "12.3x4")
    with pytest.raises(InputFileError, match=r"line 301, column Input angle \[deg\].*12\.3x4"):
        read_recording(written(tmp_path, "\n".join(lines) + "\n"))


def test_messages_in_a_few_rows_and_words_in_quotes(tmp_path: Path) -> None:
    """A column that holds no number is of words, however few; a separator in quotes parts nothing."""
    lines = [f"{row};{'Message' if k == 0 else 'door open' if k % 90 == 5 else ''}" for k, row in enumerate(rows(";"))]
    right(written(tmp_path, "\n".join(lines) + "\n"))
    quoted = [
        f'"{row.replace(",", chr(34) + "," + chr(34))}","{"State" if k == 0 else "on, ok"}"'
        for k, row in enumerate(rows(","))
    ]
    right(written(tmp_path, "\n".join(quoted) + "\n"))


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_rows_that_hold_separators_alone_are_blank(tmp_path: Path, separator: str) -> None:
    """A spreadsheet writes rows that were once filled; no map can name nothing as a word."""
    lines = rows(separator)
    empty = separator * 3
    right(
        written(tmp_path, "\n".join([empty, lines[0], empty, *lines[1:300], empty, *lines[300:], empty, empty]) + "\n")
    )


def test_words_beside_readings_that_a_map_calls_missing(tmp_path: Path) -> None:
    lines = [f"{row};{'STATE' if k == 0 else 'RUN'}" for k, row in enumerate(rows(";"))]
    lines[300] = ";".join([*lines[300].split(";")[:2], "Not A Read", *lines[300].split(";")[3:]])
    file = written(tmp_path, "\n".join(lines) + "\n")
    found = read_recording(file, chart=chart(tmp_path, 'text.missing = ["Not A Read"]'))
    assert found.driven_angle_rad is not None
    assert np.flatnonzero(np.isnan(found.driven_angle_rad)).tolist() == [299]


def test_an_angle_in_words_is_told(tmp_path: Path) -> None:
    lines = rows(";")
    lines[1:] = [";".join([*row.split(";")[:2], "north", *row.split(";")[3:]]) for row in lines[1:]]
    with pytest.raises(InputFileError, match=r'"Output angle \[deg\]" holds words, such as "north"'):
        read_recording(written(tmp_path, "\n".join(lines) + "\n"))


@pytest.mark.parametrize("date", ["4. Nov", "04.11.2026", "Nov 04", "4-Nov"])
def test_numbers_that_a_spreadsheet_made_dates_of_are_told(tmp_path: Path, date: str) -> None:
    """4.11 in a country of decimal commas; many of them make no other separator, and no column of words."""
    lines = rows(";", decimal=",")
    for k in range(20, 600, 12):
        lines[k] = ";".join([*lines[k].split(";")[:2], date, *lines[k].split(";")[3:]])
    with pytest.raises(InputFileError, match=rf"line 21, column Output.*{re.escape(date)}.*a spreadsheet made a date"):
        read_recording(written(tmp_path, "\n".join(lines) + "\n"))


@pytest.mark.parametrize("rule", ["|---|---:|:--:|---|", "|===|===|===|===|"])
def test_a_rule_below_the_names_is_none(tmp_path: Path, rule: str) -> None:
    held = [f"| {row.replace('|', ' | ')} |" for row in rows("|")]
    text = "\n".join([held[0], rule, *held[1:]]) + "\n"
    right(written(tmp_path, text))


BANNER = "rst:0x1 (POWERON_RESET),boot:0x13\nEncoder logger v1.3 ready\n"


def test_torn_lines_are_told_with_two_cures_that_work(tmp_path: Path) -> None:
    """A serial port loses a line end, and a piece of a line; a blank in their place is a gap of one row."""
    lines = rows(",")
    good = [*lines[:200], "", *lines[202:400], "", *lines[401:]]
    lines[200:202] = [lines[200][:9] + lines[201]]
    lines[399] = lines[399][5:21]
    file = written(tmp_path, BANNER + "\n".join(lines) + "\n", name="serial.log")
    with pytest.raises(InputFileError, match=r"line 203: .*delete the line if it is torn.*broken in 2 places"):
        read_recording(file)
    mapped = read_recording(file, chart=chart(tmp_path, 'text.torn_lines = "left out"'))
    assert "2 torn lines left out, as the map says" in mapped.remarks
    deleted = read_recording(written(tmp_path, BANNER + "\n".join(good) + "\n", name="deleted.log"))
    for name in ("time_s", "driving_angle_rad", "driven_angle_rad"):
        np.testing.assert_array_equal(getattr(mapped, name), getattr(deleted, name))


def sexagesimal(degrees: float, *, mark: str = ".", quoted: bool = False) -> str:
    """Degrees, minutes and seconds to a hundredth, rounded as a counter does."""
    hundredths = round(degrees * 360_000.0)
    second = f"{hundredths // 100 % 60:02d}{mark}{hundredths % 100:02d}"
    text = f"{hundredths // 360_000}°{hundredths // 6000 % 60:02d}'{second}\""
    return '"' + text.replace('"', '""') + '"' if quoted else text


@pytest.mark.parametrize(("separator", "decimal", "quoted"), [(";", ",", False), (",", ".", True), ("\t", ".", False)])
def test_degrees_with_minutes_and_seconds(tmp_path: Path, separator: str, decimal: str, quoted: bool) -> None:
    """An encoder's display writes 12°34'56.78"; 0.01 arcsec is 2.8e-6 deg."""
    lines = [separator.join(("Nr", "Zeit [s]", "Winkel Antrieb", "Winkel Abtrieb"))]
    for k, (t, a, b) in enumerate(zip(*list(RUN.values())[:3], strict=True)):
        angles = [sexagesimal(float(one), mark=decimal, quoted=quoted) for one in (a, b)]
        lines.append(separator.join([str(k), f"{t:.4f}".replace(".", decimal), *angles]))
    file = written(tmp_path, "\n".join(lines) + "\n")
    found = read_recording(file)
    same(found.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=0.5 / 360_000.0 * DEGREE)
    same(found.driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=0.5 / 360_000.0 * DEGREE)
    assert any("degrees with minutes, taken as decimal degrees" in one for one in found.remarks)
    mapped = read_recording(file, chart=chart(tmp_path, map_text(survey(file)[0])))
    np.testing.assert_array_equal(mapped.driven_angle_rad, found.driven_angle_rad)


def test_a_row_of_units_may_say_grad(tmp_path: Path) -> None:
    """Grad below German names is a degree, and a line of units no line of names."""
    bare = [name.partition(" [")[0] for name in GERMAN]
    text = table(list(RUN.values()), bare, units=("s", "Grad", "Grad", "Nm"))
    same(
        read_recording(written(tmp_path, text)).driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=0.5e-5 * DEGREE
    )


@pytest.mark.parametrize(
    "form",
    [
        "t_s={t:.2f} input_angle={a:.5f}deg output_angle={b:.5f}deg",
        "time:{t:.2f} s, input angle:{a:.5f} deg, output angle:{b:.5f} deg",
        "Time = {t:.2f}s;Input angle = {a:.5f} °;Output angle = {b:.5f} °",
    ],
)
def test_labels_and_units_beside_the_numbers(tmp_path: Path, form: str) -> None:
    """As boards print them for a plotter; nothing names the columns but the rows themselves."""
    held = zip(RUN["time_s"], RUN["driving_angle_deg"], RUN["driven_angle_deg"], strict=True)
    text = "Logger 1.2 ready\n" + "\n".join(form.format(t=t, a=a, b=b) for t, a, b in held) + "\n"
    said = right(written(tmp_path, text, name="serial.log"))
    assert any("labels and units stand beside" in one for one in said)


def test_units_in_the_cells_below_names(tmp_path: Path) -> None:
    names, columns = ("Time", "Input angle", "Output angle"), list(RUN.values())[:3]
    lines = [",".join(names)]
    lines += [f"{t:.2f} s,{a:.5f} deg,{b:.5f} deg" for t, a, b in zip(*columns, strict=True)]
    file = written(tmp_path, "\n".join(lines) + "\n")
    right(file)
    right(file, chart=chart(tmp_path, map_text(survey(file)[0])))


def test_a_row_whose_unit_changes_is_told(tmp_path: Path) -> None:
    """A meter that goes over to another range writes mNm for Nm: no number is taken in the unit of the others."""
    lines = [f"{t:.2f} s,{a:.5f} deg,{b:.5f} deg" for t, a, b in zip(*list(RUN.values())[:3], strict=True)]
    lines[300] = lines[300].replace("deg", "mrad", 1)
    with pytest.raises(InputFileError, match=r"line 302: .*as in the other rows, `0 s,0 deg,0 deg`"):
        read_recording(written(tmp_path, "\n".join(["Time,Input angle,Output angle", *lines]) + "\n"))


def degrees_with_colons(angles: FloatArray, *, width: int) -> list[str]:
    whole = np.round(np.mod(angles, 360.0) * 360_000.0).astype(int) % 129_600_000
    return [f"{n // 360_000:0{width}d}:{n // 6000 % 60:02d}:{n % 6000 / 100:05.2f}" for n in whole]


@pytest.mark.parametrize(("separator", "width", "clock"), [(";", 1, True), (",", 3, False), ("\t", 3, True)])
def test_degrees_with_colons_are_no_times_of_day(tmp_path: Path, separator: str, width: int, clock: bool) -> None:
    """Three digits, or more than a day has hours: beside real times of day, which stay times."""
    seconds = 0.02 * np.arange(1500)
    driving, driven = 36.0 * seconds, 27.0 * seconds
    times = [f"12:{int(t) // 60:02d}:{t % 60:05.2f}" if clock else f"{t:.2f}" for t in seconds]
    rows = zip(times, *(degrees_with_colons(one, width=width) for one in (driving, driven)), strict=True)
    heads = separator.join(("Time" if clock else "Time [s]", "Input angle", "Output angle"))
    path = tmp_path / "a.csv"
    path.write_text("\n".join((heads, *map(separator.join, rows))) + "\n", encoding="utf-8")
    found = read_recording(path)
    assert found.time_s is not None and found.driving_angle_rad is not None and found.driven_angle_rad is not None
    assert found.time_s[-1] - found.time_s[0] == pytest.approx(seconds[-1], abs=1e-9)
    # 0.01 arcsec, rounded, is half of it; angles begin at 0 and go on past a turn.
    half = np.radians(0.005 / 3600.0) * 1.01
    assert np.max(np.abs(np.unwrap(found.driving_angle_rad) - np.radians(driving))) < half
    assert np.max(np.abs(np.unwrap(found.driven_angle_rad) - np.radians(driven))) < half
