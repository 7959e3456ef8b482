"""Traces of oscilloscopes that number their samples: start and step of the time stand behind the names of the channels.

Rigol writes ``X,CH1,CH2,Start,Increment``, below it the units, the start and the step in s, and rows that begin with
the number of the sample.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from gearpoly.recording.by_readings import are_row_numbers
from gearpoly.recording.table import Channel, Table
from gearpoly.recording.text.cells import Marks
from gearpoly.recording.text.cut import split
from gearpoly.recording.text.layout import RecordingLines

BEHIND = ("start", "increment")
"""What stands behind the names of the channels, in small letters."""


def take_sequence(table: Table, lines: Sequence[str], block: RecordingLines, separator: str, marks: Marks) -> None:
    """Give the channels of a ``table`` the names, units and times in s that two lines above its ``block`` state."""
    for number in range(block.head[0], block.head[1] - 1):
        names = split(lines[number - 1], separator)
        units = split(lines[number], separator)
        if tuple(one.lower() for one in names[-2:]) != BEHIND or len(units) != len(names):
            continue
        held = list(table.others.values())
        try:
            start, step = (marks.value(cell) for cell in units[-2:])
        except ValueError:
            continue
        if len(held) != len(names) - 2 or not step > 0.0 or not are_row_numbers(held[0].values):
            continue
        time = Channel(values=start + step * held[0].values, unit="s", number=1)
        channels = [replace(one, unit=unit) for one, unit in zip(held[1:], units[1:-2], strict=True)]
        table.others = dict(zip(names[:-2], [time, *channels], strict=True))
        table.remarks.append(f"times are {names[-2]} and {names[-1]} of the oscilloscope, in s")
        return
