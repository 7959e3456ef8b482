"""Recordings of another pair of teeth with the same ratio: its mesh stands at another order of either shaft.

Derived here. Travels of both shafts agree, and so do all whole orders. What tells is that the strongest fast order of a
shaft, with its multiples, is that of other teeth, and hardly anything is left at the mesh of the declared ones.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from gearpoly.compare.entries import Entry

NEAR = 0.25
"""Part of the declared teeth by which they may be off. Who counts wrong is off by one or two. A judgement."""

FAMILY = 3
"""Orders that have to stand there, the mesh and its multiples: a wheel on the same shaft, or the machine that cut a
gear, seldom leaves more than two. A judgement."""

FAST = 0.5
"""Orders over the declared teeth from which on the mesh has to be the strongest: below, gears err by themselves."""

SAME = 1e-3
"""Orders within which one is a whole multiple of another."""


@dataclass(frozen=True, kw_only=True)
class SameRatio:
    """The ``teeth`` (driving, driven) whose mesh shows at these ``orders`` of the driving shaft, in the stead of the
    ``declared`` ones, which have the same ratio."""

    teeth: tuple[int, int]
    declared: tuple[int, int]
    orders: tuple[int, ...]

    @property
    def says(self) -> str:
        """What the engineer should know."""
        *first, last = self.orders
        z_1, z_2 = self.declared
        return (
            f"orders {', '.join(map(str, first))} and {last} of the driving shaft are the strongest fast ones, as a "
            f"mesh of {self.teeth[0]} on {self.teeth[1]} teeth would make them, which have the ratio of {z_1} on "
            f"{z_2}: count the teeth and correct teeth in the pair file, or state the wheel that makes them under "
            "[[also_turns]]; no physics is named of such a recording"
        )


def same_ratio(entries: Sequence[Entry], *, z: tuple[int, int]) -> SameRatio | None:
    """Whether what was located is the mesh of other teeth with the ratio of ``z`` declared ones; None where it is not,
    or where no other teeth near these have it."""
    z_1, z_2 = z
    step = z_1 // math.gcd(z_1, z_2)
    sizes = _by_order(entries, z=z)
    fast = {order: size for order, size in sizes.items() if order > FAST * z_1}
    if not fast:
        return None
    mesh = max(fast, key=lambda order: fast[order])
    if mesh % step or mesh % z_1 == 0 or abs(mesh - z_1) > NEAR * z_1:
        return None
    family = tuple(sorted(order for order in fast if order % mesh == 0))
    if len(family) < FAMILY:
        return None
    return SameRatio(teeth=(mesh, mesh * z_2 // z_1), declared=z, orders=family)


def _by_order(entries: Sequence[Entry], *, z: tuple[int, int]) -> dict[int, float]:
    """The amplitude in um of what stands at each whole order of the driving shaft, and of no stated part."""
    out: dict[int, float] = {}
    for one in entries:
        if one.order is None or one.amplitude_um is None or one.parts or one.kind not in ("shaft_order", "mesh_order"):
            continue
        per = z[0] if one.kind == "mesh_order" else z[0] / z[1] if one.gear == "driven" else 1.0
        order = one.order * per
        whole = round(order)
        if whole > 0 and abs(order - whole) < SAME:
            out[whole] = max(out.get(whole, 0.0), one.amplitude_um)
    return out
