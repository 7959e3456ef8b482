"""Rows of numbers in columns of fixed width, where numbers may touch: ``12.345-123.456`` of Fortran's F8.3.

Numbers are parted where nothing else can be meant. Decimal marks of such a table stand one below the other, and a
column ends as many places behind its mark in every row; a sign behind a digit and before a number begins a new one.
"""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.text.cut import is_data
from gearpoly.recording.text.layout import LEAST_RECORDING_ROWS
from gearpoly.recording.text.lines import TextLines
from gearpoly.recording.text.writing import Writing

PARTED = "\t"
"""What parts the cells once they are cut."""

WIDTH_LIMIT = 1000
"""Longest cell in characters."""

_ROW = re.compile(r"[ 0-9.,eEdD+\-]*\d[ 0-9.,eEdD+\-]*")
_TOUCHING = re.compile(r"\d[+-]\d*[.,]\d|[.,]\d+[.,]\d")
_SIGN = re.compile(r"(?<=[\d.,])(?=[+-]\d*[.,]\d)")
_NAME = re.compile(r"\s+(?![\[({<])")
"""What parts names whose units stand behind them in brackets."""

_IN_BYTES = re.compile(_TOUCHING.pattern.encode("ascii"))
_MARK = re.compile(r"[.,]")


@dataclass(frozen=True, kw_only=True)
class Touching:
    """Rows whose numbers touch: an ``example``; the ``lines`` parted for certain, or ``None``, and ``how``, by the
    widths ``cut`` or by signs; the ``widths`` that the columns seem to have, empty where nothing tells them."""

    example: str
    lines: TextLines | None = None
    cut: tuple[int, ...] = ()
    widths: tuple[int, ...] = ()

    @property
    def how(self) -> str:
        """What parted the numbers, in words."""
        return f"where their columns end, in widths of {', '.join(map(str, self.cut))}" if self.cut else "at signs"


def touching(lines: TextLines) -> Touching | None:
    """What is known of rows whose numbers touch; ``None`` where none do."""
    if not _IN_BYTES.search(lines.text):
        return None
    rows = [line.rstrip() for line in lines if _ROW.fullmatch(line)]
    if any("," in row for row in rows) and not _decimal_commas(rows):
        return None
    example = next((held[0] for line in rows if (held := _touching_cell(line))), "")
    if not example or len(rows) < LEAST_RECORDING_ROWS:
        return None
    ends, sure = _ends(rows)
    if sure:
        return Touching(example=example, lines=by_widths(lines, _widths(ends)), cut=_widths(ends))
    signed = [_SIGN.sub(" ", line).split() for line in rows]
    width = Counter(map(len, signed)).most_common(1)[0][0]
    # Two marks in what is left are numbers that touch without a sign, or marks of thousands.
    if width > 1 and all(len(one) == width and is_data(one) and not _double(one) for one in signed):
        text = "\n".join(_SIGN.sub(" ", line) if _ROW.fullmatch(line) else line for line in lines)
        return Touching(example=example, lines=TextLines(text.encode("utf-8"), "utf-8"))
    return Touching(example=example, widths=_widths(ends))


def parted(file: Path, held: Touching, writing: Writing) -> tuple[TextLines, Writing]:
    """The lines of a text whose numbers touch, parted, and how they are then written.

    Raises ``InputFileError`` where nothing tells where the numbers end.
    """
    if held.lines is None:
        widths = ", ".join(map(str, held.widths)) or "8, 8, 8"
        wish = f"want the widths of the columns in a map, such as: text.widths = [{widths}]"
        raise InputFileError(file, found=f"numbers that touch, such as {shorten(held.example)}", wish=wish)
    return held.lines, replace(writing, separator=PARTED if held.cut else " ", widths=held.cut)


def _decimal_commas(rows: Sequence[str]) -> bool:
    """Whether commas in rows are decimal marks, and part no cells: no points are there, and blanks fill cells up."""
    filled = sum(row.startswith(" ") or "  " in row for row in rows)
    return 2 * filled > len(rows) and not any("." in row for row in rows)


def _touching_cell(line: str) -> list[str]:
    return [cell for cell in line.split() if _TOUCHING.search(cell)]


def _double(cells: Sequence[str]) -> bool:
    return any(len(_MARK.findall(cell)) > 1 for cell in cells)


def _ends(rows: Sequence[str]) -> tuple[list[int], bool]:
    """Where each column ends, as far as the places of decimal marks tell it, and whether they do for certain: all rows
    have their marks in the same places, and of each column a row shows how many figures stand behind its mark."""
    marks = [tuple(found.start() for found in _MARK.finditer(row)) for row in rows]
    places, often = Counter(marks).most_common(1)[0]
    if len(places) < 2:
        return [], False
    figures: list[int | None] = [None] * len(places)
    sure = often == len(rows)
    for row, found in zip(rows, marks, strict=True):
        if found != places:
            continue
        for k, place in enumerate(places):
            behind = re.match(r"\d*(?:[eEdD][+-]?\d+)?", row[place + 1 :])
            long = len(behind[0]) if behind else 0
            end = place + 1 + long
            if end < len(row) and row[end] in ".,":
                continue  # the figures of the next number follow
            figures[k] = long if figures[k] is None else figures[k]
    known = Counter(one for one in figures if one is not None)
    sure = sure and None not in figures
    usual = known.most_common(1)[0][0] if known else 0
    ends = [place + 1 + (usual if one is None else one) for place, one in zip(places, figures, strict=True)]
    if any(end > place for end, place in zip(ends, places[1:], strict=False)):
        return [], False
    return ends, sure and all(is_data(_cells(row, _widths(ends))) for row in rows)


def _widths(ends: Sequence[int]) -> tuple[int, ...]:
    return tuple(end - begin for begin, end in zip([0, *ends], ends, strict=False))


def _cells(line: str, widths: Sequence[int]) -> list[str]:
    """The cells of a line; what stands beyond the last width is in the last one."""
    cells, at = [], 0
    for k, width in enumerate(widths):
        cells.append(line[at : at + width if k + 1 < len(widths) else None].strip())
        at += width
    return cells


def _on_blanks(line: str, widths: Sequence[int]) -> bool:
    """Whether a line has a blank on either side of each place where cells part."""
    places = itertools.accumulate(widths[:-1])
    return all(" " in line[place - 1 : place + 1] for place in places)


def by_widths(lines: Sequence[str], widths: Sequence[int]) -> TextLines:
    """The lines with their cells of these ``widths`` parted by tabs; names that blanks part into as many are parted so,
    and remarks stay."""
    out = []
    for line in lines:
        cells = _cells(line, widths)
        words = _NAME.split(line.strip())
        if len(line) > widths[0] and is_data(cells) and _ROW.fullmatch(line):
            out.append(PARTED.join(cells))
        elif len(words) == len(widths) and not is_data(words):
            out.append(PARTED.join(words))
        elif not _ROW.fullmatch(line) and all(cells) and _on_blanks(line, widths):
            out.append(PARTED.join(cells))
        else:
            out.append(line)
    return TextLines("\n".join(out).encode("utf-8"), "utf-8")
