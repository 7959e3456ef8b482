"""What is asked where a recording's columns are in doubt: one message with the lines of a map that settle it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.by_readings import are_levels, are_row_numbers, comes_back, level_changes, runs_evenly, swings
from gearpoly.recording.header import header_unit
from gearpoly.recording.map_lines import angle_entries, each_once, entry, likely_time
from gearpoly.recording.meant import ONE_OF_SEVERAL_RUNS, Meaning
from gearpoly.recording.pulse_times import asked_of_pulses
from gearpoly.recording.quantities import ANGLE, COUNT, LENGTH, SPEED, TIME, TORQUE, Unit, unit_written
from gearpoly.recording.recording import ANGLE_COLUMNS, SHAFTS, TE_COLUMNS, raw_channels
from gearpoly.recording.table import AXIS_ERROR, OF_WORDS, PULSE_TIMES, Channel, Table
from gearpoly.recording.words import OTHER_QUANTITY, RADIAL, TE, tokens

SETTLE = "gearpoly read FILE --write map.toml writes them, --map map.toml takes them"

ASKED = (TIME, TORQUE)
"""Quantities that are asked for where their names say them and no more, beside angles: left out they would change what
is found without a word."""

ASKED_AT_ONCE = 4
"""Columns in doubt that one message names: time, both angles and a torque."""

NO_ANGLES = (TIME, SPEED, LENGTH, OTHER_QUANTITY, RADIAL)
"""Dimensions of channels that are offered for no angle."""


def angles_known(names: Iterable[str]) -> bool:
    """Whether columns suffice for a transmission error."""
    held = set(names)
    shafts = sum(
        angle in held or bool({"a", "count"} & set(raw_channels(held, shaft)))
        for shaft, angle in zip(SHAFTS, ANGLE_COLUMNS, strict=True)
    )
    if any(name in PULSE_TIMES for name in held):
        return True  # what is lacking is told where they are read
    return shafts == 2 or (shafts == 1 and any(name in held for name in TE_COLUMNS)) or AXIS_ERROR in held


def ask(file: Path, meant: Sequence[Meaning], out: Table, channels: Mapping[str, Channel]) -> None:
    """Raise where what a comparison needs is in doubt, of the ``channels`` of a file."""
    doubtful = [one for one in meant if one.doubt and one.column not in out.columns]
    needed = [one for one in doubtful if one.twice or (one.dimension in ASKED and one.named)]
    if not angles_known(out.columns):
        _check_kind(file, meant)
        pulses = asked_of_pulses(meant, dict(channels))
        if pulses is not None:
            wish = f"{wish_for(pulses[1])}; lines are the pulses of a turn"
            raise InputFileError(file, found=pulses[0], wish=wish)
        angles = [one for one in doubtful if one.dimension == ANGLE] or [
            one for one in doubtful if one.dimension not in (*ASKED, SPEED)
        ]
        needed = [*angles, *(one for one in needed if one not in angles)]
        if not angles:
            there = shorten(", ".join(one.channel for one in meant), width=200)
            lacking = [name for name in ANGLE_COLUMNS if name not in out.columns]
            lacks = " and ".join(lacking)
            used = out.taken_from.values()
            free = [one for one in meant if one.channel not in used and one.dimension not in NO_ANGLES]
            first = next((one.run for one in meant if one.run), "")
            free = [one for one in free if one.run in ("", first) and not _is_no_angle(one, channels)]
            timed = "time_s" in out.columns or any(one.column == "time_s" for one in meant)
            ask = _offered([*([] if timed else ["time_s"]), *lacking], free, channels)
            if meant and all(one.channel == f"column {k}" for k, one in enumerate(meant, start=1)):
                wish = f"want a line of names above them, or {wish_for(ask).removeprefix('want ')}"
                if len(meant) == len(ANGLE_COLUMNS):
                    wish += "; above seconds and arcsec of a telescope's periodic error: Time [s] and PE [arcsec]"
                raise InputFileError(file, found=f"{len(meant)} columns of numbers without names", wish=wish)
            if out.unread is not None and (len(free) < len(lacking) or not out.unread[0].endswith(OF_WORDS)):
                found = f"no column that is surely {lacks}{f', only {there}' if there else ''}; and {out.unread[0]}"
                raise InputFileError(file, found=found, wish=out.unread[1])
            beside = _of_one_encoder(free, channels)
            every = each_once([*ask, *(line for one in needed for line in one.ask)])
            long = next((one.channel for one in meant if one.dimension == LENGTH), "")
            if len(free) < len(lacking) == 1 and long:
                wish = wish_for([entry("te_um", long, unit_of_length(long, channels), "sign = 1")])
                wish += "; a centre distance, as double-flank tests have it, is no transmission error"
                found = f'no column that is surely {lacks}, only "{shorten(long)}", a length'
                raise InputFileError(file, found=found, wish=wish)
            if len(free) < len(lacking):
                wish = "want the readings of both shafts, or of one and a transmission error, in one file"
                if {"sin", "cos"} <= {word for one in meant for word in tokens(one.channel)}:
                    wish += "; of sine and cosine make a column of each angle first: atan2(sine, cosine)"
                raise InputFileError(file, found=f"no column that is surely {lacks}, only {there}", wish=wish)
            raise InputFileError(
                file,
                found=f"no column that is surely {lacks}, only {there}",
                wish=wish_for(every) + beside,
            )
        errors = [one for one in doubtful if one.dimension == TE and one not in needed and len(angles) < 2]
        needed = [*needed, *errors]
        _check_other(file, meant, [*out.columns, *(one.column for one in doubtful)], channels)
    if needed:
        torques = [one for one in needed if one.dimension == TORQUE and not (one.shaft or one.twice)]
        if len(torques) == 2:  # of two in a row the second is the driven shaft's, as of angles
            needed = [*(one for one in needed if one not in torques), *torques[::-1]]
        raise _in_doubt(file, needed)


def _check_other(file: Path, meant: Sequence[Meaning], able: Sequence[str], channels: Mapping[str, Channel]) -> None:
    """Raise ``InputFileError`` where the columns that a recording is ``able`` to have are no more than one shaft's, and
    nothing else may be the other's."""
    if angles_known(able) or any(
        one.dimension in ("", COUNT) and not _is_no_angle(one, channels) for one in meant if one.column not in able
    ):
        return
    there = shorten(", ".join(one.channel for one in meant), width=200)
    held = "a transmission error alone" if any(name in TE_COLUMNS for name in able) else "the angle of one shaft alone"
    wish = "want the readings of both shafts, or of one and a transmission error, in one file"
    raise InputFileError(file, found=f"{held}, by its names: {there}", wish=wish)


