"""What programs put about the cells of a row, taken off: ``="1.5"`` of spreadsheets, objects of JSON, lists in
brackets, stamps of serial monitors, counts in hexadecimal, and channels in rows instead of columns.

Lines keep their numbers, but for channels in rows.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from gearpoly.recording.text.cells import is_number
from gearpoly.recording.text.channels import numbered_channels
from gearpoly.recording.text.cut import split
from gearpoly.recording.text.lines import TextLines

CHANNELS_TURNED_WORDS = "channels in rows were turned to columns"

WRAPPED_SAMPLE_LINES = 2000
"""Lines among which the last few are looked at; heads are shorter."""

ROWS_WRAPPED_ALIKE = 8
"""Rows that all have to be wrapped alike."""

CHANNELS_MOST = 64
"""Lines up to which a text may hold channels in rows, and cells from which it does: a channel has more readings."""

_OBJECT = re.compile(r"\s*\[?\s*\{([^{}\[\]]*)\}\s*[,\]]?\s*")
_LIST = re.compile(r"\s*\[?[\[(]([^\[\]()]*)[\])]\]?,?\s*")
_STAMP = re.compile(r"\s{0,8}\[([0-9][^\[\]]{0,40})\]\s{0,8}(?=\S)")
_ARROW = re.compile(r"\s{0,8}(\d[^\s>]{0,40}(?: [^\s>]{1,40})?) ?-{1,2}>\s{0,8}(?=\S)")
_EXCEL = re.compile(r'="([^"]*)"')
_HEX = re.compile(r"(?<![\w.])0[xX]([0-9A-Fa-f]{1,13})(?!\w)")


def unwrapped(lines: TextLines) -> tuple[TextLines, str]:
    """The ``lines`` as rows of cells, and what was done to them; nothing where nothing was wrapped."""
    sample = lines[:WRAPPED_SAMPLE_LINES]
    rows = [line for line in sample if line.strip()][-ROWS_WRAPPED_ALIKE:]
    if not rows:
        return lines, ""
    mark = next((mark for mark in (";", "\t", ",") if all(mark in line for line in rows)), " ")
    ways: tuple[tuple[str, Callable[[str], str | None]], ...] = (
        ('="..." about cells', lambda line: _EXCEL.sub(r'"\1"', line) if _EXCEL.search(line) else None),
        ("objects of JSON", _plain_object),
        ("brackets about rows", lambda line: found[1] if (found := _LIST.fullmatch(line)) else None),
        ("brackets about stamps", lambda line: _STAMP.sub(rf"\1{mark}", line, count=1) if _STAMP.match(line) else None),
        ("arrows behind stamps", lambda line: _ARROW.sub(rf"\1{mark}", line, count=1) if _ARROW.match(line) else None),
        ("hexadecimal counts", lambda line: _HEX.sub(_decimal, line) if _HEX.search(line) else None),
    )
    for said, way in ways:
        if all(way(line) is not None for line in rows):
            held = (plain if (plain := way(line)) is not None else line for line in lines)
            return TextLines("\n".join(held).encode("utf-8"), "utf-8"), f"taken off: {said}"
    turned = _turned(sample) if len(lines) <= CHANNELS_MOST else None
    if turned is not None:
        return TextLines(turned.encode("utf-8"), "utf-8"), CHANNELS_TURNED_WORDS
    return numbered_channels(lines)


def _decimal(found: re.Match[str]) -> str:
    return str(int(found[1], 16))


def _plain_object(line: str) -> str | None:
    found = _OBJECT.fullmatch(line)
    return None if found is None or ":" not in found[1] else found[1].replace('"', "").replace("null", "nan")


def _turned(lines: Sequence[str]) -> str | None:
    """The text with a column for each line, of lines that hold a name and the readings of a channel each."""
    for mark in ("\t", ";", ","):
        cells = [split(line, mark) for line in lines if line.count(mark) >= CHANNELS_MOST]
        named = [one for one in cells if not is_number(one[0]) and all(is_number(cell) or not cell for cell in one[1:])]
        if len(named) >= 2 and len(named) == len(cells) and len(set(map(len, named))) == 1:
            return "\n".join(mark.join(row) for row in zip(*named, strict=True))
    return None
