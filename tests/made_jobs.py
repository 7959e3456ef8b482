"""Jobs for processes that start afresh: each imports this module, and nothing slow with it."""

from __future__ import annotations

import time

from gearpoly.errors import InputFileError


def nap(seconds: float) -> None:
    """A job that takes its time."""
    time.sleep(seconds)


def refuse(what: str) -> None:
    """A job that a full disk stops."""
    raise InputFileError("verdict.json", found="No space left on device", wish=what)
