"""The loops of ``sparse``, compiled: a matrix (n, m) in blocks of rows. Block b holds the rows from ``starts[b]`` to
``starts[b + 1]`` of the columns ``at[first[b]:first[b + 1]]``, row by row from ``values[begins[b]]`` on."""

from __future__ import annotations

import numpy as np

from gearpoly.mesh.radial_search import compiled
from gearpoly.units import FloatArray, IntArray


@compiled
def times(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, x: FloatArray
) -> FloatArray:
    """The product (n,) with ``x`` (m,)."""
    out = np.empty(starts[-1])
    for b in range(starts.size - 1):
        here = x[at[first[b] : first[b + 1]]]
        v = begins[b]
        for i in range(starts[b], starts[b + 1]):
            total = 0.0
            for j in range(here.size):
                total += values[v + j] * here[j]
            out[i] = total
            v += here.size
    return out


@compiled
def transposed_times(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, m: int, y: FloatArray
) -> FloatArray:
    """The product (m,) of the transpose with ``y`` (n,)."""
    out = np.zeros(m)
    for b in range(starts.size - 1):
        here = np.zeros(first[b + 1] - first[b])
        v = begins[b]
        for i in range(starts[b], starts[b + 1]):
            for j in range(here.size):
                here[j] += values[v + j] * y[i]
            v += here.size
        for j in range(here.size):
            out[at[first[b] + j]] += here[j]
    return out


@compiled
def add(out: FloatArray, at: IntArray, block: FloatArray) -> None:
    """Add a ``block`` (c, c) at the rows and columns ``at`` (c,)."""
    for i in range(at.size):
        for j in range(at.size):
            out[at[i], at[j]] += block[i, j]


@compiled
def part(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, number: IntArray,
    out: FloatArray,
) -> None:  # fmt: skip
    """The columns ``out`` (n, k) that have a ``number`` (m,), which says where each goes; -1: it has none."""
    for b in range(starts.size - 1):
        for j in range(first[b], first[b + 1]):
            into = number[at[j]]
            if into >= 0:
                v, c = begins[b] + j - first[b], first[b + 1] - first[b]
                for i in range(starts[b], starts[b + 1]):
                    out[i, into] = values[v]
                    v += c


