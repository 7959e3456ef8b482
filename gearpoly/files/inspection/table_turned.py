"""Inspection tables with teeth in columns and a row for each quantity, as blocks with a row for each tooth."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.gde import Side
from gearpoly.files.inspection.sheet_map import SheetMap
from gearpoly.files.inspection.table_blocks import TeethRows, is_tooth, joined, side_by_map, tooth_of
from gearpoly.files.inspection.table_heads import length_of
from gearpoly.files.inspection.table_lines import Line
from gearpoly.files.inspection.table_titles import Title, title_of

FEWEST_TEETH_IN_ROW = 5
"""Teeth that follow one another in a row, from which it is one of teeth: the smallest gear has as many."""


def teeth_in_columns(rows: list[Line], layout: SheetMap, *, heads: bool) -> bool:
    """Whether teeth are in columns: a row of teeth stands there, named as such where there are ``heads`` too."""
    found = [(line, cells, run) for line, cells in rows if (run := _run(line, cells, layout)) is not None]
    if not heads:
        return bool(found)
    return any(is_tooth(cell, f"line {line}", layout) for line, cells, (first, _) in found for cell in cells[:first])


def blocks_beside_heads(
    file: Path, rows: list[Line], layout: SheetMap, says: list[str], *, blanks: bool
) -> list[TeethRows]:
    """The blocks of a table with teeth in columns: one for each row of teeth and each flank that titles name.
    ``blanks`` part the cells, so that a name of two words takes two.

    Raises ``InputFileError`` for rows that are shorter than that of the teeth.
    """
    out: list[TeethRows] = []
    above: list[Line] = []
    teeth: tuple[int, list[str], int, int] | None = None
    held: list[tuple[int, list[str]]] = []
    title, fresh = Title(), False
    stated: Side | None = None
    labels: list[str] = []

    def close() -> None:
        if teeth is not None and held:
            out.append(_turned(file, teeth, held, title, stated, (*above, teeth[:2])))
            above.clear()
        held.clear()

    last: int | None = None
    for line, cells in rows:
        run = _run(line, cells, layout, after=last)
        told, by_map = title_of(cells), side_by_map(layout, [(line, cells)])
        if run is not None:
            close()
            first, end = run
            last = tooth_of(cells[end - 1])
            goes_on = teeth is not None and tooth_of(cells[first]) not in (0, 1)
            if not goes_on and not fresh:  # nothing says that it is of the flank before
                title, stated = Title(), None
            stated = by_map or stated
            teeth, labels = (line, cells, first, end), []
            if len(cells) > end and any(cells[end:]):
                which = f"columns {end + 1} to {len(cells)}" if len(cells) > end + 1 else f"column {len(cells)}"
                says.append(f"line {line}: {which}, beside the teeth, not read")
        elif told is not None or (by_map is not None and not any(map(_number, cells))):
            close()
            title = Title(
                side=told.side if told is not None else None,
                meaning=told.meaning if told is not None and told.meaning else title.meaning,
            )
            stated, fresh = by_map, True
            above.append((line, cells))
        elif teeth is not None and any(map(_number, cells[teeth[2] :])):
            if blanks and teeth[2] == 1 and len(cells) > len(teeth[1]):
                words = len(cells) - len(teeth[1]) + 1
                cells = [joined(cells[:words]), *cells[words:]]
            mine = cells[: teeth[2]]
            # A name over several rows stands at the first of them.
            mine = [one or (labels[k] if labels and any(mine) else "") for k, one in enumerate(mine)]
            labels = mine
            held.append((line, [*mine, *cells[teeth[2] :]]))
            fresh = False
        else:
            above.append((line, cells))
    close()
    return out


def _number(cell: str) -> bool:
    return any(letter.isdigit() for letter in cell)


def _run(line: int, cells: Sequence[str], layout: SheetMap, *, after: int | None = None) -> tuple[int, int] | None:
    """The columns (from, to) of teeth in a row of them: numbers that follow one another, from 0 or 1, or from the one
    ``after`` which they go on, behind one head at least; ``None`` where it is no such row."""
    first = next((k for k, cell in enumerate(cells) if _number(cell)), 0)
    if first == 0:
        return None
    numbers = [tooth_of(cell) for cell in cells[first:]]
    start = numbers[0]
    if start is None:
        return None
    end = next((k for k, n in enumerate(numbers) if n != start + k), len(numbers))
    if end < len(numbers) and end >= FEWEST_TEETH_IN_ROW and numbers[end] == start:
        end += 1  # the first tooth once more, where the measurement closes
    if any(_number(cell) for cell in cells[first + end :]):
        return None
    goes_on = after is not None and start == after + 1
    named = any(is_tooth(cell, f"line {line}", layout) for cell in cells[:first])
    if (start in (0, 1) and end >= FEWEST_TEETH_IN_ROW) or (goes_on and (named or end >= FEWEST_TEETH_IN_ROW)):
        return first, first + end
    return None


def _turned(
    file: Path,
    teeth: tuple[int, list[str], int, int],
    held: Sequence[tuple[int, list[str]]],
    title: Title,
    stated: Side | None,
    above: tuple[Line, ...],
) -> TeethRows:
    line, row, first, end = teeth
    names, units, lines = [joined(row[:first])], [""], [line]
    for k, cells in held:
        if len(cells) < end:
            wish = f"want {end}, as in line {line}; a map may state separator and decimal"
            raise InputFileError(file, where=f"line {k}", found=f"{len(cells)} cells", wish=wish)
        unit = [cell.strip("[]() ") for cell in cells[:first] if length_of(cell.strip("[]() ")) is not None]
        names.append(joined([cell for cell in cells[:first] if length_of(cell.strip("[]() ")) is None]))
        units.append(unit[0] if unit else "")
        lines.append(k)
    columns = [row[first:end], *(cells[first:end] for _, cells in held)]
    return TeethRows(
        names=names,
        units=units,
        rows=[list(one) for one in zip(*columns, strict=True)],
        lines=lines,
        head=line,
        first=first,
        side=stated or title.side,
        meaning=title.meaning,
        above=above,
        turned=True,
    )
