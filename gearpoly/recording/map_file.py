"""A map: the few lines that say what an owner's file holds, where its names and units do not.

The format is TOML; docs/reference/recordings.md has its keys. A map is read and checked before the recording it is for.
"""

from __future__ import annotations

import codecs
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gearpoly.errors import InputFileError, shown_value
from gearpoly.files.toml import parse
from gearpoly.files.traces import nearest, read_text, shorten
from gearpoly.recording.map_lines import TEETH_RATIO
from gearpoly.recording.quantities import DOUBTFUL, Unit, column_unit, known_units, unit_written, units_written
from gearpoly.recording.recording import ANGLE_COLUMNS, COLUMNS, KEYS, check_key
from gearpoly.recording.table import MAPPED_AXIS, PULSE_TIMES
from gearpoly.recording.text.cells import APOSTROPHES, BLANKS
from gearpoly.recording.text.fixed_width import WIDTH_LIMIT
from gearpoly.recording.text.stamps import DATE_ORDERS
from gearpoly.recording.text.writing import Writing

MAP_LIMIT_BYTES = 2**20
"""Largest map; one of every column has 4 kB."""

TOP = ("section", "leave_out", "text", "keys", "columns")
TEXT = (
    "encoding",
    "separator",
    "decimal",
    "thousands",
    "dates",
    "header_line",
    "units_line",
    "missing",
    "torn_lines",
    "widths",
)
COLUMN = ("from", "unit", "scale", "sign", "zero", "wraps", "jumps")

JUMPS = ("taken out", "kept")

LINES_LIMIT = 10_000_000
"""Largest number of a line or of a recording."""


@dataclass(frozen=True, kw_only=True)
class Source:
    """Where a column comes from: ``channel`` names it in the file.

    Its numbers, after ``wraps`` (the number at which they begin again) are undone, times ``scale`` are in ``unit``;
    ``sign`` is -1 where they count the other way. ``zero`` is the number at which the quantity is 0. ``unit`` is
    ``None`` where that of the file holds. ``jumps`` says what is done with those of a clock that was set.
    """

    channel: str
    unit: Unit | None = None
    scale: float = 1.0
    sign: int = 1
    zero: float | None = None
    wraps: float | None = None
    jumps: str = ""


@dataclass(frozen=True, kw_only=True)
class RecordingMap:
    """What the map ``file`` says: the ``section`` of the recording (from 1; ``None``: all of them), how a text file is
    written, ``keys`` of the contract, the ``columns`` by their contract's names, and channels to ``leave_out``."""

    file: Path
    section: int | None = None
    writing: Writing = field(default_factory=Writing)
    keys: Mapping[str, object] = field(default_factory=dict)
    columns: Mapping[str, Source] = field(default_factory=dict)
    leave_out: tuple[str, ...] = ()


def read_map(path: Path | str) -> RecordingMap:
    """Read and check a map. Raises ``InputFileError`` with the key, its value and what would do."""
    file = Path(path)
    raw = parse(file, read_text(file, limit_bytes=MAP_LIMIT_BYTES))
    _known(file, "", raw, TOP)
    tables = {name: _table(file, name, raw.get(name, {})) for name in ("text", "keys", "columns")}
    left = raw.get("leave_out", [])
    if not isinstance(left, list) or not all(isinstance(one, str) for one in left):
        raise _fault(file, "leave_out", left, 'a list of names, such as ["Winkel Tisch"]')
    columns = {}
    for name, inside in tables["columns"].items():
        if name not in (*COLUMNS, *MAPPED_AXIS, *PULSE_TIMES):
            wish = f'the nearest known column is "{nearest(name, COLUMNS)}" (known: {", ".join(COLUMNS)})'
            raise InputFileError(file, where=f"columns.{shorten(name)}", found="unknown column", wish=wish)
        columns[name] = _source(file, name, _table(file, f"columns.{name}", inside))
    keys = dict(tables["keys"])
    for key, value in keys.items():
        if key not in KEYS:
            wish = f'the nearest known key is "{nearest(key, KEYS)}" (known: {", ".join(KEYS)})'
            raise InputFileError(file, where=f"keys.{shorten(key)}", found="unknown key", wish=wish)
        check_key(file, f"keys.{key}", key, value)
    _check_stated_once(file, keys, columns)
    section = _whole(file, "section", raw["section"]) if "section" in raw else None
    return RecordingMap(
        file=file,
        section=section,
        writing=_writing(file, tables["text"]),
        keys=keys,
        columns=columns,
        leave_out=tuple(left),
    )


