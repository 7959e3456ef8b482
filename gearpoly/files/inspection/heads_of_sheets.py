"""Whether a file is an inspection sheet: by its first bytes, or by a table's heads and the teeth that they stand by."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.gde import ROOT
from gearpoly.files.inspection.klingelnberg_text import is_export
from gearpoly.files.inspection.table_blocks import tooth_of
from gearpoly.files.inspection.table_heads import FLANK_WORDS, SIGNED, meaning_of
from gearpoly.files.inspection.table_lines import SHEET_SEPARATORS
from gearpoly.files.inspection.text import any_text
from gearpoly.files.paths import is_file

LARGEST_BYTES = 4 * 2**20
"""Largest table that is looked at as a sheet: 10 000 teeth of both flanks take a tenth of it."""

SHEET_HEAD_LINES = 200
"""Lines in which the heads of a sheet are looked for."""

TEETH_BELOW = 4
"""Rows below the heads whose teeth must follow one another."""

TEETH_BESIDE = 5
"""Numbers that must follow one another where teeth are in columns: the smallest gear has 5 teeth."""

SHEET_START_BYTES = 4096
"""Bytes that tell what a file is."""

MEASURED_QUANTITIES = (*SIGNED, "tooth_thickness", "not taken")


def is_sheet(file: Path) -> bool:
    """Whether a file is an inspection sheet: by its first bytes, or a table of teeth and their deviations."""
    if not is_file(file):
        return False
    try:
        size = file.stat().st_size
        with file.open("rb") as stream:
            start = stream.read(SHEET_START_BYTES)
    except OSError:
        return False
    if is_export(start) or f"<{ROOT}".encode() in start:
        return True
    if size > LARGEST_BYTES or (b"\0" in start and not start.startswith((b"\xff\xfe", b"\xfe\xff"))):
        return False
    try:
        lines = any_text(file).splitlines()[:SHEET_HEAD_LINES]
    except InputFileError:
        return False
    lines = [line for line in lines if line.strip() and not line.lstrip(' "').startswith("#")]
    return any(is_head(lines[k], lines[k + 1 :]) for k in range(len(lines)))


def is_head(line: str, below: Sequence[str]) -> bool:
    """Whether a line holds the heads of an inspection table, or the numbers of its teeth; ``below`` are the next
    lines."""
    for mark in (*SHEET_SEPARATORS, WIDE_BLANKS, ANY_BLANKS):
        cells = _cells(line, mark)
        if _are_teeth(cells) and any(
            meaning_of(cell)[0] in MEASURED_QUANTITIES for one in below for cell in _cells(one, mark)[:3]
        ):
            return True
        at = next((k for k, cell in enumerate(cells[:3]) if meaning_of(cell)[0] == "tooth"), None)
        if at is None or len(cells) < 2:
            continue
        if not any(
            meaning_of(cell)[0] in MEASURED_QUANTITIES or cell.lower() in FLANK_WORDS
            for cell in cells
            if cell != cells[at]
        ):
            continue
        teeth = [found for one in below[: 3 * TEETH_BELOW] if (found := _tooth(_cells(one, mark), at)) is not None]
        if len(teeth) >= TEETH_BELOW and all(b - a in (0, 1) for a, b in pairwise(teeth[:TEETH_BELOW])):
            return True
    return False


def _are_teeth(cells: Sequence[str]) -> bool:
    """Whether the numbers among cells are those of teeth: each one more than the one before, and the first one once
    more at the end where the measurement closes."""
    numbers = [int(cell) for cell in cells if cell.isascii() and cell.isdigit() and len(cell) < 6]
    if len(numbers) > TEETH_BESIDE and numbers[-1] == numbers[0]:
        numbers = numbers[:-1]
    return len(numbers) >= TEETH_BESIDE and all(b - a == 1 for a, b in pairwise(numbers))


WIDE_BLANKS, ANY_BLANKS = r"\s{2,}", r"\s+"
"""What parts cells without a mark: two blanks or more, since heads may hold one; or any."""


def _cells(line: str, mark: str) -> list[str]:
    return [
        cell.strip(' "')
        for cell in (re.split(mark, line.strip()) if mark in (WIDE_BLANKS, ANY_BLANKS) else line.split(mark))
    ]


def _tooth(cells: Sequence[str], at: int) -> int | None:
    return tooth_of(cells[at]) if at < len(cells) else None
