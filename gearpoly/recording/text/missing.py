"""What holds no reading in a text file: lines of remarks among rows, and cells with words that a map names."""

from __future__ import annotations

import re
from collections.abc import Sequence

from gearpoly.recording.map_lines import quoted
from gearpoly.recording.text.cells import is_number
from gearpoly.recording.text.lines import TextLines
from gearpoly.recording.text.stamps import is_stamp
from gearpoly.recording.words import tokens

LONGEST_WORD = 40
"""Characters of a cell that a message shows whole; words for no reading are shorter."""


_MONTH = r"[A-Za-z\u00e4\u00e9\u00fb]{3,4}"
_DATE = re.compile(rf"\d{{1,2}}\.?[ -]?{_MONTH}\.?|{_MONTH}[- ]\d{{1,4}}|\d{{1,2}}([./])\d{{1,2}}\1\d{{2,4}}")
"""Days that spreadsheets make of numbers: 4. Nov, Nov 04, 4-Nov, 04.11.2026."""


_SEXAGESIMAL = re.compile(r"[+-]?\d{1,3}:\d{2}:\d{2}(?:[.,]\d+)?")


def no_reading(cell: str) -> str:
    """The line of a map for a cell that is a word for no reading, or what made it of a number."""
    if _DATE.fullmatch(cell):
        return (
            "; a spreadsheet made a date of a number: export it again, with these columns as text before it is opened"
        )
    if _SEXAGESIMAL.fullmatch(cell):
        return "; degrees, minutes and seconds are read as 100\u00b048'00\", and decimal degrees"
    if is_number(cell):
        return "; write one decimal mark in all columns: replace the other one here, or export the file again"
    return f"; in a map, if it holds no reading: text.missing = [{quoted(cell)}]" if len(cell) < LONGEST_WORD else ""


CLOSING = frozenset(
    {
        *(
            "end",
            "ende",
            "fin",
            "fine",
            "mean",
            "average",
            "avg",
            "mittelwert",
            "mittel",
            "moyenne",
            "media",
            "promedio",
        ),
        *("minimum", "min", "maximum", "max", "std", "stdev", "stddev", "standardabweichung", "rms", "effektivwert"),
        *("sum", "summe", "total", "count", "anzahl", "median", "range", "spannweite", "spitze", "statistik"),
    }
)
"""Words in the first cell of what stands below the rows: the end of the table, or what a spreadsheet makes of it."""


def closes(cells: Sequence[str]) -> bool:
    """Whether the cells of a line stand below a table and are no row of it: a word says so, or all are words."""
    return bool(tokens(cells[0]) & CLOSING) or bool(cells[0] and not any(map(is_number, cells)))


def holds_cells(line: str) -> bool:
    """Whether a line among rows is more than blank, or a comment that states no key."""
    return bool(line) and not line.isspace() and (not line.lstrip().startswith("#") or "=" in line)


def without_empty(lines: TextLines) -> TextLines:
    """The ``lines`` with blank ones in the place of those that hold nothing but what parts cells, as spreadsheets write
    rows that were once filled."""
    begin = lines.beginnings()  # a pattern takes far longer
    for mark in (b",", b";", b"\t"):
        if mark[0] in begin:
            lines = TextLines(re.sub(rb"(?m)^[%b ]+$" % mark, b"", lines.text), lines.encoding)
    return lines


MISSING_SAMPLE_LINES = 2000
"""Lines that tell whether rows end in cells without names; the longest head of a logger seen has some hundred."""


def without_unnamed(lines: TextLines) -> tuple[TextLines, str]:
    """The ``lines`` without the empty cells that all rows end in and no line above them names, where there are two or
    more, and what is to be said of it."""
    sample = lines[:MISSING_SAMPLE_LINES]
    for mark in ";,\t":
        begun = [(line, line.partition(mark)[0].strip('" ')) for line in sample if mark in line]
        rows = [line for line, cell in begun if is_number(cell) or is_stamp(cell)]
        cells = min((len(line) - len(line.rstrip(mark)) for line in rows), default=0)
        if len(rows) < FEWEST_ROWS or cells < 2:
            continue
        named = rows[0].count(mark) + 1 - cells
        if named < 2 or any(cell.strip() for line in sample for cell in line.split(mark)[named:]):
            continue
        text = re.sub(rb"(?m)%b{%d}$" % (mark.encode("ascii"), cells), b"", lines.text)
        said = f"{cells} empty cells without names at the end of each row left out"
        return TextLines(text, lines.encoding), said
    return lines, ""


FEWEST_ROWS = 8
"""Rows from which that is told."""


def without(text: str, missing: Sequence[str], separator: str) -> str:
    """The ``text`` with ``nan`` in the place of cells that a map says hold no reading (``missing``)."""
    mark = r"\s" if separator == " " else re.escape(separator) + r"\n\""
    words = "|".join(re.escape(one) for one in sorted(missing, key=len, reverse=True))
    return re.sub(rf"(?:(?<=[{mark}])|(?<![\s\S])) *(?:{words}) *(?=[{mark}]|\Z)", "nan", text)
