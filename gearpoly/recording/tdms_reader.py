"""Recordings as TDMS (LabVIEW): one channel per column, all in one group, the keys as properties of group or file.

Channels under other names, or in other groups, are offered to a map by their paths, with the times of their waveforms.
A channel of time stamps is the time. Where there is none, and none is called ``time_s``, the waveform properties
``wf_start_time``, ``wf_start_offset`` and ``wf_increment`` give the time, of each channel by itself: channels that
begin apart or run at rates of their own are brought to common times.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.groups import own_group
from gearpoly.recording.reader import (
    Reader,
    check_few,
    check_held,
    damage_reported,
    is_key,
    numbers,
    offered,
    optional,
    since_first,
    take_key,
)
from gearpoly.recording.recording import COLUMNS
from gearpoly.recording.sources import put_on_one_axis
from gearpoly.recording.stated_units import UNIT_NAMES, check_unit
from gearpoly.recording.table import Channel, Table
from gearpoly.units import FloatArray

SAME_TIME = 1e-6
"""s. Times that differ by no more are one: npTDMS gives time stamps in whole microseconds."""


def read_table(file: Path) -> Table:
    """The columns and keys of one TDMS file."""
    nptdms = optional(file, "nptdms", extra="tdms")
    # The stream is opened here, since npTDMS leaves it open where the file is damaged.
    with (
        _quiet(nptdms),
        damage_reported(file, "TDMS"),
        file.open("rb") as stream,
        nptdms.TdmsFile.open(stream) as source,
    ):
        groups = {group.name: {channel.name: channel for channel in group.channels()} for group in source.groups()}
        check_few(file, "", sum(len(held) for held in groups.values()), "channels")
        where = own_group(groups)
        table = Table(columns={}, keys={})
        _take_keys(file, source, where, table.keys)
        columns, others = _parted(groups, where, table.remarks)
        left = [path for path, channel in others.items() if not _is_series(channel)]
        _check_columns(file, columns)
        every = {**columns, **{path: channel for path, channel in others.items() if path not in left}}
        read = offered(file, {name: len(channel) for name, channel in every.items()}, columns, table.remarks)
        _check_sizes(file, {name: every[name] for name in read})
        values = {name: _values(file, name, every[name], own=name in columns) for name in read}
        properties = {name: every[name].properties for name in read}
        if source.file_status.incomplete_final_segment:
            _take_what_is_there(file, properties, values, table.remarks)
        table.columns = {name: values[name] for name in columns}
        table.paths = {f"{channel.group_name}/{channel.name}": name for name, channel in columns.items()}
        mine = {name: properties[name] for name in columns}
        times = _times(file, mine, {name: values[name] for name in read if name not in columns}, properties)
        for name in read:
            if name not in columns:
                leaf = every[name].name
                unit = "s" if _is_stamps(every[name]) else _unit(every[name])
                table.others[name] = Channel(values=values[name], unit=unit, time=times.get(name), leaf=leaf)
        _take_times(file, mine, table)
        check_held(file, "" if where is None else f"group {where}", table, left)
    return table


def _take_keys(file: Path, source: Any, where: str | None, keys: dict[str, object]) -> None:
    """The keys among the properties of the file and of the group with the columns."""
    holders = [("file", source.properties)]
    if where is not None:
        holders.append((f"group {where}", source[where].properties))
    for holder, properties in holders:
        check_few(file, f"properties of {holder}", len(properties), "properties")
        for name, value in properties.items():
            if is_key(file, f"properties of {holder}", name, own=where is not None):
                take_key(file, f"properties of {holder}", name, value, keys)


def _parted(
    groups: Mapping[str, Mapping[str, Any]], where: str | None, remarks: list[str]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The channels of the columns in the group ``where`` by the columns' names, and all others by their paths; the only
    channel of time stamps is ``time_s`` where none is called so."""
    columns = {name: channel for name, channel in groups.get(where or "", {}).items() if name in COLUMNS}
    paths = {f"{group}/{name}": channel for group, held in groups.items() for name, channel in held.items()}
    looked = {path: one for path, one in paths.items() if where is None or path == f"{where}/{one.name}"}
    stamps = [path for path, channel in looked.items() if _is_stamps(channel)]
    if len(stamps) == 1 and not any(one.name == "time_s" for one in looked.values()):
        columns["time_s"] = paths[stamps[0]]
        remarks.append(f"time_s from the time stamps in {shorten(paths[stamps[0]].name)}")
    taken = {id(channel) for channel in columns.values()}
    return columns, {path: channel for path, channel in paths.items() if id(channel) not in taken}


