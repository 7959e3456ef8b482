"""The lines above rows that name their columns and state their units: one line, or names in groups above them."""

from __future__ import annotations

import re
from collections.abc import Sequence

from gearpoly.recording.header import header_unit
from gearpoly.recording.quantities import DOUBTFUL, UNSTATED, units_written
from gearpoly.recording.text.cut import part_read, split
from gearpoly.recording.words import quantity_of

ABSCISSA = "X_Value"
"""What LabVIEW calls a column of abscissas, in front of each channel."""


def heading(lines: Sequence[str], above: Sequence[int], separator: str, width: int) -> tuple[int, int]:
    """The lines (from 0) of the names and of the units above a run of rows; -1 where there is none."""
    wide = {
        k: cells
        for k in above
        if (cells := words_of_line(lines[k], separator, width)) and not part_read(cells) and not _is_rule(cells)
        if not _are_settings(cells)
    }
    if not wide:
        return -1, -1
    # A remark on one column is a line of neither.
    *others, last = [k for k, cells in wide.items() if 2 * sum(map(bool, cells)) >= width] or wide
    if others and _are_units(wide[last]):
        return others[-1], last
    if not others or not _are_units(wide[others[-1]]):
        return last, -1
    # Some write the units above the names, and others the numbers of amplifiers below units and names.
    above_units = others[-2] if len(others) > 1 else last
    return max(last, above_units, key=lambda k: _known(wide[k])), others[-1]


def _known(cells: Sequence[str]) -> int:
    """How many of some names say a quantity."""
    return sum(bool(quantity_of(header_unit(cell)[0])) for cell in cells)


def completed(
    lines: Sequence[str], above: Sequence[int], separator: str, names: tuple[int, list[str]], units: list[str]
) -> tuple[list[str], list[str]]:
    """The ``names`` of the columns, in the line of that number from 0, and their ``units``, with what other lines
    ``above`` the rows say of them: a group over several columns, a name that stands below alone, pairs of a key and a
    value for each channel."""
    at, held = names
    width = len(held)
    if pairs := _pairs([lines[k] for k in above], separator, width):
        called = [part for name in pairs["name"] for part in ("Time", name)]
        stated = pairs.get("unit", [""] * (width // 2))
        return called, [part for unit in stated for part in ("", unit)]
    if (all(held) and len(set(held)) == len(held)) or ABSCISSA in held:
        return held, units
    groups = next((cells for k in reversed(above) if k < at and (cells := _groups(lines[k], separator, width))), None)
    if groups is not None:
        whole = [one if group in one else f"{group} {one}".strip() for group, one in zip(groups, held, strict=True)]
        held = whole if len(set(whole)) > len(set(held)) else held
    for k in above:
        below = words_of_line(lines[k], separator, width) if k > at else []
        if below and not part_read(below) and 2 * sum(map(bool, below)) < width:
            held = [one or other for one, other in zip(held, below, strict=True)]
    return held, units


def _groups(line: str, separator: str, width: int) -> list[str]:
    """Names over several columns each, one for each column; none where a line is none of such names. A spreadsheet
    writes a name over merged cells into the first of them."""
    cells = words_of_line(line, separator, width)
    if part_read(cells) or len(set(cells) - {""}) < 2 or _are_units(cells):
        return []
    out: list[str] = []
    for cell in cells:
        out.append(cell or (out[-1] if out else ""))
    return out


def _pairs(above: Sequence[str], separator: str, width: int) -> dict[str, list[str]]:
    """Lines that repeat a key before the value of every channel (``Name``, ``Axis1``, ``Name``, ``Axis2``), by the key
    in small letters; none where no line names the channels so."""
    out: dict[str, list[str]] = {}
    for line in above:
        cells = split(line, separator)
        if width >= 4 and len(cells) == width and cells[0] and len(set(cells[::2])) == 1:
            out[cells[0].lower()] = cells[1::2]
    return out if "name" in out else {}


def _is_rule(cells: Sequence[str]) -> bool:
    """Whether a line above the rows is one that is drawn below names: ``---`` in each cell."""
    held = [cell for cell in cells if cell]
    return bool(held) and all(len(cell) > 2 and not cell.strip("-=:+_") for cell in held)


_SETTING = re.compile(r"[^\W\d]\w{0,15} ?= ?[\d.,+-].*")
"""One setting of a channel's, such as ``SR = 125 Hz`` or ``T0 = 12.03.2024``."""


def _are_settings(cells: Sequence[str]) -> bool:
    """Whether a line above the rows has a setting of each channel."""
    held = [cell for cell in cells if cell]
    return bool(held) and all(_SETTING.fullmatch(cell) for cell in held)


def _are_units(cells: Sequence[str]) -> bool:
    """Whether most cells that hold anything hold a unit."""
    held = [cell for cell in map(bare, cells) if cell not in UNSTATED]
    known = sum(bool(units_written(cell)) or cell.lower() in DOUBTFUL for cell in held)
    return known > 0 and 2 * known > len(held)


def bare(unit: str) -> str:
    """A unit without brackets about it, and nothing for what stands where none is stated."""
    inside = unit.strip("[]() ")
    return "" if inside in UNSTATED else inside


def words_of_line(line: str, separator: str, width: int) -> list[str]:
    """The cells of a line above rows of ``width`` cells, or none where it has another number of them."""
    text = line.lstrip()
    if text[:1] in ("#", "%") and "=" not in text:
        text = text[1:]
    ways = [split(text, separator)]
    if separator == " ":  # names may hold blanks where more of them part the columns
        ways.append(re.split(r"\s{2,}|\t", text.strip()))
    for cells in ways:
        if len(cells) == width + 1 and cells[-1].strip().lower() in (
            "",
            "comment",
        ):  # LabVIEW names a column of remarks
            cells.pop()
        if len(cells) == width:
            return [cell.strip() for cell in cells]
        if len(cells) == width - 1 and width > 2:  # rows end in a separator, names do not
            return [*(cell.strip() for cell in cells), ""]
    return []
