"""Rows of a text that hold more than numbers, rewritten as rows of numbers: columns of words are emptied, labels
and units are taken from numbers, degrees with minutes and seconds become decimal degrees, and torn lines are blanked
where a map says so.

Lines keep their numbers, and columns theirs.
"""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from gearpoly.files.traces import shorten
from gearpoly.recording.quantities import ANGLE
from gearpoly.recording.table import OF_WORDS, Table
from gearpoly.recording.text.cells import is_missing, is_number
from gearpoly.recording.text.cut import is_data, split
from gearpoly.recording.text.labelled import Labels, find_labels, without_labels
from gearpoly.recording.text.layout import CELLS_LIMIT, SEPARATOR_NAMES, SEPARATOR_SAMPLE_LINES, RecordingLines
from gearpoly.recording.text.lines import TextLines
from gearpoly.recording.text.missing import holds_cells
from gearpoly.recording.text.stamps import is_stamp
from gearpoly.recording.words import quantity_of
from gearpoly.units import TURN_DEG

LEAST_WORD_COLUMN_ROWS = 8
"""Rows from which words among numbers are a column; a head may hold a name beside a number in fewer lines."""

HEAD_ROWS_ADDED = 2
"""Rows that words must add to those without: one or two may begin a head, and columns without words need no change."""

_LETTER = re.compile(r"[^\W\d_eE]|[%\u2030]")
"""A letter or sign that no number holds."""

_SECONDS = r"(?P<s>\d{1,2}(?:[.,]\d+)?)\s*(?:\u2033|\u201d|''|\"\"|\")"
_DMS = re.compile(
    rf"(?P<sign>[+\-\u2212]?)(?P<d>\d{{1,4}})\s*[°º]\s*(?P<m>\d{{1,2}}(?:[.,]\d+)?)\s*['\u2032\u2019](?:\s*{_SECONDS})?"
)
"""Degrees, minutes, and seconds where minutes are whole; a quote in a quoted cell is doubled."""

_COLONS = re.compile(r"(?P<sign>[+\-\u2212]?)(?P<d>\d{1,3}):(?P<m>[0-5]\d):(?P<s>[0-5]\d(?:[.,]\d+)?|60(?:[.,]0+)?)")
"""The same with colons, as a time of day may stand too; some round seconds up to 60."""

DAY_H = 24
"""Hours that no time of day reaches."""


@dataclass(frozen=True, kw_only=True)
class Rewritten:
    """The ``lines`` as they are read on; columns (from 0) of ``words``, by the first of them, and those that were in
    ``degrees`` with minutes; label and unit that each number of a row had beside it."""

    lines: TextLines
    labels: Labels = ()
    words: dict[int, str] = field(default_factory=dict)
    degrees: frozenset[int] = frozenset()


def rewritten(file: Path, lines: TextLines, *, separator: str = "") -> Rewritten:
    """The ``lines`` of a text whose rows hold words or degrees with minutes, made rows of numbers; as they are where
    there is nothing of the kind. ``separator`` is that of a map.

    Raises ``InputFileError`` where a row has labels or units of its own.
    """
    sample = lines[:SEPARATOR_SAMPLE_LINES]
    degrees: frozenset[int] = frozenset()
    if any(_DMS.search(line) for line in sample[-LEAST_WORD_COLUMN_ROWS:]):
        mark = separator or _likely(sample)
        last = next(line for line in reversed(sample) if line.strip())
        degrees = frozenset(k for k, cell in enumerate(split(last, mark)) if _DMS.fullmatch(cell))
        lines = TextLines(_DMS.sub(_decimal, lines.joined(0, len(lines))).encode("utf-8"), "utf-8")
        sample = lines[:SEPARATOR_SAMPLE_LINES]
    elif any(_COLONS.search(line) for line in sample[-LEAST_WORD_COLUMN_ROWS:]):
        mark = separator or _likely(sample)
        heads = [split(line, mark) for line in sample if not _COLONS.search(line)]
        degrees = _of_degrees(
            [split(line, mark) for line in (*sample[-LEAST_WORD_COLUMN_ROWS:], *lines[-SEPARATOR_SAMPLE_LINES:])], heads
        )
        if degrees:
            lines = TextLines("\n".join(_with_degrees(lines, mark, degrees)).encode("utf-8"), "utf-8")
            sample = lines[:SEPARATOR_SAMPLE_LINES]
    if sum(map(bool, map(_LETTER.search, sample))) <= HEAD_ROWS_ADDED:
        return Rewritten(lines=lines, degrees=degrees)
    plain = {one: _plain_rows(sample, one) for one in ([separator] if separator else SEPARATOR_NAMES)}
    named = None if 2 * max(plain.values()) > len(sample) else find_labels(sample, list(plain))
    if named is not None:
        lines = TextLines("\n".join(without_labels(file, list(lines), named)).encode("utf-8"), "utf-8")
        return Rewritten(lines=lines, labels=named.labels, degrees=degrees)
    # Where most lines are rows of one separator it is that one, and words could only be pieces of numbers by another.
    ways = [one for one in plain if 2 * plain[one] > len(sample)] or list(plain)
    mark, words, count = max((words_of(sample, one) for one in ways), key=lambda one: one[2])
    if count <= max(plain.values()) + HEAD_ROWS_ADDED:
        words = {}
    if words:
        lines = _without_words(lines, mark, words)
    return Rewritten(lines=lines, words=words, degrees=degrees)


