"""The answers of a study as plain values, for JSON."""

from __future__ import annotations

import math
from typing import Any

from gearpoly.study.answers import Answers
from gearpoly.study.statistics import Interval


def answers_json(answers: Answers) -> dict[str, Any]:
    """Everything but the single values, as plain numbers; an end that is not known is null."""

    def interval(one: Interval) -> dict[str, float | None]:
        return {key: value if math.isfinite(value) else None
                for key, value in (("value", one.value), ("low", one.low), ("high", one.high))}  # fmt: skip

    def finite(value: float) -> float | None:
        return value if math.isfinite(value) else None

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
        "groups": [
            {
                "label": group.label,
                "values": group.values,
                "pairs": group.pairs,
                "done": group.done,
                "jams": group.jams,
                "no_contact": group.no_contact,
                "refused": group.refused,
                "outputs": {
                    one.output: {
                        "mean": interval(one.mean),
                        "std": finite(one.std),
                        "least": float(one.values[0]) if one.values.size else None,
                        "greatest": float(one.values[-1]) if one.values.size else None,
                        "percentiles": {f"{p:g}": interval(found) for p, found in one.percentiles},
                    }
                    for one in group.samples
                },
            }
            for group in answers.groups
        ],
        "yields": [
            {
                "limit": one.words,
                "outputs": [limit.output for limit in one.limits],
                "groups": [
                    {"label": group.label, "judged": n, "share": interval(found), "verdict": verdict}
                    for group, n, found, verdict in zip(
                        answers.groups, one.judged, one.shares, one.verdicts, strict=True
                    )
                ],
            }
            for one in answers.yields
        ],
        "cheapest": [{"limit": one.found.words, "says": list(one.says)} for one in answers.cheapest],
        "sensitivity": {
            output: [{"factor": i.factor, "first": interval(i.first), "total": interval(i.total)} for i in indices]
            for output, indices in answers.sensitivity
            if indices
        },
        "remarks": list(answers.remarks),
    }
