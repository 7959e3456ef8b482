"""``gearpoly read`` of inspection sheets: they are told from recordings, and the map that it writes makes the pair."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import gearpoly
from gearpoly.errors import InputFileError
from gearpoly.files.inspection.heads_of_sheets import is_sheet
from gearpoly.recording.read import read_recording
from tests.made_command import PAIR, Command
from tests.made_texts import own, run
from tests.test_sheets_of_blocks import BESIDE, BLOCKS, COLUMNS, HEAD, LEFT, RIGHT, row, teeth, text
from tests.test_sheets_of_owners import PLAIN, rows, sheet
from tests.test_sheets_of_owners import right as same

ROOT = Path(__file__).parents[1]
OWNERS = {
    "plain": sheet("tooth,fp left [um],fp right [um]", PLAIN),
    "from 0": sheet("tooth,fp left [um],fp right [um]", rows(first=0)),
    "german": sheet("Zahn;fp links [mm];fp rechts [mm]", [one.replace(",", ";").replace(".", ",") for one in
                                                          rows("{:.4f}", per_um=1e-3)]),
    "french": sheet("Dent,fp gauche [um],fp droite [um]", PLAIN),
    "units row": sheet("tooth,fp left,fp right\n,mm,mm", rows("{:.4f}", per_um=1e-3)),
    "words": sheet("Tooth,Left Spacing [um],Right Spacing [um]", PLAIN),
}  # fmt: skip
EVERY = {**OWNERS, **{f"blocks {k}": v for k, v in BLOCKS.items()}, **{f"columns {k}": v for k, v in COLUMNS.items()}}


def with_module(lines: str, *more: str) -> str:
    """The lines of a written map with the # taken away before what only the gear tells, and ``more`` of them."""
    for one in ("gear.module_mm = 2.0", *more):
        assert f"# {one}\n" in lines, lines
        lines = lines.replace(f"# {one}\n", f"{one}\n")
    return lines


def paired(command: Command, folder: Path, file: Path, chart: Path) -> tuple[int, str]:
    words = ("--as", "driving", "--flank", "left", "--count", "clockwise", "--map", chart)
    ran = command("pair", "--from", file, folder / "p.toml", *words)
    return ran.code, ran.err


def test_python_tells_a_sheet_from_a_recording(tmp_path: Path) -> None:
    file = tmp_path / "sheet.csv"
    file.write_text(OWNERS["plain"], encoding="utf-8")
    with pytest.raises(InputFileError, match=r"sheet\.csv: an inspection sheet, no recording; pair_from"):
        gearpoly.survey(file)


@pytest.mark.parametrize("name", EVERY)
def test_the_written_map_makes_the_gear(gearpoly_command: Command, tmp_path: Path, name: str) -> None:
    file, chart, out = tmp_path / "sheet.csv", tmp_path / "map.toml", tmp_path / "out.json"
    file.write_text(EVERY[name], encoding="utf-8")
    ran = gearpoly_command("read", file, "--write", chart, "--json", out)
    assert ran.code == 0, ran.err
    assert "11 teeth" in ran.out and "an inspection, no recording" in ran.out and "not to be taken" not in ran.out
    found = json.loads(out.read_text(encoding="utf-8"))["inspections"][0]
    assert found["gear"]["teeth"] == 11
    assert {one["flank"] for one in found["measured"]} == {"left", "right"}
    assert all(one["count"] == 11 for one in found["measured"])
    chart.write_text(with_module(chart.read_text(encoding="utf-8")), encoding="utf-8")
    code, said = paired(gearpoly_command, tmp_path, file, chart)
    assert code == 0, said
    same(tmp_path)
    again = gearpoly_command("read", file, "--map", chart)
    assert again.code == 0 and "module_mm = 2" in again.out and "does not state its module" not in again.out


@pytest.mark.parametrize(
    ("lines", "more"),
    [
        (text("Flanke A", HEAD, *LEFT, "Flanke B", HEAD, *RIGHT),
         ('blocks."line 2" = "left"', 'blocks."line 15" = "right"')),
        (text(HEAD, *LEFT, HEAD, *RIGHT), ('blocks."line 1" = "left"', 'blocks."line 13" = "right"')),
        (text("A,,,,B,,", f"{HEAD},,{HEAD}", *BESIDE),
         ('columns."column 2" = "single_pitch_left"', 'columns."column 3" = "cumulative_pitch_left"',
          'columns."column 6" = "single_pitch_right"', 'columns."column 7" = "cumulative_pitch_right"')),
        (text(teeth("Tooth"), row("dT li", "left"), row("fp right", "right")),
         ('columns."dT li" = "single_pitch_left"',)),
        (text(teeth("Tooth"), row("fp", "left"), row("fp", "right")),
         ('columns."line 2" = "single_pitch_left"', 'columns."line 3" = "single_pitch_right"')),
    ],
    ids=["titles", "no titles", "side by side", "unknown head", "one head twice"],
)  # fmt: skip
def test_what_nobody_knows_is_a_line_behind_a_hash(
    gearpoly_command: Command, tmp_path: Path, lines: str, more: tuple[str, ...]
) -> None:
    file, chart = tmp_path / "sheet.csv", tmp_path / "map.toml"
    file.write_text(lines, encoding="utf-8")
    ran = gearpoly_command("read", file, "--write", chart)
    assert ran.code == 0, ran.err
    assert "nobody knows" in ran.out
    chart.write_text(with_module(chart.read_text(encoding="utf-8"), *more), encoding="utf-8")
    code, said = paired(gearpoly_command, tmp_path, file, chart)
    assert code == 0, said
    same(tmp_path)


