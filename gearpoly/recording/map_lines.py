"""Lines of a map as messages name them: each settles what is in doubt of a channel, as it stands or filled in."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable

import numpy as np

from gearpoly.recording.by_readings import (
    are_counts,
    are_levels,
    begins_again_about,
    begins_again_at,
    counter_modulus,
    wrapped_unit,
)
from gearpoly.recording.deeds import in_full
from gearpoly.recording.quantities import ANGLE, COUNT, SPEED, TIME, TORQUE, UNITS, Unit, column_unit
from gearpoly.units import FloatArray

LEAVE_OUT_LINE = "leave_out = "
"""How the line begins that leaves channels out."""


TEETH_RATIO = "z_2/z_1"
"""Stands in a line of a map for a number that only the pair tells: such a map is refused, so that it is filled in."""


def entry(column: str, channel: str, unit: Unit | None, *more: str) -> str:
    """The line of a map that gives the ``column`` to a channel, in the contract's unit where none is known."""
    held = [f"from = {quoted(channel)}"]
    if column_unit(column).dimension != COUNT:
        held.append(f"unit = {quoted((unit or column_unit(column)).name)}")
    return f"columns.{column} = {{ {', '.join([*held, *more])} }}"


def with_more(line: str, more: str) -> str:
    """The ``line`` of a map that gives a column, with one thing more."""
    return f"{line.removesuffix(' }')}, {more} }}"


def with_unit(line: str, unit: str) -> str:
    """The ``line`` of a map that gives a column, with another ``unit``."""
    return re.sub(r'unit = "[^"]*"(?=[^"]*\}$)', f'unit = "{unit}"', line)


def turned_round(line: str) -> str:
    """The ``line`` of a map that gives a column, with the other sign."""
    return line.replace(", sign = -1", "") if ", sign = -1" in line else with_more(line, "sign = -1")


def quoted(text: str) -> str:
    """A text as TOML writes it, whatever it holds; what does not print is escaped, so that it can be copied."""
    held = json.dumps(text, ensure_ascii=False)
    return held if held.isprintable() else "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in held)


def left_out(channel: str) -> str:
    """The line of a map that leaves a channel out."""
    return f"{LEAVE_OUT_LINE}[{quoted(channel)}]"


def each_once(lines: Iterable[str]) -> list[str]:
    """The lines of a map, the first of each key; what several leave out is in one."""
    held: dict[str, str] = {}
    for line in lines:
        key = line.partition(" = ")[0]
        if line.startswith(LEAVE_OUT_LINE) and key in held:
            held[key] = f"{held[key][:-1]}, {line[len(LEAVE_OUT_LINE) + 1 :]}"
        else:
            held.setdefault(key, line)
    return list(held.values())


def angle_entries(column: str, channel: str, values: FloatArray) -> tuple[str, ...]:
    """The lines that give an angle's ``column`` to a channel with readings (n,) and no unit: in that in which they
    begin again after one turn, as counts, or as the pulses of an encoder."""
    shaft = column.partition("_")[0]
    modulus = counter_modulus(values)
    if are_levels(values):
        return (entry(f"{shaft}_a", channel, None), lines_entry(shaft))
    if modulus is not None:
        return counter_entries(column, channel, modulus)
    if are_counts(values):
        return counts_entries(shaft, channel)
    unit = wrapped_unit(values)
    return (entry(column, channel, unit),) if unit is not None else analog_entries(column, channel, values)


TURN_UNITS = ("u", "umdr", "r", "t", "tr", "cyc", "cycle", "cycles", "vuelta", "vueltas")
"""Units of an angle that are likelier turns than anything else, and may be a letter of the owner's own."""


def analog_entries(column: str, channel: str, values: FloatArray, *, stated: str = "") -> tuple[str, ...]:
    """The lines that give an angle's ``column`` to readings (n,) of no unit, or of another one that is ``stated``, such
    as volts: as turns of what they begin again at, where they do, and else with a scale to be filled in."""
    if stated.strip(" .").lower() in TURN_UNITS:
        return (entry(column, channel, UNITS[ANGLE]["rev"]),)
    modulus = counter_modulus(values) or begins_again_at(values)
    if modulus is None:
        return doubtful_entries(column, channel, values, stated=stated)
    return counter_entries(column, channel, modulus, stated=bool(stated))


def doubtful_entries(column: str, channel: str, values: FloatArray, *, stated: str = "") -> tuple[str, ...]:
    """The lines that give an angle's ``column`` to readings (n,) that leave in doubt at what they begin again."""
    about = begins_again_about(values)
    if about is None:
        return (entry(column, channel, None, *(["scale = 1.0"] if stated else [])),)
    shaft, told = column.partition("_")[0], told_about(*about)
    if np.any(values != np.rint(values), where=np.isfinite(values)):
        return (entry(column, channel, UNITS[ANGLE]["rev"], 'scale = "1 / wraps"', f'wraps = "{told}"'),)
    lines = counts_entries(shaft, channel, stated=bool(stated))
    return (lines[0], lines_entry(shaft, f", its counts begin again at {told}"), *lines[2:])


