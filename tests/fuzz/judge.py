"""What every fuzzed input has to end in: a result, or a refusal that is one short safe line, within bounds."""

from __future__ import annotations

import os
import resource
import signal
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TypeVar

from hypothesis import HealthCheck, settings

from gearpoly.errors import MESSAGE_SHOWN, GearpolyError

Result = TypeVar("Result")

WANTED = int(os.environ.get("GEARPOLY_FUZZ") or 0)
"""Inputs of each fuzzer that the environment asks for; 0: a short run, the same every time."""

SHORT = 60
"""Inputs of each fuzzer in a short run: a second or so."""

BOUND = 20
"""s of processor time in which every input of up to 10 MB is read or refused: what the documentation promises."""

FUZZ = settings(
    max_examples=WANTED or SHORT,
    derandomize=not WANTED,
    database=None,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
"""Settings of a fuzzer. What fails is printed with the input that hypothesis could not make smaller."""


@dataclass
class Tally:
    """What became of the inputs of one kind: their number, how many were ``refused``, and the ``slowest`` in s."""

    inputs: int = 0
    refused: int = 0
    slowest: float = 0.0


TALLIES: dict[str, Tally] = {}


def judged(kind: str, work: Callable[[], Result]) -> Result | None:
    """What ``work`` makes of an input, or None where it is refused as it should be; any other end fails the test."""
    tally = TALLIES.setdefault(kind, Tally())
    tally.inputs += 1
    begun = time.process_time()
    try:
        with bounded(), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # as the command does
            return work()
    except GearpolyError as error:
        tally.refused += 1
        message = str(error)
        assert message
        assert message.isprintable(), "one line that acts on no terminal"
        assert len(message) <= MESSAGE_SHOWN
        return None
    finally:
        tally.slowest = max(tally.slowest, time.process_time() - begun)


@contextmanager
def bounded() -> Iterator[None]:
    """Raises ``TimeoutError`` in work that takes more than ``BOUND`` s of processor time."""

    def over(*_: object) -> None:
        raise TimeoutError(f"more than {BOUND} s of processor time")

    before = signal.signal(signal.SIGVTALRM, over)
    signal.setitimer(signal.ITIMER_VIRTUAL, BOUND)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def table() -> list[str]:
    """The tallies as rows of a table, with the peak of memory of the whole run."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    rows = ["| inputs of | number | refused | slowest / s |", "| --- | --- | --- | --- |"]
    rows += [f"| {kind} | {one.inputs} | {one.refused} | {one.slowest:.2f} |" for kind, one in sorted(TALLIES.items())]
    return [*rows, f"peak of memory {peak:.0f} MB"]
