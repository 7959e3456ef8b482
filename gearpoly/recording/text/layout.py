"""Where the numbers stand in a text file: what parts its cells, where each recording begins, which lines name columns.

A line is data where each of its cells is a number, a time stamp or a word for nothing read. The separator is the one
that makes the longest run of data lines of one width; what stands above such a run are names, units and remarks.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.traces import shorten
from gearpoly.recording.table import told_apart
from gearpoly.recording.text.cells import is_number
from gearpoly.recording.text.cut import is_data, part_read, split
from gearpoly.recording.text.headings import bare, completed, heading, words_of_line
from gearpoly.recording.text.lines import LINES_AT_ONCE, TextLines, are_rows
from gearpoly.recording.text.missing import closes, holds_cells, no_reading
from gearpoly.recording.text.restarts import begins_again, restarts
from gearpoly.recording.text.stamps import is_stamp

SEPARATOR_NAMES = {"\t": "tabs", ";": "semicolons", "|": "bars", ",": "commas", " ": "blanks"}
"""What parts cells, the surest first: where two part a file alike, the first was meant."""

SEPARATOR_SAMPLE_LINES = 2000
"""Lines that are looked at for the separator; the longest head of a logger seen has some hundred."""

LEAST_RECORDING_ROWS = 8
"""Rows from which a table is a recording where another one of the file has as many; fewer are a logger's settings."""

FIRST_LINES = 64
"""Lines of a file that are looked at one by one before those below are told at once; most heads are shorter."""

SECTIONS_LIMIT = 100
"""Most recordings in a file."""

CELLS_LIMIT = 2000
"""Most columns."""


@dataclass(frozen=True, kw_only=True)
class RecordingLines:
    """One recording in a file: the ``names`` and stated ``units`` of its columns, and the numbers of its lines.

    ``names`` are told apart by numbers where the header (``stated``, empty where there is none) has one twice.
    ``header`` is the line of the names, 0 where there is none, ``head`` the lines of remarks above it; ``rows`` (first,
    last + 1) bound its lines, blank ones among them. Lines count from 1.
    """

    names: tuple[str, ...]
    stated: tuple[str, ...]
    units: tuple[str, ...]
    header: int
    head: tuple[int, int]
    rows: tuple[int, int]


def find_separator(file: Path, lines: Sequence[str]) -> str:
    """The separator that makes the longest run of rows of one width in the first lines with rows.

    Raises ``InputFileError`` where none makes a row of two columns.
    """
    best, longest = "", 0
    sample = lines[:SEPARATOR_SAMPLE_LINES]
    for separator in SEPARATOR_NAMES:
        most = longest_run(sample, separator)
        if most > longest:
            best, longest = separator, most
        if 2 * most > len(sample):  # another one could only part the heading too
            break
    if not best:
        ways = ", ".join(SEPARATOR_NAMES.values())
        wish = f"want rows of at least two numbers parted by {ways}, below a line with names"
        raise InputFileError(file, found="text without a table of numbers", wish=wish)
    return best


def longest_run(sample: Sequence[str], separator: str) -> int:
    """Most rows of one width, one after the other, that a ``separator`` makes of the lines."""
    run, width, most = 0, 0, 0
    for k, line in enumerate(sample, start=1):
        cells = split(line, separator) if 0 < line.count(separator) < CELLS_LIMIT else []
        if len(cells) > 1 and is_data(cells):
            run, width = (run + 1 if len(cells) == width else 1), len(cells)
            most = max(most, run)
            rest = "\n".join(sample[k:]).rstrip("\n") if run == LEAST_RECORDING_ROWS else ""
            if rest and are_rows(rest.encode("utf-8"), separator, line.encode("utf-8")):
                return max(most, run + rest.count("\n") + 1)
        elif line.strip():
            run = 0
    return most


