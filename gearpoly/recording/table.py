"""What a reader finds in a file: columns, keys and remarks, before anyone judges them."""

from __future__ import annotations

from dataclasses import dataclass, field

from gearpoly.units import FloatArray

AXIS_ERROR, AXIS_CORRECTION = "axis_error_arcsec", "axis_correction_arcsec"
"""Columns of a guide log: error of a telescope's axis, positive where it is ahead, and what pulses may have turned it
by. Only the pair file knows the worm between that axis and the pair."""


@dataclass
class Table:
    """What a reader found: columns (n,) and keys under the contract's names, and remarks for the user."""

    columns: dict[str, FloatArray]
    keys: dict[str, object]
    remarks: list[str] = field(default_factory=list)
