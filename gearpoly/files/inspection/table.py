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
from gearpoly.files.inspection.measured import SIDES, MeasuredGear, closed
from gearpoly.files.inspection.sheet_map import SheetMap
from gearpoly.files.inspection.table_heads import FLANKS, SIGNED, Heads, heads_of, length_of, meaning_of
from gearpoly.files.inspection.text import any_text
from gearpoly.files.traces import DEVIATION_LIMIT_UM, LINE_LIMIT, parse_number
from gearpoly.keys.kinds import NAME_SHOWN

SEPARATORS = (";", "\t", "|", ",")

LEAST_UM = 0.1
"""Deviations that all are smaller than this are of no gear: machines print 0.1 um. Without a unit they are mm."""

LARGEST_MODULES, LARGEST_UM = 0.1, 100.0
"""Single pitch deviation, as part of the module and in um, from which it is in another unit: that of class 12 of
ISO 1328-1 is 0.03 modules at module 2, and 60 um at small modules."""

_TOOTH = re.compile(r"(?:[A-Za-z]{1,6}[.:]?\s*)?(\d{1,6})(?:\.0+)?")
_BETWEEN = re.compile(r"(\d{1,6})\s*[-/\u2013]\s*(\d{1,6})")


def read_table(file: Path, layout: SheetMap, *, known: Mapping[str, float], count: Turn | None) -> MeasuredGear:
    """One gear from a table with a row per tooth, or per tooth and flank; ``known`` are keys of a pair file.

    Raises ``InputFileError`` with line and column for heads that nobody can tell, cells that are no numbers, and teeth
    that are missing or doubled.
    """
    rows = _rows(file, layout)
    head_line, names = _head(file, rows, layout)
    below = [(line, cells) for line, cells in rows if line > head_line and any(cells)]
    units = [""] * len(names)
    if below and len(names) - 1 <= len(below[0][1]) <= len(names) and _are_units(below[0][1]):
        units = [cell.strip("[]() ") for cell in below.pop(0)[1]]
        units = [""] * (len(names) - len(units)) + units  # blanks part the cells, and teeth have no unit
    heads = heads_of(file, head_line, names, units, layout)
    meanings, factors, says = heads.meanings, heads.factors, heads.says
    below = _above_footer(below, [meaning for meaning, _ in meanings].index("tooth"), says)
    decimal = layout.decimal or _decimal([cell for _, cells in below for cell in cells])
    values: dict[tuple[str, Side], dict[int, float]] = {}
    places: dict[tuple[tuple[str, Side], int], int] = {}
    for line, cells in below:
        if len(cells) != len(names):
            wish = f"want {len(names)}, as in line {head_line}; a map may state separator and decimal"
            raise InputFileError(file, where=f"line {line}", found=f"{len(cells)} cells", wish=wish)
        _row(file, line, cells, meanings, factors, decimal, values, places)
    teeth = sorted({n for column in values.values() for n in column})
    z = int(known.get("teeth", len(teeth)))
    if teeth == list(range(z + 1)) and all(column.get(0) == column.get(z) for column in values.values()):
        teeth = teeth[1:]  # the first tooth once more, where the measurement closes
    _check_sizes(file, values, heads, known)
    first = layout.first_tooth if layout.first_tooth is not None else (teeth[0] if teeth else 1)
    if not teeth or first not in (0, 1) or teeth != list(range(first, first + z)) or not 5 <= z <= 10_000:
        each = f"of the {z} teeth" if teeth else "tooth that was measured, with its numbers"
        wish = f"want a row for each {each}, numbered from 0 or 1"
        raise InputFileError(file, found=f"rows of {len(teeth)} teeth" if teeth else "no rows of teeth", wish=wish)
    digit = max(
        (f * 10.0 ** -_decimals(below, k, decimal) for k, f in enumerate(factors) if _measured(meanings[k])),
        default=0.1,
    )
    return _gear(file, values, z, first, known, says, count or layout.count, digit=digit)


def _measured(meaning: tuple[str, Side | None]) -> bool:
    return meaning[0] not in ("tooth", "flank", "ignored")


def _decimals(rows: list[tuple[int, list[str]]], k: int, decimal: str) -> int:
    """Decimals that column ``k`` is printed with; a power of ten counts."""
    most = 0
    for _, cells in rows:
        number, _, power = cells[k].lower().partition("e")
        few = len(number.partition(decimal)[2])
        most = max(most, few - int(power) if re.fullmatch(r"[+-]?\d{1,2}", power) else few)
    return most


