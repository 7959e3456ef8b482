"""The last row of a text whose logger was stopped while it wrote: it has no line end, and less in it than those above.

A file may lack its last line end and be whole. Its last row is left out only where it has fewer cells than all rows
above, or where its last cell is shorter behind the decimal mark than theirs.
"""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from gearpoly.files.traces import shorten
from gearpoly.recording.text.cells import is_missing, is_number
from gearpoly.recording.text.cut import split
from gearpoly.recording.text.layout import SEPARATOR_NAMES
from gearpoly.recording.text.stamps import is_stamp

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

TAIL_BYTES = 2**17
"""Bytes at the end of a text that are looked at: some thousand rows."""

FEWEST_WHOLE_ROWS = 8
"""Rows that have to have as many cells as one another."""

FEWEST_ALIKE = 64
"""Rows whose last cells have to be equally long. Where zeros at the end of numbers are not written, each row has one
digit more than the next longest in nine of ten: 64 are all equally long in 0.1 % of such files, and the last one is
shorter in a tenth of them."""

SHORTER = 3
"""Digits by which the last cell has to be shorter than the shortest above where they are not equally long: one number
in a thousand ends in so many zeros, and fewer are that much shorter than the shortest of 64."""

_BEGUN = re.compile(r"[+\-\u2212]|[+\-\u2212]?\d*[.,]?\d*(?:[eEdD][+-]?\d*)?")
"""What a number may be cut off to."""

_CLOSING = "}])"


def broken_off(tail: Sequence[str]) -> str:
    """Why the last one of the lines at the end of a text, which has no line end, is no whole row, or nothing."""
    *above, last = tail
    rows = [line for line in above if line.strip() and not line.lstrip().startswith("#")]
    if len(rows) < FEWEST_WHOLE_ROWS or not last.strip():
        return ""
    ends = {line.rstrip(" ,")[-1:] for line in rows[-FEWEST_WHOLE_ROWS:]}
    if len(ends) == 1 and ends <= set(_CLOSING):
        like = last.lstrip()[:1] == rows[-1].lstrip()[:1] and last.rstrip(" ,")[-1:] not in ends
        return "without its end" if like else ""
    for separator in SEPARATOR_NAMES:
        cells = [held for line in rows if _is_read((held := split(line, separator))[0])]
        width = len(cells[-1]) if cells else 0
        if width > 1 and len(cells) >= FEWEST_WHOLE_ROWS and all(len(one) == width for one in cells[-FEWEST_ALIKE:]):
            return _less(split(last, separator), [one for one in cells if len(one) == width])
    return ""


def _less(last: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """What the cells of a ``last`` row lack of those of the ``rows`` above."""
    above, ends = rows[-1], [row[-1] for row in rows]
    if not _is_read(last[0]) or len(last) > len(above):
        return ""
    # A column of words stands above words.
    if not all(_is_read(one) or is_missing(one) or not _is_read(up) for one, up in zip(last[:-1], above, strict=False)):
        return ""
    if len(last) < len(above):
        return f"{len(last)} of {len(above)} cells"
    if len(ends) < FEWEST_ALIKE or not all(map(_is_read, ends)):
        return ""
    if not _is_read(last[-1]):
        return f'the last cell "{shorten(last[-1])}"' if _BEGUN.fullmatch(last[-1]) else ""
    lengths = sorted(map(_behind, ends))
    short = _behind(last[-1]) <= lengths[0] - (1 if lengths[0] == lengths[-1] else SHORTER)
    return f'the last cell "{shorten(last[-1])}" shorter than all above' if short else ""


def _behind(cell: str) -> int:
    """The characters behind the decimal mark, or all of a number without one."""
    at = max(cell.rfind("."), cell.rfind(","))
    return len(cell) - at - 1 if at >= 0 else len(cell.lstrip("+-\u2212"))


def _is_read(cell: str) -> bool:
    return is_number(cell) or is_stamp(cell)


def without_broken_off(text: bytes, encoding: str) -> tuple[bytes, str]:
    """The ``text`` without a last row that is not whole, and what is to be said of it."""
    if text.endswith(b"\n"):
        return text, ""
    begin = text.rfind(b"\n") + 1
    part = text[max(0, len(text) - TAIL_BYTES) :].decode(encoding, errors="replace")
    why = broken_off(_whole_lines(part, first=len(text) <= TAIL_BYTES))
    return (text[:begin], _said(text[begin:].decode(encoding, errors="replace"), why)) if why else (text, "")


def end_of_rows(file: Path) -> tuple[int, str]:
    """The bytes of a text in UTF-8 without a last row that is not whole, and what is to be said of it."""
    size = file.stat().st_size
    with file.open("rb") as stream:
        stream.seek(max(0, size - TAIL_BYTES))
        part = stream.read()
    if part.endswith((b"\n", b"\r")):
        return size, ""
    begin = max(part.rfind(b"\n"), part.rfind(b"\r")) + 1
    held = part.decode("utf-8", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
    why = broken_off(_whole_lines(held, first=size <= TAIL_BYTES))
    if not why:
        return size, ""
    return size - (len(part) - begin), _said(part[begin:].decode("utf-8", errors="replace"), why)


def _whole_lines(part: str, *, first: bool) -> list[str]:
    """The lines of a ``part`` of a text, without one whose beginning is not in it."""
    lines = part.split("\n")
    return lines if first else lines[1:] or [""]


def _said(line: str, why: str) -> str:
    return f"the last line breaks off, {why}, and is left out: `{shorten(line.strip())}`"


class FirstBytes(io.RawIOBase):
    """A ``file`` up to so many bytes, as a stream."""

    def __init__(self, file: Path, end: int) -> None:
        super().__init__()
        self._stream = file.open("rb", buffering=0)
        self._left = end

    def readable(self) -> bool:
        return True

    def readinto(self, into: WriteableBuffer) -> int:
        got = self._stream.readinto(memoryview(into)[: self._left]) or 0
        self._left -= got
        return got

    def close(self) -> None:
        self._stream.close()
        super().close()
