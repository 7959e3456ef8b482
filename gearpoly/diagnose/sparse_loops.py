"""The dearest loops of ``sparse``, compiled: a matrix (n, m) in blocks of rows. Block b holds the rows from
``starts[b]`` to ``starts[b + 1]`` of the columns ``at[first[b]:first[b + 1]]``, row by row from ``values[begins[b]]``
on."""

from __future__ import annotations

import numpy as np

from gearpoly.mesh.radial_search import compiled
from gearpoly.units import FloatArray, IntArray


@compiled
def add(out: FloatArray, at: IntArray, block: FloatArray) -> None:
    """Add a ``block`` (c, c) at the rows and columns ``at`` (c,)."""
    for i in range(at.size):
        for j in range(at.size):
            out[at[i], at[j]] += block[i, j]


@compiled
def product(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, x: FloatArray,
    out: FloatArray,
) -> None:  # fmt: skip
    """Write the product with ``x`` (m, q) into ``out`` (n, q)."""
    for b in range(starts.size - 1):
        width = first[b + 1] - first[b]
        for i in range(starts[b], starts[b + 1]):
            v = begins[b] + (i - starts[b]) * width
            mine, columns = values[v : v + width], at[first[b] : first[b + 1]]
            for q in range(x.shape[1]):
                total = 0.0
                for j in range(width):
                    total += mine[j] * x[columns[j], q]
                out[i, q] = total


@compiled
def transposed_product(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, rows: IntArray,
    y: FloatArray, out: FloatArray,
) -> None:  # fmt: skip
    """Write the product of the transpose of these ``rows`` (k,), in ascending order, with ``y`` (k, q) into ``out``
    (m, q), which is 0."""
    b = 0
    for k in range(rows.size):
        while starts[b + 1] <= rows[k]:
            b += 1
        width = first[b + 1] - first[b]
        v = begins[b] + (rows[k] - starts[b]) * width
        mine, columns = values[v : v + width], at[first[b] : first[b + 1]]
        for q in range(y.shape[1]):
            by = y[k, q]
            for j in range(width):
                out[columns[j], q] += mine[j] * by


