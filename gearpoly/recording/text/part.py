"""The rows of one recording in a text: cut out as cells, or read as plain numbers where they are no more than that."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.finite import all_finite
from gearpoly.recording.text.cells import Marks
from gearpoly.recording.text.cut import split
from gearpoly.recording.text.layout import RecordingLines
from gearpoly.recording.text.lines import TextLines, squeezed
from gearpoly.recording.text.missing import holds_cells
from gearpoly.recording.text.parsed import parsed
from gearpoly.recording.text.writing import Writing
from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True)
class TextPart:
    """One recording in the lines of a file, and its block."""

    file: Path
    lines: TextLines
    block: RecordingLines
    separator: str
    writing: Writing

    @property
    def bounds(self) -> tuple[int, int]:
        """The first line of its rows and the one after the last, from 0."""
        return self.block.rows[0] - 1, self.block.rows[1] - 1

    def rows(self, first: int, end: int) -> list[int]:
        """The numbers from 0 of the lines from ``first`` to before ``end`` that are not blank."""
        return [first + k for k, line in enumerate(self.lines[first:end]) if holds_cells(line)]

    def ends(self, count: int) -> list[int]:
        """The numbers of the first and of the last ``count`` rows, of all where there are no more."""
        first, end = self.bounds
        begin: list[int] = []
        while len(begin) < count and first < end:
            begin += self.rows(first, min(first + count, end))
            first += count
        first = begin[count - 1] + 1 if len(begin) > count else first
        rest: list[int] = []
        while len(rest) < count and first < end:
            rest = self.rows(max(first, end - count), end) + rest
            end -= count
        return begin[:count] + rest[-count:]

    def plain(self, first: int, end: int, marks: Marks) -> Sequence[FloatArray] | None:
        """The columns (n,) in the lines from ``first`` to before ``end`` where they are plain rows of numbers;
        ``None`` where they are to be read cell by cell."""
        if marks.thousands and self.lines.hold(marks.thousands, first, end):
            return None
        found = self.parsed(first, end, marks)
        if found is not None:
            return found
        width = len(self.block.names)
        rows = self.lines.joined(first, end).replace(marks.decimal, ".").split("\n")
        mark = None if self.separator == " " else self.separator
        try:
            table = np.loadtxt(rows, delimiter=mark, comments=None, ndmin=2, dtype=np.float64)
        except ValueError:
            return None
        good = table.shape == (end - first, width) and bool(np.isfinite(table).all())
        return list(table.T) if good else None

    def parsed(self, first: int, end: int, marks: Marks, *, texts: Sequence[int] = ()) -> list[npt.NDArray[Any]] | None:
        """The same by the quickest parser, of ``texts`` the characters (n, length); ``None`` where it cannot read
        them."""
        if marks.thousands and self.lines.hold(marks.thousands, first, end):
            return None
        data = self.lines.coded(first, end)
        if self.separator == " ":
            data = squeezed(data)
        found = parsed(
            data,
            columns=len(self.block.names),
            size=self.file.stat().st_size,
            separator=self.separator,
            decimal=marks.decimal,
            texts=texts,
        )
        # Without a letter for it, what is no number was an empty cell; words are told.
        holes = not (b"n" in data or b"N" in data)
        good = found is not None and all(
            len(one) == end - first and (k in texts or holes or all_finite(one)) for k, one in enumerate(found)
        )
        return found if good else None

    def cells(self, rows: Sequence[int]) -> list[tuple[str, ...]]:
        """The cells of some rows, column by column."""
        mark = self.separator
        cells = [
            [cell.strip() for cell in line.split(mark)] if mark != " " and '"' not in line else split(line, mark)
            for line in self._texts(rows)
        ]
        return list(zip(*cells, strict=True))

    def _texts(self, rows: Sequence[int]) -> Iterator[str]:
        """The lines of some rows; neighbours are cut out together."""
        for _, same in itertools.groupby(enumerate(rows), lambda one: one[1] - one[0]):
            numbers = [row for _, row in same]
            yield from self.lines[numbers[0] : numbers[-1] + 1]

    def bad(self, k: int, row: int, cell: str, wish: str) -> InputFileError:
        """The error for a cell of column ``k`` in a row, both from 0."""
        where = f"line {row + 1}, column {self.block.names[k]}"
        return InputFileError(self.file, where=where, found=f'"{shorten(cell)}"', wish=wish)