SAME_EDGES = 0.01
"""Part by which the edges of two channels may differ in number and be A and B of one encoder."""


def _of_one_encoder(free: Sequence[Meaning], channels: Mapping[str, Channel]) -> str:
    """A word about two channels of levels with as many edges, which may be those of one encoder."""
    held = [channels[one.channel].values for one in free if one.channel in channels]
    edges = [level_changes(one) for one in held if are_levels(one)]
    if len(edges) < 2 or abs(edges[0] - edges[1]) > SAME_EDGES * edges[0] + 1:
        return ""
    return (
        "; both have as many edges: A and B of one encoder are driving_a and driving_b, and the other shaft is lacking"
    )


def _is_no_angle(one: Meaning, channels: Mapping[str, Channel]) -> bool:
    """Whether a channel of no known quantity turns no shaft by its readings: it swings, or stands, and is no pulse."""
    held = channels.get(one.channel)
    return not one.dimension and held is not None and swings(held.values) and not are_levels(held.values)


def _check_kind(file: Path, meant: Sequence[Meaning]) -> None:
    """Raise ``InputFileError`` where columns are of another test than of both shafts' angles."""
    radial = [one.channel for one in meant if one.dimension == RADIAL]
    if radial and not any(one.dimension == TE for one in meant):
        found = f'"{shorten(radial[0])}" of a double-flank test: a radial composite deviation, no transmission error'
        wish = "want a single-flank test: both shafts' angles, or one of them and a transmission error (F_i' is "
        wish += "tangential, F_i'' radial; what touches on both flanks at once tells neither flank)"
        raise InputFileError(file, found=found, wish=wish)
    runs = [one for one in meant if one.dimension == ONE_OF_SEVERAL_RUNS]
    if runs and not any(one.dimension == TE for one in meant):
        names = shorten(", ".join(f'"{one.channel}"' for one in runs[:ASKED_AT_ONCE]), width=120)
        found = f"columns {names} of runs side by side, which name no shafts"
        wish = "want both shafts of a run, or one and a transmission error, each under its own name: Run 1 input "
        wish += "angle [deg], Run 1 output angle [deg]"
        raise InputFileError(file, found=found, wish=wish)


