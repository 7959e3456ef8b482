"""The lines of a long text, cut out where they are asked for, and whether many of them are plain rows of numbers."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from gearpoly.units import BoolArray, IntArray

PIECE = 2**20
"""Characters that are looked through at a time."""

LINES_AT_ONCE = 4096
"""Lines that are cut out at a time where all of them are gone through."""

_DIGITS, _SIGNS, _POWERS = b"0123456789", b"+-., ", b"eE"


class Lines(Sequence[str]):
    """The lines of ``text``; a list of them would take three times its memory."""

    def __init__(self, text: str) -> None:
        self._text = text
        parts = []
        for begin in range(0, len(text), PIECE):
            piece = text[begin : begin + PIECE]
            if piece.isascii():
                codes: npt.NDArray[Any] = np.frombuffer(piece.encode("ascii"), dtype=np.uint8)
            else:
                codes = np.frombuffer(piece.encode("utf-32-le", "surrogatepass"), dtype="<u4")
            parts.append(begin + np.flatnonzero(codes == ord("\n")))
        ends = [*parts, np.array([len(text)])]
        self._ends: IntArray = np.concatenate(ends).astype(np.int64)

    def __len__(self) -> int:
        return int(self._ends.size)

    @overload
    def __getitem__(self, at: int) -> str: ...
    @overload
    def __getitem__(self, at: slice) -> list[str]: ...
    def __getitem__(self, at: int | slice) -> str | list[str]:
        if isinstance(at, slice):
            first, end, step = at.indices(len(self))
            return self.joined(first, end).split("\n")[::step] if first < end else []
        k = range(len(self))[at]
        return self._text[self._begin(k) : int(self._ends[k])]

    def __iter__(self) -> Iterator[str]:
        for k in range(0, len(self), LINES_AT_ONCE):
            yield from self[k : k + LINES_AT_ONCE]

    def joined(self, first: int, end: int) -> str:
        """The text of the lines from ``first`` to before ``end``, both from 0."""
        return self._text[self._begin(first) : int(self._ends[end - 1])] if first < end else ""

    def hold(self, mark: str, first: int, end: int) -> bool:
        """Whether a ``mark`` stands in any of the lines from ``first`` to before ``end``."""
        return first < end and self._text.find(mark, self._begin(first), int(self._ends[end - 1])) >= 0

    def _begin(self, k: int) -> int:
        return int(self._ends[k - 1]) + 1 if k else 0


def are_rows(text: str, separator: str, width: int) -> bool:
    """Whether every line of ``text`` has ``width`` cells with a digit in each, and nothing but what numbers are written
    with; dates of digits too. Whether they are numbers is told where they are read."""
    if separator == " " or not text.isascii():
        return False
    kinds = text.encode("ascii").translate(_kinds(separator)) + b"\5"
    if b"\0" in kinds:
        return False
    kind = np.frombuffer(kinds, dtype=np.uint8)
    if b"\3" in kinds:
        powers = np.flatnonzero(kind == 3)
        if not (powers[0] > 0 and (kind[powers - 1] == 1).all()):  # a word that begins with an E
            return False
    ends = np.flatnonzero(kind >= 4)
    if ends.size % width:
        return False
    marks = kind[ends].reshape(-1, width)
    if not ((marks[:, :-1] == 4).all() and (marks[:, -1] == 5).all()):
        return False
    if ends.size and ends[0] > 0 and (kind[ends - 1] == 1).all():  # nearly all numbers end in a digit
        return True
    digits: BoolArray = kind == 1
    return bool((np.diff(np.cumsum(digits, dtype=np.int64)[ends], prepend=0) > 0).all())


@functools.cache
def _kinds(separator: str) -> bytes:
    """For each byte: 1 of a digit, 2 of what else numbers have, 3 of a power, 4 what parts cells, 5 a line's end, 0 of
    all others."""
    kinds = bytearray(256)
    for marks, kind in ((_DIGITS, 1), (_SIGNS, 2), (_POWERS, 3), (separator.encode(), 4), (b"\n", 5)):
        for mark in marks:
            kinds[mark] = kind
    return bytes(kinds)
