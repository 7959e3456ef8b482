"""The lines of a long text, cut out where they are asked for, and whether many of them are plain rows of numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import overload

import numpy as np

from gearpoly.units import BoolArray, IntArray

LINES_PIECE_BYTES = 2**18
"""Bytes that are looked through at a time; what is made of them stays in the processor's own memory."""

LINES_AT_ONCE = 2048
"""Lines that are cut out at a time where all of them are gone through."""

NUMBER_CHARACTERS = b"0123456789+-., eE"
"""What numbers are written with; dates of digits too."""


STAMPED = b":/TZ"
"""What stamps are written with beside these."""


class TextLines(Sequence[str]):
    """The lines of a ``text`` of bytes in an ``encoding`` that holds those of ASCII; a list of them would take three
    times its memory."""

    def __init__(self, text: bytes, encoding: str) -> None:
        self.text = text
        self.encoding = encoding
        codes = np.frombuffer(text, dtype=np.uint8)
        parts = [
            begin + np.flatnonzero(codes[begin : begin + LINES_PIECE_BYTES] == _END)
            for begin in range(0, codes.size, LINES_PIECE_BYTES)
        ]
        self._ends: IntArray = np.concatenate([*parts, np.array([len(text)])]).astype(np.int64, copy=False)

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
        return self.text[self._begin(k) : int(self._ends[k])].decode(self.encoding)

    def __iter__(self) -> Iterator[str]:
        for k in range(0, len(self), LINES_AT_ONCE):
            yield from self[k : k + LINES_AT_ONCE]

    def joined(self, first: int, end: int) -> str:
        """The text of the lines from ``first`` to before ``end``, both from 0."""
        return self.coded(first, end).decode(self.encoding)

    def coded(self, first: int, end: int) -> bytes:
        """The bytes of the same lines."""
        return self.text[self._begin(first) : int(self._ends[end - 1])] if first < end else b""

    def hold(self, mark: str, first: int, end: int) -> bool:
        """Whether a ``mark`` stands in any of the lines from ``first`` to before ``end``."""
        held = mark.encode(self.encoding, "ignore")
        return first < end and held != b"" and self.text.find(held, self._begin(first), int(self._ends[end - 1])) >= 0

    def beginnings(self) -> frozenset[int]:
        """The bytes with which lines begin, but for the first."""
        codes = np.frombuffer(self.text, dtype=np.uint8)
        begins = self._ends[:-1] + 1
        return frozenset(np.flatnonzero(np.bincount(codes[begins[begins < codes.size]])).tolist())

    def _begin(self, k: int) -> int:
        return int(self._ends[k - 1]) + 1 if k else 0


def squeezed(text: bytes) -> bytes:
    """The ``text`` with one blank where several part cells, and none at either end of a line."""
    while b"  " in text:
        text = text.replace(b"  ", b" ")
    return text.replace(b"\n ", b"\n").replace(b" \n", b"\n").strip(b" ")


def are_rows(text: bytes, separator: str, row: bytes) -> bool:
    """Whether every line of ``text`` has as many cells as the ``row`` above it, with a digit in each that is not empty
    and in one at least, and nothing but what numbers are written with, beside what parts hours from minutes where
    ``row`` has it too. Whether they are numbers or stamps is told where they are read."""
    if separator == " ":
        text, row = squeezed(text), squeezed(row)
    mark = separator.encode("ascii")
    if separator != " " and (found := _HALF.search(row)):
        text, row = (_without_halves(one, found[0], mark) for one in (text, row))
    beside = NUMBER_CHARACTERS.replace(mark, b"")
    like = row.translate(None, beside) + b"\n"  # what parts cells and rows
    parts = text.translate(None, beside) + b"\n"
    if like.translate(None, mark + STAMPED + b"\n") or parts != like * (len(parts) // len(like)):
        return False
    codes = np.frombuffer(text, dtype=np.uint8)
    digit: BoolArray = codes - _ZERO < 10  # those below zero come out large
    ends: BoolArray = np.append((codes == mark[0]) | (codes == _END), True)
    if b"e" in text or b"E" in text:
        power = codes | _SMALL == ord("e")
        if power[0] or not digit[:-1][power[1:]].all():  # a word that begins with an E
            return False
    if not ends[0] and (digit | ~ends[1:]).all():  # nearly all numbers end in a digit
        return True
    read = np.diff(np.append(0, np.cumsum(digit, dtype=np.int64))[ends], prepend=0) > 0
    empty = np.diff(np.flatnonzero(ends), prepend=-1) == 1
    return bool((read | empty).all() and read.reshape(-1, like.count(mark) + 1).any(axis=1).all())


def _without_halves(text: bytes, half: bytes, mark: bytes) -> bytes:
    """The ``text`` without the halves of the day at the ends of cells, written as ``half`` is."""
    text += b"\n"
    for one in {half.translate(_AM), half.translate(_PM)}:
        for end in (mark, b"\n"):  # a pattern takes ten times as long
            text = text.replace(one + end, end)
    return text[:-1]


_HALF = re.compile(rb"(?<=\d) ?[AaPp]\.?[Mm]\.?(?=[,;|\t]|\Z)")
_AM, _PM = bytes.maketrans(b"Pp", b"Aa"), bytes.maketrans(b"Aa", b"Pp")
"""A half of the day behind a time of it, and what makes one of the other."""

_END, _ZERO, _SMALL = np.uint8(ord("\n")), np.uint8(ord("0")), np.uint8(ord("a") - ord("A"))
