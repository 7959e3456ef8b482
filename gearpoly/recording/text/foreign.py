"""Text files as loggers of all countries write them: each recording of the file as a table, under the owner's names.

Nothing here knows what a column means. What could not be told for certain is left in the table's doubts, with the line
of a map that settles it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.errors import InputFileError
from gearpoly.files.traces import check_file, shorten
from gearpoly.recording.arrow import joined_codes
from gearpoly.recording.comments import read_comment, said_radial
from gearpoly.recording.header import header_unit
from gearpoly.recording.quantities import ANGLE, unit_written
from gearpoly.recording.reader import check_few, check_numbers, memory_limit
from gearpoly.recording.table import Channel, Doubt, Table
from gearpoly.recording.text.broken_off import without_broken_off
from gearpoly.recording.text.cells import BadCellError, Marks, is_missing, marks_confirmed, marks_proved
from gearpoly.recording.text.commas import commas
from gearpoly.recording.text.encoding import coded
from gearpoly.recording.text.even_stamps import even_seconds, even_stamps
from gearpoly.recording.text.fixed_width import PARTED, by_widths, parted, touching
from gearpoly.recording.text.labview import take_times
from gearpoly.recording.text.layout import SEPARATOR_NAMES, RecordingLines, find_blocks, find_separator
from gearpoly.recording.text.lines import TextLines
from gearpoly.recording.text.missing import no_reading, without, without_empty, without_unnamed
from gearpoly.recording.text.oscilloscope import take_sequence
from gearpoly.recording.text.part import TextPart
from gearpoly.recording.text.rewritten import rewritten, say_rewritten, without_torn
from gearpoly.recording.text.stamps import DATE_ORDERS, date_order, is_date_alone, is_stamp, seconds
from gearpoly.recording.text.wrapped import unwrapped
from gearpoly.recording.text.writing import Writing
from gearpoly.recording.words import quantity_of
from gearpoly.units import FloatArray

SAMPLE_CELLS = 20_000
"""Cells that are looked at first for the decimal mark; one may settle it."""

NO_COUNTRY = "latin-1"
"""What bytes are read in that are neither UTF-8 nor of western Windows; nobody writes the characters beyond these."""

CHUNK_CELLS = 20_000
"""Cells that are held as text at a time."""

PLAIN_CELLS = 200_000
"""Cells that are read at a time while they are plain numbers; a few MB of text."""

CELL_BYTES = 80
"""Memory of one cell as text, beside its line."""

LINE_BYTES = 64
"""Memory that a line takes beside its characters."""

RECORDING_TEXT_LIMIT_BYTES = 2**30
"""Largest text file that is held as lines, which take three times its size; the contract's own CSV is read as a stream
up to 4 GB."""


def read_foreign(file: Path, writing: Writing, *, footer: bool = True) -> list[Table]:
    """Every recording in a text file, its columns under ``others``, in the order of the file; ``footer`` allows text
    below the last row.

    Raises ``InputFileError`` with the line at fault where it holds no table of numbers.
    """
    check_file(file, limit_bytes=RECORDING_TEXT_LIMIT_BYTES)
    text, inside, encoding = coded(file, stated=writing.encoding)
    text, broken = without_broken_off(text, inside)
    lines, left_out = without_unnamed(without_empty(TextLines(text, inside)))
    if LINE_BYTES * len(lines) > memory_limit(file):
        wish = "want rows of numbers; take empty lines out, or split the file"
        found = f"{len(lines)} lines of {len(text) / len(lines):.1f} characters"
        raise InputFileError(file, found=found, wish=wish)
    del text
    lines, taken_off = unwrapped(lines)
    tables = _parted(file, lines, writing, encoding, footer=footer)
    for table in tables:
        table.remarks += [said for said in (left_out, taken_off) if said]
    tables[-1].remarks += [broken] if broken else []
    return tables


def _parted(file: Path, lines: TextLines, writing: Writing, encoding: str, *, footer: bool) -> list[Table]:
    """Every recording in the lines of a text, by whatever parts its cells."""
    if writing.widths:
        cut = by_widths(lines, writing.widths)
        return _recordings(file, cut, replace(writing, separator=PARTED), encoding, footer=footer)
    both = commas(file, lines, writing)
    if both is not None:
        how = replace(writing, separator=PARTED, decimal=",")
        tables = _recordings(file, both.lines, how, encoding, footer=footer, parted_by=",")
        for table in tables:
            table.remarks.insert(1, both.said)
            table.doubts[:0] = [both.doubt] if both.doubt is not None else []
        return tables
    try:
        return _recordings(file, lines, writing, encoding, footer=footer)
    except InputFileError:
        held = touching(lines) if writing.separator in ("", " ") else None
        if held is None:
            raise
    tables = _recordings(file, *parted(file, held, writing), encoding, footer=footer)
    for table in tables:
        table.remarks.append(f"numbers touch, such as {shorten(held.example)}: parted {held.how}")
    return tables


def _recordings(
    file: Path, lines: TextLines, writing: Writing, encoding: str, *, footer: bool, parted_by: str = ""
) -> list[Table]:
    """Every recording in the lines of a text, whose cells were ``parted_by`` another mark in the file."""
    beside = rewritten(file, lines, separator=writing.separator)
    lines, torn = beside.lines, 0
    separator = writing.separator or find_separator(file, lines)
    if writing.missing:
        lines = TextLines(without(lines.joined(0, len(lines)), writing.missing, separator).encode("utf-8"), "utf-8")
    if writing.torn_lines:
        lines, torn = without_torn(lines, separator)
    blocks = find_blocks(file, lines, separator, header=writing.header_line, units=writing.units_line, footer=footer)
    columns = sum((one.rows[1] - one.rows[0]) * len(one.names) for one in blocks)
    check_numbers(file, columns)
    shared = _keys(file, lines, blocks[0])
    mark = parted_by or separator
    parting = "their widths" if writing.widths else SEPARATOR_NAMES.get(mark, shorten(mark))
    tables = []
    for block in blocks:
        table = _table(file, lines, block, separator, writing)
        say_rewritten(table, block, beside)
        if torn:
            table.remarks.append(f"{torn} torn lines left out, as the map says")
        own = shared if block is blocks[0] else {**shared, **_keys(file, lines, block)}
        table.keys.update(own)
        table.remarks += said_radial(lines[block.head[0] - 1 : (block.header or block.rows[0]) - 1])
        ways = {"widths": str(list(writing.widths))} if writing.widths else {"separator": mark}
        table.layout = {"encoding": encoding, **ways, **table.layout}
        table.remarks.insert(
            0,
            f"text in {encoding}, cells parted by {parting}, names in line "
            f"{block.header or 'none'}, rows from line {block.rows[0]}",
        )
        if encoding == NO_COUNTRY and not writing.encoding:
            others = '"shift_jis", "gb18030", "cp1251"'
            table.remarks.append(f"names are in another encoding: a map may state it, as text.encoding = {others}")
        tables.append(table)
    return tables


def _keys(file: Path, lines: Sequence[str], block: RecordingLines) -> dict[str, object]:
    """The keys in the comment lines above a recording."""
    keys: dict[str, object] = {}
    places: dict[str, str] = {}
    stated = 0
    for number in range(block.head[0], block.head[1]):
        line = lines[number - 1].strip()
        if line.startswith("#"):
            stated += "=" in line
            check_few(file, f"line {number}", stated, "comment lines with =")
            read_comment(file, f"line {number}", line[1:].strip(), keys, places)
    return keys


def _table(file: Path, lines: TextLines, block: RecordingLines, separator: str, writing: Writing) -> Table:
    table = Table(columns={}, keys={})
    part = TextPart(file=file, lines=lines, block=block, separator=separator, writing=writing)
    sample = part.cells(part.ends(max(1, SAMPLE_CELLS // len(block.names) // 2)))
    stamped = [k for k, cells in enumerate(sample) if _are_stamps(cells)]
    marks = _marks(part, sample, [k for k in range(len(sample)) if k not in stamped], table)
    check_numbers(file, 0, beside=CELL_BYTES * (block.rows[1] - block.rows[0]) * len(stamped))
    series = _even(part, marks, stamped, table) if stamped else None
    if series is None:
        series, texts = _columns(part, marks, stamped, table)
    else:
        texts = {}
    if lines.hold("#", *part.bounds) and any(line.lstrip().startswith("#") for line in lines[slice(*part.bounds)]):
        table.remarks.append("comment lines among the rows passed over")
    series.update(_times(part, texts, table))
    for k, name in enumerate(block.names):
        if k not in series or (name == f"column {k + 1}" and not np.isfinite(series[k]).any()):
            continue  # a date whose time stands beside it; rows that end in a separator
        unit, own = "s" if k in stamped else block.units[k], block.stated[k]
        table.others[name] = Channel(values=series[k], unit=unit, leaf=own if own != name else "", number=k + 1)
    take_times(table, lines, block, separator, marks)
    take_sequence(table, lines, block, separator, marks)
    table.layout["decimal"] = marks.decimal
    if marks.thousands:
        table.layout["thousands"] = marks.thousands
    return table


def _even(part: TextPart, marks: Marks, stamped: Sequence[int], table: Table) -> dict[int, FloatArray] | None:
    """The numbers (n,) of every column by its number from 0, those of time stamps in s after the first, where all rows
    are plain and all stamps written alike; ``None`` where they are to be read cell by cell."""
    pieces = []
    for begin, stop, _ in reversed(_cut(*part.bounds, PLAIN_CELLS // len(part.block.names), large=True)):
        pieces.append(part.parsed(begin, stop, marks, texts=stamped))
        if pieces[-1] is None:
            return None
    columns = [[held[k] for held in pieces if held is not None] for k in range(len(part.block.names))]
    whole: list[Any] = [(joined_codes if k in stamped else np.concatenate)(column) for k, column in enumerate(columns)]
    found = {k: even_stamps(whole[k]) for k in stamped}
    if any(one is None for one in found.values()):
        return None
    stamps = {k: one for k, one in found.items() if one is not None}
    dates = next((k for k, one in stamps.items() if one.dated and not one.timed), None) if len(stamps) > 1 else None
    series = {k: values for k, values in enumerate(whole) if k not in stamps}
    beside = Table(columns={}, keys={})  # what is said of the stamps, once it is sure that they are read so
    for k, one in stamps.items():
        if k == dates:
            continue
        days = one if dates is None else stamps[dates]
        order = _order(part, [text for _, text in days.dated], beside)
        read = even_seconds(one, order=order, dates=None if dates is None else days)
        if read is None:
            return None
        series[k] = read
        beside.remarks.append(f"{shorten(part.block.names[k])}: time stamps, in s after the first")
    table.remarks += beside.remarks
    table.doubts += beside.doubts
    table.layout.update(beside.layout)
    return series


def _columns(
    part: TextPart, marks: Marks, stamped: Sequence[int], table: Table
) -> tuple[dict[int, FloatArray], dict[int, list[str]]]:
    """The numbers (n,) of every column by its number from 0, and the cells of those of time stamps; words without a
    reading are told."""
    texts: dict[int, list[str]] = {k: [] for k in stamped}
    first, end = part.bounds
    read = {k: np.empty(end - first) for k in range(len(part.block.names)) if k not in texts}
    width = len(part.block.names)
    pieces = _cut(first, end, (CHUNK_CELLS if texts else PLAIN_CELLS) // width, large=not texts)
    wish = f'want a finite number with the decimal mark "{marks.decimal}" ({marks.why}), or an empty cell'
    count = 0
    words: set[str] = set()
    while pieces:
        begin, stop, large = pieces.pop()
        columns = part.plain(begin, stop, marks) if not texts else None
        if columns is not None:
            for k, held in read.items():
                held[count : count + stop - begin] = columns[k]
            count += stop - begin
            continue
        if large:
            pieces += _cut(begin, stop, CHUNK_CELLS // width, large=False)
            continue
        rows = part.rows(begin, stop)
        if not rows:
            continue
        cells = part.cells(rows)
        for k, stamps in texts.items():
            stamps.extend(cells[k])
        for k, held in read.items():
            try:
                held[count : count + len(rows)] = marks.values(cells[k])
            except BadCellError as bad:
                word = cells[k][bad.at]
                raise part.bad(k, rows[bad.at], word, wish + no_reading(word)) from None
            words |= {cell for cell in set(cells[k]) if not cell[-1:].isdigit() and is_missing(cell)}
        count += len(rows)
    if words - {""}:
        said = ", ".join(f'"{one}"' for one in sorted(words - {""}))
        table.remarks.append(f"cells without a reading: {shorten(said)}")
    return {k: held[:count] for k, held in read.items()}, texts


def _cut(first: int, end: int, size: int, *, large: bool) -> list[tuple[int, int, bool]]:
    """Lines in pieces (first, end, ``large``) of a ``size``, the last piece first."""
    return [(begin, min(begin + max(1, size), end), large) for begin in range(first, end, max(1, size))][::-1]


def _times(part: TextPart, texts: dict[int, list[str]], table: Table) -> dict[int, FloatArray]:
    """Seconds (n,) of every column of time stamps; a column of dates beside one of times says their days."""
    dates = next((k for k, cells in texts.items() if _all(cells, is_date_alone)), None) if len(texts) > 1 else None
    days = None if dates is None else texts[dates]
    out: dict[int, FloatArray] = {}
    for k, cells in texts.items():
        if k == dates:
            continue
        order = _order(part, cells if days is None else days, table)
        try:
            out[k] = seconds(cells, order=order, dates=days)
        except BadCellError as bad:
            wish = "want a time stamp like those above, or an empty cell"
            raise part.bad(k, part.rows(*part.bounds)[bad.at], cells[bad.at], wish) from None
        table.remarks.append(f"{shorten(part.block.names[k])}: time stamps, in s after the first")
    return out


def _all(cells: Sequence[str], holds: Callable[[str], bool]) -> bool:
    return all(holds(cell) for cell in cells if not is_missing(cell))


def _are_stamps(cells: Sequence[str]) -> bool:
    """Whether a column is of time stamps."""
    first = next((cell for cell in cells if not is_missing(cell)), "")
    return is_stamp(first) and _all(cells, is_stamp)


def _marks(part: TextPart, sample: Sequence[Sequence[str]], numbers: Sequence[int], table: Table) -> Marks:
    """The marks of the columns of ``numbers``: as stated, as proved, as confirmed by the readings, or as a doubt."""
    if part.writing.decimal:
        return Marks(decimal=part.writing.decimal, thousands=part.writing.thousands, why="as the map says")
    quoted = part.lines.hold('"', *part.bounds)
    cells = [sample[k] for k in numbers]
    found = marks_proved(cells, separator=part.separator, quoted=quoted)
    if found is None and cells and part.bounds[1] - part.bounds[0] > len(cells[0]):
        whole = part.cells(part.rows(*part.bounds))
        cells = [whole[k] for k in numbers]
        found = marks_proved(cells, separator=part.separator, quoted=quoted)
    found = found or marks_confirmed(cells, angles=[j for j, k in enumerate(numbers) if _is_degrees(part.block, k)])
    if found is not None:
        if found.decimal == "," or found.thousands:
            parts = f', "{found.thousands}" parts thousands' if found.thousands else ""
            table.remarks.append(f'"{found.decimal}" is the decimal mark{parts}: {found.why}')
        return found
    mark = next(m for held in cells for cell in held for m in ",." if m in cell)
    example = next(cell for held in cells for cell in held if mark in cell)
    other = {",": ".", ".": ","}[mark]
    says = (
        f'"{shorten(example)}" may be {shorten(example.replace(mark, "."))} or {shorten(example.replace(mark, ""))}, '
        "and no number of the file tells which"
    )
    ask = (f'text.decimal = "{mark}"', f'or text.decimal = "{other}" and text.thousands = "{mark}"')
    table.doubts.append(Doubt(says=says, ask=ask))
    return Marks(decimal=mark, why="for the time being")


def _is_degrees(block: RecordingLines, k: int) -> bool:
    """Whether the column is an angle in deg by its name and unit."""
    name, unit = header_unit(block.stated[k])
    stated = unit_written(block.units[k] or unit, ANGLE)
    return quantity_of(name) == ANGLE and stated is not None and stated.name == "deg"


def _order(part: TextPart, cells: Sequence[str], table: Table) -> str:
    """The order of the dates in ``cells``, the letters of its parts."""
    order, why = date_order(cells, stated=part.writing.dates)
    if not order:
        first = next(cell for cell in cells if not is_missing(cell))
        says = f'the date in "{shorten(first)}" may begin with the day or the month'
        ask = ('text.dates = "day first"', 'or text.dates = "month first"')
        table.doubts.append(Doubt(says=says, ask=ask))
        return DATE_ORDERS["day first"]
    called = next(name for name, letters in DATE_ORDERS.items() if letters == order)
    if called != "year first":
        table.layout["dates"] = called
        table.remarks.append(f"dates have the {called}: {why}")
    return order
