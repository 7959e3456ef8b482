"""What a column under a name of the owner's own holds: by the words of its name, its unit, and its readings.

Words are German, French, Spanish, Italian and English. A column is taken where nothing else can be meant: its quantity,
its unit and its shaft are all stated, or shown by the readings. Everything else is a doubt that a map settles.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gearpoly.errors import shown
from gearpoly.recording.by_readings import (
    CLOCK_TICKS,
    are_days,
    are_whole_turns,
    contradicting,
    counter_modulus,
    rises,
    runs_evenly,
    since_1970,
    swings,
    told_since,
    went_on,
    wrapped_unit,
)
from gearpoly.recording.header import COUNT_UNIT_NAMES, header_unit, is_clock
from gearpoly.recording.map_lines import (
    TEETH_RATIO,
    analog_entries,
    counter_entries,
    counts_entries,
    entry,
    likely_time,
    quoted,
    scaled,
    turn_of_counts,
)
from gearpoly.recording.meant import Meaning, called_twice, of_runs, without_twins
from gearpoly.recording.quantities import (
    ANGLE,
    COUNT,
    DOUBTFUL,
    LENGTH,
    SPEED,
    TIME,
    TORQUE,
    UNITS,
    UNSTATED,
    Unit,
    column_unit,
    is_per_second,
    unit_written,
    units_written,
)
from gearpoly.recording.recording import ANGLE_COLUMNS, COLUMNS, SHAFTS
from gearpoly.recording.table import AXIS_ERROR, MAPPED_AXIS, WORM_ANGLE, Channel
from gearpoly.recording.words import (
    ANGULAR_SPEED,
    AXIS,
    BARE_ERRORS,
    CLOCKS,
    OTHER_QUANTITY,
    PERCENT,
    RADIAL,
    TE,
    WORM,
    by_letter,
    plain,
    quantity_of,
    shaft_of,
    tokens,
)
from gearpoly.units import FloatArray

NO_ROTATION_UNITS = ("arcsec", "arcmin", "urad", "mrad", "mdeg")
"""Units of angles that no shaft's rotation is told in."""

_GERMAN = "winkel|zeit|dreh|antrieb|abtrieb|eingang|ausgang|zahler"


def meanings(channels: Mapping[str, Channel]) -> list[Meaning]:
    """What each of the ``channels`` of a recording holds, in their order; no column is surely two of them."""
    # "in" is a word of German and an inch; beside an "out" it is a shaft.
    outs = any("out" in tokens(one.leaf or name) for name, one in channels.items())
    shafts = _shafts(channels, outs=outs)
    found = [replace(_meaning(name, one, shaft=shafts[name]), shaft=shafts[name]) for name, one in channels.items()]
    found = of_runs(channels, found)
    open_ = [one for one in found if one.doubt and one.dimension == ANGLE and not shafts[one.channel]]
    taken = {one.column for one in found if not one.doubt}
    for one, column in zip(open_, (c for c in ANGLE_COLUMNS if c not in taken), strict=False):
        ask = (entry(column, one.channel, one.unit),)
        found[found.index(one)] = replace(one, column=column, ask=ask)
    counts = [one for one in found if one.dimension == COUNT and one.doubt and not shafts[one.channel]]
    free = [shaft for shaft, angle in zip(SHAFTS, ANGLE_COLUMNS, strict=True) if angle not in taken]
    for one, shaft in zip(counts, (s for s in free if s not in shafts.values()), strict=False):
        found[found.index(one)] = _counted(one, shaft, channels[one.channel].values)
    found = without_twins(channels, found)
    found = called_twice(channels, found)
    for column in {one.column for one in found if one.column and not one.doubt}:
        rivals = [one for one in found if one.column == column and not one.doubt]
        if len(rivals) > 1:
            names = " and ".join(f'"{one.channel}"' for one in rivals)
            for one in rivals:
                doubt = f"{names} may each be {column}"
                ask = (entry(column, one.channel, one.unit),)
                found[found.index(one)] = replace(one, doubt=doubt, ask=ask)
    return found


