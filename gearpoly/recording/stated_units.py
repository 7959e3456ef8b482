"""What formats state beside the numbers of a column: its unit, and how it was packed.

A column's name says its unit in this package, so a unit that is stated as well has to be the same. Packing follows the
CF conventions 1.11, 8.1 and 2.5.1 (netCDF, HDF5): value = stored ``scale_factor`` + ``add_offset``; ``_FillValue``,
``missing_value`` and the valid range are in stored numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.quantities import COUNT, UNSTATED, column_unit, unit_written

UNIT_NAMES = ("units", "unit", "unit_string")
"""Attributes that hold a unit: netCDF and HDF5, others, TDMS."""

PACKED_NAMES = ("scale_factor", "add_offset", "_FillValue", "missing_value", "valid_min", "valid_max", "valid_range")
"""Attributes that change what numbers mean."""


def check_unit(file: Path, name: str, stated: object) -> None:
    """Raise ``InputFileError`` where the unit that is ``stated`` for column ``name`` is not the one in its name."""
    text = (stated.decode("utf-8", "replace") if isinstance(stated, bytes) else str(stated)).strip()
    unit = text.lower().split(" since ")[0].strip()  # netCDF: seconds since a date
    wanted = column_unit(name)
    if wanted.dimension == COUNT or unit in UNSTATED or unit_written(unit, wanted.dimension) == wanted:
        return
    wish = f"want {wanted.name}, as its name says; convert the values, or take the unit out where it is wrong"
    raise InputFileError(file, where=f"column {name}", found=f'the unit "{shorten(text)}"', wish=wish)


def unpacked(
    file: Path, name: str, values: npt.NDArray[Any], attributes: Mapping[str, npt.NDArray[Any]]
) -> npt.NDArray[Any]:
    """The ``values`` of column ``name`` as meant, by its ``attributes``, of which those of ``PACKED_NAMES`` count."""
    held = {key: _numbers(file, name, key, attributes[key]) for key in PACKED_NAMES if key in attributes}
    if not held or values.dtype.kind not in "iufb":
        return values
    out = values.astype(np.float64)
    for key in ("_FillValue", "missing_value"):
        for stated in held.get(key, ()):
            out[values == stated] = np.nan
    low, high = held.get("valid_range", [-math.inf, math.inf])
    low, high = max(low, *held.get("valid_min", [low])), min(high, *held.get("valid_max", [high]))
    with np.errstate(invalid="ignore"):
        out[(values < low) | (values > high)] = np.nan
    scale, offset = held.get("scale_factor", [1.0])[0], held.get("add_offset", [0.0])[0]
    if scale != 1.0 or offset != 0.0:
        with np.errstate(over="ignore"):  # what becomes infinite is refused by row
            out = out * scale + offset
    return out


def _numbers(file: Path, name: str, key: str, stated: npt.NDArray[Any]) -> list[float]:
    """The numbers of one attribute: two of ``valid_range``, any of ``missing_value``, else one."""
    values = np.atleast_1d(stated).reshape(-1)
    count = {"valid_range": 2, "missing_value": values.size}.get(key, 1)
    good = values.dtype.kind in "iuf" and values.size == count
    if good and key in ("scale_factor", "add_offset"):
        good = bool(np.isfinite(values[0])) and not (key == "scale_factor" and values[0] == 0.0)
    if not good:
        found = f"{key} = {shorten(str(stated))}"
        raise InputFileError(file, where=f"column {name}", found=found, wish="want the number that CF conventions have")
    return [float(value) for value in values]
