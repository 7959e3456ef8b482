"""Recordings as Parquet: one table, the keys as text in the file's metadata."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.errors import InputFileError, MissingExtraError
from gearpoly.files.traces import shorten
from gearpoly.recording.arrow import doubles
from gearpoly.recording.reader import (
    Reader,
    check_few,
    check_held,
    check_numbers,
    damage_reported,
    is_key,
    numbers,
    optional,
    pass_over,
    take_key,
    text_value,
)
from gearpoly.recording.recording import COLUMNS, PASSED_OVER
from gearpoly.recording.stated_units import UNIT_NAMES, check_unit
from gearpoly.recording.table import Channel, Table, told_apart

PYARROW_LEAST = 15
"""Oldest pyarrow, by its major version: up to 14.0.0 it unpickled what a Parquet file told it to (CVE-2023-47248)."""


def read_table(file: Path) -> Table:
    """The columns and keys of one Parquet file; nulls are drop-outs.

    Columns under the contract's names are the recording's; all others are offered to a map.
    """
    version = str(optional(file, "pyarrow", extra="parquet").__version__)
    if int(version.split(".")[0]) < PYARROW_LEAST:
        wish = f"pip install --upgrade gearpoly[parquet] (pyarrow {PYARROW_LEAST} or later)"
        raise MissingExtraError(f"{file}: pyarrow {version} can be made to run code by a Parquet file; {wish}")
    parquet = optional(file, "pyarrow.parquet", extra="parquet")
    types = optional(file, "pyarrow.types", extra="parquet")
    with damage_reported(file, "Parquet"), parquet.ParquetFile(file, memory_map=True) as source:
        schema = source.schema_arrow
        check_few(file, "schema", len(schema.names), "columns")
        named = dict(zip(told_apart(schema.names), schema, strict=True))
        plain = {
            name: types.is_floating(column.type) or types.is_integer(column.type) or types.is_boolean(column.type)
            for name, column in named.items()
        }
        clocks = [
            name for name, column in named.items() if types.is_timestamp(column.type) or types.is_duration(column.type)
        ]
        clock = clocks[0] if len(clocks) == 1 and "time_s" not in named else ""
        for name, column in named.items():
            if name in COLUMNS:
                stamps = name == "time_s" and types.is_timestamp(column.type)
                if not (plain[name] or stamps):
                    found = f"values of type {column.type}"
                    raise InputFileError(file, where=f"column {name}", found=found, wish="want plain numbers")
                check_unit(file, name, _unit(column))
        _check_size(file, source.metadata)
        keys: dict[str, object] = {}
        check_few(file, "metadata", len(schema.metadata or {}), "keys")
        for key, value in (schema.metadata or {}).items():
            name = key.decode("utf-8", errors="replace")
            if is_key(file, "metadata", name):
                take_key(file, "metadata", name, text_value(value.decode("utf-8", errors="replace")), keys)
        table = Table(columns={}, keys=keys)
        for number, (name, column) in enumerate(named.items(), start=1):
            if not plain[name] and name != "time_s" and name not in clocks:
                continue
            # One at a time, so that only one column is held twice; all of a name come at once.
            alike = [k for k, one in enumerate(schema.names, start=1) if one == column.name]
            held = source.read(columns=[column.name], use_threads=True).column(alike.index(number))
            values = doubles(held)
            if values is None:
                values = np.asarray(held.to_numpy())
            del held
            if name == clock:
                table.columns["time_s"] = numbers(file, "time_s", values)
                table.remarks.append(f'"{shorten(name)}" taken for time_s: the only time stamps, in s after the first')
            elif name in (*COLUMNS, *PASSED_OVER):
                table.columns[name] = numbers(file, name, values)
            elif name in clocks:
                leaf = column.name if column.name != name else ""
                table.others[name] = Channel(values=numbers(file, "time_s", values), unit="s", leaf=leaf, number=number)
            else:
                values = np.ascontiguousarray(values, dtype=np.float64)
                leaf = column.name if column.name != name else ""
                table.others[name] = Channel(values=values, unit=_unit(column), leaf=leaf, number=number)
        left = [name for name in named if not plain[name] and name != "time_s" and name not in clocks]
    pass_over(table)
    check_held(file, "schema", table, left)
    return table


def _unit(column: Any) -> str:
    """The unit that a column's metadata state, or nothing."""
    held = column.metadata or {}
    return next((held[key.encode()].decode("utf-8", "replace") for key in UNIT_NAMES if key.encode() in held), "")


def _check_size(file: Path, metadata: Any) -> None:
    """Refuse what would unpack beyond the limit: run lengths make a billion rows of a few bytes."""
    groups = [metadata.row_group(i) for i in range(metadata.num_row_groups)]
    largest = max((group.total_byte_size for group in groups), default=0)
    check_numbers(file, metadata.num_rows * metadata.num_columns, beside=largest)


READER = Reader(
    name="Parquet",
    endings=(".parquet", ".pq"),
    recognises=lambda head: head.startswith(b"PAR1"),
    read=read_table,
    module="pyarrow",
    extra="parquet",
)