def _shafts(channels: Mapping[str, Channel], *, outs: bool) -> dict[str, str]:
    """The shaft of each channel by its own name, or by its path where paths name both shafts: one group called input
    may hold the inputs of a logger."""
    by_path = {name: shaft_of(group) if (group := one.group(name)) else "" for name, one in channels.items()}
    if not {"driving", "driven"} <= set(by_path.values()):
        by_path = dict.fromkeys(channels, "")
    return {
        name: shaft_of(header_unit(one.leaf or name)[0], outs=outs) or by_path[name] for name, one in channels.items()
    }


def _meaning(channel: str, held: Channel, *, shaft: str) -> Meaning:
    own = held.leaf or channel
    name, in_name = header_unit(own)
    quantity = quantity_of(name)
    stated = held.unit or in_name
    if unit_written(stated, ANGLE) == UNITS[ANGLE]["arcsec"] and tokens(name) & {"ra", "dec"}:  # of a star
        quantity = AXIS if "ra" in tokens(name) else OTHER_QUANTITY
    if own in (*COLUMNS, *MAPPED_AXIS):
        return _by_own_name(channel, own, held.unit)
    if not np.isfinite(held.values).any():  # without one number it can be nothing
        return Meaning(channel=channel, dimension=OTHER_QUANTITY)
    small = unit_written(stated, ANGLE)
    if tokens(name) and tokens(name) <= BARE_ERRORS and small is not None and small.name in NO_ROTATION_UNITS:
        doubt = "an error, of the transmission or of something else, whose sign no name tells (positive where the "
        doubt += "driven gear is ahead)"
        ask, why = (entry("te_arcsec", channel, small, "sign = 1"),), f'"{name}"'
        return Meaning(channel=channel, column="te_arcsec", unit=small, dimension=TE, why=why, doubt=doubt, ask=ask)
    if quantity in (OTHER_QUANTITY, RADIAL):
        return Meaning(channel=channel, dimension=quantity, why=f'"{name}"' if quantity == RADIAL else "")
    if not stated and tokens(name) & set(PERCENT):
        stated = "%"
    doubt = ""
    if not quantity and not stated and is_clock(name, held.values):
        quantity, stated = TIME, name.strip()
    letter = by_letter(name) and name.strip() != "t"
    if not quantity or (letter and unit_written(stated, quantity) is None):
        dimensions = {one.dimension for one in units_written(stated)} & {ANGLE, TORQUE, SPEED, TIME}
        if stated.strip().lower() in COUNT_UNIT_NAMES:
            dimensions = {COUNT}
        if len(dimensions) != 1:
            long = unit_written(stated, LENGTH) is not None and not dimensions
            return Meaning(channel=channel, dimension=LENGTH if long else "")
        quantity = dimensions.pop()
        # Nothing else of a drive is told in seconds and runs on evenly.
        timed = quantity == TIME and unit_written(stated, TIME) is not None and runs_evenly(held.values)
        doubt = "" if timed else f"known by its unit alone, {stated}"
        if quantity == TIME and not rises(held.values) and not rises(-held.values):
            return Meaning(channel=channel, unit=unit_written(stated, TIME), dimension=TIME)
        if quantity == ANGLE and swings(held.values):
            return Meaning(channel=channel, dimension=OTHER_QUANTITY)
    if quantity == TIME:
        unit = unit_written(stated, TIME)
        if unit is None and not stated and "dat" in plain(name) and are_days(held.values):
            doubt = "a date as spreadsheets count them, in days"
            ask = (entry("time_s", channel, UNITS[TIME]["d"]),)
            unit = UNITS[TIME]["d"]
            return Meaning(
                channel=channel, column="time_s", unit=unit, dimension=TIME, why=f'"{name}"', doubt=doubt, ask=ask
            )
        counted = since_1970(held.values) if unit is None and not stated else None
        if counted is not None:
            why = f'"{name}", {told_since(counted)}'
            return Meaning(channel=channel, column="time_s", unit=counted, dimension=TIME, why=why)
        clock = next((CLOCKS[one] for one in tokens(name) if one in CLOCKS), "") if not stated else ""
        if clock and rises(held.values):
            unit, stated = UNITS[TIME][clock], clock
        elif clock and rises(went_on(held.values, CLOCK_TICKS)):
            doubt = f"{clock} that begin again after {CLOCK_TICKS} of them"
            ask = (entry("time_s", channel, UNITS[TIME][clock], f"wraps = {CLOCK_TICKS}"),)
            return Meaning(
                channel=channel, column="time_s", unit=UNITS[TIME][clock], dimension=TIME, why=f'"{name}"', doubt=doubt,
                ask=ask,
            )  # fmt: skip
        settled = replace(_settled(channel, name, "time_s", unit, stated, TIME, doubt), named=not doubt)
        if unit is None and not stated:
            likely, lasts = likely_time(held.values)
            ask = (entry("time_s", channel, likely),)
            settled = replace(settled, unit=likely, doubt=settled.doubt + lasts, ask=ask)
        return settled
    if quantity == COUNT:
        doubt = "counts of an encoder whose lines are not stated"
        found = Meaning(channel=channel, dimension=COUNT, why=f'"{name}"', doubt=doubt)
        return _counted(found, shaft or "driving", held.values)
    if quantity == TE:
        unit = unit_written(stated, ANGLE) or unit_written(stated, LENGTH)
        column = "te_um" if unit is not None and unit.dimension == LENGTH else "te_arcsec"
        doubt = "a transmission error, whose sign no name tells (positive where the driven gear is ahead)"
        ask = (entry(column, channel, unit, "sign = 1"),)
        return Meaning(channel=channel, column=column, unit=unit, dimension=TE, why=f'"{name}"', doubt=doubt, ask=ask)
    if quantity == AXIS:
        unit = unit_written(stated, ANGLE)
        doubt = (
            "the error of a telescope's axis, whose sign no name tells (positive where the axis is ahead), nor whether "
            "it was guided"
        )
        ask = (entry(AXIS_ERROR, channel, unit, *(["scale = 1.0"] if stated and unit is None else []), "sign = 1"),)
        return Meaning(
            channel=channel, column=AXIS_ERROR, unit=unit, dimension=AXIS, why=f'"{name}"', doubt=doubt, ask=ask
        )
    if quantity == WORM:
        return _settled(channel, name, WORM_ANGLE, _unit_of(name, stated, ANGLE, held.values), stated, WORM, "")
    columns = {ANGLE: f"{shaft or 'driving'}_angle_deg", TORQUE: "torque_nm", SPEED: "speed_rpm"}
    unit = _unit_of(name, stated, quantity, held.values)
    doubts = [doubt] if doubt else []
    other = contradicting(held.values, unit) if quantity == ANGLE and unit is not None else None
    if unit is not None and other is not None:
        many = f" (or after more turns: unit = {quoted(unit.name)} and wraps)" if other.name[:1].isdigit() else ""
        doubts.append(
            f"the unit {stated or unit.name}, and its readings begin again after one turn as in {other.name}{many}"
        )
        unit = other
    modulus = counter_modulus(held.values) if quantity == ANGLE and unit is not None and other is None else None
    if unit is not None and modulus is not None and not are_whole_turns(modulus * unit.size):
        doubt = f"the unit {stated}, and its readings are counts that begin again after {modulus}"
        asked = counter_entries(columns[ANGLE], channel, modulus, stated=bool(stated))
        return Meaning(channel=channel, column=columns[ANGLE], dimension=ANGLE, why=f'"{name}"', doubt=doubt, ask=asked)
    of_other = (quantity, shaft) in ((TORQUE, "driving"), (SPEED, "driven"))
    if quantity == TORQUE and shaft == "driving":
        doubts.append(f"a torque of the driving shaft (torque_nm is of the driven one: scale is {TEETH_RATIO})")
    elif quantity == SPEED and shaft == "driven":
        doubts.append(f"a speed of the driven shaft (speed_rpm is of the driving one: scale is {TEETH_RATIO})")
    elif not shaft:
        doubts.append(f"no word says of which shaft the {quantity} is")
    settled = _settled(channel, name, columns[quantity], unit, stated, quantity, ", ".join(doubts))
    if unit is not None and of_other:
        settled = replace(settled, ask=(entry(columns[quantity], channel, unit, f'scale = "{TEETH_RATIO}"'),))
    if quantity == ANGLE and unit is None:
        settled = replace(settled, ask=analog_entries(columns[ANGLE], channel, held.values, stated=stated))
    return replace(settled, named=not doubt)


