"""The unit of an angle by how far both shafts travelled: 57.3 times too little are rad that were read as deg.

Derived here. The driven shaft travels z_1/z_2 of the driving one. Where the readings travel that times the ratio of two
units, one of the shafts is in the other unit; encoders whose counts are set wrong are off by other factors.
"""

from __future__ import annotations

import math

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.recording.map_lines import entry, with_unit
from gearpoly.recording.quantities import ANGLE, UNITS
from gearpoly.recording.recording import ANGLE_COLUMNS, SHAFTS, Recording
from gearpoly.recording.unwrapping import WRAPPED_SPAN
from gearpoly.units import TURN, FloatArray

FIRST = 20_000
"""Readings that are looked at before all are."""

SAME = 0.02
"""Relative. The travel of two shafts differs by their lost motion and what was read last, a hundredth of a turn each;
between the factors of two units, 57.3, 360 and 6.28, lie ten times as much."""

TURNS_LEAST = 1.0
"""Turns of both shafts in the unit that is told: in part of one a deviation is as large as the travel."""

TOLD = ("deg", "rad", "rev", "arcmin", "arcsec")
"""Units that are told."""

APART = 3.0
"""Least factor between the units that are told apart. Gons and degrees are 0.9 apart, as counts of encoders may be."""


def check_units_by_travel(recording: Recording, ratio: float) -> None:
    """Raise ``InputFileError`` where both shafts' travel says that one of them is in another unit than it was read in,
    with the line of a map that states it; ``ratio`` is z_1/z_2."""
    angles = [getattr(recording, f"{shaft}_angle_rad") for shaft in SHAFTS]
    if any(one is None for one in angles):
        return
    for some in (FIRST, None):  # the first readings of most recordings show that all is well
        travel = [_travel(one[:some]) for one in angles]
        off = travel[1] / travel[0] / ratio if all(travel) else math.nan
        if 1.0 / APART < off < APART:
            return
    if not off > 0.0:
        return
    found = []
    for shaft, column, power in zip(SHAFTS, ANGLE_COLUMNS, (-1.0, 1.0), strict=True):
        line = recording.entries.get(column) or entry(column, column, None)
        read = next((one for one in UNITS[ANGLE].values() if f'unit = "{one.name}"' in line), UNITS[ANGLE]["deg"])
        for name in TOLD:
            factor = UNITS[ANGLE][name].size / read.size
            true = [one * (factor if other == shaft else 1.0) for one, other in zip(travel, SHAFTS, strict=True)]
            if max(factor, 1.0 / factor) > APART and abs(off * factor**power - 1.0) <= SAME and min(true) > TURNS_LEAST:
                found.append((column, read.name, name, with_unit(line, name)))
    if len(found) == 1:
        column, stated, name, line = found[0]
        says = f"read in {stated}, and the shafts travel {off:.4g} times what the teeth let them, as with {name} in it"
        wish = f"want in a map, if so: {line}"
        if name.startswith("arc"):  # 60 may be a gear as well
            gear = column.partition("_")[0]
            wish += f"; of an encoder behind such a gear state [{gear}.encoder] scale in the pair file"
        raise InputFileError(recording.source, where=f"column {column}", found=says, wish=wish)


def _travel(angle: FloatArray) -> float:
    """How many turns readings (n,) in rad go on, wraps undone; 0 where there are none."""
    held = angle[np.isfinite(angle)]
    if not held.size:
        return 0.0
    # In a wrong unit readings that run on may step by more than half a turn, which is no wrap.
    whole = np.unwrap(held) if float(np.ptp(held)) <= WRAPPED_SPAN * TURN else held
    return abs(float(whole[-1] - whole[0])) / TURN
