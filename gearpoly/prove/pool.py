"""Jobs on this machine: in this process, or in others that are started afresh (spawn)."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context
from typing import TypeVar

from gearpoly.errors import GearpolyError
from gearpoly.study.local import _begin, _SingleThreaded

Job = TypeVar("Job")


def each(work: Callable[[Job], None], jobs: Sequence[Job], *, workers: int, what: str) -> None:
    """Do all ``jobs``, which write what they find; a bar on standard error where that is a terminal.

    Raises ``GearpolyError`` where a worker dies; what was written stays.
    """
    if not jobs:
        return
    with _bar(len(jobs), what) as advance:
        if workers == 1:
            for job in jobs:
                work(job)
                advance()
            return
        pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=_begin)
        try:
            with _SingleThreaded():
                for future in as_completed([pool.submit(work, job) for job in jobs]):
                    future.result()
                    advance()
        except BrokenProcessPool:
            raise GearpolyError(
                "a worker process died (out of memory?); finished cases are kept: run again with fewer --workers"
            ) from None
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _bar(total: int, what: str) -> Iterator[Callable[[], None]]:
    if not sys.stderr.isatty():
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda: bar.advance(task)
