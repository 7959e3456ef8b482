"""Figures of every case whatever its kind: what a careful expert could know, chances stated, unseen data, time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from gearpoly.prove import reliability
from gearpoly.prove.expert import FAILURES
from gearpoly.prove.row import Row, at_least, at_most, figure
from gearpoly.prove.score import CaseScore
from gearpoly.prove.statistics import quantile, share
from gearpoly.prove.thresholds import Thresholds

LENGTHS_SAID = ("short", "long")


def said_rows(scores: Sequence[CaseScore], limits: Thresholds) -> list[Row]:
    """The figures of all cases as rows of the scoreboard. None has a goal: none was set before they were built."""
    known = [(one.name, one.expert) for one in scores]
    stated = reliability.joined(one.stated for one in scores)
    logs = reliability.log_score(stated.true, limits)
    ratios = [one.unseen_ratio for one in scores if one.unseen_ratio is not None]
    rises = [(one.name, one.unseen_ratio > 1.0) for one in scores if one.claims and one.unseen_ratio is not None]
    return [
        at_most(
            "false_name_cases", "cases with a name that may not stand",
            [(name, one.false_names > 0) for name, one in known], None,
        ),
        at_least(
            "to_be_named", "of what was to be named: named, tooth included",
            [(name, hit) for name, one in known for hit in one.named], None,
        ),
        at_least(
            "to_be_located", "of what was to be located: located, by a name or without",
            [(name, hit) for name, one in known for hit in one.located], None,
        ),
        at_most(
            "silent", "nothing said where something could be known",
            [(name, one.silent) for name, one in known if one.named or one.located], None,
        ),
        *(at_most(key, text, [(name, one.failure == key) for name, one in known], None)
          for key, text in FAILURES.items()),
        figure(
            "log_score", "log score of stated chances: mean log probability of what was true", logs["log_score"], "",
            note=f"{logs['entries']} entries of verdicts; 0 is best",
        ),
        figure("unseen_ratio", "rms of unseen data, after over before, median", quantile(ratios, 0.5), ""),
        figure("unseen_ratio_95", "the same, 95th percentile", quantile(ratios, 0.95), ""),
        at_most("unseen_rises", "something named, and unseen data fit worse", rises, None),
    ]  # fmt: skip


def length(one: CaseScore, limits: Thresholds) -> str | None:
    """Whether a recording is short or long; None where the truth does not say how long it is."""
    cycles = one.truth.hunting_cycles
    return None if cycles is None else LENGTHS_SAID[cycles > limits.short_cycles]


def by_class(scores: Sequence[CaseScore], limits: Thresholds) -> dict[str, Any]:
    """Figures of every class, and of all together."""
    return _grouped(scores, lambda one: one.truth.klass, limits) | {"all": _figures(scores, limits)}


def by_length(scores: Sequence[CaseScore], limits: Thresholds) -> dict[str, Any]:
    """The same of short recordings and of long ones."""
    return _grouped(scores, lambda one: length(one, limits), limits)


def time_of(scores: Sequence[CaseScore], limits: Thresholds) -> dict[str, Any]:
    """Processor seconds by class, by length, and of all together."""
    groups: dict[str, list[float]] = {}
    for one in scores:
        for key in (one.truth.klass, length(one, limits), "all"):
            if key is not None and one.seconds is not None:
                groups.setdefault(key, []).append(one.seconds)
    return {
        key: {"median": quantile(spent, 0.5), "q95": quantile(spent, 0.95), "all": sum(spent)}
        for key, spent in sorted(groups.items())
    }


def _grouped(scores: Sequence[CaseScore], key: Callable[[CaseScore], str | None], limits: Thresholds) -> dict[str, Any]:
    groups: dict[str, list[CaseScore]] = {}
    for one in scores:
        name = key(one)
        if name is not None:
            groups.setdefault(name, []).append(one)
    return {name: _figures(some, limits) for name, some in sorted(groups.items())}


def _figures(some: Sequence[CaseScore], limits: Thresholds) -> dict[str, Any]:
    experts = [one.expert for one in some]
    ratios = [one.unseen_ratio for one in some if one.unseen_ratio is not None]
    rises = [one.unseen_ratio > 1.0 for one in some if one.claims and one.unseen_ratio is not None]
    return {
        "cases": len(some),
        "false_names": share([one.false_names > 0 for one in experts]).to_json(),
        "named": share([hit for one in experts for hit in one.named]).to_json(),
        "located": share([hit for one in experts for hit in one.located]).to_json(),
        "silent": share([one.silent for one in experts if one.named or one.located]).to_json(),
        "said": share([one.said for one in experts if one.said is not None]).to_json(),
        **{key: sum(one.failure == key for one in experts) for key in FAILURES},
        "reliability": reliability.figures(reliability.joined(one.stated for one in some), limits),
        "unseen_ratio": {"median": quantile(ratios, 0.5), "q95": quantile(ratios, 0.95), "cases": len(ratios)},
        "unseen_rises": share(rises).to_json(),
    }
