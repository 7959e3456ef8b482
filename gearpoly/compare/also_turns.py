"""Other parts of a drive that the pair file states, and the lines that they make: a motor, a belt, a further stage.

A part that turns t times for one turn of the driven gear makes waves at whole multiples k t: k = 1 where it runs off
its axis, low ones for its pitch, its teeth where it meshes, with side bands. Where such a line falls on an order of the
pair, no recording of this pair tells them apart.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from gearpoly.compare.describe import HALF_A_LINE, SIDE_BANDS
from gearpoly.compare.entries import Entry
from gearpoly.files.models import AlsoTurns

LOW_ORDERS = 6
"""Orders of its own turn up to which a part without teeth makes waves: bearings out of round, couplings, a motor's
poles. Wheels wave like this pair's own, up to half their teeth."""

MESH_ORDERS = 3
"""Harmonics of a part's mesh that are looked for; higher ones hardly pass a drive."""

SURE = 3.0
"""Standard errors of an order within which it may be a part's."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """A part of the drive: its ``name``, its ``turns`` for one turn of the driven gear, and its ``teeth`` if it
    meshes."""

    name: str
    turns: float
    teeth: int | None = None

    def line(self, order: float, within: float) -> str | None:
        """Which of its lines lies at ``order`` per turn of the driven gear, to ``within``, in words; ``None`` where
        none does."""
        k = round(order / self.turns)
        if k < 1 or abs(k * self.turns - order) > within:
            return None
        if k == 1:
            return f"the {self.name}'s turn"
        mesh = 0 if self.teeth is None else max(1, min(MESH_ORDERS, round(k / self.teeth)))
        beside = k - mesh * (self.teeth or 0)
        if mesh and abs(beside) <= SIDE_BANDS:
            whole = f"the {self.name}'s mesh" if mesh == 1 else f"mesh order {mesh} of the {self.name}"
            return whole if beside == 0 else f"side band {beside:+d} of {whole}"
        return f"order {k} of the {self.name}" if k <= max(LOW_ORDERS, (self.teeth or 0) // 2) else None


def parts_of(stated: Iterable[AlsoTurns], *, z_1: int, z_2: int) -> tuple[Part, ...]:
    """The parts that a pair file of ``z_1`` on ``z_2`` teeth states, their turns per turn of the driven gear."""
    return tuple(
        Part(
            name=one.name.removeprefix("the "),
            turns=one.turns_per_driven or (one.turns_per_driving or 0.0) * z_2 / z_1,
            teeth=one.teeth,
        )
        for one in stated
    )


def lines_at(parts: Iterable[Part], order: float, *, turns: float) -> tuple[str, ...]:
    """What of ``parts`` has a line at ``order`` per turn of the driven gear, in words, as far as a recording of so many
    ``turns`` of it resolves."""
    found = (one.line(order, HALF_A_LINE / turns) for one in parts)
    return tuple(words for words in found if words is not None)


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
    std = (entry.order_std or 0.0) / (entry.order or 1.0) + (entry.hz_std or 0.0) / (entry.hz or 1.0)
    length = min(turns[longest], HALF_A_LINE / max(SURE * std * order, 1e-300))
    return replace(entry, parts=lines_at(parts, order, turns=length))


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
