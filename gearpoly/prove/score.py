"""One verdict beside one truth."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from gearpoly.prove.expert import Expert, expert
from gearpoly.prove.match import acceptable, located, names, on_tooth, reported_set, stands_at
from gearpoly.prove.reliability import StatedChances, stated
from gearpoly.prove.thresholds import Thresholds
from gearpoly.prove.truth import FROM_ONE, SIZE_PARAMETERS, Item, Truth

ANGLE_PARAMETERS = ("angle_deg",)

NO_ANSWER: dict[str, Any] = {"status": "nothing_missing", "missing": [], "unexplained": [], "fit": {}}
"""What a diagnosis that raised an error has said."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter of a right claim: ``off`` from the truth, the stated ``std``, the true ``size`` that a relative error
    refers to; ``main`` where it is how much of the physics there is."""

    name: str
    off: float
    std: float
    size: float
    main: bool

    def within(self, sigmas: float) -> bool:
        """Whether the truth lies within so many stated standard errors."""
        return abs(self.off) <= sigmas * self.std

    @property
    def relative(self) -> float:
        """Error over the true size."""
        return abs(self.off) / abs(self.size) if self.size else math.inf


@dataclass(frozen=True, kw_only=True)
class ItemScore:
    """What became of one concealed effect.

    ``named``: a claim has its physics, gear and order, ``placed``: and its tooth; ``first``: that claim leads the
    verdict; ``in_set``: it is in the reported set of some claim; ``set_size`` of the claim that stands for it;
    ``alike_named``: that claim is a look-alike of it; ``singly``: a look-alike or it alone was named although a rival
    is as good.
    """

    item: Item
    named: bool
    placed: bool
    first: bool
    in_set: bool
    set_size: int | None
    alike_named: bool
    singly: bool
    parameters: tuple[Parameter, ...]


@dataclass(frozen=True, kw_only=True)
class CaseScore:
    """A case with its ``truth``; ``error`` of a diagnosis that failed; what was ``said`` in a few words; ``claims`` in
    all and ``extras`` among them that stand for nothing concealed; entries ``unexplained``, and the ``strays`` among
    them that are not where something of the background is; whether a stranger was ``located``, and each wave of the
    ``background``; held-out rms in um ``before`` and ``after``;
    ``expert``: beside what one could know; ``stated``: the chances that it states, beside the truth."""

    name: str
    truth: Truth
    error: str
    seconds: float | None
    status: str
    said: tuple[str, ...]
    claims: int
    unexplained: int
    strays: int
    extras: int
    items: tuple[ItemScore, ...]
    located: bool
    background: tuple[tuple[Item, bool], ...]
    before: float | None
    after: float | None
    expert: Expert
    stated: StatedChances

    @property
    def unseen_ratio(self) -> float | None:
        """Rms of unseen data after over before; None where no verdict was reached."""
        if self.before is None or self.after is None or self.before <= 0.0:
            return None
        return self.after / self.before

    @property
    def reported(self) -> bool:
        """Whether the verdict says that anything is amiss beside the background."""
        return self.claims > 0 or self.strays > 0

    @property
    def removed(self) -> float | None:
        """Part of the held-out repeatable mismatch energy that the fit took away."""
        mismatch = self.mismatch
        if self.before is None or self.after is None or not mismatch:
            return None
        return min(1.0, (self.before**2 - self.after**2) / mismatch)

    @property
    def mismatch(self) -> float:
        """Held-out energy in um^2 above the true noise before any fit."""
        return 0.0 if self.before is None else max(0.0, self.before**2 - self.truth.noise_um**2)


def said(claim: dict[str, Any]) -> str:
    """A claim in a few words, its rivals after a slash."""
    words = [claim["physics"]]
    if claim.get("gear"):
        words.append(claim["gear"])
    if claim.get("tooth") is not None:
        words.append(f"tooth {claim['tooth']}")
    out = " ".join(words)
    rivals = [" ".join(filter(None, (one["physics"], one.get("gear")))) for one in reported_set(claim)[1:]]
    return " / ".join([out, *rivals])


def score(
    name: str, verdict: dict[str, Any] | None, truth: Truth, limits: Thresholds, *,
    seconds: float | None = None, error: str = "", failure: str = "",
) -> CaseScore:  # fmt: skip
    """Score a verdict (None: the diagnosis failed with ``error``, which counts as having found nothing)."""
    verdict = NO_ANSWER if verdict is None else verdict
    claims = verdict["missing"]
    items = tuple(_item(claims, item, limits) for item in truth.items if item.physics)
    extras = sum(not any(_stands_for(claim, item, limits) for item in truth.items if item.physics) for claim in claims)
    rms = verdict.get("fit", {}).get("heldout_rms_um", {})
    strangers = [item for item in truth.items if not item.physics]
    return CaseScore(
        name=name,
        truth=truth,
        error=error,
        seconds=seconds,
        status=verdict["status"],
        said=tuple(said(claim) for claim in claims),
        claims=len(claims),
        unexplained=len(verdict.get("unexplained", ())),
        strays=sum(
            not any(stands_at(entry, item, truth, limits) for item in truth.background)
            for entry in verdict.get("unexplained", ())
        ),
        extras=extras,
        items=items,
        located=bool(strangers) and all(located(verdict, item, truth, limits) for item in strangers),
        background=tuple((item, located(verdict, item, truth, limits)) for item in truth.background),
        before=rms.get("before"),
        after=rms.get("after"),
        expert=expert(verdict, truth, limits, error=error, failure=failure),
        stated=stated(verdict, truth, limits),
    )


def _stands_for(claim: dict[str, Any], item: Item, limits: Thresholds) -> bool:
    mine = names(claim, item) and on_tooth(claim, item, limits, claim=claim)
    return mine or _in_set(claim, item, limits) or acceptable(claim, item, limits)


def _in_set(claim: dict[str, Any], item: Item, limits: Thresholds) -> bool:
    return any(names(one, item) and on_tooth(one, item, limits, claim=claim) for one in reported_set(claim))


def _item(claims: list[dict[str, Any]], item: Item, limits: Thresholds) -> ItemScore:
    named = [claim for claim in claims if names(claim, item)]
    placed = [claim for claim in named if on_tooth(claim, item, limits, claim=claim)]
    within = [claim for claim in claims if _in_set(claim, item, limits)]
    alike = [claim for claim in claims if acceptable(claim, item, limits)]
    stands = next(iter(placed or within or alike), None)
    size = None if stands is None else len(reported_set(stands))
    return ItemScore(
        item=item,
        named=bool(named),
        placed=bool(placed),
        first=bool(placed) and placed[0] is claims[0],
        in_set=bool(within),
        set_size=size,
        alike_named=not placed and bool(within or alike),
        singly=size == 1 and item.alike(limits),
        parameters=_parameters(placed[0], item) if placed else (),
    )


def _parameters(claim: dict[str, Any], item: Item) -> tuple[Parameter, ...]:
    out = []
    main = SIZE_PARAMETERS[item.physics]
    for name, true in item.parameters.items():
        stated = claim.get("parameters", {}).get(name)
        if stated is None or stated.get("value") is None:
            continue
        off = float(stated["value"]) - true
        if name in ANGLE_PARAMETERS:
            off = (off + 180.0) % 360.0 - 180.0
        counted = true - 1.0 if name == main and item.physics in FROM_ONE else true
        out.append(Parameter(name=name, off=off, std=float(stated.get("std") or 0.0), size=counted, main=name == main))
    return tuple(out)
