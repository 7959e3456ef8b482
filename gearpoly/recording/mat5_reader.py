"""Recordings as MAT 5 (MATLAB's -v6 and -v7): plain variables or one struct, the keys as scalars and text.

SciPy's ``loadmat`` takes the sizes that a file states at their word, and its manual says that it is not hardened
against bad files. Here the elements are walked first, every size is compared with what is really there, and only
arrays of real numbers and short texts are taken out. Functions and cells are passed over; tables and timetables are
read by a library in a process of its own.
"""

from __future__ import annotations

import contextlib
import math
import zlib
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import BinaryIO

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten, unreadable
from gearpoly.recording.apart import read_apart
from gearpoly.recording.groups import own_group, take_own
from gearpoly.recording.mat5_layout import (
    CLASS_NAMES,
    CODECS,
    MAT5_CHAR_CLASS,
    MAT5_HEADER_BYTES,
    MAT5_OPAQUE_CLASS,
    MAT5_STRUCT_CLASS,
    NUMERIC_CLASSES,
    VARIABLE_HEAD_BYTES,
    Array,
    BrokenError,
    Order,
    Variable,
    array_head,
    element,
    elements_of,
    numbers_of,
    object_class,
    unpacked,
    variables,
    whole,
)
from gearpoly.recording.mat5_matrices import MatrixColumn, matrix_columns
from gearpoly.recording.matlab_tables import READER as TABLES
from gearpoly.recording.matlab_tables import take_tables
from gearpoly.recording.reader import (
    DEEPEST_NESTING,
    KEY_TEXT_LIMIT,
    NAMES_LIMIT,
    Reader,
    check_few,
    check_held,
    is_key,
    numbers,
    offered,
    take_key,
)
from gearpoly.recording.recording import COLUMNS, KEYS
from gearpoly.recording.table import Channel, Table

SERIES_FIELDS = ("Data", "data", "Values", "values")
"""Fields of a struct that hold the numbers of a channel."""


def read_table(file: Path) -> Table:
    """The columns and keys of one MAT 5 file."""
    try:
        with file.open("rb") as stream:
            return _read(file, stream)
    except (BrokenError, zlib.error) as error:
        found = f"a cut-off or damaged MAT 5 file ({error})"
        raise InputFileError(file, found=found, wish="want the whole file; save it again") from None
    except OSError as error:
        raise unreadable(file, error) from None


