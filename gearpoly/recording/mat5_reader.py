"""Recordings as MAT 5 (MATLAB's -v6 and -v7): plain variables or one struct, the keys as scalars and text.

SciPy's ``loadmat`` takes the sizes that a file states at their word, and its manual says that it is not hardened
against bad files. Here the elements are walked first, every size is compared with what is really there, and only
arrays of real numbers and short texts are taken out. Objects, functions, cells and opaque variables are passed over, so
there is nothing left that a general reader would be needed for.

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

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten, unreadable
from gearpoly.recording.matlab_objects import refuse_objects
from gearpoly.recording.reader import Reader, check_few, check_numbers, is_key, numbers, take_key, wanted_columns
from gearpoly.recording.recording import COLUMNS, KEYS
from gearpoly.recording.table import Table

Order = Literal["<", ">"]

HEADER_BYTES = 128
HEAD_BYTES = 2**16
"""How much of a variable is looked at to learn its class, shape, name and, of a struct, the names of its fields."""
TEXT_LIMIT = 1000
"""Longest text that a key may have, in characters; ``flank`` needs five."""
DEPTH = 4
"""Structs within structs that are looked through: data of a run of a test of a rig."""

MATRIX, COMPRESSED = 14, 15
STRUCT, CHAR, OPAQUE = 2, 4, 17
NUMERIC_CLASSES = range(6, 16)
STORAGE = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
CODECS = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
CLASS_NAMES = {1: "cell", 2: "struct", 3: "object", 4: "text", 5: "sparse matrix", 16: "function", 17: "object"}


class _BrokenError(Exception):
    """The walk met a size or a type that cannot be; the caller knows the file."""


@dataclass(frozen=True)
class _Variable:
    """Where one top-level variable lies in the file, and whether it is packed."""

    packed: bool
    offset: int
    size: int


@dataclass(frozen=True)
class _Array:
    """One array as its header states it: class, shape and name; its contents begin at ``at`` in ``data``."""

    name: str
    kind: int
    is_complex: bool
    shape: tuple[int, ...]
    data: memoryview
    at: int
    order: Order


def read_table(file: Path) -> Table:
    """The columns and keys of one MAT 5 file."""
    try:
        with file.open("rb") as stream:
            return _read(file, stream)
    except (_BrokenError, zlib.error) as error:
        found = f"a cut-off or damaged MAT 5 file ({error})"
        raise InputFileError(file, found=found, wish="want the whole file; save it again") from None
    except OSError as error:
        raise unreadable(file, error) from None


def _read(file: Path, stream: BinaryIO) -> Table:
    stream.seek(HEADER_BYTES - 2)
    order: Order = "<" if stream.read(2) == b"IM" else ">"
    table = Table(columns={}, keys={})
    places: dict[str, _Variable] = {}
    heads: dict[str, _Array] = {}
    objects: dict[str, str] = {}
    for variable in _variables(stream, order):
        head = _array(memoryview(_unpacked(file, stream, variable, order, limit=HEAD_BYTES)), order)
        if head.kind == OPAQUE:
            objects.update(_object(head))
        elif head.name and not head.name.startswith("__"):
            heads[head.name], places[head.name] = head, variable
        check_few(file, "", len(heads), "variables")
    where = _place(file, heads)
    if where:
        inside = _fields(_array(memoryview(_unpacked(file, stream, places[where], order)), order))
    elif deeper := _deeper(file, stream, order, heads, places):
        where, inside = deeper
    else:
        if not any(name in COLUMNS for name in heads):
            refuse_objects(file, objects)
        wanted = [name for name in heads if name in COLUMNS and not _is_scalar_key(heads[name])]
        check_numbers(file, sum(math.prod(heads[name].shape) for name in wanted))
        inside = heads
    keys = [(where or "variables", inside)] + ([("variables", heads)] if where else [])
    if (stated := heads.get("keys")) is not None and stated.kind == STRUCT and where != "keys":
        keys.append(("keys", _fields(_array(memoryview(_unpacked(file, stream, places["keys"], order)), order))))
    if (stated := inside.get("keys")) is not None and stated.kind == STRUCT and where:
        keys.append((f"{where}.keys", _fields(stated)))
    for holder, arrays in keys:
        for name, array in arrays.items():
            single = math.prod(array.shape) == 1 or array.kind == CHAR
            if single and not _is_column_only(name) and is_key(file, holder, name):
                take_key(file, holder, name, _value(file, holder, array), table.keys)
    names = [name for name, array in inside.items() if name != "keys" and not _is_scalar_key(array)]
    wanted = wanted_columns(file, where or "variables", names, table.remarks)
    check_numbers(file, sum(math.prod(inside[name].shape) for name in wanted))
    for name in wanted:
        array = inside[name]
        if not where:  # only its head was unpacked so far; its shape bounds the rest
            bound = HEAD_BYTES + 8 * math.prod(array.shape)
            array = _array(memoryview(_unpacked(file, stream, places[name], order, limit=bound)), order)
        if array.kind not in NUMERIC_CLASSES or array.is_complex:
            found = "complex numbers" if array.is_complex else f"a {CLASS_NAMES.get(array.kind, 'variable')}"
            raise InputFileError(file, where=f"column {name}", found=found, wish="want plain numbers")
        table.columns[name] = numbers(file, name, _numbers(array))
    return table


def _place(file: Path, heads: dict[str, _Array]) -> str:
    """The name of the struct that holds the columns, or nothing where they are variables themselves."""
    if any(name in COLUMNS and not _is_scalar_key(head) for name, head in heads.items()):
        return ""
    holding = [
        name for name, head in heads.items() if head.kind == STRUCT and any(n in COLUMNS for n in _field_names(head)[0])
    ]
    holding = [name for name in holding if name != "keys"] or holding
    if len(holding) > 1:
        found = f"columns in {shorten(' and '.join(holding), width=120)}"
        raise InputFileError(file, found=found, wish="want one recording in a file")
    return holding[0] if holding else ""


def _deeper(
    file: Path, stream: BinaryIO, order: Order, heads: dict[str, _Array], places: dict[str, _Variable]
) -> tuple[str, dict[str, _Array]] | None:
    """The struct within a struct that holds the columns, by its path, with its fields; ``None`` where there is none or
    they are variables themselves."""
    if any(name in COLUMNS and not _is_scalar_key(head) for name, head in heads.items()):
        return None
    waiting = [
        (name, _array(memoryview(_unpacked(file, stream, places[name], order)), order))
        for name, head in heads.items()
        if head.kind == STRUCT and math.prod(head.shape) == 1 and name != "keys"
    ]
    found = []
    for _ in range(DEPTH):
        inner = [(path, _fields(array)) for path, array in waiting]
        found += [(path, held) for path, held in inner if any(name in COLUMNS for name in held)]
        waiting = [
            (f"{path}.{name}", array)
            for path, held in inner
            for name, array in held.items()
            if array.kind == STRUCT and math.prod(array.shape) == 1 and name != "keys"
        ]
        check_few(file, "", len(waiting), "structs")
    if len(found) > 1:
        listed = shorten(" and ".join(path for path, _ in found), width=120)
        raise InputFileError(file, found=f"columns in {listed}", wish="want one recording in a file")
    return found[0] if found else None


def _is_column_only(name: str) -> bool:
    return name in COLUMNS and name not in KEYS


def _is_scalar_key(array: _Array) -> bool:
    return array.name in KEYS and (math.prod(array.shape) == 1 or array.kind == CHAR)


def _variables(stream: BinaryIO, order: Order) -> list[_Variable]:
    """Where every variable lies; nothing is read but the tags."""
    end = stream.seek(0, 2)
    at, found = HEADER_BYTES, []
    while at < end:
        stream.seek(at)
        tag = stream.read(8)
        if len(tag) < 8:
            raise _BrokenError("it ends inside a tag")
        kind, size = struct.unpack(order + "II", tag)
        if kind not in (MATRIX, COMPRESSED):
            raise _BrokenError(f"an element of type {kind} at byte {at}")
        if at + 8 + size > end:
            raise _BrokenError(f"it ends at byte {end}, inside a variable that runs to {at + 8 + size}")
        if size:
            found.append(_Variable(kind == COMPRESSED, at + 8, size))
        at += 8 + size
    return found


def _unpacked(file: Path, stream: BinaryIO, variable: _Variable, order: Order, *, limit: int | None = None) -> bytes:
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
        raise _BrokenError(f"a packed variable at byte {variable.offset} that does not unpack")
    kind, size = struct.unpack(order + "II", tag)
    if kind != MATRIX:
        raise _BrokenError(f"a packed element of type {kind} at byte {variable.offset}")
    wanted = min(size, limit or size)
    check_numbers(file, 0, beside=2 * wanted)
    data = inflate.decompress(inflate.unconsumed_tail, wanted) if wanted else b""
    if len(data) < wanted:
        raise _BrokenError(f"a packed variable at byte {variable.offset} of {len(data)} bytes instead of {size}")
    return data


def _element(data: memoryview, at: int, order: Order) -> tuple[int, int, int, int]:
    """Type, start and size of the element at ``at``, and where the next one begins."""
    if at + 8 > len(data):
        raise _BrokenError("an array that ends too early")
    kind, size = struct.unpack(order + "II", data[at : at + 8])
    if kind >> 16:  # the short form: size and type share the first four bytes
        kind, size = kind & 0xFFFF, kind >> 16
        if size > 4:
            raise _BrokenError("a short element of more than 4 bytes")
        return kind, at + 4, size, at + 8
    after = at + 8 + size
    return kind, at + 8, size, after if kind == COMPRESSED else after + (-after) % 8


def _whole(data: memoryview, start: int, size: int) -> memoryview:
    if start + size > len(data):
        raise _BrokenError(f"an array of {size} bytes with {max(0, len(data) - start)} in the file")
    return data[start : start + size]


def _array(data: memoryview, order: Order) -> _Array:
    """The header of the array in ``data`` (the contents of a matrix element, or their beginning)."""
    kind, start, size, at = _element(data, 0, order)
    if kind != 6 or size != 8:
        raise _BrokenError("an array without its flags")
    (flags,) = struct.unpack(order + "I", _whole(data, start, 4))
    kind = flags & 0xFF
    if kind == OPAQUE:  # an object, a table among them: its layout is its own affair
        return _Array("", kind, False, (), data, at, order)
    stored, start, size, at = _element(data, at, order)
    if stored not in (5, 6) or size % 4 or not 8 <= size <= 128:
        raise _BrokenError("an array without its shape")
    shape = tuple(int(n) for n in np.frombuffer(_whole(data, start, size), dtype=order + "i4"))
    if min(shape) < 0:
        raise _BrokenError(f"the shape {shape}")
    _, start, size, at = _element(data, at, order)
    name = bytes(_whole(data, start, size)).decode("latin-1")
    return _Array(name, kind, bool(flags & 0x0800), shape, data, at, order)


def _object(array: _Array) -> dict[str, str]:
    """Name and class of an opaque variable, as far as it states them: name, "MCOS", class."""
    words, at = [], array.at
    for _ in range(3):
        _, start, size, at = _element(array.data, at, array.order)
        words.append(bytes(_whole(array.data, start, min(size, TEXT_LIMIT))).decode("latin-1"))
    return {words[0]: words[2]} if words[0].isidentifier() and words[1] == "MCOS" else {}


def _field_names(array: _Array) -> tuple[list[str], int]:
    """The names of a struct's fields, and where the fields begin."""
    _, start, size, at = _element(array.data, array.at, array.order)
    if size != 4:
        raise _BrokenError("a struct without the length of its names")
    (length,) = struct.unpack(array.order + "i", _whole(array.data, start, 4))
    _, start, size, at = _element(array.data, at, array.order)
    raw = bytes(_whole(array.data, start, size))
    if length < 1 or size % length:
        raise _BrokenError("a struct without names")
    names = [raw[i : i + length].split(b"\0")[0].decode("latin-1") for i in range(0, size, length)]
    return names, at


