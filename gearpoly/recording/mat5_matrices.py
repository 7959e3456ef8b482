"""Columns of matrices in MAT 5 files: numbers in one variable, names and units of their columns in a cell or a matrix
of characters beside it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from gearpoly.recording.hdf5_columns import COLUMNS_LIMIT, NAMES_LIST_PATTERN, UNITS_LIST_PATTERN, alike
from gearpoly.recording.mat5_layout import (
    MAT5_CELL_CLASS,
    MAT5_CHAR_CLASS,
    NUMERIC_CLASSES,
    Array,
    cells_of,
    rows_of_text,
)
from gearpoly.recording.recording import COLUMNS

Groups = Mapping[str, Mapping[str, Array]]
Whole = Callable[[Array], Array]
"""What unpacks a variable of which only the head was unpacked so far."""


@dataclass(frozen=True, kw_only=True)
class MatrixColumn:
    """Column number ``at`` along ``axis`` of a ``matrix``, its ``unit``, and how many readings it has."""

    matrix: Array
    at: int
    axis: int
    unit: str = ""

    @property
    def size(self) -> int:
        """Number of readings."""
        return self.matrix.shape[1 - self.axis]

    def of(self, numbers: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Its readings (n,) among the ``numbers`` of the matrix."""
        return np.asarray(np.take(numbers, self.at, axis=self.axis))


def matrix_columns(groups: Groups, whole: Whole) -> Iterator[tuple[str, str, str, MatrixColumn]]:
    """Group, own name, path and column of every matrix in the ``groups`` of arrays by path; the name of the matrix is
    part of the path where columns of two in one group are called alike."""
    for place, held in groups.items():
        found = {name: list(_columns(groups, place, name, whole)) for name in held}
        called = [one for name, columns in found.items() for one in ([c for c, _ in columns] or [name])]
        for name, columns in found.items():
            alone = all(called.count(one) == 1 for one, _ in columns)
            group = place if alone else ".".join(filter(None, (place, name)))
            for one, column in columns:
                yield group, one, f"{group}.{one}" if group else one, column


def _columns(groups: Groups, place: str, name: str, whole: Whole) -> Iterator[tuple[str, MatrixColumn]]:
    array = groups[place][name]
    shape = array.shape
    plain = array.kind in NUMERIC_CLASSES and not array.is_complex and len(shape) == 2 and min(shape) > 1
    if name in COLUMNS or not plain or shape[0] == shape[1]:
        return
    for axis in (1, 0) if shape[0] > shape[1] else (0, 1):
        if shape[axis] > COLUMNS_LIMIT:
            continue
        names = _listed(groups, place, name, shape[axis], NAMES_LIST_PATTERN, whole)
        if len(set(names)) == shape[axis]:
            units = _listed(groups, place, name, shape[axis], UNITS_LIST_PATTERN, whole) or [""] * shape[axis]
            for k, (called, unit) in enumerate(zip(names, units, strict=True)):
                yield called, MatrixColumn(matrix=array, at=k, axis=axis, unit=unit)
            return
    axis = int(np.argmin(shape))
    for k in range(shape[axis] if shape[axis] <= COLUMNS_LIMIT else 0):
        yield f"{name} (column {k + 1})", MatrixColumn(matrix=array, at=k, axis=axis)


def _listed(groups: Groups, place: str, name: str, count: int, called: re.Pattern[str], whole: Whole) -> list[str]:
    """The ``count`` texts that stand nearest to a matrix under a name such as ``called`` has; none where there are no
    such."""
    while True:
        beside = {
            other: texts
            for other, one in groups.get(place, {}).items()
            if called.search(other) and one.kind in (MAT5_CELL_CLASS, MAT5_CHAR_CLASS) and count in one.shape
            if len(texts := _texts(whole(one))) == count
        }
        if beside or not place:
            return max(
                beside.items(), key=lambda one: (alike(one[0], name), "name" in one[0].lower()), default=("", [])
            )[1]
        place = place.rpartition(".")[0]


def _texts(array: Array) -> list[str]:
    """The texts of a cell, or the rows of a matrix of characters; none where a cell holds anything else."""
    if array.kind == MAT5_CHAR_CLASS:
        return rows_of_text(array)
    held = [rows_of_text(one) if one.kind == MAT5_CHAR_CLASS else [] for one in cells_of(array)]
    return [one[0] for one in held] if all(len(one) == 1 for one in held) else []
