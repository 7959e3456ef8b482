"""A pair file to begin with: a commented one to fill in, or that of a telescope mount that is known."""

from __future__ import annotations

import os
from pathlib import Path

from gearpoly.errors import InputFileError
from gearpoly.files.mounts import find_mount, mount_text
from gearpoly.files.output import check_targets, write_text
from gearpoly.files.pair_from import MadeFiles
from gearpoly.files.paths import look
from gearpoly.files.sheet_csv import sheet_text
from gearpoly.files.template import TEMPLATE_TEETH, pair_template


def write_new(target: Path, sheet: Path | None = None) -> MadeFiles:
    """Write a commented pair file that runs as it stands, and an empty inspection sheet that it reads.

    Raises ``InputFileError`` where either is there already or cannot be written.
    """
    _check_new(target, sheet)
    beside = None if sheet is None else Path(os.path.relpath(sheet.resolve(), target.resolve().parent)).as_posix()
    files = []
    if sheet is not None:
        write_text(sheet, sheet_text(TEMPLATE_TEETH))
        files.append((sheet, "an inspection sheet to fill in, one row per tooth"))
    write_text(target, pair_template(sheet=beside))
    files.append((target, "a pair file to fill in; gearpoly simulate reads it as it stands"))
    return MadeFiles(files=tuple(files), says=())


def write_mount(name: str, target: Path | None) -> MadeFiles:
    """Write gears and worm of the mount of that ``name``.

    Raises ``InputFileError`` for an unknown name, and where ``target`` is missing, there already or cannot be written.
    """
    mount = find_mount(name)
    if target is None:
        raise InputFileError("--mount", found=f"{name} without a file", wish=f"want --mount {name} PAIR.toml")
    _check_new(target)
    write_text(target, mount_text(mount))
    ready = "gearpoly compare reads it as it stands" if mount.driving else "state the teeth of its transfer gears"
    return MadeFiles(files=((target, f"{mount.maker} {mount.names[0]}; {ready}"),), says=())


def _check_new(*targets: Path | None) -> None:
    """Refuse what exists, and standard output: what is written is there to be filled in."""
    check_targets(targets, inputs=[])
    for target in targets:
        if target is not None and str(target) == "-":
            raise InputFileError(target, found="standard output", wish="want the name of a file")
        if target is not None and look(target) is not None:
            wish = "want a new name, since what was filled in would be lost"
            raise InputFileError(target, found="this file exists", wish=wish)
