"""Columns of Arrow tables as arrays of ours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from gearpoly.units import FloatArray

LONGEST_CODE = 40
"""Characters of a cell that are held; a time stamp has no more."""


def codes_of(column: Any) -> npt.NDArray[np.uint8] | None:
    """The characters (n, length) of a chunked column of bytes, short ones filled up with zeros; ``None`` where one is
    missing, empty or long."""
    parts = []
    for chunk in column.chunks:
        if not len(chunk):
            continue
        _, offsets, data = chunk.buffers()
        places = np.frombuffer(offsets, dtype=np.int32, count=len(chunk) + 1, offset=4 * chunk.offset)
        lengths = np.diff(places)
        least, most = int(lengths.min()), int(lengths.max())
        if chunk.null_count or least == 0 or most > LONGEST_CODE:
            return None
        held = np.frombuffer(data, dtype=np.uint8)[: int(places[-1])]
        if least == most:
            parts.append(held[int(places[0]) :].reshape(-1, most))
            continue
        part = np.zeros((len(chunk), most), dtype=np.uint8)
        for length in np.unique(lengths).tolist():
            rows = np.flatnonzero(lengths == length)
            part[rows, :length] = held[places[rows][:, np.newaxis] + np.arange(length)]
        parts.append(part)
    return joined_codes(parts) if parts else None


def joined_codes(parts: Sequence[npt.NDArray[np.uint8]]) -> npt.NDArray[np.uint8]:
    """The characters (n, length) of all parts, one below the other, short ones filled up with zeros."""
    most = max(part.shape[1] for part in parts)
    return np.concatenate(
        [part if part.shape[1] == most else np.pad(part, ((0, 0), (0, most - part.shape[1]))) for part in parts]
    )


def doubles(column: Any) -> FloatArray | None:
    """The numbers (n,) of a chunked column of doubles, ``nan`` where there is none; ``None`` for another type.

    ``to_numpy`` of pyarrow imports pandas, which takes longer than most files.
    """
    if str(column.type) != "double":
        return None
    if column.num_chunks == 1 and not column.chunk(0).null_count:
        (one,) = column.chunks  # its memory is taken over, not copied
        _, data = one.buffers()
        if data is not None:
            return np.frombuffer(data, dtype=np.float64, count=len(one), offset=8 * one.offset)
    out = np.empty(len(column))
    at = 0
    for chunk in column.chunks:
        valid, data = chunk.buffers()
        part = out[at : at + len(chunk)]
        if data is not None:
            part[:] = np.frombuffer(data, dtype=np.float64, count=len(chunk), offset=8 * chunk.offset)
        if chunk.null_count:
            bits = np.frombuffer(valid, dtype=np.uint8)
            held = np.unpackbits(bits, count=chunk.offset + len(chunk), bitorder="little")[chunk.offset :]
            part[held == 0] = np.nan
        at += len(chunk)
    return out
