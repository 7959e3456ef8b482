"""An inspection sheet as a table of any layout: found by its heads in German or English, or read as a map says."""

from __future__ import annotations

import csv
import io
import math
import re
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from gearpoly.errors import InputFileError, shown
from gearpoly.files.gde import Side, Turn
from gearpoly.files.inspection.klingelnberg_text import SIDE
from gearpoly.files.inspection.measured import SIDES, MeasuredGear, closed
from gearpoly.files.inspection.sheet_map import SheetMap
from gearpoly.files.inspection.text import any_text
from gearpoly.files.traces import DEVIATION_LIMIT_UM, LINE_LIMIT, parse_number
from gearpoly.keys.kinds import NAME_SHOWN

SEPARATORS = (";", "\t", "|", ",")

HEADS = (
    ("tooth", r"(z(ahn|\W)?-?\s?(nr|no|nummer)\.?|zahn|tooth\s?(no\.?|number|#)?|z)$"),
    ("flank", r"(flanke|flank|seite|side)$"),
    ("single_pitch", r"(f_?p|f_?pt|f_?pn)\b"),
    ("cumulative_pitch", r"(F_?p|F_?pn)\b"),
    ("single_pitch", r"(einzelteilung|teilungs-?einzel|single pitch)"),
    ("cumulative_pitch", r"(teilungs-?summen|summenteilung|gesamtteilung|cumulative pitch|index)"),
    ("profile_slope", r"(f_?H(a|alpha|\u03b1)\b|profilwinkel|profile slope)"),
    ("profile_crowning", r"(C_?(a|alpha|\u03b1)\b|profilballigkeit|profile crown)"),
    ("tooth_thickness", r"(E_?sn?\b|zahndicken?abma|tooth thickness dev)"),
)
"""What a head means by how it begins; f_p and F_p differ by their case alone."""

HEAD_LIMIT = 200
"""Characters of a head that are looked at: each costs time as the square of them."""

SIGNED = ("single_pitch", "cumulative_pitch", "profile_slope", "profile_crowning")


def read_table(file: Path, layout: SheetMap, *, known: Mapping[str, float], count: Turn | None) -> MeasuredGear:
    """One gear from a table with a row per tooth, or per tooth and flank; ``known`` are keys of a pair file.

    Raises ``InputFileError`` with line and column for heads that nobody can tell, cells that are no numbers, and teeth
    that are missing or doubled.
    """
    rows = _rows(file, layout)
    head_line, heads = _head(file, rows, layout)
    meanings, factors, says = _meanings(file, head_line, heads, layout)
    decimal = layout.decimal or _decimal([cell for line, cells in rows if line > head_line for cell in cells])
    values: dict[tuple[str, Side], dict[int, float]] = {}
    places: dict[tuple[tuple[str, Side], int], int] = {}
    for line, cells in rows:
        if line <= head_line or not any(cells):
            continue
        if len(cells) != len(heads):
            wish = f"want {len(heads)}, as in line {head_line}; a map may state separator and decimal"
            raise InputFileError(file, where=f"line {line}", found=f"{len(cells)} cells", wish=wish)
        _row(file, line, cells, meanings, factors, decimal, values, places)
    teeth = sorted({n for column in values.values() for n in column})
    z = int(known.get("teeth", len(teeth)))
    first = layout.first_tooth if layout.first_tooth is not None else (teeth[0] if teeth else 1)
    if not teeth or first not in (0, 1) or teeth != list(range(first, first + z)) or not 5 <= z <= 10_000:
        each = f"of the {z} teeth" if teeth else "tooth that was measured, with its numbers"
        wish = f"want a row for each {each}, numbered from 0 or 1"
        raise InputFileError(file, found=f"rows of {len(teeth)} teeth" if teeth else "no rows of teeth", wish=wish)
    return _gear(file, values, z, first, known, says, count or layout.count)


def _rows(file: Path, layout: SheetMap) -> list[tuple[int, list[str]]]:
    """Lines of cells with their numbers, comment lines left out."""
    lines = any_text(file).splitlines()
    if long := next((k for k, line in enumerate(lines, start=1) if len(line) > LINE_LIMIT), None):
        found = f"{len(lines[long - 1])} characters"
        raise InputFileError(file, where=f"line {long}", found=found, wish=f"want lines of at most {LINE_LIMIT}")
    kept = [
        (k, line) for k, line in enumerate(lines, start=1) if line.strip() and not line.lstrip(' "').startswith("#")
    ]
    # The separator of a table stands equally often in most of its lines.
    separator: str | None = layout.separator
    if separator is None:
        counts = {one: Counter(line.count(one) for _, line in kept) for one in SEPARATORS}
        often = {one: max((n for times, n in found.items() if times), default=0) for one, found in counts.items()}
        separator = max(SEPARATORS, key=lambda one: (often[one] >= 0.5 * len(kept), -SEPARATORS.index(one)))
    return [
        (k, [cell.strip() for cell in next(csv.reader(io.StringIO(line), delimiter=separator), [])]) for k, line in kept
    ]


