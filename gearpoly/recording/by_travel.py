"""The unit of an angle by how far both shafts travelled: 57.3 times too little are rad that were read as deg.

Derived here. The driven shaft travels z_1/z_2 of the driving one. Where the readings travel that times the ratio of two
units, one of the shafts is in the other unit; encoders whose counts are set wrong are off by other factors.
"""

from __future__ import annotations

import math
from itertools import product
from typing import NoReturn

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.recording.map_lines import entry, with_unit
from gearpoly.recording.quantities import ANGLE, UNITS, Unit
from gearpoly.recording.recording import ANGLE_COLUMNS, SHAFTS, Recording
from gearpoly.recording.unwrapping import WRAPPED_SPAN
from gearpoly.units import TURN, FloatArray

READINGS_FOR_TRAVEL = 20_000
"""Readings that are looked at before all are."""

SAME_TRAVEL_PART = 0.02
"""Relative. The travel of two shafts differs by their lost motion and what was read last, a hundredth of a turn each;
between the factors of two units, 57.3, 360 and 6.28, lie ten times as much."""

LEAST_TURNS_FOR_TRAVEL = 1.0
"""Turns of both shafts in the unit that is told: in part of one a deviation is as large as the travel."""

TRAVEL_UNITS = ("deg", "rad", "rev", "arcmin", "arcsec")
"""Units that are told."""

TRAVEL_UNITS_LEAST_FACTOR = 3.0
"""Least factor between the units that are told apart. Gons and degrees are 0.9 apart, as counts of encoders may be."""


def check_units_by_travel(recording: Recording, ratio: float) -> None:
    """Raise ``InputFileError`` where both shafts' travel says that one of them is in another unit than it was read in,
    with the line of a map that states it; ``ratio`` is z_1/z_2."""
    angles = [getattr(recording, f"{shaft}_angle_rad") for shaft in SHAFTS]
    if any(one is None for one in angles):
        return
    for some in (READINGS_FOR_TRAVEL, None):  # the first readings of most recordings show that all is well
        travel = [_travel(one[:some]) for one in angles]
        off = travel[1] / travel[0] / ratio if all(travel) else math.nan
        if 1.0 / TRAVEL_UNITS_LEAST_FACTOR < off < TRAVEL_UNITS_LEAST_FACTOR:
            return
    if not off > 0.0:
        return
    lines = [recording.entries.get(column) or entry(column, column, None) for column in ANGLE_COLUMNS]
    read = [
        next((one for one in UNITS[ANGLE].values() if f'unit = "{one.name}"' in line), UNITS[ANGLE]["deg"])
        for line in lines
    ]
    found = [
        pair
        for pair in product(TRAVEL_UNITS, repeat=2)
        if _fits(off, travel, [UNITS[ANGLE][name].size / one.size for name, one in zip(pair, read, strict=True)])
    ]
    # One shaft in another unit is likelier than both, and units of arcs are rare.
    for few in (1, 2):
        told = [
            pair
            for pair in found
            if sum(name != one.name for name, one in zip(pair, read, strict=True)) == few
            and (few == 1 or not any(name.startswith("arc") for name in pair))
        ]
        if told:
            _refuse(recording, off, told, read, lines)


def _fits(off: float, travel: list[float], factors: list[float]) -> bool:
    """Whether travels in turns that are ``off`` the teeth's ratio are so by units that are ``factors`` as large."""
    if any(
        factor != 1.0 and 1.0 / TRAVEL_UNITS_LEAST_FACTOR < factor < TRAVEL_UNITS_LEAST_FACTOR for factor in factors
    ):
        return False
    true = [one * factor for one, factor in zip(travel, factors, strict=True)]
    return abs(off * factors[1] / factors[0] - 1.0) <= SAME_TRAVEL_PART and min(true) > LEAST_TURNS_FOR_TRAVEL


def _refuse(
    recording: Recording, off: float, told: list[tuple[str, ...]], read: list[Unit], lines: list[str]
) -> NoReturn:
    """Raise with what may be: of each pair of units that is ``told`` the lines of the shafts that are in another one
    than they were ``read`` in."""
    ways, where = [], []
    for pair in told:
        other = [k for k, name in enumerate(pair) if name != read[k].name]
        where += [ANGLE_COLUMNS[k] for k in other]
        ways.append(" ".join(with_unit(lines[k], pair[k]) for k in other))
    stated = " and ".join(dict.fromkeys(read[ANGLE_COLUMNS.index(one)].name for one in where))
    units = " or ".join(" and ".join(name for k, name in enumerate(pair) if name != read[k].name) for pair in told)
    places = list(dict.fromkeys(where))
    says = f"read in {stated}, and the shafts travel {off:.4g} times what the teeth let them, as with {units} in "
    says += "it" if len(places) == 1 else "them" if len(told) == 1 else "one of them"
    wish = f"want in a map, if so: {', or '.join(ways)}"
    if any(name.startswith("arc") for pair in told for name in pair):  # 60 may be a gear as well
        gear = places[0].partition("_")[0]
        wish += f"; of an encoder behind such a gear state [{gear}.encoder] scale in the pair file"
    columns = f"column{'s' if len(places) > 1 else ''} {' and '.join(places)}"
    raise InputFileError(recording.source, where=columns, found=says, wish=wish)


def _travel(angle: FloatArray) -> float:
    """How many turns readings (n,) in rad go on, wraps undone; 0 where there are none."""
    held = angle[np.isfinite(angle)]
    if not held.size:
        return 0.0
    # In a wrong unit readings that run on may step by more than half a turn, which is no wrap.
    whole = np.unwrap(held) if float(np.ptp(held)) <= WRAPPED_SPAN * TURN else held
    return abs(float(whole[-1] - whole[0])) / TURN
