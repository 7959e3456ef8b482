"""Text files of all countries: what stands there is read, what may mean two things is asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording, read_recordings
from gearpoly.recording.recording import Recording
from tests.made_texts import DEGREE, GERMAN, OWN, chart, own, run, same, table, written

RUN = run()
HALF = 0.5e-5
"""Half of the last place of five decimals."""


def check(recording: Recording, *, torque: bool = True, half: float = HALF) -> None:
    """The recording is the run, to half of the last place written."""
    same(recording.time_s, RUN["time_s"], half=half)
    same(recording.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=half * DEGREE)
    same(recording.driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=half * DEGREE)
    if torque:
        same(recording.torque_samples_nm, RUN["torque_nm"], half=half)


@pytest.mark.parametrize("separator", [";", "\t", "|", " ", "   "])
@pytest.mark.parametrize("decimal", [",", "."])
def test_every_separator_and_decimal_mark(tmp_path: Path, separator: str, decimal: str) -> None:
    names = [name.replace(" ", "_").replace("_[", "[") for name in GERMAN] if " " in separator else GERMAN
    text = table(list(RUN.values()), names, separator=separator, decimal=decimal)
    check(read_recording(written(tmp_path, text)))


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "cp1252", "latin-1"]
)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_encoding_and_line_end(tmp_path: Path, encoding: str, end: str) -> None:
    text = table(list(RUN.values()), GERMAN, head="Prüfstand: 3\nBediener: Jörg Müßig\n\n").replace("\n", end)
    recording = read_recording(written(tmp_path, text, encoding=encoding))
    check(recording)
    assert any('"Winkel Antrieb [°]" taken for driving_angle_deg' in remark for remark in recording.remarks)


def test_one_byte_a_character_is_that_of_western_windows(tmp_path: Path) -> None:
    """è and Ø are č and Ř in the table of the east, which shares the degree sign and the umlauts."""
    names = (*GERMAN[:3], "Pièce Ø")
    recording = read_recording(written(tmp_path, table(list(RUN.values()), names), encoding="cp1252"))
    assert any(remark.endswith("no columns of a recording: Pièce Ø") for remark in recording.remarks)


@pytest.mark.parametrize(
    "names",
    [
        ("Zeit [s]", "Winkel Antrieb [°]", "Winkel Abtrieb [°]", "Drehmoment Abtrieb [Nm]"),
        ("Messzeit / s", "Antriebswinkel / Grad", "Abtriebswinkel / Grad", "Abtriebsmoment / Nm"),
        ("time (s)", "input shaft angle (deg)", "output shaft angle (deg)", "output torque (N.m)"),
        ("Time_s", "InputAngle_deg", "OutputAngle_deg", "OutputTorque_Nm"),
        ("Temps [s]", "Angle d'entrée [deg]", "Angle de sortie [deg]", "Couple de sortie [N·m]"),
        ("Tiempo [s]", "Ángulo de entrada [°]", "Ángulo de salida [°]", "Par de salida [N m]"),
        ("Tempo [s]", "Angolo ingresso [gradi]", "Angolo uscita [gradi]", "Coppia uscita [Nm]"),
        ("t [s]", "angle_in [deg]", "angle_out [deg]", "torque_out [Nm]"),
    ],
    ids=["German", "German compounds", "English", "camel case", "French", "Spanish", "Italian", "in and out"],
)
def test_names_of_five_languages(tmp_path: Path, names: tuple[str, ...]) -> None:
    check(read_recording(written(tmp_path, table(list(RUN.values()), names))))


@pytest.mark.parametrize(
    "units", [("s", "°", "°", "Nm"), ("[s]", "[deg]", "[deg]", "[N.m]"), ("(s)", "(°)", "(°)", "(Nm)")]
)
def test_a_row_of_units_below_the_names(tmp_path: Path, units: tuple[str, ...]) -> None:
    names = ("Zeit", "Winkel Antrieb", "Winkel Abtrieb", "Drehmoment Abtrieb")
    check(read_recording(written(tmp_path, table(list(RUN.values()), names, units=units))))


def test_a_row_of_units_above_the_names(tmp_path: Path) -> None:
    names = ("Zeit", "Winkel Antrieb", "Winkel Abtrieb", "Drehmoment Abtrieb")
    check(read_recording(written(tmp_path, table(list(RUN.values()), names, head="s;°;°;Nm\n"))))


def test_metadata_and_keys_before_the_header(tmp_path: Path) -> None:
    head = 'Prüfstand;7\nDatum;03.04.2026\nAbtastrate [Hz];100\n# torque_nm = 25.0\n# flank = "coast"\n\n'
    recording = read_recording(written(tmp_path, table(list(RUN.values()), GERMAN, head=head)))
    check(recording)
    assert (recording.torque_nm, recording.flank) == (25.0, "coast")


@pytest.mark.parametrize(
    ("thousands", "decimal"),
    [(".", ","), (",", "."), ("'", "."), ("\u2019", ","), (" ", ","), ("\u00a0", ","), ("\u202f", ",")],
)
def test_thousands_are_parted_by_any_mark(tmp_path: Path, thousands: str, decimal: str) -> None:
    """Angles that do not wrap pass a thousand; one number holds both marks, or a decimal part that proves the mark."""
    driving = np.degrees(np.unwrap(np.radians(RUN["driving_angle_deg"])))
    driven = np.degrees(np.unwrap(np.radians(RUN["driven_angle_deg"])))

    def cell(value: float) -> str:
        return f"{value:,.5f}".replace(",", "T").replace(".", decimal).replace("T", thousands)

    rows = [";".join(map(cell, row)) for row in zip(RUN["time_s"], driving, driven, strict=True)]
    assert any(thousands in row for row in rows)
    recording = read_recording(written(tmp_path, "\n".join([";".join(GERMAN[:3]), *rows]) + "\n"))
    same(recording.driving_angle_rad, driving * DEGREE, half=HALF * DEGREE)
    same(recording.driven_angle_rad, driven * DEGREE, half=HALF * DEGREE)


def test_commas_in_quotes_are_decimal_marks(tmp_path: Path) -> None:
    check(read_recording(written(tmp_path, table(list(RUN.values()), GERMAN, separator=",", quoted=True))))


def ambiguous(folder: Path, *, wraps: bool) -> Path:
    """Angles of three digits before and three after the mark, in every row."""
    step = np.arange(600)
    driving, driven = 100.0 + 0.9 * step, 150.0 + 0.9 * 0.72 * step
    if wraps:  # between 100 and 460, as a counter that begins again after one turn may well be set
        driving, driven = 100.0 + np.mod(7.2 * step, 360.0), 100.0 + np.mod(0.72 * 7.2 * step, 360.0)
    text = table([driving, driven], GERMAN[1:3], digits=3)
    return written(folder, text)


def test_a_number_of_two_meanings_is_asked_for(tmp_path: Path) -> None:
    file = ambiguous(tmp_path, wraps=False)
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    assert '"100,000" may be 100.000 or 100000' in caught.value.found
    assert 'text.decimal = ","' in caught.value.wish
    assert 'text.decimal = "." and text.thousands = ","' in caught.value.wish
    # Both cures work.
    one = read_recording(file, chart=chart(tmp_path, 'text.decimal = ","\n'))
    other = read_recording(file, chart=chart(tmp_path, 'text.decimal = "."\ntext.thousands = ","\n'))
    assert one.driving_angle_rad is not None and other.driving_angle_rad is not None
    assert one.driving_angle_rad[0] == pytest.approx(100.0 * DEGREE, rel=1e-15)
    assert other.driving_angle_rad[0] == pytest.approx(100000.0 * DEGREE, rel=1e-15)


@pytest.mark.parametrize("digits", [1, 2, 4, 5])
def test_other_than_three_digits_after_a_mark_are_decimals(tmp_path: Path, digits: int) -> None:
    step = np.arange(600)
    text = table([100.0 + 0.9 * step, 150.0 + 0.648 * step], GERMAN[1:3], digits=digits)
    recording = read_recording(written(tmp_path, text))
    same(recording.driving_angle_rad, (100.0 + 0.9 * step) * DEGREE, half=0.5 * 10.0**-digits * DEGREE)


def test_an_angle_that_begins_again_after_one_turn_settles_it(tmp_path: Path) -> None:
    recording = read_recording(ambiguous(tmp_path, wraps=True))
    assert recording.driving_angle_rad is not None
    assert recording.driving_angle_rad.max() < 460.0 * DEGREE
    assert any("begin again after one turn" in remark for remark in recording.remarks)


def test_a_count_that_runs_on_past_a_thousand_settles_it(tmp_path: Path) -> None:
    """998, 999, 1,000: as 1.000 it would fall by 998."""
    step = np.arange(700, 2200)
    rows = [f"{k:,d};{k * 0.72:,.0f}" for k in step.tolist()]
    recording = read_recording(written(tmp_path, "\n".join([";".join(GERMAN[1:3]), *rows]) + "\n"))
    same(recording.driving_angle_rad, step * DEGREE, half=0.0)


def test_one_decimal_settles_the_whole_file(tmp_path: Path) -> None:
    """Both angles alone are open; the time beside them is not."""
    step = np.arange(600)
    text = table([0.01 * step, 100.0 + 0.9 * step, 150.0 + 0.648 * step], GERMAN[:3], digits=[2, 3, 3])
    recording = read_recording(written(tmp_path, text))
    assert recording.driving_angle_rad is not None
    assert recording.driving_angle_rad[-1] == pytest.approx((100.0 + 0.9 * 599) * DEGREE, rel=1e-15)


STAMPS = {
    "ISO": lambda s: f"2026-04-03T23:59:{s:06.3f}",
    "ISO, zone": lambda s: f"2026-04-03 23:59:{s:06.3f}+02:00",
    "German": lambda s: f"03.04.2026 23:59:{s:06.3f}".replace(f"{s:06.3f}", f"{s:06.3f}".replace(".", ",")),
    "American": lambda s: f"4/3/2026 11:59:{s:06.3f} PM",
    "time of day": lambda s: f"23:59:{s:06.3f}",
}


@pytest.mark.parametrize("kind", STAMPS)
def test_time_stamps_become_seconds(tmp_path: Path, kind: str) -> None:
    write = STAMPS[kind]
    keep = RUN["time_s"] < 15.0
    angles = table([RUN[name][keep] for name in OWN[1:3]], GERMAN[1:3]).splitlines()
    stamps = ["Zeitstempel", *(write(second) for second in RUN["time_s"][keep])]
    text = "\n".join(f"{stamp};{row}" for stamp, row in zip(stamps, angles, strict=True)) + "\n"
    recording = read_recording(written(tmp_path, text))
    # Milliseconds after a day's seconds: the last place of 8.6e4 s in double precision is 1.5e-11 s.
    same(recording.time_s, RUN["time_s"][keep], half=2e-11)


def test_zones_of_stamps_count(tmp_path: Path) -> None:
    """The clock is set an hour forward at the end of winter, and its zone with it: no second is lost."""
    stamps = [f"2026-03-29T01:59:{k:02d}+01:00" for k in range(60)] + [
        f"2026-03-29T03:00:{k:02d}+02:00" for k in range(60)
    ]
    rows = [f"{stamp};{7.5 * k};{5.4 * k}" for k, stamp in enumerate(stamps)]
    recording = read_recording(
        written(tmp_path, "\n".join(["Zeit;Winkel Antrieb [°];Winkel Abtrieb [°]", *rows]) + "\n")
    )
    same(recording.time_s, np.arange(120.0), half=0.0)


def stamped(folder: Path, dates: list[str], *, name: str = "Datum") -> Path:
    """Ten rows a day at noon on each of the dates, or running on over midnight."""
    rows = [
        f"{day};{k:02d}:00:00;{40.5 * n};{29.16 * n}"
        for n, (day, k) in enumerate((d, h) for d in dates for h in range(24))
    ]
    return written(folder, "\n".join([f"{name};Uhrzeit;Winkel Antrieb [°];Winkel Abtrieb [°]", *rows]) + "\n")


def test_a_date_beside_the_time_of_day_counts_on(tmp_path: Path) -> None:
    recording = read_recording(stamped(tmp_path, ["03.04.2026", "04.04.2026"]))
    same(recording.time_s, 3600.0 * np.arange(48), half=0.0)


def test_the_order_of_a_date_is_told_by_the_days(tmp_path: Path) -> None:
    """03/04 and 04/04: as March and April the clock would stand for a month."""
    recording = read_recording(stamped(tmp_path, ["03/04/2026", "04/04/2026"]))
    same(recording.time_s, 3600.0 * np.arange(48), half=0.0)
    recording = read_recording(stamped(tmp_path, ["04/03/2026", "04/04/2026"]))
    same(recording.time_s, 3600.0 * np.arange(48), half=0.0)
    recording = read_recording(stamped(tmp_path, ["31/01/2026", "02/02/2026"]))
    assert recording.time_s is not None and recording.time_s[24] == 2 * 86400.0


def test_an_order_that_nothing_tells_is_asked_for(tmp_path: Path) -> None:
    file = stamped(tmp_path, ["03/04/2026", "05/08/2026"])
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    assert '"03/04/2026" may begin with the day or the month' in caught.value.found
    for order, days in (("day first", 124), ("month first", 65)):  # 3 April to 5 August, 4 March to 8 May
        assert f'text.dates = "{order}"' in caught.value.wish
        recording = read_recording(file, chart=chart(tmp_path, f'text.dates = "{order}"\n'))
        assert recording.time_s is not None
        assert recording.time_s[24] == 86400.0 * days


@pytest.mark.long
def test_several_recordings_in_a_file_are_each_its_own(tmp_path: Path) -> None:
    slow = run(rpm=20.0)
    text = table(list(RUN.values()), GERMAN, head="# torque_nm = 25.0\n")
    text += "\n" + table(list(slow.values()), GERMAN, head='Lauf 2\n# flank = "coast"\n')
    file = written(tmp_path, text, encoding="cp1252")
    first, second = read_recordings(file)
    check(first)
    same(second.driving_angle_rad, slow["driving_angle_deg"] * DEGREE, half=HALF * DEGREE)
    assert (first.flank, second.flank, second.torque_nm) == ("drive", "coast", 25.0)
    assert first.source != second.source
    assert "recording 2 of 2 in the file" in second.remarks[0]
    with pytest.raises(InputFileError, match="2 recordings; want one of them: section = 1 in a map"):
        read_recording(file)
    alone = read_recording(file, chart=chart(tmp_path, "section = 2\n"))
    assert alone.flank == "coast"


def test_own_files_strung_together_are_each_a_recording(tmp_path: Path) -> None:
    assert [one.size for one in read_recordings(written(tmp_path, own(RUN) + own(run(800))))] == [1500, 800]


def test_own_names_beside_others(tmp_path: Path) -> None:
    """A column that is unlike any is left out, or taken where it is sure; one that is nearly one of ours is a slip."""
    held = [*list(RUN.values())[:3], RUN["torque_nm"]]
    for name, torque in (("Temperatur", False), ("Drehmoment Abtrieb [Nm]", True)):
        text = table(held, [*OWN[:3], name], separator=",", decimal=".")
        recording = read_recording(written(tmp_path, text))
        check(recording, torque=torque)
        assert (recording.torque_samples_nm is not None) == torque
        assert any(name in remark for remark in recording.remarks)
    with pytest.raises(InputFileError, match='nearest known column is "torque_nm"'):
        read_recording(written(tmp_path, table(held, [*OWN[:3], "torque"], separator=",", decimal=".")))


@pytest.mark.parametrize("encoding", ["utf-16", "cp1252"])
def test_own_names_in_any_writing(tmp_path: Path, encoding: str) -> None:
    """The contract's names with semicolons, decimal commas, another encoding: no doubt, so no map."""
    text = table(list(RUN.values()), OWN, head="# torque_nm = 25.0\n# gemessen von Jörg\n")
    recording = read_recording(written(tmp_path, text, encoding=encoding))
    check(recording)
    assert recording.torque_nm == 25.0


