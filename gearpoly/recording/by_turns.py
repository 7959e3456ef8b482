"""Columns of two devices in one table, read by turns: a row holds what one of them read, and nothing of the other.

Tables that were merged by their times look so. Their rows have no sample in common, so the columns are brought to
common times, as channels with times of their own are.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.recording.recording import ANGLE_COLUMNS, RAW_COLUMNS, TE_COLUMNS
from gearpoly.recording.sources import put_on_one_axis
from gearpoly.recording.table import Table
from gearpoly.recording.unwrapping import gaps
from gearpoly.units import FloatArray

READ_TOGETHER_PART = 0.01
"""Part of its readings that a column shares with another below which both are read by turns; two clocks meet by chance
in fewer, and a recording with drop-outs holds more."""

ROWS_FOR_TURNS = 8
"""Rows that are looked at first: devices that are read by turns leave cells empty in some of them."""


def bring_together(file: Path, table: Table) -> None:
    """Put columns that are read by turns on common times, in ``table``; leave all others as they are.

    Raises ``InputFileError`` where there is no time to bring them together by.
    """
    read = {name: values for name, values in table.columns.items() if name in (*ANGLE_COLUMNS, *TE_COLUMNS)}
    if len(read) < 2 or any(name in RAW_COLUMNS for name in table.columns):
        return
    if not any(np.isnan(values[:ROWS_FOR_TURNS]).any() for values in read.values()):
        return
    there = [np.isfinite(values) for values in read.values()]
    shared = np.count_nonzero(np.logical_and.reduce(there))
    if shared >= READ_TOGETHER_PART * min(np.count_nonzero(one) for one in there):
        return
    time = table.columns.get("time_s")
    if time is None:
        found = f"{shared} rows with readings of {' and '.join(read)}"
        wish = "want readings of all of them in a row, or a column time_s, by which they are brought together"
        raise InputFileError(file, found=found, wish=wish)
    times, columns = {}, {}
    for name, values in table.columns.items():
        held = np.isfinite(values) & np.isfinite(time)
        if name == "time_s" or not held.any():
            continue
        if np.any(np.diff(time[held]) <= 0.0):  # told where times are looked at
            return
        times[name], columns[name] = _with_gaps(time[held], values[held])
    table.columns = columns
    table.remarks.append("no row holds readings of all columns: they are taken as read by turns")
    put_on_one_axis(file, table, times)


def _with_gaps(time: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rising times (n,) in s and readings (n,) with a drop-out in each gap, so that nothing is read there."""
    steps = np.diff(time)
    wide = np.flatnonzero(gaps(steps, float(np.median(steps)))) if steps.size else np.empty(0, dtype=np.int64)
    return np.insert(time, wide + 1, time[wide] + 0.5 * steps[wide]), np.insert(values, wide + 1, np.nan)
