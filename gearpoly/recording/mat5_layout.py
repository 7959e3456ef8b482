"""The layout of MAT 5 files: variables, packed or not, and the arrays in them, every size compared with what is there.

Source of the layout: MathWorks, "MAT-File Format", level 5 (element tags, array flags, compressed elements).
"""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np
import numpy.typing as npt

from gearpoly.recording.reader import KEY_TEXT_LIMIT, check_numbers

Order = Literal["<", ">"]

MAT5_HEADER_BYTES = 128
VARIABLE_HEAD_BYTES = 2**16
"""How much of a variable is looked at to learn its class, shape, name and, of a struct, the names of its fields."""

MATRIX, COMPRESSED = 14, 15
MAT5_CELL_CLASS, MAT5_STRUCT_CLASS, MAT5_CHAR_CLASS, MAT5_OPAQUE_CLASS = 1, 2, 4, 17
NUMERIC_CLASSES = range(6, 16)
STORAGE = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
CODECS = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
CLASS_NAMES = {1: "cell", 2: "struct", 3: "object", 4: "text", 5: "sparse matrix", 16: "function", 17: "object"}


class BrokenError(Exception):
    """The walk met a size or a type that cannot be; the caller knows the file."""


@dataclass(frozen=True)
class Variable:
    """Where one top-level variable lies in the file, and whether it is packed."""

    packed: bool
    offset: int
    size: int


@dataclass(frozen=True)
class Array:
    """One array as its header states it: class, shape and name; its contents begin at ``at`` in ``data``."""

    name: str
    kind: int
    is_complex: bool
    shape: tuple[int, ...]
    data: memoryview
    at: int
    order: Order


def variables(stream: BinaryIO, order: Order) -> list[Variable]:
    """Where every variable lies; nothing is read but the tags."""
    end = stream.seek(0, 2)
    at, found = MAT5_HEADER_BYTES, []
    while at < end:
        stream.seek(at)
        tag = stream.read(8)
        if len(tag) < 8:
            raise BrokenError("it ends inside a tag")
        kind, size = struct.unpack(order + "II", tag)
        if kind not in (MATRIX, COMPRESSED):
            raise BrokenError(f"an element of type {kind} at byte {at}")
        if at + 8 + size > end:
            raise BrokenError(f"it ends at byte {end}, inside a variable that runs to {at + 8 + size}")
        if size:
            found.append(Variable(kind == COMPRESSED, at + 8, size))
        at += 8 + size
    return found


def unpacked(file: Path, stream: BinaryIO, variable: Variable, order: Order, *, limit: int | None = None) -> bytes:
    """The contents of one variable (without its tag), or its first ``limit`` bytes.

    Never unpacks more than the variable's own tag states, which is less than 4 GB in this format.
    """
    stream.seek(variable.offset)
    if not variable.packed:
        return stream.read(min(variable.size, limit or variable.size))
    # A head of 64 kB packs into less than that plus a few bytes of framing.
    packed = stream.read(min(variable.size, limit + 1024 if limit else variable.size))
    inflate = zlib.decompressobj()
    tag = inflate.decompress(packed, 8)
    if len(tag) < 8:
        raise BrokenError(f"a packed variable at byte {variable.offset} that does not unpack")
    kind, size = struct.unpack(order + "II", tag)
    if kind != MATRIX:
        raise BrokenError(f"a packed element of type {kind} at byte {variable.offset}")
    wanted = min(size, limit or size)
    check_numbers(file, 0, beside=2 * wanted)
    data = inflate.decompress(inflate.unconsumed_tail, wanted) if wanted else b""
    if len(data) < wanted:
        raise BrokenError(f"a packed variable at byte {variable.offset} of {len(data)} bytes instead of {size}")
    return data


def element(data: memoryview, at: int, order: Order) -> tuple[int, int, int, int]:
    """Type, start and size of the element at ``at``, and where the next one begins."""
    if at + 8 > len(data):
        raise BrokenError("an array that ends too early")
    kind, size = struct.unpack(order + "II", data[at : at + 8])
    if kind >> 16:  # the short form: size and type share the first four bytes
        kind, size = kind & 0xFFFF, kind >> 16
        if size > 4:
            raise BrokenError("a short element of more than 4 bytes")
        return kind, at + 4, size, at + 8
    after = at + 8 + size
    return kind, at + 8, size, after if kind == COMPRESSED else after + (-after) % 8


def whole(data: memoryview, start: int, size: int) -> memoryview:
    if start + size > len(data):
        raise BrokenError(f"an array of {size} bytes with {max(0, len(data) - start)} in the file")
    return data[start : start + size]


