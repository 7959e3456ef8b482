"""Columns of HDF5 files that are no datasets of their own: those of a matrix, and the fields of a compound dataset.

What the columns of a matrix are called stands in a list of texts with one for each: an attribute of the matrix or of a
group about it, or a dataset beside it; MATLAB has cells and matrices of characters.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from gearpoly.recording.recording import COLUMNS
from gearpoly.recording.stated_units import PACKED_NAMES

COLUMNS_LIMIT = 200
"""Most columns of a matrix; a logger has some dozen channels, a camera's frame a thousand lines."""

ATTRIBUTE_TEXT_LIMIT = 1000
"""Longest list of names in characters that stands in one text, and most texts or numbers of one attribute."""

NAMES_LIST_PATTERN = re.compile(
    r"name|col|chan|label|field|head|var|legend|signal|kan[aä]l|spalte|item|axis", re.IGNORECASE
)
UNITS_LIST_PATTERN = re.compile(r"unit|einheit|unit[eé]|unidad", re.IGNORECASE)
"""What a list of names, and one of units, is called."""

FILTERS = frozenset({1, 2, 3, 4, 5, 6, 32000})
"""Filters that HDF5 and h5py hold themselves: deflate, shuffle, Fletcher 32, szip, n-bit, scale-offset, LZF."""

OBJECT = "MATLAB_object_decode"
"""Attribute of what MATLAB keeps as an object."""


@dataclass(kw_only=True)
class HeldDataset:
    """A matrix or a compound dataset; its values are read once for all of its columns."""

    dataset: Any
    fields: tuple[str, ...] = ()

    @cached_property
    def values(self) -> npt.NDArray[Any]:
        read = self.dataset.fields(list(self.fields)) if self.fields else self.dataset
        return np.asarray(read[()])


@dataclass(kw_only=True)
class Series:
    """One column: number ``at`` along ``axis`` of a matrix, or the field ``at`` of a compound dataset, of which a
    ``part`` where it holds rows of numbers. What is asked of a dataset is answered by the one that it lies in, but for
    shape, type, unit and packing, which are its own."""

    grid: HeldDataset
    at: int | str
    axis: int = 1
    part: int | None = None
    unit: str = ""

    def __getattr__(self, name: str) -> Any:
        return getattr(self.grid.dataset, name)

    @property
    def shape(self) -> tuple[int, ...]:
        whole: tuple[int, ...] = self.grid.dataset.shape
        return whole if isinstance(self.at, str) else (whole[1 - self.axis],)

    @property
    def size(self) -> int:
        return math.prod(self.shape)

    @property
    def dtype(self) -> Any:
        held = self.grid.dataset.dtype
        return held[self.at].base if isinstance(self.at, str) else held

    @property
    def values(self) -> npt.NDArray[Any]:
        if isinstance(self.at, str):
            held = self.grid.values[self.at]
            return np.ascontiguousarray(
                held.reshape(-1) if self.part is None else held.reshape(self.size, -1)[:, self.part]
            )
        return np.ascontiguousarray(np.take(self.grid.values, self.at, axis=self.axis))

    @property
    def packing(self) -> dict[str, npt.NDArray[Any]]:
        """The attributes that change what its numbers mean; of a list with one for each column its own."""
        held: dict[str, npt.NDArray[Any]] = {}
        count = self.grid.dataset.shape[self.axis] if isinstance(self.at, int) else 0
        for key in PACKED_NAMES:
            if key in self.grid.dataset.attrs and few(self.grid.dataset.attrs, key):
                value = np.asarray(self.grid.dataset.attrs[key])
                of_each = isinstance(self.at, int) and value.shape == (count,) and key != "valid_range"
                held[key] = value[self.at] if of_each else value
        return held


