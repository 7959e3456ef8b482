"""Quantities that a file keeps in several columns: seconds beside nanoseconds, degrees beside minutes and seconds."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from gearpoly.files.traces import shorten
from gearpoly.recording.quantities import TIME
from gearpoly.recording.table import Table
from gearpoly.recording.words import quantity_of
from gearpoly.units import FloatArray

_LAST = re.compile(r"(.*?)[\s_.,/\[(]*([A-Za-z]+|°|'|\"|''|\u2032|\u2033)[\])]?", re.DOTALL)
"""The name of a part: what it is of, and its unit."""

SECOND_UNIT_NAMES = frozenset({"s", "sec", "secs", "seconds"})
NANOS = frozenset({"ns", "nsec", "nsecs", "nanosec", "nanosecs", "nanoseconds"})
DEGREES = frozenset({"deg", "degree", "degrees", "grad", "°"})
MINUTES = frozenset({"min", "minute", "minutes", "minuten", "arcmin", "'", "\u2032"})
ARC_SECONDS = frozenset({"sec", "secs", "seconds", "sekunden", "arcsec", '"', "''", "\u2033"})

PER_SECOND = 1e9
"""Nanoseconds, which begin again at the second."""


def join_parts(table: Table) -> None:
    """Put one channel in the place of those that hold one quantity in parts; alone each would be read as the whole, to
    a second or a degree."""
    by_stem: dict[str, dict[str, str]] = {}
    for name, one in table.others.items():
        found = _LAST.fullmatch((one.leaf or name)[:200].strip())
        if found is not None and found[1]:
            by_stem.setdefault(f"{one.group(name)}/{found[1]}", {}).setdefault(found[2].lower(), name)
    _join_millis(table)
    for held in by_stem.values():
        _join_time(table, held)
        _join_angle(table, held)


MILLIS = frozenset({"millitm", "millisecond", "milliseconds", "millisekunden", "millis", "msec", "ms"})

PER_MILLI = 1e3
"""Milliseconds, which begin again at the second."""


def _join_millis(table: Table) -> None:
    """Add a column of milliseconds to the stamps in whole seconds beside it."""
    parts = [name for name, one in table.others.items() if (one.leaf or name).strip().lower() in MILLIS]
    stamps = [name for name, one in table.others.items() if one.unit == "s" and quantity_of(one.leaf or name) == TIME]
    if len(parts) != 1 or len(stamps) != 1 or parts[0] == stamps[0]:
        return
    milli, second = table.others[parts[0]].values, table.others[stamps[0]].values
    if second.shape != milli.shape or not (_whole(second) and _whole(milli) and _within(milli, PER_MILLI)):
        return
    if not np.any(np.diff(milli) < 0.0):
        return
    first = float(milli[np.isfinite(milli)][0])  # stamps are told after the first of them
    table.others[stamps[0]] = replace(table.others[stamps[0]], values=second + (milli - first) / PER_MILLI)
    del table.others[parts[0]]
    table.remarks.append(f"{_named([stamps[0], parts[0]])} are one time, in s after the first")


def _join_time(table: Table, held: Mapping[str, str]) -> None:
    names = _among(held, SECOND_UNIT_NAMES, NANOS)
    if names is None:
        return
    second, nano = (table.others[name].values for name in names)
    if second.shape != nano.shape or not _whole(second) or not _within(nano, PER_SECOND):
        return
    first = float(second[np.isfinite(second)][0])  # small, so that no digit of the second is lost
    _put(table, names, second - first + nano / PER_SECOND, unit="s", what="time")
    table.remarks.append(f"{_named(names)} are one time, in s after the first whole second")


def _join_angle(table: Table, held: Mapping[str, str]) -> None:
    names = _among(held, DEGREES, MINUTES, ARC_SECONDS)
    if names is None:
        return
    degree, minute, second = (table.others[name].values for name in names)
    if not degree.shape == minute.shape == second.shape:
        return
    if not (_whole(degree) and _whole(minute) and _within(minute, 60.0) and _within(second, 60.0)):
        return
    sign = np.where(np.signbit(degree), -1.0, 1.0)
    _put(table, names, degree + sign * (minute / 60.0 + second / 3600.0), unit="deg", what="")
    table.remarks.append(f"{_named(names)} are one angle, taken in decimal degrees")


def _among(held: Mapping[str, str], *sets: Iterable[str]) -> tuple[str, ...] | None:
    """The name of one part of each of the sets of units, or ``None``."""
    found = [next((held[unit] for unit in held if unit in one), None) for one in sets]
    names = tuple(name for name in found if name is not None)
    return names if len(names) == len(found) == len(set(names)) else None


def _whole(values: FloatArray) -> bool:
    held = values[np.isfinite(values)]
    return bool(held.size and (held == np.rint(held)).all())


def _within(values: FloatArray, turn: float) -> bool:
    held = values[np.isfinite(values)]
    return bool(held.size and held.min() >= 0.0 and held.max() < turn)


def _named(names: Iterable[str]) -> str:
    return " and ".join(f'"{shorten(name)}"' for name in names)


def _put(table: Table, names: tuple[str, ...], values: FloatArray, *, unit: str, what: str) -> None:
    """Put the ``values`` where the first part was, called by all of the parts."""
    first = table.others[names[0]]
    leaves = [table.others[name].leaf or name for name in names]
    leaf = " + ".join(leaves) + (f" {what}" if what else "")
    path = first.group(names[0])
    called = f"{path}/{leaf}" if path else leaf
    joined = replace(first, values=values, unit=unit, leaf=leaf if path else "")
    table.others = {
        (called if name == names[0] else name): (joined if name == names[0] else one)
        for name, one in table.others.items()
        if name not in names[1:]
    }
