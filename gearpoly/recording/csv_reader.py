"""Recordings as CSV: comment lines with the condition, a header row, numbers.

The numbers of a large file go through pyarrow's parser, where it is installed, those of others through numpy's. Only
where that stops (an empty cell, a word, a short row) a slow pass in Python reads them again, which either understands
them or names the line.
"""

from __future__ import annotations

import contextlib
import io
import itertools
import math
import re
from array import array
from pathlib import Path
from typing import TextIO

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import (
    check_file,
    check_header,
    nearest,
    not_utf8,
    parse_number,
    shorten,
    split_row,
    unreadable,
)
from gearpoly.recording.comments import read_comment, said_radial
from gearpoly.recording.header import header_unit
from gearpoly.recording.quantities import TIME, in_another_unit
from gearpoly.recording.reader import (
    NAME_CUTOFF,
    RECORDING_LIMIT_BYTES,
    Reader,
    check_few,
    pass_over,
    recording_from_table,
)
from gearpoly.recording.recording import COLUMNS, PASSED_OVER, Recording, check_complete
from gearpoly.recording.table import Table
from gearpoly.recording.taken import only, taken
from gearpoly.recording.text.broken_off import FirstBytes, end_of_rows
from gearpoly.recording.text.encoding import shown
from gearpoly.recording.text.foreign import read_foreign
from gearpoly.recording.text.missing import closes, no_reading
from gearpoly.recording.text.parsed import parsed
from gearpoly.recording.text.writing import Writing
from gearpoly.recording.words import quantity_of
from gearpoly.units import FloatArray

CSV_LINE_LIMIT_BYTES = 2**20
"""Longest line in bytes, far beyond any row of a recording; a file without line ends must not be taken in as one line,
each cell of which takes 60 bytes.
"""

BYTES_TO_LINE_END = 4096
"""Bytes in which rows of a recording have a line end."""


def read_csv(path: Path | str) -> Recording:
    """Read one recording.

    Empty cells and ``nan`` are drop-outs. Raises ``InputFileError`` with the line (from 1) and
    column at fault.
    """
    file = Path(path)
    return recording_from_table(file, taken(file, only(file, read_tables(file, Writing()))))


def read_tables(file: Path, writing: Writing, *, mapped: bool = False) -> list[Table]:
    """The recordings of a text file: the contract's own CSV by its plain path, any other as its logger wrote it.

    A file whose header has the contract's names is held to its rules, unless all that differs is how it is written, and
    columns under names unlike any of the contract, or that a map may say more of (``mapped``).
    Raises ``InputFileError`` with the line at fault.
    """
    if writing != Writing():
        return read_foreign(file, writing)
    if not _is_own(file):
        _check_lines(file)
        return read_foreign(file, writing)
    try:
        return [read_table(file)]
    except InputFileError as fault:
        try:
            tables = read_foreign(file, writing, footer=False)
            for table in tables if not mapped else ():
                _check_names(file, table)
        except InputFileError:
            raise fault from None
        if any(table.doubts for table in tables):
            raise
        return tables


def _check_names(file: Path, table: Table) -> None:
    """Raise ``InputFileError`` where names of a table are nearly the contract's, or all are and do not suffice."""
    known = (*COLUMNS, *PASSED_OVER)
    # A time with a unit, or of time stamps, is one under any name.
    held = {name: one for name, one in table.others.items() if not (one.unit and quantity_of(name) == TIME)}
    names = [one.leaf or name for name, one in held.items()]
    units = {one.leaf or name: one.unit or header_unit(one.leaf or name)[1] for name, one in held.items()}
    others = [name for name in names if name not in known]
    for name in others:
        if re.fullmatch(r"column \d+", name):
            if np.array_equal(np.diff(table.others[name].values), np.ones(table.others[name].values.size - 1)):
                continue  # the numbers of the rows, as pandas writes them
            raise InputFileError(file, found=f"{name} has no name", wish="want a name for every column")
        if (close := nearest(name, known, cutoff=NAME_CUTOFF)) and not in_another_unit(units[name], close):
            raise InputFileError(file, found=f'unknown column "{shorten(name)}"', wish=f'the nearest is "{close}"')
    if not others:
        check_complete(file, "", names)


