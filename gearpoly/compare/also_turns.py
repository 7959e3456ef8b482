"""Located waves that another part of the drive has at the same place, which the pair file states."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from gearpoly.compare.entries import Entry
from gearpoly.keys.also_turns import HALF_A_LINE, Part, lines_at

SAME_ORDER_SIGMAS = 3.0
"""Standard errors of an order within which it may be a part's."""


def with_parts(
    entries: Sequence[Entry],
    parts: Sequence[Part],
    *,
    z: tuple[int, int],
    turns: Sequence[float],
    speeds: Sequence[float | None],
) -> tuple[Entry, ...]:
    """The ``entries`` with the parts that have a line there; ``turns`` of the driven gear of each recording, and the
    driving ``speeds`` in rad/s, where known."""
    if not parts:
        return tuple(entries)
    return tuple(_with_parts(one, parts, z, turns, speeds) for one in entries)


def _with_parts(
    entry: Entry, parts: Sequence[Part], z: tuple[int, int], turns: Sequence[float], speeds: Sequence[float | None]
) -> Entry:
    longest = max(entry.recordings, key=lambda k: turns[k], default=None)
    order = None if longest is None else _per_driven(entry, z, speeds[longest])
    if order is None or longest is None or turns[longest] <= 0.0:
        return entry
    length = min(turns[longest], HALF_A_LINE / max(SAME_ORDER_SIGMAS * relative_std(entry) * order, 1e-300))
    return replace(entry, parts=lines_at(tuple(parts), order, turns=length))


def relative_std(entry: Entry) -> float:
    """The standard error of a wave's order or frequency as a part of it; 0 where it is a whole order."""
    return (entry.order_std or 0.0) / (entry.order or 1.0) + (entry.hz_std or 0.0) / (entry.hz or 1.0)


def _per_driven(entry: Entry, z: tuple[int, int], speed: float | None) -> float | None:
    """The order of a wave per turn of the driven gear; None where the entry is none."""
    ratio = z[1] / z[0]
    if entry.kind == "mesh_order" and entry.order is not None:
        return entry.order * z[1]
    if entry.kind == "shaft_order" and entry.order is not None:
        return entry.order * (1.0 if entry.gear == "driven" else ratio)
    if entry.kind == "time" and entry.hz and speed and entry.burst is None:
        return entry.hz * 2.0 * math.pi / speed * ratio
    return None
