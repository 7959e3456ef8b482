"""Other parts of a drive that the pair file states, and the lines that they make: a motor, a belt, a further stage.

A part that turns t times for one turn of the driven gear makes waves at whole multiples k t: k = 1 where it runs off
its axis, low ones for its pitch, its teeth where it meshes, with side bands. Where such a line falls on an order of the
pair, no recording of this pair tells them apart.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from gearpoly.keys.sections import AlsoTurns

SIDE_BANDS = 3
"""Orders beside a mesh order that count as its side bands."""

HALF_A_LINE = 0.5
"""Independent lines, one per record, within which two orders are not told apart by their place alone."""

LOW_ORDERS_OF_PART = 6
"""Orders of its own turn up to which a part without teeth makes waves: bearings out of round, couplings, a motor's
poles. Wheels wave like this pair's own, up to half their teeth."""

PART_MESH_ORDERS = 3
"""Harmonics of a part's mesh that are looked for; higher ones hardly pass a drive."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """A part of the drive: its ``name``, its ``turns`` for one turn of the driven gear, and its ``teeth`` if it
    meshes."""

    name: str
    turns: float
    teeth: int | None = None

    def meshes(self) -> Iterable[float]:
        """The orders per turn of the driven gear of its mesh."""
        return () if self.teeth is None else (k * self.teeth * self.turns for k in range(1, PART_MESH_ORDERS + 1))

    def line(self, order: float, within: float) -> str | None:
        """Which of its lines lies at ``order`` per turn of the driven gear, to ``within``, in words; ``None`` where
        none does."""
        k = round(order / self.turns)
        if k < 1 or abs(k * self.turns - order) > within:
            return None
        if k == 1:
            return f"the {self.name}'s turn"
        mesh = 0 if self.teeth is None else max(1, min(PART_MESH_ORDERS, round(k / self.teeth)))
        beside = k - mesh * (self.teeth or 0)
        if mesh and abs(beside) <= SIDE_BANDS:
            whole = f"the {self.name}'s mesh" if mesh == 1 else f"mesh order {mesh} of the {self.name}"
            return whole if beside == 0 else f"side band {beside:+d} of {whole}"
        return f"order {k} of the {self.name}" if k <= max(LOW_ORDERS_OF_PART, (self.teeth or 0) // 2) else None


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


@lru_cache(maxsize=16384)
def lines_at(parts: tuple[Part, ...], order: float, *, turns: float) -> tuple[str, ...]:
    """What of ``parts`` has a line at ``order`` per turn of the driven gear, in words, as far as a recording of so many
    ``turns`` of it resolves."""
    found = (one.line(order, HALF_A_LINE / turns) for one in parts)
    return tuple(words for words in found if words is not None)
