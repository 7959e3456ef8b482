"""What workers do: write one case, diagnose one case. Each result is a file that is there whole or not at all."""

from __future__ import annotations

import json
import signal
import threading
import time
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from gearpoly.errors import GearpolyError, InputFileError
from gearpoly.files.output import write_text
from gearpoly.prove.cases import CaseFiles, digest, truth_hash
from gearpoly.prove.diagnoser import Diagnoser, How

LONGEST_DIAGNOSIS_S, LONGEST_HURRIED_DIAGNOSIS_S = 120.0, 60.0
"""Processor seconds after which a diagnosis counts as one without an answer, and the same of one that is to be quick:
nobody waits longer for a verdict than two minutes."""


class TooLongError(Exception):
    """A diagnosis that does not come to an end."""


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Raise ``TooLongError`` once so much processor time is spent; without a limit where the system has no such
    timer, or outside the main thread."""
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def end(number: int, frame: object) -> None:
        raise TooLongError(f"not done after {seconds:g} s of processor time")

    before = signal.signal(signal.SIGPROF, end)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@dataclass(frozen=True, kw_only=True)
class CaseToWrite:
    """A case of a ground to be written under ``folder``, its truth under ``truths``, its hash to ``sealed``."""

    seed: int
    index: int
    quick: bool
    folder: Path
    truths: Path
    sealed: Path
    code: str
    ground: str

    def done(self) -> bool:
        """Whether it was written by this very bench, and its truth is as it was sealed then."""
        name = self.sealed.name
        truth, pair = self.truths / f"{name}.truth.json", self.folder / name / "pair.toml"
        if not (self.sealed.is_file() and truth.is_file() and pair.is_file()):
            return False
        return self.sealed.read_text(encoding="utf-8").split() == [truth_hash(truth), self.code]


def write(job: CaseToWrite) -> None:
    """Write the case; its hash comes last, so that a killed run writes it again. Raises ``InputFileError`` where the
    folder cannot be written to."""
    from gearpoly.proving.write import write_case

    try:
        sha256 = write_case(job.seed, job.index, job.folder, truths=job.truths, quick=job.quick, ground=job.ground)
    except OSError as error:
        raise InputFileError(
            job.folder, found=error.strerror or str(error), wish="could not be written; check space and rights"
        ) from None
    write_text(job.sealed, f"{sha256} {job.code}\n")


@dataclass(frozen=True, kw_only=True)
class Diagnosing:
    """A case to be diagnosed, in the way ``how``, by code of this hash, with the result at ``target``."""

    case: CaseFiles
    how: How
    code: str
    diagnoser: Diagnoser
    target: Path

    def key(self) -> str:
        """What the result depends on: the files given, the way and the code."""
        given = digest((self.case.pair, *self.case.recordings))
        return f"{given} {self.code} {json.dumps(asdict(self.how))}"

    def done(self) -> bool:
        """Whether the result is there."""
        return result(self.target).get("key") == self.key()


def diagnose(job: Diagnosing) -> None:
    """Diagnose the case without a look at its truth; the time goes beside the result, which is the same every time."""
    begun = time.process_time()
    verdict, error, failure = None, "", ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with limited(LONGEST_HURRIED_DIAGNOSIS_S if job.how.hurried else LONGEST_DIAGNOSIS_S):
                verdict = job.diagnoser(job.case.pair, job.case.recordings, job.how)
        except Exception as caught:  # a failed case counts against the diagnosis and must not stop the proof
            last = traceback.extract_tb(caught.__traceback__)[-1]
            error = f"{type(caught).__name__}: {caught}"
            failure = "refused" if isinstance(caught, GearpolyError) else "traceback"
            if isinstance(caught, TooLongError):
                failure = "time_out"
            if not isinstance(caught, TooLongError):
                error += f" ({Path(last.filename).name}, {last.name})"
            error = error.replace(f"{job.case.pair.parent}/", "").replace(str(job.case.pair.parent), job.case.name)
    spent = time.process_time() - begun
    write_text(job.target.with_suffix(".seconds"), f"{spent:.3f}\n")
    write_text(
        job.target,
        json.dumps({"key": job.key(), "error": error, "failure": failure, "verdict": verdict}, indent=1) + "\n",
    )


def result(target: Path) -> dict[str, Any]:
    """A written result; empty where there is none."""
    if not target.is_file():
        return {}
    try:
        found = json.loads(target.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) and {"key", "error", "verdict"} <= found.keys() else {}


def seconds(target: Path) -> float | None:
    """Processor seconds that a result took."""
    path = target.with_suffix(".seconds")
    try:
        return float(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
