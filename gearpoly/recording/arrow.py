"""Columns of Arrow tables as arrays of ours."""

from __future__ import annotations

from typing import Any

import numpy as np

from gearpoly.units import FloatArray


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
