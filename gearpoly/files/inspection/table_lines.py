"""The lines of an inspection table as cells: the mark between them, frames and rules taken away."""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.inspection.sheet_map import SheetMap
from gearpoly.files.inspection.text import any_text
from gearpoly.files.traces import TRACE_LINE_LIMIT

Line = tuple[int, list[str]]
"""Number in the file, from 1, and the cells."""

SHEET_SEPARATORS = (";", "\t", "|", ",")

_COMMAS = re.compile(r"\d,\d+\s+[-+]?\d+,\d")
"""Two numbers with decimal commas and blanks between them: the comma parts no cells."""


def lines_of(file: Path, layout: SheetMap) -> tuple[list[Line], str]:
    """Lines of cells, comment lines left out, and the separator ("" for blanks)."""
    lines = any_text(file).replace("\u2212", "-").splitlines()
    if long := next((k for k, line in enumerate(lines, start=1) if len(line) > TRACE_LINE_LIMIT), None):
        found = f"{len(lines[long - 1])} characters"
        raise InputFileError(file, where=f"line {long}", found=found, wish=f"want lines of at most {TRACE_LINE_LIMIT}")
    kept = [
        (k, line) for k, line in enumerate(lines, start=1) if line.strip() and not line.lstrip(' "').startswith("#")
    ]
    # The separator of a table stands equally often in most of its lines, or in those of each block.
    separator: str | None = layout.separator
    if separator is None:
        apart = sum(bool(_COMMAS.search(line)) for _, line in kept)
        marks = [one for one in SHEET_SEPARATORS if one != "," or 4 * apart < len(kept)]
        counts = {one: Counter(line.count(one) for _, line in kept) for one in marks}
        often = {one: _alike(found) for one, found in counts.items()}
        separator = max(marks, key=lambda one: (often[one] >= 0.5 * len(kept), -SHEET_SEPARATORS.index(one)))
        if 2 * often[separator] < len(kept):  # most lines have none of them
            separator = _of_long_lines([line for _, line in kept])
        if separator is None:
            width = Counter(len(line.split()) for _, line in kept).most_common(1)[0][0] if kept else 0
            wider = [(k, line.split(), re.split(r"\s{2,}|\t", line.strip())) for k, line in kept]  # names hold blanks
            return [(k, far if len(far) == width != len(cells) else cells) for k, cells, far in wider], ""
    rows = [
        (k, [cell.strip() for cell in next(csv.reader(io.StringIO(line), delimiter=separator), [])]) for k, line in kept
    ]
    return _inside(rows, bars=separator == "|"), separator


def _alike(counts: Counter[int]) -> int:
    """Lines in which a mark stands as often as in others of the same block, which has five teeth at least."""
    most = max((n for times, n in counts.items() if times), default=0)
    return max(most, sum(n for times, n in counts.items() if times and n >= FEWEST_TEETH_MARKS))


FEWEST_TEETH_MARKS = 5
"""Marks in a line with a cell for each tooth, and lines with a row for each: the smallest gear has 5 teeth."""


def _of_long_lines(lines: list[str]) -> str | None:
    """The mark between cells of two lines or more that have many of them alike, below a page of other lines: teeth in
    columns. A comma is none where it stands within numbers that blanks part."""
    for one in SHEET_SEPARATORS:
        counts = Counter(line.count(one) for line in lines if line.count(one) >= FEWEST_TEETH_MARKS)
        if counts and counts.most_common(1)[0][1] >= 2:
            many = [line for line in lines if line.count(one) in counts]
            if one != "," or not any(map(_COMMAS.search, many)):
                return one
    return None


def _inside(rows: list[Line], *, bars: bool) -> list[Line]:
    """The rows without what nothing stands in: behind the last separator of each, and before the first one of ``bars``
    that are drawn about a table; nor rules that are drawn below heads."""
    if bars:
        rows = [(k, cells) for k, cells in rows if "".join(cells).strip("-:= ")]
    width = Counter(len(cells) for _, cells in rows).most_common(1)[0][0] if rows else 0
    wide = [cells for _, cells in rows if len(cells) == width]
    last = width - 1 if width > 2 and not any(cells[-1] for cells in wide) else width
    first = 1 if bars and width > 2 and not any(cells[0] for cells in wide) else 0
    return [(k, cells[first:last] if len(cells) == width else cells) for k, cells in rows]
