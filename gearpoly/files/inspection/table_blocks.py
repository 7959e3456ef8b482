"""The blocks of an inspection table: its heads, and the rows of teeth below them, one under another or side by side."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from gearpoly.errors import InputFileError, shown
from gearpoly.files.gde import Side
from gearpoly.files.inspection.klingelnberg_text import SIDE_WORDS
from gearpoly.files.inspection.sheet_map import SheetMap
from gearpoly.files.inspection.table_heads import SIGNED, length_of, meaning_of
from gearpoly.files.inspection.table_lines import Line
from gearpoly.files.inspection.table_titles import Title, title_of, together
from gearpoly.files.traces import parse_number

_TOOTH = re.compile(r"(?:[A-Za-z]{1,6}[.:]?\s*)?(\d{1,6})(?:\.0+)?")
_BETWEEN = re.compile(r"(\d{1,6})\s*[-/\u2013]\s*(\d{1,6})")
_NUMBERED = re.compile(r"(column|line) \d{1,6}")


@dataclass(frozen=True, kw_only=True)
class TeethRows:
    """Rows of teeth below one line of heads: ``names`` and ``units`` (n,) by column, ``rows`` of n cells, and the line
    of each. ``side`` and ``meaning`` are what the titles above say, ``None`` and "" where they do not. ``head`` is the
    line of the heads, ``first`` the columns left of the block, ``above`` the lines that may name it in a map.

    Where teeth are in columns (``turned``), ``lines`` are those of the heads, and ``first`` the columns of heads.
    """

    names: list[str]
    units: list[str]
    rows: list[list[str]]
    lines: list[int]
    head: int
    first: int = 0
    side: Side | None = None
    meaning: str = ""
    above: tuple[Line, ...] = ()
    turned: bool = False

    def place(self, row: int, column: int) -> tuple[int, int]:
        """Line and column in the file, from 1."""
        if self.turned:
            return self.lines[column], self.first + row + 1
        return self.lines[row], self.first + column + 1

    def head_place(self, column: int) -> str:
        """Where a head stands, in words."""
        if self.turned:
            return f"line {self.lines[column]}"
        return f"line {self.head}, column {self.first + column + 1}"

    def number(self, column: int) -> str:
        """How a map names that head by its number."""
        return f"line {self.lines[column]}" if self.turned else f"column {self.first + column + 1}"

    @property
    def tooth(self) -> int | None:
        """The first tooth of the block, where its first column is of teeth."""
        return tooth_of(self.rows[0][0]) if self.rows else None


def tooth_of(cell: str) -> int | None:
    """The number of a tooth: 7, T7, 7.0, or 6-7 for the pitch from tooth 6 to tooth 7; ``None`` where there is none."""
    if found := _TOOTH.fullmatch(cell):
        return int(found[1])
    between = _BETWEEN.fullmatch(cell)
    if between is None:
        return None
    first, second = int(between[1]), int(between[2])
    # The last pitch leads back to the first tooth.
    return second if second == first + 1 or (second in (0, 1) and first > 2) else None


def is_tooth(name: str, number: str, layout: SheetMap) -> bool:
    """Whether a head is that of teeth, by the map or by itself."""
    given = layout.columns.get(number, layout.columns.get(name))
    return given == "tooth" if given is not None else meaning_of(name)[0] == "tooth"


def called(layout: SheetMap) -> set[str]:
    """The heads that a map calls by their names."""
    return {name for name in layout.columns if not _NUMBERED.fullmatch(name)}


def side_by_map(layout: SheetMap, above: Sequence[Line]) -> Side | None:
    """The flank that a map states for a block with these lines above it."""
    for line, cells in reversed(above):
        stated = layout.blocks.get(f"line {line}", layout.blocks.get(joined(cells)))
        if stated is not None:
            return SIDE_WORDS[stated]
    return None


def joined(cells: Sequence[str]) -> str:
    """A line as a map names it."""
    return " ".join(cell for cell in cells if cell)


def are_units(cells: Sequence[str]) -> bool:
    """Whether a row below the heads holds units, and nothing else."""
    held = [cell.strip("[]() ") for cell in cells if cell.strip("[]() -")]
    return bool(held) and not any(_TOOTH.fullmatch(cell) for cell in held) and all(map(length_of, held))


def blocks_below_heads(file: Path, rows: list[Line], layout: SheetMap, says: list[str]) -> list[TeethRows]:
    """The blocks of a table with a row for each tooth, or each tooth and flank.

    Raises ``InputFileError`` where there is no line of heads, and for rows of another number of cells.
    """
    heads = _heads(file, rows, layout)
    out: list[TeethRows] = []
    ends = [at for at, _, _ in heads[1:]] + [len(rows)]
    above: list[Line] = rows[: heads[0][0]]
    for (at, taken, names), end in zip(heads, ends, strict=True):
        head, below = rows[at][0] - (not taken), rows[at + taken : end]
        units = [""] * len(names)
        if below and len(names) - 1 <= len(below[0][1]) <= len(names) and are_units(below[0][1]):
            units = [cell.strip("[]() ") for cell in below[0][1]]
            units = [""] * (len(names) - len(units)) + units  # blanks part the cells, and teeth have no unit
            below = below[1:]
        starts = [k for k, name in enumerate(names) if is_tooth(name, f"column {k + 1}", layout)] or [0]
        below, left = _above_footer(below, starts[0], layout, last=end == len(rows), says=says)
        mine = [(head, names)] if taken else []
        for titles, part in _parted([*above, *mine], below, starts[0], layout):
            for line, cells in part:
                if len(cells) != len(names):
                    wish = f"want {len(names)}, as in line {head}; a map may state separator and decimal"
                    if not any(re.search(r"\d", cell) for cell in cells):
                        wish += f'; or [blocks] "line {line}" = "left", or right, where the block of a flank begins'
                    raise InputFileError(file, where=f"line {line}", found=f"{len(cells)} cells", wish=wish)
            lines, cells_ = [line for line, _ in part], [cells for _, cells in part]
            whole = TeethRows(
                names=names, units=units, rows=cells_, lines=lines, head=head, above=(*titles, *part[:1])
            )  # fmt: skip
            out += [_titled(one, out, layout, alone=len(starts) == 1) for one in _beside(whole, starts)]
        above = left
    return out


def _heads(file: Path, rows: list[Line], layout: SheetMap) -> list[tuple[int, int, list[str]]]:
    """Index, number of lines and names of each line of heads: those that the map names, or that have a column of teeth.
    A map that calls columns by their numbers alone needs none."""
    names = called(layout)
    whole = any(_is_called(names, cells) for _, cells in rows)
    out: list[tuple[int, int, list[str]]] = []
    over = -1
    for k, (_, cells) in enumerate(rows):
        if k == over or len(cells) < 2:
            continue
        teeth = any(is_tooth(cell, "", layout) for cell in cells)
        if (
            (names <= set(cells) and 2 * sum(map(_is_head, cells)) > len(cells))
            if whole
            else (teeth and all(map(_is_head, cells)))
        ):
            merged = _merged(rows, k, cells) if not names else None
            over = k + 1 if merged is not None else -1
            out.append((k, 1 if merged is None else 2, cells if merged is None else merged))
    if out:
        return out
    numbers = [int(name.removeprefix("column ")) for name in layout.columns if name.startswith("column ")]
    if numbers and not names:
        full = (k for k, (_, cells) in enumerate(rows) if len(cells) >= max(numbers) and _numbered(cells, layout))
        if (first := next(full, None)) is not None:
            return [(first, 0, [f"column {k}" for k in range(1, len(rows[first][1]) + 1)])]
    raise no_heads(file, layout)


def no_heads(file: Path, layout: SheetMap) -> InputFileError:
    """The error for a table in which no line names its columns, or none as the map does."""
    wanted = f"with {', '.join(map(shown, layout.columns))}" if layout.columns else "with Zahn or tooth"
    wish = (
        f'want a line of column names {wanted}; a file that --map names may say which: [columns] "NAME" = "tooth", or '
        '"column 1" = "tooth"'
    )
    return InputFileError(file, found="no line of column names", wish=wish)


def _is_called(names: set[str], cells: list[str]) -> bool:
    """Whether a line has all ``names`` that a map calls. A row of numbers behind a name is of teeth in columns."""
    return bool(names) and names <= set(cells) and 2 * sum(map(_is_head, cells)) > len(cells)


def _is_head(cell: str) -> bool:
    return parse_number(cell.replace(",", ".")) is None


def _merged(rows: list[Line], at: int, heads: list[str]) -> list[str] | None:
    """Heads in two lines, of which the first has names over several columns (``Left,,Right,``), as one; ``None`` where
    the next line is none of names."""
    below = rows[at + 1][1] if at + 1 < len(rows) else []
    if len(below) != len(heads) or are_units(below) or re.search(r"\d", "".join(below)):
        return None
    if all(meaning_of(cell)[0] not in SIGNED for cell in below):
        return None
    over = list(heads)
    for k in range(1, len(over)):
        over[k] = over[k] or over[k - 1]
    return [f"{one} {cell}".strip() for one, cell in zip(over, below, strict=True)]


def _numbered(cells: list[str], layout: SheetMap) -> bool:
    """Whether a row has a number in every column that a map calls by its number."""
    taken = [
        int(name.removeprefix("column "))
        for name, held in layout.columns.items()
        if name.startswith("column ") and held not in ("ignored", "flank")
    ]
    return all(k <= len(cells) and re.search(r"\d", cells[k - 1]) for k in taken)


def _above_footer(
    rows: list[Line], tooth: int, layout: SheetMap, *, last: bool, says: list[str]
) -> tuple[list[Line], list[Line]]:
    """The rows without those below the last tooth: of extremes and means, whose place for a tooth holds no digit, and
    between two blocks whatever is no row of a tooth. And those that are left out."""

    def counts(cells: list[str]) -> bool:
        place = cells[tooth] if tooth < len(cells) else ""
        if last:
            return bool(re.search(r"\d", place))
        others = [cell for k, cell in enumerate(cells) if k != tooth]
        return tooth_of(place) is not None and any(re.search(r"\d", cell) for cell in others)

    end = len(rows)
    while end and not counts(rows[end - 1][1]):
        end -= 1
    if end in (0, len(rows)):
        return rows, []
    rest = rows[end:]
    told = [one[0] for one in rest if title_of(one[1]) is None and side_by_map(layout, [one]) is None]
    if told and (last or len(told) == len(rest)):
        lines = f"line {told[0]}" if len(told) == 1 else f"lines {told[0]} to {told[-1]}"
        says.append(f"{lines} below the teeth not read")
    return rows[:end], rest


def _parted(above: list[Line], rows: list[Line], tooth: int, layout: SheetMap) -> list[tuple[list[Line], list[Line]]]:
    """The rows below one line of heads, parted at titles that stand among them; each with what stands above it."""
    out: list[tuple[list[Line], list[Line]]] = [(above, [])]
    for line, cells in rows:
        place = cells[tooth] if tooth < len(cells) else ""
        stated = side_by_map(layout, [(line, cells)]) is not None
        if tooth_of(place) is None and (stated or title_of(cells) is not None):
            if out[-1][1]:
                out.append(([], []))
            out[-1][0].append((line, cells))
        else:
            out[-1][1].append((line, cells))
    return out


def _beside(block: TeethRows, starts: Sequence[int]) -> list[TeethRows]:
    """The blocks of which one stands beside the other, each from one column of teeth to the next."""
    if len(starts) == 1:
        return [block]
    out = []
    for first, end in zip(starts, [*starts[1:], len(block.names)], strict=True):
        while end > first and not block.names[end - 1] and not any(cells[end - 1] for cells in block.rows):
            end -= 1
        held = [(line, cells[first:end]) for line, cells in zip(block.lines, block.rows, strict=True)]
        held = [(line, cells) for line, cells in held if any(cells)]
        out.append(
            replace(
                block,
                names=block.names[first:end],
                units=block.units[first:end],
                rows=[cells for _, cells in held],
                lines=[line for line, _ in held],
                first=first,
                above=tuple((line, cells[first:end]) for line, cells in block.above),
            )
        )
    return out


def _titled(block: TeethRows, before: Sequence[TeethRows], layout: SheetMap, *, alone: bool) -> TeethRows:
    """The block with the flank and the quantity that the map, or else its titles, say."""
    told = together(title_of(cells) for line, cells in block.above if line != block.head)
    own = {side for name in block.names if (found := meaning_of(name))[0] == "tooth" and (side := found[1])}
    previous = before[-1] if before and before[-1].names == block.names else None
    if told is None:
        # A page that goes on with the next tooth is of the flank before.
        goes_on = alone and previous is not None and previous.rows and block.tooth is not None
        if goes_on and previous is not None and block.tooth == (tooth_of(previous.rows[-1][0]) or -2) + 1:
            told = Title(side=previous.side, meaning=previous.meaning)
        else:
            told = Title()
    elif not told.meaning and previous is not None:
        told = replace(told, meaning=previous.meaning)
    side = side_by_map(layout, block.above) or (next(iter(own)) if len(own) == 1 else None) or told.side
    return replace(block, side=side, meaning=told.meaning)
