"""A unit that a stated speed contradicts: seconds under the name of milliseconds are a thousand times as quick.

Derived here. Speed is angle over time. Where the speed of the readings is the stated one times the ratio of two units,
one of the three is in the other unit; speeds that are set wrong are off by other factors.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.recording.map_lines import entry, with_unit
from gearpoly.recording.quantities import UNITS, column_unit
from gearpoly.recording.table import Table
from gearpoly.recording.unwrapping import WRAPPED_SPAN
from gearpoly.units import TURN_DEG

READINGS_FOR_SPEED = 20_000
"""Readings that the speed is told by, the first ones."""

SAME_SPEED_PART = 0.01
"""Relative. A speed display is as true; factors between two units are 1000, 60 or 57.3."""

SPEED_UNITS_LEAST_FACTOR = 3.0
"""Least factor between the units that are told apart: a speed of the other shaft is off by the ratio of the teeth."""

FEWEST_READINGS_FOR_SPEED = 16
"""Readings that a speed is told by."""

ONE_WAY_SHARE = 0.9
"""Part of their range that readings go on by: forth and back they tell no speed."""

EXCHANGED_COLUMN_UNITS = {
    "time_s": ("s", "ms", "us", "min"),
    "driving_angle_deg": ("deg", "rad", "rev"),
    "speed_rpm": ("rpm", "rev/s", "rad/s", "deg/s"),
}
"""Units that people exchange."""


@np.errstate(over="ignore", invalid="ignore", divide="ignore")  # a damaged file may hold anything
def check_speed(file: Path, table: Table) -> None:
    """Raise ``InputFileError`` where the stated speed of a ``table`` says that its time, angle or speed is in another
    unit, with the line of a map that states it; say in a remark where more than one of them may be."""
    if not {"time_s", "driving_angle_deg"} <= table.columns.keys():
        return
    stated, turned = _stated(table), _turned(table)
    off = turned / stated if stated else 0.0
    if not off > 0.0 or 1.0 / SPEED_UNITS_LEAST_FACTOR < off < SPEED_UNITS_LEAST_FACTOR:
        return
    found = []
    for column, names in EXCHANGED_COLUMN_UNITS.items():
        if column in table.mapped:
            continue
        kept = column_unit(column)
        read = table.units.get(column, kept)
        size = read.size / off if column == "driving_angle_deg" else read.size * off
        for unit in (UNITS[kept.dimension][name] for name in names):
            if abs(unit.size / size - 1.0) <= SAME_SPEED_PART and unit.name != read.name:
                found.append((unit, table.entries.get(column) or entry(column, column, read), read))
    says = f"a speed of {turned:.4g} rpm by time and angle, and {stated:.4g} rpm is stated, {off:.4g} times off"
    if len(found) == 1:
        unit, line, read = found[0]
        says += f", as if {read.name} were {unit.name}"
        wish = f'want in a map, if so: {with_unit(line, unit.name)}; or the same with unit = "{read.name}" if so'
        raise InputFileError(file, found=says, wish=wish)
    if found:
        table.remarks.append(f"{says}, as if {' or '.join(f'{read.name} were {unit.name}' for unit, _, read in found)}")


def _stated(table: Table) -> float:
    """The speed in rpm that a column states, on average over the first readings, or a key; 0 where none does."""
    key = table.keys.get("speed_rpm")
    if "speed_rpm" in table.columns:
        return abs(float(np.nanmean(table.columns["speed_rpm"][:READINGS_FOR_SPEED])))
    return abs(float(key)) if isinstance(key, int | float) else 0.0


def _turned(table: Table) -> float:
    """The speed in rpm of the driving shaft by the first readings of time and angle; 0 where they tell none."""
    time, angle = (table.columns[name][:READINGS_FOR_SPEED] for name in ("time_s", "driving_angle_deg"))
    if time.size != angle.size:
        return 0.0
    read = np.isfinite(time) & np.isfinite(angle)
    time, angle = time[read], angle[read]
    if time.size < FEWEST_READINGS_FOR_SPEED or time[-1] == time[0]:
        return 0.0
    whole = np.unwrap(angle, period=TURN_DEG) if float(np.ptp(angle)) <= WRAPPED_SPAN * TURN_DEG else angle
    if abs(float(whole[-1] - whole[0])) < ONE_WAY_SHARE * float(np.ptp(whole)):
        return 0.0
    return abs(float((whole[-1] - whole[0]) / (time[-1] - time[0]))) * 60.0 / TURN_DEG
