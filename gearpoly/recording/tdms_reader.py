"""Recordings as TDMS (LabVIEW): one channel per column, all in one group, the keys as properties of group or file.

A channel of time stamps is the time. Where there is none, and none is called ``time_s``, the waveform properties
``wf_start_time``, ``wf_start_offset`` and ``wf_increment`` give the time, of each channel by itself: channels that
begin apart or run at rates of their own are brought to common times.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.reader import (
    Reader,
    check_few,
    check_numbers,
    damage_reported,
    is_key,
    numbers,
    optional,
    take_key,
    wanted_columns,
)
from gearpoly.recording.recording import COLUMNS
from gearpoly.recording.sources import put_on_one_axis
from gearpoly.recording.stated_units import UNIT_NAMES, check_unit
from gearpoly.recording.table import Table
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
        group = _group(file, source.groups())
        where = f"group {group.name}"
        table = Table(columns={}, keys={})
        for holder, properties in (("file", source.properties), (where, group.properties)):
            check_few(file, f"properties of {holder}", len(properties), "properties")
            for name, value in properties.items():
                if is_key(file, f"properties of {holder}", name):
                    take_key(file, f"properties of {holder}", name, value, table.keys)
        channels = {channel.name: channel for channel in group.channels()}
        _take_stamps(channels, table.remarks)
        wanted = wanted_columns(file, where, channels, table.remarks)
        _check_sizes(file, {name: channels[name] for name in wanted})
        for name in wanted:
            for key in UNIT_NAMES:
                if key in channels[name].properties:
                    check_unit(file, name, channels[name].properties[key])
            table.columns[name] = numbers(file, name, np.asarray(channels[name][:]))
        properties = {name: channels[name].properties for name in wanted}
        if source.file_status.incomplete_final_segment:
            _take_what_is_there(file, properties, table)
        _take_times(file, properties, table)
    return table


def _take_stamps(channels: dict[str, Any], remarks: list[str]) -> None:
    """Let a channel of time stamps be ``time_s`` where none is called so and it is the only one."""
    stamps = [name for name, channel in channels.items() if np.dtype(channel.dtype).kind == "M"]
    if len(stamps) == 1 and "time_s" not in channels:
        channels["time_s"] = channels.pop(stamps[0])
        remarks.append(f"time_s from the time stamps in {shorten(stamps[0])}")


def _take_what_is_there(file: Path, properties: dict[str, dict[str, Any]], table: Table) -> None:
    """Keep of a file that was cut off what every channel holds; channels with times of their own are cut by these."""
    own = {(str(held.get("wf_start_time")), held.get("wf_start_offset"), held.get("wf_increment"))
           for held in properties.values()}  # fmt: skip
    least = min(values.size for values in table.columns.values())
    if least == 0:
        found = "a cut-off TDMS file (a channel holds nothing)"
        raise InputFileError(file, found=found, wish="want the whole file; copy or export it again")
    if len(own) == 1:
        table.columns = {name: values[:least] for name, values in table.columns.items()}
    table.remarks.append(f"the file is cut off in its last segment; it was read as far as it goes, {least} samples")


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


def _group(file: Path, groups: list[Any]) -> Any:
    """The one group with columns."""
    check_few(file, "", sum(len(group.channels()) for group in groups), "channels")
    holding = [group for group in groups if any(channel.name in COLUMNS for channel in group.channels())]
    if len(holding) > 1:
        found = f"columns in the groups {shorten(' and '.join(group.name for group in holding), width=120)}"
        raise InputFileError(file, found=found, wish="want one recording in a file")
    if not holding and not groups:
        raise InputFileError(file, found="no groups", wish="want a group with one channel for every column")
    return holding[0] if holding else groups[0]


def _check_sizes(file: Path, channels: dict[str, Any]) -> None:
    """Refuse what the file cannot hold: TDMS packs nothing, so its numbers take no less room than the file."""
    check_numbers(file, sum(len(channel) for channel in channels.values()))
    stated = 0
    for name, channel in channels.items():
        dtype = np.dtype(channel.dtype)
        if dtype.kind not in "iufb" and not (name == "time_s" and dtype.kind == "M"):
            raise InputFileError(
                file, where=f"column {name}", found=f"values of type {dtype}", wish="want plain numbers"
            )
        stated += len(channel) * (channel.data_type.size or 0)
    if stated > file.stat().st_size:
        found = f"a cut-off or damaged TDMS file ({stated} bytes of numbers in {file.stat().st_size})"
        raise InputFileError(file, found=found, wish="want the whole file; copy or export it again")


def _take_times(file: Path, properties: dict[str, dict[str, Any]], table: Table) -> None:
    """Put columns that were read at different times on one axis, and add ``time_s`` where no channel is it."""
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
        table.remarks.append(f"time_s from the waveform properties: {1.0 / rates.pop():g} samples per second")
        return
    put_on_one_axis(file, table, even)


def _begins(file: Path, properties: dict[str, dict[str, Any]]) -> dict[str, float]:
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


def _seconds(file: Path, name: str, properties: dict[str, Any], key: str) -> float | None:
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
