"""Results on disk: written aside and renamed, so that a file is there whole or not at all."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from gearpoly.errors import InputFileError, escaped
from gearpoly.files.paths import is_file, is_folder, look, parted
from gearpoly.files.streams import write_out


def check_target(target: Path) -> None:
    """Raise ``InputFileError`` where ``target`` plainly cannot be written, before long work is done for it; ``-``
    always can."""
    if str(target) == "-":
        return
    if not is_folder(target.parent):
        raise InputFileError(
            target,
            found=f"there is no folder {target.parent}",
            wish="make it, or write somewhere else",
        )
    if is_folder(target):
        raise InputFileError(target, found="this is a folder", wish="want the name of a file")
    if look(target) is not None and not is_file(target):
        raise InputFileError(target, found="this is no file but a device or pipe", wish="want the name of a file, or -")
    if not os.access(target.parent, os.W_OK):
        raise InputFileError(target, found="the folder is read-only", wish="want a folder that can be written to")


def check_targets(targets: Iterable[Path | None], *, inputs: Iterable[Path]) -> None:
    """``check_target`` for all ``targets`` of a command that are asked for (not None); raise ``InputFileError`` too
    where one is a file that the command reads, or two are the same file or both standard output."""
    read = {
        one.resolve() for one, _ in map(parted, inputs) if look(one) is not None
    }  # what is not there is told by who reads it
    taken: set[Path] = set()
    for target in targets:
        if target is None:
            continue
        check_target(target)
        place = target if str(target) == "-" else target.resolve()
        if place in read:
            raise InputFileError(target, found="this is what is read", wish="write to another file")
        if place in taken:
            raise InputFileError(target, found="two results are to go there", wish="give each a place of its own")
        taken.add(place)


def check_folder(target: Path) -> None:
    """Raise ``InputFileError`` where ``target`` is no folder and cannot become one."""
    if look(target) is None:
        check_target(target)
    elif not is_folder(target):
        raise InputFileError(target, found="this is a file", wish="want the name of a folder")
    elif not os.access(target, os.W_OK):
        raise InputFileError(target, found="the folder is read-only", wish="want a folder that can be written to")


@contextmanager
def written_aside(target: Path) -> Iterator[Path]:
    """A temporary path beside ``target`` that replaces it on success and vanishes on any error.

    The temporary file keeps the target's ending, since writers choose their format by it. Raises ``InputFileError``
    where the folder is missing or cannot be written to.
    """
    check_target(target)
    # A link stays, and what it leads to is replaced.
    target = target.resolve()
    try:
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=".gearpoly-", suffix=target.suffix)
    except OSError as error:
        raise InputFileError(
            target, found=error.strerror or str(error), wish="want a folder that can be written to"
        ) from None
    os.close(handle)
    aside = Path(name)
    try:
        yield aside
        # mkstemp makes private files; a result gets what the user's umask gives any new file.
        umask = os.umask(0)
        os.umask(umask)
        aside.chmod(0o666 & ~umask)
        aside.replace(target)
    except OSError as error:
        raise InputFileError(
            target,
            found=error.strerror or str(error),
            wish="could not be written; check space and rights",
        ) from None
    finally:
        aside.unlink(missing_ok=True)


def write_text(target: Path | str, text: str) -> None:
    """Write ``text`` to ``target``, or to standard output where that is ``-``."""
    if str(target) == "-":
        write_out(text if text.endswith("\n") else text + "\n")
        return
    with written_aside(Path(target)) as aside:
        # A path that is no UTF-8 may be part of it.
        aside.write_text(text, encoding="utf-8", errors="backslashreplace")


def say_written(target: Path | str | None, what: str) -> None:
    """Say on standard error that ``target`` was written and ``what`` is in it; nothing where it was not asked for
    (None) or was standard output. Standard error, since standard output may hold a result."""
    if target is not None and str(target) != "-":
        print(f"wrote {escaped(str(target))}: {what}", file=sys.stderr, flush=True)
