"""Numbers as they are written in different countries, and which mark is the decimal one.

``1,234`` is 1.234 in Lyon and 1234 in Leeds. A guess would decide every number of a file, so the mark is taken only
where the cells prove it, and asked for where they do not.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.units import TURN_DEG, FloatArray

BLANKS = " \u00a0\u202f\u2009"
"""What may part thousands: blank, no-break blank, narrow no-break blank, thin blank."""

APOSTROPHES = "'\u2019"

MISSING = frozenset(
    {
        *("", "nan", "-nan", "nan(ind)", "-nan(ind)", "1.#nan", "1.#qnan", "1.#ind", "-1.#ind"),
        *("n/a", "na", "null", "none", "-", "--", "---", "----", "?"),
        *("#nv", "#n/a", "#nan", "#value!", "#wert!", "#div/0!", "#num!", "#zahl!", "#ref!", "#bezug!"),
        *("ol", "ovl", "ovld", "ovrld", "over", "overload", "overflow", "overrange", "underrange"),
        *("\u00fcberlast", "ueberlast", "\u00fcberlauf", "ung\u00fcltig", "ungueltig", "fehler"),
        *("invalid", "error", "err", "undef", "missing"),
    }
)
"""Cells that hold no reading, in small letters: nothing, what programs write of no number, errors of spreadsheets, and
a meter beyond its range."""

LONGEST_MISSING = max(map(len, MISSING))

FILL_MARKS = "*#"
"""Marks with which Fortran and spreadsheets fill a cell that is too narrow for its number."""

_SIGN = "[+\\-\u2212]?"
_GROUPS = rf"\d{{1,3}}(?:[{BLANKS}{APOSTROPHES}]\d{{3}})+"  # a blank elsewhere parts two numbers
_NUMBER = re.compile(rf"{_SIGN}(?:(?:{_GROUPS}|\d)[\d.,]*|[.,]\d+)(?:[eEdD][+-]?\d+)?", re.ASCII)

NEARLY_TURN = (0.9, 1.001)
"""Span of the readings, in turns, of an angle that wraps once a turn; a recording of two turns passes nearly all."""


def is_number(cell: str) -> bool:
    """Whether a stripped cell may be a number in any country's writing."""
    return _NUMBER.fullmatch(cell) is not None


def is_missing(cell: str) -> bool:
    """Whether a stripped cell says that nothing was read."""
    return (len(cell) <= LONGEST_MISSING and cell.lower() in MISSING) or not cell.strip(FILL_MARKS)


@dataclass(frozen=True, kw_only=True)
class Marks:
    """How numbers are written: the ``decimal`` mark, what parts ``thousands`` (each one character or none), and the
    sentence that says ``why``."""

    decimal: str
    thousands: str = ""
    why: str = ""

    def plain(self, cell: str) -> str:
        """The cell as Python writes numbers."""
        for mark in (self.thousands, *BLANKS, *APOSTROPHES):
            if mark:
                cell = cell.replace(mark, "")
        cell = cell.replace(self.decimal, ".").replace("\u2212", "-")
        return cell.replace("D", "e").replace("d", "e")  # Fortran's power of a double

    def value(self, cell: str) -> float:
        """The number in a stripped cell, ``nan`` where it says that nothing was read; ``ValueError`` where it is none,
        or one that is infinite."""
        if is_missing(cell):
            return math.nan
        if not is_number(cell):
            raise ValueError(cell)
        if self.thousands and self.thousands in cell and not _grouped(cell, self.thousands, self.decimal):
            raise ValueError(cell)
        number = float(self.plain(cell))
        if math.isinf(number):
            raise ValueError(cell)
        return number

    def values(self, cells: Sequence[str]) -> FloatArray:
        """The numbers (n,) in stripped cells. Raises ``BadCellError`` with the first that is none."""
        text = "\n".join(cells)
        if _SIMPLE.fullmatch(text) and not (self.thousands and self.thousands in text):
            try:
                found = np.array([float(cell) for cell in text.replace(self.decimal, ".").split("\n")])
            except ValueError:
                found = np.array([math.inf])
            if np.isfinite(found).all():
                return found
        out = np.empty(len(cells))
        for k, cell in enumerate(cells):
            try:
                out[k] = self.value(cell)
            except ValueError:
                raise BadCellError(k) from None
        return out


class BadCellError(ValueError):
    """The cell of this number, from 0, is no number."""

    def __init__(self, at: int) -> None:
        super().__init__(at)
        self.at = at


_SIMPLE = re.compile(r"[0-9eE+\-.,\n]+")


def _grouped(cell: str, thousands: str, decimal: str) -> bool:
    """Whether the marks of thousands stand where thousands part."""
    whole = cell.lstrip("+-\u2212").split(decimal)[0]
    first, *rest = whole.split(thousands)
    return 1 <= len(first) <= 3 and all(len(group) == 3 and group.isdigit() for group in rest)