@pytest.mark.parametrize("name", ["driving.mka", "driven.csv"])
def test_samples_are_told_as_they_are(gearpoly_command: Command, tmp_path: Path, name: str) -> None:
    chart = tmp_path / "map.toml"
    ran = gearpoly_command("read", ROOT / "data" / "sheets" / name, "--write", chart)
    assert ran.code == 0 and "not to be taken" not in ran.out
    taken = next(line for line in chart.read_text(encoding="utf-8").splitlines() if "Taken by: " in line)
    assert f"gearpoly pair --from {name}" in taken
    lines = chart.read_text(encoding="utf-8")
    chart.write_text(lines if "gear.module_mm = 2.0\n" in lines.replace("# gear", "") else with_module(lines), "utf-8")
    code, said = paired(gearpoly_command, tmp_path, ROOT / "data" / "sheets" / name, chart)
    assert code == 0, said


@pytest.mark.long
def test_an_inspection_as_xml_is_told(gearpoly_command: Command, tmp_path: Path) -> None:
    """What ``export`` wrote of a gear: its map leaves nothing open, and is taken."""
    pair, file, chart = tmp_path / "pair.toml", tmp_path / "gear.gde", tmp_path / "map.toml"
    pair.write_text(PAIR, encoding="utf-8")
    ran = gearpoly_command("export", pair, "--to", file, "--gear", "driving")
    assert ran.code == 0, ran.err
    ran = gearpoly_command("read", file, "--write", chart)
    assert ran.code == 0 and "inspection as XML" in ran.out and "18 teeth" in ran.out, ran.err
    words = ("--as", "driving", "--flank", "left", "--map", chart)
    ran = gearpoly_command("pair", "--from", file, tmp_path / "made.toml", *words)
    assert ran.code == 0, ran.err
    with pytest.raises(InputFileError, match=r"no recording; want it given to gearpoly pair --from"):
        read_recording(file)


@pytest.mark.parametrize("file", sorted((ROOT / "data" / "recordings").rglob("*.csv")), ids=lambda one: one.name)
def test_recordings_are_no_sheets(file: Path) -> None:
    assert not is_sheet(file)


@pytest.mark.parametrize(
    "lines",
    [
        own(run(700)),
        "x,y,z,index\n" + "".join(f"{k % 7},{k % 5},{(7 * k) % 11},{k}\n" for k in range(50)),
        "Zeit;Antrieb;Abtrieb;Seite\n" + "".join(f"{k};{k};{k};1\n" for k in range(50)),
        "index,z,t\n" + "".join(f"{k},{0.1 * k},{k}\n" for k in range(50)),
    ],
)
def test_tables_of_other_things_are_no_sheets(tmp_path: Path, lines: str) -> None:
    file = tmp_path / "rec.csv"
    file.write_text(lines, encoding="utf-8")
    assert not is_sheet(file)


@pytest.mark.parametrize("name", ["plain", "german", "blocks side by side", "columns titles"])
def test_a_sheet_that_is_compared_is_called_one(tmp_path: Path, name: str) -> None:
    """Two of its columns were offered as angles."""
    file = tmp_path / "sheet.csv"
    file.write_text(EVERY[name], encoding="utf-8")
    with pytest.raises(
        InputFileError, match=r"an inspection sheet, no recording; want it given to gearpoly pair --from"
    ):
        read_recording(file)


def test_designs_and_own_sheets_are_told_where_they_go(gearpoly_command: Command, tmp_path: Path) -> None:
    ran = gearpoly_command("read", ROOT / "data" / "sheets" / "design.rexs")
    assert ran.code == 2 and re.search(
        r"a design \(REXS\), no recording; want it given to gearpoly pair --from", ran.err
    )
    ran = gearpoly_command("pair", "--new", tmp_path / "pair.toml", "--sheet", tmp_path / "own.csv")
    ran = gearpoly_command("read", tmp_path / "own.csv")
    assert ran.code == 2 and 'sheet_csv = "own.csv" under [driving.inspection]' in ran.err


def test_what_a_picture_of_a_sheet_would_be_is_refused(gearpoly_command: Command, tmp_path: Path) -> None:
    file = tmp_path / "sheet.csv"
    file.write_text(OWNERS["plain"], encoding="utf-8")
    ran = gearpoly_command("read", file, "--plot", tmp_path / "x.png")
    assert ran.code == 2 and "leave --plot out" in ran.err and not (tmp_path / "x.png").exists()
