"""The proof from end to end: write and seal the cases, diagnose them, and only then open the truths."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy
import scipy

import gearpoly
import gearpoly.proving
from gearpoly.errors import InputFileError, SelfCheckError
from gearpoly.files.output import write_text
from gearpoly.prove import diagnoser as diagnosers
from gearpoly.prove.arms import PLAIN_ARM, Arm, arms
from gearpoly.prove.cases import CaseFiles, case_files, code_of, folder_cases, truth_hashes
from gearpoly.prove.controls import compared, shuffled
from gearpoly.prove.diagnoser import Diagnoser, How
from gearpoly.prove.pool import each
from gearpoly.prove.score import CaseScore, score
from gearpoly.prove.thresholds import Thresholds, read_thresholds
from gearpoly.prove.truth import read_truth
from gearpoly.prove.work import CaseToWrite, Diagnosing, diagnose, result, seconds, write
from gearpoly.proving.grounds import BENCH, GROUNDS
from gearpoly.proving.rig import BenchError
from gearpoly.proving.write import seal

Say = Callable[[str], None]


@dataclass(frozen=True, kw_only=True)
class Proof:
    """A finished proof: ``of`` what, its ``ground`` and ``seed`` ("" and None: a folder of cases), ``quick``; the
    sealed ``truths`` by case and the one ``sealed`` hash over them; the ``scores``; ``controls`` by name; hashes of the
    ``code`` that was put to the proof; the ``limits`` that it was measured by."""

    of: str
    seed: int | None
    quick: bool
    truths: dict[str, str]
    sealed: str
    scores: tuple[CaseScore, ...]
    limits: Thresholds
    code: str
    controls: dict[str, Any] = field(default_factory=dict)
    ground: str = ""


def prove_ground(
    seed: int, *, out: Path, quick: bool = False, workers: int = 1, diagnoser: Diagnoser = diagnosers.gearpoly,
    say: Say = print, indices: Sequence[int] | None = None, ground: str = BENCH,
) -> Proof:  # fmt: skip
    """Prove on a ground of ``seed``, one of ``gearpoly.proving.grounds``; finished work in ``out`` is gone on with.
    ``indices``: some cases only, then without controls.

    Raises ``GearpolyError`` where ``out`` cannot be written or a worker dies, ``SelfCheckError`` where the bench fails
    at a case.
    """
    entries = GROUNDS[ground].plan(seed, quick=quick)
    chosen = list(range(len(entries))) if indices is None else list(indices)
    bench = code_of(Path(gearpoly.proving.__file__).parent)
    for name in ("cases", "truths", "sealed"):
        made_folder(out / name)
    writing = [
        CaseToWrite(
            seed=seed, index=k, quick=quick, folder=out / "cases", truths=out / "truths",
            sealed=out / "sealed" / entries[k].name, code=bench, ground=ground,
        ) for k in chosen
    ]  # fmt: skip
    say(f"{len(chosen)} cases of seed {seed}{', quick' if quick else ''}, in {out}")
    try:
        each(
            write, [job for job in writing if not job.done()], workers=workers, what="cases written",
            name=lambda job: entries[job.index].name,
        )  # fmt: skip
    except BenchError as error:
        raise SelfCheckError(str(error)) from None
    cases = {k: case_files(out / "cases", entries[k].name, truths=out / "truths") for k in chosen}
    extra = [] if quick or indices is not None or ground != BENCH else arms(entries)
    part = "" if indices is None else f", {len(chosen)} of its {len(entries)} cases, without its controls"
    which = "" if ground == BENCH else f"{ground} "
    of = f"{which}ground of seed {seed}{', quick' if quick else ''}{part}"
    return _prove(
        cases,
        extra,
        of=of,
        seed=seed,
        quick=quick,
        out=out,
        workers=workers,
        diagnoser=diagnoser,
        say=say,
        ground=ground,
    )


def prove_folder(
    folder: Path, *, out: Path, workers: int = 1, diagnoser: Diagnoser = diagnosers.gearpoly, say: Say = print
) -> Proof:
    """Prove on cases that somebody else recorded: NAME/pair.toml, NAME/rec_K.csv and NAME.truth.json in ``folder``.

    Raises ``InputFileError`` for a folder that is not laid out so, ``GearpolyError`` as ``prove_ground`` does.
    """
    cases = dict(enumerate(folder_cases(folder)))
    made_folder(out)
    say(f"{len(cases)} cases of {folder}")
    return _prove(
        cases, [], of=str(folder), seed=None, quick=False, out=out, workers=workers, diagnoser=diagnoser, say=say
    )


def made_folder(folder: Path) -> None:
    """Make a folder to work in. Raises ``InputFileError`` where that cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputFileError(folder, found=error.strerror or str(error), wish="want a folder to work in") from None