def _fields(array: _Array) -> dict[str, _Array]:
    """The fields of a struct of one element, by name, each with its own header."""
    if math.prod(array.shape) != 1:
        raise _BrokenError(f"an array of {math.prod(array.shape)} structs where one is wanted")
    names, at = _field_names(array)
    found = {}
    for name in names:
        kind, start, size, at = _element(array.data, at, array.order)
        if kind != MATRIX:
            raise _BrokenError(f"a field of type {kind}")
        inside = _whole(array.data, start, size)
        if size:
            head = _array(inside, array.order)
            found[name] = _Array(name, head.kind, head.is_complex, head.shape, inside, head.at, array.order)
    return found


def _numbers(array: _Array) -> npt.NDArray[Any]:
    """The values of a numeric array, as stored: MATLAB packs whole doubles into small integers."""
    kind, start, size, _ = _element(array.data, array.at, array.order)
    if kind not in STORAGE:
        raise _BrokenError(f"numbers stored as type {kind}")
    dtype = np.dtype(array.order + STORAGE[kind])
    if size != math.prod(array.shape) * dtype.itemsize:
        raise _BrokenError(f"{array.name}: {size} bytes for {math.prod(array.shape)} numbers")
    return np.frombuffer(_whole(array.data, start, size), dtype=dtype).reshape(array.shape, order="F")


def _value(file: Path, where: str, array: _Array) -> object:
    """A key's value: a scalar, or a short text."""
    if array.kind in NUMERIC_CLASSES and not array.is_complex:
        return _numbers(array)
    if array.kind != CHAR:
        found = f"{array.name} is a {CLASS_NAMES.get(array.kind, 'variable')}"
        raise InputFileError(file, where=where, found=found, wish="want a number or a text")
    kind, start, size, _ = _element(array.data, array.at, array.order)
    if kind not in CODECS or size > 4 * TEXT_LIMIT:
        raise InputFileError(file, where=where, found=f"{array.name} is no short text", wish="want a short text")
    codec = CODECS[kind] + ({"<": "-le", ">": "-be"}[array.order] if kind in (4, 17, 18) else "")
    return bytes(_whole(array.data, start, size)).decode(codec, errors="replace")


def _recognises(head: bytes) -> bool:
    """The version and byte order at the end of the header; version 2 is MAT 7.3."""
    return head[124:128] in (b"\x00\x01IM", b"\x01\x00MI")


READER = Reader(name="MAT 5", endings=(".mat",), recognises=_recognises, read=read_table)