@compiled
def only(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, number: IntArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """``first``, ``at`` and ``values`` of those columns alone that have a ``number`` (m,) of 0 or more, by which they
    are called from now on."""
    new_first, total = np.zeros_like(first), 0
    for b in range(starts.size - 1):
        width = 0
        for j in range(first[b], first[b + 1]):
            if number[at[j]] >= 0:
                width += 1
        new_first[b + 1] = new_first[b] + width
        total += width * (starts[b + 1] - starts[b])
    new_at, new = np.empty(new_first[-1], dtype=np.int64), np.empty(total)
    taken, w = np.empty(at.size, dtype=np.int64), 0
    for b in range(starts.size - 1):
        c = 0
        for j in range(first[b + 1] - first[b]):
            mine = number[at[first[b] + j]]
            if mine >= 0:
                new_at[new_first[b] + c] = mine
                taken[c] = j
                c += 1
        for i in range(starts[b], starts[b + 1]):
            v = begins[b] + (i - starts[b]) * (first[b + 1] - first[b])
            for j in range(c):
                new[w + j] = values[v + taken[j]]
            w += c
    return new_first, new_at, new


@compiled
def beside(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, m: int, columns: FloatArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """``first``, ``at`` and ``values`` with further ``columns`` (n, q) at the end, each in blocks where it is not 0."""
    blocks, more = starts.size - 1, columns.shape[1]
    seen, new_first, total = np.zeros((blocks, more), dtype=np.bool_), np.zeros_like(first), 0
    for b in range(blocks):
        for i in range(starts[b], starts[b + 1]):
            for q in range(more):
                if columns[i, q] != 0.0:
                    seen[b, q] = True
        width = first[b + 1] - first[b] + np.sum(seen[b])
        new_first[b + 1] = new_first[b] + width
        total += width * (starts[b + 1] - starts[b])
    new_at, new = np.empty(new_first[blocks], dtype=np.int64), np.empty(total)
    w = 0
    for b in range(blocks):
        width, c = first[b + 1] - first[b], new_first[b]
        for j in range(width):
            new_at[c + j] = at[first[b] + j]
        c += width
        for q in range(more):
            if seen[b, q]:
                new_at[c] = m + q
                c += 1
        for i in range(starts[b], starts[b + 1]):
            v = begins[b] + (i - starts[b]) * width
            for j in range(width):
                new[w + j] = values[v + j]
            w += width
            for q in range(more):
                if seen[b, q]:
                    new[w] = columns[i, q]
                    w += 1
    return new_first, new_at, new


@compiled
def _reached(
    b: int, low: int, high: int, starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray,
    mark: IntArray, stamp: int,
) -> int:  # fmt: skip
    """Set the ``mark`` (m,) of all columns of block ``b``, and of those that are not 0 in rows ``low`` to ``high`` of
    others, to the ``stamp``; how many they are."""
    c = 0
    for j in range(first[b], first[b + 1]):
        mark[at[j]] = stamp
        c += 1
    other = b
    while other > 0 and starts[other] > low:
        other -= 1
    while other < starts.size - 1 and starts[other] < high:
        if other != b:
            width = first[other + 1] - first[other]
            for i in range(max(low, starts[other]), min(high, starts[other + 1])):
                v = begins[other] + (i - starts[other]) * width
                for j in range(width):
                    k = at[first[other] + j]
                    if values[v + j] != 0.0 and mark[k] != stamp:
                        mark[k] = stamp
                        c += 1
        other += 1
    return c


@compiled
def _drawn_wide(
    b: int, low: int, high: int, starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray,
    place: IntArray, c: int, wide: FloatArray,
) -> None:  # fmt: skip
    """Write rows ``low`` to ``high`` of those ``c`` columns that have a ``place`` (m,) about block ``b`` into ``wide``,
    row by row, where they are not 0."""
    for w in range((high - low) * c):
        wide[w] = 0.0
    other = b
    while other > 0 and starts[other] > low:
        other -= 1
    while other < starts.size - 1 and starts[other] < high:
        width = first[other + 1] - first[other]
        for i in range(max(low, starts[other]), min(high, starts[other + 1])):
            v, w = begins[other] + (i - starts[other]) * width, (i - low) * c
            for j in range(width):
                if other == b or values[v + j] != 0.0:
                    wide[w + place[at[first[other] + j]]] = values[v + j]
        other += 1


@compiled
def filtered(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, m: int, ar: FloatArray,
    innovation: float, forth: bool,
) -> tuple[IntArray, IntArray, FloatArray]:  # fmt: skip
    """``first``, ``at`` and ``values`` of the columns less what the coefficients ``ar`` (p,) foretell of them from
    earlier samples, over ``innovation``, the first p samples 0; or, not ``forth``, from later samples."""
    blocks, n, p = starts.size - 1, starts[-1], ar.size
    back, ahead = (p, 0) if forth else (0, p)
    new_first, mark, total, widest = np.zeros_like(first), np.zeros(m, dtype=np.int64), 0, 0
    for b in range(blocks):
        low, high = max(0, starts[b] - back), min(n, starts[b + 1] + ahead)
        c = _reached(b, low, high, starts, first, begins, at, values, mark, b + 1)
        new_first[b + 1] = new_first[b] + c
        total += c * (starts[b + 1] - starts[b])
        widest = max(widest, c * (high - low))
    new_at, new = np.empty(new_first[blocks], dtype=np.int64), np.empty(total)
    place, wide = np.zeros(m, dtype=np.int64), np.empty(widest)
    w = 0
    for b in range(blocks):
        low, high = max(0, starts[b] - back), min(n, starts[b + 1] + ahead)
        _reached(b, low, high, starts, first, begins, at, values, mark, blocks + 1 + b)
        c = 0
        for k in range(m):
            if mark[k] == blocks + 1 + b:
                place[k] = c
                new_at[new_first[b] + c] = k
                c += 1
        _drawn_wide(b, low, high, starts, first, begins, at, values, place, c, wide)
        for i in range(starts[b], starts[b + 1]):
            here, taps = (i - low) * c, min(p, n - 1 - i)
            if forth:
                taps = p if i >= p else -1
            # Slices, not places from their beginning on: those might be negative for all that the compiler knows.
            mine, out = wide[here : here + c], new[w : w + c]
            for j in range(c):
                out[j] = mine[j] / innovation if taps >= 0 else 0.0
            for k in range(taps):
                at_past = here - (1 + k) * c if forth else here + (1 + k) * c
                past, by = wide[at_past : at_past + c], ar[k] / innovation
                for j in range(c):
                    out[j] -= by * past[j]
            w += c
    return new_first, new_at, new
