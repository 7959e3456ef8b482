"""Recordings of the same columns one below the other, parted by no line of names: their time begins again.

An angle that falls back has gone round, and one row that falls back is a bad one. Only the column that is a time by its
name tells, where it falls back to about its first value and rises again from there.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from gearpoly.recording.header import header_unit
from gearpoly.recording.quantities import TIME
from gearpoly.recording.text.cells import is_number
from gearpoly.recording.text.cut import split
from gearpoly.recording.text.lines import TextLines
from gearpoly.recording.text.missing import holds_cells
from gearpoly.recording.text.stamps import is_stamp
from gearpoly.recording.words import quantity_of

SAMPLED = 4096
"""Rows that are looked at for a time that falls back, some of all: a recording is at least so small a part of a file
in which a hundred may be."""

RISING = 8
"""Rows from which a time that begins again is told: so many rise, before it and from it on."""

RESTART_OFF_PART = 0.01
"""Part of the earlier recording's length by which the later one may begin elsewhere, two steps at least."""

CLOCK_PERIODS = (1.0, 60.0, 1e3, 3600.0, 6e4, 86_400.0, 1e6, 2.0**16, 2.0**32)
"""What clocks themselves begin again at: seconds, minutes, hours and days in s or ms, and widths of counters."""

ON = 3.0
"""Largest steps of the rows before by which a reading may be off the one before, where a shaft only turned on."""


def restarts(lines: TextLines, separator: str, names: Sequence[str], rows: tuple[int, int]) -> list[int]:
    """The ``rows`` (first, end; from 0) at which a time begins again among the columns of these ``names``."""
    first, end = rows
    column = _time(lines, separator, names, first)
    if column is None:
        return []
    found, begin = [], first
    held = [(row, _value(lines, separator, column, row)) for row in _some(first, end)]
    known = [(row, value) for row, value in held if value is not None]
    for (low, before), (high, after) in itertools.pairwise(known):
        if after >= before:
            continue
        while high - low > 1:
            middle = (low + high) // 2
            value = _value(lines, separator, column, middle)
            if value is None or value >= before:  # a blank line stands below the rows above it
                low = middle
            else:
                high = middle
        if begins_again(lines, separator, names, (begin, high), (high, end)):
            found.append(high)
            begin = high
    return found


def begins_again(
    lines: TextLines, separator: str, names: Sequence[str], above: tuple[int, int], below: tuple[int, int]
) -> bool:
    """Whether the time of the rows ``below`` (first, end; from 0) begins about where that of the rows ``above`` did,
    and is no clock that went round while the shafts turned on."""
    column = _time(lines, separator, names, above[0])
    if column is None:
        return False
    earlier = [row for row in range(max(above[0], above[1] - 2 * RISING), above[1]) if holds_cells(lines[row])][
        -RISING:
    ]
    later = [row for row in range(below[0], min(below[1], below[0] + 2 * RISING)) if holds_cells(lines[row])][:RISING]
    if min(len(earlier), len(later)) < RISING:
        return False
    texts = [_value(lines, separator, column, row) for row in (above[0], *earlier, *later)]
    values = np.array([np.nan if one is None else one for one in texts])
    start, old, new = float(values[0]), values[1 : 1 + RISING], values[1 + RISING :]
    if not (np.all(np.diff(old) > 0.0) and np.all(np.diff(new) > 0.0) and new[-1] < old[-1]):
        return False
    step = float(np.median(np.diff(old)))
    if abs(new[0] - start) > max(2.0 * step, RESTART_OFF_PART * (float(old[-1]) - start)):
        return False
    gone = float(old[-1] - new[0]) + step
    around = any(abs(gone - one) <= 2.0 * step for one in CLOCK_PERIODS)
    return not (around and _turn_on(lines, separator, column, earlier, later[0]))


def _turn_on(lines: TextLines, separator: str, time: int, earlier: Sequence[int], row: int) -> bool:
    """Whether all columns but the ``time`` go on in a ``row`` from the ``earlier`` ones by steps as theirs."""
    table = np.array([[np.nan if (one := _number(cell)) is None else one for cell in split(lines[k], separator)]
                      for k in (*earlier, row)])  # fmt: skip
    steps = np.abs(np.diff(np.delete(table, time, axis=1), axis=0))
    return bool(np.all(steps[-1] <= ON * np.max(steps[:-1], axis=0)))


def _some(first: int, end: int) -> list[int]:
    """Rows from ``first`` to before ``end``, all of few."""
    return [int(row) for row in np.unique(np.linspace(first, end - 1, min(SAMPLED, end - first)).astype(np.int64))]


def _time(lines: TextLines, separator: str, names: Sequence[str], row: int) -> int | None:
    """The column of numbers that is a time by its name; none beside stamps, which say themselves when it was."""
    cells = split(lines[row], separator)
    if len(cells) != len(names) or any(is_stamp(cell) and not is_number(cell) for cell in cells):
        return None
    return next((k for k, name in enumerate(names) if quantity_of(header_unit(name)[0]) == TIME), None)


def _value(lines: TextLines, separator: str, column: int, row: int) -> float | None:
    """The number in a ``column`` of a ``row``, or ``None``."""
    cells = split(lines[row], separator)
    return _number(cells[column]) if column < len(cells) else None


def _number(cell: str) -> float | None:
    """The number in a ``cell`` with a decimal mark of either kind, or ``None``."""
    last = max(cell.rfind(","), cell.rfind("."))
    whole, part = (cell[:last], cell[last + 1 :]) if last >= 0 else (cell, "")
    try:
        if last < 0:
            return float(cell)
        return float(f"{whole.replace(',', '').replace('.', '')}.{part}")
    except ValueError:
        return None
