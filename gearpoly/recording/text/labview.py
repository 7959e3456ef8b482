"""Measurement files of LabVIEW (.lvm): units and times of the channels, which stand in the lines above their names.

Above each table ``X_Dimension``, ``X0``, ``Delta_X`` and ``Y_Unit_Label`` have a cell for every channel. The columns of
abscissas are one for each channel, one for all, or empty, and then the times are X0 + k Delta_X.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from gearpoly.recording.table import Channel, Table
from gearpoly.recording.text.cells import Marks
from gearpoly.recording.text.cut import split
from gearpoly.recording.text.headings import ABSCISSA
from gearpoly.recording.text.layout import RecordingLines
from gearpoly.units import FloatArray

LABVIEW_TABLE_MARK = "X_Dimension"


def take_times(table: Table, lines: Sequence[str], block: RecordingLines, separator: str, marks: Marks) -> None:
    """Give the channels of a ``table`` the units and the times in s that the lines above its ``block`` state."""
    above: dict[str, list[str]] = {}
    for number in range(block.head[0], block.head[1]):
        line = lines[number - 1]
        if line.startswith((LABVIEW_TABLE_MARK, "X0", "Delta_X", "Y_Unit_Label")):
            key, *cells = split(line, separator)
            above[key] = cells
    if LABVIEW_TABLE_MARK not in above:
        return
    numbers = {one.number: name for name, one in table.others.items()}
    held: dict[str, Channel] = {}
    for number, called in enumerate(block.stated, start=1):
        if called == ABSCISSA or number not in numbers:
            continue
        name = numbers[number]
        one = table.others[name]
        time = _time(table, block, above, numbers, number, one.values.size, marks)
        held[name] = replace(one, unit=one.unit or _cell(above, "Y_Unit_Label", number), time=time)
    table.others = held
    times = [one.time for one in held.values()]
    if times and times[0] is not None:
        table.remarks.append("times of the channels are those of LabVIEW's abscissas, in s")


def _cell(above: Mapping[str, list[str]], key: str, number: int) -> str:
    """The cell of a ``key`` for the column of that ``number`` (from 1); the key takes the first place."""
    cells = above.get(key, [])
    return cells[number - 2].strip() if 0 <= number - 2 < len(cells) else ""


def _time(
    table: Table,
    block: RecordingLines,
    above: Mapping[str, list[str]],
    numbers: Mapping[int, str],
    number: int,
    size: int,
    marks: Marks,
) -> FloatArray | None:
    """Times (size,) in s of the channel in the column of that ``number``: those of the nearest abscissas before it."""
    if _cell(above, LABVIEW_TABLE_MARK, number) != "Time":
        return None
    before = [k for k, called in enumerate(block.stated[: number - 1], start=1) if called == ABSCISSA and k in numbers]
    read = table.others[numbers[before[-1]]].values if before else np.empty(0)
    if read.size == size and np.isfinite(read).all():
        return read
    try:
        first, step = (marks.value(_cell(above, key, number)) for key in ("X0", "Delta_X"))
    except ValueError:
        return None
    return first + step * np.arange(size, dtype=np.float64) if step > 0.0 else None
