"""What lies at a path: one question to the system, whose every refusal is a message."""

from __future__ import annotations

import errno
import os
import re
import stat
from pathlib import Path

from gearpoly.errors import InputFileError

_NOTHING = {errno.ENOENT, errno.ENOTDIR}
_CURES = {
    errno.ELOOP: "want a path whose links lead to a file; these lead round in a circle",
    errno.ENAMETOOLONG: "want a shorter name; most systems end at 255 bytes",
}


def look(path: Path) -> os.stat_result | None:
    """What the system says of the file or folder at ``path``, links followed; ``None`` where there is nothing.

    Raises ``InputFileError`` for a loop of links, a name that is too long or holds a null byte, and where it may not be
    looked at.
    """
    try:
        return path.stat()
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path
        if getattr(error, "errno", None) in _NOTHING:
            return None
        raise unreadable(path, error) from None


def unreadable(path: Path, error: Exception) -> InputFileError:
    """The error for a file that the operating system does not let us read."""
    reason = getattr(error, "strerror", None) or str(error)
    wish = _CURES.get(getattr(error, "errno", None) or 0, "want a file that can be opened")
    return InputFileError(path, found=f"cannot be read ({reason})", wish=wish)


def is_folder(path: Path) -> bool:
    """Whether there is a folder at ``path``; raises as ``look`` does."""
    found = look(path)
    return found is not None and stat.S_ISDIR(found.st_mode)


def is_file(path: Path) -> bool:
    """Whether there is an ordinary file at ``path``, no pipe and no device; raises as ``look`` does."""
    found = look(path)
    return found is not None and stat.S_ISREG(found.st_mode)


def parted(path: Path) -> tuple[Path, int | None]:
    """A file and which of its recordings is asked for, counted from 1: ``log.txt#2``; a file of that very name is
    itself."""
    named = re.fullmatch(r"(.+)#(\d{1,6})", path.name)
    if named is None or is_file(path):
        return path, None
    return path.with_name(named[1]), int(named[2])
