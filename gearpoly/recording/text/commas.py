"""Rows in which commas part the cells and mark the decimals too: ``0,0,1,234`` for 0,0 and 1,234.

Programs write them that take the decimal mark from the country and the comma from their format. A whole number is never
written with a zero in front, and of fractions every tenth begins with one; the names above the rows say how many
numbers there are. Where both leave one way to read the rows it is taken, and where they leave two it is asked for.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.table import Doubt
from gearpoly.recording.text.cells import is_number
from gearpoly.recording.text.cut import split
from gearpoly.recording.text.fixed_width import PARTED
from gearpoly.recording.text.layout import LEAST_RECORDING_ROWS, SEPARATOR_SAMPLE_LINES
from gearpoly.recording.text.lines import TextLines
from gearpoly.recording.text.writing import Writing

ROW_CELLS_LIMIT = 400
"""Most cells of a row that are looked at: the ways to read them are counted cell by cell."""

_STAMP = r"\d[\d./T-]*(?: \d+)?:[\d:]*\d"
_FIRST = rf"(?:[+\-\u2212]?\d+|{_STAMP})"
_POWER = r"(?:[eE][+-]?\d+)?"
_CELL = rf" *(?:{_FIRST}{_POWER}) *"
_ROW = re.compile(rf"{_CELL}(?:,{_CELL})+")
_LEADING = re.compile(rf" *0\d+{_POWER} *")
_FRACTION = re.compile(rf"\d+{_POWER}")
_WHOLE = re.compile(rf" *{_FIRST}")


@dataclass(frozen=True, kw_only=True)
class Commas:
    """Rows whose commas also mark decimals: the ``lines`` with the numbers parted by tabs, what is ``said`` of them,
    and the ``doubt``, where they may be whole numbers as well."""

    lines: TextLines
    said: str
    doubt: Doubt | None = None


def commas(file: Path, lines: TextLines, writing: Writing) -> Commas | None:
    """The rows of a text put together where commas part cells and mark decimals; ``None`` where they do not.

    Raises ``InputFileError`` where they do and the rows may be read in several ways.
    """
    if writing.separator not in ("", ",") or writing.decimal not in ("", ",") or writing.thousands or writing.widths:
        return None
    sample = lines[:SEPARATOR_SAMPLE_LINES]
    rows = [line.split(",") for line in sample if _ROW.fullmatch(line)]
    if len(rows) < LEAST_RECORDING_ROWS or 2 * len(rows) < len(sample):
        return None
    width, _ = Counter(map(len, rows)).most_common(1)[0]
    heads = [line for line in sample[: sample.index(",".join(rows[0]))] if line.strip()]
    names = next((n for line in reversed(heads) if (n := _names(line, width))), 0)
    stated = writing.decimal == ","
    if names == width and not stated:
        return None
    rows = [cells for cells in rows if len(cells) == width]
    columns = list(zip(*rows, strict=True))
    evident = [_begins_with_zeros(column) for column in columns]
    if not stated and not (any(evident) or 2 * names == width):
        return None
    ways = _ways(columns, names or width // 2) if width <= ROW_CELLS_LIMIT and 2 * (names or width / 2) >= width else []
    if not ways and not stated:
        return None
    if len(ways) != 1:
        raise _several(file, ",".join(rows[0]), width, names)
    held = _joined(file, lines, ways[0], names or len(ways[0]), torn=bool(writing.torn_lines))
    doubt, example = None, shorten(",".join(rows[-1]).strip())
    if not stated and not (names and any(evident)):
        says = f"`{example}` may be {len(ways[0])} numbers with decimal commas or {width} whole ones"
        doubt = Doubt(says=says, ask=('text.decimal = ","', 'or text.decimal = "."'))
    why = f"as the {names} names above say" if names else "for the time being"
    numbers = "; ".join(_numbers(rows[-1], ways[0]))
    said = f"commas part the cells and mark the decimals too, {'as the map says' if stated else why}: "
    said += f"`{example}` is read as {shorten(numbers)}"
    return Commas(lines=held, said=said, doubt=doubt)


def _names(line: str, width: int) -> int:
    """How many names a line above rows of ``width`` cells has; 0 where it names none of their columns."""
    cells = split(line, ",")
    return len(cells) if 2 <= len(cells) <= width <= 2 * len(cells) and not any(map(is_number, cells)) else 0


def _begins_with_zeros(column: Sequence[str]) -> bool:
    """Whether cells are fractions, by zeros in front of some and none in front of others."""
    zeros = sum(bool(_LEADING.fullmatch(cell)) for cell in column)
    return 0 < zeros < len(column)


def _ways(columns: Sequence[Sequence[str]], count: int) -> list[tuple[int, ...]]:
    """The ways, two at most, to read columns of cells as ``count`` numbers: the cells, one or two, that each takes."""
    first = [not any(_LEADING.fullmatch(cell) for cell in column) for column in columns]
    whole = [
        good and all(_WHOLE.fullmatch(cell) for cell in column) for good, column in zip(first, columns, strict=True)
    ]
    fraction = [all(_FRACTION.fullmatch(cell.rstrip()) for cell in column) for column in columns]
    ways: dict[tuple[int, int], list[tuple[int, ...]]] = {(0, 0): [()]}
    for at in range(len(columns)):
        for taken in range(max(0, count - (len(columns) - at)), count):
            for before in ways.get((at, taken), ()):
                if first[at]:
                    ways.setdefault((at + 1, taken + 1), []).append((*before, 1))
                if whole[at] and at + 1 < len(columns) and fraction[at + 1]:
                    ways.setdefault((at + 2, taken + 1), []).append((*before, 2))
        for key in [key for key in ways if key[0] <= at]:
            del ways[key]
        for key, held in ways.items():
            ways[key] = held[:2]
    return ways.get((len(columns), count), [])


def _numbers(cells: Sequence[str], way: Sequence[int]) -> Iterator[str]:
    """The numbers in the ``cells`` of a row."""
    at = 0
    for many in way:
        yield ",".join(cells[at : at + many]).strip()
        at += many


def _joined(file: Path, lines: TextLines, way: tuple[int, ...], names: int, *, torn: bool) -> TextLines:
    """The ``lines`` with tabs between the numbers of rows, and between the names of lines with so many of them."""
    number = {1: f"{_FIRST}{_POWER}", 2: rf"{_FIRST},\d+{_POWER}"}
    row = re.compile(",".join(f" *({number[many]}) *" for many in way))
    out = []
    for k, line in enumerate(lines):
        found = row.fullmatch(line)
        if found is not None:
            line = PARTED.join(found.groups())
        elif _ROW.fullmatch(line) and not torn:
            raise _several(file, line, line.count(",") + 1, len(way), where=f"line {k + 1}")
        elif "," in line and not (line.startswith("#") and "=" in line) and len(cells := split(line, ",")) == names:
            line = PARTED.join(cells)
        out.append(line)
    return TextLines("\n".join(out).encode("utf-8"), "utf-8")


def _several(file: Path, line: str, width: int, count: int, *, where: str = "") -> InputFileError:
    """The error for a row whose commas may be read in several ways."""
    found = f"`{shorten(line.strip())}`, {width} cells" + (f" for {count} numbers" if count else "")
    wish = (
        "want semicolons between the cells, or decimal points: commas that part cells and mark decimals tell no number"
    )
    return InputFileError(file, where=where, found=found, wish=wish)
