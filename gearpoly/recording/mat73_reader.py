"""Recordings as MAT 7.3, which is HDF5 inside: plain variables or one struct, the keys as scalars and text.

As in MAT 5, ``torque_nm`` and ``speed_rpm`` are keys where they are scalars; where a recording has both the key and the
column, the keys go into a struct called ``keys``. Objects, function handles and cells are not looked into.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.recording.hdf5_reader import SIGNATURE, check_datasets, members, nested, only_group, stored
from gearpoly.recording.matlab_objects import refuse_objects
from gearpoly.recording.reader import Reader, damage_reported, is_key, numbers, optional, take_key, wanted_columns
from gearpoly.recording.recording import COLUMNS, KEYS
from gearpoly.recording.table import Table

TEXT_LIMIT = 1000
"""Longest text that a key may have, in characters; ``flank`` needs five."""


def read_table(file: Path) -> Table:
    """The columns and keys of one MAT 7.3 file."""
    h5py = optional(file, "h5py", extra="hdf5")
    with damage_reported(file, "MAT 7.3"), h5py.File(file, "r") as root:
        top = {name: item for name, item in members(file, h5py, root).items() if not name.startswith("#")}
        groups = nested(file, h5py, {"/": top})
        stated = groups.pop("/keys", {})
        where, held = only_group(file, {k: v for k, v in groups.items() if not k.endswith("/keys")}, h5py.Dataset)
        if not any(name in COLUMNS for name in held):
            objects = {name: _class(item) for name, item in top.items() if "MATLAB_object_decode" in item.attrs}
            refuse_objects(file, objects)
        table = Table(columns={}, keys={})
        for holder, inside in ((f"{where}/keys", held.get("keys")), ("keys", stated), (where, held), ("/", top)):
            if isinstance(inside, h5py.Group):
                inside = members(file, h5py, inside)
            for name, item in (inside or {}).items():
                single = isinstance(item, h5py.Dataset) and (item.size == 1 or _class(item) == "char")
                column_only = name in COLUMNS and name not in KEYS
                if single and not column_only and is_key(file, holder, name):
                    take_key(file, holder, name, _value(file, holder, name, item), table.keys)
        arrays = {n: item for n, item in held.items() if isinstance(item, h5py.Dataset)}
        columns = [n for n in arrays if not (n in KEYS and arrays[n].size == 1)]
        wanted = wanted_columns(file, where, columns, table.remarks)
        for name in wanted:
            kind = _class(arrays[name])
            if (
                kind in ("cell", "char", "function_handle", "FileWrapper__")
                or "MATLAB_object_decode" in arrays[name].attrs
            ):
                raise InputFileError(file, where=f"column {name}", found=f"a {kind}", wish="want plain numbers")
        check_datasets(file, {name: arrays[name] for name in wanted})
        for name in wanted:
            empty = "MATLAB_empty" in arrays[name].attrs
            table.columns[name] = numbers(file, name, np.empty(0) if empty else stored(file, name, arrays[name]))
    return table


def _class(item: Any) -> str:
    """MATLAB's own class of a variable, or nothing where another program wrote it."""
    value = item.attrs.get("MATLAB_class", b"")
    return value.decode("ascii", errors="replace") if isinstance(value, bytes) else str(value)


def _value(file: Path, where: str, name: str, item: Any) -> object:
    """A key's value: a scalar, or text, which MATLAB keeps as 16-bit codes."""
    if math.prod(item.shape or (0,)) > TEXT_LIMIT or item.is_virtual or item.external:
        raise InputFileError(file, where=where, found=f"{name} is an array", wish="want one value")
    value = item[()]
    if _class(item) == "char" or (isinstance(value, np.ndarray) and value.dtype == np.uint16 and value.size > 1):
        return "".join(chr(int(code)) for code in np.asarray(value).reshape(-1, order="F"))
    return value


READER = Reader(
    name="MAT 7.3",
    endings=(".mat",),
    recognises=lambda head: any(head[at : at + 8] == SIGNATURE for at in (0, 512, 1024, 2048)),
    read=read_table,
    module="h5py",
    extra="hdf5",
    apart=True,
)
