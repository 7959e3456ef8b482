"""The scoreboard as data: every figure, every failed case."""

from __future__ import annotations

import math
from typing import Any

from gearpoly import __version__
from gearpoly.prove.profile import by_key, by_size
from gearpoly.prove.row import Row
from gearpoly.prove.rows import rows
from gearpoly.prove.run import Proof
from gearpoly.prove.said import by_class, by_length, length, time_of
from gearpoly.prove.score import CaseScore
from gearpoly.prove.thresholds import Thresholds
from gearpoly.prove.wanted import unsaid
from gearpoly.proving.grounds import ALL_CONCEALED_BY


def board_json(proof: Proof) -> dict[str, Any]:
    """Every figure of the scoreboard; only what is under ``seconds``, here and by case, differs from run to run."""
    judged = rows(proof.scores, proof.limits)
    timed = [row for row in judged if row.key in ("seconds", "seconds_95", "seconds_all")]
    return {
        "gearpoly": __version__,
        "of": proof.of,
        "seed": proof.seed,
        "quick": proof.quick,
        "ground": proof.ground,
        "cases": len(proof.scores),
        "truths_sha256": proof.sealed,
        "truths": proof.truths,
        "thresholds_sha256": proof.limits.sha256,
        "thresholds": proof.limits.values,
        "code": proof.code,
        "rows": [row.to_json() for row in judged if row not in timed],
        "seconds": {row.key: row.value for row in timed} | {"by_group": time_of(proof.scores, proof.limits)},
        "by_size": by_size(proof.scores),
        "by_class": {
            klass: {"concealed": ALL_CONCEALED_BY.get(klass, ""), **found}
            for klass, found in by_key(proof.scores, lambda one: one.truth.klass).items()
        },
        "by_expert": by_class(proof.scores, proof.limits),
        "by_length": by_length(proof.scores, proof.limits),
        "without_unknown": sum(unsaid(one.truth) for one in proof.scores),
        "by_pair": by_key(proof.scores, lambda one: one.truth.pair),
        "by_physics": by_key(
            [one for one in proof.scores if one.truth.kind == "missing"],
            lambda one: " and ".join(dict.fromkeys(i.item.physics for i in one.items)),
        ),
        "controls": proof.controls,
        "failures": failures(proof.scores, judged),
        "by_case": [_case(one, proof.limits) for one in proof.scores],
    }


def failures(scores: tuple[CaseScore, ...], found: list[Row]) -> list[dict[str, Any]]:
    """Every case that misses a row, with the truth, what was said, and which rows it misses."""
    missed: dict[str, list[str]] = {}
    for row in found:
        for name in row.cases:
            missed.setdefault(name, []).append(row.key)
    return [
        {
            "case": one.name,
            "class": one.truth.klass,
            "pair": one.truth.pair,
            "truth": _concealed(one),
            "over_limit": [_finite(i.over_limit) for i in (*one.truth.items, *one.truth.background)],
            "status": one.status,
            "said": list(one.said),
            "unexplained": one.unexplained,
            "error": one.error,
            "misses": missed[one.name],
        }
        for one in scores
        if one.name in missed
    ]


def _concealed(one: CaseScore) -> list[str]:
    beside = [f"beside {item.label}" for item in one.truth.background]
    return [item.label for item in one.truth.items] + beside


def _case(one: CaseScore, limits: Thresholds) -> dict[str, Any]:
    out: dict[str, Any] = {
        "case": one.name,
        "class": one.truth.klass,
        "truth": _concealed(one),
        "status": one.status,
        "said": list(one.said),
        "unexplained": one.unexplained,
        "extras": one.extras,
        "error": one.error,
        "length": length(one, limits),
        "false_names": one.expert.false_names,
        "stated": [{"of": f.of, "stated": f.stated, "right": f.right} for f in one.stated.forecasts],
        "chance_of_what_was_true": list(one.stated.true),
        "heldout_rms_um": {"before": one.before, "after": one.after},
        "noise_um": one.truth.noise_um,
        "energy_removed": one.removed,
        "items": [
            {
                "label": i.item.label,
                "over_limit": _finite(i.item.over_limit),
                "separable": i.item.separable(limits),
                "to_be_named": i.item.earned(limits),
                "seen_by_shape": i.item.seen_by_shape(limits),
                "within_the_evidence": len(i.item.acceptable(limits)),
                "look_alike": i.item.alike(limits),
                "named": i.named,
                "placed": i.placed,
                "first": i.first,
                "in_set": i.in_set,
                "set_size": i.set_size,
                "parameters": [
                    {"name": p.name, "off": p.off, "std": p.std, "size": _finite(p.size)} for p in i.parameters
                ],
            }
            for i in one.items
        ],
    }
    if one.background:
        out["background"] = [
            {"label": item.label, "over_limit": _finite(item.over_limit), "located": found}
            for item, found in one.background
        ]
    if one.truth.kind == "unknown":
        out["located"] = one.located
    return out


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