def array_head(data: memoryview, order: Order) -> Array:
    """The header of the array in ``data`` (the contents of a matrix element, or their beginning)."""
    kind, start, size, at = element(data, 0, order)
    if kind != 6 or size != 8:
        raise BrokenError("an array without its flags")
    (flags,) = struct.unpack(order + "I", whole(data, start, 4))
    kind = flags & 0xFF
    if kind == MAT5_OPAQUE_CLASS:  # an object, a table among them: its layout is its own affair
        return Array("", kind, False, (), data, at, order)
    stored, start, size, at = element(data, at, order)
    if stored not in (5, 6) or size % 4 or not 8 <= size <= 128:
        raise BrokenError("an array without its shape")
    shape = tuple(int(n) for n in np.frombuffer(whole(data, start, size), dtype=order + "i4"))
    if min(shape) < 0:
        raise BrokenError(f"the shape {shape}")
    _, start, size, at = element(data, at, order)
    name = bytes(whole(data, start, size)).decode("latin-1")
    return Array(name, kind, bool(flags & 0x0800), shape, data, at, order)


def object_class(array: Array) -> tuple[str, str]:
    """Name and class of an opaque variable, as far as it states them (name, "MCOS", class); empty where it does not."""
    words, at = [], array.at
    for _ in range(3):
        _, start, size, at = element(array.data, at, array.order)
        words.append(bytes(whole(array.data, start, min(size, KEY_TEXT_LIMIT))).decode("latin-1"))
    return (words[0], words[2]) if words[1] == "MCOS" else ("", "")


def field_names(array: Array) -> tuple[list[str], int]:
    """The names of a struct's fields, and where the fields begin."""
    _, start, size, at = element(array.data, array.at, array.order)
    if size != 4:
        raise BrokenError("a struct without the length of its names")
    (length,) = struct.unpack(array.order + "i", whole(array.data, start, 4))
    _, start, size, at = element(array.data, at, array.order)
    raw = bytes(whole(array.data, start, size))
    if length < 1 or size % length:
        raise BrokenError("a struct without names")
    names = [raw[i : i + length].split(b"\0")[0].decode("latin-1") for i in range(0, size, length)]
    return names, at


def elements_of(array: Array) -> list[dict[str, Array]]:
    """The elements of an array of structs, each as its fields by name with their own headers."""
    names, at = field_names(array)
    if len(set(names)) < len(names):
        raise BrokenError("a struct with a field twice")
    elements = []
    for _ in range(math.prod(array.shape)):
        found = {}
        for name in names:
            kind, start, size, at = element(array.data, at, array.order)
            if kind != MATRIX:
                raise BrokenError(f"a field of type {kind}")
            inside = whole(array.data, start, size)
            if size:
                head = array_head(inside, array.order)
                found[name] = Array(name, head.kind, head.is_complex, head.shape, inside, head.at, array.order)
        elements.append(found)
    return elements


def numbers_of(array: Array) -> npt.NDArray[Any]:
    """The values of a numeric array, as stored: MATLAB packs whole doubles into small integers."""
    kind, start, size, _ = element(array.data, array.at, array.order)
    if kind not in STORAGE:
        raise BrokenError(f"numbers stored as type {kind}")
    dtype = np.dtype(array.order + STORAGE[kind])
    if size != math.prod(array.shape) * dtype.itemsize:
        raise BrokenError(f"{array.name}: {size} bytes for {math.prod(array.shape)} numbers")
    return np.frombuffer(whole(array.data, start, size), dtype=dtype).reshape(array.shape, order="F")


def cells_of(array: Array) -> list[Array]:
    """The arrays in a cell."""
    found, at = [], array.at
    for _ in range(math.prod(array.shape)):
        kind, start, size, at = element(array.data, at, array.order)
        if kind != MATRIX:
            raise BrokenError(f"a cell with an element of type {kind}")
        found.append(array_head(whole(array.data, start, size), array.order))
    return found


def rows_of_text(array: Array) -> list[str]:
    """The rows of a matrix of characters without blanks at their ends; none where they are many, or no characters."""
    kind, start, size, _ = element(array.data, array.at, array.order)
    if kind not in CODECS or size > 4 * KEY_TEXT_LIMIT or len(array.shape) != 2:
        return []
    codec = CODECS[kind] + ({"<": "-le", ">": "-be"}[array.order] if kind in (4, 17, 18) else "")
    text = bytes(whole(array.data, start, size)).decode(codec, errors="replace")
    rows, columns = array.shape
    return ["".join(text[k::rows]).strip() for k in range(rows)] if len(text) == rows * columns else []
