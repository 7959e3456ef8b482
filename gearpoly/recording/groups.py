"""Where in a file of groups within groups (HDF5, structs of MATLAB, TDMS) the columns of a recording lie."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path

from gearpoly.recording.reader import check_finite
from gearpoly.recording.recording import COLUMNS
from gearpoly.recording.stated_units import check_unit
from gearpoly.recording.table import Table


def own_group(groups: Mapping[str, Collection[str]]) -> str | None:
    """The path of the one group, of ``groups`` with the names of their channels, that has columns under the contract's
    names; ``None`` where none has, or several have, so that all channels are called by their paths."""
    holding = [path for path, names in groups.items() if any(name in COLUMNS for name in names)]
    return holding[0] if len(holding) == 1 else None


def take_own(file: Path, table: Table) -> None:
    """Let channels of ``table`` be its columns, where it has none and one group holds them under the contract's names.

    Raises ``InputFileError`` where a column states another unit than its name, or holds an infinite number.
    """
    groups: dict[str, list[str]] = {}
    for path, one in table.others.items():
        groups.setdefault(one.group(path), []).append(one.leaf)
    where = own_group(groups)
    if table.columns or where is None:
        return
    for path, one in list(table.others.items()):
        if one.group(path) == where and one.leaf in COLUMNS:
            check_unit(file, one.leaf, one.unit)
            check_finite(file, one.leaf, one.values)
            table.columns[one.leaf] = table.others.pop(path).values
            table.paths[path] = one.leaf
