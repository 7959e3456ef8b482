"""Pair files written from Python: to fill in, of a telescope mount, from an inspection sheet or a design."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, get_args

from gearpoly import arguments
from gearpoly.api.words import told_in_python
from gearpoly.errors import OutOfRangeError, shown_value
from gearpoly.files import mounts as known
from gearpoly.files import pair_from as source_file
from gearpoly.files.gde import Side, Turn
from gearpoly.files.new_pair import write_mount, write_new
from gearpoly.files.pair_from import Choices, MadeFiles


@told_in_python()
def new_pair(target: Path | str, *, sheet: Path | str | None = None) -> MadeFiles:
    """Write a commented pair file that runs as it stands, as ``gearpoly pair --new`` does, and an empty inspection
    ``sheet`` that it reads. Raises ``InputFileError`` where either is there already."""
    arguments.check_file("target", target)
    if sheet is not None:
        arguments.check_file("sheet", sheet)
    return write_new(Path(target), None if sheet is None else Path(sheet))


def mounts() -> tuple[str, ...]:
    """Names of the telescope mounts whose gears are known."""
    return tuple(name for mount in known.mounts() for name in mount.names)


@told_in_python()
def pair_of_mount(name: str, target: Path | str) -> MadeFiles:
    """Write the gears and the worm of a telescope mount, as ``gearpoly pair --mount`` does. Raises ``InputFileError``
    that lists the nearest names, and where ``target`` is there already."""
    if not isinstance(name, str):
        raise OutOfRangeError(f'name {shown_value(name)}: want the name of a mount, such as "EQ6"')
    arguments.check_file("target", target)
    return write_mount(name, Path(target))


@told_in_python()
def pair_from(
    source: Path | str,
    target: Path | str,
    *,
    which: Literal["driving", "driven"] | None = None,
    flank: Side | None = None,
    count: Turn | None = None,
    map: Path | str | None = None,
    stage: int | None = None,
) -> MadeFiles:
    """Write what an inspection sheet or a design holds into the pair file ``target``, as ``gearpoly pair --from`` does.

    Of a sheet, ``which`` gear it is of, the ``flank`` that drives, seen on the datum face with the tooth pointing up,
    how it ``count``s teeth and a ``map`` of what it leaves open; of a design its ``stage``. Raises ``InputFileError``,
    asking for what the file does not say.
    """
    arguments.check_file("source", source)
    arguments.check_file("target", target)
    if which is not None:
        arguments.check_choice("which", which, arguments.GEARS)
    if flank is not None:
        arguments.check_choice("flank", flank, get_args(Side))
    if count is not None:
        arguments.check_choice("count", count, get_args(Turn))
    if map is not None:
        arguments.check_file("map", map)
    if stage is not None:
        arguments.STAGE.check("stage", stage)
    layout = None if map is None else Path(map)
    choices = Choices(which=which, drive=flank, count=count, layout=layout, stage=stage)
    return source_file.pair_from(Path(source), Path(target), choices)
