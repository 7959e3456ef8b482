"""Recordings as HDF5: one dataset per column, at the root or in one group up to four deep, the keys as attributes.

Datasets under other names, or in other groups, are offered to a map by their paths.
Only plain numbers inside the file are read: no links to other files, no external or virtual storage, no filters that
HDF5 would have to load from a plug-in.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gearpoly.errors import InputFileError
from gearpoly.recording.groups import own_group, take_own
from gearpoly.recording.hdf5_columns import Series, above, expanded, kept_elsewhere
from gearpoly.recording.hdf5_waveforms import Stated, put_begins, stated
from gearpoly.recording.reader import (
    DEEPEST_NESTING,
    Reader,
    check_few,
    check_held,
    damage_reported,
    is_key,
    numbers,
    offered,
    optional,
    take_key,
)
from gearpoly.recording.recording import COLUMNS, KEYS
from gearpoly.recording.stated_units import PACKED_NAMES, UNIT_NAMES, check_unit, unpacked
from gearpoly.recording.table import Channel, Table

SIGNATURE = b"\x89HDF\r\n\x1a\n"

EMPTY = "MATLAB_empty"
"""Attribute by which MATLAB marks a variable without values."""

UNSIGNED = "_Unsigned"
"""Attribute of netCDF 3 by which stored numbers are of another type than they are."""

CLASS = "MATLAB_class"
"""Attribute of MATLAB's own type of a variable; the fields of an array of structs have none."""

ELEMENTS_LIMIT = 10_000
"""Most fields of all elements of an array of structs: runs of a test are some dozen."""

ATTRIBUTE_LIMIT = 1000
"""Most values of one attribute of a column; a list of what counts as missing has a few."""


def read_table(file: Path) -> Table:
    """The columns and keys of one HDF5 file."""
    h5py = optional(file, "h5py", extra="hdf5")
    with damage_reported(file, "HDF5"), h5py.File(file, "r") as root:
        groups = {
            path: {name: member for name, member in held.items() if isinstance(member, h5py.Dataset)}
            for path, held in nested(file, h5py, {"/": members(file, h5py, root)}).items()
        }
        groups = expanded(h5py, root, groups)
        where = own_group(groups)
        table = Table(columns={}, keys={})
        for holder in dict.fromkeys(("/", *list(above(where or "/"))[::-1], where or "/")):
            if holder in root:  # an element of an array of structs has no place of its own
                _take_attributes(file, root[holder], table.keys, own=where is not None)
        left = take_datasets(file, root, table, groups, where, wrong=no_numbers)
        take_own(file, table)
        check_held(file, where or "/", table, left)
    return table


def take_datasets(
    file: Path,
    root: Any,
    table: Table,
    groups: Mapping[str, Mapping[str, Any]],
    where: str | None,
    *,
    wrong: Callable[[Any], tuple[str, str] | None],
    joint: str = "/",
) -> list[str]:
    """Put into ``table`` the columns of the group ``where``, and all other series of numbers in ``groups`` by their
    paths, whose parts stand about a ``joint``; ``wrong`` says what of a dataset is no plain numbers. The paths of what
    is left out.

    Raises ``InputFileError`` where a column is no plain numbers.
    """
    columns = {name: one for name, one in groups.get(where or "", {}).items() if name in COLUMNS}
    for name, dataset in columns.items():
        if why := wrong(dataset):
            raise InputFileError(file, where=f"column {name}", found=why[0], wish=why[1])
    others: dict[str, tuple[str, str, Any]] = {}
    left = []
    for group, held in groups.items():
        for name, dataset in held.items():
            path = joint.join([*group.strip("/").split("/"), name] if group != "/" else [name])
            if (group == where and name in columns) or (name in KEYS and name not in COLUMNS):
                continue
            if wrong(dataset) or dataset.size != max(dataset.shape, default=0):
                left.append(path)
            elif dataset.size > 1:
                others[path] = (group, name, dataset)
    every = {**columns, **{path: dataset for path, (_, _, dataset) in others.items()}}
    # A packed chunk is unpacked whole, beside its packed form.
    chunks = (2 * math.prod(one.chunks) * one.dtype.itemsize for one in every.values() if one.chunks)
    sizes = {name: int(one.size) for name, one in every.items()}
    said: dict[str, Stated] = {}
    for name in offered(file, sizes, columns, table.remarks, beside=max(chunks, default=0)):
        if name in columns:
            check_unit(file, name, _attribute(file, name, columns[name], UNIT_NAMES))
            values = stored(file, name, columns[name])
            # Of mapped numbers no page is touched here: the process that reads them looks whether they are finite.
            table.columns[name] = values if isinstance(values, np.memmap) else numbers(file, name, values)
            table.paths[joint.join([*(where or "").strip("/").split("/"), name]).lstrip(joint)] = name
        else:
            group, leaf, dataset = others[name]
            said[name] = stated(root, groups, group, leaf)
            values = np.ascontiguousarray(stored(file, name, dataset).reshape(-1), dtype=np.float64)
            table.others[name] = Channel(values=values)
    _take_said(file, table, said, {(group, leaf): path for path, (group, leaf, _) in others.items()})
    return left


def _take_said(file: Path, table: Table, said: Mapping[str, Stated], paths: Mapping[tuple[str, str], str]) -> None:
    """Give the channels of a ``table`` what is ``said`` of each beside its numbers; a dataset (its ``paths`` by group
    and name) that is the times of another one is no channel."""
    put_begins(file, said)
    for name, one in said.items():
        table.others[name] = replace(table.others[name], unit=one.unit, leaf=one.leaf, time=one.time)
    for path in {paths.get(times, "") for one in said.values() for times in one.taken}:
        table.others.pop(path, None)
    for text in dict.fromkeys(one.said for one in said.values() if one.said):
        table.remarks.append(f"times of channels by the attribute {text}")


