"""Arrays as text for a page, as exact as each needs to be.

What varies smoothly has small differences, whose high bytes are nearly all 0. So whole numbers travel as differences
along the last axis, the bytes of all numbers sorted by their place in the number, deflated, and in base64. A browser
inflates by itself.
"""

from __future__ import annotations

import base64
import math
import zlib
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from gearpoly.units import FloatArray

Kind = Literal["f8", "f4", "u4", "i4", "u2", "i2", "u1", "i1"]
"""What a browser's typed arrays hold: Float64Array, Float32Array, Uint32Array, Int32Array, Uint16Array, Int16Array,
Uint8Array, Int8Array."""

SIGNED_TYPES: tuple[tuple[Kind, int], ...] = (("i1", 2**7 - 1), ("i2", 2**15 - 1), ("i4", 2**31 - 1))
"""Whole numbers with a sign, and the greatest of each."""

DIFFERENCES = range(4)
"""How often differences are taken; what makes the shortest text is taken. Drawn flanks need 3, noise none."""

STEPS_PER_NOISE = 30.0
"""Least steps in one noise floor. Rounding to a step errs by its 3.5th part, which makes noise greater by 0.005 %."""

LAST_DIGIT = 1e-3
"""um. The last digit that pages print of what was measured."""

STANDS_FOR_ZERO = 1e-12
"""What stands for 0 where logarithms are packed: an atom is a hundred million times as large in um."""

LOG_STEP = 4e-4
"""Step of decimal logarithms: half of it is 0.05 % of the amplitude, a tenth of a pixel over six decades."""


def packed(values: npt.ArrayLike, kind: Kind) -> dict[str, Any]:
    """``values`` (any shape) as ``{"kind", "shape", "differences", "deflated"}``, rounded to ``kind``.

    Raises ``OverflowError`` for a whole number that ``kind`` cannot hold, so that none wraps round unseen.
    """
    array = np.asarray(values)
    if kind[0] == "f":
        differences, text = 0, _text(np.ascontiguousarray(array, dtype=_little(kind)))
    else:
        limits = np.iinfo(np.dtype(kind))
        if array.size and (array.min() < limits.min or array.max() > limits.max):
            raise OverflowError(f"{array.min()} to {array.max()} does not fit {kind}")
        whole = array.astype(np.int64)
        texts = {order: _text(_codes(whole, kind, order)) for order in DIFFERENCES}
        differences = min(texts, key=lambda order: len(texts[order]))
        text = texts[differences]
    return {"kind": kind, "shape": list(array.shape), "differences": differences, "deflated": text}


def _little(kind: str) -> np.dtype[Any]:
    return np.dtype(kind).newbyteorder("<")


def _codes(whole: npt.NDArray[np.int64], kind: Kind, order: int) -> npt.NDArray[Any]:
    """Differences of whole numbers, modulo what ``kind`` holds, without their signs: 0, -1, 1, -2 as 0, 1, 2, 3."""
    for _ in range(order):
        whole = np.diff(whole, axis=-1, prepend=0)
    bits = 8 * np.dtype(kind).itemsize
    wrapped = whole.astype(_little(f"i{bits // 8}"))
    return np.asarray((wrapped << 1) ^ (wrapped >> (bits - 1)))


def _text(array: npt.NDArray[Any]) -> str:
    """Bytes of numbers, first the lowest of all, deflated, in base64."""
    planes = np.frombuffer(array.tobytes(), dtype=np.uint8).reshape(-1, array.dtype.itemsize).T
    return base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode("ascii")


def rounded(values: npt.ArrayLike, *, to: float) -> dict[str, Any]:
    """``values`` (any shape) in whole steps of ``to``, thus within half of it; in float32 where 32 bits do not hold
    them. For what noise or a screen hides."""
    array = np.asarray(values, dtype=np.float64)
    if not array.size:
        return packed(array, "f4")
    middle, half = 0.5 * float(array.max() + array.min()), 0.5 * float(np.ptp(array))
    step = to if half > 0.0 else 1.0
    for kind, most in SIGNED_TYPES:
        if half <= step * (most - 1):  # never where a value is none
            return packed(np.rint((array - middle) / step), kind) | {"middle": middle, "step": step}
    return packed(array, "f4")


def under_noise(values: npt.ArrayLike, *, noise: float) -> dict[str, Any]:
    """Measured ``values`` (any shape) in um, ``rounded`` within their ``noise`` in um and within the last digit that is
    printed."""
    return rounded(values, to=min(noise / STEPS_PER_NOISE, LAST_DIGIT))


def rounded_log(values: npt.ArrayLike) -> dict[str, Any]:
    """Amplitudes (any shape), not negative, by their logarithms to 0.05 %."""
    return rounded(np.log10(np.maximum(values, STANDS_FOR_ZERO)), to=LOG_STEP) | {"log": True}


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
    kind, shape = pack["kind"], pack["shape"]
    planes = np.frombuffer(zlib.decompress(base64.b64decode(pack["deflated"])), dtype=np.uint8)
    raw = np.ascontiguousarray(planes.reshape(np.dtype(kind).itemsize, math.prod(shape)).T)
    if kind[0] == "f":
        return raw.view(_little(kind)).reshape(shape)
    codes = raw.view(_little(f"u{kind[1]}")).reshape(shape).astype(np.int64)
    values = (codes >> 1) ^ -(codes & 1)
    for _ in range(pack["differences"]):
        values = np.cumsum(values, axis=-1)
    array = values.astype(_little(kind))
    if "step" not in pack:
        return array
    whole = pack["middle"] + pack["step"] * array
    return np.asarray(10.0**whole if pack.get("log") else whole)