def marks_proved(columns: Sequence[Sequence[str]], *, separator: str, quoted: bool) -> Marks | None:
    """The marks that the cells of all ``columns`` prove, or ``None`` where they may be read in two ways.

    ``separator`` parts cells; a mark that parts cells too is in no number unless cells are ``quoted``.
    """
    if separator == "," and not quoted:
        return Marks(decimal=".", why="commas part the cells")
    if alone := _marked_once(columns):
        return alone
    seen: dict[str, str] = {}
    for cells in columns:
        for cell in cells:
            for mark, sort in _said(cell):
                if seen.setdefault(mark, sort) != sort:
                    return None
    decimal = [mark for mark, sort in seen.items() if sort == "decimal"]
    thousands = [mark for mark, sort in seen.items() if sort == "thousands"]
    other = {",": ".", ".": ","}
    if len(decimal) > 1:
        return None
    if decimal:
        parts = other[decimal[0]]
        example = next(cell for cells in columns for cell in cells if (decimal[0], "decimal") in _said(cell))
        return Marks(decimal=decimal[0], thousands=parts if parts in thousands else "", why=f"{example} has it so")
    if len(thousands) == 1:
        return Marks(decimal=other[thousands[0]], thousands=thousands[0], why="a number holds the other mark twice")
    if not any(mark in cell for cells in columns for cell in cells for mark in ".,"):
        return Marks(decimal=".", why="no number has a mark")
    return None


def _marked_once(columns: Sequence[Sequence[str]]) -> Marks | None:
    """The decimal mark that one cell proves where all cells have this mark alone, and at most once, so that none can
    say anything else: the commonest case, told without a look at each. ``None`` in all others."""
    for mark, other in ((",", "."), (".", ",")):
        if any(other in cell or cell.count(mark) > 1 for cells in columns for cell in cells):
            continue
        example = next((cell for cells in columns for cell in cells if _said(cell)), None)
        if example is not None:
            return Marks(decimal=mark, why=f"{example} has it so")
    return None


def _said(cell: str) -> list[tuple[str, str]]:
    """What one cell proves of its marks: pairs of a mark and ``decimal`` or ``thousands``."""
    number = cell.strip().lstrip("+-\u2212")
    if not number.isdigit():
        number = re.split("[eEdD]", number, maxsplit=1)[0]
    dots, commas = number.count("."), number.count(",")
    if dots and commas:
        last = "." if number.rfind(".") > number.rfind(",") else ","
        return [(last, "decimal"), ({".": ",", ",": "."}[last], "thousands")]
    if dots + commas == 0:
        return []
    mark = "." if dots else ","
    if dots + commas > 1:
        return [(mark, "thousands")]
    before, after = number.split(mark)
    lead = before.lstrip("0") != before or not before
    if len(after) != 3 or lead or len(before) > 3 or any(one in before for one in BLANKS + APOSTROPHES):
        return [(mark, "decimal")]
    return []


def marks_confirmed(columns: Sequence[Sequence[str]], *, angles: Iterable[int]) -> Marks | None:
    """The marks that the readings themselves confirm where every cell may be read in two ways: a column that runs on
    evenly under one and jumps under the other, or one of the ``angles`` (numbers of columns in degrees) that begins
    again after one turn. ``None`` where neither tells."""
    mark = next((m for cells in columns for cell in cells for m in ".," if m in cell), "")
    if not mark:
        return None
    ways = (Marks(decimal=mark), Marks(decimal={",": ".", ".": ","}[mark], thousands=mark))
    for cells in columns:
        if all(mark in cell for cell in cells if cell and not is_missing(cell.strip())):
            continue  # a thousand times as much runs as evenly
        rough = []
        for way in ways:
            try:
                rough.append(_roughness(np.array([way.value(cell.strip()) for cell in cells])))
            except ValueError:
                rough.append(math.inf)
        better = int(np.argmin(rough))
        if rough[better] * ROUGHER < rough[1 - better]:
            return Marks(
                decimal=ways[better].decimal, thousands=ways[better].thousands, why="only so do readings run on"
            )
    for k in angles:
        try:
            read = np.array([ways[0].value(cell.strip()) for cell in columns[k]])
        except (ValueError, IndexError):
            continue
        held = read[np.isfinite(read)]
        if held.size < 8:
            continue
        span, steps = float(np.ptp(held)), np.abs(np.diff(held))
        wraps = np.count_nonzero(steps > 0.5 * TURN_DEG)
        if NEARLY_TURN[0] <= span / TURN_DEG <= NEARLY_TURN[1] and 1 <= wraps <= held.size // 4:
            return Marks(decimal=mark, why="only so does an angle begin again after one turn")
    return None


ROUGHER = 10.0
"""Ratio of the two readings' roughness from which one is right: where a column passes 1000 the wrong one jumps by the
whole of it, a hundred to a thousand usual steps."""


def _roughness(values: FloatArray) -> float:
    """The largest step over the usual one."""
    steps = np.abs(np.diff(values[np.isfinite(values)]))
    moving = steps[steps > 0.0]
    return float(moving.max() / np.median(moving)) if moving.size else math.inf