def _is_own(file: Path) -> bool:
    """Whether the header of a file, in UTF-8 and with commas, has a name of the contract; so has one without header,
    whose faults are told by the contract's rules."""
    check_file(file, limit_bytes=RECORDING_LIMIT_BYTES)
    try:
        with file.open(encoding="utf-8-sig", errors="replace") as stream:
            while line := stream.readline(CSV_LINE_LIMIT_BYTES):
                if "\0" in line:
                    return False
                if line.strip() and not line.lstrip().startswith("#"):
                    names = split_row(line)
                    return len(line) >= CSV_LINE_LIMIT_BYTES or any(name in COLUMNS for name in names)
    except OSError as error:
        raise unreadable(file, error) from None
    return True


def read_table(file: Path) -> Table:
    """The columns and keys of one file with the contract's own header."""
    check_file(file, limit_bytes=RECORDING_LIMIT_BYTES)
    try:
        with file.open("rb") as start:
            if b"\0" in start.read(4096):
                wish = "want a CSV file in UTF-8 (other formats need their own file name ending)"
                raise InputFileError(file, found="not a text file", wish=wish)
        _check_lines(file)
        end, broken = end_of_rows(file)
        with _opened(file, end) as stream:
            keys, names, head_lines = _read_head(file, stream)
            # A file that is read to its end needs no look of Python at each piece of it: a fifth less time.
            with io.BufferedReader(FirstBytes(file, end)) if broken else contextlib.nullcontext(file) as whole:
                columns = parsed(whole, lines_above=head_lines, columns=len(names), size=end)
            if columns is None:
                columns = list(_read_numbers(file, names, head_lines, stream, end=end).T)
    except UnicodeDecodeError:
        raise not_utf8(file) from None
    except OSError as error:
        raise unreadable(file, error) from None
    table = Table(columns=dict(zip(names, columns, strict=True)), keys=keys, remarks=[broken] if broken else [])
    with file.open(encoding="utf-8-sig") as stream:
        table.remarks += said_radial(itertools.islice(stream, head_lines - 1))
    pass_over(table)
    return table


def _opened(file: Path, end: int) -> TextIO:
    """The text of a file up to so many bytes."""
    return io.TextIOWrapper(io.BufferedReader(FirstBytes(file, end)), encoding="utf-8-sig")


def _check_lines(file: Path) -> None:
    """Raise ``InputFileError`` where a line is longer than the limit; one of twice the limit is found for certain."""
    with file.open("rb", buffering=0) as stream:
        for at in range(0, file.stat().st_size - CSV_LINE_LIMIT_BYTES + 1, CSV_LINE_LIMIT_BYTES):
            stream.seek(at)
            # A line end among the first bytes of a block saves reading the rest of it.
            if not _ends_line(stream.read(BYTES_TO_LINE_END)) and not _ends_line(
                stream.read(CSV_LINE_LIMIT_BYTES - BYTES_TO_LINE_END)
            ):
                found = f"no line end from byte {at} to {at + CSV_LINE_LIMIT_BYTES}"
                raise InputFileError(
                    file, found=found, wish=f"want lines of at most {CSV_LINE_LIMIT_BYTES} bytes, one for each row"
                )


def _ends_line(part: bytes) -> bool:
    return b"\n" in part or b"\r" in part


