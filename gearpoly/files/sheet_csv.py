"""An inspection sheet as a table: one row per tooth of a gear, one column per measured deviation; and an empty one."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gearpoly.arguments import GEARS
from gearpoly.errors import InputFileError, shown
from gearpoly.files.paths import is_file
from gearpoly.files.traces import DEVIATION_LIMIT_UM, check_header, parse_number, read_text, split_row
from gearpoly.keys.inspection import Inspection

SHEET_KEYS = tuple(
    key
    for key in Inspection.model_fields
    if key.endswith("_um") and key not in ("uncertainty_um", "profile_form_um", "profile_form_coast_um")
)
"""Keys of an inspection that have one value per tooth: the columns of a sheet beside gear and tooth."""

MOST_TEETH = 10_000
"""Teeth of the largest gear that a pair file may state; more are refused there."""

ROWS_HELP = """# Inspection sheet: one row per tooth, numbered from 0 in the order in which teeth come into mesh, in um.
# Leave a column empty that nobody measured; fill a column for all teeth of a gear or for none.
{flanks}
# single_pitch_um is f_p, tooth n against n - 1, positive = pitch too large; pitch_um is the index deviation (the F_p
# curve), positive = more material. Fill one of the two. E_s in tooth_thickness_um: negative thins.
"""

SIDES_HELP = """# Left and right on a sheet: look at the datum face, the tooth pointing up. Where the driving gear turns
# counter-clockwise (the driven gear then clockwise) seen on the datum faces, the left flank is the drive flank of both
# gears and the right one the coast flank. Teeth then come into mesh clockwise on the driving gear, and
# counter-clockwise on the driven one. Where a gear turns the other way, or was measured from its other face, right is
# drive, left is coast, and its teeth come the other way round. The columns without "coast" are those of the drive
# flank."""


def sheet_text(teeth: Mapping[str, int]) -> str:
    """An empty sheet for gears with so many ``teeth`` each, by "driving" and "driven"."""
    rows = [f"{gear},{tooth}" + "," * len(SHEET_KEYS) for gear in GEARS for tooth in range(teeth[gear])]
    return ROWS_HELP.format(flanks=SIDES_HELP) + "\n".join((",".join(("gear", "tooth", *SHEET_KEYS)), *rows)) + "\n"


def with_sheets(raw: dict[str, Any], pair_file: Path) -> dict[str, Any]:
    """The tables ``raw`` of ``pair_file`` with the columns of its sheets as keys of the inspections that name them.

    A gear of which its sheet says nothing, and of which nothing else was measured, has no inspection. Raises
    ``InputFileError`` for a sheet that is missing, that has another gear's rows, gaps or no numbers, and for what both
    files state.
    """
    out = dict(raw)
    for gear in GEARS:
        section = raw.get(gear)
        if not isinstance(section, dict) or not isinstance(section.get("inspection"), dict):
            continue
        inspection, z = section["inspection"], section.get("teeth")
        name = inspection.get("sheet_csv")
        if not isinstance(name, str) or not name or type(z) is not int or not 0 < z <= MOST_TEETH:
            continue  # nothing, or what the model refuses
        file, where = pair_file.parent / name, f"{gear}.inspection.sheet_csv"
        if not is_file(file):
            wish = "want the path of an inspection sheet, relative to the pair file"
            raise InputFileError(pair_file, where=where, found=f"no such file, {file}", wish=wish)
        columns = _columns(file, gear, z)
        for key in columns:
            if key in inspection:
                found = f"{key} in the sheet, and in the pair file too"
                raise InputFileError(pair_file, where=where, found=found, wish="want it in one of the two")
        merged = {key: value for key, value in inspection.items() if key != "sheet_csv"} | columns
        keep = {key: value for key, value in section.items() if key != "inspection"}
        out[gear] = keep | ({"inspection": merged} if set(merged) - {"uncertainty_um"} else {})
    return out


def _columns(file: Path, gear: str, z: int) -> dict[str, list[float]]:
    """The columns that a sheet fills for a ``gear`` with ``z`` teeth."""
    names: list[str] = []
    rows: dict[int, tuple[str, dict[str, float]]] = {}
    for number, line in enumerate(io.StringIO(read_text(file), newline=None), start=1):
        where = f"line {number}"
        if not line.strip(" ,\t\r\n") or line.lstrip(' "').startswith("#"):
            continue
        cells = split_row(line)
        if not names:
            check_header(file, where, cells, ("gear", "tooth", *SHEET_KEYS))
            names = cells
            for name in ("gear", "tooth"):
                if name not in names:
                    wish = "want the columns gear and tooth, and what was measured"
                    raise InputFileError(file, where=where, found=f'no column "{name}"', wish=wish)
            continue
        if len(cells) != len(names):
            wish = f"want {len(names)}, as in the header, and decimal points"
            raise InputFileError(file, where=where, found=f"{len(cells)} cells", wish=wish)
        row = dict(zip(names, cells, strict=True))
        if row["gear"] not in GEARS:
            raise _bad(file, where, "gear", row["gear"], "driving or driven")
        if row["gear"] != gear:
            continue
        cell = row["tooth"]
        if not (cell.isascii() and cell.isdigit()) or len(cell) > 9 or int(cell) >= z:
            raise _bad(file, where, "tooth", cell, f"a tooth of the {gear} gear, 0 to {z - 1}")
        if int(cell) in rows:
            found = f"tooth {cell} of the {gear} gear again, as in {rows[int(cell)][0]}"
            raise InputFileError(file, where=where, found=found, wish="want each tooth once")
        rows[int(cell)] = where, {key: _value(file, where, key, row[key]) for key in names if key in SHEET_KEYS}
    out: dict[str, list[float]] = {}
    for key in (name for name in names if name in SHEET_KEYS):
        values = [rows[k][1][key] if k in rows else math.nan for k in range(z)]
        empty = [k for k, value in enumerate(values) if math.isnan(value)]
        if len(empty) == z:
            continue
        if empty:
            found = f"no value for tooth {empty[0]} of the {gear} gear"
            raise InputFileError(
                file, where=f"column {key}", found=found, wish=f"want all {z} teeth, or an empty column"
            )
        out[key] = values
    return out


def _value(file: Path, where: str, key: str, cell: str) -> float:
    """The number in a cell, nan where it is empty."""
    if not cell:
        return math.nan
    value = parse_number(cell)
    if value is None or not abs(value) <= DEVIATION_LIMIT_UM:
        span = f"a number in um, -{DEVIATION_LIMIT_UM:.0f} to {DEVIATION_LIMIT_UM:.0f}, or an empty cell"
        raise _bad(file, where, key, cell, span)
    return value + 0.0


def _bad(file: Path, where: str, column: str, cell: str, want: str) -> InputFileError:
    found = f'"{shown(cell)}"' if cell else "an empty cell"
    return InputFileError(file, where=f"{where}, column {column}", found=found, wish=f"want {want}")
