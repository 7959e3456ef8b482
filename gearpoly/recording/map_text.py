"""The map that a survey writes: what is sure as lines, what is in doubt as lines behind a # with the question."""

from __future__ import annotations

from gearpoly.errors import escaped
from gearpoly.recording.meaning import entry, quoted
from gearpoly.recording.survey import Seen, Survey


def map_text(found: Survey) -> str:
    """The map of one recording, as TOML; of a file with several it holds for each of them."""
    lines = [
        f"# Map of {quoted(found.file.name)}, by gearpoly read. What is in doubt stands behind a #:",
        "# read the line above it, and take the # away where it is so.",
    ]
    if found.of > 1:
        lines.append(f"# The file holds {found.of} recordings. To take one alone:")
        lines.append(f"# section = {found.number}")
    lines += [f"text.{key} = {quoted(value)}" for key, value in found.layout.items() if value]
    lines += [_line(one) for one in found.channels if one.sure and one.column]
    for doubt in found.doubts:
        lines.append(f"# {escaped(doubt.says)}")
        lines += [f"# {ask}" for ask in doubt.ask]
    return "\n".join(lines) + "\n"


def _line(one: Seen) -> str:
    """The line of a column that is sure, with the unit that its numbers are in."""
    return entry(one.column, one.name, one.known)
