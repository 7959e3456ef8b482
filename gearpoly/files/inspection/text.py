"""Text of measuring machines and spreadsheets, in whatever encoding they write."""

from __future__ import annotations

from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.traces import FILE_LIMIT_BYTES, check_file, unreadable


def any_text(file: Path) -> str:
    """The text of ``file`` in UTF-8, UTF-16 with its mark, or else Windows' western encoding.

    Raises ``InputFileError`` where the file is missing, too large, or holds null bytes.
    """
    check_file(file, limit_bytes=FILE_LIMIT_BYTES)
    try:
        data = file.read_bytes()[: FILE_LIMIT_BYTES + 1]
    except OSError as error:
        raise unreadable(file, error) from None
    codes = ["utf-16"] if data[:2] in (b"\xff\xfe", b"\xfe\xff") else ["utf-8-sig", "cp1252", "latin-1"]
    for code in codes:
        try:
            text = data.decode(code)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise InputFileError(file, found="no text", wish="want a text file; export the sheet as text or CSV")
