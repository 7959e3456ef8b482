"""What an inspection sheet holds, before a pair file is made of it: its gear, quantities by flank, and what is open.

Nothing is refused here: what ``gearpoly pair --from`` would refuse is told, with the line of a map that cures it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from gearpoly.errors import InputFileError, shown
from gearpoly.files.gde import ROOT, Side
from gearpoly.files.inspection.heads_of_sheets import SHEET_START_BYTES
from gearpoly.files.inspection.klingelnberg_text import is_export
from gearpoly.files.inspection.measured import SIDES, MeasuredGear
from gearpoly.files.inspection.read import read_sheet
from gearpoly.files.inspection.sheet_map import SheetMap
from gearpoly.files.inspection.table import blocks_of, columns_of, decimal_of
from gearpoly.files.inspection.table_blocks import TeethRows
from gearpoly.files.inspection.table_columns import by_map, by_name, stated
from gearpoly.files.inspection.table_heads import SIGNED, UNIT
from gearpoly.files.inspection.table_lines import lines_of
from gearpoly.files.paths import is_file
from gearpoly.files.rexs.source import is_design
from gearpoly.files.sheet_csv import SHEET_KEYS
from gearpoly.files.toml_text import value_text
from gearpoly.files.traces import split_row


@dataclass(frozen=True, kw_only=True)
class ColumnSeen:
    """A column of a table (a row, where teeth are in columns): its ``name`` and ``unit`` there ("" where none is
    stated), how a map calls it (``key``), and what it is taken for, "" where nobody knows. ``own`` is the flank
    that its head says itself, and ``side`` that which the title above says too."""

    name: str
    unit: str
    key: str
    meaning: str
    side: Side | None
    own: Side | None = None


@dataclass(frozen=True, kw_only=True)
class Held:
    """A quantity that was measured: of how many flanks or teeth, on which ``side``, from ``low`` to ``high`` in um."""

    name: str
    side: Side | None
    count: int
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class SheetDoubt:
    """What a sheet leaves open, in words, and the lines of a map that say it, to be chosen or filled in."""

    says: str
    ask: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class SheetSeen:
    """An inspection sheet: its ``format``, the gear as it was read (``None`` where it is refused, by ``refusal``), the
    ``columns`` of a table and how it was taken apart (``layout``), what was measured, notes and doubts."""

    file: Path
    format: str
    gear: MeasuredGear | None
    refusal: str
    columns: tuple[ColumnSeen, ...]
    layout: dict[str, str]
    held: tuple[Held, ...]
    says: tuple[str, ...]
    doubts: tuple[SheetDoubt, ...]


def check_kind(file: Path) -> None:
    """Raise ``InputFileError`` where a file is neither a recording nor a sheet that a pair file is made of: a design,
    or gearpoly's own sheet."""
    if not is_file(file):
        return
    try:
        with file.open("rb") as stream:
            start = stream.read(SHEET_START_BYTES)
    except OSError:
        return
    if is_design(file, start):
        wish = "want it given to gearpoly pair --from, which makes a pair file of it"
        raise InputFileError(file, found="a design (REXS), no recording", wish=wish)
    head = next((one for one in start.decode("utf-8", "replace").splitlines() if one[:1] not in ("#", "")), "")
    cells = split_row(head)
    if {"gear", "tooth"} <= set(cells) and not set(SHEET_KEYS).isdisjoint(cells):
        wish = f'want it named in a pair file: sheet_csv = "{file.name}" under [driving.inspection]'
        raise InputFileError(file, found="gearpoly's own inspection sheet, no recording", wish=wish)


def look_at_sheet(file: Path, layout: SheetMap) -> SheetSeen:
    """What ``pair --from`` would make of an inspection sheet, as far as the ``layout`` and the sheet say it."""
    with file.open("rb") as stream:
        start = stream.read(SHEET_START_BYTES)
    gear, refusal = None, ""
    try:
        gear = read_sheet(file, start, layout=layout, known={}, count=None)
    except InputFileError as error:
        refusal = str(error)
    columns: tuple[ColumnSeen, ...] = ()
    apart: dict[str, str] = {}
    doubts: list[SheetDoubt] = []
    kind = "inspection by Klingelnberg" if is_export(start) else "inspection as XML"
    if kind.endswith("XML") and f"<{ROOT}".encode() not in start:
        kind = "table of an inspection"
        columns, apart, found = _of_table(file, layout)
        doubts += found
    if refusal and not doubts:
        doubts.append(SheetDoubt(says=refusal))
    doubts += _open(gear, layout)
    return SheetSeen(
        file=file,
        format=kind,
        gear=gear,
        refusal=refusal,
        columns=columns,
        layout=apart,
        held=() if gear is None else tuple(_held(gear)),
        says=() if gear is None else gear.says,
        doubts=tuple(doubts),
    )


def _of_table(file: Path, layout: SheetMap) -> tuple[tuple[ColumnSeen, ...], dict[str, str], list[SheetDoubt]]:
    """The columns of a table, how it was taken apart, and what nobody knows of it."""
    try:
        _, separator = lines_of(file, layout)
        blocks = blocks_of(file, layout, [])
    except InputFileError:
        return (), {}, []
    apart = {"separator": separator, "decimal": layout.decimal or decimal_of(blocks)}
    seen: list[ColumnSeen] = []
    doubts: list[SheetDoubt] = []
    for block in blocks:
        known = _known(file, block, blocks, layout)
        for one, (meaning, side) in zip(_columns(block, layout, blocks), known, strict=True):
            seen.append(replace(one, meaning=meaning, side=side) if meaning else one)
        if not any(meaning for meaning, _ in known):
            doubts += _unknown(block, layout, blocks)
    return tuple(dict.fromkeys(seen)), apart, list(dict.fromkeys(doubts))


