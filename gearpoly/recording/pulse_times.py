"""Times of pulses in the place of angles: a column for each encoder, or a row for each pulse with its channel.

Pulse k of an encoder of N pulses a turn stands at k/N turns. Both shafts are brought to the times of the one with fewer
pulses. A file of the time between pulses is the same after a sum.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.by_readings import rises, runs_evenly
from gearpoly.recording.deeds import in_full
from gearpoly.recording.map_lines import entry, lines_entry
from gearpoly.recording.meant import Meaning
from gearpoly.recording.pulses import Edges, pulses
from gearpoly.recording.quantities import TIME, UNITS, Unit
from gearpoly.recording.recording import ANGLE_COLUMNS, SHAFTS
from gearpoly.recording.sources import TimedColumn, brought_together
from gearpoly.recording.table import PULSE_CHANNEL, PULSE_TIME, PULSE_TIMES, Channel, Table
from gearpoly.recording.words import INTERVALS, tokens
from gearpoly.units import FloatArray

ROWS_LEAST = 50
"""Rows from which two numbers that come by turns are the channels of pulses."""


def angles_from_pulse_times(file: Path, table: Table) -> Table:
    """The ``table`` with angles at common times in the place of times of pulses.

    Raises ``InputFileError`` where times do not rise, pulses are too few, or a turn's number of pulses is not stated.
    """
    remarks = list(table.remarks)
    given = {name: values for name, values in table.columns.items() if name in PULSE_TIMES}
    beside = [name for name in table.columns if name not in PULSE_TIMES]
    if beside:
        remarks.append(f"{', '.join(beside)} not read: rows are of pulses, and no samples")
    times = _by_channel(file, given) if PULSE_TIME in given else _by_shaft(file, given)
    sources = []
    for shaft, angle, time in zip(SHAFTS, ANGLE_COLUMNS, times, strict=True):
        key = f"{shaft}_lines"
        lines = table.keys.get(key)
        if not isinstance(lines, int | float):
            wish = f"want the pulses of a turn of that shaft, such as keys.{key} = 100 in a map"
            raise InputFileError(file, found=f"pulses of the {shaft} shaft, and no {key}", wish=wish)
        count = _counted(shaft, time, remarks)
        sources.append(TimedColumn(column=angle, time=time, values=count * (360.0 / float(lines))))
    remarks.append(f"times of {times[0].size} driving and {times[1].size} driven pulses taken as angles")
    common, columns = brought_together(file, sources, remarks)
    return Table(columns={"time_s": common, **columns}, keys=table.keys, remarks=remarks)


def _by_shaft(file: Path, given: dict[str, FloatArray]) -> list[FloatArray]:
    """The rising times of both shafts' pulses, each in a column of its own."""
    out = []
    for shaft in SHAFTS:
        name = next((f"{shaft}_{kind}" for kind in ("pulse_s", "interval_s") if f"{shaft}_{kind}" in given), "")
        if not name:
            wish = f"want columns.{shaft}_pulse_s or columns.{shaft}_interval_s in the map too"
            raise InputFileError(file, found=f"pulses of one shaft, and none of the {shaft} one", wish=wish)
        values = given[name][np.isfinite(given[name])]
        # Both counters begin with their first pulse, within one of them.
        time = np.concatenate([[0.0], np.cumsum(values)]) if name.endswith("interval_s") else values
        out.append(_rising(file, name, time))
    return out


def _by_channel(file: Path, given: dict[str, FloatArray]) -> list[FloatArray]:
    """The rising times of both shafts' pulses, of rows with a channel."""
    if PULSE_CHANNEL not in given:
        wish = f"want columns.{PULSE_CHANNEL} in the map too, with zero = the number of the driving shaft's channel"
        raise InputFileError(file, found=f"{PULSE_TIME} without {PULSE_CHANNEL}", wish=wish)
    time, channel = given[PULSE_TIME], given[PULSE_CHANNEL]
    read = np.isfinite(time) & np.isfinite(channel)
    first, other = read & (channel == 0.0), read & (channel != 0.0)
    held = np.unique(channel[read])
    if held.size != 2 or not first.any():
        found = f"channels {', '.join(in_full(one) for one in held[:4])}, counted from that of the driving shaft"
        wish = f"want two, one of them 0: zero of columns.{PULSE_CHANNEL} is the number of the driving shaft's channel"
        raise InputFileError(file, where=f"column {PULSE_CHANNEL}", found=found, wish=wish)
    return [_rising(file, PULSE_TIME, time[rows]) for rows in (first, other)]


