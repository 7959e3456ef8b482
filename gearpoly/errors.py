"""Every error that gearpoly raises on purpose, under one root.

A message names what was found and what would do. The command line prints it and exits 2; anything
that is not a ``GearpolyError`` is a bug and exits 1, a ``SelfCheckError`` among them.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class GearpolyError(Exception):
    """Root of all errors that a user can cure."""


class OutOfRangeError(GearpolyError, ValueError):
    """A quantity lies outside the range in which its formula or standard holds."""


class GeometryError(GearpolyError, ValueError):
    """Such a gear cannot be cut, or such a pair cannot be mounted."""


class JammedError(GearpolyError):
    """The teeth leave no backlash at some position, so the gears cannot turn."""


class NotConvergedError(GearpolyError):
    """A search ended without a certified answer; nothing uncertified leaves the kernel."""


class NoGearPassesError(GearpolyError):
    """No drawn gear stays within its limits, so the limits contradict one another."""


class MissingExtraError(GearpolyError, ImportError):
    """An optional package is not installed; the message says which extra brings it."""


class SelfCheckError(Exception):
    """Two ways to the same answer disagree, so one of them is at fault: a bug that no user can cure."""

    def __init__(self, found: str) -> None:
        super().__init__(
            f"{found}. This is a fault in gearpoly, not in your files. Please report it: send this message, the "
            "command line, the pair file with the files that it names, and the recordings"
        )


class InputFileError(GearpolyError, ValueError):
    """A file breaks a rule of its format.

    ``where`` is the key (``driving.teeth``) or the line (``line 12``); ``found`` is what stands there, ``wish`` what
    would do. ``str()`` gives the one message that a user sees.
    """

    def __init__(self, file: Path | str, *, where: str = "", found: str = "", wish: str) -> None:
        self.file = str(file)
        self.where = where
        self.found = found
        self.wish = wish
        place = f"{self.file}: {where}" if where else self.file
        super().__init__(f"{place}: {found}; {wish}" if found else f"{place}: {wish}")


@contextmanager
def blamed(file: Path | str, where: str) -> Iterator[None]:
    """Turn an error of geometry, limits or contact into one that names the file and the section it came from."""
    try:
        yield
    except InputFileError:
        raise
    except GearpolyError as error:
        raise InputFileError(file, where=where, wish=str(error)) from None