def _read(file: Path, stream: BinaryIO) -> Table:
    stream.seek(MAT5_HEADER_BYTES - 2)
    order: Order = "<" if stream.read(2) == b"IM" else ">"
    places: dict[str, Variable] = {}
    heads: dict[str, Array] = {}
    objects: dict[str, str] = {}
    for variable in variables(stream, order):
        head = array_head(memoryview(unpacked(file, stream, variable, order, limit=VARIABLE_HEAD_BYTES)), order)
        if head.kind == MAT5_OPAQUE_CLASS:
            name, kind = object_class(head)
            if name.isidentifier() and kind:
                objects[name] = kind
        elif head.name and not head.name.startswith("__"):
            if head.name in heads:
                found = f'"{shorten(head.name)}" at byte {places[head.name].offset} and at byte {variable.offset}'
                wish = "want each variable once; load the file and save it again"
                raise InputFileError(file, where="variables", found=found, wish=wish)
            heads[head.name], places[head.name] = head, variable
        check_few(file, "", len(heads), "variables")
    groups: dict[str, dict[str, Array]] = {"": heads}
    for name, head in heads.items():
        if head.kind == MAT5_STRUCT_CLASS and 0 < math.prod(head.shape) <= NAMES_LIMIT:
            struct = array_head(memoryview(unpacked(file, stream, places[name], order)), order)
            _take_fields(file, name, struct, groups, objects)
    unpacked_whole: dict[str, Array] = {}

    def inside(array: Array) -> Array:
        """An array with its contents: of a variable only the head was unpacked so far; its shape bounds the rest."""
        if array is not heads.get(array.name):
            return array
        if array.name not in unpacked_whole:
            unpacked_whole.clear()  # columns of a matrix come one after the other
            bound = VARIABLE_HEAD_BYTES + 8 * math.prod(array.shape)
            data = unpacked(
                file, stream, places[array.name], order, limit=bound if array.kind in NUMERIC_CLASSES else None
            )
            unpacked_whole[array.name] = array_head(memoryview(data), order)
        return unpacked_whole[array.name]

    parts = list(matrix_columns(groups, inside))
    table = Table(columns={}, keys={})
    where = _place(groups, parts)
    own = {} if where is None else groups.get(where, {})
    _take_keys(file, groups, where, table.keys)
    columns = {name: array for name, array in own.items() if name in COLUMNS and not _is_scalar_key(name, array)}
    for name, array in columns.items():
        if array.kind not in NUMERIC_CLASSES or array.is_complex:
            found = "complex numbers" if array.is_complex else f"a {CLASS_NAMES.get(array.kind, 'variable')}"
            raise InputFileError(file, where=f"column {name}", found=found, wish="want plain numbers")
    others, left = _others(groups, where, columns, {id(one.matrix) for *_, one in parts})
    of_matrix = {path: (leaf, one) for _, leaf, path, one in parts if path not in others and path not in columns}
    every = {**columns, **{path: array for path, (_, array) in others.items()}}
    sizes = {name: math.prod(array.shape) for name, array in every.items()}
    sizes |= {path: one.size for path, (_, one) in of_matrix.items()}
    for name in offered(file, sizes, columns, table.remarks):
        if name in of_matrix:
            leaf, one = of_matrix[name]
            values = np.ascontiguousarray(one.of(numbers_of(inside(one.matrix))), dtype=np.float64)
            table.others[name] = Channel(values=values, unit=one.unit, leaf=leaf)
            continue
        array = inside(every[name])
        if name in columns:
            table.columns[name] = numbers(file, name, numbers_of(array))
            table.paths[f"{where}.{name}" if where else name] = name
        else:
            values = np.ascontiguousarray(numbers_of(array).reshape(-1), dtype=np.float64)
            leaf, unit = _called(file, groups[name.rpartition(".")[0]], others[name][0])
            table.others[name] = Channel(values=values, unit=unit, leaf=leaf)
    take_tables(file, table, objects, lambda names: read_apart(TABLES, file, names))
    take_own(file, table)
    check_held(file, where or "variables", table, left)
    return table


def _take_fields(
    file: Path,
    path: str,
    array: Array,
    groups: dict[str, dict[str, Array]],
    objects: dict[str, str],
    depth: int = 1,
) -> None:
    """Put the fields of a struct, of each element where it is an array of them, and of structs within into ``groups``
    by their paths: ``rig.run(2)``; and what of them are ``objects`` into these, with their classes."""
    elements = elements_of(array)
    for number, fields in enumerate(elements, start=1):
        place = path if len(elements) == 1 else f"{path}({number})"
        groups[place] = {name: inner for name, inner in fields.items() if inner.kind != MAT5_OPAQUE_CLASS}
        check_few(file, "", sum(len(held) for held in groups.values()), "fields of structs")
        for name, inner in fields.items():
            if inner.kind == MAT5_OPAQUE_CLASS:
                objects[f"{place}.{name}"] = object_class(inner)[1]
            elif (
                inner.kind == MAT5_STRUCT_CLASS
                and depth < DEEPEST_NESTING
                and 0 < math.prod(inner.shape) <= NAMES_LIMIT
            ):
                _take_fields(file, f"{place}.{name}", inner, groups, objects, depth + 1)


def _place(
    groups: Mapping[str, Mapping[str, Array]], parts: Iterable[tuple[str, str, str, MatrixColumn]]
) -> str | None:
    """The path of the struct that holds the columns, empty where they are variables themselves, and ``None`` where none
    or several do. One called keys counts last."""
    series = {
        path: [name for name, array in held.items() if not _is_scalar_key(name, array)] for path, held in groups.items()
    }
    for group, name, _, _ in parts:
        series.setdefault(group, []).append(name)
    if any(name in COLUMNS for name in series[""]):
        return ""
    place = own_group({path: names for path, names in series.items() if not _is_keys(path)})
    return own_group({path: names for path, names in series.items() if _is_keys(path)}) if place is None else place


