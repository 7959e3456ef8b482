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