@compiled
def only(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, number: IntArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """``first``, ``at`` and ``values`` of the columns that have a ``number`` (m,), by these; -1: it has none."""
    kept_first, kept_at, size, total = np.zeros_like(first), np.empty_like(at), 0, 0
    for b in range(starts.size - 1):
        for j in range(first[b], first[b + 1]):
            if number[at[j]] >= 0:
                kept_at[size] = number[at[j]]
                size += 1
        kept_first[b + 1] = size
        total += (size - kept_first[b]) * (starts[b + 1] - starts[b])
    kept = np.empty(total)
    w = 0
    for b in range(starts.size - 1):
        v = begins[b]
        for _ in range(starts[b], starts[b + 1]):
            for j in range(first[b], first[b + 1]):
                if number[at[j]] >= 0:
                    kept[w] = values[v]
                    w += 1
                v += 1
    return kept_first, kept_at[:size].copy(), kept


@compiled
def rows(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, numbers: IntArray
) -> tuple[IntArray, IntArray, IntArray, FloatArray]:
    """``starts``, ``first``, ``at`` and ``values`` of the rows of these ``numbers`` (k,), in ascending order."""
    blocks = starts.size - 1
    kept_starts, kept_first = np.zeros(blocks + 1, dtype=np.int64), np.zeros(blocks + 1, dtype=np.int64)
    kept_at, size, many, total, k = np.empty_like(at), 0, 0, 0, 0
    for b in range(blocks):
        before = k
        while k < numbers.size and numbers[k] < starts[b + 1]:
            k += 1
        if k > before:
            for j in range(first[b], first[b + 1]):
                kept_at[size] = at[j]
                size += 1
            many += 1
            kept_starts[many], kept_first[many] = k, size
            total += (k - before) * (first[b + 1] - first[b])
    kept = np.empty(total)
    k = w = 0
    for b in range(blocks):
        c = first[b + 1] - first[b]
        while k < numbers.size and numbers[k] < starts[b + 1]:
            v = begins[b] + (numbers[k] - starts[b]) * c
            kept[w : w + c] = values[v : v + c]
            w += c
            k += 1
    return kept_starts[: many + 1].copy(), kept_first[: many + 1].copy(), kept_at[:size].copy(), kept


@compiled
def beside(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, m: int, columns: FloatArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """``first``, ``at`` and ``values`` with further ``columns`` (n, q) from number ``m`` on, where they are not 0."""
    blocks, q = starts.size - 1, columns.shape[1]
    seen = np.zeros((blocks, q), dtype=np.bool_)
    new_first, total = np.zeros_like(first), 0
    for b in range(blocks):
        c = first[b + 1] - first[b]
        for i in range(starts[b], starts[b + 1]):
            for k in range(q):
                if columns[i, k] != 0.0:
                    seen[b, k] = True
        for k in range(q):
            c += seen[b, k]
        new_first[b + 1] = new_first[b] + c
        total += c * (starts[b + 1] - starts[b])
    new_at, new = np.empty(new_first[blocks], dtype=np.int64), np.empty(total)
    w = 0
    for b in range(blocks):
        c, size = first[b + 1] - first[b], new_first[b]
        new_at[size : size + c] = at[first[b] : first[b + 1]]
        size += c
        for k in range(q):
            if seen[b, k]:
                new_at[size] = m + k
                size += 1
        v = begins[b]
        for i in range(starts[b], starts[b + 1]):
            new[w : w + c] = values[v : v + c]
            v += c
            w += c
            for k in range(q):
                if seen[b, k]:
                    new[w] = columns[i, k]
                    w += 1
    return new_first, new_at, new


@compiled
def filtered(
    starts: IntArray, first: IntArray, begins: IntArray, at: IntArray, values: FloatArray, m: int, ar: FloatArray,
    innovation: float, forth: bool,
) -> tuple[IntArray, IntArray, FloatArray]:  # fmt: skip
    """``first``, ``at`` and ``values`` of the columns less what the coefficients ``ar`` (p,) foretell of them from
    earlier samples, over ``innovation``, the first p samples 0; or, not ``forth``, from later samples."""
    blocks, n, p = starts.size - 1, starts[-1], ar.size
    by = ar / innovation
    new_first, total = np.zeros_like(first), 0
    reached = np.zeros((blocks, m), dtype=np.bool_)
    for b in range(blocks):
        low = max(0, starts[b] - p) if forth else starts[b]
        high = starts[b + 1] if forth else min(n, starts[b + 1] + p)
        for j in range(first[b], first[b + 1]):
            reached[b, at[j]] = True
        other = b - 1 if forth else b + 1
        while 0 <= other < blocks and starts[other + 1] > low and starts[other] < high:
            c = first[other + 1] - first[other]
            for i in range(max(low, starts[other]), min(high, starts[other + 1])):
                v = begins[other] + (i - starts[other]) * c
                for j in range(c):
                    if values[v + j] != 0.0:
                        reached[b, at[first[other] + j]] = True
            other += -1 if forth else 1
        c = 0
        for k in range(m):
            c += reached[b, k]
        new_first[b + 1] = new_first[b] + c
        total += c * (starts[b + 1] - starts[b])
    new_at, new = np.empty(new_first[blocks], dtype=np.int64), np.empty(total)
    place = np.zeros(m, dtype=np.int64)
    w = 0
    for b in range(blocks):
        low = max(0, starts[b] - p) if forth else starts[b]
        high = starts[b + 1] if forth else min(n, starts[b + 1] + p)
        c = 0
        for k in range(m):
            if reached[b, k]:
                place[k] = c
                new_at[new_first[b] + c] = k
                c += 1
        wide = np.zeros((high - low, c))
        other = b
        while other > 0 and starts[other] > low:
            other -= 1
        while other < blocks and starts[other] < high:
            width = first[other + 1] - first[other]
            for i in range(max(low, starts[other]), min(high, starts[other + 1])):
                v = begins[other] + (i - starts[other]) * width
                if other == b:
                    for j in range(width):
                        wide[i - low, place[at[first[b] + j]]] = values[v + j]
                    continue
                for j in range(width):
                    if values[v + j] != 0.0:
                        wide[i - low, place[at[first[other] + j]]] = values[v + j]
            other += 1
        for i in range(starts[b], starts[b + 1]):
            out = new[w : w + c]
            w += c
            if forth and i < p:
                out[:] = 0.0
                continue
            out[:] = wide[i - low] / innovation
            for k in range(p if forth else min(p, n - 1 - i)):
                past = wide[i - low - 1 - k] if forth else wide[i - low + 1 + k]
                for j in range(c):
                    out[j] -= by[k] * past[j]
    return new_first, new_at, new
