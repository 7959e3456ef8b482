"""Rows on this machine: in this process, or in others that are started afresh (spawn), of which any may die."""

from __future__ import annotations

import os
import signal
import sys
import threading
import warnings
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from itertools import islice
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.process import BaseProcess

from gearpoly.errors import GearpolyError
from gearpoly.study.pipeline import MadeRow, make_row
from gearpoly.study.plan import StudyPlan, plan_from

CHUNKS_AHEAD_PER_WORKER = 3
"""Chunks per worker that are handed out: none waits for the next, and memory does not grow with the study."""

BREAKS = 3
"""Times in a row that workers may die without one chunk done before the fault is taken to be in the work."""

Chunk = tuple[int, int]

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def in_this_process(plan: StudyPlan, chunks: Iterator[Chunk]) -> Iterator[list[MadeRow]]:
    """Rows of all chunks, one after the other."""
    for start, stop in chunks:
        yield [make_row(plan, index) for index in range(start, stop)]


def in_processes(plan: StudyPlan, chunks: Iterator[Chunk], *, workers: int) -> Iterator[list[MadeRow]]:
    """Rows of all chunks in the order in which they are finished, by ``workers`` processes.

    Where a worker dies, its chunks are done again by others. Raises ``GearpolyError`` where they keep dying.
    """
    left: list[Chunk] = []
    breaks = 0
    while True:
        under_way: dict[Future[list[MadeRow]], Chunk] = {}
        others = set(active_children())
        pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=begin_worker)
        try:
            with SingleThreaded():
                while True:
                    room = CHUNKS_AHEAD_PER_WORKER * workers - len(under_way)
                    for chunk in [left.pop(0) for _ in range(min(room, len(left)))] or list(islice(chunks, room)):
                        with interrupts_held():
                            under_way[pool.submit(_make, plan.text, chunk)] = chunk
                    if not under_way:
                        return
                    for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                        rows = future.result()
                        del under_way[future]
                        breaks = 0
                        yield rows
        except BrokenProcessPool:
            breaks += 1
            if breaks >= BREAKS:
                raise GearpolyError(
                    "worker processes keep dying (out of memory?); finished work is kept: run again with fewer "
                    "--workers"
                ) from None
            left = sorted(under_way.values()) + left
        except (KeyboardInterrupt, GeneratorExit):
            end_workers(besides=others)
            raise
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


class SingleThreaded:
    """Workers inherit one thread each: as many processes as cores already keep them busy."""

    def __enter__(self) -> None:
        self._before = {name: os.environ.get(name) for name in _THREADS}
        os.environ.update(dict.fromkeys(_THREADS, "1"))

    def __exit__(self, *_: object) -> None:
        for name, value in self._before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@contextmanager
def interrupts_held() -> Iterator[None]:
    """While processes are started, which happens as work is submitted, an interrupt waits: they inherit that, so that
    it goes to their parent alone from their first instruction on, not only once ``begin_worker`` runs."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_workers(*, besides: set[BaseProcess]) -> None:
    """End all worker processes but those that were there before: nobody waits for what is under way."""
    for child in set(active_children()) - besides:
        child.terminate()


def begin_worker() -> None:
    """A worker leaves interrupts to its parent, and ends when its parent does, however that was killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # What a library warns of in a worker is no more for the user than what it warns of in the parent.
    if not sys.flags.dev_mode:
        warnings.simplefilter("ignore")
    parent = parent_process()
    if parent is not None:

        def watch() -> None:
            parent.join()
            os._exit(1)

        threading.Thread(target=watch, daemon=True).start()


def _make(text: str, chunk: Chunk) -> list[MadeRow]:
    plan = plan_from(text)
    return [make_row(plan, index) for index in range(*chunk)]