@pytest.mark.parametrize(
    ("change", "where", "found"),
    [
        (lambda lines: [*lines[:700], "0,1;abc;3,0;4,0", *lines[700:]], "line 701, column Winkel Antrieb [°]", '"abc"'),
        (lambda lines: [*lines[:700], "0,1;2,0", *lines[700:]], "line 701", "`0,1;2,0`"),
        (lambda lines: [*lines, "0,1;2,"], "line 1502", "`0,1;2,`"),
        (
            lambda lines: [*lines[:700], "0,1;2,0;1,2,3;4,0", *lines[700:]],
            "line 701, column Winkel Abtrieb [°]",
            "1,2,3",
        ),
        (lambda lines: [*lines[:700], "Pause", *lines[700:]], "line 701", "`Pause`"),
    ],
    ids=["word", "short", "cut off", "two marks", "remark"],
)
def test_a_bad_line_is_named(tmp_path: Path, change: object, where: str, found: str) -> None:
    lines = table(list(RUN.values()), GERMAN).splitlines()
    with pytest.raises(InputFileError) as caught:
        read_recording(written(tmp_path, "\n".join(change(lines)) + "\n"))  # type: ignore[operator]
    assert caught.value.where == where
    assert found in caught.value.found


def test_text_below_the_rows_and_empty_columns_are_passed_over(tmp_path: Path) -> None:
    text = table(list(RUN.values()), GERMAN).replace("\n", ";\n") + "\nEnde der Messung\n"
    check(read_recording(written(tmp_path, text)))


