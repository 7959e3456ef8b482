"""Quick looks at texts of millions of cells say what a look at each cell says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_tables
from gearpoly.recording.table import Table
from gearpoly.recording.text import cells, foreign, parsed
from gearpoly.recording.text.cells import marks_proved
from gearpoly.recording.text.encoding import coded
from gearpoly.recording.text.even_stamps import Codes, EvenStamps
from gearpoly.recording.text.lines import NUMBER_CHARACTERS, TextLines, are_rows
from gearpoly.recording.text.part import TextPart

PIECES = ("1", "12,5", "-0.25", "3e5", "+4E-2", "7.", " 8 ", "1.000,5", "05.03.2026")
ODD = ("", "-", "e5", "1e", "x", "1;2", "1\t2", ".e3", "\u00b0", "+", "1:2")


def is_cell(cell: str) -> bool:
    """Whether a cell has a digit and nothing but what numbers are written with, and powers behind digits alone."""
    if not any("0" <= one <= "9" for one in cell) or not all(one.encode() in NUMBER_CHARACTERS for one in cell):
        return False
    return all(k > 0 and "0" <= cell[k - 1] <= "9" for k, one in enumerate(cell) if one in "eE")


@pytest.mark.parametrize("separator", [";", ",", "\t"])
def test_rows_are_told_as_by_a_look_at_each_cell(separator: str) -> None:
    rng = np.random.default_rng(3)
    seen = set()
    for trial in range(600):
        width, odd = 2 + trial % 3, trial % 4
        rows = [[PIECES[k] for k in rng.integers(0, len(PIECES), width)] for _ in range(rng.integers(1, 8))]
        for _ in range(odd):
            row = rows[rng.integers(0, len(rows))]
            row[rng.integers(0, len(row))] = ODD[rng.integers(0, len(ODD))]
        if odd == 3:
            rows[rng.integers(0, len(rows))].append("1")
        text = "\n".join(separator.join(row) for row in rows)
        wanted = all(
            line.count(separator) == width - 1
            and all(cell == "" or is_cell(cell) for cell in line.split(separator))
            and any(is_cell(cell) for cell in line.split(separator))
            for line in text.split("\n")
        )
        above = separator.join(["7"] * width).encode("ascii")
        assert are_rows(text.encode("utf-8"), separator, above) == wanted, text
        seen.add(wanted)
    assert seen == {False, True}


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        (b"1:02 AM,5\n1:03 PM,6", True),
        (b"1:02 am,5\n1:03 PM,6", False),
        (b"1:02 AM,5\n1:03,6", True),  # which is told where it is read
        (b"1:02 AM,5 AM\n1:03 PM,6", True),
        (b"1:02 AM,5\nAMEN,6", False),
        (b"1:02 AM,5\n1:03 AM 4,6", False),
        (b"1:02 AM,5\n1:03 XM,6", False),
    ],
)
def test_halves_of_the_day_are_no_words(text: bytes, rows: bool) -> None:
    assert are_rows(text, ",", b"12:00 PM,7") == rows
    assert (
        are_rows(b"\n".join(b",".join(line.split(b",")[::-1]) for line in text.split(b"\n")), ",", b"7,12:00 PM")
        == rows
    )


def test_rows_parted_by_blanks_are_told_as_by_a_look_at_each_cell() -> None:
    rng = np.random.default_rng(5)
    seen = set()
    for trial in range(600):
        rows = [[PIECES[k].strip() for k in rng.integers(0, len(PIECES), 3)] for _ in range(rng.integers(1, 8))]
        if trial % 2:
            row = rows[rng.integers(0, len(rows))]
            row[rng.integers(0, 3)] = ODD[rng.integers(0, len(ODD))]
        blank = [" " * k for k in rng.integers(1, 4, 40)]
        text = "\n".join(blank[k][1:] + blank[k + 9].join(row) + blank[k + 19][1:] for k, row in enumerate(rows))
        wanted = all(
            len(line.split(" ")) == 3 and all(is_cell(cell) for cell in line.split(" "))
            for line in (" ".join(one for one in line.split(" ") if one) for line in text.split("\n"))
        )
        assert are_rows(text.encode("utf-8"), " ", b"  7 8   9 ") == wanted, text
        seen.add(wanted)
    assert seen == {False, True}


def test_one_mark_alone_proves_what_all_cells_prove(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(4)
    ways = ("12,5", "1,234", "0,125", "1,234,567", "7", "3.5", "1.234", "-1234,567", "1,5e3", "nan", "")
    columns = [[[ways[k] for k in rng.choice(len(ways), 3)] for _ in range(rng.integers(1, 4))] for _ in range(500)]
    quick = [marks_proved(one, separator=";", quoted=False) for one in columns]
    monkeypatch.setattr(cells, "_marked_once", lambda columns: None)
    assert quick == [marks_proved(one, separator=";", quoted=False) for one in columns]
    assert len({(one.decimal, one.thousands) if one else None for one in quick}) > 3


def test_empty_cells_are_the_same_in_one_go_and_cell_by_cell(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Drop-outs of a column, with the same remarks; words without a reading are told either way."""
    pytest.importorskip("pyarrow")
    monkeypatch.setattr(parsed, "LARGE_BYTES", 0)
    for word, mark in (("", ";"), ("nan", ";"), ("OL", ";"), ("nan", "   ")):
        rows = [["1,5", f"{k},25", f"{2 * k},5"] for k in range(500)]
        for k in (100, 101, 250):
            rows[k][1 + k % 2] = word if k == 250 or mark != ";" else ""
        file = tmp_path / "a.csv"
        file.write_text(mark.join("ABC") + "\n" + "".join(mark.join(row) + "\n" for row in rows), encoding="utf-8")
        quick = read_tables(file)[0]
        with monkeypatch.context() as patch:
            patch.setattr(TextPart, "plain", lambda *_: None)
            slow = read_tables(file)[0]
        assert quick.remarks == slow.remarks
        assert any(word in one for one in quick.remarks) and np.isnan(quick.others["B"].values).sum() == 2
        for name, one in quick.others.items():
            np.testing.assert_array_equal(one.values, slow.others[name].values)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize(
    ("encoding", "name", "stated"),
    [
        ("utf-8", "utf-8", ""),
        ("utf-8-sig", "utf-8-sig", ""),
        ("utf-8-sig", "UTF8", "UTF8"),
        ("cp1252", "cp1252", ""),
        ("utf-16", "utf-16", ""),
        ("utf-16-le", "utf-16-le", ""),
        ("utf-32", "utf-32", ""),
        ("cp850", "cp850", "cp850"),
    ],
)
@pytest.mark.parametrize("beyond", [False, True])
def test_a_text_is_held_in_its_own_bytes_or_in_utf_8(
    tmp_path: Path, encoding: str, name: str, stated: str, end: str, beyond: bool
) -> None:
    """With a sign beyond ASCII in the heading alone, and with one below the part that is looked at first."""
    wanted = ["Winkel [\u00b0]", *["1,25;3,50"] * 9000, "\u00d8" if beyond else "0,5;1,5"]
    file = tmp_path / "a.txt"
    file.write_bytes(
        end.join([*wanted, ""]).encode(encoding) + (b"" if "16" in encoding or "32" in encoding else b"\0")
    )
    text, inside, found = coded(file, stated=stated)
    lines = TextLines(text, inside)
    assert found == name
    assert [*lines] == [*wanted, ""]
    assert lines[0] == wanted[0] and lines[-2] == wanted[-1]
    assert lines.joined(1, 3) == "1,25;3,50\n1,25;3,50"
    assert lines.hold("\u00b0", 0, 1) and not lines.hold("\u00b0", 1, 9) and not lines.hold("\u202f", 0, 9)