def _is_stamps(channel: Any) -> bool:
    return bool(np.dtype(channel.dtype).kind == "M")


def _is_series(channel: Any) -> bool:
    """Whether a channel holds numbers or time stamps, and more than one."""
    return np.dtype(channel.dtype).kind in "iufbM" and len(channel) > 1


def _unit(channel: Any) -> str:
    """The unit that a channel states, or nothing."""
    return str(next((channel.properties[key] for key in UNIT_NAMES if key in channel.properties), ""))


def _values(file: Path, name: str, channel: Any, *, own: bool) -> FloatArray:
    """The numbers (n,) of a channel; of a column (``own``) they are finite."""
    if own:
        check_unit(file, name, "" if _is_stamps(channel) else _unit(channel))
        return numbers(file, name, np.asarray(channel[:]))
    held = np.asarray(channel[:])
    return since_first(held) if held.dtype.kind == "M" else np.ascontiguousarray(held, dtype=np.float64)


def _take_what_is_there(
    file: Path, properties: Mapping[str, Mapping[str, Any]], values: dict[str, FloatArray], remarks: list[str]
) -> None:
    """Keep of a file that was cut off what every channel holds of those with the same times."""
    own: dict[tuple[object, ...], list[str]] = {}
    for name, held in properties.items():
        times = (str(held.get("wf_start_time")), held.get("wf_start_offset"), held.get("wf_increment"))
        own.setdefault(times, []).append(name)
    least = min((one.size for one in values.values()), default=0)
    if least == 0:
        found = "a cut-off TDMS file (a channel holds nothing)"
        raise InputFileError(file, found=found, wish="want the whole file; copy or export it again")
    for names in own.values():
        short = min(values[name].size for name in names)
        values.update({name: values[name][:short] for name in names})
    remarks.append(f"the file is cut off in its last segment; it was read as far as it goes, {least} samples")


def _times(
    file: Path,
    mine: Mapping[str, Mapping[str, Any]],
    others: Mapping[str, FloatArray],
    properties: Mapping[str, Mapping[str, Any]],
) -> dict[str, FloatArray]:
    """The times of ``others`` by their waveforms, on the axis of the columns (``mine``); none where a channel is the
    time, or a waveform states none."""
    if "time_s" in mine:
        return {}
    stamps = {name: held.get("wf_start_time") for name, held in properties.items()}
    stamped = {
        name: stamp for name, stamp in stamps.items() if isinstance(stamp, np.datetime64) and not np.isnat(stamp)
    }
    zero = min((stamped[name] for name in mine if name in stamped), default=min(stamped.values(), default=None))
    out: dict[str, FloatArray] = {}
    made: dict[tuple[float, float, int], FloatArray] = {}
    for name, values in others.items():
        step = _seconds(file, name, properties[name], "wf_increment") or 0.0
        if step <= 0.0 or (zero is not None and name not in stamped):
            continue
        start = _seconds(file, name, properties[name], "wf_start_offset") or 0.0
        if zero is not None:
            start += float((stamped[name] - zero) / np.timedelta64(1, "us")) * 1e-6
        same = (start, step, values.size)
        if same not in made:
            made[same] = start + step * np.arange(values.size, dtype=np.float64)
        out[name] = made[same]
    return out


@contextmanager
def _quiet(nptdms: Any) -> Iterator[None]:
    """Keep npTDMS from writing its warnings, and bytes of the file, to the terminal; damage is told by this reader."""
    manager = nptdms.log.log_manager
    level = manager.log_level
    manager.set_level(logging.CRITICAL)
    try:
        yield
    finally:
        manager.set_level(level)


def _check_columns(file: Path, columns: Mapping[str, Any]) -> None:
    """Refuse columns that are no plain numbers."""
    for name, channel in columns.items():
        dtype = np.dtype(channel.dtype)
        if dtype.kind not in "iufb" and not (name == "time_s" and dtype.kind == "M"):
            raise InputFileError(
                file, where=f"column {name}", found=f"values of type {dtype}", wish="want plain numbers"
            )


