"""The same work for many things at once: compiled and vectorised work lets go of the interpreter."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import lru_cache
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

TICK_S = 1.0
"""Seconds after which a wait is begun anew: one without an end misses an interrupt that comes as it begins (2 of 4 runs
of its test on a loaded machine). A user waits a second at most, and a wait anew costs microseconds."""

_at = threading.local()


def each(work: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
    """What ``work`` makes of every item, in their order; the first error of all is raised."""
    listed = list(items)
    if len(listed) < 2 or threads() < 2 or getattr(_at, "work", False):
        return [work(item) for item in listed]
    futures = [_pool().submit(_marked, work, item) for item in listed]
    try:
        return [_waited_for(future) for future in futures]
    finally:
        for future in futures:
            future.cancel()


def _waited_for(future: Future[Result]) -> Result:
    while True:
        try:
            return future.result(timeout=TICK_S)
        except TimeoutError:
            if future.done():  # an error of the work itself, or done since
                return future.result()


def _marked(work: Callable[[Item], Result], item: Item) -> Result:
    """Work in a thread of the pool, which must not wait for the pool."""
    _at.work = True
    try:
        return work(item)
    finally:
        _at.work = False


def threads() -> int:
    """As many as there are cores; fewer where NUMBA_NUM_THREADS says so, as in processes that share the work."""
    allowed = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    wanted = os.environ.get("NUMBA_NUM_THREADS", "")
    return max(1, min(allowed, int(wanted))) if wanted.isdigit() else allowed


@lru_cache(maxsize=1)
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads(), thread_name_prefix="gearpoly")
