"""Lines cut into cells, and whether the cells are a row of readings."""

from __future__ import annotations

import csv
from collections.abc import Sequence

from gearpoly.recording.text.cells import is_missing, is_number
from gearpoly.recording.text.stamps import is_stamp


def split(line: str, separator: str) -> list[str]:
    """The cells of a line without blanks and quotes around them."""
    if '"' in line and separator != " ":
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])]
        except csv.Error:  # a cell without end
            return [line]
    if separator == " ":
        return [cell.strip('"') for cell in line.split()]
    return [cell.strip() for cell in line.split(separator)]


def is_data(cells: Sequence[str]) -> bool:
    """Whether a line is a row: every cell is a number, a stamp or nothing read, and one at least was read."""
    read = False
    for cell in cells:
        if is_number(cell) or is_stamp(cell):
            read = True
        elif not is_missing(cell):
            return False
    return read


def part_read(cells: Sequence[str]) -> bool:
    """Whether a line that is no row holds a number all the same."""
    return any(is_number(cell) for cell in cells)
