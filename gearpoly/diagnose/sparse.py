"""Columns of a fit that touch few samples each, kept as blocks of samples with those columns that touch them.

A tooth is in contact for two meshes of a turn: of 900 columns of teeth as built some 50 differ from 0 at a sample. A
recording of 60 000 samples takes a tenth of the memory and of the products so. All blocks stand in one array, so that
compiled loops go through them: blocks as arrays of their own cost more calls than products.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearpoly.diagnose import sparse_loops
from gearpoly.units import BoolArray, FloatArray, IntArray

FEW_COLUMNS = 4
"""Columns up to which a compiled loop takes less time than one product of arrays for each block, of 24 samples on some
50 columns."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sparse:
    """A matrix (n, m) in blocks of rows: block b holds the rows from ``starts[b]`` to ``starts[b + 1]`` of the columns
    ``at[first[b]:first[b + 1]]``, in ascending order; all others are 0 there. ``values`` has all blocks one after
    another, each row by row."""

    shape: tuple[int, int]
    starts: IntArray
    first: IntArray
    at: IntArray
    values: FloatArray

    @cached_property
    def _begins(self) -> IntArray:
        """Where the values of each block begin (b + 1,), the end added."""
        return np.concatenate(([0], np.cumsum(np.diff(self.starts) * np.diff(self.first))))

    @property
    def _stored(self) -> tuple[IntArray, IntArray, IntArray, IntArray, FloatArray]:
        """What compiled loops go through."""
        return self.starts, self.first, self._begins, self.at, self.values

    @property
    def T(self) -> Transposed:
        """The transpose (m, n), for products with it."""
        return Transposed(of=self)

    def __matmul__(self, x: FloatArray) -> FloatArray:
        """The product (n,) or (n, q) with ``x`` (m,) or (m, q)."""
        out = np.zeros((self.shape[0], *x.shape[1:]))
        if few(x):
            sparse_loops.product(*self._stored, wide(x), wide(out))
            return out
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
            sparse_loops.add(out, at, values.T @ values)
        return out

    def part(self, places: IntArray | slice | Sequence[int]) -> FloatArray:
        """The columns at these ``places`` (k,), each named once, as an array (n, k)."""
        chosen = np.arange(self.shape[1])[places]
        out = np.zeros((self.shape[0], chosen.size))
        number = self._numbered(chosen)
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
        first, at, values = sparse_loops.only(*self._stored, self._numbered(keep))
        return Sparse(shape=(self.shape[0], keep.size), starts=self.starts, first=first, at=at, values=values)

    def rows(self, where: IntArray | BoolArray) -> Sparse:
        """The rows of these numbers, in ascending order, or those that are marked."""
        numbers = np.flatnonzero(where) if where.dtype == np.bool_ else where
        ends = np.searchsorted(numbers, self.starts).tolist()
        starts, kept, parts = [0], [], []
        for b, (rows, at, values) in enumerate(self._blocks()):
            mine = numbers[ends[b] : ends[b + 1]] - rows.start
            if mine.size:
                kept.append(at)
                parts.append(values[mine].ravel())
                starts.append(starts[-1] + mine.size)
        return _laid_out((numbers.size, self.shape[1]), np.array(starts), kept, parts)

    def transposed_at(self, where: IntArray, y: FloatArray) -> FloatArray:
        """The product (m, q) of the transpose of the rows ``where`` (k,), in ascending order, with ``y`` (k, q)."""
        out = np.zeros((self.shape[1], y.shape[1]))
        sparse_loops.transposed_product(*self._stored, where, np.ascontiguousarray(y), out)
        return out

    def beside(self, columns: FloatArray) -> Sparse:
        """The same with further ``columns`` (n, q) at the end."""
        m, q = self.shape[1], columns.shape[1]
        first, at, values = sparse_loops.beside(*self._stored, m, np.ascontiguousarray(columns, dtype=np.float64))
        return Sparse(shape=(self.shape[0], m + q), starts=self.starts, first=first, at=at, values=values)

    def forward(self, ar: FloatArray, innovation: float) -> Sparse:
        """All columns less what the autoregressive coefficients ``ar`` (p,) foretell of them from earlier samples, over
        ``innovation`` in their unit; the first p samples are 0."""
        return self._filtered(ar, innovation, forth=True)

    def backward(self, ar: FloatArray, innovation: float) -> Sparse:
        """The same from later samples: the transpose of ``forward``, but for the first p samples of what comes in."""
        return self._filtered(ar, innovation, forth=False)

    def _filtered(self, ar: FloatArray, innovation: float, *, forth: bool) -> Sparse:
        # In one piece that may be written, so that the loop is compiled once.
        ar = np.array(ar, dtype=np.float64)
        first, at, values = sparse_loops.filtered(*self._stored, self.shape[1], ar, innovation, forth)
        return Sparse(shape=self.shape, starts=self.starts, first=first, at=at, values=values)

    def _blocks(self) -> Iterator[tuple[slice, IntArray, FloatArray]]:
        """The rows of every block, its columns, and their values (rows, c)."""
        starts, first, begins = self.starts.tolist(), self.first.tolist(), self._begins.tolist()
        for b in range(len(starts) - 1):
            rows, at = slice(starts[b], starts[b + 1]), self.at[first[b] : first[b + 1]]
            yield rows, at, self.values[begins[b] : begins[b + 1]].reshape(rows.stop - rows.start, at.size)

    def _numbered(self, chosen: IntArray) -> IntArray:
        """The place of every column (m,) among those ``chosen`` (k,), -1 of the others."""
        number = np.full(self.shape[1], -1)
        number[chosen] = np.arange(chosen.size)
        return number


