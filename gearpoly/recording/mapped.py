"""What a map says of a recording's columns, done to the channels that it names."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import nearest, shorten
from gearpoly.recording.agreement import rounding
from gearpoly.recording.by_readings import are_whole_turns, contradicting, counter_modulus, since_1970
from gearpoly.recording.counters import from_the_index
from gearpoly.recording.header import header_unit
from gearpoly.recording.map_file import RecordingMap, Source
from gearpoly.recording.map_lines import OF_COUNTERS, entry, quoted
from gearpoly.recording.quantities import COUNT, UNITS, Unit, column_unit, unit_written
from gearpoly.recording.recording import ANGLE_COLUMNS
from gearpoly.recording.table import Channel, Table
from gearpoly.units import FloatArray

SLIP = 0.75
"""Likeness (difflib, 0..1) from which a name in a map is one of the file misspelt: two letters exchanged in six give
0.83, and "angle in" is to "angle away" 0.67."""


def take_mapped(table: Table, out: Table, times: dict[str, FloatArray], chart: RecordingMap) -> set[str]:
    """Take what the map says; the names of the channels that need no other meaning."""
    channels = {**{name: Channel(values=values) for name, values in table.columns.items()}, **table.others}
    used = {find(channels, name, chart, "leave_out", paths=table.paths) for name in chart.leave_out}
    sources = {
        column: (find(channels, source.channel, chart, f"columns.{column}.from", paths=table.paths), source)
        for column, source in chart.columns.items()
    }
    _check_once(chart, used, sources)
    for name in {*used, *(name for name, _ in sources.values()), *sources}:
        out.columns.pop(name, None)
        out.taken_from.pop(name, None)
    for column, (name, source) in sources.items():
        used.add(name)
        one, wanted = channels[name], column_unit(column)
        unit = source.unit or _unit(chart, column, name, one, own=name in table.columns)
        if column in ANGLE_COLUMNS and source.wraps is None:
            _check_unit(chart, column, one, source, unit)
        put(out, times, column, one, replace(source, channel=name, unit=unit))
        out.mapped.add(column)
        out.remarks.append(f'"{shorten(name)}" taken for {column}: the map says so')
        if column in ANGLE_COLUMNS:
            shaft = column.partition("_")[0]
            if source.sign < 0:
                out.keys[f"{shaft}_direction"] = -1
            if source.zero is not None:
                out.keys[f"{shaft}_zero_deg"] = source.zero * source.scale * unit.size / wanted.size
    return used


def _check_once(chart: RecordingMap, left: set[str], sources: Mapping[str, tuple[str, Source]]) -> None:
    """Raise ``InputFileError`` of the map where it names one channel for two columns, or for one and to be left out."""
    given = dict.fromkeys(left, "leave_out")
    for column, (name, _) in sources.items():
        if name in given:
            where, before = f"columns.{column}.from", given[name]
            found = f'"{shorten(name)}", which {before} has too'
            wish = f"want a channel in one place: take it out of {before}, or name another one here"
            raise InputFileError(chart.file, where=where, found=found, wish=wish)
        given[name] = f"columns.{column}"


def _unit(chart: RecordingMap, column: str, name: str, one: Channel, *, own: bool) -> Unit:
    """The unit of a channel of which the map states none: the file's, or that of its ``own`` name of the contract."""
    wanted = column_unit(column)
    stated = stated_unit(name, one)
    unit = unit_written(stated, wanted.dimension)
    called = one.leaf if one.number and one.leaf else name
    if own or called == column:
        unit = column_unit(called) if column_unit(called).dimension == wanted.dimension else None
    elif not stated and wanted.dimension == COUNT:
        unit = wanted
    if unit is None:
        found = f'"{shorten(name)}" states {f"the unit {shorten(stated)}" if stated else "no unit"}'
        wish = f'want its unit of {wanted.dimension}: unit = "{wanted.name}"'
        raise InputFileError(chart.file, where=f"columns.{column}.unit", found=found, wish=wish)
    return unit


def _check_unit(chart: RecordingMap, column: str, one: Channel, source: Source, unit: Unit) -> None:
    """Raise ``InputFileError`` of the map where readings begin again after one turn in another unit than its own."""
    modulus = counter_modulus(one.values)
    if modulus is not None and not are_whole_turns(modulus * source.scale * unit.size):
        found = f"{unit.name}, and the readings are counts that begin again after {modulus}"
        wish = f'want wraps = {modulus}, and scale: what a count is of a {unit.name}; unit = "rev" and scale = '
        width = f"1 / (counts of a turn), as {modulus} may be no more than the counter's width"
        wish += width if modulus in OF_COUNTERS else f"{1.0 / modulus!r} if that is one turn"
        raise InputFileError(chart.file, where=f"columns.{column}", found=found, wish=wish)
    values = one.values * source.scale
    other = contradicting(values, unit)
    if other is not None:
        found = f"{unit.name}, and the readings begin again after one turn as in {other.name}"
        wish = f'want unit = "{other.name}", or wraps, the number at which they begin again'
        raise InputFileError(chart.file, where=f"columns.{column}.unit", found=found, wish=wish)


