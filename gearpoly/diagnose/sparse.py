"""Columns of a fit that touch few samples each, kept as blocks of samples with those columns that touch them.

A tooth is in contact for two meshes of a turn: of 900 columns of teeth as built some 50 differ from 0 at a sample. A
recording of 60 000 samples takes a tenth of the memory and of the products so.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.mesh.radial_search import compiled
from gearpoly.units import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Sparse:
    """A matrix (n, m) in blocks of rows: block b holds the rows from ``starts[b]`` to ``starts[b + 1]``, ``values[b]``
    (rows, c) of the columns ``at[b]`` (c,), in ascending order; all others are 0 there."""

    shape: tuple[int, int]
    starts: IntArray
    at: tuple[IntArray, ...]
    values: tuple[FloatArray, ...]

    @property
    def T(self) -> Transposed:
        """The transpose (m, n), for products with it."""
        return Transposed(of=self)

    def __matmul__(self, x: FloatArray) -> FloatArray:
        """The product (n,) or (n, q) with ``x`` (m,) or (m, q)."""
        out = np.empty((self.shape[0], *x.shape[1:]))
        for rows, at, values in self._blocks():
            out[rows] = values @ x[at]
        return out

    def times(self, places: IntArray | slice | Sequence[int], x: FloatArray) -> FloatArray:
        """The product (n,) with ``x`` (k,) at these ``places`` (k,) of the columns, and 0 at all others."""
        whole = np.zeros(self.shape[1])
        whole[places] = x
        return self @ whole

    def gram(self) -> FloatArray:
        """The product (m, m) of the transpose with the matrix."""
        out = np.zeros((self.shape[1], self.shape[1]))
        for _, at, values in self._blocks():
            _add(out, at, values.T @ values)
        return out

    def part(self, places: IntArray | slice | Sequence[int]) -> FloatArray:
        """The columns at these ``places`` (k,), each named once, as an array (n, k)."""
        chosen = np.arange(self.shape[1])[places]
        out = np.zeros((self.shape[0], chosen.size))
        number = np.full(self.shape[1], -1)
        number[chosen] = np.arange(chosen.size)
        for rows, at, values in self._blocks():
            into = number[at]
            mine = into >= 0
            if mine.any():
                out[rows, into[mine]] = values[:, mine]
        return out

    def dense(self) -> FloatArray:
        """The same as an array (n, m)."""
        return self.part(slice(None))

    def only(self, keep: IntArray) -> Sparse:
        """The columns ``keep`` (k,), in ascending order."""
        number = np.full(self.shape[1], -1)
        number[keep] = np.arange(keep.size)
        kept, parts = [], []
        for at, values in zip(self.at, self.values, strict=True):
            mine = number[at]
            inside = mine >= 0
            whole = bool(inside.all())
            kept.append(mine if whole else mine[inside])
            parts.append(values if whole else values[:, inside])
        return Sparse(shape=(self.shape[0], keep.size), starts=self.starts, at=tuple(kept), values=tuple(parts))

    def rows(self, where: IntArray | BoolArray) -> Sparse:
        """The rows of these numbers, in ascending order, or those that are marked."""
        numbers = np.flatnonzero(where) if where.dtype == np.bool_ else where
        ends = np.searchsorted(numbers, self.starts)
        starts, kept, parts = [0], [], []
        for b, (at, values) in enumerate(zip(self.at, self.values, strict=True)):
            mine = numbers[ends[b] : ends[b + 1]] - self.starts[b]
            if mine.size:
                kept.append(at)
                parts.append(values if mine.size == len(values) else values[mine])
                starts.append(starts[-1] + mine.size)
        return Sparse(shape=(numbers.size, self.shape[1]), starts=np.array(starts), at=tuple(kept), values=tuple(parts))

    def beside(self, columns: FloatArray) -> Sparse:
        """The same with further ``columns`` (n, q) at the end."""
        kept, parts = [], []
        for rows, at, values in self._blocks():
            more = columns[rows]
            seen = np.flatnonzero(more.any(axis=0))
            kept.append(np.concatenate((at, self.shape[1] + seen)))
            parts.append(np.concatenate((values, more[:, seen]), axis=1))
        shape = self.shape[0], self.shape[1] + columns.shape[1]
        return Sparse(shape=shape, starts=self.starts, at=tuple(kept), values=tuple(parts))

    def through(self, work: Callable[[FloatArray], FloatArray], *, before: int = 0, after: int = 0) -> Sparse:
        """What ``work`` makes of all columns side by side: of each sample from so many ``before`` it and ``after``."""
        kept, parts = [], []
        for b, (first, end) in enumerate(zip(self.starts[:-1].tolist(), self.starts[1:].tolist(), strict=True)):
            low, high = max(0, first - before), min(self.shape[0], end + after)
            at, values = self._stretch(b, low, high)
            kept.append(at)
            parts.append(work(values)[first - low : end - low])
        return Sparse(shape=self.shape, starts=self.starts, at=tuple(kept), values=tuple(parts))

    def _blocks(self) -> list[tuple[slice, IntArray, FloatArray]]:
        """The rows of every block, its columns, and their values."""
        ends = self.starts.tolist()
        rows = [slice(first, end) for first, end in itertools.pairwise(ends)]
        return list(zip(rows, self.at, self.values, strict=True))

    def _stretch(self, block: int, low: int, high: int) -> tuple[IntArray, FloatArray]:
        """The columns (c,) that are not 0 in the rows from ``low`` to ``high`` about a block, and these (rows, c)."""
        first, last = (int(np.searchsorted(self.starts, row, side="right")) - 1 for row in (low, high - 1))
        if first == last:
            return self.at[block], self.values[block]
        pieces = []
        for b in range(first, last + 1):
            start = int(self.starts[b])
            values, at = self.values[b][max(low - start, 0) : high - start], self.at[b]
            if b != block:
                seen = values.any(axis=0)
                values, at = values[:, seen], at[seen]
            pieces.append((max(start, low) - low, at, values))
        every = np.unique(np.concatenate([at for _, at, _ in pieces]))
        out = np.zeros((high - low, every.size))
        for row, at, values in pieces:
            out[row : row + len(values), np.searchsorted(every, at)] = values
        return every, out


@dataclass(frozen=True, kw_only=True, eq=False)
class Transposed:
    """The transpose (m, n) of a matrix ``of`` (n, m)."""

    of: Sparse

    def __matmul__(self, y: FloatArray) -> FloatArray:
        """The product (m,) or (m, q) with ``y`` (n,) or (n, q)."""
        out = np.zeros((self.of.shape[1], *y.shape[1:]))
        for rows, at, values in self.of._blocks():
            out[at] += values.T @ y[rows]
        return out


def full(columns: FloatArray) -> Sparse:
    """An array (n, m) as one block."""
    n, m = columns.shape
    return Sparse(shape=(n, m), starts=np.array([0, n]), at=(np.arange(m),), values=(columns,))


def stacked(parts: Sequence[Sparse]) -> Sparse:
    """Matrices (n_k, m), one below the other."""
    sizes = np.concatenate([np.diff(one.starts) for one in parts])
    starts = np.concatenate(([0], np.cumsum(sizes)))
    return Sparse(
        shape=(int(starts[-1]), parts[0].shape[1]),
        starts=starts,
        at=tuple(at for one in parts for at in one.at),
        values=tuple(values for one in parts for values in one.values),
    )


@compiled
def _add(out: FloatArray, at: IntArray, block: FloatArray) -> None:
    """Add a ``block`` (c, c) at the rows and columns ``at`` (c,)."""
    for i in range(at.size):
        for j in range(at.size):
            out[at[i], at[j]] += block[i, j]
