"""How far long work is, how fast, and how long it will take: a bar for people, a line now and then for logs."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, Self

EVERY = 30.0
"""s between lines where standard error is no terminal."""


class Progress:
    """Counts rows, or what else ``command`` makes; prints to standard error."""

    def __init__(self, *, total: int = 0, done: int = 0, command: str = "study", noun: str = "pairs") -> None:
        self._command, self._noun, self._note = command, noun, ""
        self.begin(total=total, done=done)
        self._bar: Any = None
        self._task: Any = None

    def begin(self, *, total: int, done: int) -> None:
        """Start at ``done`` of ``total`` rows."""
        self.total, self.done, self._first = total, done, done
        self._begun = self._said = time.monotonic()

    @property
    def rate(self) -> float:
        """Rows per second since the beginning of this run."""
        return (self.done - self._first) / max(time.monotonic() - self._begun, 1e-9)

    @property
    def left(self) -> float:
        """Seconds that the rest takes at this rate; infinite before the first row."""
        return (self.total - self.done) / self.rate if self.rate > 0.0 else float("inf")

    def words(self) -> str:
        """The state in words."""
        left = f", {span(self.left)} left" if self.left < float("inf") else ""
        return f"{self.done} of {self.total} {self._noun}, {self.rate:.3g} {self._noun}/s{left}{self._note}"

    def __enter__(self) -> Self:
        if sys.stderr.isatty():
            from rich.progress import BarColumn, TextColumn
            from rich.progress import Progress as Bar

            from gearpoly.report.terminal import Terminal

            self._bar = Bar(
                BarColumn(),
                TextColumn("{task.description}", markup=False),
                console=Terminal(stderr=True),
                transient=True,
            )
            self._bar.start()
            self._task = self._bar.add_task(self.words(), total=self.total, completed=self.done)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def advance(self, rows: int, *, note: str = "") -> None:
        """So many rows more are kept; a note on what takes long."""
        self.done += rows
        self._note = f"; {note}" if note else ""
        if self._bar is not None:
            self._bar.update(self._task, completed=self.done, description=self.words())
        elif time.monotonic() - self._said > EVERY:
            self._said = time.monotonic()
            print(f"gearpoly {self._command}: {self.words()}", file=sys.stderr, flush=True)


def span(seconds: float) -> str:
    """A time in s in words."""
    whole = round(seconds)
    if whole < 120:
        return f"{whole} s"
    return f"{whole // 60} min" if whole < 7200 else f"{whole / 3600:.1f} h"
