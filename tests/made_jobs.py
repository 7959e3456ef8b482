"""Jobs for processes that start afresh: each imports this module, and nothing slow with it."""

from __future__ import annotations

import os
import signal
import time

from gearpoly.errors import InputFileError


def nap(seconds: float) -> None:
    """A job that takes its time."""
    time.sleep(seconds)


def die(name: str) -> None:
    """A job whose process is killed, if that is its name; the other takes an hour."""
    if name == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(3600.0)


def refuse(what: str) -> None:
    """A job that a full disk stops."""
    raise InputFileError("verdict.json", found="No space left on device", wish=what)
