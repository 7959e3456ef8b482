"""A verdict beside what a careful expert could know from the same data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gearpoly.prove.match import acceptable, at_place, names, on_tooth, reported_set
from gearpoly.prove.thresholds import Thresholds
from gearpoly.prove.truth import WRONG_FILE, Item, Truth
from gearpoly.prove.wanted import to_be_located, to_be_named

FAILURES = {"refused": "refused where it should have worked", "time_out": "time-outs", "traceback": "tracebacks"}
"""How a diagnosis can end without a verdict."""


@dataclass(frozen=True, kw_only=True)
class Expert:
    """``false_names``: claims that stand for nothing that may be named; ``named``: of what could be named, tooth
    included; ``located``: of the places that could be known; ``silent``: nothing said where something could be known;
    ``said``: of a wrong file, whether that was said (None: it cannot be known); ``failure``: one of ``FAILURES``, or
    none."""

    false_names: int
    named: tuple[bool, ...]
    located: tuple[bool, ...]
    silent: bool
    said: bool | None
    failure: str


def expert(verdict: dict[str, Any], truth: Truth, limits: Thresholds, *, error: str, failure: str) -> Expert:
    """What became of a case, asked of the verdict (empty where the diagnosis failed with an ``error``)."""
    claims = verdict["missing"]
    # The truth itself is never false; it knows its tooth's encoder reading, of which a list of names has the number.
    allowed = (*(truth.may_name or ()), *(i for i in truth.items if i.physics))
    must_name, must_locate = to_be_named(truth, limits), to_be_located(truth, limits)
    something = bool(claims or verdict.get("unexplained") or error)
    wrong = truth.kind == WRONG_FILE
    words = " ".join((error, *map(str, verdict.get("remarks", ())))).lower()
    refused_rightly = wrong and failure == "refused"
    return Expert(
        false_names=sum(not any(_may(claim, item, limits) for item in allowed) for claim in claims),
        named=tuple(any(_right(claim, item, limits) for claim in claims) for item in must_name),
        located=tuple(at_place(verdict, place, truth, limits) for place in must_locate),
        silent=bool(must_name or must_locate) and not something,
        said=(failure != "traceback" and any(word in words for word in truth.says)) if truth.says else None,
        failure="" if refused_rightly else failure,
    )


def _right(claim: dict[str, Any], item: Item, limits: Thresholds) -> bool:
    return names(claim, item) and on_tooth(claim, item, limits, claim=claim)


def _may(claim: dict[str, Any], item: Item, limits: Thresholds) -> bool:
    if "tooth" in claim and claim["tooth"] is None and claim.get("encoder_deg") is None and names(claim, item):
        return True  # it says that some tooth of the gear has it, not which
    within = any(names(one, item) and on_tooth(one, item, limits, claim=claim) for one in reported_set(claim))
    return within or acceptable(claim, item, limits)