@pytest.mark.parametrize(
    "below",
    [
        "Ende der Messung;;;\nMittelwert;;;25,0",
        "Mittelwert;180,00;129,60;25,00\nMinimum;0,00;0,00;24,80",
        "Max;360,00;360,00;25,20",
        "Datei;Messung;von;gestern",
        "Ende;;;",
    ],
)
def test_what_closes_a_table_is_no_row_of_it(tmp_path: Path, below: str) -> None:
    """A remark or what a spreadsheet makes of the columns, in as many cells as the rows have: the readings are those of
    the rows alone. A word that says neither, beside readings, is a cell at fault."""
    text = table(list(RUN.values()), GERMAN)
    read = read_recording(written(tmp_path, text + below + "\n"))
    check(read)
    assert read.size == RUN["time_s"].size
    with pytest.raises(InputFileError, match=r'"Kanalfehler"; want a finite number.*text\.missing = \["Kanalfehler"\]'):
        read_recording(written(tmp_path, text + "Kanalfehler;180,00;129,60;25,00\n"))


@pytest.mark.long
def test_what_closes_the_contract_s_own_table_is_to_be_deleted(tmp_path: Path) -> None:
    """A map that calls the word missing would make a reading of a mean."""
    text = table(list(RUN.values()), OWN, separator=",", decimal=".")
    for below in ("Mittelwert,180.0,129.6,25.0\n", "Ende der Messung,,,\n"):
        with pytest.raises(InputFileError, match=r"line 1502.*delete the line if it is no row"):
            read_recording(written(tmp_path, text + below))
    check(read_recording(written(tmp_path, text)))