def _prove(
    cases: dict[int, CaseFiles], extra: list[Arm], *, of: str, seed: int | None, quick: bool, out: Path, workers: int,
    diagnoser: Diagnoser, say: Say, ground: str = "",
) -> Proof:  # fmt: skip
    limits = read_thresholds()
    hashes = truth_hashes(cases.values())
    sealed = seal(hashes)
    listing = "".join(f"{hashes[case.name]}  {case.truth.name}\n" for case in cases.values())
    write_text(out / "truths.sha256", listing)
    say(f"truths sealed: sha256 {sealed} over {len(hashes)} truths, each in {out / 'truths.sha256'}")
    say(f"thresholds: sha256 {limits.sha256}")
    code = code_under_proof(diagnoser)
    plain = _jobs(
        cases, Arm(key=PLAIN_ARM, text="", how=dict.fromkeys(cases, How(hurried=quick))), code, diagnoser, out
    )
    others = {arm.key: _jobs(cases, arm, code, diagnoser, out) for arm in extra}
    every = [*plain, *(job for jobs in others.values() for job in jobs)]
    left = [job for job in every if not job.done()]
    if len(left) < len(every):
        say(f"{len(every) - len(left)} of {len(every)} diagnoses are there from a run before")
    # The whole method first, and the longest first, so that no worker is left alone with them at the end.
    left.sort(key=lambda job: (job.how != How(), -sum(path.stat().st_size for path in job.case.recordings)))
    each(diagnose, left, workers=workers, what="diagnoses", name=lambda job: job.case.name)
    # From here on truths are read. What they were sealed as is what they still have to be.
    if truth_hashes(cases.values()) != hashes:
        raise InputFileError(out, found="a truth changed during the proof", wish="want truths as they were sealed")
    scores = {job.case.name: _scored(job, limits) for job in plain}
    told = {job.case.name: ((result(job.target)["verdict"] or {}).get("missing", [])) for job in plain}
    controls: dict[str, Any] = {"shuffled": shuffled(tuple(scores.values()), told, limits)}
    for arm in extra:
        mine = [_scored(job, limits) for job in others[arm.key]]
        controls[arm.key] = compared(arm.text, mine, [scores[one.name] for one in mine])
    return Proof(
        of=of, seed=seed, quick=quick, truths=hashes, sealed=sealed, scores=tuple(scores.values()), limits=limits,
        code=code, controls=controls, ground=ground,
    )  # fmt: skip


def code_under_proof(diagnoser: Diagnoser) -> str:
    """Hash of everything that a verdict depends on beside its files."""
    sources = code_of(Path(gearpoly.__file__).parent, but=("prove", "proving"))
    return f"{sources[:32]}-{diagnoser.__module__}.{diagnoser.__qualname__}-{numpy.__version__}-{scipy.__version__}"


def _jobs(cases: dict[int, CaseFiles], arm: Arm, code: str, diagnoser: Diagnoser, out: Path) -> list[Diagnosing]:
    place = out / "verdicts" / arm.key
    made_folder(place)
    return [
        Diagnosing(
            case=cases[k], how=how, code=code, diagnoser=diagnoser, target=place / f"{cases[k].name}.json"
        ) for k, how in sorted(arm.how.items())
    ]  # fmt: skip


def _scored(job: Diagnosing, limits: Thresholds) -> CaseScore:
    found = result(job.target)
    truth = read_truth(job.case.truth, pair=job.case.pair)
    return score(
        job.case.name,
        found["verdict"],
        truth,
        limits,
        seconds=seconds(job.target),
        error=found["error"],
        failure=found.get("failure", ""),
    )
