"""Real recordings, on which nobody knows the truth: what an expert's judgement lets be named, and wants located."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.errors import GearpolyError, InputFileError
from gearpoly.files.pairfile import read_pair
from gearpoly.files.paths import is_folder
from gearpoly.prove import diagnoser as diagnosers
from gearpoly.prove import reliability
from gearpoly.prove.diagnoser import Diagnoser, How
from gearpoly.prove.expert import FAILURES
from gearpoly.prove.judgement import ENDING, Judgement, PlaceWanted, read_judgement
from gearpoly.prove.match import reported_set
from gearpoly.prove.pool import each
from gearpoly.prove.reliability import NAME, StatedChances, bins, claimed
from gearpoly.prove.run import code_under_proof, made_folder
from gearpoly.prove.statistics import quantile, share
from gearpoly.prove.thresholds import read_thresholds
from gearpoly.prove.work import Diagnosing, diagnose, result, seconds
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray

HALF_WIDTH = 0.5
"""Line widths (1 over the turns that were recorded) by which a line may be off."""


@dataclass(frozen=True, kw_only=True)
class RealScore:
    """How a verdict stands beside its judgement: ``named`` all that was named, ``false`` those that may not be;
    ``located`` and ``lost`` of the places wanted; rms in um of unseen data before and after, where a verdict was
    reached; ``error`` where none was, and how it ``failure`` ended; processor ``seconds``; ``stated``: the chances of
    names, right where the judgement lets them stand."""

    name: str
    control: bool
    named: tuple[str, ...] = ()
    false: tuple[str, ...] = ()
    located: tuple[str, ...] = ()
    lost: tuple[str, ...] = ()
    unseen_um: tuple[float, float] | None = None
    error: str = ""
    failure: str = ""
    seconds: float | None = None
    stated: StatedChances = field(default_factory=StatedChances)

    @property
    def ratio(self) -> float | None:
        """Rms of unseen data after over before."""
        return None if self.unseen_um is None or not self.unseen_um[0] else self.unseen_um[1] / self.unseen_um[0]

    @property
    def rises(self) -> bool:
        """Whether unseen data fit worse with what was named."""
        return bool(self.named) and self.unseen_um is not None and self.unseen_um[1] > self.unseen_um[0]


@dataclass(frozen=True, kw_only=True)
class PeriodsAt:
    """What lies between a place and its frequency: teeth of both gears, turns of the driven shaft that were recorded,
    and seconds per turn (None: no time)."""

    z_1: int
    z_2: int
    turns: float
    seconds: float | None

    def per_turn(self, place: dict[str, Any]) -> float | None:
        """Cycles per turn of the driven shaft of an entry of the verdict, or of a place; None where it is no line."""
        order, hz = place.get("order"), place.get("hz")
        if order is None:
            return None if self.seconds is None or hz is None else float(hz * self.seconds)
        if place["kind"] == "mesh_order":
            return float(order * self.z_2)
        return float(order * (self.z_2 / self.z_1 if place.get("gear") == "driving" else 1.0))


def span_of(recordings: list[Recording], *, z_1: int, z_2: int) -> PeriodsAt:
    """Turns and seconds of the longest of some recordings."""
    best = PeriodsAt(z_1=z_1, z_2=z_2, turns=0.0, seconds=None)
    for one in recordings:
        driven = one.driven_angle_rad
        turns = _turns(driven) if driven is not None else _turns(one.driving_angle_rad) * z_1 / z_2
        if turns > best.turns:
            time = None if one.time_s is None else float(np.nanmax(one.time_s) - np.nanmin(one.time_s)) / turns
            best = PeriodsAt(z_1=z_1, z_2=z_2, turns=turns, seconds=time)
    return best


def _turns(angle: FloatArray | None) -> float:
    if angle is None:
        return 0.0
    held = angle[np.isfinite(angle)]
    return float(np.ptp(np.unwrap(held))) / (2.0 * math.pi)


def score(judgement: Judgement, verdict: dict[str, Any] | None, span: PeriodsAt, *, error: str = "", failure: str = "",
          seconds: float | None = None) -> RealScore:  # fmt: skip
    """How a ``verdict`` (None: none was reached, for the reason ``error``) stands beside a judgement."""
    wanted = {place.label: place for place in judgement.must_locate}
    if verdict is None:
        return RealScore(
            name=judgement.case.name, control=judgement.control, lost=tuple(wanted), error=error, failure=failure,
            seconds=seconds,
        )  # fmt: skip
    missing = verdict["missing"]
    allowed = judgement.may_name
    false = [one for one in missing if not any(_names(one, *may) for may in allowed)]
    entries = [*verdict["where"], *verdict["unexplained"]]
    found = [label for label, place in wanted.items() if any(_is_at(one, place, span) for one in entries)]
    unseen = verdict["fit"]["heldout_rms_um"]
    return RealScore(
        name=judgement.case.name,
        control=judgement.control,
        named=tuple(map(_label, missing)),
        false=tuple(map(_label, false)),
        located=tuple(found),
        lost=tuple(label for label in wanted if label not in found),
        unseen_um=(unseen["before"], unseen["after"]),
        seconds=seconds,
        stated=reliability.joined(claimed(one, _allowed(one, allowed)) for one in missing),
    )


def _allowed(claim: dict[str, Any], allowed: tuple[tuple[str, str | None], ...]) -> list[bool]:
    """Which of a claim, its rivals and the unknown a judgement lets stand: the unknown where it lets none of the
    others, since who may not name the cause does not know it."""
    rights = [any(_names(one, *may) for may in allowed) for one in reported_set(claim)]
    return [*rights, not any(rights)]


def _names(entry: dict[str, Any], physics: str, gear: str | None) -> bool:
    return entry["physics"] == physics and gear in (None, entry.get("gear"))


def _label(entry: dict[str, Any]) -> str:
    words = [entry["physics"], entry.get("gear"), f"tooth {entry['tooth']}" if entry.get("tooth") is not None else None]
    return " ".join(word for word in words if word)


def _is_at(entry: dict[str, Any], place: PlaceWanted, span: PeriodsAt) -> bool:
    """Whether an entry of the verdict lies at a place, by whichever shaft it is told, and is as large."""
    there, here = span.per_turn(asdict(place)), span.per_turn(entry)
    if there is None or here is None or abs(here - there) > HALF_WIDTH / max(span.turns, 1e-9):
        return False
    size = entry.get("amplitude_um")
    if place.amplitude_um is None or size is None:
        return place.amplitude_um is None
    return bool(abs(size - place.amplitude_um) <= place.tolerance * place.amplitude_um)


def prove_real(
    folder: Path, *, out: Path, workers: int = 1, diagnoser: Diagnoser = diagnosers.gearpoly,
    say: Callable[[str], None] = print,
) -> tuple[tuple[RealScore, ...], tuple[str, ...]]:  # fmt: skip
    """Diagnose every judged recording of ``folder``, and score it; also what of the folder could not be read, a message
    each. Raises ``InputFileError`` for a folder without judgements."""
    if not is_folder(folder):
        raise InputFileError(folder, found="there is no such folder", wish="want a folder with judgements")
    paths = sorted(folder.glob(f"*{ENDING}"))
    if not paths:
        wish = f"want NAME{ENDING} beside the recordings (docs/reference/cases.md says what is in it)"
        raise InputFileError(folder, found="no judgement", wish=wish)
    wrong: list[str] = []
    judged: list[tuple[Judgement, PeriodsAt]] = []
    for path in paths:
        try:
            one = read_judgement(path)
            file = read_pair(one.case.pair)
            read = [read_recording(recording, worm=file.worm) for recording in one.case.recordings]
            judged.append((one, span_of(read, z_1=file.driving.teeth, z_2=file.driven.teeth)))
        except GearpolyError as error:
            wrong.append(str(error))
    place = out / "verdicts"
    made_folder(place)
    say(f"{len(judged)} judged recordings of {folder}")
    code = code_under_proof(diagnoser)
    jobs = [
        Diagnosing(case=one.case, how=How(), code=code, diagnoser=diagnoser, target=place / f"{one.case.name}.json")
        for one, _ in judged
    ]
    each(diagnose, [job for job in jobs if not job.done()], workers=workers, what="diagnoses",
         name=lambda job: job.case.name)  # fmt: skip
    scores = []
    for (one, span), job in zip(judged, jobs, strict=True):
        found = result(job.target)
        failure, spent = found.get("failure", ""), seconds(job.target)
        scores.append(score(one, found["verdict"], span, error=found["error"], failure=failure, seconds=spent))
    return tuple(scores), tuple(wrong)


def real_json(scores: tuple[RealScore, ...]) -> dict[str, Any]:
    """The scores and their sums, for JSON."""
    limits = read_thresholds()
    stated = reliability.joined(one.stated for one in scores)
    ratios = [one.ratio for one in scores if one.ratio is not None]
    spent = [one.seconds for one in scores if one.seconds is not None]
    return {
        "recordings": [asdict(one) for one in scores],
        "false_names": sum(len(one.false) for one in scores),
        "controls": sum(one.control for one in scores),
        "controls_named": sum(one.control and bool(one.named) for one in scores),
        "located": sum(len(one.located) for one in scores),
        "to_be_located": sum(len(one.located) + len(one.lost) for one in scores),
        "no_verdict": sum(bool(one.error) for one in scores),
        **{key: sum(one.failure == key for one in scores) for key in FAILURES},
        "unseen_rises": sum(one.rises for one in scores),
        "unseen_rises_where_named": share([one.rises for one in scores if one.named]).to_json(),
        "unseen_ratio": {"median": quantile(ratios, 0.5), "q95": quantile(ratios, 0.95), "recordings": len(ratios)},
        "seconds": {"median": quantile(spent, 0.5), "q95": quantile(spent, 0.95), "all": sum(spent)},
        "reliability": {
            NAME: bins(stated.forecasts, limits.bins), **reliability.log_score(stated.true, limits),
        },
    }  # fmt: skip
