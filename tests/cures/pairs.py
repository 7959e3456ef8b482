"""Refusals of pair files and of what they name: keys, TOML, inspection sheets, traces, inspection files."""

from __future__ import annotations

from pathlib import Path

from gearpoly.api import load
from gearpoly.files.sheet_csv import sheet_text
from tests.cures.cure import Cure, put
from tests.made_command import PAIR
from tests.test_gde import HAND, pair_text

TEETH = {"driving": 18, "driven": 25}
EMPTY = sheet_text(TEETH)
HEAD = next(line for line in EMPTY.splitlines() if line.startswith("gear,"))
NAMES = HEAD.split(",")


def filled(**cells: str) -> str:
    """A sheet whose first row of the driving gear, and all others of it, have 1.0 in a column; ``cells`` of row 3."""
    lines = [HEAD]
    for tooth in range(18):
        row = dict.fromkeys(NAMES, "") | {"gear": "driving", "tooth": str(tooth), "pitch_um": str(tooth % 2 * 2 - 1.0)}
        lines.append(",".join((row | (cells if tooth == 3 else {}))[name] for name in NAMES))
    return "\n".join(lines) + "\n"


def pair(name: str, says: str, bad: dict[str, str | bytes], good: dict[str, str | bytes]) -> Cure:
    """A pair file with what it names, by file name: refused, and loaded after the ``good`` files were put there."""

    def attempt(folder: Path, files: dict[str, str | bytes]) -> object:
        for one, content in files.items():
            put(folder, one, content)
        return load(folder / "pair.toml")

    return Cure(
        name=name,
        says=says,
        bad=lambda folder: attempt(folder, bad),
        good=lambda folder, message: attempt(folder, good),
    )


SHEET = PAIR.replace("grade = 6\n", '[driving.inspection]\nsheet_csv = "sheet.csv"\n', 1)
TRACED = PAIR.replace("grade = 6\n", '[driving.inspection]\nprofile_csv = "t.csv"\n', 1)
TRACE_HEAD = "tooth,flank,roll_length_mm,deviation_um\n"
TRACE = TRACE_HEAD + "0,drive,5.0,1.0\n0,drive,8.0,2.0\n"


def key(name: str, says: str, old: str, new: str, *, good: str = PAIR) -> Cure:
    assert old in PAIR, old
    return pair(name, says, {"pair.toml": PAIR.replace(old, new, 1)}, {"pair.toml": good})


def sheet(name: str, says: str, bad: str | bytes, *, text: str = SHEET, good: str | None = None) -> Cure:
    return pair(
        name,
        says,
        {"pair.toml": text, "sheet.csv": bad},
        {"pair.toml": SHEET, "sheet.csv": filled() if good is None else good},
    )


def trace(name: str, says: str, bad: str) -> Cure:
    return pair(name, says, {"pair.toml": TRACED, "t.csv": bad}, {"t.csv": TRACE})