def find_blocks(
    file: Path, lines: TextLines, separator: str, *, header: int = 0, units: int = 0, footer: bool = True
) -> list[RecordingLines]:
    """Every recording of the file; ``header`` and ``units`` are the lines of names and units where a map states them,
    ``footer`` allows text below the last row.

    Raises ``InputFileError`` where a row among others is none.
    """
    runs = _runs(lines, separator)
    if header:
        runs = [(max(first, header, units), end, width) for first, end, width in runs if end > header]
    longest = max(runs, key=lambda run: run[1] - run[0], default=(0, 0, 0))
    least = min(LEAST_RECORDING_ROWS, longest[1] - longest[0])
    runs = [run for run in runs if run[1] - run[0] >= least or run[2] == longest[2]]
    if len(runs) > SECTIONS_LIMIT:
        wish = f"want at most {SECTIONS_LIMIT}; split the file"
        raise InputFileError(file, found=f"{len(runs)} tables of numbers", wish=wish)
    if not runs:
        found = f"no row of numbers parted by {SEPARATOR_NAMES.get(separator, 'it')}"
        raise InputFileError(file, found=found, wish="want another separator, or none in [text] to have it found")
    blocks: list[RecordingLines] = []
    before = 0
    for first, end, width in runs:
        above = [k for k in range(before, first) if lines[k].strip()]
        block = _block(file, lines, above, separator, (first, end, width), header=header, units=units)
        if blocks and not _begins(lines, above, separator, width):
            rows = ((blocks[-1].rows[0] - 1, before), (first, end))
            torn = any(separator in lines[k] and is_number(split(lines[k], separator)[0]) for k in above)
            if torn or len(blocks[-1].names) != width or not begins_again(lines, separator, blocks[-1].names, *rows):
                raise _bad_line(file, lines, above, separator, blocks[-1], gaps=len(runs) - 1)
            block = replace(blocks[-1], head=block.head, rows=block.rows)
        blocks += _parted(lines, separator, block)
        before = end
    tail = [k for k in range(before, len(lines)) if holds_cells(lines[k])]
    if tail and (not footer or _is_row(split(lines[tail[0]], separator), len(blocks[-1].names))):
        raise _bad_line(file, lines, tail, separator, blocks[-1])
    return blocks


def _parted(lines: TextLines, separator: str, block: RecordingLines) -> list[RecordingLines]:
    """A ``block`` as the recordings that it holds: one begins where the time does so again."""
    first, end = block.rows[0] - 1, block.rows[1] - 1
    begins = [first, *restarts(lines, separator, block.names, (first, end)), end]
    parts = [replace(block, rows=(one + 1, other + 1)) for one, other in itertools.pairwise(begins)]
    return [parts[0], *(replace(one, head=(one.rows[0], one.rows[0])) for one in parts[1:])]


def _runs(lines: TextLines, separator: str) -> list[tuple[int, int, int]]:
    """Runs of rows of one width: first line, end (both from 0), width."""
    runs: list[tuple[int, int, int]] = []
    quick: re.Pattern[str] | None = None
    if separator != " ":
        mark = re.escape(separator)
        cell = r"[ ]*[+-]?\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?[ ]*" if separator != "," else r"[ ]*[+-]?\d+(?:\.\d+)?[ ]*"
        quick = re.compile(rf"{cell}(?:{mark}{cell})+")
    open_ = False
    begins = [
        *range(0, min(LINES_AT_ONCE, len(lines)), FIRST_LINES)[:2],
        *range(LINES_AT_ONCE, len(lines), LINES_AT_ONCE),
    ]
    for begin, end in itertools.pairwise([*begins, len(lines)]):
        text = lines.coded(begin, end) if open_ else b""
        held = text.rstrip(b"\n")  # blank lines at the end of the file
        if held and are_rows(held, separator, lines.coded(runs[-1][1] - 1, runs[-1][1])):
            runs[-1] = (runs[-1][0], end - len(text) + len(held), runs[-1][2])
            continue
        for k, line in enumerate(lines[begin:end], start=begin):
            if not line or line.isspace() or (open_ and not holds_cells(line)):
                continue
            if quick is not None and quick.fullmatch(line):
                width = line.count(separator) + 1
            else:
                cells = split(line, separator) if 0 < line.count(separator) < CELLS_LIMIT else []
                width = len(cells) if len(cells) > 1 and is_data(cells) else 0
            if width and open_ and runs[-1][2] == width:
                runs[-1] = (runs[-1][0], k + 1, width)
            elif width:
                runs.append((k, k + 1, width))
            open_ = width > 0
    return runs