def told_about(middle: float, doubt: float) -> str:
    """A number with its doubt, to the digits that this allows."""
    places = max(0, -math.floor(math.log10(max(doubt, 1e-9))))
    return f"about {middle:.{places}f} +- {math.ceil(doubt * 10**places) / 10**places:.{places}f}"


def counter_entries(column: str, channel: str, modulus: float, *, stated: bool = False) -> tuple[str, ...]:
    """The lines that give an angle's ``column`` to readings that begin again at a ``modulus``, if that is one turn; as
    counts of an encoder whose lines are asked for where it may be no more than the counter's width."""
    if modulus in OF_COUNTERS:
        shaft = column.partition("_")[0]
        return (*counts_entries(shaft, channel, stated=stated), f"keys.{shaft}_count_modulus = {in_full(modulus)}")
    line = entry(column, channel, UNITS[ANGLE]["rev"], f"scale = {1.0 / modulus!r}", f"wraps = {in_full(modulus)}")
    return (line,)


def lines_entry(shaft: str, more: str = "") -> str:
    """The line of a map for the lines of a ``shaft``'s encoder, which no file tells. It holds words, so that a map that
    is not filled in is refused: the same number of both shafts would fit any pair."""
    return f'keys.{shaft}_lines = "those on its label{more}"'


def turn_of_counts(values: FloatArray) -> int | None:
    """The number at which counts (n,) begin again, if it may be a turn: none at which the counter itself goes round."""
    modulus: float | None = counter_modulus(values)
    if modulus is None and not np.any(values != np.rint(values), where=np.isfinite(values)):
        modulus = begins_again_at(values)
    return None if modulus is None or modulus in OF_COUNTERS else int(modulus)


OF_COUNTERS = (2**8, 2**16, 2**24, 2**32)
"""What counters of a whole number of bytes go round at, whatever the encoder has."""


def counts_entries(shaft: str, channel: str, *, stated: bool = False) -> tuple[str, ...]:
    """The lines that give a channel's counts to a ``shaft``, with the lines of the encoder to be filled in; ``stated``:
    the channel states a unit of its own."""
    return (
        entry(f"{shaft}_count", channel, None, *(['unit = "1"'] if stated else [])),
        lines_entry(shaft),
        f"keys.{shaft}_counts_per_line = 4",
    )


def scaled(channel: str, column: str, stated: str, dimension: str, what: str) -> tuple[str, tuple[str, ...]]:
    """What is to say of a channel in a unit of another kind, and the line for it: nobody knows what one of it is."""
    kept, percent = column_unit(column), "%" in stated
    if dimension not in (TORQUE, SPEED):
        return f"{what}: scale is what one of it is in {kept.name}", (entry(column, channel, None, "scale = 1.0"),)
    if percent:
        what = f"in per cent of a {dimension} that is not stated"
    line = entry(column, channel, None, "scale = 0.5")
    example = f"100 % is 50 {kept.name}" if percent else f"one of it is 0.5 {kept.name}"
    return f"{what}; with scale as in {line} if {example}", (left_out(channel),)


def turns_in(values: FloatArray) -> str:
    """How many turns readings (n,) without a unit are in each that people write."""
    held = values[np.isfinite(values)]
    if held.size < 2:
        return ""
    span = float(np.ptp(held)) / 360.0
    return f" ({', '.join(f'{span * UNITS[ANGLE][one].size:.3g} turns in {one}' for one in ('deg', 'rad', 'rev'))})"


WHOLE_STEP = {"ms": 2.0, "us": 1e4, "ns": 1e7}
"""Steps of whole numbers from which they are likelier counted in that unit than in the one before: loggers take from
one sample in 10 s to some thousands in one."""


def likely_time(values: FloatArray) -> tuple[Unit, str]:
    """The unit that times (n,) of none are likelier in, and how long they last in each."""
    held = values[np.isfinite(values)]
    unit = UNITS[TIME]["s"]
    if held.size < 2 or np.any(held != np.rint(held)):
        return unit, ""
    step = abs(float(np.median(np.diff(held))))
    for name, least in WHOLE_STEP.items():
        unit = UNITS[TIME][name] if step >= least else unit
    lasts = [f"{float(np.ptp(held)) * UNITS[TIME][one].size:.4g} s in {one}" for one in ("s", *WHOLE_STEP)]
    return unit, f" (it lasts {', '.join(lasts)})"
