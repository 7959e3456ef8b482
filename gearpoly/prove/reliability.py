"""How often a stated chance is right, and the log score of what was true."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from gearpoly.prove.match import MESH, at_place, names, on_tooth, order_of, reported_set, stands_at
from gearpoly.prove.statistics import share
from gearpoly.prove.thresholds import Thresholds
from gearpoly.prove.truth import WRONG_FILE, Item, Truth
from gearpoly.prove.wanted import place_of
from gearpoly.proving.physics import PHYSICS_BY_NAME

Entry = dict[str, Any]

NAME, PLACE = "names", "places"
"""What a chance is stated of: that this is the cause, or that something is there."""

SLOW_KINDS = ("course", "step")
"""Kinds of place that have no order and no tooth."""

COURSE_KINDS = ("drift", "step", "condition")
WHERE = {
    "mesh": (*MESH, "condition"), "course": COURSE_KINDS, "step": COURSE_KINDS, "jump": COURSE_KINDS,
    "other": (*MESH, *COURSE_KINDS),
}  # fmt: skip
"""Kinds of entries that are right of a place without order and tooth, of a physics and of a stranger. To be located any
entry is enough there; a chance is right only where the entry is."""


@dataclass(frozen=True, kw_only=True)
class Forecast:
    """A ``stated`` chance, of a name or of a place (``of``), and whether that was ``right``."""

    of: str
    stated: float
    right: bool


@dataclass(frozen=True, kw_only=True)
class StatedChances:
    """The ``forecasts`` of a verdict, and for each of its entries the chance that was stated of what was ``true``."""

    forecasts: tuple[Forecast, ...] = ()
    true: tuple[float, ...] = ()


def stated(verdict: Entry, truth: Truth, limits: Thresholds) -> StatedChances:
    """Every chance that a verdict states, beside the truth. An entry without any is passed over, and so is every place
    beside a file that says what is not so: its truth is no list of places, and the recording differs everywhere."""
    places = () if truth.kind == WRONG_FILE else verdict.get("unexplained", ())
    return joined(
        (
            *(claimed(one, _rights(one, truth, limits)) for one in verdict["missing"]),
            *(_left(one, truth, limits) for one in places),
        )
    )


def joined(parts: Iterable[StatedChances]) -> StatedChances:
    """Some verdicts, or entries of one, as one."""
    every = tuple(parts)
    return StatedChances(
        forecasts=tuple(one for part in every for one in part.forecasts),
        true=tuple(one for part in every for one in part.true),
    )


def chances(claim: Entry) -> tuple[float, ...]:
    """The chances that an entry of ``missing`` states of itself, of its rivals in order, and of the unknown; none where
    it states none.

    An entry without ``probability`` has a ``p_value``: its chance is one less that, shared equally among the name and
    its rivals."""
    entries = reported_set(claim)
    if claim.get("probability") is not None:
        own = [float(one.get("probability") or 0.0) for one in entries]
        return (*own, float(claim.get("unknown_probability") or 0.0))
    if claim.get("p_value") is not None:
        return (*[(1.0 - float(claim["p_value"])) / len(entries)] * len(entries), 0.0)
    return ()


def claimed(claim: Entry, rights: Sequence[bool]) -> StatedChances:
    """One entry of ``missing``, of which ``rights`` says what of it is true: the name, its rivals in order, the
    unknown. What was true is the first of these; if none is, the rest of the probability."""
    found = chances(claim)
    if not found:
        return StatedChances()
    forecasts = [Forecast(of=NAME, stated=p, right=right) for p, right in zip(found, rights, strict=True) if p > 0.0]
    true = next((p for p, right in zip(found, rights, strict=True) if right), max(1.0 - sum(found), 0.0))
    return StatedChances(forecasts=tuple(forecasts), true=(true,))


def _rights(claim: Entry, truth: Truth, limits: Thresholds) -> list[bool]:
    effects = [item for item in truth.items if item.physics]
    rights = [
        any(names(one, item) and on_tooth(one, item, limits, claim=claim) for item in effects)
        for one in reported_set(claim)
    ]
    return [*rights, not any(rights) and _unknown_there(claim, truth, limits)]


def _unknown_there(claim: Entry, truth: Truth, limits: Thresholds) -> bool:
    """Whether something that has no name is where a claim is."""
    place = PHYSICS_BY_NAME[claim["physics"]].place if claim["physics"] in PHYSICS_BY_NAME else ""
    there = {"kind": "shaft_order", "gear": claim.get("gear"), "order": order_of(claim) or 1.0}
    for item in _nameless(truth):
        slow = item.order is None and item.hz is None
        if (place in SLOW_KINDS) if slow else (place == "wave" and stands_at(there, item, truth, limits)):
            return True
    return False


def _nameless(truth: Truth) -> Iterator[Item]:
    yield from (item for item in truth.items if not item.physics)
    yield from truth.background


def _left(entry: Entry, truth: Truth, limits: Thresholds) -> StatedChances:
    """One entry of ``unexplained``: the chance that it is there (one less its ``p_value`` where it states none), and
    those of the physics that it could be. What was true is the first of these that is, else the rest of the chance that
    it is there; of a place where nothing is, the rest to 1."""
    there = entry.get("probability")
    if there is None and entry.get("p_value") is not None:
        there = 1.0 - float(entry["p_value"])
    if there is None:
        return StatedChances()
    may = [one for one in entry.get("could_be", ()) if one.get("probability")]
    effects = [item for item in truth.items if item.physics]
    rights = [
        any(names(one, item) and on_tooth(one, item, limits, claim=entry) for item in effects) for one in may
    ]  # fmt: skip
    found = [float(one["probability"]) for one in may]
    right = any(rights) or _something_there(entry, truth, limits)
    rest = max(there - sum(found), 0.0) if right else 1.0 - there
    true = next((p for p, good in zip(found, rights, strict=True) if good), rest)
    names_ = [Forecast(of=NAME, stated=p, right=good) for p, good in zip(found, rights, strict=True)]
    return StatedChances(forecasts=(*names_, Forecast(of=PLACE, stated=there, right=right)), true=(true,))


def _something_there(entry: Entry, truth: Truth, limits: Thresholds) -> bool:
    alone = {"missing": [], "unexplained": [entry]}
    for item in (*truth.items, *truth.background):
        place = _slow_place(item)
        if place:
            if entry["kind"] in WHERE[place] or _of_all_meshes(entry, place, truth):
                return True
        elif at_place(alone, place_of(item), truth, limits):
            return True
    return False


def _slow_place(item: Item) -> str:
    """The key in ``WHERE`` of what has neither order nor tooth; empty for all else."""
    if item.physics:
        place = PHYSICS_BY_NAME[item.physics].place if item.physics in PHYSICS_BY_NAME else ""
        return place if place in WHERE else ""
    if item.order is not None or item.hz is not None:
        return ""
    return "jump" if item.shape == "jump" else "other"


def _of_all_meshes(entry: Entry, place: str, truth: Truth) -> bool:
    """Whether a line of a shaft is one of the mesh."""
    if place not in ("mesh", "other") or entry["kind"] != "shaft_order" or entry.get("order") is None:
        return False
    z = truth.z[0 if entry.get("gear") == "driving" else 1]
    meshes = float(entry["order"]) / z
    return abs(meshes - round(meshes)) * z < 0.1 and round(meshes) > 0


def figures(some: StatedChances, limits: Thresholds) -> dict[str, Any]:
    """Bins of stated chances of names and of places, and the log score of all entries."""
    return {
        NAME: bins([one for one in some.forecasts if one.of == NAME], limits.bins),
        PLACE: bins([one for one in some.forecasts if one.of == PLACE], limits.bins),
        **log_score(some.true, limits),
    }


def bins(some: Sequence[Forecast], count: int) -> list[dict[str, Any]]:
    """Bins of equal width from 0 to 1, the last with 1 in it: mean of the chances stated, and how often right."""
    out = []
    for k in range(count):
        here = [one for one in some if min(int(one.stated * count), count - 1) == k]
        mean = math.fsum(one.stated for one in here) / len(here) if here else None
        ends = [k / count, (k + 1) / count]
        out.append({"chance": ends, "stated": mean, "right": share([one.right for one in here]).to_json()})
    return out


def log_score(true: Sequence[float], limits: Thresholds) -> dict[str, Any]:
    """Mean natural logarithm of the chance stated of what was true, over ``entries`` entries of verdicts: 0 is best,
    log(1/2) a coin. ``log_score_std`` is the standard error of the mean."""
    logs = [math.log(max(one, limits.least_chance)) for one in true]
    n = len(logs)
    mean = math.fsum(logs) / n if n else None
    spread = None
    if mean is not None and n > 1:
        spread = math.sqrt(math.fsum((one - mean) ** 2 for one in logs) / (n - 1) / n)
    return {"log_score": mean, "log_score_std": spread, "entries": n}
