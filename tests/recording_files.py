"""One recording written in every format, for the tests of the readers and for the benchmark."""

from __future__ import annotations

import importlib
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Columns = Mapping[str, FloatArray]
Keys = Mapping[str, object]
Writer = Callable[[Path, Columns, Keys], None]


def toml(value: object) -> str:
    return json.dumps(value) if isinstance(value, str) else repr(value)


def write_csv(file: Path, columns: Columns, keys: Keys) -> None:
    head = "".join(f"# {key} = {toml(value)}\n" for key, value in keys.items()) + ",".join(columns) + "\n"
    cells = [map(repr, column.tolist()) for column in columns.values()]  # repr gives every double back exactly
    file.write_text(head + "".join(",".join(row) + "\n" for row in zip(*cells, strict=True)), encoding="utf-8")


def write_parquet(file: Path, columns: Columns, keys: Keys, **options: Any) -> None:
    pa = importlib.import_module("pyarrow")
    parquet = importlib.import_module("pyarrow.parquet")
    table = pa.table({name: pa.array(values) for name, values in columns.items()})
    table = table.replace_schema_metadata({key: toml(value) for key, value in keys.items()})
    parquet.write_table(table, file, **options)


def write_hdf5(file: Path, columns: Columns, keys: Keys, *, group: str = "/", **options: Any) -> None:
    h5py = importlib.import_module("h5py")
    with h5py.File(file, "w") as root:
        holder = root.require_group(group)
        for name, values in columns.items():
            holder.create_dataset(name, data=values, **options)
        holder.attrs.update(keys)


def write_mat5(file: Path, columns: Columns, keys: Keys, *, struct: str = "", packed: bool = True) -> None:
    scipy_io = importlib.import_module("scipy.io")
    held: dict[str, Any] = {name: values[:, None] for name, values in columns.items()}
    held["keys"] = dict(keys)
    scipy_io.savemat(file, {struct: held} if struct else held, do_compression=packed)


def write_mat73(file: Path, columns: Columns, keys: Keys, *, struct: str = "", **options: Any) -> None:
    """MATLAB's own way: a user block of 512 bytes, the classes as attributes, text as 16-bit codes."""
    h5py = importlib.import_module("h5py")
    with h5py.File(file, "w", userblock_size=512) as root:
        holder = root
        if struct:
            holder = root.create_group(struct)
            holder.attrs["MATLAB_class"] = np.bytes_("struct")
        for name, values in columns.items():
            data = holder.create_dataset(name, data=values[None, :], **options)
            data.attrs["MATLAB_class"] = np.bytes_("double")
        stated = holder.create_group("keys")
        stated.attrs["MATLAB_class"] = np.bytes_("struct")
        for key, value in keys.items():
            if isinstance(value, str):
                data = stated.create_dataset(key, data=np.array([[ord(c)] for c in value], dtype=np.uint16))
                data.attrs["MATLAB_class"] = np.bytes_("char")
            else:
                data = stated.create_dataset(key, data=np.array([[float(str(value))]]))
                data.attrs["MATLAB_class"] = np.bytes_("double")
    block = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"
    with file.open("r+b") as stream:
        stream.write(block.ljust(512, b"\0"))


def write_tdms(file: Path, columns: Columns, keys: Keys) -> None:
    nptdms = importlib.import_module("nptdms")
    with nptdms.TdmsWriter(file) as writer:
        channels = [nptdms.ChannelObject("rig", name, values) for name, values in columns.items()]
        writer.write_segment([nptdms.RootObject({}), nptdms.GroupObject("rig", dict(keys)), *channels])


def uff_header(name: str, count: int, keys: Keys, *, binary: bool, single: bool = False, even: bool = False) -> bytes:
    first = (
        f"    58b     1     2          11{count * 8:12d}     0     0           0           0" if binary else "    58"
    )
    ids = [name, "", "NONE", "", ""]
    stated = [f"{key} = {toml(value)}" for key, value in keys.items()]
    ids[1], ids[3], ids[4] = ("; ".join(stated[i::3]) or "NONE" for i in range(3))
    numbers = f"{2 if single else 4:10d}{count:10d}{int(even):10d}{0:13.5e}{0:13.5e}{0:13.5e}"
    axes = [f"{kind:10d}    0    0    0 NONE                 NONE" for kind in (0, 0, 0, 0)]
    dof = "    1         0    0         0       NONE         1   1       NONE         0   0"
    lines = ["    -1", first, *ids, dof, numbers, *axes]
    return "".join(f"{line:<80.80}".rstrip() + "\n" for line in lines).encode()


def write_uff(file: Path, columns: Columns, keys: Keys, *, binary: bool = True) -> None:
    """One data set 58 per column, evenly spaced without a time of its own, in double precision."""
    parts = []
    for i, (name, values) in enumerate(columns.items()):
        parts.append(uff_header(name, values.size, keys if i == 0 else {}, binary=binary, even=True))
        if binary:
            parts.append(values.astype("<f8").tobytes())
        else:
            lines = ("".join(f"{v:20.11e}" for v in values[j : j + 4]) for j in range(0, values.size, 4))
            parts.append("".join(f"{line}\n" for line in lines).encode())
        parts.append(b"    -1\n")
    file.write_bytes(b"".join(parts))
