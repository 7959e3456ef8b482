"""The ``gearpoly`` command: parse, call, print. Exit code 0 done, 2 bad input, 1 a bug, 130 interrupted."""

from __future__ import annotations

import contextlib
import os
import sys

INTERRUPTED = 130


def command() -> None:
    """``main`` as a process: it ends with an interrupt, whatever threads are at work on what nobody waits for."""
    try:
        main()
    except SystemExit as end:
        if end.code != INTERRUPTED:
            raise
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError, ValueError):  # a closed pipe, a closed stream
                stream.flush()
        os._exit(INTERRUPTED)


def main() -> None:
    """Run the command line; turn a user's errors into one message and exit code 2."""
    try:
        from gearpoly.cli import app
        from gearpoly.errors import GearpolyError, SelfCheckError

        try:
            app()
        except GearpolyError as error:
            print(f"gearpoly: {error}", file=sys.stderr)
            raise SystemExit(2) from None
        except SelfCheckError as error:
            print(f"gearpoly: a check of gearpoly itself failed: {error}", file=sys.stderr)
            raise SystemExit(1) from None
    except (KeyboardInterrupt, SystemExit) as end:
        # What runs commands turns an interrupt into an exit, silently.
        cause: BaseException | None = end
        while cause is not None and not isinstance(cause, KeyboardInterrupt):
            cause = cause.__cause__ or cause.__context__
        if cause is None:
            raise
        print(f"gearpoly: interrupted; {str(cause) or 'nothing half-written was left behind'}", file=sys.stderr)
        raise SystemExit(INTERRUPTED) from None


if __name__ == "__main__":
    command()
