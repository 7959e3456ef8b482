"""Recordings as universal files: one data set 58 (text or binary, "58b") per column.

ID line 1 of a data set is the column's name. Keys stand in ID lines 2 to 5, as ``key = value``, several separated by
semicolons, in any of the data sets. The abscissa, where it is time, is ``time_s`` unless a column of that name is
there. The format keeps abscissas to six digits in text and their start and step to six digits everywhere, so a column
``time_s`` is better.

This reader stands on its own, since pyuff 2.5.8 does not stand its round trip (docs/explanation/libraries.md says what
fails): it drops a data set that is cut off without a word, takes bytes of binary numbers for the end of a set, and does
not look at the stated number of values. Here the stated sizes decide, and what is not there is an error.
"""

from __future__ import annotations

import math
import mmap
import re
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten, unreadable
from gearpoly.recording.deeds import in_full
from gearpoly.recording.reader import (
    RECORDING_LIMIT_BYTES,
    Reader,
    check_few,
    check_held,
    check_numbers,
    is_key,
    numbers,
    take_key,
    text_value,
)
from gearpoly.recording.recording import COLUMNS
from gearpoly.recording.sources import put_on_one_axis
from gearpoly.recording.stated_units import check_unit
from gearpoly.recording.table import Channel, Table, told_apart
from gearpoly.units import FloatArray

UFF58_START_PATTERN = re.compile(rb"\s*-1[ ]*\r?\n[ ]*\d+[ ]*(b|\r?\n|[ ]+\r?\n)")
UFF58_END_PATTERN = re.compile(rb"\r?\n?[ ]{0,4}-1[ ]*(\r?\n|$)")
UFF58_LINE_LIMIT_BYTES = 200
"""Longest header line, in bytes; the format has 80."""
UFF58_TIME_ABSCISSA = 17
"""Abscissa type that is time."""
_WHOLE = "want the whole file; copy or export it again"


@dataclass(frozen=True)
class _Set:
    """One data set 58 as its header states it; its values begin at byte ``at``."""

    name: str
    id_lines: tuple[str, ...]
    at: int
    count: int
    single: bool
    even: bool
    start: float
    step: float
    is_time: bool
    unit: str
    binary: str
    """Byte order of binary values, or nothing for text."""


def read_table(file: Path) -> Table:
    """The columns and keys of one universal file."""
    try:
        with file.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
            return _read(file, data)
    except OSError as error:
        raise unreadable(file, error) from None


def _read(file: Path, data: mmap.mmap) -> Table:
    table = Table(columns={}, keys={})
    found: list[tuple[FloatArray, FloatArray | None, _Set]] = []
    at = number = 0
    while data[at : at + 4096].strip():
        where = f"data set {number + 1}"
        line, after = _line(file, where, data, at)
        if not line.strip():
            at = after
            continue
        number += 1
        if line.strip() != b"-1":
            standing = f"`{shorten(line.decode('latin-1').strip())}`"
            raise InputFileError(file, where=where, found=standing, wish="want a data set, which begins with -1")
        kind, _ = _line(file, where, data, after)
        if kind[:6].strip() != b"58":
            at = _skip(file, where, data, after)
            continue
        found_set = _header(file, where, data, after)
        for text in found_set.id_lines:
            _take_keys(file, where, text, table.keys)
        check_numbers(file, sum(held[2].count for held in found) + found_set.count)
        ordinate, abscissa, at = _values(file, where, data, found_set)
        found.append((ordinate, abscissa, found_set))
        check_few(file, "", len(found), "data sets")
    values = dict(zip(told_apart([one.name for _, _, one in found]), found, strict=True))
    wanted = [name for name in values if name in COLUMNS]
    for name in wanted:
        check_unit(file, name, values[name][2].unit)
        table.columns[name] = numbers(file, name, values[name][0])
    if wanted and "time_s" not in wanted:
        _add_time(file, {name: values[name] for name in wanted}, table)
    for number, (name, (ordinate, abscissa, one)) in enumerate(values.items(), start=1):
        if name not in wanted:
            time = _axis(file, name, abscissa, one) if one.is_time and "time_s" not in wanted else None
            leaf = one.name if one.name != name else ""
            table.others[name] = Channel(values=ordinate, unit=one.unit.strip(), time=time, leaf=leaf, number=number)
    check_held(file, "ID lines 1", table, ())
    return table


