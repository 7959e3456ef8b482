"""The map of an inspection sheet that ``gearpoly read`` writes and ``gearpoly pair --from`` takes."""

from __future__ import annotations

from collections.abc import Iterator

from gearpoly.errors import escaped
from gearpoly.files.inspection.seen import SheetSeen, column_line
from gearpoly.files.inspection.table_heads import SIGNED
from gearpoly.files.toml_text import value_text

STATED_GEAR_KEYS = ("teeth", "module_mm", "pressure_angle_deg", "profile_shift", "face_width_mm")
"""Numbers of a gear that a map may state."""


def sheet_map_text(seen: SheetSeen) -> str:
    """What a sheet was taken for as lines of a map, and what is in doubt as lines behind a # with the question."""
    lines = [
        f"# Map of {value_text(seen.file.name)}, an inspection sheet, by gearpoly read.",
        "# What is in doubt stands behind a #: read the line above it, and take the # away where it is so.",
        f"# Taken by: {escaped(taken_by(seen, mapped=True))}",
    ]
    lines += [f"{key} = {value_text(value)}" for key, value in seen.layout.items() if value]
    if seen.gear is not None:
        if seen.gear.count is not None and seen.columns:
            lines.append(f"count = {value_text(seen.gear.count)}")
        geometry = seen.gear.geometry
        for key in STATED_GEAR_KEYS:
            if key in geometry:
                value = geometry[key]
                lines.append(f"gear.{key} = {int(value) if key == 'teeth' else value_text(float(value))}")
    lines += _columns(seen)
    for doubt in seen.doubts:
        lines.append(f"# {escaped(doubt.says)}")
        lines += [f"# {line}" for line in doubt.ask]
    return "\n".join(lines) + "\n"


def _columns(seen: SheetSeen) -> Iterator[str]:
    """The lines of the columns; none where one head means two things in two blocks, which their titles tell."""
    held: dict[str, set[str]] = {}
    for one in seen.columns:
        if one.meaning:
            sided = one.own is not None and one.meaning in SIGNED
            held.setdefault(one.key, set()).add(f"{one.meaning}_{one.own}" if sided else one.meaning)
    asked = {line.partition(" = ")[0] for doubt in seen.doubts for line in doubt.ask}
    if all(len(meanings) == 1 for meanings in held.values()):
        lines = (column_line(key, meaning) for key, (meaning,) in held.items())
        yield from (line for line in lines if line.partition(" = ")[0] not in asked)


def taken_by(seen: SheetSeen, *, mapped: bool = False) -> str:
    """The command that makes a pair file of a sheet, with what it has to be told."""
    words = ["gearpoly pair --from", seen.file.name, "--as driving --flank left"]
    if seen.gear is not None and seen.gear.count is None and not mapped:
        words.append("--count clockwise")
    return " ".join([*words, *(["--map map.toml"] if mapped else []), "pair.toml"])
