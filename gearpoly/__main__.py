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
        from gearpoly.errors import GearpolyError, SelfCheckError

        try:
            from gearpoly.files.environment import check_arguments, check_environment
            from gearpoly.files.streams import told_output

            with told_output():
                check_arguments(sys.argv[1:])
                check_environment(os.environ)
                from gearpoly.cli import app

                app()
        except GearpolyError as error:
            _say(str(error))
            raise SystemExit(2) from None
        except MemoryError:
            _say("out of memory; want a smaller recording, fewer positions or fewer workers, or a larger machine")
            raise SystemExit(2) from None
        except SelfCheckError as error:
            _say(f"a check of gearpoly itself failed: {error}")
            raise SystemExit(1) from None
    except (KeyboardInterrupt, SystemExit) as end:
        # What runs commands turns an interrupt into an exit, silently.
        cause: BaseException | None = end
        while cause is not None and not isinstance(cause, KeyboardInterrupt):
            cause = cause.__cause__ or cause.__context__
        if cause is None:
            raise
        with contextlib.suppress(ValueError):  # not the main thread
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # the message is on its way
        _say(f"interrupted; {str(cause) or 'nothing half-written was left behind'}")
        raise SystemExit(INTERRUPTED) from None


def _say(message: str) -> None:
    """A message on standard error, if there is one that takes it."""
    if sys.stderr is not None:
        with contextlib.suppress(OSError, ValueError):
            print(f"gearpoly: {message}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    command()
