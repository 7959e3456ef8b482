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
from gearpoly.recording.groups import own_group, take_own
from gearpoly.recording.hdf5_columns import OBJECT, above, expanded
from gearpoly.recording.hdf5_reader import SIGNATURE, members, nested, no_numbers, take_datasets
from gearpoly.recording.matlab_tables import read_table as read_tables
from gearpoly.recording.matlab_tables import take_tables
from gearpoly.recording.reader import KEY_TEXT_LIMIT, Reader, check_held, damage_reported, is_key, optional, take_key
from gearpoly.recording.recording import COLUMNS, KEYS
from gearpoly.recording.table import Table


def read_table(file: Path) -> Table:
    """The columns and keys of one MAT 7.3 file."""
    h5py = optional(file, "h5py", extra="hdf5")
    with damage_reported(file, "MAT 7.3"), h5py.File(file, "r") as root:
        top = {name: item for name, item in members(file, h5py, root).items() if not name.startswith("#")}
        groups = nested(file, h5py, {"/": top})
        stated = groups.pop("/keys", {})
        series = {
            path: {
                name: item for name, item in held.items() if isinstance(item, h5py.Dataset) and not _is_key(name, item)
            }
            for path, held in groups.items()
            if not path.endswith("/keys")
        }
        series = expanded(h5py, root, series)
        where = own_group(series)
        held = groups.get(where or "", {})
        table = Table(columns={}, keys={})
        own = held.get("keys") if where not in (None, "/") else None
        about = {place: groups.get(place, {}) for place in above(where or "/")}  # columns of a matrix lie in it
        # Each holder once, also where all lies at the top.
        for holder, inside in {f"{where}/keys": own, "keys": stated, where or "/": held, **about, "/": top}.items():
            if isinstance(inside, h5py.Group):
                inside = members(file, h5py, inside)
            for name, item in (inside or {}).items():
                if (name in COLUMNS and name not in KEYS) or not isinstance(item, h5py.Dataset):
                    continue
                single = item.size == 1 or _class(item) == "char"
                if single and is_key(file, holder, name, own=where is not None):
                    take_key(file, holder, name, _value(file, holder, name, item), table.keys)
        objects = {
            ".".join([*path.strip("/").split("/"), name] if path != "/" else [name]): _class(item)
            for path, held in groups.items()
            for name, item in held.items()
            if OBJECT in item.attrs
        }
        left = take_datasets(file, root, table, series, where, wrong=_no_numbers, joint=".")
    take_tables(file, table, objects, lambda names: read_tables(file, names))
    take_own(file, table)
    check_held(file, where or "/", table, [path for path in left if path not in objects])
    return table


def _is_key(name: str, item: Any) -> bool:
    """Whether a variable with the name of a key and a column is the key: one value."""
    return name in KEYS and item.size == 1


def _no_numbers(item: Any) -> tuple[str, str] | None:
    """What of a variable is no plain numbers, and what would do; ``None`` where it is."""
    kind = _class(item)
    if kind in ("cell", "char", "function_handle", "FileWrapper__") or OBJECT in item.attrs:
        return f"a {kind}", "want plain numbers"
    return no_numbers(item)


def _class(item: Any) -> str:
    """MATLAB's own class of a variable, or nothing where another program wrote it."""
    value = item.attrs.get("MATLAB_class", b"")
    return value.decode("ascii", errors="replace") if isinstance(value, bytes) else str(value)


def _value(file: Path, where: str, name: str, item: Any) -> object:
    """A key's value: a scalar, or text, which MATLAB keeps as 16-bit codes."""
    if math.prod(item.shape or (0,)) > KEY_TEXT_LIMIT or item.is_virtual or item.external:
        raise InputFileError(file, where=where, found=f"{name} is an array", wish="want one value")
    value = item[()]
    if item.dtype.kind == "u" and (_class(item) == "char" or (item.dtype == np.uint16 and item.size > 1)):
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
