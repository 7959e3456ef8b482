"""The ``gearpoly`` command: parse, call, print. Exit code 0 done, 2 bad input, 1 a bug, 130 interrupted."""

from __future__ import annotations

import contextlib
import os
import signal
import sys

INTERRUPTED = 130


def command() -> None:
    """``main`` as a process: it ends with an interrupt, whatever threads are at work on what nobody waits for.

    What libraries warn of (an overflow, a cache that cannot be written) would stand before the one message.
    """
    try:
        import logging
        import warnings

        logging.disable(logging.WARNING)
        if not sys.flags.dev_mode:
            warnings.simplefilter("ignore")
        main()
    except SystemExit as end:
        if end.code != INTERRUPTED:
            raise
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError, ValueError, AttributeError):  # a closed pipe, a closed stream, none
                stream.flush()
        os._exit(INTERRUPTED)


def main() -> None:
    """Run the command line; turn a user's errors into one message and exit code 2."""
    try:
        from gearpoly.files.environment import check_arguments, check_environment
        from gearpoly.files.streams import told_output

        with told_output():
            check_arguments(sys.argv[1:])
            check_environment(os.environ)
            from gearpoly.cli import app

            app()
    except BaseException as end:
        code = _told(end)
        if code is None:
            raise
        raise SystemExit(code) from None


def _told(end: BaseException) -> int | None:
    """Say in one message why a command ended, and return its exit code; None where there is no message for it."""
    interrupt = _interrupt_behind(end)
    if interrupt is not None:
        with contextlib.suppress(ValueError):  # not the main thread
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # the message is on its way
        _say(f"interrupted; {str(interrupt) or 'nothing half-written was left behind'}")
        return INTERRUPTED
    from gearpoly.errors import GearpolyError, SelfCheckError

    if isinstance(end, GearpolyError):
        _say(str(end))
        return 2
    if isinstance(end, MemoryError):
        _say("out of memory; want a smaller recording, fewer positions or fewer workers, or a larger machine")
        return 2
    if isinstance(end, SelfCheckError):
        _say(f"a check of gearpoly itself failed: {end}")
        return 1
    return None


def _interrupt_behind(end: BaseException) -> KeyboardInterrupt | None:
    """The interrupt that made an error or an exit, if one did.

    What runs commands turns an interrupt into an exit, silently. One that arrives while a lock is taken or given back
    leaves that lock's own error in its place.
    """
    cause: BaseException | None = end
    while cause is not None and not isinstance(cause, KeyboardInterrupt):
        cause = cause.__cause__ or cause.__context__
    return cause


def _say(message: str) -> None:
    """A message on standard error, if there is one that takes it."""
    if sys.stderr is not None:
        with contextlib.suppress(OSError, ValueError):
            print(f"gearpoly: {message}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    command()
