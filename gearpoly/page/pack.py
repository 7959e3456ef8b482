"""Arrays as text for a page: little-endian bytes in base64, as exact as each needs to be."""

from __future__ import annotations

import base64
import math
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from gearpoly.units import FloatArray

Kind = Literal["f8", "f4", "u4", "u2", "i2", "u1", "i1"]
"""What a browser's typed arrays hold: Float64Array, Float32Array, Uint32Array, Uint16Array, Int16Array, Uint8Array,
Int8Array."""

HALF = 32_767
"""Greatest whole number of 16 bits with a sign."""

FINER = 30.0
"""Steps in one noise floor. Rounding to a step errs by its 3.5th part, and thus makes noise greater by 0.005 %."""

FAINT = 1e-12
"""What stands for 0 where logarithms are packed: an atom is a hundred million times as large in um."""


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


def rounded(values: npt.ArrayLike, *, to: float) -> dict[str, Any]:
    """``values`` (any shape) within half of ``to``: in 16 bits, evenly over their range, where that is fine enough, and
    in float32 where it is not. Half the room for what noise or a screen hides."""
    array = np.asarray(values, dtype=np.float64)
    if not array.size:
        return packed(array, "f4")
    middle, step = 0.5 * float(array.max() + array.min()), float(np.ptp(array)) / (2 * HALF)
    if not (step <= to):  # also where a value is none
        return packed(array, "f4")
    step = step or 1.0
    return packed(np.rint((array - middle) / step).clip(-HALF, HALF), "i2") | {"middle": middle, "step": step}


def under_noise(values: npt.ArrayLike, *, noise: float) -> dict[str, Any]:
    """Measured ``values`` (any shape), ``rounded`` so that it cannot be told from their ``noise``."""
    return rounded(values, to=noise / FINER)


def rounded_log(values: npt.ArrayLike) -> dict[str, Any]:
    """Amplitudes (any shape), not negative, as 16 bits of their logarithms: over 12 decades to 0.05 %."""
    return rounded(np.log10(np.maximum(values, FAINT)), to=math.inf) | {"log": True}


def nearly_even(x: FloatArray) -> dict[str, Any]:
    """Places (n,) as a straight line and what is left of it, within a thousandth of their spacing; even ones as the
    line alone."""
    first, last = float(x[0]), float(x[-1])
    rest = x - np.linspace(first, last, x.size)
    line = {"first": first, "last": last, "size": int(x.size)}
    even = float(np.max(np.abs(rest))) <= 1e-12 * max(abs(first), abs(last))  # no more than sums round
    return line | {"rest": None if even else rounded(rest, to=1e-3 * (last - first) / x.size)}


def unpacked(pack: dict[str, Any]) -> npt.NDArray[Any]:
    """The array of a ``packed`` or ``rounded`` one."""
    dtype = np.dtype(pack["kind"]).newbyteorder("<")
    array = np.frombuffer(base64.b64decode(pack["base64"]), dtype=dtype).reshape(pack["shape"])
    if "step" not in pack:
        return array
    values = pack["middle"] + pack["step"] * array
    return np.asarray(10.0**values if pack.get("log") else values)