def _is_row(cells: Sequence[str], width: int) -> bool:
    """Whether a line below the rows was meant for one: it begins with a number, has as many cells, or no letters; not
    where it begins with a word that closes a table, or with one beside nothing but empty cells and other words."""
    if is_number(cells[0]) or is_stamp(cells[0]):
        return True
    if len(cells) == width and not closes(cells):
        return True
    text = " ".join(cells)
    return any(c.isdigit() for c in text) and not any(c.isalpha() for c in text)


def _begins(lines: Sequence[str], above: Sequence[int], separator: str, width: int) -> bool:
    """Whether the lines between two runs of rows begin another recording: one of them names as many columns."""
    for k in above:
        cells = words_of_line(lines[k], separator, width)
        if any(cells) and not part_read(cells):
            return True
    return False


def _bad_line(
    file: Path, lines: Sequence[str], above: Sequence[int], separator: str, block: RecordingLines, *, gaps: int = 0
) -> InputFileError:
    """The error for a line among rows that is none; ``gaps`` are the places where the rows are broken so."""
    width = len(block.names)
    if not above:
        at = block.rows[1] - 1
        cells = split(lines[at], separator)
        wish = f"want {width}, as above{_cut(lines, at)}"
        return InputFileError(file, where=f"line {at + 1}", found=f"{len(cells)} cells", wish=wish)
    at = above[0]
    cells = split(lines[at], separator)
    if len(cells) != width:
        wish = f"want {width} cells, as above, or a line of names where another recording begins{_cut(lines, at)}"
        if gaps:
            more = f" (rows are broken in {gaps} places)" if gaps > 1 else ""
            wish += f'; delete the line if it is torn, or in a map: text.torn_lines = "left out"{more}'
        found = f"`{shorten(lines[at].strip())}`"
        return InputFileError(file, where=f"line {at + 1}", found=found, wish=wish)
    bad = next((k for k, cell in enumerate(cells) if not is_data([cell, "0"])), 0)
    wish = f"want a finite number (an empty cell or nan for a drop-out){no_reading(cells[bad])}{_cut(lines, at)}"
    where = f"line {at + 1}, column {block.names[bad]}"
    return InputFileError(file, where=where, found=f'"{shorten(cells[bad])}"', wish=wish)


def _cut(lines: Sequence[str], at: int) -> str:
    """What is said of the last line, which a logger may have been stopped in."""
    last = not any(line.strip() for line in lines[at + 1 :])
    return "; the last line looks cut off, delete it" if last else ""


def _block(
    file: Path,
    lines: Sequence[str],
    above: Sequence[int],
    separator: str,
    run: tuple[int, int, int],
    *,
    header: int,
    units: int,
) -> RecordingLines:
    """The recording of one run of rows, with what the lines above it say of its columns."""
    first, end, width = run
    named, unit_line = header - 1, units - 1
    if not header:
        named, unit_line = heading(lines, above, separator, width)
    names = words_of_line(lines[named], separator, width) if 0 <= named < len(lines) else []
    named_units = words_of_line(lines[unit_line], separator, width) if 0 <= unit_line < len(lines) else []
    for asked, key, held in ((header, "header_line", names), (units, "units_line", named_units)):
        if asked and not held:
            found = f"no {width} cells in line {asked}, as the rows have"
            raise InputFileError(file, found=found, wish=f"want {key} in [text] of the map to be another line, or none")
    if names and not header:
        names, named_units = completed(lines, above, separator, (named, names), named_units)
    return RecordingLines(
        names=tuple(told_apart(names or [""] * width)),
        stated=tuple(names or [""] * width),
        units=tuple(bare(cell) for cell in named_units or [""] * width),
        header=named + 1 if names else 0,
        head=(above[0] + 1 if above else first + 1, (named if names else first) + 1),
        rows=(first + 1, end + 1),
    )