BEGIN = np.datetime64("2026-03-05T23:59:50.000000")


def stamped(form: str, count: int = 300) -> list[str]:
    """Stamps every 0.25 s, over midnight, in a ``form`` of strftime; ``%f`` has six digits."""
    return [(BEGIN + np.timedelta64(250_000 * k, "us")).item().strftime(form) for k in range(count)]


def both(monkeypatch: pytest.MonkeyPatch, file: Path, taken: list[bool]) -> tuple[Table | str, Table | str]:
    """What is read in one go and cell by cell: a table, or what is said of the fault; into ``taken``, whether stamps
    were taken in one go."""
    out: list[Table | str] = []
    real = foreign.even_stamps
    monkeypatch.setattr(parsed, "LARGE_BYTES", 0)

    def asked(codes: Codes) -> EvenStamps | None:
        found = real(codes)
        taken.append(found is not None)
        return found

    for way in (asked, lambda codes: None):
        monkeypatch.setattr(foreign, "even_stamps", way)
        try:
            out.append(read_tables(file)[0])
        except InputFileError as error:
            out.append(str(error))
    return out[0], out[1]


@pytest.mark.parametrize(
    ("forms", "at_once"),
    [
        (("%Y-%m-%d %H:%M:%S,%f",), True),
        (("%Y-%m-%dT%H:%M:%S.%f",), True),
        (("%d.%m.%Y %H:%M:%S",), True),
        (("%d/%m/%Y %H:%M:%S.%f",), True),
        (("%d/%m/%y %H:%M:%S",), True),
        (("%H:%M:%S.%f",), True),
        (("%d.%m.%Y", "%H:%M:%S,%f"), True),
        (("%Y-%m-%dT%H:%M:%S.%fZ",), True),
        (("%Y-%m-%dT%H:%M:%S.%f+01:00",), True),
        (("%Y-%m-%d %H:%M:%S.%f -0330",), True),
        (("%m/%d/%Y %I:%M:%S %p",), True),
        (("%-m/%-d/%Y %-I:%M:%S.%f %p",), True),
        (("%-I:%M:%S.%f%p",), True),
        (("%-d.%-m.%Y", "%-H:%M:%S,%f"), True),
        (("%M:%S.%f",), False),
    ],
)
def test_even_stamps_are_the_same_in_one_go_and_cell_by_cell(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, forms: tuple[str, ...], at_once: bool
) -> None:
    """Bit by bit, with the same remarks and doubts."""
    pytest.importorskip("pyarrow")
    columns = [stamped(form) for form in forms]
    names = ("Datum", "Uhrzeit")[-len(forms) :]
    rows = [";".join([*row, f"{k},5", f"{k},25"]) for k, row in enumerate(zip(*columns, strict=True))]
    file = tmp_path / "a.csv"
    file.write_text("\n".join([";".join([*names, "A", "B"]), *rows, ""]), encoding="utf-8")
    taken: list[bool] = []
    quick, slow = both(monkeypatch, file, taken)
    assert isinstance(quick, Table) and isinstance(slow, Table)
    assert taken == [at_once] * len(forms)
    assert [*quick.others] == [*slow.others]
    for name, one in quick.others.items():
        np.testing.assert_array_equal(one.values, slow.others[name].values)
        assert (one.unit, one.leaf, one.number) == (
            slow.others[name].unit,
            slow.others[name].leaf,
            slow.others[name].number,
        )
    assert (quick.remarks, quick.doubts, quick.layout) == (slow.remarks, slow.doubts, slow.layout)