def _are_units(cells: list[str]) -> bool:
    """Whether a row below the heads holds units, and nothing else."""
    held = [cell.strip("[]() ") for cell in cells if cell.strip("[]() -")]
    return bool(held) and not any(_TOOTH.fullmatch(cell) for cell in held) and all(map(length_of, held))


def _above_footer(rows: list[tuple[int, list[str]]], tooth: int, says: list[str]) -> list[tuple[int, list[str]]]:
    """The rows without those of extremes and means below the last tooth, whose place for a tooth holds no digit."""
    last = len(rows)
    while last and not re.search(r"\d", rows[last - 1][1][tooth] if tooth < len(rows[last - 1][1]) else ""):
        last -= 1
    if last in (0, len(rows)):
        return rows
    lines = f"line {rows[last][0]}" if last == len(rows) - 1 else f"lines {rows[last][0]} to {rows[-1][0]}"
    says.append(f"{lines} below the teeth not read")
    return rows[:last]


def _check_sizes(
    file: Path, values: Mapping[tuple[str, Side], Mapping[int, float]], heads: Heads, known: Mapping[str, float]
) -> None:
    """Raise ``InputFileError`` where deviations are too small or too large to be in the unit that they are taken in."""
    sizes = [abs(value) for column in values.values() for value in column.values()]
    if heads.unstated and 0.0 < max(sizes, default=0.0) < LEAST_UM:
        found = f'"{shown(heads.unstated[0])}" states no unit, and no deviation is above {max(sizes):.3g}'
        wish = 'want unit = "mm" (or um, in, mil) in a file that --map names'
        raise InputFileError(file, found=found, wish=wish)
    heads.says.extend(f'"{shown(head)}" states no unit and is taken in um' for head in heads.unstated)
    module = known.get("module_mm")
    pitches = [abs(v) for (meaning, _), column in values.items() if meaning == "single_pitch" for v in column.values()]
    for (meaning, _), column in values.items():
        if meaning == "cumulative_pitch":
            pitches += [abs(value - column.get(n - 1, value)) for n, value in column.items()]
    if module is not None and pitches and max(pitches) > max(1e3 * LARGEST_MODULES * module, LARGEST_UM):
        found = f"a single pitch deviation of {max(pitches):.4g} um at module {module:g} mm"
        wish = (
            'want the unit that the numbers have: in brackets in the heads, or unit = "um" in a file that --map names'
        )
        raise InputFileError(file, found=found, wish=wish)


def _rows(file: Path, layout: SheetMap) -> list[tuple[int, list[str]]]:
    """Lines of cells with their numbers, comment lines left out."""
    lines = any_text(file).replace("\u2212", "-").splitlines()
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
        if 2 * often[separator] < len(kept):  # most lines have none of them
            width = Counter(len(line.split()) for _, line in kept).most_common(1)[0][0] if kept else 0
            wider = [(k, line.split(), re.split(r"\s{2,}|\t", line.strip())) for k, line in kept]  # names hold blanks
            return [(k, far if len(far) == width != len(cells) else cells) for k, cells, far in wider]
    return _inside(
        [
            (k, [cell.strip() for cell in next(csv.reader(io.StringIO(line), delimiter=separator), [])])
            for k, line in kept
        ],
        bars=separator == "|",
    )


def _inside(rows: list[tuple[int, list[str]]], *, bars: bool) -> list[tuple[int, list[str]]]:
    """The rows without what nothing stands in: behind the last separator of each, and before the first one of ``bars``
    that are drawn about a table; nor rules that are drawn below heads."""
    if bars:
        rows = [(k, cells) for k, cells in rows if "".join(cells).strip("-:= ")]
    width = Counter(len(cells) for _, cells in rows).most_common(1)[0][0] if rows else 0
    wide = [cells for _, cells in rows if len(cells) == width]
    last = width - 1 if width > 2 and not any(cells[-1] for cells in wide) else width
    first = 1 if bars and width > 2 and not any(cells[0] for cells in wide) else 0
    return [(k, cells[first:last] if len(cells) == width else cells) for k, cells in rows]


