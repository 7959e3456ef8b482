"""Long arrays taken piece by piece: what is made on the way stays small, and in the processor's cache."""

from __future__ import annotations

from collections.abc import Iterator

SAMPLES_PER_PIECE = 16384
"""Samples of a piece: a dozen arrays of them fit into a cache of 2 MB."""


def pieces(n: int, *, size: int = SAMPLES_PER_PIECE) -> Iterator[slice]:
    """Slices of ``size`` or fewer that cover ``n`` samples."""
    for start in range(0, n, max(1, size)):
        yield slice(start, min(n, start + size))