def _is_keys(path: str) -> bool:
    return path.rpartition(".")[2] == "keys"


def _take_keys(
    file: Path, groups: Mapping[str, Mapping[str, Array]], where: str | None, keys: dict[str, object]
) -> None:
    """The keys among the variables, beside the columns, and in structs called keys beside either."""
    about = [
        (where or "")[:at] for at, letter in enumerate(where or "") if letter == "."
    ]  # columns of a matrix lie in it
    places = dict.fromkeys([where or "", *about[::-1], "", "keys", f"{where}.keys" if where else "keys"])
    for place in places:
        for name, array in groups.get(place, {}).items():
            single = math.prod(array.shape) == 1 or array.kind == MAT5_CHAR_CLASS
            column_only = name in COLUMNS and name not in KEYS
            if single and not column_only and is_key(file, place or "variables", name, own=where is not None):
                take_key(file, place or "variables", name, _value(file, place or "variables", array), keys)


def _others(
    groups: Mapping[str, Mapping[str, Array]], where: str | None, columns: Mapping[str, Array], parted: Collection[int]
) -> tuple[dict[str, tuple[str, Array]], list[str]]:
    """The series of numbers beside the ``columns`` by their paths, each with its own name; and what else there is, but
    for matrices that are ``parted`` (by id)."""
    out, left = {}, []
    for place, held in groups.items():
        if _is_keys(place) and place != where:
            continue
        for name, array in held.items():
            path = f"{place}.{name}" if place else name
            if (place == where and name in columns) or array.kind == MAT5_STRUCT_CLASS or _is_scalar_key(name, array):
                continue
            if id(array) in parted:
                continue
            size = math.prod(array.shape)
            if array.kind not in NUMERIC_CLASSES or array.is_complex or size != max(array.shape, default=0):
                left.append(path)
            elif size > 1:
                out[path] = (name, array)
    return out, left


def _called(file: Path, beside: Mapping[str, Array], field: str) -> tuple[str, str]:
    """The name and the unit of the numbers in a ``field``: those in the texts ``Name`` and ``Unit`` beside them, where
    ControlDesk and others keep each channel as a struct; else the field's own name, and nothing."""
    texts = []
    for key in ("Name", "Unit"):
        text: object = ""
        if key in beside and beside[key].kind == MAT5_CHAR_CLASS:
            with contextlib.suppress(InputFileError):  # a long text is no name, and nothing of the recording
                text = _value(file, field, beside[key])
        texts.append(str(text).strip())
    name = texts[0].rpartition("/")[2].strip('" ')  # the last part of a path in the model
    return (name, texts[1]) if field in SERIES_FIELDS and name else (field, "")


def _is_scalar_key(name: str, array: Array) -> bool:
    return name in KEYS and (math.prod(array.shape) == 1 or array.kind == MAT5_CHAR_CLASS)


def _value(file: Path, where: str, array: Array) -> object:
    """A key's value: a scalar, or a short text."""
    if array.kind in NUMERIC_CLASSES and not array.is_complex:
        return numbers_of(array)
    if array.kind != MAT5_CHAR_CLASS:
        found = f"{array.name} is a {CLASS_NAMES.get(array.kind, 'variable')}"
        raise InputFileError(file, where=where, found=found, wish="want a number or a text")
    kind, start, size, _ = element(array.data, array.at, array.order)
    if kind not in CODECS or size > 4 * KEY_TEXT_LIMIT:
        raise InputFileError(file, where=where, found=f"{array.name} is no short text", wish="want a short text")
    codec = CODECS[kind] + ({"<": "-le", ">": "-be"}[array.order] if kind in (4, 17, 18) else "")
    return bytes(whole(array.data, start, size)).decode(codec, errors="replace")


def _recognises(head: bytes) -> bool:
    """The version and byte order at the end of the header; version 2 is MAT 7.3."""
    return head[124:128] in (b"\x00\x01IM", b"\x01\x00MI")


READER = Reader(name="MAT 5", endings=(".mat",), recognises=_recognises, read=read_table)
