"""Standard output that may fail: a pipe that nobody reads, a full disk, no output at all."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
from collections.abc import Iterator
from typing import Any, TextIO

from gearpoly.errors import GearpolyError, InputFileError


class _Told:
    """A text stream whose failure to write is an ``InputFileError``; all else is as the stream's own."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        with _failure_told(self._stream):
            return self._stream.write(text)

    def flush(self) -> None:
        with _failure_told(self._stream):
            self._stream.flush()


@contextlib.contextmanager
def _failure_told(stream: TextIO) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        # What is left in the buffer must not fail once more at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        raise _unwritable(error) from None


def _unwritable(error: OSError) -> InputFileError:
    found = error.strerror or str(error)
    return InputFileError("standard output", found=found, wish="write to a file, or read to the end")


@contextlib.contextmanager
def told_output() -> Iterator[None]:
    """While it lasts, standard output that cannot be written to raises ``InputFileError``, at the latest at the end.

    Characters that the terminal's encoding lacks are written as their escapes. Without a standard output (a shell's
    ``>&-``) only what is asked for with ``-`` fails.
    """
    before = sys.stdout
    for stream in (sys.stdout, sys.stderr):
        if stream is not None and hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    if before is None:
        yield
        return
    told = _Told(before)
    sys.stdout = told
    try:
        yield
        told.flush()
    except SystemExit as end:
        if not end.code:
            told.flush()
        raise
    except GearpolyError:
        # What was printed before the error comes first; the error that is told is the first one.
        with contextlib.suppress(GearpolyError):
            told.flush()
        raise
    finally:
        sys.stdout = before


def write_out(text: str) -> None:
    """Write ``text`` to standard output; raises ``InputFileError`` where that fails or there is none."""
    if sys.stdout is None:
        raise _unwritable(OSError(errno.EBADF, os.strerror(errno.EBADF)))
    with _failure_told(sys.stdout):
        sys.stdout.write(text)
        sys.stdout.flush()