def _head(file: Path, rows: list[tuple[int, list[str]]], layout: SheetMap) -> tuple[int, list[str]]:
    """The line of column names: the first that the map names, or that has a column of teeth."""
    for line, cells in rows:
        if layout.columns and set(layout.columns) <= set(cells):
            return line, cells
        if not layout.columns and any(_meaning(cell)[0] == "tooth" for cell in cells) and len(cells) > 1:
            return line, cells
    wanted = f"with {', '.join(map(shown, layout.columns))}" if layout.columns else "with Zahn or tooth"
    wish = f'want a line of column names {wanted}; a file that --map names may say which: [columns] "NAME" = "tooth"'
    raise InputFileError(file, found="no line of column names", wish=wish)


def _meaning(head: str) -> tuple[str, Side | None]:
    """What a head holds ("" where it says nothing known), and of which side."""
    text = re.sub(r"[\[(].*?[\])]", " ", head[:HEAD_LIMIT]).strip(" .:")
    words = [word for word in re.split(r"[\s_./-]+", text) if word]
    side = next((SIDE[word.lower()] for word in words if word.lower() in SIDE), None)
    plain = " ".join(word for word in re.split(r"\s+", text) if word.lower().strip(".,") not in SIDE)
    plain = re.sub(r"_(left|right|links|rechts)$", "", plain, flags=re.IGNORECASE)
    for meaning, pattern in HEADS:
        cased = meaning in ("single_pitch", "cumulative_pitch") and "_?p" in pattern
        if re.match(pattern, plain, 0 if cased else re.IGNORECASE):
            return meaning, side
    return "", side


def _stated(column: str) -> tuple[str, Side | None]:
    """What a map says that a column holds, and of which side."""
    stem, _, tail = column.rpartition("_")
    return (stem, SIDE[tail]) if tail in SIDES else (column, None)


def _meanings(
    file: Path, line: int, heads: list[str], layout: SheetMap
) -> tuple[list[tuple[str, Side | None]], list[float], list[str]]:
    """What each column holds, its size in um, and what was taken without being stated."""
    meanings: list[tuple[str, Side | None]] = []
    factors, says = [], []
    named = {_stated(stated) for head, stated in layout.columns.items() if head in heads}
    for k, head in enumerate(heads, start=1):
        stated = layout.columns.get(head)
        if stated is not None:
            meaning, side = _stated(stated)
        else:
            meaning, side = _meaning(head)
            # A map speaks of the columns that it names; what it leaves out may go unread, but is not doubled.
            if layout.columns and (not meaning or (meaning, side) in named):
                meaning, side = "ignored", None
        if not meaning:
            wish = (
                f'say in a file that --map names what it holds: [columns] "{shown(head)}" = "ignored", or another word'
            )
            raise InputFileError(file, where=f"line {line}, column {k}", found=f'"{shown(head)}"', wish=wish)
        if (meaning, side) in meanings and meaning != "ignored":
            wish = 'want each once; state [columns] in a file that --map names, and "ignored" for the others'
            raise InputFileError(file, where=f"line {line}, column {k}", found=f'"{shown(head)}" again', wish=wish)
        unit = re.search(r"[\[(]\s*(.*?)\s*[\])]", head[:HEAD_LIMIT])
        known = {"um": 1.0, "µm": 1.0, "μm": 1.0, "mm": 1e3, "mum": 1.0}
        measured = meaning not in ("tooth", "flank", "ignored")
        if measured and unit is not None and unit[1] not in known:
            raise InputFileError(
                file, where=f"line {line}, column {k}", found=f'unit "{shown(unit[1])}"', wish="want um or mm"
            )
        if measured and unit is None:
            says.append(f'"{shown(head)}" states no unit and is taken in um')
        factors.append(known[unit[1]] if measured and unit is not None else 1.0)
        meanings.append((meaning, side))
    found = [meaning for meaning, _ in meanings]
    if "tooth" not in found:
        wish = '[columns] in the map wants "NAME" = "tooth"'
        raise InputFileError(file, where=f"line {line}", found="no column of teeth", wish=wish)
    sided = [side for meaning, side in meanings if meaning in SIGNED]
    if "flank" not in found and None in sided:
        head = next(
            head for head, (meaning, side) in zip(heads, meanings, strict=True) if meaning in SIGNED and not side
        )
        wish = "want left or right in its name, or a column of flanks; or say it in a file that --map names"
        raise InputFileError(file, where=f"line {line}", found=f'"{shown(head)}" of which flank', wish=wish)
    return meanings, factors, says