def _head(file: Path, rows: list[tuple[int, list[str]]], layout: SheetMap) -> tuple[int, list[str]]:
    """The line of column names: the first that the map names, or that has a column of teeth. A map that calls columns
    by their numbers alone needs none."""
    called = {name for name in layout.columns if not re.fullmatch(r"column \d+", name)}
    for line, cells in rows:
        if called and called <= set(cells):
            return line, cells
        if not called and any(meaning_of(cell)[0] == "tooth" for cell in cells) and len(cells) > 1:
            return _merged(rows, line, cells)
    if layout.columns and not called:
        wide = max(int(name.removeprefix("column ")) for name in layout.columns)
        first = next((k for k, (_, cells) in enumerate(rows) if len(cells) >= wide and _numbered(cells, layout)), 0)
        if first or (rows and _numbered(rows[0][1], layout)):
            return rows[first][0] - 1, [f"column {k}" for k in range(1, len(rows[first][1]) + 1)]
    wanted = f"with {', '.join(map(shown, layout.columns))}" if layout.columns else "with Zahn or tooth"
    wish = (
        f'want a line of column names {wanted}; a file that --map names may say which: [columns] "NAME" = "tooth", or '
        '"column 1" = "tooth"'
    )
    raise InputFileError(file, found="no line of column names", wish=wish)


def _merged(rows: list[tuple[int, list[str]]], line: int, heads: list[str]) -> tuple[int, list[str]]:
    """Heads in two lines, of which the first has names over several columns (``Left,,Right,``), as one; the heads as
    they are where the next line is none of names."""
    below = next(((k, cells) for k, cells in rows if k > line), None)
    if below is None or len(below[1]) != len(heads) or _are_units(below[1]) or re.search(r"\d", "".join(below[1])):
        return line, heads
    if all(meaning_of(cell)[0] not in SIGNED for cell in below[1]):
        return line, heads
    over = list(heads)
    for k in range(1, len(over)):
        over[k] = over[k] or over[k - 1]
    return below[0], [f"{one} {cell}".strip() for one, cell in zip(over, below[1], strict=True)]


def _numbered(cells: list[str], layout: SheetMap) -> bool:
    """Whether a row has a number in every column that a map calls by its number."""
    taken = [
        int(name.removeprefix("column ")) for name, held in layout.columns.items() if held not in ("ignored", "flank")
    ]
    return all(k <= len(cells) and re.search(r"\d", cells[k - 1]) for k in taken)


def _tooth(cell: str) -> int | None:
    """The number of a tooth: 7, T7, 7.0, or 6-7 for the pitch from tooth 6 to tooth 7; ``None`` where there is none."""
    if found := _TOOTH.fullmatch(cell):
        return int(found[1])
    between = _BETWEEN.fullmatch(cell)
    if between is None:
        return None
    first, second = int(between[1]), int(between[2])
    # The last pitch leads back to the first tooth.
    return second if second == first + 1 or (second in (0, 1) and first > 2) else None


def _decimal(cells: list[str]) -> str:
    """The decimal mark of a table: a comma where numbers have one and no points."""
    numbers = [cell for cell in cells if re.fullmatch(r"[-+]?\d*[.,]\d+(?:[eE][-+]?\d+)?", cell)]
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
    tooth = _tooth(named["tooth"])
    if tooth is None:
        wish = "want the number of a tooth, or 6-7 for the pitch from tooth 6 to 7"
        raise InputFileError(file, where=f"line {line}", found=f'tooth "{shown(named["tooth"])}"', wish=wish)
    row_side = None
    if "flank" in named:
        row_side = FLANKS.get(named["flank"].lower().split(" ")[0])
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
        if column.get(tooth, value * factor) != value * factor:  # once more as it was: where the measurement closes
            before = places[key, tooth]
            found = f"tooth {tooth} again, after line {before}"
            raise InputFileError(file, where=f"line {line}", found=found, wish="want each flank once")
        column[tooth], places[key, tooth] = value * factor, line


def _gear(
    file: Path,
    values: dict[tuple[str, Side], dict[int, float]],
    z: int,
    first: int,
    known: Mapping[str, float],
    says: list[str],
    count: Turn | None,
    *,
    digit: float,
) -> MeasuredGear:
    """The gear of the columns ``values``, which are printed in steps of ``digit`` um."""
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
                # Three roundings of half a digit differ by less than two of them.
                off = max(range(z), key=lambda n: abs(sums[n] - sums[n - 1] - single[n]))
                if not math.isclose(sums[off] - sums[off - 1], single[off], rel_tol=0.0, abs_tol=2.0 * max(digit, 0.1)):
                    found = (
                        f"f_p = {single[off]:g} of tooth {off + first}, and F_p steps by {sums[off] - sums[off - 1]:g}"
                    )
                    wish = "want F_p(n) - F_p(n-1) = f_p(n); if one is another quantity, call it ignored in a map"
                    raise InputFileError(file, found=found, wish=wish)
        elif single is not None:
            arcs[side] = closed(file, f"single pitch of the {side} flank", single, digit=max(digit, 0.1))
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
