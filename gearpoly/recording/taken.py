"""From an owner's table to the contract's: channels are taken for columns by their names and units, or by a map.

What is sure is taken, and said. Where something a comparison needs is not sure nothing is guessed: one message names
the lines of a map that settle it.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import nearest, shorten
from gearpoly.recording.asked import SETTLE, angles_known, ask, wish_for
from gearpoly.recording.map_file import RecordingMap, Source
from gearpoly.recording.mapped import put, stated_unit, take_mapped
from gearpoly.recording.meaning import meanings
from gearpoly.recording.meant import Meaning
from gearpoly.recording.quantities import in_another_unit
from gearpoly.recording.reader import NAME_CUTOFF, check_finite
from gearpoly.recording.recording import ANGLE_COLUMNS, COLUMNS, PASSED_OVER, TE_COLUMNS
from gearpoly.recording.sources import put_on_one_axis
from gearpoly.recording.table import AXIS_CORRECTION, AXIS_ERROR, WORM_ANGLE, Channel, Table
from gearpoly.units import FloatArray

SAME_SPEED = 0.01
"""Relative. A speed display is as true, and speeds of the two shafts differ by a tooth or more, unless they are one."""


def only(file: Path, tables: Sequence[Table]) -> Table:
    """The one recording of a file; ``InputFileError`` where there are more."""
    if len(tables) > 1:
        wish = "want one of them: section = 1 in a map, taken by --map"
        raise InputFileError(file, found=f"{len(tables)} recordings", wish=wish)
    return tables[0]


def taken(file: Path, table: Table, chart: RecordingMap | None = None) -> Table:
    """The table with the contract's columns alone: those of the map ``chart``, then what names and units make sure.

    Raises ``InputFileError`` of the recording where something is in doubt, with the lines that settle it, and of the
    map where it names what is not there.
    """
    if table.doubts:
        first = table.doubts[0]
        raise InputFileError(file, found=first.says, wish=wish_for(first.ask))
    if not table.others and chart is None and (table.unread is None or angles_known(table.columns)):
        return table
    out, found = assigned(file, table, chart)
    _check_names(file, table, [one.channel for one in found if one.channel not in out.taken_from.values()])
    ask(file, found, out, table.others)
    return out


def assigned(file: Path, table: Table, chart: RecordingMap | None = None) -> tuple[Table, list[Meaning]]:
    """The columns as :func:`taken` has them, whatever else is in doubt, and what all channels mean that no map names.

    Raises ``InputFileError`` of the map where it names what is not there.
    """
    keys = {**table.keys, **(chart.keys if chart is not None else {})}
    out = Table(columns=dict(table.columns), keys=keys, remarks=list(table.remarks), places=dict(table.places))
    out.taken_from = {name: name for name in table.columns}
    out.unread, out.worm_period_s = table.unread, table.worm_period_s
    times: dict[str, FloatArray] = {}
    used = take_mapped(table, out, times, chart) if chart is not None else set()
    held = _beside(table, out, used)
    found = meanings(held)
    _by_meaning(held, found, out, times)
    found = _confirmed(held, found, out, times)
    _say_left(found, out)
    by_channel = {column for column, name in out.taken_from.items() if column != name or name in table.others}
    _on_one_axis(file, out, times, mapped=by_channel)
    for name, channel in out.taken_from.items():
        if channel in table.others and name in out.columns:
            check_finite(file, name, out.columns[name])
    if AXIS_ERROR not in out.columns:  # a worm in another machine
        for name in (WORM_ANGLE, AXIS_CORRECTION):
            out.columns.pop(name, None)
    return out, found


def _check_names(file: Path, table: Table, left: Iterable[str]) -> None:
    """Raise ``InputFileError`` where a channel beside the contract's columns, ``left`` for nothing, is called nearly as
    one of them."""
    if not {*table.columns, *(one.leaf or name for name, one in table.others.items())} & set(COLUMNS) - {"time_s"}:
        return
    for name in left:
        one = table.others[name]
        own = one.leaf or name
        close = "" if own in COLUMNS else nearest(own, COLUMNS, cutoff=NAME_CUTOFF)
        if close and not in_another_unit(stated_unit(name, one), close):
            wish = f'the nearest known column is "{close}"; rename it, or give or leave it out in a map ({SETTLE})'
            raise InputFileError(file, found=f'unknown column "{shorten(own)}"', wish=wish)


def _beside(table: Table, out: Table, used: set[str]) -> dict[str, Channel]:
    """The channels that names and units may still give a column: none of another recording than the one whose columns
    are taken, and none that was read at other times which nobody states."""
    groups = {
        one.group(name)
        for name, one in table.others.items()
        if one.leaf in (*ANGLE_COLUMNS, *TE_COLUMNS) and not one.number
    }
    # So is a group with a channel that is called as one that the map takes from another group.
    mapped = {table.others[name].leaf for name in used if name in table.others and table.others[name].group(name)}
    groups |= {one.group(name) for name, one in table.others.items() if one.leaf in mapped and not one.number}
    chosen = {table.others[name].group(name) for name in used if name in table.others}
    sizes = {values.size for values in out.columns.values()}
    held = {}
    for name, one in table.others.items():
        if name in used:
            continue
        of_another = not one.number and one.group(name) in groups - chosen and (chosen & groups or out.columns)
        if of_another or (one.time is None and len(sizes) == 1 and one.values.size not in sizes):
            out.remarks.append(
                f"{shorten(name)} not read: it is of {'another recording' if of_another else 'another length'}"
            )
        else:
            held[name] = one
    return held


def _confirmed(
    held: Mapping[str, Channel], found: list[Meaning], out: Table, times: dict[str, FloatArray]
) -> list[Meaning]:
    """The meanings with a speed settled that is the driving shaft's by its readings, and taken as that."""
    time, angle = out.columns.get("time_s"), out.columns.get("driving_angle_deg")
    other = out.columns.get("driven_angle_deg")
    if time is None or angle is None or "speed_rpm" in out.columns or times:
        return found
    for k, one in enumerate(found):
        if one.column != "speed_rpm" or not one.doubt or one.unit is None or not one.named:
            continue
        read = float(np.nanmedian(held[one.channel].values)) * one.unit.size
        driving, driven = (abs(_speed_rpm(time, a)) if a is not None else math.nan for a in (angle, other))
        if abs(read / driving - 1.0) < SAME_SPEED and not abs(read / driven - 1.0) < SAME_SPEED:
            sure = replace(one, doubt="", ask=(), why=f"{one.why}, and the driving shaft's by its readings")
            _by_meaning(held, [sure], out, times)
            return [*found[:k], sure, *found[k + 1 :]]
    return found