def _check_stated_once(file: Path, keys: Mapping[str, object], columns: Mapping[str, Source]) -> None:
    """Raise where a zero or a direction is stated of a column and as a key."""
    for name, one in columns.items():
        shaft = name.partition("_")[0]
        for key, stated, says in (
            (f"{shaft}_zero_deg", one.zero is not None, "zero"),
            (f"{shaft}_direction", one.sign != 1, "sign"),
        ):
            if name in ANGLE_COLUMNS and stated and key in keys:
                wish = f"want one of the two: leave out {says} in [columns.{name}], or {key} in [keys]"
                found = f"{says} of {name}, and {key} too"
                raise InputFileError(file, where=f"columns.{name}.{says}", found=found, wish=wish)


def _source(file: Path, column: str, raw: Mapping[str, object]) -> Source:
    where = f"columns.{column}"
    _known(file, where, raw, COLUMN)
    channel = raw.get("from")
    if not isinstance(channel, str) or not channel.strip():
        if "from" not in raw:
            wish = 'want from = "the name or path of the column in the file" (gearpoly read lists them)'
            raise InputFileError(file, where=f"{where}.from", found="missing", wish=wish)
        raise _fault(file, f"{where}.from", channel, 'the name or path of a column, in quotes: from = "Winkel [°]"')
    unit = None
    wanted = column_unit(column)
    if "unit" in raw:
        unit = _unit(file, f"{where}.unit", raw["unit"], wanted)
    numbers = {}
    for key in ("scale", "zero", "wraps", "sign"):
        if key in raw:
            numbers[key] = _number(file, f"{where}.{key}", raw[key])
    if numbers.get("scale", 1.0) <= 0.0:
        raise _fault(
            file, f"{where}.scale", raw["scale"], f"a number above 0 (sign = -1 turns it round): times it {wanted.name}"
        )
    if numbers.get("wraps", 1.0) <= 0.0:
        raise _fault(file, f"{where}.wraps", raw["wraps"], "the number at which the readings begin again, above 0")
    if numbers.get("sign", 1.0) not in (1.0, -1.0):
        raise _fault(file, f"{where}.sign", raw["sign"], "1, or -1 where the numbers count the other way")
    jumps = raw.get("jumps", "")
    if jumps != "" and not (column == "time_s" and jumps in JUMPS):
        wish = " or ".join(f'"{one}"' for one in JUMPS) if column == "time_s" else "jumps for time_s alone"
        raise _fault(file, f"{where}.jumps", jumps, wish)
    return Source(
        channel=channel,
        unit=unit,
        scale=numbers.get("scale", 1.0),
        sign=int(numbers.get("sign", 1.0)),
        zero=numbers.get("zero"),
        wraps=numbers.get("wraps"),
        jumps=str(jumps),
    )


def _unit(file: Path, where: str, value: object, wanted: Unit) -> Unit:
    if isinstance(value, str) and (unit := unit_written(value, wanted.dimension)) is not None:
        return unit
    known = known_units(wanted.dimension)
    if isinstance(value, str) and value.strip().lower() in DOUBTFUL:
        raise _fault(file, where, value, f"{' or '.join(DOUBTFUL[value.strip().lower()])}, since it may mean both")
    others = units_written(value) if isinstance(value, str) else ()
    if others:
        found = f"{shown_value(value)}, a unit of {others[0].dimension}"
        raise InputFileError(file, where=where, found=found, wish=f"want a unit of {wanted.dimension}: {known}")
    raise _fault(file, where, value, f"a unit of {wanted.dimension}: {known}")