def _in_doubt(file: Path, needed: Sequence[Meaning]) -> InputFileError:
    """The error for columns in doubt: what each may be, and a line of a map for each that asks for another key."""
    named = needed[:ASKED_AT_ONCE]
    by_doubt: dict[str, list[str]] = {}
    for one in named:
        by_doubt.setdefault(one.doubt, []).append(f'"{shorten(one.channel)}"')
    lines = each_once(line for one in named for line in one.ask)
    (doubt, columns), *others = by_doubt.items()
    says = "".join(f"; {' and '.join(channels)}: {other}" for other, channels in others)
    beyond = f" (and {len(needed) - len(named)} more in doubt)" if len(needed) > len(named) else ""
    where = f"column{'s' * (len(columns) > 1)} {' and '.join(columns)}"
    return InputFileError(file, where=where, found=f"{doubt}{says}{beyond}", wish=wish_for(lines))


def _offered(lacking: Sequence[str], free: Sequence[Meaning], channels: Mapping[str, Channel]) -> tuple[str, ...]:
    """The lines of a map for the angles, and the time, that no name says, one channel for each: those whose names say
    the shaft, then those that say the least else and go on; for the time the first where its readings run evenly."""
    rows = [one for one in free if one.channel in channels and are_row_numbers(channels[one.channel].values)]
    back = [one for one in free if one.channel in channels and comes_back(channels[one.channel].values)]
    rest = [one for one in free if one not in rows]
    likely = [*sorted(rest, key=lambda one: (bool(one.dimension), one in back)), *rows]
    out = []
    if lacking[0] == "time_s":
        lacking = lacking[1:]
        first = channels.get(likely[0].channel) if len(likely) > len(lacking) else None
        if first is not None and not likely[0].shaft and runs_evenly(first.values):
            out.append(entry("time_s", likely.pop(0).channel, likely_time(first.values)[0]))
    chosen: dict[str, Meaning] = {}
    for said in (True, False):
        for angle in lacking:
            shaft = angle.partition("_")[0]
            left = [one for one in likely if one not in chosen.values() and one.shaft == (shaft if said else "")]
            if angle not in chosen and left:
                chosen[angle] = left[0]
    for angle in lacking:  # whatever its name says, there is nothing else
        left = [one for one in likely if one not in chosen.values()]
        if angle not in chosen and left:
            chosen[angle] = left[0]
    nothing = np.empty(0)
    for angle, one in sorted(chosen.items(), key=lambda pair: lacking.index(pair[0])):
        held = channels.get(one.channel)
        out += angle_entries(angle, one.channel, nothing if held is None else held.values)
    return tuple(out)


def unit_of_length(name: str, channels: Mapping[str, Channel]) -> Unit | None:
    """The unit of length that a channel states."""
    held = channels.get(name)
    return unit_written((held.unit if held is not None else "") or header_unit(name)[1], LENGTH)


def wish_for(ask: Sequence[str]) -> str:
    each = ", each on a line" if len(ask) > 1 else ""
    return f"want in a map, if so{each}: {' '.join(ask)} ({SETTLE})"
