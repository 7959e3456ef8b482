"""The orders at which two shafts and their mesh can make waves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.units import BoolArray, FloatArray, IntArray

BESIDE_WHOLE = 0.5
"""Independent lines from a whole order of a shaft within which a sum or difference of both shafts' orders is taken for
it. In a log of one turn of a worm and a half its order 2 was told as a difference 0.13 lines beside it, and its order 1
as 69.0 +- 0.9 um, of 77."""


PART_SEEN = 0.75
"""Part of a shaft's turn that was recorded from which on its orders are told one from the next: at three quarters two
neighbours share a third of their size, at one half two thirds."""


@dataclass(frozen=True, kw_only=True, eq=False)
class KnownOrders:
    """Integer orders of both shafts below the sampling's limit, and the lowest sums and differences of both shafts.

    ``place`` (k,) frequencies in cycles per mesh times lcm(z_1, z_2): first ``first`` orders of the driving shaft
    from 1 on, then those of the driven shaft that are none of the driving, then the sums and differences.
    """

    z_1: int
    z_2: int
    first: int
    second: IntArray
    place: IntArray

    @property
    def period(self) -> int:
        """Meshes in a hunting cycle."""
        return math.lcm(self.z_1, self.z_2)

    @property
    def whole(self) -> IntArray:
        """Places of the integer orders alone."""
        return self.place[: self.first + self.second.size]

    @property
    def frequency(self) -> FloatArray:
        """Frequencies (k,) in cycles per mesh."""
        return self.place / float(self.period)

    def told_apart(self, span: float) -> BoolArray:
        """Which of them (k,) a record of ``span`` meshes tells from whole orders: all but sums and differences that lie
        within ``BESIDE_WHOLE`` of one."""
        whole, mixed = np.sort(self.whole), self.place[self.whole.size :]
        near = np.clip(np.searchsorted(whole, mixed), 1, whole.size - 1)
        off = np.minimum(np.abs(mixed - whole[near - 1]), np.abs(mixed - whole[near]))
        apart = off * span / self.period > BESIDE_WHOLE
        return np.concatenate([np.ones(whole.size, dtype=np.bool_), apart])

    def told_by(self, u: FloatArray) -> BoolArray:
        """Which of them (k,) samples at ``u`` (n,) meshes tell from others: none that comes of a shaft of which less
        than a turn was recorded, or the same part of every turn is missing, but for the mesh's own. A flank that an arm
        hangs on in one half of its turn showed order 5 as 1868 mm; of a joint that swings over a third of a turn orders
        100 and 102 were told to a hundredth."""
        out: BoolArray = np.ones(self.place.size, dtype=np.bool_)
        whole = self.whole.size
        for z, mine in (
            (self.z_1, np.arange(whole) < self.first),
            (self.z_2, self.place[:whole] % (self.period // self.z_2) == 0),
        ):
            if np.unique(np.floor(np.mod(u, z))).size < PART_SEEN * z:
                out[:whole] &= ~mine
                out[whole:] = False
        return np.asarray(out | (self.place % self.period == 0))


def known_orders(z_1: int, z_2: int, *, nyquist: float, slowest: float) -> KnownOrders:
    """The orders between ``slowest`` and ``nyquist`` cycles per mesh (the slower ones stand in the list all the
    same)."""
    period = math.lcm(z_1, z_2)
    one, two = period // z_1, period // z_2
    top = max(int(nyquist * period), one + 1)
    driving = np.arange(one, top, one)
    driven = np.arange(two, top, two)
    driven = driven[driven % one != 0]
    both = set(driving.tolist()) | set(driven.tolist())
    mixed = {abs(i * one + j * two) for i in (1, 2) for j in (-2, -1, 1, 2)}
    rest = np.array(sorted(k for k in mixed - both if slowest * period < k < top), dtype=np.int64)
    return KnownOrders(
        z_1=z_1, z_2=z_2, first=driving.size, second=driven // two, place=np.concatenate([driving, driven, rest])
    )
