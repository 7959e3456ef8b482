"""The fit of all recordings in blocks of samples, each as all others foretell it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from gearpoly.diagnose.sparse import stacked
from gearpoly.diagnose.system import FLOOR, System, scales_of
from gearpoly.units import FloatArray, IntArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Unseen:
    """What is left of the unseen blocks, white: ``left`` (n,) of all recordings in a row, and ``strain``, by how much
    what was known beforehand is contradicted meanwhile, both squared a misfit."""

    left: FloatArray
    strain: float

    @property
    def misfit(self) -> float:
        """Square misfit, 1 per sample where noise alone is left."""
        return float(self.left @ self.left) + self.strain


class Blocks:
    """A linear ``system`` in blocks: ``number`` (n,) says to which one every sample belongs."""

    def __init__(self, system: System, number: IntArray) -> None:
        self._system, self._number = system, number
        white, target = stacked(system.white), np.concatenate(system.target)
        where = [np.flatnonzero(number == k) for k in range(int(number[-1]) + 1)]
        self._where = where
        self._white, self._target = [white.rows(one) for one in where], [target[one] for one in where]
        self._normal = [a.gram() for a in self._white]
        self._right = [a.T @ y for a, y in zip(self._white, self._target, strict=True)]

    def unseen(self, leave: Sequence[int] = ()) -> Unseen:
        """Every block as the others foretell it, without the parameters ``leave``."""
        system = self._system
        keep = np.setdiff1d(np.arange(system.size), np.asarray(leave, dtype=np.int64))
        at = np.ix_(keep, keep)
        precision, prior = system.precision[at], system.prior[keep]
        normal = precision + sum(one[at] for one in self._normal)
        right = precision @ prior + sum(one[keep] for one in self._right)
        left, strain = np.empty(self._number.size), 0.0
        parts = zip(self._where, self._white, self._target, self._normal, self._right, strict=True)
        for where, a, y, own, mine in parts:
            x = _solved(normal - own[at], right - mine[keep])
            left[where] = y - a.times(keep, x)
            strain += float((x - prior) @ precision @ (x - prior)) / len(self._where)
        return Unseen(left=left, strain=strain)


def _solved(normal: FloatArray, right: FloatArray) -> FloatArray:
    """Inverse of a ``normal`` matrix (m, m) times ``right`` (m,); what nothing tells stays nothing."""
    scale = scales_of(normal)
    scaled = normal / np.outer(scale, scale)
    scaled[np.diag_indices(scale.size)] += FLOOR
    return np.asarray(cho_solve(cho_factor(scaled), right / scale) / scale)


def gained(plain: Unseen, wider: Unseen, number: IntArray) -> tuple[float, float]:
    """By how much less unseen blocks misfit under ``wider`` than under ``plain``, and its standard error over blocks.

    A block counts by how far both are apart in it, since a tooth shows in few: what it gains is expected to be so much
    of all (the ratio estimator of Cochran, Sampling Techniques, 1977, chapter 6).
    """
    each = np.bincount(number, plain.left**2 - wider.left**2)
    apart = np.bincount(number, (plain.left - wider.left) ** 2)
    whole = float(np.sum(apart))
    if whole == 0.0:
        return plain.strain - wider.strain, 0.0
    off = each - apart * (float(np.sum(each)) / whole)
    count = max(2.0, whole**2 / float(apart @ apart))
    std = math.sqrt(count / (count - 1.0) * float(off @ off))
    return float(np.sum(each)) + plain.strain - wider.strain, std