def find(
    channels: Mapping[str, Channel], name: str, chart: RecordingMap, where: str, *, paths: Mapping[str, str]
) -> str:
    """The channel that a map calls ``name``: its whole name or path, that without its unit, or its number ("column 3");
    ``paths`` are those of columns in a file of groups.

    Raises ``InputFileError`` of the map where there is none, or more than one.
    """
    if name in channels:
        return name
    if (path := name.lstrip("/")) in paths or path in channels:
        return paths.get(path, path)
    bare = [
        path
        for path, one in channels.items()
        if name in (header_unit(path)[0], one.leaf or path.rpartition("/")[2], header_unit(one.leaf)[0])
    ]
    bare += [column for path, column in paths.items() if re.split(r"[/.]", path)[-1] == name and column not in bare]
    if len(bare) == 1:
        return bare[0]
    number = name.removeprefix("column ")
    if name.startswith("column ") and number.isascii() and number.isdigit() and len(number) < 6:
        numbers = {one.number or k: path for k, (path, one) in enumerate(channels.items(), start=1)}
        if int(number) in numbers:
            return numbers[int(number)]
    called = {column: path for path, column in paths.items() if not path.endswith(column)}
    there = shorten(", ".join(called.get(one, one) for one in channels), width=200)
    close = nearest(name, [*channels, *paths], cutoff=SLIP)
    found = f'"{shorten(name)}" is no column of the recording'
    if len(bare) > 1:
        found = f'"{shorten(name)}" is the name of {len(bare)} columns'
        wish = f"want one of them: {shorten(', '.join(quoted(one) for one in bare), width=200)}"
        raise InputFileError(chart.file, where=where, found=found, wish=wish)
    wish = f"want one of: {there}" if close is None else f'the nearest is "{shorten(close)}" (there are: {there})'
    raise InputFileError(chart.file, where=where, found=found, wish=wish)


def put(out: Table, times: dict[str, FloatArray], column: str, one: Channel, source: Source) -> None:
    """Put a channel's numbers, as its source says, into ``out`` under the column's name and in its unit."""
    unit = source.unit or UNITS[COUNT]["1"]
    factor = source.scale * unit.size / column_unit(column).size
    values = one.values
    if source.wraps is not None:
        values = values.copy()
        once = source.wraps * factor < 540.0 and are_whole_turns(source.wraps * factor)
        if column in ANGLE_COLUMNS and once:  # as a counter does that the index sets to 0
            values = from_the_index(quoted(shorten(source.channel)), values, source.wraps, out.remarks)
        read = np.isfinite(values)
        values[read] = np.unwrap(values[read], period=source.wraps)
    if column == "time_s" and (counted := since_1970(values)) is not None and counted.size == factor:
        values = values - values[np.isfinite(values)][0]  # small, so that no digit is lost where it is used
        out.remarks.append(f'"{shorten(source.channel)}" counts from long ago, and is taken from its first reading on')
    if column not in ANGLE_COLUMNS:  # an angle's zero and direction are keys, so that readings stay the encoder's own
        values = values - source.zero if source.zero else values
        factor *= source.sign
    if factor != 1.0:
        out.places[column] = abs(factor) * float(np.nanmax(rounding(one.values), initial=0.0))
        with np.errstate(over="ignore", invalid="ignore"):
            values = values * factor
    if values is one.values:  # which may be read again: a recording takes over the numbers it gets, unless sealed
        values.setflags(write=False)
    if column == "time_s":
        out.jumps = source.jumps
    more = {"scale": (source.scale, 1.0), "zero": (source.zero, None), "wraps": (source.wraps, None)}
    said = [f"{key} = {held!r}" for key, (held, default) in more.items() if held != default]
    out.entries[column] = entry(column, source.channel, unit, *said, *(["sign = -1"] if source.sign < 0 else []))
    out.units[column] = unit
    out.columns[column] = values
    out.taken_from[column] = source.channel
    if one.time is not None:
        times[column] = one.time


def stated_unit(name: str, one: Channel) -> str:
    """The unit that a channel states, in its own place or in its name."""
    return one.unit or header_unit(one.leaf or name)[1]