def test_hours_of_twelve_and_changing_zones(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Noon and midnight, an hour that is none of twelve, and a clock that is set from winter to summer."""
    pytest.importorskip("pyarrow")
    hours = [f"{h} {half}" for half in ("AM", "PM") for h in (12, *range(1, 12))]
    cells_ = [f"4/3/2026 {one.split()[0]}:{m:02d}:00 {one.split()[1]}" for one in hours for m in range(0, 60, 5)]
    winter = [f"2026-03-29T{h:02d}:{m:02d}:00+{1 + (h > 1):02d}:00" for h in (0, 1, 3, 4) for m in range(60)]
    for held, right in ((cells_, 300.0 * np.arange(288)), (winter, 60.0 * np.arange(240))):
        file = tmp_path / "a.csv"
        file.write_text("Time;A\n" + "".join(f"{one};{k},5\n" for k, one in enumerate(held)), encoding="utf-8")
        quick, slow = both(monkeypatch, file, [])
        assert isinstance(quick, Table) and isinstance(slow, Table)
        np.testing.assert_array_equal(quick.others["Time"].values, right)
        np.testing.assert_array_equal(slow.others["Time"].values, right)
    cells_[100] = "4/3/2026 13:20:00 PM"
    file.write_text("Time;A\n" + "".join(f"{one};{k},5\n" for k, one in enumerate(cells_)), encoding="utf-8")
    quick, slow = both(monkeypatch, file, [])
    assert quick == slow and "13:20:00 PM" in str(quick)


@pytest.mark.parametrize(
    "bad", ["2026-03-05 23:61:00", "2026-02-31 23:59:59", "2026-03-05 25:00:00", "2026-03-05 23:5x:00", ""]
)
def test_a_bad_stamp_is_told_as_cell_by_cell(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, bad: str) -> None:
    pytest.importorskip("pyarrow")
    cells_ = stamped("%Y-%m-%d %H:%M:%S")
    cells_[200] = bad
    file = tmp_path / "a.csv"
    file.write_text("Zeit;A;B\n" + "".join(f"{one};{k},5;{k},25\n" for k, one in enumerate(cells_)), encoding="utf-8")
    quick, slow = both(monkeypatch, file, [])
    if isinstance(quick, Table) and isinstance(slow, Table):
        assert bad == ""
        for name, one in quick.others.items():
            np.testing.assert_array_equal(one.values, slow.others[name].values)
    else:
        assert quick == slow and "line 202" in str(quick)
