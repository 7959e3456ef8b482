"""A pair file from what an owner has: an inspection sheet of one gear, or a design of both."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.gde import Side, Turn
from gearpoly.files.inspection.into_pair import read_target, stated, write_gear
from gearpoly.files.inspection.measured import Which, translated
from gearpoly.files.inspection.read import read_sheet
from gearpoly.files.inspection.sheet_map import read_map
from gearpoly.files.output import check_targets
from gearpoly.files.paths import unreadable
from gearpoly.files.rexs.into_pair import write_design
from gearpoly.files.rexs.source import is_design
from gearpoly.files.traces import FILE_LIMIT_BYTES, check_file

DESIGN_START_BYTES = 512
"""Bytes that tell what a file is."""


@dataclass(frozen=True, kw_only=True)
class Choices:
    """What a user says beside the file: which gear, its drive flank, the direction of counting, a map, a stage."""

    which: Which | None = None
    drive: Side | None = None
    count: Turn | None = None
    layout: Path | None = None
    stage: int | None = None


@dataclass(frozen=True, kw_only=True)
class MadeFiles:
    """Files that were written, with what is in them, and what was taken for what or is still open."""

    files: tuple[tuple[Path, str], ...]
    says: tuple[str, ...]


def pair_from(source: Path, target: Path, choices: Choices) -> MadeFiles:
    """Write what ``source`` holds into the pair file ``target``.

    Raises ``InputFileError`` for a file that cannot be read, and asking for what it does not say.
    """
    check_targets([target], inputs=[source, *([choices.layout] if choices.layout is not None else [])])
    check_file(source, limit_bytes=FILE_LIMIT_BYTES)
    if str(target) == "-":
        raise InputFileError(target, found="standard output", wish="want the name of a pair file")
    try:
        with source.open("rb") as stream:
            start = stream.read(DESIGN_START_BYTES)
    except OSError as error:
        raise unreadable(source, error) from None
    if is_design(source, start):
        for option, value in (("--flank", choices.drive), ("--count", choices.count), ("--map", choices.layout)):
            if value is not None:
                raise InputFileError(
                    source, found=f"a design, and {option}", wish=f"leave {option} out: designs need none"
                )
        says = write_design(source, target, stage=choices.stage, first=choices.which)
        return MadeFiles(files=((target, f"a pair file with the design of {source.name}"),), says=tuple(says))
    if choices.stage is not None:
        raise InputFileError(source, found="no REXS design, and --stage", wish="leave --stage out, or name a design")
    which, drive = choices.which, choices.drive
    if which is None:
        raise InputFileError(source, found="the inspection of one gear", wish="say which: --as driving or --as driven")
    if drive is None:
        wish = (
            "say --flank left or --flank right: seen on the datum face, left drives where the driving gear turns "
            "counter-clockwise, and the driven one clockwise"
        )
        raise InputFileError(source, found="it does not say which flank drives", wish=wish)
    layout, aim = read_map(choices.layout), read_target(target, which=which)
    sheet = read_sheet(source, start, layout=layout, known=stated(aim, which), count=choices.count)
    keys = translated(sheet, which=which, drive=drive)
    written, open_ = write_gear(aim, sheet, keys, which=which)
    drives = f"the {drive} flank is the drive flank of the {which} gear"
    return MadeFiles(
        files=tuple(
            (one, f"the {which} gear's " + ("inspection" if one == target else "measured profiles")) for one in written
        ),
        says=(drives, *keys.says, *open_),
    )
