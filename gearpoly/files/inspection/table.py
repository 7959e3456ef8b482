"""An inspection sheet as a table of any layout: found by its heads in German or English, or read as a map says."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from gearpoly.errors import InputFileError, shown
from gearpoly.files.gde import Side, Turn
from gearpoly.files.inspection.measured import SIDES, MeasuredGear, closed
from gearpoly.files.inspection.sheet_map import SheetMap
from gearpoly.files.inspection.table_blocks import TeethRows, blocks_below_heads, called, joined, no_heads, tooth_of
from gearpoly.files.inspection.table_columns import Heads, heads_of
from gearpoly.files.inspection.table_heads import FLANK_WORDS
from gearpoly.files.inspection.table_lines import lines_of
from gearpoly.files.inspection.table_turned import blocks_beside_heads, teeth_in_columns
from gearpoly.files.traces import DEVIATION_LIMIT_UM, parse_number
from gearpoly.keys.kinds import NAME_SHOWN

LEAST_UM = 0.1
"""Deviations that all are smaller than this are of no gear: machines print 0.1 um. Without a unit they are mm."""

LARGEST_MODULES, LARGEST_UM = 0.1, 100.0
"""Single pitch deviation, as part of the module and in um, from which it is in another unit: that of class 12 of
ISO 1328-1 is 0.03 modules at module 2, and 60 um at small modules."""


def read_table(file: Path, layout: SheetMap, *, known: Mapping[str, float], count: Turn | None) -> MeasuredGear:
    """One gear from a table of blocks; ``known`` are keys of a pair file.

    Raises ``InputFileError`` with line and column for heads that nobody can tell, cells that are no numbers, and teeth
    that are missing or doubled.
    """
    says: list[str] = []
    blocks = blocks_of(file, layout, says)
    heads = [columns_of(file, one, blocks, layout) for one in blocks]
    says += [word for one in heads for word in one.says if word not in says]
    decimal = layout.decimal or decimal_of(blocks)
    values: dict[tuple[str, Side], dict[int, float]] = {}
    places: dict[tuple[tuple[str, Side], int], int] = {}
    for block, its in zip(blocks, heads, strict=True):
        for k in range(len(block.rows)):
            _row(file, block, k, its, decimal, values, places)
    teeth = sorted({n for column in values.values() for n in column})
    z = int(known.get("teeth", len(teeth)))
    if teeth == list(range(z + 1)) and all(column.get(0) == column.get(z) for column in values.values()):
        teeth = teeth[1:]  # the first tooth once more, where the measurement closes
    _check_sizes(file, values, list(dict.fromkeys(head for one in heads for head in one.unstated)), says, known)
    first = layout.first_tooth if layout.first_tooth is not None else (teeth[0] if teeth else 1)
    if not teeth or first not in (0, 1) or teeth != list(range(first, first + z)) or not 5 <= z <= 10_000:
        each = f"of the {z} teeth" if teeth else "tooth that was measured, with its numbers"
        turned = any(one.turned for one in blocks)
        wish = f"want a {'column' if turned else 'row'} for each {each}, numbered from 0 or 1"
        rows = "columns" if turned else "rows"
        raise InputFileError(file, found=f"{rows} of {len(teeth)} teeth" if teeth else f"no {rows} of teeth", wish=wish)
    digit = max(
        (
            factor * 10.0 ** -_decimals(block, k, decimal)
            for block, its in zip(blocks, heads, strict=True)
            for k, factor in enumerate(its.factors)
            if its.meanings[k][0] not in ("tooth", "flank", "ignored")
        ),
        default=0.1,
    )
    return _gear(file, values, z, first, known, says, count or layout.count, digit=digit)


def blocks_of(file: Path, layout: SheetMap, says: list[str]) -> list[TeethRows]:
    """The blocks of a table, whichever way its teeth run; what is not read is added to ``says``.

    Raises ``InputFileError`` where no line names columns or rows, and where the map names a head or a block that is not
    there.
    """
    rows, separator = lines_of(file, layout)
    heard: list[str] = []
    fault: InputFileError | None = None
    blocks: list[TeethRows] = []
    try:
        blocks = blocks_below_heads(file, rows, layout, heard)
    except InputFileError as error:
        fault = error
    if teeth_in_columns(rows, layout, heads=fault is None):
        heard = []
        blocks = blocks_beside_heads(file, rows, layout, heard, blanks=not separator)
    elif fault is not None:
        raise fault
    says += heard
    there = {name for one in blocks for name in one.names}
    if missing := next((name for name in called(layout) if name not in there), None):
        raise (
            no_heads(file, layout)
            if len(blocks) == 1
            else InputFileError(
                file, found=f'no head "{shown(missing)}"', wish=f"want one of {', '.join(map(shown, sorted(there)))}"
            )
        )
    lines = {name for one in blocks for line, cells in one.above for name in (f"line {line}", joined(cells))}
    if missing := next((name for name in layout.blocks if name not in lines), None):
        near = [f"line {one.head}" for one in blocks]
        wish = f"want the title of a block, or its line of heads: {', '.join(dict.fromkeys(near))}"
        raise InputFileError(file, where="blocks in the map", found=f'"{shown(missing)}"', wish=wish)
    return blocks


def columns_of(file: Path, block: TeethRows, blocks: Sequence[TeethRows], layout: SheetMap) -> Heads:
    """What the columns of one of the ``blocks`` hold. Raises ``InputFileError`` where nobody can tell."""
    beside = any(one.head == block.head and one.first != block.first for one in blocks)
    return heads_of(file, block, layout, several=len(blocks) > 1, beside=beside)


def _decimals(block: TeethRows, k: int, decimal: str) -> int:
    """Decimals that column ``k`` is printed with; a power of ten counts."""
    most = 0
    for cells in block.rows:
        number, _, power = cells[k].lower().partition("e")
        few = len(number.partition(decimal)[2])
        most = max(most, few - int(power) if re.fullmatch(r"[+-]?\d{1,2}", power) else few)
    return most


def _check_sizes(
    file: Path,
    values: Mapping[tuple[str, Side], Mapping[int, float]],
    unstated: Sequence[str],
    says: list[str],
    known: Mapping[str, float],
) -> None:
    """Raise ``InputFileError`` where deviations are too small or too large to be in the unit that they are taken in."""
    sizes = [abs(value) for column in values.values() for value in column.values()]
    if unstated and 0.0 < max(sizes, default=0.0) < LEAST_UM:
        found = f'"{shown(unstated[0])}" states no unit, and no deviation is above {max(sizes):.3g}'
        wish = 'want unit = "mm" (or um, in, mil) in a file that --map names'
        raise InputFileError(file, found=found, wish=wish)
    says.extend(f'"{shown(head)}" states no unit and is taken in um' for head in unstated)
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


def decimal_of(blocks: Sequence[TeethRows]) -> str:
    """The decimal mark of a table: a comma where numbers have one and no points."""
    cells = [cell for block in blocks for row in block.rows for cell in row]
    numbers = [cell for cell in cells if re.fullmatch(r"[-+]?\d*[.,]\d+(?:[eE][-+]?\d+)?", cell)]
    return "," if numbers and all("," in cell for cell in numbers) else "."


def _row(
    file: Path,
    block: TeethRows,
    at: int,
    heads: Heads,
    decimal: str,
    values: dict[tuple[str, Side], dict[int, float]],
    places: dict[tuple[tuple[str, Side], int], int],
) -> None:
    """Put the numbers of one row where they belong, and its line into ``places``."""
    cells, meanings = block.rows[at], heads.meanings
    named = {meaning: k for k, (meaning, _) in enumerate(meanings)}
    teeth = cells[named["tooth"]]
    tooth = tooth_of(teeth)
    if tooth is None:
        line, _ = block.place(at, named["tooth"])
        wish = "want the number of a tooth, or 6-7 for the pitch from tooth 6 to 7"
        if not any(re.search(r"\d", cell) for cell in cells):
            wish += f'; where a block of the other flank begins here: [blocks] "line {line}" = "right" in a map'
        raise InputFileError(file, where=f"line {line}", found=f'tooth "{shown(teeth)}"', wish=wish)
    row_side = None
    if "flank" in named:
        word = cells[named["flank"]]
        row_side = FLANK_WORDS.get(word.lower().split(" ")[0])
        if row_side is None:
            line, _ = block.place(at, named["flank"])
            wish = "want links or rechts, left or right"
            raise InputFileError(file, where=f"line {line}", found=f'flank "{shown(word)}"', wish=wish)
    for k, (cell, (meaning, side), factor) in enumerate(zip(cells, meanings, heads.factors, strict=True)):
        if meaning in ("tooth", "flank", "ignored") or not cell:
            continue
        line, column = block.place(at, k)
        value = parse_number(cell.replace(",", ".") if decimal == "," else cell)
        if value is None or not abs(value * factor) <= DEVIATION_LIMIT_UM:
            wish = (
                f'want a number with decimal "{decimal}", at most {DEVIATION_LIMIT_UM:.0f} um; a map may state decimal'
            )
            raise InputFileError(file, where=f"line {line}, column {column}", found=f'"{shown(cell)}"', wish=wish)
        # Thickness is of the tooth, whichever flank's row it stands in.
        key: tuple[str, Side] = (meaning, "left" if meaning == "tooth_thickness" else side or row_side or "left")
        held = values.setdefault(key, {})
        if held.get(tooth, value * factor) != value * factor:  # once more as it was: where the measurement closes
            before = places[key, tooth]
            found = f"tooth {tooth} again, after line {before}"
            wish = f'want each flank once; a map says of which one a block is: [blocks] "line {block.head}" = "right"'
            raise InputFileError(file, where=f"line {line}", found=found, wish=wish)
        held[tooth], places[key, tooth] = value * factor, line


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