def _counted(one: Meaning, shaft: str, values: FloatArray) -> Meaning:
    """Counts (n,) as those of a ``shaft``, with the lines of a map that say so, as turns where they begin again."""
    modulus = turn_of_counts(values)
    if modulus is None:
        return replace(one, column=f"{shaft}_count", ask=counts_entries(shaft, one.channel))
    doubt = f"counts of an encoder that begin again after {modulus}, which may be one turn"
    ask = counter_entries(f"{shaft}_angle_deg", one.channel, modulus)
    return replace(one, column=f"{shaft}_count", doubt=doubt, ask=ask)


def _by_own_name(channel: str, column: str, stated: str) -> Meaning:
    """The meaning of a channel that is called as a ``column`` is; in doubt where it states another unit."""
    unit = column_unit(column)
    if stated.strip().lower() in UNSTATED or unit.dimension == COUNT or unit_written(stated, unit.dimension) == unit:
        return Meaning(channel=channel, column=column, unit=unit, dimension=unit.dimension, why="the name of a column")
    ask = (entry(column, channel, unit_written(stated, unit.dimension)),)
    doubt = f'the unit "{shown(stated)}", and its name says {unit.name}'
    return Meaning(channel=channel, column=column, dimension=unit.dimension, why="its name", doubt=doubt, ask=ask)


