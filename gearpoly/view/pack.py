"""Arrays as text for a page: little-endian bytes in base64, as exact as each needs to be."""

from __future__ import annotations

import base64
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Kind = Literal["f8", "f4", "u4", "u2", "u1", "i1"]
"""What a browser's typed arrays hold: Float64Array, Float32Array, Uint32Array, Uint16Array, Uint8Array, Int8Array."""


def packed(values: npt.ArrayLike, kind: Kind) -> dict[str, Any]:
    """``values`` (any shape) as ``{"kind", "shape", "base64"}``, rounded to ``kind``.

    Raises ``OverflowError`` for a whole number that ``kind`` cannot hold, so that none wraps round unseen.
    """
    array = np.asarray(values)
    if kind[0] != "f":
        limits = np.iinfo(np.dtype(kind))
        if array.size and (array.min() < limits.min or array.max() > limits.max):
            raise OverflowError(f"{array.min()} to {array.max()} does not fit {kind}")
    data = np.ascontiguousarray(array, dtype=np.dtype(kind).newbyteorder("<"))
    return {"kind": kind, "shape": list(array.shape), "base64": base64.b64encode(data.tobytes()).decode("ascii")}


def unpacked(pack: dict[str, Any]) -> npt.NDArray[Any]:
    """The array of a ``packed`` one."""
    dtype = np.dtype(pack["kind"]).newbyteorder("<")
    return np.frombuffer(base64.b64decode(pack["base64"]), dtype=dtype).reshape(pack["shape"])