def _decimal(cells: list[str]) -> str:
    """The decimal mark of a table: a comma where numbers have one and no points."""
    numbers = [cell for cell in cells if re.fullmatch(r"[-+]?\d*[.,]\d+", cell)]
    return "," if numbers and all("," in cell for cell in numbers) else "."


def _row(
    file: Path,
    line: int,
    cells: list[str],
    meanings: list[tuple[str, Side | None]],
    factors: list[float],
    decimal: str,
    values: dict[tuple[str, Side], dict[int, float]],
    places: dict[tuple[tuple[str, Side], int], int],
) -> None:
    """Put the numbers of one row where they belong, and its line into ``places``."""
    named = {meaning: cell for cell, (meaning, _) in zip(cells, meanings, strict=True)}
    tooth = named["tooth"]
    if not (tooth.isascii() and tooth.isdigit() and len(tooth) < 7):
        raise InputFileError(file, where=f"line {line}", found=f'tooth "{shown(tooth)}"', wish="want a tooth number")
    row_side = None
    if "flank" in named:
        row_side = SIDE.get(named["flank"].lower())
        if row_side is None:
            found = f'flank "{shown(named["flank"])}"'
            raise InputFileError(file, where=f"line {line}", found=found, wish="want links or rechts, left or right")
    for k, (cell, (meaning, side), factor) in enumerate(zip(cells, meanings, factors, strict=True), start=1):
        if meaning in ("tooth", "flank", "ignored") or not cell:
            continue
        value = parse_number(cell.replace(",", ".") if decimal == "," else cell)
        if value is None or not abs(value * factor) <= DEVIATION_LIMIT_UM:
            wish = (
                f'want a number with decimal "{decimal}", at most {DEVIATION_LIMIT_UM:.0f} um; a map may state decimal'
            )
            raise InputFileError(file, where=f"line {line}, column {k}", found=f'"{shown(cell)}"', wish=wish)
        # Thickness is of the tooth, whichever flank's row it stands in.
        key: tuple[str, Side] = (meaning, "left" if meaning == "tooth_thickness" else side or row_side or "left")
        column = values.setdefault(key, {})
        if int(tooth) in column and not (meaning == "tooth_thickness" and column[int(tooth)] == value * factor):
            before = places[key, int(tooth)]
            found = f"tooth {tooth} again, after line {before}"
            raise InputFileError(file, where=f"line {line}", found=found, wish="want each flank once")
        column[int(tooth)], places[key, int(tooth)] = value * factor, line


def _gear(
    file: Path,
    values: dict[tuple[str, Side], dict[int, float]],
    z: int,
    first: int,
    known: Mapping[str, float],
    says: list[str],
    count: Turn | None,
) -> MeasuredGear:
    """The gear of the columns ``values``."""
    rows: dict[tuple[str, Side], tuple[float, ...]] = {}
    for (meaning, side), column in values.items():
        missing = next((n for n in range(first, first + z) if n not in column), None)
        if missing is not None:
            found = f"no {meaning.replace('_', ' ')} of tooth {missing}"
            raise InputFileError(file, found=found, wish=f"want all {z} teeth, or an empty column")
        rows[meaning, side] = tuple(column[n] for n in range(first, first + z))
    arcs: dict[Side, tuple[float, ...]] = {}
    for side in SIDES:
        single, sums = rows.get(("single_pitch", side)), rows.get(("cumulative_pitch", side))
        if sums is not None:
            arcs[side] = sums
            if single is not None:
                # A sheet prints 0.1 um; three roundings of half a digit differ by less than this.
                off = max(range(z), key=lambda n: abs(sums[n] - sums[n - 1] - single[n]))
                if not math.isclose(sums[off] - sums[off - 1], single[off], rel_tol=0.0, abs_tol=0.2):
                    found = (
                        f"f_p = {single[off]:g} of tooth {off + first}, and F_p steps by {sums[off] - sums[off - 1]:g}"
                    )
                    wish = "want F_p(n) - F_p(n-1) = f_p(n); if one is another quantity, call it ignored in a map"
                    raise InputFileError(file, found=found, wish=wish)
        elif single is not None:
            arcs[side] = closed(file, f"single pitch of the {side} flank", single, digit=0.1)
    shapes: dict[str, dict[Side, tuple[float, ...]]] = {}
    for key in ("profile_slope", "profile_crowning"):
        sides = {side: rows[key, side] for side in SIDES if (key, side) in rows}
        if sides:
            shapes[f"{key}_um"] = sides
    if arcs:
        says.append("f_p is taken as the pitch from tooth n - 1 to n, positive = too large; F_p as its running sum")
    return MeasuredGear(
        file=file,
        name=shown(file.stem, width=NAME_SHOWN),
        geometry={"teeth": float(z)} | {key: v for key, v in known.items() if key not in ("start_mm", "end_mm")},
        count=count,
        arcs=arcs,
        thickness=rows.get(("tooth_thickness", "left")),
        shapes=shapes,
        says=tuple(says),
    )