def _read_head(file: Path, stream: TextIO) -> tuple[dict[str, object], list[str], int]:
    """The stated keys, the column names and the number of lines up to the header, leaving
    ``stream`` at the data.
    """
    keys: dict[str, object] = {}
    places: dict[str, str] = {}
    number = stated = 0
    while line := stream.readline(CSV_LINE_LIMIT_BYTES):
        number += 1
        where = f"line {number}"
        if len(line) >= CSV_LINE_LIMIT_BYTES:
            raise InputFileError(
                file,
                where=where,
                found=f"more than {CSV_LINE_LIMIT_BYTES} characters",
                wish="want a CSV file with lines",
            )
        if line.lstrip().startswith("#"):
            stated += "=" in line
            check_few(file, where, stated, "comment lines with =")
            read_comment(file, where, line.strip()[1:].strip(), keys, places)
        elif line.strip():
            names = split_row(line)
            check_header(file, where, names, (*COLUMNS, *PASSED_OVER))
            check_complete(file, where, names)
            return keys, names, number
    found = "an empty file" if number == 0 else "no header row"
    raise InputFileError(
        file,
        found=found,
        wish="want a header row with driving_angle_deg, driven_angle_deg, then numbers",
    )


def _read_numbers(file: Path, names: list[str], head_lines: int, stream: TextIO, *, end: int) -> FloatArray:
    """The table (n, columns) under the header up to so many bytes of the file; ``nan`` where a cell is empty."""
    start = next((line for line in stream if line.strip()), None)
    if start is None:
        raise InputFileError(
            file,
            where=f"line {head_lines}",
            found="no rows under the header",
            wish="want rows of numbers",
        )
    rows = itertools.chain([start], stream)
    try:
        table = np.loadtxt(rows, delimiter=",", comments=None, quotechar='"', ndmin=2, dtype=np.float64)
    except UnicodeDecodeError:
        raise
    except ValueError:
        table = None
    if table is not None and table.shape[1] == len(names) and not np.isinf(table).any():
        return np.asarray(table, dtype=np.float64)
    with _opened(file, end) as again:
        return _read_slowly(file, names, head_lines, again)


def _read_slowly(file: Path, names: list[str], head_lines: int, stream: TextIO) -> FloatArray:
    """The same table cell by cell, or the ``InputFileError`` that names the line."""
    values = array("d")
    for number, line in enumerate(stream, start=1):
        if number <= head_lines or not line.strip():
            continue
        try:
            row = [float(cell) if (cell := part.strip()) else math.nan for part in line.split(",")]
        except ValueError:
            row = []
        plain = "_" not in line and line.isascii()  # float() takes 1_000 and foreign digits too
        if len(row) != len(names) or not plain or math.inf in row or -math.inf in row:
            row = _read_row(file, names, number, line)
        values.extend(row)
    return np.frombuffer(values, dtype=np.float64).reshape(-1, len(names))


def _read_row(file: Path, names: list[str], number: int, line: str) -> list[float]:
    """One row with empty cells or quotes, or the ``InputFileError`` for what is wrong with it."""
    where = f"line {number}"
    # Only the last line can lack its end, and it does where a logger was stopped while it wrote.
    cut = "" if line.endswith("\n") else "; the last line looks cut off, delete it"
    if line.lstrip().startswith("#"):
        wish = "want comment lines before the header row only"
        raise InputFileError(file, where=where, found=f"the comment `{shorten(line.strip())}`", wish=wish)
    cells = split_row(line)
    if len(cells) != len(names):
        comma = ", and decimal points, not commas, or semicolons between the cells" if len(cells) > len(names) else ""
        wish = f"want {len(names)}, as in the header{comma}{cut or '; delete the line if it is no row'}"
        raise InputFileError(file, where=where, found=f"{len(cells)} cells", wish=wish)
    row = []
    for name, cell in zip(names, cells, strict=True):
        value = parse_number(cell) if cell else math.nan
        if value is None or math.isinf(value):
            cure = "; delete the line if it is no row" if closes(cells) else no_reading(cell)
            wish = f"want a finite number (an empty cell or nan for a drop-out){cure}{cut}"
            raise InputFileError(file, where=f"{where}, column {name}", found=f'"{shorten(cell)}"', wish=wish)
        row.append(value)
    return row


def _recognises(head: bytes) -> bool:
    """Whether it may be text, of one or two bytes a character."""
    return b"\0" not in head or bool(shown(head))


READER = Reader(
    name="CSV",
    endings=(".csv", ".txt", ".log"),
    recognises=_recognises,
    read=read_table,
    fallback=True,
    several=read_tables,
)