def _writing(file: Path, raw: Mapping[str, object]) -> Writing:
    _known(file, "text", raw, TEXT)
    marks = {"separator": '";", ",", "\\t", "|" or " "', "decimal": '"," or "."', "thousands": '".", ",", " " or "\'"'}
    able = {"separator": ";,\t| ", "decimal": ",.", "thousands": f".,{BLANKS}{APOSTROPHES}"}
    for key, wish in marks.items():
        value = raw.get(key, "")
        if value != "" and (not isinstance(value, str) or len(value) != 1 or value not in able[key]):
            raise _fault(file, f"text.{key}", value, wish)
    if raw.get("decimal") and raw.get("decimal") == raw.get("thousands"):
        raise _fault(file, "text.thousands", raw["thousands"], "another mark than the decimal one")
    if raw.get("thousands") and not raw.get("decimal"):
        raise InputFileError(
            file, where="text.decimal", found="missing beside thousands", wish='want decimal = "," or "."'
        )
    dates = raw.get("dates", "")
    if dates != "" and not (isinstance(dates, str) and dates in DATE_ORDERS):
        raise _fault(file, "text.dates", dates, " or ".join(f'"{one}"' for one in DATE_ORDERS))
    encoding = raw.get("encoding", "")
    if encoding != "":
        try:
            good = isinstance(encoding, str) and len(encoding) < 40 and "x".encode(codecs.lookup(encoding).name) != b""
        except (LookupError, ValueError):
            good = False
        if not good:
            raise _fault(file, "text.encoding", encoding, '"utf-8", "utf-16", "cp1252" or another that Python knows')
    lines = {key: _whole(file, f"text.{key}", raw[key]) for key in ("header_line", "units_line") if key in raw}
    if "units_line" in lines and "header_line" not in lines:
        wish = "want header_line, the line of the names, beside it"
        raise InputFileError(file, where="text.header_line", found="missing beside units_line", wish=wish)
    missing = raw.get("missing", [])
    if not isinstance(missing, list) or not all(isinstance(one, str) and one.strip() for one in missing):
        raise _fault(file, "text.missing", missing, 'a list of cells without a reading, as text: ["OVERLOAD", "-9999"]')
    torn = raw.get("torn_lines", "")
    if torn not in ("", "left out"):
        raise _fault(file, "text.torn_lines", torn, '"left out", or no such line to have them told')
    widths = raw.get("widths", [])
    whole = isinstance(widths, list) and all(type(one) is int and 0 < one <= WIDTH_LIMIT for one in widths)
    if not isinstance(widths, list) or not whole or len(widths) == 1:
        raise _fault(file, "text.widths", widths, "the width of every column in characters, from the left: [8, 8, 10]")
    if widths and raw.get("separator"):
        wish = "want one of the two: cells have widths, or something parts them"
        raise InputFileError(file, where="text.widths", found="widths, and separator too", wish=wish)
    held: dict[str, Any] = {key: str(raw[key]) for key in (*TEXT[:5], "torn_lines") if key in raw}
    held["widths"] = tuple(widths)
    held["missing"] = tuple(one.strip() for one in missing)
    return Writing(**(held | lines))


def _known(file: Path, where: str, raw: Mapping[str, object], known: tuple[str, ...]) -> None:
    for key in raw:
        if key not in known:
            place = f"{where}.{shorten(key)}" if where else shorten(key)
            wish = f'the nearest known key here is "{nearest(key, known)}" (known: {", ".join(known)})'
            raise InputFileError(file, where=place, found="unknown key", wish=wish)


def _table(file: Path, where: str, value: object) -> Mapping[str, object]:
    if not isinstance(value, dict):
        raise _fault(file, where, value, f"a table: [{where}] on a line of its own")
    return value


def _number(file: Path, where: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e300:
        if value == TEETH_RATIO:
            raise _fault(
                file, where, value, "that as a number: the driven teeth by the driving ones, 25 / 18 is 1.3889"
            )
        raise _fault(file, where, value, "a finite number with a decimal point")
    return float(value)


def _whole(file: Path, where: str, value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= LINES_LIMIT:
        raise _fault(file, where, value, "a whole number, counted from 1")
    return value


def _fault(file: Path, where: str, value: object, wish: str) -> InputFileError:
    return InputFileError(file, where=where, found=shown_value(value), wish=f"want {wish}")
