"""Rows on a Dask cluster that is already there: chunks go out, rows come back, and only this process writes."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any, cast

from gearpoly.errors import GearpolyError, MissingExtraError
from gearpoly.study.local import Chunk
from gearpoly.study.pipeline import MadeRow, make_row
from gearpoly.study.plan import StudyPlan, plan_from, versions

ANSWER = 20.0
"""s. How long a scheduler may take to answer, and then to have a worker. A live one takes milliseconds."""

SILENCE = 600.0
"""s without a chunk finished while no worker is left, after which the cluster is given up."""

CHUNKS_AHEAD_PER_THREAD = 3
"""Chunks per thread of the cluster that are handed out at a time."""

LOOK = 5.0
"""s between looks at whether workers are left."""


def on_cluster(
    plan: StudyPlan, chunks: Iterator[Chunk], *, address: str, silence: float = SILENCE
) -> Iterator[list[MadeRow]]:
    """Rows of all chunks in the order in which they are finished, on the workers of the scheduler at ``address``.

    Chunks of a worker that is lost are done again by others. Raises ``GearpolyError`` where the cluster does not
    answer, has no workers, has other versions, or is lost on the way.
    """
    try:
        from distributed import Client, TimeoutError, as_completed
        from distributed.client import FutureCancelledError
        from distributed.scheduler import KilledWorker
    except ImportError:
        raise MissingExtraError("--scheduler needs Dask; pip install gearpoly[cluster]") from None
    lost = (OSError, TimeoutError, FutureCancelledError)
    try:
        client: Any = cast(Any, Client)(address, timeout=ANSWER, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise GearpolyError(
            f"no Dask scheduler answers at {address} within {ANSWER:g} s ({_first_line(error)}); check the address and "
            "that `dask scheduler` runs there; finished work is kept"
        ) from None
    try:
        try:
            client.wait_for_workers(1, timeout=ANSWER)
        except TimeoutError:
            raise GearpolyError(
                f"the Dask scheduler at {address} has no workers; start some (`dask worker {address}`)"
            ) from None
        yield from _run(client, as_completed, plan, chunks, silence=silence)
    except KilledWorker:
        raise GearpolyError(
            f"workers of the Dask cluster at {address} keep dying (out of memory?); finished work is kept: run again "
            "with fewer threads or more memory per worker"
        ) from None
    except lost as error:
        raise GearpolyError(
            f"the Dask cluster at {address} was lost ({_first_line(error)}); finished work is kept: run again to go on"
        ) from None
    finally:
        client.close(timeout=2.0)


def _first_line(error: BaseException) -> str:
    return (str(error) or type(error).__name__).splitlines()[0]


def _run(
    client: Any, as_completed: Any, plan: StudyPlan, chunks: Iterator[Chunk], *, silence: float
) -> Iterator[list[MadeRow]]:
    from distributed import TimeoutError

    def submit(room: int) -> list[Any]:
        # Not pure: two chunks are never the same, and hashing the plan's text each time is of no use.
        return [client.submit(_make, plan.text, chunk, pure=False, retries=2) for chunk in islice(chunks, room)]

    def room() -> int:
        threads: dict[str, int] = client.nthreads()
        return max(1, CHUNKS_AHEAD_PER_THREAD * sum(threads.values()))

    waiting = submit(room())
    quiet = 0.0
    while waiting:
        finished = as_completed(waiting, timeout=LOOK, loop=client.loop)
        try:
            future = next(finished)
        except TimeoutError:
            quiet = 0.0 if client.nthreads() else quiet + LOOK
            if quiet >= silence:
                raise OSError("no worker is left") from None
            continue
        quiet = 0.0
        waiting = [one for one in waiting if one is not future]
        theirs, rows = future.result()
        future.release()
        mine = plan.versions
        if theirs != mine:
            raise GearpolyError(
                f"a worker of the cluster has {_words(theirs)}, here are {_words(mine)}; the rows would not be the "
                "same: want the same versions everywhere"
            )
        waiting += submit(max(0, room() - len(waiting)))  # fewer workers than before leave no room
        yield rows


def _words(found: dict[str, str]) -> str:
    return ", ".join(f"{name} {version}" for name, version in found.items())


def _make(text: str, chunk: Chunk) -> tuple[dict[str, str], list[MadeRow]]:
    """One chunk on a worker, with the versions that made it."""
    plan = plan_from(text)
    return versions(), [make_row(plan, index) for index in range(*chunk)]