def say_rewritten(table: Table, block: RecordingLines, beside: Rewritten) -> None:
    """Take columns of words out of a ``table``, give those of degrees and minutes their unit, and say so."""
    for k, word in beside.words.items():
        name = block.names[k] if k < len(block.names) else ""
        if name in table.others and not np.isfinite(table.others[name].values).any():
            del table.others[name]
            words = f'"{shorten(name)}" holds words, such as "{shorten(word)}"'
            table.remarks.append(f"{words}: not read")
            table.unread = (f"{words}, a column {OF_WORDS}", "want numbers in the columns that are to be read")
    for k, (label, unit) in enumerate(beside.labels):
        name = block.names[k] if k < len(block.names) else ""
        if name not in table.others:
            continue
        called = label if label and not block.stated[k] and label not in table.others else name
        one = replace(table.others[name], unit=table.others[name].unit or unit)
        table.others = {called if key == name else key: held for key, held in (table.others | {name: one}).items()}
    if beside.labels:
        table.remarks.append("labels and units stand beside the numbers of each row")
    for k in sorted(beside.degrees):
        name = block.names[k] if k < len(block.names) else ""
        if name in table.others:
            table.others[name] = replace(table.others[name], unit="deg")
            table.remarks.append(f'"{shorten(name)}": degrees with minutes, taken as decimal degrees')


def _of_degrees(rows: Sequence[Sequence[str]], heads: Sequence[Sequence[str]]) -> frozenset[int]:
    """Columns (from 0) of which most cells are degrees, minutes and seconds parted by colons, where ``heads`` name
    an angle or not all may be times of day: three digits, a sign, or more than a day has hours, but below a turn."""
    out = set()
    held = [row for row in rows if any(map(_COLONS.fullmatch, row))]
    for k in range(max(map(len, held), default=0)):
        cells = [row[k] for row in held if k < len(row) and row[k]]
        found = [one for one in map(_COLONS.fullmatch, cells) if one is not None]
        if 2 * len(found) <= len(cells) or any(int(one["d"]) >= TURN_DEG for one in found):
            continue
        named = any(k < len(head) and quantity_of(head[k]) == ANGLE for head in heads)
        if named or any(one["sign"] or len(one["d"]) > 2 or int(one["d"]) >= DAY_H for one in found):
            out.add(k)
    return frozenset(out)


def _with_degrees(lines: TextLines, separator: str, degrees: frozenset[int]) -> Iterator[str]:
    """The lines with the cells of these columns in decimal degrees."""
    for line in lines:
        if ":" in line:
            cells = list(split(line, separator))
            # A bad cell stays as it is, and is told where it stands.
            found = {k: one for k in degrees if k < len(cells) and (one := _COLONS.fullmatch(cells[k])) is not None}
            for k, one in found.items():
                cells[k] = _decimal(one)
            if found:
                line = separator.join(_one(cell, separator) for cell in cells)
        yield line


def _plain_rows(sample: Sequence[str], separator: str) -> int:
    """How many lines are rows of the width that most rows have."""
    widths = Counter(len(split(line, separator)) for line in sample if _is_row(line, separator))
    return max(widths.values(), default=0)


