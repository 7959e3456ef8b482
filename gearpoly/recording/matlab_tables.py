"""Tables, timetables and time stamps that MATLAB keeps as objects, read by mat-io: every series of numbers by its path.

Nobody documents how MATLAB lays its objects out; mat-io follows what was found out about it. It does not compare the
sizes that a file states with what is there, so it runs in the process of its own that bounds memory and time.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.errors import InputFileError, MissingExtraError
from gearpoly.files.traces import shorten
from gearpoly.recording.matlab_objects import unread
from gearpoly.recording.reader import (
    DEEPEST_NESTING,
    NAMES_LIMIT,
    Reader,
    check_few,
    check_numbers,
    damage_reported,
    optional,
    since_first,
)
from gearpoly.recording.table import Channel, Table
from gearpoly.units import FloatArray

MATLAB_TABLE_CLASSES = ("table", "timetable", "datetime", "duration")
"""Classes that hold series of numbers."""


def read_table(file: Path, variables: list[str]) -> Table:
    """The series of numbers in some ``variables`` of a MAT file, each an object or a struct with objects in it."""
    with warnings.catch_warnings(), damage_reported(file, "MATLAB"):
        # Of zones and formats of dates, of objects that it passes over, and when first imported of an old option.
        warnings.simplefilter("ignore")
        matio = optional(file, "matio", extra="matlab")
        held = matio.load_from_mat(str(file), variable_names=list(variables), add_table_attrs=True)
        table = Table(columns={}, keys={})
        left: list[str] = []
        for path, leaf, values, unit in _series(held):
            check_few(file, "", len(table.others), "columns of tables")
            if values is None:
                left.append(path)
            elif values.size > 1:
                check_numbers(file, sum(one.values.size for one in table.others.values()) + values.size)
                table.others[path] = Channel(values=values, unit=unit, leaf=leaf)
    if not table.others:
        found = f"nothing that could be read in {shorten(', '.join(variables), width=120)}"
        raise InputFileError(file, found=found, wish="want tables with columns of numbers")
    if left:
        table.remarks.append(f"not read, since no series of plain numbers: {shorten(', '.join(left), width=200)}")
    return table


def take_tables(file: Path, table: Table, objects: Mapping[str, str], read: Any) -> None:
    """Put what tables and timetables among ``objects`` (class by path) hold into ``table``, as ``read`` finds it from
    the names of variables; what of the objects is not read is ``table.unread``.

    Raises ``InputFileError`` where objects were not read, and there is nothing else.
    """
    wanted = {path: kind for path, kind in objects.items() if kind in MATLAB_TABLE_CLASSES}
    lost, why = {path: kind for path, kind in objects.items() if kind not in MATLAB_TABLE_CLASSES}, None
    if wanted:
        try:
            found = read(list(dict.fromkeys(path.partition(".")[0].partition("(")[0] for path in wanted)))
            table.others.update({path: one for path, one in found.others.items() if path not in table.others})
            table.remarks.extend(found.remarks)
        except (InputFileError, MissingExtraError) as error:
            lost, why = dict(objects), error
    table.unread = unread(lost, why=why)
    if table.unread is not None:
        table.remarks.append(f"{table.unread[0]}; {table.unread[1]}")
        if not table.columns and not table.others:
            raise InputFileError(file, where="variables", found=f"no columns; {table.unread[0]}", wish=table.unread[1])


def _series(held: dict[str, Any]) -> Iterator[tuple[str, str, FloatArray | None, str]]:
    """Path, own name, values (``None`` for what is no number) and unit of every column of the tables in ``held``."""
    # Taken out, so that nothing but what waits is kept.
    waiting = [(name, held.pop(name), 0) for name in list(held) if not name.startswith("__")]
    while waiting:
        path, value, depth = waiting.pop(0)
        if type(value).__name__ == "DataFrame":
            yield from _columns(path, value)
        elif (
            getattr(getattr(value, "dtype", None), "names", None)
            and depth < DEEPEST_NESTING
            and value.size <= NAMES_LIMIT
        ):
            for number, element in enumerate(value.reshape(-1, order="F"), start=1):
                place = path if value.size == 1 else f"{path}({number})"
                waiting += [(f"{place}.{name}", element[name], depth + 1) for name in value.dtype.names]
        elif isinstance(value, np.ndarray) and value.dtype.kind in "mM":
            yield path, path.rpartition(".")[2], _numbers(value.reshape(-1, order="F")), "s"


def _columns(path: str, frame: Any) -> Iterator[tuple[str, str, FloatArray | None, str]]:
    """The columns of one table; the times of the rows of a timetable are the time."""
    if frame.index.dtype.kind in "mM":
        yield f"{path}.{frame.index.name or 'Time'}", "time_s", _numbers(frame.index.to_numpy()), "s"
    stated = frame.attrs.get("varUnits") or frame.attrs.get("VariableUnits") or ()
    units = [str(one) for one in stated] if len(stated) == len(frame.columns) else [""] * len(frame.columns)
    for name, unit in zip(frame.columns, units, strict=True):
        column = frame[name]
        plain = getattr(column.dtype, "kind", "O") in "iufbmM"
        timed = plain and column.dtype.kind in "mM"
        yield f"{path}.{name}", str(name), _numbers(column.to_numpy()) if plain else None, "s" if timed else unit


def _numbers(values: Any) -> FloatArray:
    """Numbers (n,) as float64; time stamps as seconds since the first, durations in s."""
    if values.dtype.kind == "M":
        return since_first(values)
    if values.dtype.kind == "m":
        return np.asarray(values / np.timedelta64(1, "s"), dtype=np.float64)
    return np.array(values, dtype=np.float64)


READER = Reader(
    name="MATLAB",
    endings=(),
    recognises=lambda head: False,
    read=read_table,
    module="matio",
    extra="matlab",
    apart=True,
)
