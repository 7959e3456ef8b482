"""The characters of a text file whose encoding nobody states.

Byte order marks are certain, so are the zero bytes of UTF-16 without one, and bytes that are no UTF-8 are none. What is
left is one byte a character, read as Windows has it in the west (cp1252), which holds latin-1. Statistics were tried
instead: charset-normalizer 3.5 takes German bench logs in cp1252 for cp1250, and their Ø for Ř.
"""

from __future__ import annotations

import codecs
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten, unreadable

MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
"""Byte order marks; that of UTF-32 begins as that of UTF-16 does."""

LOOKED_AT = 4096
"""Bytes in which the zero bytes of UTF-16 are counted."""

HEAD_BYTES = 2**16
"""Bytes of the lines above the numbers; the longest head of a logger seen has some 10 kB."""

ONE_BYTE = ("utf-8", "cp1252", "latin-1")
"""Encodings in which the bytes of ASCII are ASCII."""

PADDING = "\0\x1a"
"""What fills a file up behind its last line: zeros of a logger that lost its power, and the end mark of DOS."""

MOST_ASCII = 127

ZEROS = 0.4
"""Part of the even or of the odd bytes that is zero in UTF-16 of western text, where nearly all are; none is in any
encoding of one byte."""


def wide(head: bytes) -> str:
    """The encoding of two bytes a character that the first bytes of a text show, or nothing."""
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE, codecs.BOM_UTF32_BE)):
        return "utf-16"
    part = head[: LOOKED_AT - LOOKED_AT % 2]
    first, second = part[0::2].count(0), part[1::2].count(0)
    least = ZEROS * (len(part) // 2)
    if len(part) >= 8 and second > least and first == 0:
        return "utf-16-le"
    if len(part) >= 8 and first > least and second == 0:
        return "utf-16-be"
    return ""


def decoded(file: Path, *, stated: str = "") -> tuple[str, str]:
    """The text of ``file`` and the name of its encoding; ``stated`` settles it. Line ends become ``\\n``.

    Raises ``InputFileError`` where the file cannot be opened or is not in the encoding stated, and where zero bytes
    or end marks amid it say that it is no text.
    """
    try:
        data = file.read_bytes()
    except OSError as error:
        raise unreadable(file, error) from None
    for name in (stated,) if stated else _candidates(data):
        try:
            text = _text(data, name)
        except (UnicodeDecodeError, UnicodeError):
            continue
        text = text.rstrip(PADDING)
        if any(one in text for one in PADDING):
            wish = "want a text file (other formats need their own file name ending)"
            raise InputFileError(file, found="not a text file", wish=wish)
        if "\r" in text:  # looking for two characters takes as long as decoding
            text = text.replace("\r\n", "\n").replace("\r", "\n")
        return text.removeprefix("\ufeff"), name
    if stated:
        wish = "want the encoding that the file was saved in: leave encoding out of [text] to have it found"
        raise InputFileError(file, found=f'bytes that are not in the encoding "{shorten(stated)}"', wish=wish)
    wish = "want a text file; export it again as UTF-8"
    raise InputFileError(file, found="text in no encoding that is known", wish=wish)


def _text(data: bytes, name: str) -> str:
    """The characters of ``data`` in the encoding ``name``. Where all below the first lines is ASCII, as numbers are, it
    is copied, once if the head allows; a table of characters takes five times as long."""
    end = data.find(b"\n", HEAD_BYTES) + 1
    if name not in ONE_BYTE or end == 0 or np.frombuffer(data, dtype=np.uint8, offset=end).max(initial=0) > MOST_ASCII:
        return data.decode(name)
    head = data[:end].decode(name)
    return (
        data.decode("latin-1") if head == data[:end].decode("latin-1") else head + str(memoryview(data)[end:], "ascii")
    )


def _candidates(data: bytes) -> tuple[str, ...]:
    if marked := next((name for mark, name in MARKS if data.startswith(mark)), ""):
        return (marked,)
    if two := wide(data[:LOOKED_AT]):
        return (two,)
    return ("utf-8", "cp1252", "latin-1")
