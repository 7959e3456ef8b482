"""How groups of cases fare: by size over the theoretical limit, class, physics, pair."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

from gearpoly.prove.score import CaseScore, ItemScore
from gearpoly.prove.statistics import quantile, share

EDGES = (0.0, 1.0, 2.0, 4.0, 7.0, 10.0, 15.0, math.inf)
"""Bounds of the sizes that are counted together."""


def by_size(scores: Sequence[CaseScore]) -> list[dict[str, Any]]:
    """Detection and naming of single effects against their size over the theoretical limit."""
    single = [one for one in scores if one.truth.kind == "missing" and len(one.items) == 1]
    out = []
    for low, high in pairwise(EDGES):
        here = [one for one in single if low <= one.items[0].item.over_limit < high]
        out.append({"over_limit": [low, None if math.isinf(high) else high], **_profile(here)})
    return out


def by_key(scores: Sequence[CaseScore], key: Callable[[CaseScore], str]) -> dict[str, Any]:
    """The same figures by class, by physics or by whatever else."""
    groups: dict[str, list[CaseScore]] = {}
    for one in scores:
        groups.setdefault(key(one), []).append(one)
    return {name: _profile(here) for name, here in sorted(groups.items())}


def _profile(cases: Sequence[CaseScore]) -> dict[str, Any]:
    items: list[ItemScore] = [i for one in cases for i in one.items]
    return {
        "cases": len(cases),
        "over_noise": _middle(cases, "over_noise"),
        "over_what_hides_it": _middle(cases, "over_what_hides_it"),
        "reported": share([one.reported for one in cases]).to_json(),
        "named": share([i.placed for i in items]).to_json(),
        "in_set": share([i.in_set for i in items]).to_json(),
        "extras": sum(one.extras for one in cases),
    }


def _middle(cases: Sequence[CaseScore], depth: str) -> float | None:
    """Median of how deep the effects of some cases lie, in rms."""
    return quantile([one.truth.depth[depth] for one in cases if depth in one.truth.depth], 0.5)