def nested(file: Path, h5py: Any, groups: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """The ``groups`` by path, with what lies in them, and those within them, ``DEEPEST_NESTING`` deep."""
    out, level = dict(groups), groups
    for _ in range(DEEPEST_NESTING):
        inner = {
            f"{path.rstrip('/')}/{name}": member
            for path, held in level.items()
            for name, member in held.items()
            if isinstance(member, h5py.Group)
        }
        check_few(file, "", len(out) + len(inner), "groups")
        level = {}
        for path, member in inner.items():
            held = members(file, h5py, member)
            level |= _elements(h5py, path, member, held) or {path: held}
        check_few(file, "", len(out) + len(level), "groups")
        out |= level
    return out


def _elements(h5py: Any, path: str, group: Any, held: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """The elements of an array of structs of MATLAB, each by its path with its number from 1: every field is a list of
    references, one to the value of each element. None of any other group."""
    fields = list(held.values())
    of_references = all(
        isinstance(one, h5py.Dataset) and one.shape and h5py.check_ref_dtype(one.dtype) is h5py.Reference
        for one in fields
    )  # fmt: skip
    if not fields or not of_references or any(CLASS in one.attrs for one in fields) or CLASS not in group.attrs:
        return {}
    count = fields[0].size
    if any(one.size != count for one in fields) or count * len(fields) > ELEMENTS_LIMIT:
        return {}
    # HDF5 has the dimensions the other way round, so that its order is MATLAB's.
    values = {name: one[()].reshape(-1) for name, one in held.items()}
    return {
        f"{path}({k + 1})": {name: group.file[each[k]] for name, each in values.items() if each[k]}
        for k in range(count)
    }


def members(file: Path, h5py: Any, group: Any) -> dict[str, Any]:
    """What lies in a group itself; links to other files and other places are left alone."""
    check_few(file, group.name, len(group), "datasets")
    own = (name for name in group if isinstance(group.get(name, getlink=True), h5py.HardLink))
    return {name: group[name] for name in own}


def no_numbers(dataset: Any) -> tuple[str, str] | None:
    """What of a dataset is no plain numbers in this file, and what would do; ``None`` where it is."""
    if dataset.shape is None or dataset.dtype.kind not in "iufb":
        return f"values of type {dataset.dtype}", "want plain numbers"
    return kept_elsewhere(dataset)


def stored(file: Path, name: str, dataset: Any) -> npt.NDArray[Any]:
    """The values of a dataset as its attributes mean them: scale, offset, what is missing. MATLAB keeps the shape of an
    empty variable in its place."""
    if isinstance(dataset, Series):
        return unpacked(file, name, dataset.values, dataset.packing)
    attributes = dataset.attrs  # made anew whenever it is asked for, which takes longer than a look into it
    if EMPTY in attributes:
        return np.empty(0)
    if UNSIGNED in attributes:
        wish = "want numbers of an unsigned type, as they are meant"
        raise InputFileError(file, where=f"column {name}", found=f"the attribute {UNSIGNED}", wish=wish)
    stated = {key: _short(file, name, attributes, key) for key in PACKED_NAMES if key in attributes}
    values = None if stated else _mapped(file, dataset)
    if values is not None:
        return values
    return unpacked(file, name, np.asarray(dataset[()]), {k: np.asarray(v) for k, v in stated.items()})


def _mapped(file: Path, dataset: Any) -> npt.NDArray[Any] | None:
    """The values of a dataset mapped from the file, where they lie there in one piece as doubles; ``None`` elsewhere.
    Neither HDF5 nor the way between two processes then copies them. The offset counts from the file's beginning, a user
    block before HDF5's own included (H5D__get_offset of HDF5 1.8 to 2.0)."""
    offset = dataset.id.get_offset() if dataset.chunks is None else None
    series = dataset.dtype == np.dtype("=f8") and dataset.size == max(dataset.shape, default=0) > 0
    if offset is None or not series or offset + 8 * dataset.size > file.stat().st_size:
        return None
    return np.memmap(file, dtype=np.float64, mode="r", offset=offset, shape=(dataset.size,))


def _short(file: Path, name: str, attributes: Any, key: str) -> Any:
    """The value of an attribute, which is no long list."""
    if math.prod(attributes.get_id(key).shape or (1,)) > ATTRIBUTE_LIMIT:
        raise InputFileError(file, where=f"column {name}", found=f"{key} is a long list", wish="want one value")
    return attributes[key]


def _attribute(file: Path, name: str, dataset: Any, keys: Sequence[str]) -> str:
    """The text of the first of some attributes that a dataset has, or nothing."""
    held = dataset.attrs
    value = next((_short(file, name, held, key) for key in keys if key in held), "")
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _take_attributes(file: Path, holder: Any, keys: dict[str, object], *, own: bool) -> None:
    """The keys among a group's attributes."""
    where = f"attributes of {holder.name}"
    held = holder.attrs
    check_few(file, where, len(held), "attributes")
    for name in held:
        if not is_key(file, where, name, own=own):
            continue
        if math.prod(held.get_id(name).shape or (1,)) != 1:
            raise InputFileError(file, where=where, found=f"{name} is a list", wish="want one value")
        take_key(file, where, name, held[name], keys)


def _recognises(head: bytes) -> bool:
    if head.startswith(b"MATLAB 7.3"):
        return False
    return any(head[at : at + 8] == SIGNATURE for at in (0, 512, 1024, 2048))


READER = Reader(
    name="HDF5",
    endings=(".h5", ".hdf5", ".hdf", ".he5"),
    recognises=_recognises,
    read=read_table,
    module="h5py",
    extra="hdf5",
    apart=True,
)
