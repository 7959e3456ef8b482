"""Every error that gearpoly raises on purpose, under one root.

A message names what was found and what would do. The command line prints it and exits 2; anything
that is not a ``GearpolyError`` is a bug and exits 1, a ``SelfCheckError`` among them. Whatever a file or a command
line holds passes through ``shown`` before it is part of a message.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

CHARACTERS_SHOWN = 60
"""Characters of a value that a message shows: enough to find it again, and two of them fit a line."""

PATH_SHOWN = 240
"""Characters of a path that a message shows; its middle gives way, since its ends say which file it is."""

MESSAGE_SHOWN = 1600
"""Characters of a whole message: the longest of gearpoly's own lists every key or output that would do."""


def shown(text: str, *, width: int = CHARACTERS_SHOWN) -> str:
    """``text`` from outside as one short line that is safe to print, at most ``width`` characters long.

    Control characters, escape sequences, line ends, invisible characters and bytes that are no UTF-8 become their
    escapes (``\\x1b``); where it is too long the middle is left out. Shown text is shown unchanged.
    """
    head = width * 2 // 3
    # What cannot be shown need not be escaped: a value may be as large as its file.
    text = text if len(text) <= width else f"{text[:width]}{text[-width:]}"
    line = escaped(text)
    return line if len(line) <= width else f"{line[:head]}...{line[len(line) - (width - head - 3) :]}"


def escaped(text: str) -> str:
    """``text`` with escapes in the place of all characters that do not print."""
    return text if text.isprintable() else "".join(map(_printable, text))


def _printable(character: str) -> str:
    if character.isprintable():
        return character
    if "\udc80" <= character <= "\udcff":  # a byte of a file name that is no UTF-8
        return f"\\x{ord(character) - 0xDC00:02x}"
    return character.encode("unicode_escape").decode("ascii")


def shown_value(value: object) -> str:
    """A value of a file as the file has it, short and safe to print."""
    if isinstance(value, str):
        return f'"{shown(value)}"'
    try:
        return shown(str(value).lower() if isinstance(value, bool) else str(value))
    except (ValueError, RecursionError):  # an integer with more digits than Python prints, tables within tables
        return "a huge value"


def told_beside(value: float, limit: float, decimals: int) -> str:
    """``value`` with as many decimals, or as few more as it takes to be seen on its side of the ``limit`` that it
    breaks: 0.998 is no 1.00 where at least 1 is wanted."""
    for more in range(decimals, decimals + 16):
        text = f"{value:.{more}f}"
        if (float(text) > limit) == (value > limit) and (float(text) < limit) == (value < limit):
            return text
    return repr(value)


def told_at_most(limit: float, decimals: int) -> str:
    """The ``limit`` rounded down: what is told as a cure has to be one."""
    # Not by a product, which may round up to the next whole number.
    text = f"{limit:.{decimals}f}"
    return text if float(text) <= limit else f"{float(text) - 10.0**-decimals:.{decimals}f}"


class GearpolyError(Exception):
    """Root of all errors that a user can cure; its message is one line, safe to print."""

    def __init__(self, message: str = "") -> None:
        super().__init__(shown(message, width=MESSAGE_SHOWN))


class OutOfRangeError(GearpolyError, ValueError):
    """A quantity lies outside the range in which its formula or standard holds."""


class GeometryError(GearpolyError, ValueError):
    """Such a gear cannot be cut, or such a pair cannot be mounted."""


class JammedError(GearpolyError):
    """The teeth leave no backlash at some position, so the gears cannot turn."""


class NoContactError(GeometryError):
    """At some position no teeth touch, so the driven gear turns freely there."""


class NotConvergedError(GearpolyError):
    """A search ended without a certified answer; nothing uncertified leaves the kernel."""


class NoGearPassesError(GearpolyError):
    """No drawn gear stays within its limits, so the limits contradict one another."""


class MissingExtraError(GearpolyError, ImportError):
    """An optional package is not installed; the message says which extra brings it."""


class PluginError(GearpolyError):
    """What another installed package brings does not load, is no physics, reader or exporter, or failed at its work."""


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
    would do. ``str()`` gives the one message that a user sees, each part of it short.
    """

    def __init__(self, file: Path | str, *, where: str = "", found: str = "", wish: str) -> None:
        self.file = shown(str(file), width=PATH_SHOWN)
        self.where = shown(where, width=PATH_SHOWN)
        self.found = shown(found, width=MESSAGE_SHOWN // 4)
        self.wish = shown(wish, width=MESSAGE_SHOWN // 2)
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