def _settled(
    channel: str, name: str, column: str, unit: Unit | None, stated: str, dimension: str, doubt: str
) -> Meaning:
    """The meaning of a channel whose quantity is known; without a unit it is a doubt."""
    ask: tuple[str, ...] = (entry(column, channel, unit),)
    if unit is None:
        what = f'its unit "{shown(stated)}" is none of {dimension}' if stated else f"no unit of {dimension} is stated"
        if stated:
            what, ask = scaled(channel, column, stated, dimension, what)
        doubt = f"{doubt}, and {what}" if doubt else what
    known = f"unit {stated}" if stated else "its readings begin again after one turn"
    return Meaning(
        channel=channel,
        column=column,
        unit=unit,
        dimension=dimension,
        why=f'"{name}", {known}' if unit is not None else f'"{name}"',
        doubt=doubt,
        ask=ask if doubt else (),
    )


def _unit_of(name: str, stated: str, dimension: str, values: FloatArray) -> Unit | None:
    """The unit of a channel: the one stated, or that in which an angle begins again after one turn."""
    if stated.strip().lower() in DOUBTFUL and dimension == ANGLE:
        if re.search(_GERMAN, plain(name)):
            return UNITS[ANGLE]["deg"]
        return wrapped_unit(values)
    if stated:
        if dimension == SPEED and is_per_second(stated) and ANGULAR_SPEED.search(plain(name)):
            return UNITS[SPEED]["rad/s"]
        return unit_written(stated, dimension)
    return wrapped_unit(values) if dimension == ANGLE else None
