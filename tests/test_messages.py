"""What files and command lines hold never acts on a terminal or a spreadsheet, and a message is one short line."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from gearpoly.errors import MESSAGE_SHOWN, GearpolyError, InputFileError, shown
from gearpoly.files.environment import check_arguments, check_environment
from gearpoly.files.gde_read import read_gde
from gearpoly.files.pairfile import dump_pair, read_pair
from gearpoly.report.terminal import Terminal
from gearpoly.study.read import read_study
from gearpoly.study.store import _cell
from tests.made_command import Command
from tests.made_pairfile import SMALLEST, write
from tests.study_files import write_study
from tests.test_gde import HAND

ACTS = "\x1b]0;title\x07\x1b[31m\r\n\x9b2J\u202e\u2028\ufeff\udcff"


@pytest.mark.parametrize("text", [ACTS, "x" * 900_000, ACTS * 100_000, "", "plain 5 °C µm"])
def test_shown_text_is_one_short_line_and_stays_as_it_is(text: str) -> None:
    line = shown(text)
    assert line.isprintable()
    assert len(line) <= 60
    assert shown(line) == line
    if text.isprintable() and len(text) <= 60:
        assert line == text


def test_both_ends_of_a_long_text_are_shown() -> None:
    assert shown("/data/" + "x" * 500 + "/rec_7.csv", width=40).startswith("/data/")
    assert shown("/data/" + "x" * 500 + "/rec_7.csv", width=40).endswith("/rec_7.csv")
    assert shown("\udce4") == "\\xe4", "a byte that is no UTF-8, as the byte it is"


def test_every_part_of_a_message_is_safe_and_short() -> None:
    for error in (
        GearpolyError(ACTS * 9999),
        InputFileError(ACTS * 99, where=ACTS * 99, found=ACTS * 999, wish=ACTS * 99),
    ):
        assert str(error).isprintable()
        assert len(str(error)) <= MESSAGE_SHOWN
    # A value as large as its file leaves room for where it stands and for the cure.
    told = str(InputFileError("pair.toml", where="driving.teeth", found="9" * 900_000, wish="want 5 to 10000"))
    assert told.startswith("pair.toml: driving.teeth: 999")
    assert told.endswith("; want 5 to 10000")


def test_names_are_one_safe_line_in_every_result(tmp_path: Path) -> None:
    file = write(tmp_path, 'name = "a\\u001b[31mb\\nc"\n' + SMALLEST)
    pair = read_pair(file)
    assert pair.name == "a\\x1b[31mb\\nc"
    file.write_text(dump_pair(pair))
    assert read_pair(file) == pair
    (tmp_path / "s").mkdir()
    study = write_study(tmp_path / "s")
    study.write_text(study.read_text().replace("small study", "two\\nlines"))
    assert read_study(study).file.name == "two\\nlines"
    gear = tmp_path / "gear.gde"
    gear.write_text(HAND.replace("six &amp; teeth", "six\nteeth"))
    assert read_gde(gear).name == "six\\nteeth"


def test_the_printer_takes_no_orders() -> None:
    out = io.StringIO()
    Terminal(file=out, width=80).print("a\x1b[2J :warning: [bold]b[/bold]\nnext line", highlight=False)
    assert out.getvalue() == "a\\x1b[2J :warning: [bold]b[/bold]\nnext line\n"


def test_a_hostile_pair_file_prints_one_line(gearpoly_command: Command, tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    for text in (
        '"\\u001b[2J\\n" = 1\n' + SMALLEST,
        SMALLEST + f'grade = "{"v" * 900_000}"\n',
        f"{'k' * 90_000} = 1\n",
    ):
        file.write_text(text)
        ran = gearpoly_command("simulate", file)
        assert ran.code == 2
        assert ran.err.count("\n") == 1
        assert ran.err[:-1].isprintable()
        assert len(ran.err) <= MESSAGE_SHOWN + len("gearpoly: \n")


@pytest.mark.parametrize(
    ("word", "says"),
    [
        ("b\udcff.toml", r"b\xff.toml"),
        ("a\x1b[2J.toml", r"a\x1b[2J.toml"),
        ("--out=\n", r"\n"),
        ("x" * 5000, "5000 characters"),
    ],
)
def test_words_that_could_not_be_printed_are_refused(word: str, says: str) -> None:
    with pytest.raises(InputFileError) as caught:
        check_arguments(["simulate", word])
    assert says in str(caught.value)
    check_arguments(["compare", "Zahnrad ä.toml", "recording\u202f5.csv", "--json", "-"])


def test_variables_that_stop_a_library_are_named() -> None:
    for name, bad, good in (
        ("NUMBA_NUM_THREADS", "-1", "4"), ("NUMBA_CPU_FEATURES", "abc", "+avx2,-sse3"), ("SOURCE_DATE_EPOCH", "x", "0"),
    ):  # fmt: skip
        with pytest.raises(InputFileError, match=name):
            check_environment({name: bad})
        check_environment({name: good, "COLUMNS": "-1", "LANG": "xx", "TERM": "\x1b"})


def test_text_is_no_formula_to_a_spreadsheet_and_numbers_stay_numbers() -> None:
    for text in ("=1+1", "+cmd|' /C calc'!A0", "-@SUM(1)", "@x", "\t=1", "\r=1", "=HYPERLINK(1)"):
        assert _cell(text) == f"'{text}"
    for value in ("-0.5", "+3", "drive", "a=b", 1.5, -2, True, "", "flanks.csv"):
        assert _cell(value) == value
    assert _cell(None) == ""