CURES = [
    key("unknown key", 'the nearest known key in [driving] is "teeth"', "teeth = 18", "teth = 18"),
    key("missing key", "want number of teeth", "teeth = 18\n", ""),
    key("too small", "want 5 or more", "teeth = 18", "teeth = 1"),
    key("word", "want a whole number", "teeth = 18", 'teeth = "many"'),
    key("rule", "want", "grade = 6", "grade = 6\ndiametral_pitch = 12.7"),
    key("no TOML", "want", "teeth = 18", "teeth = = 18"),
    key("deep", "its limit is 32 parts", "teeth = 18", ".".join("a" * 40) + " = 1"),
    key("nested", "want", "teeth = 18", "x = " + "[" * 5000),
    pair("large", "the limit is", {"pair.toml": PAIR + "#" * 5_000_000}, {"pair.toml": PAIR}),
    pair(
        "no UTF-8",
        "save it again with that encoding",
        {"pair.toml": f"# \u00b5\n{PAIR}".encode("cp1252")},
        {"pair.toml": f"# \u00b5\n{PAIR}"},
    ),
    pair("too large a file", "or check the file name", {"pair.toml": PAIR + "#" * (64 * 2**20)}, {"pair.toml": PAIR}),
    pair(
        "no sheet",
        "want the path of an inspection sheet, relative to the pair file",
        {"pair.toml": SHEET},
        {"sheet.csv": filled()},
    ),
    pair(
        "no traces", "want the path of a trace file, relative to the pair file", {"pair.toml": TRACED}, {"t.csv": TRACE}
    ),
    sheet(
        "stated twice",
        "want it in one of the two",
        filled(),
        text=SHEET.replace('"sheet.csv"\n', '"sheet.csv"\npitch_um = 1.0\n'),
    ),
    sheet("column missing", "want the columns gear and tooth", "gear,pitch_um\ndriving,1.0\n"),
    sheet("cells", "as in the header, and decimal points", filled() + "driving,1\n"),
    sheet("gear", "want driving or driven", filled(gear="pinion")),
    sheet("tooth", "want a tooth of the driving gear, 0 to 17", filled(tooth="18")),
    sheet("tooth twice", "want each tooth once", filled(tooth="2")),
    sheet("a gap", "want all 18 teeth, or an empty column", filled(pitch_um="")),
    sheet("cell", "or an empty cell", filled(pitch_um="x")),
    sheet("semicolons", "want commas between cells and decimal points", filled().replace(",", ";")),
    sheet("no name", "want a name for every column", filled().replace("tooth,", "tooth,,", 1)),
    sheet("a number for a name", "want a header row first", "0,1,2.0\n"),
    sheet("unknown column", 'the nearest known column is "pitch_um"', filled().replace("pitch_um", "pich_um", 1)),
    sheet("column twice", "want each name once", filled().replace("pitch_coast_um", "pitch_um", 1)),
    sheet(
        "open circle",
        "belong in pitch_um",
        "gear,tooth,single_pitch_um\n" + "".join(f"driving,{n},3.0\n" for n in range(18)),
    ),
    trace("line", "want lines of at most 10000 characters", TRACE + "1" * 20_000),
    trace("cells", "want 4, as in the header", TRACE + "0,drive\n"),
    trace("no column", "want the columns tooth, flank", TRACE.replace(",deviation_um", "", 1)),
    trace("flank", "want drive or coast", TRACE + "1,left,5.0,1.0\n"),
    trace("length", "a length from the base circle, 0 or more", TRACE + "1,drive,-5.0,1.0\n"),
    trace("deviation", "a deviation in um, -10000 to 10000", TRACE + "1,drive,5.0,1e6\n"),
    trace("number", "a finite number with a decimal point", TRACE + "1,drive,x,1.0\n"),
    trace("tooth", "a tooth number from 0 to 17", TRACE + "18,drive,5.0,1.0\n"),
    trace("no rows", "want rows of tooth, flank", TRACE_HEAD),
    trace("one point", "want at least 2 points on a flank", TRACE_HEAD + "0,drive,5.0,1.0\n"),
    trace("twice", "want each roll length once on a flank", TRACE + "0,drive,8.0,1.0\n"),
    pair(
        "another gear",
        "want 7, as pair.toml has it",
        {"gear.gde": HAND, "pair.toml": pair_text("driving").replace("teeth = 6", "teeth = 7")},
        {"pair.toml": pair_text("driving")},
    ),
    pair(
        "no inspection file",
        "want the path of an inspection file, relative to the pair file",
        {"pair.toml": pair_text("driving")},
        {"gear.gde": HAND},
    ),
    pair(
        "no such span",
        "want span_mm and span_teeth as measured on this gear",
        {"pair.toml": PAIR.replace("grade = 6\n", "[driving.inspection]\nspan_mm = 99.0\nspan_teeth = 3\n", 1)},
        {"pair.toml": PAIR},
    ),
]