def _line(file: Path, where: str, data: mmap.mmap, at: int) -> tuple[bytes, int]:
    """One header line without its end, and where the next begins."""
    end = data.find(b"\n", at, at + UFF58_LINE_LIMIT_BYTES)
    if end < 0 and len(data) - at > UFF58_LINE_LIMIT_BYTES:
        raise InputFileError(
            file, where=where, found=f"a line of more than {UFF58_LINE_LIMIT_BYTES} bytes", wish=_WHOLE
        )
    end = len(data) if end < 0 else end
    return data[at:end].rstrip(b"\r"), end + 1


def _skip(file: Path, where: str, data: mmap.mmap, at: int) -> int:
    """Where the data set after one that is not ours begins."""
    end = re.compile(rb"^[ ]{0,4}-1[ ]*\r?$", re.MULTILINE).search(data, at)
    if end is None:
        raise InputFileError(file, where=where, found="a cut-off file (the data set has no end)", wish=_WHOLE)
    return end.end() + 1


def _header(file: Path, where: str, data: mmap.mmap, at: int) -> _Set:
    lines = []
    for _ in range(12):
        line, at = _line(file, where, data, at)
        lines.append(line.decode("utf-8", errors="replace").ljust(80))
    try:
        form = lines[7]
        kind, count, even = int(form[:10]), int(form[10:20]), int(form[20:30])
        start, step = float(form[30:43]), float(form[43:56])
        is_time, unit = int(lines[8][:10]) == UFF58_TIME_ABSCISSA, lines[9][47:67]
        binary = {"1": "<", "2": ">"}[lines[0][7:13].strip()] if lines[0][6:7].lower() == "b" else ""
        if binary and lines[0][13:19].strip() not in ("", "0", "2"):
            raise ValueError("its numbers are not IEEE 754")
    except (ValueError, KeyError) as error:
        cut = at > len(data)
        found = "a cut-off header" if cut else f"a header that cannot be read ({shorten(str(error))})"
        raise InputFileError(file, where=where, found=found, wish=_WHOLE) from None
    if kind not in (2, 4):
        raise InputFileError(file, where=where, found=f"ordinates of type {kind}", wish="want real numbers (2 or 4)")
    if count < 0:
        raise InputFileError(file, where=where, found=f"{count} values", wish=_WHOLE)
    if even == 1 and not (math.isfinite(start) and math.isfinite(step)):
        found = f"abscissas from {in_full(start)} by {in_full(step)}"
        raise InputFileError(file, where=where, found=found, wish="want finite numbers in line 7 of its header")
    ids = tuple(line.strip() for line in lines[1:6])
    return _Set(ids[0], ids[1:], at, count, kind == 2, even == 1, start, step, is_time, unit, binary)


def _values(file: Path, where: str, data: mmap.mmap, held: _Set) -> tuple[FloatArray, FloatArray | None, int]:
    """Ordinates and, where they are stored, abscissas; and where the next data set begins."""
    width = held.count * (1 if held.even else 2)
    if held.binary:
        dtype = np.dtype(held.binary + ("f4" if held.single else "f8"))
        stop = held.at + width * dtype.itemsize
        if stop > len(data):
            found = f"a cut-off file ({max(0, len(data) - held.at)} bytes of {width * dtype.itemsize} are there)"
            raise InputFileError(file, where=f"{where}, {held.name}", found=found, wish=_WHOLE)
        flat = np.frombuffer(data[held.at : stop], dtype=dtype).astype(np.float64)
        end = UFF58_END_PATTERN.match(data[stop : stop + 100])
        if end is None:
            found = f"no end after the {held.count} values that the header states"
            wish = "want the whole file, with values of the stated precision; export it again, in double precision"
            raise InputFileError(file, where=f"{where}, {held.name}", found=found, wish=wish)
        after = stop + end.end()
    else:
        after = _skip(file, f"{where}, {held.name}", data, held.at)
        stop = data.rfind(b"-1", held.at, after)
        if (stop - held.at) > RECORDING_LIMIT_BYTES or width > stop - held.at:
            found = f"{stop - held.at} bytes of text for {width} numbers"
            raise InputFileError(file, where=f"{where}, {held.name}", found=found, wish=_WHOLE)
        flat = _text_values(file, f"{where}, {held.name}", data[held.at : stop], held, width)
    if held.even:
        return flat, None, after
    return flat[1::2], flat[0::2], after


