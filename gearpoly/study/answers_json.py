"""The answers of a study as plain values, for JSON."""

from __future__ import annotations

import json
import math
from typing import Any

from gearpoly.study.answers import Answers
from gearpoly.study.groups import Group
from gearpoly.study.statistics import Interval


def json_text(answers: Answers) -> str:
    """The answers as JSON."""
    return json.dumps(answers_json(answers), allow_nan=False, indent=1)


def answers_json(answers: Answers) -> dict[str, Any]:
    """Everything but the single values, as plain numbers; an end that is not known is null."""
    return {
        "gearpoly": answers.manifest["gearpoly"],
        "study": answers.name,
        "seed": answers.manifest["seed"],
        "rows": answers.manifest["rows"],
        "finished": answers.manifest["finished"],
        "confidence": answers.confidence,
        "failures": [
            {
                "status": one.status,
                "pairs": one.pairs,
                "reason": one.reason,
                "example": {"index": one.index, "seed": one.seed, "values": one.values},
            }
            for one in answers.causes
        ],
        "groups": [_group_json(group) for group in answers.groups],
        "yields": [
            {
                "limit": one.words,
                "outputs": [limit.output for limit in one.limits],
                "groups": [
                    {"label": group.label, "judged": n, "share": _interval_json(found), "verdict": verdict}
                    for group, n, found, verdict in zip(
                        answers.groups, one.judged, one.shares, one.verdicts, strict=True
                    )
                ],
            }
            for one in answers.yields
        ],
        "cheapest": [{"limit": one.found.words, "says": list(one.says)} for one in answers.cheapest],
        "sensitivity": {
            output: [
                {"factor": i.factor, "first": _interval_json(i.first), "total": _interval_json(i.total)}
                for i in indices
            ]
            for output, indices in answers.sensitivity
            if indices
        },
        "remarks": list(answers.remarks),
    }


def _group_json(group: Group) -> dict[str, Any]:
    """One combination of a sweep: how its pairs fared, and its outputs."""
    return {
        "label": group.label,
        "values": group.values,
        "pairs": group.pairs,
        "done": group.done,
        "jams": group.jams,
        "no_contact": group.no_contact,
        "refused": group.refused,
        "outputs": {
            one.output: {
                "mean": _interval_json(one.mean),
                "std": _finite(one.std),
                "least": float(one.values[0]) if one.values.size else None,
                "greatest": float(one.values[-1]) if one.values.size else None,
                "percentiles": {f"{p:g}": _interval_json(found) for p, found in one.percentiles},
            }
            for one in group.samples
        },
    }


def _interval_json(one: Interval) -> dict[str, float | None]:
    """A value and both ends of its interval."""
    return {"value": _finite(one.value), "low": _finite(one.low), "high": _finite(one.high)}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