def _likely(sample: Sequence[str]) -> str:
    """What parts the cells of the last line, by how evenly it stands in all."""
    counts = {
        mark: Counter(line.count(mark) for line in sample if mark in line) for mark in SEPARATOR_NAMES if mark != " "
    }
    often = {mark: count.most_common(1)[0][1] for mark, count in counts.items() if count}
    return max(often, key=lambda mark: often[mark], default=" ")


def _decimal(found: re.Match[str]) -> str:
    """The same angle in decimal degrees, with the decimal mark that it has, to a millionth of its last place."""
    minutes, seconds = found["m"], found["s"] or "0"
    mark = "," if "," in minutes + seconds else "."
    value = int(found["d"]) + float(minutes.replace(",", ".")) / 60.0 + float(seconds.replace(",", ".")) / 3600.0
    digits = 4 + max(len(part.partition(mark)[2]) for part in (minutes, seconds)) + 2 * (found["s"] is not None)
    return f"{found['sign']}{value:.{digits}f}".replace(".", mark)


def words_of(sample: Sequence[str], separator: str) -> tuple[str, dict[int, str], int]:
    """The ``separator``, the columns of words that rows parted by it have, by their first word, and how many rows there
    are beside them (0 where no column is of words)."""
    nothing: tuple[str, dict[int, str], int] = (separator, {}, 0)
    widths = Counter(len(split(line, separator)) - 1 for line in sample if 1 < line.count(separator) < CELLS_LIMIT)
    width, often = widths.most_common(1)[0] if widths else (0, 0)
    if width < 2 or often < LEAST_WORD_COLUMN_ROWS:
        return nothing
    rows = [cells for line in sample if len(cells := split(line, separator)) == width + 1]
    read = [[is_number(cell) or is_stamp(cell) for cell in cells] for cells in rows]
    kept = [(cells, good) for cells, good in zip(rows, read, strict=True) if sum(good) >= 2]
    words: dict[int, str] = {}
    for k in range(width + 1):
        at = [j for j, (cells, good) in enumerate(kept) if not good[k] and not is_missing(cells[k])]
        numbers = sum(good[k] for _, good in kept)
        few = (
            not numbers and bool(at) and at[-1] > len(at) + LEAST_WORD_COLUMN_ROWS
        )  # a message now and then, not a head
        if few or len(at) >= max(numbers, LEAST_WORD_COLUMN_ROWS):
            words[k] = kept[at[0]][0][k]
    held = [[cell for k, cell in enumerate(cells) if k not in words] for cells, _ in kept]
    return (separator, words, sum(map(is_data, held))) if words else nothing


def _without_words(lines: TextLines, separator: str, words: dict[int, str]) -> TextLines:
    """The lines with the cells of the columns of ``words`` emptied in every row."""
    out = []
    for line in lines:
        cells = split(line, separator) if separator in line else []
        rest = [cell for k, cell in enumerate(cells) if k not in words]
        read = sum(is_number(cell) or is_stamp(cell) for cell in rest)
        if len(rest) == len(cells) - len(words) and read > 1:  # one bad cell is told where it stands
            empty = "nan" if separator == " " else ""
            line = separator.join(empty if k in words else _one(cell, separator) for k, cell in enumerate(cells))
        out.append(line)
    return TextLines("\n".join(out).encode("utf-8"), "utf-8")


def _one(cell: str, separator: str) -> str:
    """A cell as it stands in a row."""
    return f'"{cell}"' if separator in cell else cell


def without_torn(lines: TextLines, separator: str) -> tuple[TextLines, int]:
    """The lines with those blanked that stand among rows and are none, nor names; and how many they are."""
    held = list(lines)
    width = Counter(len(split(line, separator)) for line in held[:SEPARATOR_SAMPLE_LINES] if _is_row(line, separator))
    wide = width.most_common(1)[0][0] if width else 0
    good = [k for k, line in enumerate(held) if _is_row(line, separator) and len(split(line, separator)) == wide]
    count = 0
    for before, after in itertools.pairwise(good):
        for k in range(before + 1, after):
            cells = split(held[k], separator)
            named = len(cells) == wide and not any(is_number(cell) for cell in cells)
            if holds_cells(held[k]) and not named:
                held[k], count = "", count + 1
    return TextLines("\n".join(held).encode("utf-8"), "utf-8"), count


def _is_row(line: str, separator: str) -> bool:
    cells = split(line, separator) if separator in line else []
    return len(cells) > 1 and is_data(cells)
