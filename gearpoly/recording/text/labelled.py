"""Rows that name their numbers: ``t:0.1,in:17.3`` as serial plotters want it, or ``17.3 deg``."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.text.cut import split
from gearpoly.recording.text.layout import CELLS_LIMIT, SEPARATOR_NAMES
from gearpoly.recording.text.stamps import is_stamp

LEAST_LABELLED_ROWS = 8
"""Rows from which numbers with the same labels and units are a table; a head may state a few settings so."""

_CELL = re.compile(
    r"(?:([^\W\d]\w{0,30}(?: \w{1,20})?)\s*[=:]\s*)?"  # a label
    r"([+\-\u2212]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?)"
    r"\s*([^\s\d.,;:|=+-][^\s,;:|=]{0,9})?"  # a unit
)

Labels = tuple[tuple[str, str], ...]
"""Label and unit of each column."""


@dataclass(frozen=True, kw_only=True)
class Labelled:
    """What parts the cells of rows that have the same ``labels``."""

    separator: str
    labels: Labels


def find_labels(sample: Sequence[str], separators: Sequence[str] = tuple(SEPARATOR_NAMES)) -> Labelled | None:
    """The labels that most lines of a ``sample`` have; ``None`` where their numbers have none."""
    best: tuple[int, Labelled] | None = None
    for separator in separators:
        seen = Counter(found[0] for line in sample if (found := _parts(line, separator)) is not None)
        if not seen:
            continue
        labels, count = seen.most_common(1)[0]
        if count >= LEAST_LABELLED_ROWS and 2 * count > len(sample) and (best is None or count > best[0]):
            best = count, Labelled(separator=separator, labels=labels)
    return None if best is None else best[1]


def without_labels(file: Path, lines: Sequence[str], found: Labelled) -> list[str]:
    """The lines with numbers alone in those that have the labels.

    Raises ``InputFileError`` with the line where numbers have others: their unit may be another one.
    """
    out = []
    for number, line in enumerate(lines, start=1):
        parts = _parts(line, found.separator)
        if parts is not None and parts[0] != found.labels:
            like = found.separator.join(f"{label} 0 {unit}".strip() for label, unit in found.labels)
            wish = f"want labels and units as in the other rows, `{shorten(like)}`; delete the line if it is no row"
            raise InputFileError(file, where=f"line {number}", found=f"`{shorten(line.strip())}`", wish=wish)
        out.append(line if parts is None else found.separator.join(parts[1]))
    return out


def _parts(line: str, separator: str) -> tuple[Labels, list[str]] | None:
    """The labels and units of a line's cells, and their numbers; ``None`` where a cell is none of the kind, or none has
    a label or a unit."""
    if not 0 < line.count(separator) < CELLS_LIMIT:
        return None
    labels, numbers = [], []
    for cell in split(line.strip().rstrip(separator), separator):
        held = _CELL.fullmatch(cell)
        if held is None and is_stamp(cell):
            labels.append(("", ""))
            numbers.append(cell)
            continue
        if held is None:
            return None
        labels.append(((held[1] or "").strip(), held[3] or ""))
        numbers.append(held[2])
    return (tuple(labels), numbers) if len(numbers) > 1 and any(map(any, labels)) else None