def _known(
    file: Path, block: TeethRows, blocks: Sequence[TeethRows], layout: SheetMap
) -> list[tuple[str, Side | None]]:
    """What each column of a block is read as; ("", None) for all where the block is refused."""
    try:
        return columns_of(file, block, blocks, layout).meanings
    except InputFileError:
        return [("", None)] * len(block.names)


def _columns(block: TeethRows, layout: SheetMap, blocks: Sequence[TeethRows]) -> Iterator[ColumnSeen]:
    """The columns of one of the ``blocks``, each by its own head or the map."""
    beside = any(one.head == block.head and one.first != block.first for one in blocks)
    for k, name in enumerate(block.names):
        alone = name and block.names.count(name) == 1 and not beside
        given = by_map(layout, block, k)
        meaning, side = by_name(name, block) if given is None else stated(given)
        if block.turned and k == 0:
            meaning = "tooth"
        written = UNIT.search(name)
        unit = written[1] if written is not None else block.units[k]
        yield ColumnSeen(
            name=name or block.number(k),
            unit=unit,
            key=name if alone else block.number(k),
            meaning="ignored" if meaning == "not taken" else meaning,
            side=side,
            own=side,
        )


def _unknown(block: TeethRows, layout: SheetMap, blocks: Sequence[TeethRows]) -> Iterator[SheetDoubt]:
    """What is not known of the columns of a block that is refused, each with the lines of a map that would do."""
    columns = list(_columns(block, layout, blocks))
    flanks = any(one.meaning == "flank" for one in columns)
    for one in columns:
        if not one.meaning:
            says = f'nobody knows what "{shown(one.name)}" holds: one of these, or another quantity'
            ask = [column_line(one.key, word) for word in ("ignored", "single_pitch_left", "single_pitch_right")]
            yield SheetDoubt(says=says, ask=tuple(ask))
        elif one.meaning in SIGNED and one.side is None and block.side is None and not flanks:
            if len(blocks) > 1 and len({other.head for other in blocks}) == len(blocks):
                says = f"nobody knows of which flank the block below line {block.head} is"
                ask = [f'blocks.{value_text(f"line {block.head}")} = "{side}"' for side in SIDES]
            else:
                says = f'nobody knows of which flank "{shown(one.name)}" is'
                ask = [column_line(one.key, f"{one.meaning}_{side}") for side in SIDES]
            yield SheetDoubt(says=says, ask=tuple(ask))
    if not any(one.meaning == "tooth" for one in columns):
        ask = [column_line(one.key, "tooth") for one in columns[:2]]
        yield SheetDoubt(says=f"no column below line {block.head} has the numbers of teeth", ask=tuple(ask))


def column_line(key: str, meaning: str) -> str:
    """The line of a map that says what a column holds."""
    return f"columns.{value_text(key)} = {value_text(meaning)}"


def _open(gear: MeasuredGear | None, layout: SheetMap) -> Iterator[SheetDoubt]:
    """What no sheet of this kind says, or this one does not: numbers of the gear, and the direction of counting."""
    geometry = layout.known if gear is None else gear.geometry
    count = layout.count if gear is None else gear.count
    for key, what, line in (
        ("module_mm", "its module, which a pair file may state too", "gear.module_mm = 2.0"),
        ("pressure_angle_deg", "its pressure angle, which is taken as 20 deg", "gear.pressure_angle_deg = 20.0"),
        ("profile_shift", "its profile shift, which is taken as 0", "gear.profile_shift = 0.0"),
    ):
        if key not in geometry:
            yield SheetDoubt(says=f"the sheet does not state {what}", ask=(line,))
    by_tooth = gear is None or any((gear.arcs, gear.material, gear.profiles, gear.thickness, gear.shapes))
    if count is None and by_tooth:
        yield SheetDoubt(
            says="the sheet does not say which way teeth are counted, seen on the datum face",
            ask=('count = "clockwise"', 'count = "counterclockwise"'),
        )
    if gear is not None and any("states no unit" in one for one in gear.says):
        yield SheetDoubt(says="heads state no unit, and um is taken", ask=('unit = "um"',))


def _held(gear: MeasuredGear) -> Iterator[Held]:
    """What was measured of a gear, by flank."""
    for side in SIDES:
        for name, rows in (("pitch along the reference circle", gear.arcs), ("index deviation", gear.material)):
            if side in rows:
                yield _row(name, side, rows[side])
        traces = [one for one in gear.profiles if one.flank == side]
        if traces:
            every = [value for one in traces for value in one.deviation]
            yield Held(name="profile", side=side, count=len(traces), low=min(every), high=max(every))
        for key, sides in gear.shapes.items():
            if side in sides:
                value = sides[side]
                yield _row(
                    re.sub("_um$", "", key).replace("_", " "), side, value if isinstance(value, tuple) else (value,)
                )
    if gear.thickness is not None:
        yield _row("tooth thickness", None, gear.thickness)


def _row(name: str, side: Side | None, values: Sequence[float]) -> Held:
    return Held(name=name, side=side, count=len(values), low=min(values), high=max(values))
