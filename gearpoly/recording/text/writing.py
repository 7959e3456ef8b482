"""How a text file is written: what a map states of it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Writing:
    """Encoding, separator of cells, decimal mark, what parts thousands, order of dates ("day first"), the lines of
    names and units (from 1), cells that hold no reading, "left out" for torn lines, and the widths of cells that
    touch, as far as a map states them; what is empty or 0 is found from the file."""

    encoding: str = ""
    separator: str = ""
    decimal: str = ""
    thousands: str = ""
    dates: str = ""
    header_line: int = 0
    units_line: int = 0
    missing: tuple[str, ...] = ()
    torn_lines: str = ""
    widths: tuple[int, ...] = ()
