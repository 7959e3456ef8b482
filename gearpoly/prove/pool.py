"""Jobs on this machine: in this process, or in others that are started afresh (spawn), of which any may die."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import active_children, get_context
from typing import TypeVar

from gearpoly.errors import GearpolyError
from gearpoly.study.local import SingleThreaded, begin_worker, end_workers, interrupts_held
from gearpoly.study.progress import Progress, span

Job = TypeVar("Job")

LOOK_EVERY = 1.0
"""s between looks at what is under way."""

SLOW_JOB = 60.0
"""s after which a job is named in the progress: longer than nearly all take."""


def each(
    work: Callable[[Job], None], jobs: Sequence[Job], *, workers: int, what: str, name: Callable[[Job], str]
) -> None:
    """Do all ``jobs``, which write what they find, and show on standard error how many of ``what`` are done.

    Raises ``GearpolyError`` where a worker dies, with the names of what was under way. What was written stays, and an
    interrupt does not wait for what is under way.
    """
    if not jobs:
        return
    try:
        with Progress(total=len(jobs), command="prove", noun=what) as progress:
            if workers == 1:
                for job in jobs:
                    work(job)
                    progress.advance(1)
            else:
                _in_processes(work, jobs, workers=workers, name=name, progress=progress)
    except KeyboardInterrupt:
        raise KeyboardInterrupt("what is finished is kept: run the same again to go on") from None


def _in_processes(
    work: Callable[[Job], None], jobs: Sequence[Job], *, workers: int, name: Callable[[Job], str], progress: Progress
) -> None:
    others = set(active_children())
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=begin_worker)
    left, under_way = deque(jobs), dict[Future[str], tuple[str, float]]()
    try:
        with SingleThreaded():
            while left or under_way:
                while left and len(under_way) < workers:
                    job = left.popleft()
                    with interrupts_held():
                        under_way[pool.submit(_told, work, job)] = (name(job), time.monotonic())
                done = wait(under_way, timeout=LOOK_EVERY, return_when=FIRST_COMPLETED).done
                for future in done:
                    wrong = future.result()
                    if wrong:
                        raise GearpolyError(wrong)
                    del under_way[future]
                progress.advance(len(done), note=_slow(under_way.values()))
    except BrokenProcessPool:
        names = " or ".join(sorted(one for one, _ in under_way.values()))
        raise GearpolyError(
            f"a worker process died at {names} (killed, or out of memory?); what is finished is kept: "
            "run the same again, perhaps with fewer --workers"
        ) from None
    except BaseException:
        # An interrupt, or a fault of the work itself.
        end_workers(besides=others)
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _told(work: Callable[[Job], None], job: Job) -> str:
    """Do a job; what is wrong comes back as text, since not every error can be sent between processes."""
    try:
        work(job)
    except GearpolyError as error:
        return str(error)
    return ""


def _slow(under_way: Iterable[tuple[str, float]]) -> str:
    now = time.monotonic()
    return ", ".join(f"{one} for {span(now - begun)}" for one, begun in under_way if now - begun > SLOW_JOB)
