"""Whole measured flank traces, and the plain-text groundwork that every input file shares.

A trace is what a gear measuring machine writes for one flank: the deviation at each roll length.
"""

from __future__ import annotations

import difflib
import io
import itertools
import math
import stat
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, cast

from gearpoly.errors import InputFileError, shown
from gearpoly.files.paths import look
from gearpoly.files.paths import unreadable as unreadable
from gearpoly.units import UM, FloatArray, read_only

Flank = Literal["drive", "coast"]

FILE_LIMIT_BYTES = 64 * 2**20
"""Largest pair or trace file that is read, so that a mistaken file name cannot fill the memory."""

DEVIATION_LIMIT_UM = 1e4
"""Largest flank deviation in um; beyond 10 mm a unit was mistaken."""

COMPARED_NAME_LIMIT = 100
"""Characters of a name that are compared with known ones, the longest of which has 44: a comparison takes time as the
square of the length."""

shorten = shown

TRACE_LINE_LIMIT = 10_000
"""Characters of a line of a trace file; four cells have fewer than 100, and a line without end would be cut into cells
of 60 bytes each."""

TRACE_COLUMNS = ("tooth", "flank", "roll_length_mm", "deviation_um")


@dataclass(frozen=True, kw_only=True, eq=False)
class Trace:
    """The measured deviation along one flank of one tooth.

    ``tooth`` counts from 0 in the order of meshing. ``roll_length`` (n,) in mm is ``sqrt(r^2 -
    r_b^2)``, strictly rising; ``deviation`` (n,) in mm is normal to the flank, positive = more
    material. Both arrays are read-only.
    """

    tooth: int
    flank: Flank
    roll_length: FloatArray
    deviation: FloatArray


def check_file(file: Path, *, limit_bytes: int) -> None:
    """Raise ``InputFileError`` unless ``file`` is there, is a file on a disk and is not above the limit (before it is
    opened).
    """
    status = look(file)
    if status is None:
        wish = "want the path of a file that exists"
        raise InputFileError(file, found="no such file", wish=wish)
    if stat.S_ISDIR(status.st_mode):
        raise InputFileError(file, found="a folder", wish="want a file")
    if not stat.S_ISREG(status.st_mode):
        # Nobody knows how much a pipe or a device will give, or when.
        raise InputFileError(file, found="a pipe or a device", wish="want a file on a disk; write it to one first")
    if status.st_size > limit_bytes:
        raise too_large(file, limit_bytes)


def too_large(file: Path, limit_bytes: int) -> InputFileError:
    """The error for a file that would fill the memory."""
    limit = f"{limit_bytes / 2**20:.0f} MB" if limit_bytes < 2**30 else f"{limit_bytes / 2**30:.0f} GB"
    return InputFileError(
        file,
        found=f"larger than {limit}",
        wish=f"want at most {limit}; split it, or check the file name",
    )


def not_utf8(file: Path) -> InputFileError:
    """The error for a file that is not UTF-8 text, naming the first line that is not."""
    wish = "want text in UTF-8 (save it again with that encoding)"
    with file.open("rb") as stream:
        for number, line in enumerate(stream, start=1):
            try:
                line.decode("utf-8")
            except UnicodeDecodeError as error:
                found = f"byte 0x{line[error.start]:02x}, which is not UTF-8"
                return InputFileError(file, where=f"line {number}", found=found, wish=wish)
    return InputFileError(file, found="not UTF-8 text", wish=wish)


def read_text(file: Path, *, limit_bytes: int = FILE_LIMIT_BYTES) -> str:
    """The text of a small UTF-8 file, with or without byte order mark, line ends as they are.

    Raises ``InputFileError`` where the file is missing, a folder, too large, unreadable or not
    UTF-8.
    """
    check_file(file, limit_bytes=limit_bytes)
    try:
        with file.open("rb") as stream:
            data = stream.read(limit_bytes + 1)  # a file may grow, so the size is checked again
    except OSError as error:
        raise unreadable(file, error) from None
    if len(data) > limit_bytes:
        raise too_large(file, limit_bytes)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise not_utf8(file) from None


def nearest(name: str, known: Iterable[str], *, cutoff: float = 0.0) -> str | None:
    """The known name most like ``name`` whatever its case, or ``None`` where none reaches the
    cutoff (0..1). Of a long name its first ``COMPARED_NAME_LIMIT`` characters are compared.
    """
    by_lower = {key.lower(): key for key in known}
    close = difflib.get_close_matches(name[:COMPARED_NAME_LIMIT].lower(), by_lower, n=1, cutoff=cutoff)
    return by_lower[close[0]] if close else None


def split_row(line: str) -> list[str]:
    """The cells of one comma-separated line without blanks and quotes around them (no cell of ours
    holds a comma).
    """
    return [cell.strip().strip('"').strip() for cell in line.split(",")]


def check_header(file: Path, where: str, names: Sequence[str], known: Sequence[str]) -> None:
    """Raise ``InputFileError`` at the first column name that is empty, unknown or doubled."""
    known_list = ", ".join(known)
    if len(names) == 1:
        for separator, called in ((";", "semicolons"), ("\t", "tabs")):
            if separator in names[0]:
                wish = "want commas between cells and decimal points in numbers"
                raise InputFileError(file, where=where, found=f"columns separated by {called}", wish=wish)
    for i, name in enumerate(names):
        if not name:
            wish = f"want a name for every column, of {known_list}"
            raise InputFileError(file, where=where, found=f"column {i + 1} has no name", wish=wish)
        if name not in known:
            if parse_number(name) is not None:
                wish = f"want a header row first, with columns of {known_list}"
                raise InputFileError(file, where=where, found=f'the number "{name}" for a column name', wish=wish)
            close = nearest(name, known, cutoff=0.6)  # a unit or a word more; others are another column
            near = f'the nearest known column is "{close}"; ' if close else ""
            wish = f"{near}want columns of {known_list}"
            raise InputFileError(file, where=where, found=f'unknown column "{shown(name)}"', wish=wish)
        if name in names[:i]:
            found = f'"{name}" is the name of columns {names.index(name) + 1} and {i + 1}'
            wish = "want each name once; rename one of the two, or take it out"
            raise InputFileError(file, where=where, found=found, wish=wish)