def _rising(file: Path, name: str, time: FloatArray) -> FloatArray:
    back = np.flatnonzero(np.diff(time) <= 0.0)
    if time.size < ROWS_LEAST:
        wish = f"want at least {ROWS_LEAST}"
        raise InputFileError(file, where=f"column {name}", found=f"{time.size} pulses", wish=wish)
    if back.size:
        found = f"pulse {int(back[0]) + 2} at {time[back[0] + 1]:.9g} s, after one at {time[back[0]]:.9g} s"
        wish = "want times that rise from pulse to pulse; leave the row out, or cut the file there"
        raise InputFileError(file, where=f"column {name}", found=found, wish=wish)
    return time


def _counted(shaft: str, time: FloatArray, remarks: list[str]) -> FloatArray:
    """The counts at the ``time`` (n,) of each pulse, with those that are lost counted on."""
    number = np.arange(time.size)
    always = np.ones(time.size, dtype=np.bool_)
    found = pulses(Edges(sample=number, time=time, rising=always, state=always, low=0.0, high=1.0, sharp=0.0))
    if found.lost:
        lost = sum(count for _, count in found.lost)
        first = found.lost[0][0] + 1
        remarks.append(f"{lost} pulses of the {shaft} shaft lost (first before pulse {first}), and counted on")
    if found.against.size:
        remarks.append(
            f"{found.against.size} pulses of the {shaft} shaft come much too early, first pulse {found.against[0] + 1}"
        )
    return np.asarray(found.count - found.count[0])


def asked_of_pulses(meant: Sequence[Meaning], channels: dict[str, Channel]) -> tuple[str, tuple[str, ...]] | None:
    """What is to say of a recording's channels where they are times of pulses, and the lines of a map that read them;
    ``None`` where they are something else."""
    timed = [one for one in meant if one.dimension == TIME and one.column == "time_s"]
    rest = [one for one in meant if one not in timed]
    lines = tuple(lines_entry(shaft) for shaft in SHAFTS)
    between = [one for one in meant if tokens(one.channel) & set(INTERVALS) and not rises(channels[one.channel].values)]
    if len(between) == 2 and all(one in between or one.dimension == TIME for one in meant):
        first = _paired(between)
        ask = tuple(
            entry(f"{shaft}_interval_s", one.channel, one.unit or UNITS[TIME]["us"])
            for shaft, one in zip(SHAFTS, first, strict=True)
        )
        return f"times between pulses ({_names(first)}), and no angles", (*ask, *lines)
    rising = [one for one in timed if rises(channels[one.channel].values)]
    if len(rising) == 2 and len(timed) == 2 and not rest:
        first = _paired(rising)
        ask = tuple(entry(f"{shaft}_pulse_s", one.channel, one.unit) for shaft, one in zip(SHAFTS, first, strict=True))
        return f"times of pulses ({_names(first)}), and no angles", (*ask, *lines)
    if len(timed) == 1 and len(rest) == 1 and not runs_evenly(channels[timed[0].channel].values):
        numbers = _two_numbers(channels[rest[0].channel].values)
        if numbers is not None and rises(channels[timed[0].channel].values):
            unit: Unit | None = timed[0].unit
            ask = (
                entry(PULSE_TIME, timed[0].channel, unit),
                entry(PULSE_CHANNEL, rest[0].channel, None, f"zero = {in_full(numbers[0])}"),
            )
            found = f"a row for each pulse with its channel ({_names([timed[0], rest[0]])}), and no angles"
            return found, (*ask, *lines)
    return None


def _paired(two: Sequence[Meaning]) -> list[Meaning]:
    """The driving shaft's and the driven one's, by their names or in the order of the file."""
    return sorted(two, key=lambda one: {"driving": 0, "driven": 2}.get(one.shaft, 1))


def _names(some: Collection[Meaning]) -> str:
    return " and ".join(f'"{shorten(one.channel)}"' for one in some)


def _two_numbers(values: FloatArray) -> FloatArray | None:
    """The two whole numbers that a channel's readings (n,) are, each of them often."""
    held = values[np.isfinite(values)]
    if held.size < ROWS_LEAST:
        return None
    numbers, often = np.unique(held[:100_000], return_counts=True)
    if numbers.size != 2 or np.any(numbers != np.rint(numbers)) or often.min() <= ROWS_LEAST // 4:
        return None
    return np.asarray(numbers, dtype=np.float64)
