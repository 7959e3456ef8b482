"""The ``gearpoly`` command: parse, call, print. Exit code 0 done, 2 bad input, 1 a bug, 130 interrupted."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command line; turn a user's errors into one message and exit code 2."""
    from gearpoly.cli import app
    from gearpoly.errors import GearpolyError

    try:
        app()
    except GearpolyError as error:
        print(f"gearpoly: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    except KeyboardInterrupt:
        print("gearpoly: interrupted; nothing half-written was left behind", file=sys.stderr)
        raise SystemExit(130) from None


if __name__ == "__main__":
    main()
