"""All rows of a study: what is missing is handed out, what comes back is kept, until the end or until it is enough."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearpoly.errors import GearpolyError, InputFileError, OutOfRangeError
from gearpoly.study.causes import causes
from gearpoly.study.cluster import on_cluster
from gearpoly.study.keys import with_values
from gearpoly.study.local import Chunk, in_processes, in_this_process
from gearpoly.study.pipeline import REFUSED, MadeRow
from gearpoly.study.plan import StudyPlan, plan_of
from gearpoly.study.progress import Progress
from gearpoly.study.read import Study, check_pair
from gearpoly.study.stop import enough, looks
from gearpoly.study.store import Store, opened, write_manifest

HOPELESS = 32
"""Rows, and every combination once at least, after which a study ends that has refused all of them. If a tenth of the
pairs could be drawn, 32 refusals in a row would come about once in thirty studies (0.9^32 = 0.034); a yield of less
than a tenth of the draws says nothing of a workshop's gears. Fewer end a study that could run, more let an impossible
one go on: a refused gear takes as long as 400 that are drawn."""


@dataclass(frozen=True, kw_only=True)
class Outcome:
    """A finished study: its ``store``, ``rows`` in all, how many were ``made`` now, in how many ``seconds``, and why it
    ended ("all rows", or what was known)."""

    store: Store
    rows: int
    made: int
    seconds: float
    why: str


def plan_study(study: Study) -> StudyPlan:
    """The plan of ``study``, every end of every sweep tried. Raises ``InputFileError`` for a pair that is none."""
    plan = plan_of(study)
    try:
        plan.design.combinations  # noqa: B018 - asked for what it raises: too many are refused here
        corners = plan.design.corners()
    except OutOfRangeError as error:
        raise InputFileError(study.path, where="sweep", wish=str(error)) from None
    for values in corners:
        where = ", ".join(f"{key} = {value}" for key, value in values.items())
        file = check_pair(
            with_values(study.raw, values), blame=study.path, where=f"pair with {where}" if where else "pair"
        )
        for gear in ("driving", "driven"):
            inspection = getattr(file, gear).inspection
            if values and inspection is not None and any(key == f"{gear}.grade" for key in values):
                raise InputFileError(
                    study.path, where=f"sweep {gear}.grade", found=f"{gear}.inspection in the pair file",
                    wish="want no grade swept for an inspected gear, of which nothing is drawn",
                )  # fmt: skip
    return plan


def run_study(
    study: Study,
    *,
    out: Path,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Outcome:
    """Make the rows of ``study`` that ``out`` lacks, by ``workers`` processes or on the cluster at ``scheduler``.

    Raises ``InputFileError`` where ``out`` holds rows of another study or where the first rows are all refused (then
    ``out`` is emptied again), ``GearpolyError`` where workers or disk fail; finished chunks are on disk by then.
    """
    plan = plan_study(study)
    begun = time.monotonic()
    with opened(out, plan) as store:
        target, cuts = plan.design.rows, looks(plan.file, plan.design.combinations)
        _refuse_fewer(study, plan, store)
        write_manifest(store, rows=target, finished=False, why="")
        done = store.done()
        there = _rows_of(done, target)
        watch = progress or Progress(total=target, done=there)
        watch.begin(total=target, done=there)
        made = 0
        chunks = plan.chunks(rows=target, done=done, cuts=cuts)
        why = "all rows"
        last_look = 0
        stop = _enough_at(store, plan, cuts, last_look)
        first = min(target, max(HOPELESS, plan.design.combinations))
        hopeless = _none_drawn(store, first)
        if stop is None:
            with watch:
                for rows in _computed(plan, chunks, workers=workers, scheduler=scheduler):
                    store.write(rows)
                    made += len(rows)
                    watch.advance(len(rows))
                    hopeless = hopeless and all(row.status == REFUSED for row in rows if row.index < first)
                    if hopeless and _front(store.done()) >= first:
                        break
                    front = _front(store.done()) if cuts else 0
                    reached = [cut for cut in cuts if last_look < cut <= front]
                    if reached:
                        stop = _enough_at(store, plan, reached, last_look)
                        last_look = reached[-1]
                        if stop is not None:
                            break
        if hopeless:
            raise _refusal(study, store, first)
        if stop is not None and plan.file.until is not None:
            until = plan.file.until
            why = f"percentile {until.percentile:g} of {until.output} is known to {until.width:g} after {stop} rows"
            target = stop
        store.trim(target)
        _check_complete(store, target)
        write_manifest(store, rows=target, finished=True, why=why)
    return Outcome(store=store, rows=target, made=made, seconds=time.monotonic() - begun, why=why)


def _refuse_fewer(study: Study, plan: StudyPlan, store: Store) -> None:
    """Raise ``InputFileError`` where a study without an end of its own asks for fewer rows than there are."""
    kept = _front(store.done())
    if plan.file.until is None and kept > plan.design.rows:
        raise InputFileError(
            study.path, where="pairs", found=f"{plan.file.pairs}, fewer rows than the {kept} in {store.folder}",
            wish="want as many pairs or more, or another --out",
        )  # fmt: skip


def _none_drawn(store: Store, first: int) -> bool:
    """Whether every one of the ``first`` rows that is there was refused."""
    found = store.columns(["index", "status"])
    return bool(np.all(found["status"][found["index"] < first] == REFUSED))


def _refusal(study: Study, store: Store, first: int) -> InputFileError:
    """Why nothing can come of ``study``, in one message. A table of refusals is of no use, so its folder is emptied for
    the study as it will be when mended."""
    cause, *others = causes(store, rows=first)
    share = "" if not others else f", {cause.pairs} of them for this cause"
    every = "the only pair is" if first == 1 else f"all of the first {first} pairs are"
    store.clear()
    return InputFileError(study.path, where="pair", found=f"{every} refused{share}; {cause.example}", wish=cause.reason)


def _computed(
    plan: StudyPlan, chunks: Iterator[Chunk], *, workers: int, scheduler: str | None
) -> Iterator[list[MadeRow]]:
    if scheduler is not None:
        return on_cluster(plan, chunks, address=scheduler)
    if workers == 1:
        return in_this_process(plan, chunks)
    return in_processes(plan, chunks, workers=workers)


def _rows_of(done: list[tuple[int, int]], target: int) -> int:
    return sum(max(0, min(stop, target) - start) for start, stop in done)


def _front(done: list[tuple[int, int]]) -> int:
    """Rows that are there without a gap, from the first on."""
    front = 0
    for start, stop in done:
        if start > front:
            break
        front = max(front, stop)
    return front


def _enough_at(store: Store, plan: StudyPlan, cuts: list[int], looked: int) -> int | None:
    """The first of ``cuts`` at which it is enough, of those that the rows on disk have reached."""
    if plan.file.until is None:
        return None
    front = _front(store.done())
    return next((cut for cut in cuts if looked < cut <= front and enough(store, plan.file.until, cut)), None)


def _check_complete(store: Store, target: int) -> None:
    """Every row once: what a reader of the table relies on."""
    at = 0
    for start, stop in store.done():
        if start != at:
            raise GearpolyError(
                f"{store.folder}: rows {min(at, start)} to {max(at, start)} are missing or doubled; run again"
            )
        at = stop
    if at != target:
        raise GearpolyError(f"{store.folder}: {at} rows of {target} are there; run again to go on")
