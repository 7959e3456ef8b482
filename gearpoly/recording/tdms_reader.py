"""Recordings as TDMS (LabVIEW): one channel per column, all in one group, the keys as properties of group or file.

Where no channel is called ``time_s``, the waveform properties ``wf_start_offset`` and ``wf_increment`` give the time.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.reader import (
    NAMES_LIMIT,
    Reader,
    check_numbers,
    damage_reported,
    is_key,
    numbers,
    optional,
    take_key,
    wanted_columns,
)
from gearpoly.recording.recording import COLUMNS
from gearpoly.recording.table import Table


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
            for name, value in properties.items():
                if is_key(file, f"properties of {holder}", name):
                    take_key(file, f"properties of {holder}", name, value, table.keys)
        channels = {channel.name: channel for channel in group.channels()}
        wanted = wanted_columns(file, where, channels, table.remarks)
        _check_sizes(file, {name: channels[name] for name in wanted})
        if source.file_status.incomplete_final_segment:
            found = "a cut-off TDMS file (its last segment is not whole)"
            raise InputFileError(file, found=found, wish="want the whole file; copy or export it again")
        for name in wanted:
            table.columns[name] = numbers(file, name, np.asarray(channels[name][:]))
        if "time_s" not in wanted:
            _add_time(file, [channels[name] for name in wanted], table)
    return table


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
    if sum(len(group.channels()) for group in groups) > NAMES_LIMIT:
        wish = "want a file with the columns of one recording"
        raise InputFileError(file, found=f"more than {NAMES_LIMIT} channels", wish=wish)
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
        if dtype.kind not in "iufb":
            raise InputFileError(
                file, where=f"column {name}", found=f"values of type {dtype}", wish="want plain numbers"
            )
        stated += len(channel) * (channel.data_type.size or 0)
    if stated > file.stat().st_size:
        found = f"a cut-off or damaged TDMS file ({stated} bytes of numbers in {file.stat().st_size})"
        raise InputFileError(file, found=found, wish="want the whole file; copy or export it again")


def _add_time(file: Path, channels: list[Any], table: Table) -> None:
    """Time in s from the waveform properties, where all channels state the same."""
    stated = {(c.properties.get("wf_start_offset", 0.0), c.properties.get("wf_increment")) for c in channels}
    if stated == {(0.0, None)}:
        return
    if len(stated) > 1 or None in next(iter(stated)):
        found = "waveform times that differ from channel to channel"
        raise InputFileError(file, found=found, wish="want one wf_increment for all, or a channel time_s")
    start, increment = (float(value) for value in next(iter(stated)))
    size = next(iter(table.columns.values())).size
    table.columns["time_s"] = start + increment * np.arange(size, dtype=np.float64)
    table.remarks.append(f"time_s from the waveform properties: {1.0 / increment:g} samples per second")


READER = Reader(
    name="TDMS",
    endings=(".tdms",),
    recognises=lambda head: head.startswith(b"TDSm"),
    read=read_table,
    module="nptdms",
    extra="tdms",
)
