"""Recordings as HDF5: one dataset per column, at the root or in one group however deep, the keys as attributes.

Only plain numbers inside the file are read: no links to other files, no external or virtual storage, no filters that
HDF5 would have to load from a plug-in.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.reader import (
    Reader,
    check_few,
    check_numbers,
    damage_reported,
    is_key,
    numbers,
    optional,
    take_key,
    wanted_columns,
)
from gearpoly.recording.recording import COLUMNS
from gearpoly.recording.stated_units import PACKED_NAMES, UNIT_NAMES, check_unit, unpacked
from gearpoly.recording.table import Table

SIGNATURE = b"\x89HDF\r\n\x1a\n"

FILTERS = frozenset({1, 2, 3, 4, 5, 6, 32000})
"""Filters that HDF5 and h5py hold themselves: deflate, shuffle, Fletcher 32, szip, n-bit, scale-offset, LZF."""


UNSIGNED = "_Unsigned"
"""Attribute of netCDF 3 by which stored numbers are of another type than they are."""

DEPTH = 4
"""Groups within groups that are looked through: data of a run of a test of a rig."""

ATTRIBUTE_LIMIT = 1000
"""Most values of one attribute of a column; a list of what counts as missing has a few."""


def read_table(file: Path) -> Table:
    """The columns and keys of one HDF5 file."""
    h5py = optional(file, "h5py", extra="hdf5")
    with damage_reported(file, "HDF5"), h5py.File(file, "r") as root:
        groups = nested(file, h5py, {"/": members(file, h5py, root)})
        where, held = only_group(file, groups, h5py.Dataset)
        table = Table(columns={}, keys={})
        datasets = [name for name, member in held.items() if isinstance(member, h5py.Dataset)]
        wanted = wanted_columns(file, where, datasets, table.remarks)
        check_datasets(file, {name: held[name] for name in wanted})
        for holder in (root, root[where]):
            _take_attributes(file, holder, table.keys)
        for name in wanted:
            table.columns[name] = numbers(file, name, stored(file, name, held[name]))
    return table


def nested(file: Path, h5py: Any, groups: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """The ``groups`` by path, with what lies in them, and those within them, ``DEPTH`` deep."""
    out, level = dict(groups), groups
    for _ in range(DEPTH):
        inner = {
            f"{path.rstrip('/')}/{name}": member
            for path, held in level.items()
            for name, member in held.items()
            if isinstance(member, h5py.Group)
        }
        check_few(file, "", len(out) + len(inner), "groups")
        level = {path: members(file, h5py, member) for path, member in inner.items()}
        out |= level
    return out


def members(file: Path, h5py: Any, group: Any) -> dict[str, Any]:
    """What lies in a group itself; links to other files and other places are left alone."""
    check_few(file, group.name, len(group), "datasets")
    own = (name for name in group if isinstance(group.get(name, getlink=True), h5py.HardLink))
    return {name: group[name] for name in own}


def only_group(file: Path, groups: dict[str, dict[str, Any]], kind: Any) -> tuple[str, dict[str, Any]]:
    """The one group that holds columns, with its members; the root where none does, for the message about it."""
    holding = [
        where for where, held in groups.items() if any(n in COLUMNS and isinstance(m, kind) for n, m in held.items())
    ]
    # In a MAT file torque_nm and speed_rpm may be keys at the root beside the struct with the columns.
    if (
        len(holding) > 1
        and "/" in holding
        and not any(n in COLUMNS and m.size > 1 for n, m in groups["/"].items() if isinstance(m, kind))
    ):
        holding.remove("/")
    if len(holding) > 1:
        found = f"columns in {shorten(' and '.join(holding), width=120)}"
        raise InputFileError(file, found=found, wish="want one recording in a file")
    where = holding[0] if holding else "/"
    return where, groups[where]


def check_datasets(file: Path, datasets: dict[str, Any]) -> None:
    """Refuse datasets that are no plain numbers in this file, and sizes beyond the limit, before anything is read."""
    sizes = {name: math.prod(dataset.shape or (0,)) for name, dataset in datasets.items()}
    for name, dataset in datasets.items():
        where = f"column {name}"
        if dataset.dtype.kind not in "iufb" or dataset.shape is None:
            found = f"values of type {dataset.dtype}"
            raise InputFileError(file, where=where, found=found, wish="want plain numbers")
        if dataset.is_virtual or dataset.external:
            wish = "want the numbers in the file itself"
            raise InputFileError(file, where=where, found="numbers kept in another file", wish=wish)
        if sizes[name] and not dataset.id.get_storage_size():
            wish = "want the values in the file; close it where it is written, and copy it then"
            raise InputFileError(file, where=where, found=f"{sizes[name]} values stated, and none there", wish=wish)
        layout = dataset.id.get_create_plist()
        for i in range(layout.get_nfilters()):
            if layout.get_filter(i)[0] not in FILTERS:
                found = f"compression by filter {layout.get_filter(i)[0]}"
                raise InputFileError(file, where=where, found=found, wish="want gzip, LZF or no compression")
    # A packed chunk is unpacked whole, beside its packed form.
    chunks = (2 * math.prod(one.chunks) * one.dtype.itemsize for one in datasets.values() if one.chunks)
    check_numbers(file, sum(sizes.values()), beside=max(chunks, default=0))


def stored(file: Path, name: str, dataset: Any) -> npt.NDArray[Any]:
    """The values of a dataset as its attributes mean them: unit, scale, offset, what is missing."""
    stated = {}
    for key in (*PACKED_NAMES, *UNIT_NAMES, UNSIGNED):
        if key in dataset.attrs:
            if math.prod(dataset.attrs.get_id(key).shape or (1,)) > ATTRIBUTE_LIMIT:
                raise InputFileError(file, where=f"column {name}", found=f"{key} is a long list", wish="want one value")
            stated[key] = dataset.attrs[key]
    if UNSIGNED in stated:
        wish = "want numbers of an unsigned type, as they are meant"
        raise InputFileError(file, where=f"column {name}", found=f"the attribute {UNSIGNED}", wish=wish)
    for key in UNIT_NAMES:
        if key in stated:
            check_unit(file, name, stated[key])
    return unpacked(file, name, np.asarray(dataset[()]), {k: np.asarray(v) for k, v in stated.items()})


def _take_attributes(file: Path, holder: Any, keys: dict[str, object]) -> None:
    """The keys among a group's attributes."""
    where = f"attributes of {holder.name}"
    check_few(file, where, len(holder.attrs), "attributes")
    for name in holder.attrs:
        if not is_key(file, where, name):
            continue
        if math.prod(holder.attrs.get_id(name).shape or (1,)) != 1:
            raise InputFileError(file, where=where, found=f"{name} is a list", wish="want one value")
        value = holder.attrs[name]
        take_key(file, where, name, value, keys)


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
