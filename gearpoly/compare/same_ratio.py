"""Recordings of another pair of teeth with the same ratio: its mesh stands at another order of either shaft.

Derived here. Travels of both shafts agree, and so do all whole orders. What tells is that the mesh of other teeth and
its multiples are the strongest lines far around, and those of the declared teeth are not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.compare.ratio import MESH_PRESENT, SEEN_LOG_ODDS, OrderPower
from gearpoly.keys.also_turns import HALF_A_LINE, Part
from gearpoly.units import FloatArray

MISCOUNTED = 0.25
"""Part of the declared teeth by which they may be off. Who counts wrong is off by one or two. A judgement."""

MESH_ORDERS_STANDING_OUT = 3
"""Orders that have to stand out, the mesh and its multiples, each over all whole orders within half a mesh of it: one
of twenty orders is the strongest by chance, three are once in 8000 times. Of 60 made pairs of grades 4 to 10
with 10 ratios, loaded and not, in 1 to 9 turns, no right file was doubted, and of 336 wrong ones 72 were told, all with
the right teeth."""


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
            f"orders {', '.join(map(str, first))} and {last} of the driving shaft are the strongest far around, as a "
            f"mesh of {self.teeth[0]} on {self.teeth[1]} teeth would make them, which have the ratio of {z_1} on "
            f"{z_2}: count the teeth and correct teeth in the pair file, or state the wheel that makes them under "
            "[[also_turns]]; no physics is named of such a recording"
        )


def other_teeth_of_ratio(z: tuple[int, int]) -> list[int]:
    """Teeth of a driving gear near the declared ``z`` with which a whole number of driven ones has the same ratio."""
    step = z[0] // math.gcd(*z)
    low, high = math.ceil(z[0] * (1.0 - MISCOUNTED) / step), math.floor(z[0] * (1.0 + MISCOUNTED) / step)
    return [k * step for k in range(low, high + 1) if k * step != z[0]]


def same_ratio(every: Sequence[OrderPower], *, z: tuple[int, int], parts: Sequence[Part] = ()) -> SameRatio | None:
    """Whether the recordings whose lines these are, at orders of the driving shaft, show the mesh of other teeth with
    the ratio of ``z`` declared ones; None where they do not. ``parts`` turn beside the pair, and are none of it."""
    highest = math.ceil((MESH_ORDERS_STANDING_OUT + 0.5) * (1.0 + MISCOUNTED) * z[0])
    power = sum((one.at(np.arange(highest + 1.0)) for one in every), np.zeros(highest + 1))
    turns = min(one.length for one in every) * z[0] / z[1]
    for mesh in other_teeth_of_ratio(z):
        orders = tuple(k * mesh for k in range(1, MESH_ORDERS_STANDING_OUT + 1))
        strongest = all(_strongest(power, at, mesh) and power[at] > power[at // mesh * z[0]] for at in orders)
        if not strongest or any(one.line(mesh * z[1] / z[0], HALF_A_LINE / turns) for one in parts):
            continue
        if all(
            sum(one.evidence(np.array([float(at)]), MESH_PRESENT) for one in every) > SEEN_LOG_ODDS for at in orders
        ):
            return SameRatio(teeth=(mesh, mesh * z[1] // z[0]), declared=z, orders=orders)
    return None


def _strongest(power: FloatArray, at: int, mesh: int) -> bool:
    """Whether order ``at`` is the strongest of the whole ones within half a ``mesh``, with power (k,) at each."""
    low, high = math.ceil(at - mesh / 2), math.floor(at + mesh / 2)
    return low + int(np.argmax(power[low : high + 1])) == at