def test_settings_of_channels_below_the_names_are_no_names(tmp_path: Path) -> None:
    """Two lines as HBM's catman writes them between the names and the rows."""
    lines = table(list(RUN.values()), GERMAN, separator="\t").splitlines()
    lines[1:1] = ["T0 = 12.03.2024 14:05:33" + "\tSR = 100 Hz" * 3, "\t".join(["dt = 10 ms"] * 4)]
    check(read_recording(written(tmp_path, "\n".join(lines) + "\n", name="log.asc")))


def test_a_file_of_two_decimal_marks_is_told_what_to_write(tmp_path: Path) -> None:
    """Points in the time and commas in the angles: no map reads both, so it is said what to write, and that is read."""
    lines = table(list(RUN.values()), GERMAN).splitlines()
    mixed = [lines[0], *(row.replace(",", ".", 1) for row in lines[1:])]
    with pytest.raises(InputFileError, match=r"line 2, column Zeit.*write one decimal mark in all columns") as caught:
        read_recording(written(tmp_path, "\n".join(mixed) + "\n"))
    assert "text.missing" not in str(caught.value)
    cured = [lines[0], *(row.replace(".", ",", 1) for row in mixed[1:])]
    check(read_recording(written(tmp_path, "\n".join(cured) + "\n")))
