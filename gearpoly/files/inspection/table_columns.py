"""What each column of a block of an inspection table holds: by its head, by the titles above, or by a map."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import get_args

from gearpoly.errors import InputFileError, shown
from gearpoly.files.gde import Side
from gearpoly.files.inspection.klingelnberg_text import SIDE_WORDS
from gearpoly.files.inspection.measured import SIDES
from gearpoly.files.inspection.sheet_map import Meaning, SheetMap
from gearpoly.files.inspection.table_blocks import TeethRows, joined
from gearpoly.files.inspection.table_heads import FLANK_WORDS, HEAD_LIMIT, SIGNED, UNIT, VALUES, length_of, meaning_of
from gearpoly.files.inspection.table_titles import title_of

MEANING_WORDS = ", ".join(get_args(Meaning))


@dataclass(frozen=True, kw_only=True)
class Heads:
    """By column: what it holds ("ignored": nothing that is taken) and of which flank, and its size in um. ``unstated``
    are the heads of deviations without a unit."""

    meanings: list[tuple[str, Side | None]]
    factors: list[float]
    unstated: list[str]
    says: list[str]


def stated(column: str) -> tuple[str, Side | None]:
    """What a map says that a column holds, and of which side."""
    stem, _, tail = column.rpartition("_")
    return (stem, SIDE_WORDS[tail]) if tail in SIDES else (column, None)


def by_map(layout: SheetMap, block: TeethRows, k: int) -> str | None:
    """What a map says of column ``k`` of a block; its number tells heads of one name apart."""
    return layout.columns.get(block.number(k), layout.columns.get(block.names[k]))


def heads_of(file: Path, block: TeethRows, layout: SheetMap, *, several: bool, beside: bool) -> Heads:
    """What each column of a block holds by its head, by the unit beside it, by the titles above, or by the map;
    ``several``: it is one of several blocks, and ``beside``: one of them stands beside it.

    Raises ``InputFileError`` where a head says nothing known, stands twice, or has no length for a unit.
    """
    meanings: list[tuple[str, Side | None]] = []
    factors, unstated, says = [], [], []
    given = [by_map(layout, block, k) for k in range(len(block.names))]
    named = {_sided(*stated(one), block) for one in given if one is not None}
    flanks = ("flank", None) in named or any(meaning_of(head)[0] == "flank" for head in block.names)
    for k, head in enumerate(block.names):
        held = given[k]
        meaning, side = stated(held) if held is not None else by_name(head, block)
        if block.turned and k == 0:
            meaning = "tooth"  # numbers that follow one another are nothing else
        if not flanks:
            meaning, side = _sided(meaning, side, block)
        # A map speaks of the columns that it names; what it leaves out may go unread, but is not doubled.
        open_ = not meaning or (meaning, side) in named or (meaning in SIGNED and side is None and not flanks)
        if held is None and layout.columns and open_:
            meaning, side = "ignored", None
        if meaning == "not taken":
            says.append(f'"{shown(head)}" is not taken: a pair file has no place for it')
            meaning, side = "ignored", None
        where = block.head_place(k)
        if not meaning:
            name = head or block.number(k)
            entry = f'[columns] "{shown(name)}" = "ignored"'
            wish = f"say in a file that --map names what it holds: {entry}, or {MEANING_WORDS}"
            raise InputFileError(file, where=where, found=f'"{shown(head)}"', wish=wish)
        if (meaning, side) in meanings and meaning != "ignored":
            wish = (
                'want each once; state [columns] in a file that --map names, and "ignored" for the others; '
                f'"{block.number(k)}" = "{meaning}_right" names one by its number'
            )
            raise InputFileError(file, where=where, found=f'"{shown(head)}" again', wish=wish)
        factor = 1.0
        if meaning not in ("tooth", "flank", "ignored"):
            written = UNIT.search(head[:HEAD_LIMIT])
            text = (written[1] if written is not None else block.units[k]) or _unit_above(block)
            factor = _factor(file, where, text or layout.unit or "")
            if not (text or layout.unit):
                unstated.append(head)
        factors.append(factor)
        meanings.append((meaning, side))
    found = [meaning for meaning, _ in meanings]
    if "tooth" not in found:
        wish = '[columns] in the map wants "NAME" = "tooth"'
        raise InputFileError(file, where=block.head_place(0), found="no column of teeth", wish=wish)
    sided = [side for meaning, side in meanings if meaning in SIGNED]
    if "flank" not in found and None in sided:
        k = next(k for k, (meaning, side) in enumerate(meanings) if meaning in SIGNED and not side)
        raise InputFileError(
            file, where=block.head_place(k), found=f'"{shown(block.names[k])}" of which flank',
            wish=_wish_of_flank(block, found[k], k, several=several, beside=beside),
        )  # fmt: skip
    return Heads(meanings=meanings, factors=factors, unstated=unstated, says=says)


def _wish_of_flank(block: TeethRows, meaning: str, k: int, *, several: bool, beside: bool) -> str:
    """What says of which flank a column is: the line of its block, where there are several, or its head."""
    wish = "want left or right in its name, or a column of flanks; or say it in a file that --map names: "
    if beside:
        return f'{wish}[columns] "{block.number(k)}" = "{meaning}_left", or right'
    if several:
        return f'{wish}[blocks] "line {block.head}" = "left", or right, and so for the other blocks'
    return f'{wish}[columns] "{shown(block.names[k])}" = "{meaning}_left", or right'


def _sided(meaning: str, side: Side | None, block: TeethRows) -> tuple[str, Side | None]:
    """What a column holds and of which side: that of its block where it names none itself."""
    return meaning, (side or block.side) if meaning in SIGNED else side


def by_name(head: str, block: TeethRows) -> tuple[str, Side | None]:
    """What a head says; one of a flank or of values alone is of the quantity that the title of its block names."""
    meaning, side = meaning_of(head)
    bare = UNIT.sub(" ", head).strip(" .:").lower()
    if block.meaning and (bare in FLANK_WORDS or bare in VALUES or (side and meaning in ("", "flank"))):
        return block.meaning, side
    return meaning, side


def _unit_above(block: TeethRows) -> str:
    """The unit in brackets in the title of a block, "" where there is none."""
    for line, cells in reversed(block.above):
        if line != block.head and title_of(cells) is not None:
            found = UNIT.search(joined(cells)[:HEAD_LIMIT])
            if found is not None and length_of(found[1]) is not None:
                return found[1]
    return ""


def _factor(file: Path, where: str, text: str) -> float:
    """The size in um of a deviation in the unit ``text``, um where none is stated."""
    size = length_of(text) if text else 1.0
    if size is None:
        wish = "want a length: um, mm, nm, m, in, mil (an angle in rad times the radius is one)"
        raise InputFileError(file, where=where, found=f'unit "{shown(text)}"', wish=wish)
    return size