def _speed_rpm(time: FloatArray, angle: FloatArray) -> float:
    """The usual speed in rpm of a shaft with readings (n,) in deg, wrapped or not."""
    good = np.isfinite(time) & np.isfinite(angle)
    step, pause = np.diff(np.unwrap(angle[good], period=360.0)), np.diff(time[good])
    moving = (pause > 0.0) & (step != 0.0)
    return float(np.median(step[moving] / pause[moving])) / 6.0 if moving.any() else math.nan


def _by_meaning(
    held: Mapping[str, Channel], found: Iterable[Meaning], out: Table, times: dict[str, FloatArray]
) -> None:
    """Take what is sure."""
    for one in found:
        if not one.column or one.doubt or one.column in out.columns or one.unit is None:
            continue
        put(out, times, one.column, held[one.channel], Source(channel=one.channel, unit=one.unit))
        if one.channel != one.column:
            out.remarks.append(f'"{shorten(one.channel)}" taken for {one.column}: {one.why}')


def _say_left(found: Iterable[Meaning], out: Table) -> None:
    """Say which channels were left out, and why where it might have been another way."""
    left = [one for one in found if one.channel not in out.columns and (not one.column or one.doubt)]
    plain = [shorten(one.channel) for one in left if not one.column and one.channel not in PASSED_OVER]
    if plain:
        out.remarks.append(f"not read, since no columns of a recording: {shorten(', '.join(plain), width=200)}")
    for one in left:
        if one.channel in PASSED_OVER:
            out.remarks.append(f"{one.channel} passed over: it belongs to a simulation")
        elif one.column:
            out.remarks.append(f'"{shorten(one.channel)}" not read: {one.doubt}; in a map, if so: {" ".join(one.ask)}')


def _on_one_axis(file: Path, out: Table, times: Mapping[str, FloatArray], *, mapped: Collection[str]) -> None:
    """Bring columns that the format read at times of their own to common times; its own ``time_s`` is on their axis."""
    if not times or "time_s" in mapped:
        return
    own = out.columns.pop("time_s", None)
    if own is not None:
        times = {**dict.fromkeys(out.columns, own), **times}
    if len(times) < len(out.columns):
        lacking = next(name for name in out.columns if name not in times)
        wish = "want columns that all have times, or one that is time_s"
        raise InputFileError(file, where=f"column {lacking}", found="no times, which others have", wish=wish)
    first = next(iter(times.values()))
    if all(one.size == first.size and np.array_equal(one, first) for one in times.values()):
        out.columns["time_s"] = first
        return
    put_on_one_axis(file, out, times)