def parse_number(cell: str) -> float | None:
    """The number in a cell (``nan`` and ``inf`` too), or ``None``; ``1_000`` is Python's, not a
    table's.
    """
    try:
        return float(cell) if cell.isascii() and "_" not in cell else None
    except ValueError:
        return None


def read_traces(path: Path | str, teeth: int) -> tuple[Trace, ...]:
    """Read the measured flank traces of one gear with ``teeth`` teeth.

    A CSV with the columns ``tooth, flank, roll_length_mm, deviation_um`` in any order and its rows
    in any order. Gives the traces by tooth, drive before coast; flanks that nobody measured are
    absent. Raises ``InputFileError`` with the line.
    """
    file = Path(path)
    lines = io.StringIO(read_text(file), newline=None)
    columns: dict[str, int] = {}
    points: dict[tuple[int, str], list[tuple[float, float, int]]] = {}
    for number, line in enumerate(lines, start=1):
        where = f"line {number}"
        if not line.strip() or (not columns and line.lstrip().startswith("#")):
            continue
        if len(line) > TRACE_LINE_LIMIT:
            wish = f"want lines of at most {TRACE_LINE_LIMIT} characters"
            raise InputFileError(file, where=where, found=f"{len(line)} characters", wish=wish)
        cells = split_row(line)
        if not columns:
            check_header(file, where, cells, TRACE_COLUMNS)
            columns = {name: i for i, name in enumerate(cells)}
            for name in TRACE_COLUMNS:
                if name not in columns:
                    wish = f"want the columns {', '.join(TRACE_COLUMNS)}"
                    raise InputFileError(file, where=where, found=f'no column "{name}"', wish=wish)
            continue
        if len(cells) != len(columns):
            wish = f"want {len(columns)}, as in the header"
            raise InputFileError(file, where=where, found=f"{len(cells)} cells", wish=wish)
        row = {name: cells[i] for name, i in columns.items()}
        tooth = _tooth(file, where, row["tooth"], teeth)
        if row["flank"] not in ("drive", "coast"):
            raise _bad_cell(file, where, "flank", row["flank"], "drive or coast")
        length = _number(file, where, "roll_length_mm", row["roll_length_mm"])
        if length < 0.0:
            raise _bad_cell(
                file,
                where,
                "roll_length_mm",
                row["roll_length_mm"],
                "a length from the base circle, 0 or more",
            )
        deviation = _number(file, where, "deviation_um", row["deviation_um"])
        if abs(deviation) > DEVIATION_LIMIT_UM:
            span = f"a deviation in um, -{DEVIATION_LIMIT_UM:.0f} to {DEVIATION_LIMIT_UM:.0f}"
            raise _bad_cell(file, where, "deviation_um", row["deviation_um"], span)
        points.setdefault((tooth, row["flank"]), []).append((length, deviation, number))
    if not points:
        found = "no rows under the header" if columns else "an empty file"
        raise InputFileError(file, found=found, wish=f"want rows of {', '.join(TRACE_COLUMNS)}")
    order = sorted(points, key=lambda key: (key[0], key[1] != "drive"))
    return tuple(_trace(file, tooth, flank, points[tooth, flank]) for tooth, flank in order)


def _trace(file: Path, tooth: int, flank: str, points: list[tuple[float, float, int]]) -> Trace:
    points.sort()
    if len(points) < 2:
        found = f"one point on tooth {tooth}, {flank} flank"
        raise InputFileError(
            file,
            where=f"line {points[0][2]}",
            found=found,
            wish="want at least 2 points on a flank",
        )
    for (length, _, first), (following, _, second) in itertools.pairwise(points):
        if length == following:
            place = f"tooth {tooth}, {flank} flank"
            found = f"roll_length_mm {length} of {place}, as in line {min(first, second)}"
            wish = "want each roll length once on a flank"
            raise InputFileError(file, where=f"line {max(first, second)}", found=found, wish=wish)
    return Trace(
        tooth=tooth,
        flank=cast(Flank, flank),
        roll_length=read_only([point[0] for point in points]),
        deviation=read_only([point[1] * UM for point in points]),
    )


def _bad_cell(file: Path, where: str, column: str, cell: str, want: str) -> InputFileError:
    found = f'"{shown(cell)}"' if cell else "an empty cell"
    return InputFileError(file, where=f"{where}, column {column}", found=found, wish=f"want {want}")


def _number(file: Path, where: str, column: str, cell: str) -> float:
    value = parse_number(cell)
    if value is None or not math.isfinite(value):
        raise _bad_cell(file, where, column, cell, "a finite number with a decimal point")
    return value


def _tooth(file: Path, where: str, cell: str, teeth: int) -> int:
    if not (cell.isascii() and cell.isdigit()) or len(cell) > 9 or int(cell) >= teeth:
        raise _bad_cell(file, where, "tooth", cell, f"a tooth number from 0 to {teeth - 1}")
    return int(cell)