def _text_values(file: Path, where: str, text: bytes, held: _Set, width: int) -> FloatArray:
    """The first ``width`` numbers of a text; some programs fill the last line up with zeros."""
    plain = text.replace(b"D", b"E")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)  # numpy's word for text that is no number
            flat: FloatArray = np.asarray(np.fromstring(plain.decode("ascii", "replace"), sep=" "), dtype=np.float64)
    except (ValueError, DeprecationWarning):
        flat = np.empty(0, dtype=np.float64)
    if flat.size < width or flat.size > width + 6:
        flat = _fixed_width(file, where, plain, held)
    if flat.size < width:
        found = f"{flat.size // (1 if held.even else 2)} of {held.count} values"
        raise InputFileError(file, where=where, found=f"a cut-off file ({found})", wish=_WHOLE)
    return flat[:width]


def _fixed_width(file: Path, where: str, text: bytes, held: _Set) -> FloatArray:
    """The numbers by columns of the line, as the format has them: large ones may touch."""
    widths = [13] * 6 if held.single else [20] * 4 if held.even else [13, 20] * 2
    found = []
    for line in text.decode("ascii", errors="replace").splitlines():
        at = 0
        for width in widths:
            cell = line[at : at + width].strip()
            at += width
            if cell:
                try:
                    found.append(float(cell))
                except ValueError:
                    wish = "want numbers in the format's columns"
                    raise InputFileError(file, where=where, found=f'"{shorten(cell)}"', wish=wish) from None
    return np.array(found, dtype=np.float64)


def _take_keys(file: Path, where: str, text: str, keys: dict[str, object]) -> None:
    """The keys in one ID line."""
    for part in text.split(";"):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if equals and is_key(file, where, name):
            take_key(file, where, name, text_value(value), keys)


def _add_time(file: Path, held: dict[str, tuple[FloatArray, FloatArray | None, _Set]], table: Table) -> None:
    """Time in s from the abscissas, where they are time; columns that were read at other times are put on one axis."""
    axes = {name: _axis(file, name, abscissa, one) for name, (_, abscissa, one) in held.items()}
    stated = {name: axis for name, axis in axes.items() if axis is not None}
    if not stated:
        return
    times = [axis for name, axis in stated.items() if held[name][2].is_time]
    first = next(iter(stated.values()))
    if all(np.array_equal(axis[: first.size], first[: axis.size]) for axis in stated.values()):
        if times:
            one = next(one for _, _, one in held.values() if one.is_time)
            digits = "" if one.binary and not one.even else ", which the format keeps to 6 digits"
            table.columns["time_s"] = times[0].copy()
            table.remarks.append(f"time_s from the abscissas{digits}")
        return
    if len(times) < len(axes):
        wish = "want columns sampled together, abscissas in s (type 17) for all of them, or a column time_s"
        raise InputFileError(file, found="abscissas that differ from column to column", wish=wish)
    for name, axis in stated.items():
        if (back := np.flatnonzero(np.diff(axis) <= 0.0)).size:
            found = f"value {back[0] + 2} at {in_full(axis[back[0] + 1])} s, not after the one before"
            raise InputFileError(file, where=f"column {name}", found=found, wish="want times that rise")
    put_on_one_axis(file, table, stated)


def _axis(file: Path, name: str, abscissa: FloatArray | None, one: _Set) -> FloatArray | None:
    """Where a data set's values were taken, or nothing where it does not say."""
    if abscissa is None:
        if not one.step:
            return None
        with np.errstate(over="ignore"):
            abscissa = one.start + one.step * np.arange(one.count, dtype=np.float64)
    bad = ~np.isfinite(abscissa)
    if bad.any():
        row = int(np.argmax(bad))
        found = f"abscissa {in_full(abscissa[row])} of value {row + 1}"
        raise InputFileError(file, where=f"column {name}", found=found, wish="want a finite number for each value")
    return abscissa


READER = Reader(
    name="UFF58",
    endings=(".uff", ".unv", ".ufb", ".bunv", ".uff58"),
    recognises=lambda head: UFF58_START_PATTERN.match(head) is not None,
    read=read_table,
)