@dataclass(frozen=True, kw_only=True, eq=False)
class Transposed:
    """The transpose (m, n) of a matrix ``of`` (n, m)."""

    of: Sparse

    def __matmul__(self, y: FloatArray) -> FloatArray:
        """The product (m,) or (m, q) with ``y`` (n,) or (n, q)."""
        out = np.zeros((self.of.shape[1], *y.shape[1:]))
        if few(y):
            sparse_loops.transposed_product(*self.of._stored, np.arange(self.of.shape[0]), wide(y), wide(out))
            return out
        for rows, at, values in self.of._blocks():
            out[at] += values.T @ y[rows]
        return out


def few(x: FloatArray) -> bool:
    """Whether there are so few columns that a compiled loop is sooner done than a product for each block."""
    return x.ndim == 1 or x.shape[1] <= FEW_COLUMNS


def wide(x: FloatArray) -> FloatArray:
    """Columns (n, q) in one piece of ``x`` (n,) or (n, q); the same memory where that is in one piece already."""
    whole = np.ascontiguousarray(x, dtype=np.float64)
    return whole[:, None] if x.ndim == 1 else whole


def full(columns: FloatArray) -> Sparse:
    """An array (n, m) as one block."""
    n, m = columns.shape
    return Sparse(
        shape=(n, m), starts=np.array([0, n]), first=np.array([0, m]), at=np.arange(m),
        values=np.ascontiguousarray(columns, dtype=np.float64).ravel(),
    )  # fmt: skip


def stacked(parts: Sequence[Sparse]) -> Sparse:
    """Matrices (n_k, m), one below the other."""
    starts, first = (
        np.concatenate(([0], np.cumsum(np.concatenate([np.diff(getattr(one, name)) for one in parts]))))
        for name in ("starts", "first")
    )
    return Sparse(
        shape=(int(starts[-1]), parts[0].shape[1]),
        starts=starts,
        first=first,
        at=np.concatenate([one.at for one in parts]),
        values=np.concatenate([one.values for one in parts]),
    )


def _laid_out(shape: tuple[int, int], starts: IntArray, at: Sequence[IntArray], values: Sequence[FloatArray]) -> Sparse:
    """A matrix of blocks by their columns and their values, each row by row."""
    first = np.concatenate(([0], np.cumsum([one.size for one in at], dtype=np.int64)))
    # Without a row there is no block, and nothing to be put together.
    return Sparse(
        shape=shape, starts=starts, first=first, at=np.concatenate((np.zeros(0, dtype=np.int64), *at)),
        values=np.concatenate((np.zeros(0), *values)),
    )  # fmt: skip