def _check_sizes(file: Path, channels: Mapping[str, Any]) -> None:
    """Refuse what the file cannot hold: TDMS packs nothing, so its numbers take no less room than the file."""
    stated = sum(len(channel) * (channel.data_type.size or 0) for channel in channels.values())
    if stated > file.stat().st_size:
        found = f"a cut-off or damaged TDMS file ({stated} bytes of numbers in {file.stat().st_size})"
        raise InputFileError(file, found=found, wish="want the whole file; copy or export it again")


def _take_times(file: Path, properties: Mapping[str, Mapping[str, Any]], table: Table) -> None:
    """Put columns that were read at different times on one axis, and add ``time_s`` where no channel is it."""
    if not table.columns:
        return
    if "time_s" in table.columns:
        stamped = {name: held for name, held in properties.items() if "wf_start_time" in held}
        begins = _begins(file, stamped or properties)
        if max(begins.values()) - min(begins.values()) > SAME_TIME:
            late = max(begins, key=lambda name: begins[name])
            found = f"{late} begins {begins[late] - min(begins.values()):.6g} s after another channel (wf_start_time)"
            wish = "want channels that begin together beside time_s; leave time_s out to have the waveform times used"
            raise InputFileError(file, found=found, wish=wish)
        return
    begins = _begins(file, properties)
    steps = {name: _seconds(file, name, held, "wf_increment") for name, held in properties.items()}
    offsets = {name: _seconds(file, name, held, "wf_start_offset") or 0.0 for name, held in properties.items()}
    starts = {name: begins[name] + offset for name, offset in offsets.items()}
    apart = max(starts.values()) - min(starts.values()) > SAME_TIME
    if not apart and not any(steps.values()):
        return
    if lacking := next((name for name, step in steps.items() if not step or step < 0.0), None):
        found = f"{lacking} has no wf_increment above 0, and others have, or begin at another time"
        raise InputFileError(file, found=found, wish="want wf_increment in s for every channel, or a channel time_s")
    rates = {float(step) for step in steps.values() if step}
    even: dict[str, FloatArray] = {
        name: starts[name] + float(steps[name] or 0.0) * np.arange(values.size, dtype=np.float64)
        for name, values in table.columns.items()
    }
    if not apart and len(rates) == 1:
        table.columns["time_s"] = max(even.values(), key=lambda time: time.size)
        table.remarks.append(f"time_s from the waveform properties: {1.0 / rates.pop():.12g} samples per second")
        return
    put_on_one_axis(file, table, even)


def _begins(file: Path, properties: Mapping[str, Mapping[str, Any]]) -> dict[str, float]:
    """When each channel begins, in s after the first of them; 0 where none says so."""
    stamps = {name: held.get("wf_start_time") for name, held in properties.items()}
    if all(stamp is None for stamp in stamps.values()):
        return dict.fromkeys(stamps, 0.0)
    for name, stamp in stamps.items():
        if not isinstance(stamp, np.datetime64) or np.isnat(stamp):
            found = f"wf_start_time {'missing' if stamp is None else shorten(str(stamp))}, which others have"
            raise InputFileError(file, where=f"channel {name}", found=found, wish="want a time stamp for every channel")
    microseconds = {name: int(np.datetime64(stamp, "us").astype(np.int64)) for name, stamp in stamps.items()}
    first = min(microseconds.values())
    return {name: 1e-6 * (stamp - first) for name, stamp in microseconds.items()}


def _seconds(file: Path, name: str, properties: Mapping[str, Any], key: str) -> float | None:
    """A waveform property in s, or nothing where it is not there."""
    value = properties.get(key)
    if value is None:
        return None
    number = float(value) if isinstance(value, int | float | np.number) else math.nan
    if not math.isfinite(number):
        raise InputFileError(file, where=f"channel {name}", found=f"{key} {shorten(str(value))}", wish="want seconds")
    return number


READER = Reader(
    name="TDMS",
    endings=(".tdms",),
    recognises=lambda head: head.startswith(b"TDSm"),
    read=read_table,
    module="nptdms",
    extra="tdms",
)