def expanded(h5py: Any, root: Any, groups: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """The ``groups`` of datasets by path, with the columns of matrices and the fields of compound datasets in the place
    of these; in a group of their own where another one beside them has the same name."""
    out: dict[str, dict[str, Any]] = {}
    for path, held in groups.items():
        inside = {name: dict(_columns(h5py, root, groups, path, name)) for name in held}
        called = [one for name, columns in inside.items() for one in (columns or [name])]
        out.setdefault(path, {})
        for name, columns in inside.items():
            if not columns:
                out[path][name] = held[name]
            elif all(called.count(one) == 1 for one in columns):
                out[path] |= columns
            else:
                out[f"{path.rstrip('/')}/{name}"] = columns
    return out


def _columns(
    h5py: Any, root: Any, groups: Mapping[str, Mapping[str, Any]], path: str, name: str
) -> Iterator[tuple[str, Series]]:
    """The columns of the dataset ``name`` in the group ``path`` by their names; none of one that is a series itself."""
    dataset = groups[path][name]
    several = isinstance(dataset, h5py.Dataset) and (dataset.dtype.names or len(dataset.shape or ()) == 2)
    if name in COLUMNS or not several or not dataset.size or OBJECT in dataset.attrs or kept_elsewhere(dataset):
        return
    if dataset.dtype.names and dataset.size == max(dataset.shape, default=0):
        fields = {one: dataset.dtype[one].shape for one in dataset.dtype.names if _is_field(dataset.dtype[one])}
        if not 0 < sum(math.prod(shape) for shape in fields.values()) <= COLUMNS_LIMIT:
            return
        grid = HeldDataset(dataset=dataset, fields=tuple(fields))
        units = _listed(h5py, root, groups, path, name, len(dataset.dtype.names), UNITS_LIST_PATTERN)
        for k, field in enumerate(dataset.dtype.names):
            unit = units[k] if units else _of_field(dataset, k)
            if field in fields and not fields[field]:
                yield field, Series(grid=grid, at=field, unit=unit)
            for part in range(fields[field][0] if fields.get(field) else 0):
                yield f"{field} (column {part + 1})", Series(grid=grid, at=field, part=part, unit=unit)
        return
    plain = dataset.dtype.kind in "iufb" and len(dataset.shape) == 2 and min(dataset.shape) > 1
    if not plain:
        return
    # The names say which way columns run; without names there are more readings than columns.
    for axis in (1, 0) if dataset.shape[0] >= dataset.shape[1] else (0, 1):
        count = dataset.shape[axis]
        if count > COLUMNS_LIMIT or dataset.shape[0] == dataset.shape[1]:
            continue
        names = _listed(h5py, root, groups, path, name, count, NAMES_LIST_PATTERN)
        if len(set(names)) == count:
            units = _listed(h5py, root, groups, path, name, count, UNITS_LIST_PATTERN)
            grid = HeldDataset(dataset=dataset)
            for k, called in enumerate(names):
                yield called, Series(grid=grid, at=k, axis=axis, unit=units[k] if units else "")
            return
    axis = int(np.argmin(dataset.shape))
    if dataset.shape[axis] <= COLUMNS_LIMIT and dataset.shape[0] != dataset.shape[1]:
        grid = HeldDataset(dataset=dataset)
        for k in range(dataset.shape[axis]):
            yield f"{name} (column {k + 1})", Series(grid=grid, at=k, axis=axis)


def _is_field(kind: Any) -> bool:
    """Whether a field of a compound type holds a number, or a row of them."""
    return kind.base.kind in "iufb" and len(kind.shape) < 2


def _of_field(dataset: Any, k: int) -> str:
    """The unit of a field in an attribute of its own, as PyTables and others number them."""
    held = dataset.attrs
    return next((text_of(held[key]) for key in (f"FIELD_{k}_UNIT", f"FIELD_{k}UNITS") if key in held), "")


def _listed(
    h5py: Any,
    root: Any,
    groups: Mapping[str, Mapping[str, Any]],
    path: str,
    name: str,
    count: int,
    called: re.Pattern[str],
) -> list[str]:
    """The ``count`` texts that stand nearest to a dataset under a name such as ``called`` has; none where there are no
    such."""
    places = [path, *above(path)]
    if found := _of_attributes(groups[path][name].attrs, count, called):
        return found
    for place in places:
        beside = {
            other: texts
            for other, one in groups.get(place, {}).items()
            if called.search(other) and isinstance(one, h5py.Dataset) and not kept_elsewhere(one)
            if (texts := texts_of(h5py, root, one, count))
        }
        if beside:
            # data_names belongs to data, block0_items to block0_values.
            return max(beside.items(), key=lambda one: (alike(one[0], name), "name" in one[0].lower()))[1]
        if place in root and (found := _of_attributes(root[place].attrs, count, called)):
            return found
    return []


def above(path: str) -> Iterator[str]:
    """The groups in which the one of that path lies, the nearest first."""
    while path != "/":
        path = path.rpartition("/")[0] or "/"
        yield path


def alike(one: str, other: str) -> int:
    """How many letters two names begin with alike."""
    return next((k for k, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), min(len(one), len(other)))


def _of_attributes(attributes: Any, count: int, called: re.Pattern[str]) -> list[str]:
    """The ``count`` texts in one of some ``attributes``: a list, or one text parted by tabs, commas and such."""
    for key in attributes:
        if not called.search(key) or not few(attributes, key):
            continue
        value = attributes[key]
        if isinstance(value, np.ndarray) and value.size == count and value.dtype.kind in "OSU":
            return [text_of(one) for one in value.reshape(-1)]
        if isinstance(value, str | bytes) and len(value) <= ATTRIBUTE_TEXT_LIMIT:
            for mark in "\t;|\n,":
                parts = [one.strip() for one in text_of(value).split(mark)]
                if len(parts) == count:
                    return parts
    return []


def texts_of(h5py: Any, root: Any, dataset: Any, count: int) -> list[str]:
    """The ``count`` texts in a dataset: of texts, a cell of MATLAB's, or a matrix of characters; none in any other."""
    if h5py.check_ref_dtype(dataset.dtype) is not None and dataset.size == count <= ATTRIBUTE_TEXT_LIMIT:
        held = [root[one] if one else None for one in dataset[()].reshape(-1)]
        return [_characters(one) for one in held] if all(_is_text(h5py, one) for one in held) else []
    if h5py.check_string_dtype(dataset.dtype) is not None and dataset.size == count <= ATTRIBUTE_TEXT_LIMIT:
        return [text_of(one) for one in np.asarray(dataset[()]).reshape(-1)]
    if (
        _is_char(dataset)
        and len(dataset.shape) == 2
        and dataset.shape[1] == count
        and dataset.size <= ATTRIBUTE_TEXT_LIMIT
    ):
        return ["".join(chr(c) for c in row).strip(" \0") for row in dataset[()].T]
    return []


def _is_char(dataset: Any) -> bool:
    return text_of(dataset.attrs.get("MATLAB_class", "")) == "char" and dataset.dtype.kind == "u"


def _is_text(h5py: Any, one: Any) -> bool:
    """Whether what a cell refers to is a text of a line."""
    if not isinstance(one, h5py.Dataset) or one.size > ATTRIBUTE_TEXT_LIMIT or kept_elsewhere(one):
        return False
    return _is_char(one) and one.size == max(one.shape, default=0)


def _characters(one: Any) -> str:
    return "".join(chr(int(c)) for c in one[()].reshape(-1)).strip(" \0")


def one_text(dataset: Any) -> str:
    """The text that a dataset holds, of MATLAB's characters or of one text; nothing where it holds something else."""
    if dataset.shape is None or dataset.size > ATTRIBUTE_TEXT_LIMIT:
        return ""
    if _is_char(dataset):
        return _characters(dataset) if dataset.size == max(dataset.shape, default=0) else ""
    if dataset.size == 1 and dataset.dtype.kind in "OS":
        value = np.asarray(dataset[()]).reshape(-1)[0]
        return text_of(value) if isinstance(value, str | bytes) else ""
    return ""


def few(attributes: Any, key: str) -> bool:
    return math.prod(attributes.get_id(key).shape or (1,)) <= ATTRIBUTE_TEXT_LIMIT


def text_of(value: object) -> str:
    return (value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)).strip(" \0")


def kept_elsewhere(dataset: Any) -> tuple[str, str] | None:
    """Why the values of a dataset cannot be read from this file, and what would do; ``None`` where they can."""
    if dataset.is_virtual or dataset.external:
        return "numbers kept in another file", "want the numbers in the file itself"
    if dataset.size and not dataset.id.get_storage_size():
        wish = "want the values in the file; close it where it is written, and copy it then"
        return f"{dataset.size} values stated, and none there", wish
    layout = dataset.id.get_create_plist()
    for i in range(layout.get_nfilters()):
        if layout.get_filter(i)[0] not in FILTERS:
            return f"compression by filter {layout.get_filter(i)[0]}", "want gzip, LZF or no compression"
    return None
