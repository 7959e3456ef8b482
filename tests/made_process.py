"""Commands in processes of their own that heed interrupts, and what they show on a terminal."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import time
from typing import Any

HEED = "import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_DFL); os.execv(sys.argv[1], sys.argv[1:])"
"""What runs in the background of a shell is deaf to interrupts, and passes that on; a user's command is not."""

PATIENCE = 300.0
"""s. What a command may take to say a word on a crowded machine; no test measures it."""


def begun(*command: object, env: dict[str, str] | None = None, **how: Any) -> subprocess.Popen[str]:
    """Python with the arguments ``command``, as a user's terminal starts it; ``how`` goes to ``Popen``.

    Aborted (SIGABRT), it writes on standard error where each of its threads is.
    """
    # No preexec_fn: between fork and exec it would run beside the locks of threads that are not there any more.
    words = [sys.executable, *map(str, command)]
    changed = os.environ | {"COLUMNS": "200", "PYTHONFAULTHANDLER": "1"} | (env or {})
    return subprocess.Popen([sys.executable, "-c", HEED, *words], text=True, env=changed, **how)


def read_until(terminal: int, words: str | None, *, of: subprocess.Popen[str], patience: float = PATIENCE) -> str:
    """What a process shows on a ``terminal`` until ``words`` come, or (None) until nobody writes to it any more.

    Fails where the words never come, or not within ``patience`` s; then it says where the process was.
    """
    seen = ""
    until = time.monotonic() + patience
    while words is None or words not in seen:
        left = until - time.monotonic()
        if left < 0.0 or not select.select([terminal], [], [], left)[0]:
            of.send_signal(signal.SIGABRT)
            seen += _last(terminal)
            of.wait(PATIENCE)  # or the next test that collects garbage is told of it
            raise AssertionError(f"waited {patience:g} s for {words or 'the end'!r} of\n{seen}")
        more = _read(terminal)
        if not more:
            assert words is None, seen
            break
        seen += more
    return seen


def _last(terminal: int) -> str:
    """What an aborted process still says."""
    said = ""
    while select.select([terminal], [], [], 10.0)[0] and (more := _read(terminal)):
        said += more
    return said


def _read(terminal: int) -> str:
    try:
        return os.read(terminal, 4096).decode(errors="replace")
    except OSError:  # the other end is closed
        return ""
