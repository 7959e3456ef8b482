"""What a reader finds in a file: columns, keys and remarks, before anyone judges them."""

from __future__ import annotations

from dataclasses import dataclass, field

from gearpoly.units import FloatArray


@dataclass
class Table:
    """What a reader found: columns (n,) and keys under the contract's names, and remarks for the user."""

    columns: dict[str, FloatArray]
    keys: dict[str, object]
    remarks: list[str] = field(default_factory=list)
