"""The map that a survey writes: what is sure as lines, what is in doubt as lines behind a # with the question."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from gearpoly.errors import OutOfRangeError, escaped
from gearpoly.recording.asked import angles_known
from gearpoly.recording.map_lines import LEAVE_OUT_LINE, angle_entries, each_once, entry, quoted
from gearpoly.recording.recording import ANGLE_COLUMNS
from gearpoly.recording.survey import Seen, Survey

OFFERED = 12
"""Columns that are offered for an angle; a recording has a handful."""


def check_one_file(target: Path | str, *, files: int) -> None:
    """Raise ``OutOfRangeError`` where a map is wanted of several files."""
    if files > 1:
        raise OutOfRangeError(f"--write {target}: a map is of one file, and {files} are given; want one of them")


def map_text(found: Survey) -> str:
    """The map of one recording, as TOML; of a file with several it holds for each of them."""
    lines = [
        f"# Map of {quoted(found.file.name)}, by gearpoly read. What is in doubt stands behind a #:",
        "# read the line above it, and take the # away where it is so.",
    ]
    if found.of > 1:
        lines.append(f"# The file holds {found.of} recordings. To take one alone:")
        lines.append(f"# section = {found.number}")
    lines += [f"text.{k} = {held if k == 'widths' else quoted(held)}" for k, held in found.layout.items() if held]
    lines += [_line(one) for one in found.channels if one.sure and one.column]
    stated = {line.partition(" = ")[0] for line in lines}
    left = each_once(ask for doubt in found.doubts for ask in doubt.ask if ask.startswith(LEAVE_OUT_LINE))
    for doubt in found.doubts:
        lines.append(f"# {escaped(doubt.says)}")
        if any(ask.partition(" = ")[0] in stated for ask in doubt.ask):
            lines.append("# (in the place of its line above)")
        lines += [f"# {ask}" for ask in doubt.ask if not ask.startswith(LEAVE_OUT_LINE)]
    lines += [f"# {line}" for line in left]  # at the end, since a map states each key once
    lines += _angles_asked(found)
    return "\n".join(lines) + "\n"


def _angles_asked(found: Survey) -> Iterator[str]:
    """The lines of angles that nothing in the recording may be by its name, one for each column that is free."""
    named = [one.column for one in found.channels if one.column]
    free = [one for one in found.channels if not one.column][:OFFERED]
    if angles_known(named) or not free:
        return
    for angle in ANGLE_COLUMNS:
        if angles_known([*named, *(other for other in ANGLE_COLUMNS if other != angle)]):
            continue
        yield f"# no column is {angle} by its name: one of these, with the unit that it has?"
        yield from (f"# {line}" for one in free for line in _offers(angle, one))


def _offers(angle: str, one: Seen) -> tuple[str, ...]:
    """The lines that give an ``angle`` to a channel: by what its readings do where it states no unit."""
    return (entry(angle, one.name, one.known),) if one.unit else angle_entries(angle, one.name, one.values)


def _line(one: Seen) -> str:
    """The line of a column that is sure, with the unit that its numbers are in."""
    return entry(one.column, one.name, one.known)
