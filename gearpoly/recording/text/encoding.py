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

BYTE_ORDER_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
"""Byte order marks beside that of UTF-8; that of UTF-32 begins as that of UTF-16 does."""

ENCODING_SAMPLE_BYTES = 4096
"""Bytes in which the zero bytes of UTF-16 are counted."""

TEXT_HEAD_BYTES = 2**16
"""Bytes of the lines above the numbers; the longest head of a logger seen has some 10 kB."""

ENCODING_PIECE_BYTES = 2**20
"""Bytes that are looked through at a time."""

ONE_BYTE = ("utf-8", "cp1252", "latin-1")
"""Encodings in which the bytes of ASCII are ASCII."""

PADDING = b"\0\x1a"
"""What fills a file up behind its last line: zeros of a logger that lost its power, and the end mark of DOS."""

MOST_ASCII = 127

ZERO_BYTES_PART = 0.4
"""Part of the even or of the odd bytes that is zero in UTF-16 of western text, where nearly all are; none is in any
encoding of one byte."""


def shown(head: bytes) -> str:
    """The encoding that the first bytes of a text show for certain, by a byte order mark or as wide characters do; or
    nothing."""
    marked = "utf-8-sig" if head.startswith(codecs.BOM_UTF8) else ""
    return marked or next((name for mark, name in BYTE_ORDER_MARKS if head.startswith(mark)), "") or wide(head)


def wide(head: bytes) -> str:
    """The encoding of two bytes a character that the zero bytes among the first of a text show, or nothing."""
    part = head[: ENCODING_SAMPLE_BYTES - ENCODING_SAMPLE_BYTES % 2]
    first, second = part[0::2].count(0), part[1::2].count(0)
    least = ZERO_BYTES_PART * (len(part) // 2)
    if len(part) >= 8 and second > least and first == 0:
        return "utf-16-le"
    if len(part) >= 8 and first > least and second == 0:
        return "utf-16-be"
    return ""


def coded(file: Path, *, stated: str = "") -> tuple[bytes, str, str]:
    """The text of ``file`` in bytes of which those of ASCII are ASCII, their encoding, and that of the file; ``stated``
    settles it. Line ends become ``\\n``.

    The bytes of the file are kept where they are such: as characters they would take their memory and time once more.
    Raises ``InputFileError`` where the file cannot be opened or is not in the encoding stated, and where zero bytes
    or end marks amid it say that it is no text.
    """
    try:
        with file.open("rb", buffering=0) as stream:  # a buffer would be put together with the rest, which copies it
            marked = stream.read(len(codecs.BOM_UTF8)) == codecs.BOM_UTF8 and (not stated or _is_utf8(stated))
            stream.seek(len(codecs.BOM_UTF8) if marked else 0)
            data = stream.readall()
    except OSError as error:
        raise unreadable(file, error) from None
    found = ("utf-8-sig",) if marked else _candidates(data)
    for name in (stated,) if stated else found:
        try:
            text, inside = _held(data, name)
        except UnicodeError:
            continue
        del data
        text = text.rstrip(PADDING)
        if any(one in text for one in (PADDING[:1], PADDING[1:])):
            wish = "want a text file (other formats need their own file name ending)"
            raise InputFileError(file, found="not a text file", wish=wish)
        if b"\r" in text:  # looking for two characters takes as long as decoding
            text = text.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        return text, inside, name
    if stated:
        wish = "want the encoding that the file was saved in: leave encoding out of [text] to have it found"
        raise InputFileError(file, found=f'bytes that are not in the encoding "{shorten(stated)}"', wish=wish)
    wish = "want a text file; export it again as UTF-8"
    raise InputFileError(file, found="text in no encoding that is known", wish=wish)


def _held(data: bytes, name: str) -> tuple[bytes, str]:
    """The text ``data``, which is in the encoding ``name``, in bytes that hold those of ASCII, and their encoding.

    Raises ``UnicodeError`` where it is in another encoding.
    """
    if _is_utf8(name):
        name = "utf-8"
    elif name not in ONE_BYTE:
        return data.decode(name).removeprefix("\ufeff").encode("utf-8"), "utf-8"
    end = data.find(b"\n", TEXT_HEAD_BYTES) + 1
    if end == 0 or np.frombuffer(data, dtype=np.uint8, offset=end).max(initial=0) > MOST_ASCII:
        end = len(data)
    decoder = codecs.getincrementaldecoder(name)()  # a whole text of characters takes up to four times its size
    for at in range(0, end, ENCODING_PIECE_BYTES):
        decoder.decode(data[at : min(at + ENCODING_PIECE_BYTES, end)], final=at + ENCODING_PIECE_BYTES >= end)
    return data, name


def _is_utf8(name: str) -> bool:
    """Whether an encoding is UTF-8, under any of its names."""
    return codecs.lookup(name).name in ("utf-8", "utf-8-sig")


def _candidates(data: bytes) -> tuple[str, ...]:
    certain = shown(data[:ENCODING_SAMPLE_BYTES])
    return (certain,) if certain else ("utf-8", "cp1252", "latin-1")
