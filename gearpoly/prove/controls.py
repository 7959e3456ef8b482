"""What the scoreboard says where it ought to say less: shuffled teeth, a struck physics, wrong knowledge, a method with
a part missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearpoly.prove.match import names, on_tooth
from gearpoly.prove.score import CaseScore
from gearpoly.prove.statistics import share
from gearpoly.prove.thresholds import Thresholds

SHUFFLES = 50
"""Shuffles of the tooth labels: thousands of guesses in all, so that the share is known to a percent."""

FALSIFIED = ("eccentricity", "tip_relief", "tooth_deflection", "encoder_eccentricity", "cumulative_pitch")
"""Physics that a wrong declared eccentricity, relief or modulus truly is, or is alike."""


def shuffled(
    scores: Sequence[CaseScore], claims: dict[str, list[dict[str, Any]]], limits: Thresholds
) -> dict[str, Any]:
    """How often the right tooth would be named were the teeth of the truths numbered at random, and what chance says.

    ``claims`` are the verdicts' by case.
    """
    rng = np.random.default_rng(2028)
    hits, fair = [], []
    for one in scores:
        for i in one.items:
            item = i.item
            if not i.named or item.tooth is None or item.encoder_deg is None or not item.teeth:
                continue
            named = [claim for claim in claims[one.name] if names(claim, item)]
            for turn in rng.integers(item.teeth, size=SHUFFLES).tolist():
                guess = replace(
                    item, tooth=(item.tooth + turn) % item.teeth,
                    encoder_deg=(item.encoder_deg + turn * 360.0 / item.teeth) % 360.0,
                )  # fmt: skip
                hits.append(any(on_tooth(claim, guess, limits, claim=claim) for claim in named))
                fair.append(len(named) / item.teeth)
    return {
        "text": "control: tooth labels shuffled; right tooth by chance",
        "right_tooth": share(hits).to_json(),
        "expected": float(np.mean(fair)) if fair else None,
    }


def compared(text: str, with_: Sequence[CaseScore], without: Sequence[CaseScore]) -> dict[str, Any]:
    """The same cases as the whole method (``without`` the change) and the arm (``with_`` it) answer them."""
    return {"text": text, "cases": len(with_), "arm": _told(with_), "plain": _told(without)}


def _told(scores: Sequence[CaseScore]) -> dict[str, Any]:
    healthy = [one for one in scores if one.truth.kind == "none"]
    missing = [one for one in scores if one.truth.kind == "missing"]
    items = [i for one in missing for i in one.items]
    return {
        "false_alarms": share([one.reported for one in healthy]).to_json(),
        "healthy_named_otherwise": share([_otherwise(one) for one in healthy]).to_json(),
        "reported": share([one.reported for one in missing]).to_json(),
        "named": share([i.placed for i in items]).to_json(),
        "in_set": share([i.in_set for i in items]).to_json(),
        "false_names": share([one.extras > 0 for one in missing]).to_json(),
        "look_alike_named": share([i.alike_named and not i.in_set for i in items]).to_json(),
        "errors": sum(bool(one.error) for one in scores),
    }


def _otherwise(one: CaseScore) -> bool:
    """Whether a healthy case was given a name that a wrong declaration does not account for."""
    return any(words.split(" ")[0] not in FALSIFIED for words in one.said)
