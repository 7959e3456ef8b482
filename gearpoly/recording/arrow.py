"""Columns of Arrow tables as arrays of ours."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from gearpoly.units import FloatArray


def even_codes(column: Any) -> npt.NDArray[np.uint8] | None:
    """The characters (n, length) of a chunked column of bytes, all of one length; ``None`` where they are not."""
    parts = []
    for chunk in column.chunks:
        _, offsets, data = chunk.buffers()
        places = np.frombuffer(offsets, dtype=np.int32, count=len(chunk) + 1, offset=4 * chunk.offset)
        length = int(places[1] - places[0]) if len(chunk) else 0
        if chunk.null_count or length == 0 or (np.diff(places) != length).any():
            return None
        held = np.frombuffer(data, dtype=np.uint8, count=length * len(chunk), offset=int(places[0]))
        parts.append(held.reshape(-1, length))
    return np.concatenate(parts) if parts and len({part.shape[1] for part in parts}) == 1 else None


def doubles(column: Any) -> FloatArray | None:
    """The numbers (n,) of a chunked column of doubles, ``nan`` where there is none; ``None`` for another type.

    ``to_numpy`` of pyarrow imports pandas, which takes longer than most files.
    """
    if str(column.type) != "double":
        return None
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
