"""A progress bar on standard error for people, nothing for pipes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress

LEAST_WATCHED = 4000
"""Positions below which a run is over before a bar could be read."""


@contextmanager
def watched(total: int, what: str) -> Iterator[Callable[[int], None]]:
    """A function to call with each count of finished positions; it draws a bar where standard error is a terminal."""
    if total < LEAST_WATCHED or not sys.stderr.isatty():
        yield lambda done: None
        return
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    from gearpoly.report.terminal import Terminal

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Terminal(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda done: bar.advance(task, done)


class StageProgress:
    """What is done next, and how many stages are behind; nothing shows where standard error is no terminal."""

    def __init__(self, bar: Progress | None = None) -> None:
        self._bar, self._task = bar, bar.add_task("", total=None) if bar is not None else None

    def __call__(self, what: str) -> None:
        """Say what is done next."""
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, description=f"{what} ...")

    def reached(self, done: int, of: int) -> None:
        """So many stages are ``done`` ``of`` all."""
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, completed=done, total=of)


@contextmanager
def steps() -> Iterator[StageProgress]:
    """A function to call with what is done next; it shows on standard error where that is a terminal, with a bar of
    the stages where somebody counts them."""
    if not sys.stderr.isatty():
        yield StageProgress()
        return
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    from gearpoly.report.terminal import Terminal

    columns = (
        SpinnerColumn(),
        BarColumn(bar_width=24),
        TimeElapsedColumn(),
        TextColumn("{task.description}", markup=False),
    )
    with Progress(*columns, console=Terminal(stderr=True), transient=True) as bar:
        yield StageProgress(bar)
