"""One figure that a diagnosis has to reach."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from gearpoly.prove.statistics import Share, share


@dataclass(frozen=True, kw_only=True)
class Row:
    """A figure of the scoreboard: ``key`` for scripts, ``text`` for people; a ``share`` of cases or a ``value`` with
    its ``unit``; the ``goal`` in words and whether it is ``reached`` (None: no goal, or nothing to judge by); the
    ``cases`` that miss it; a ``note``."""

    key: str
    text: str
    share: Share | None = None
    value: float | None = None
    unit: str = ""
    goal: str = ""
    reached: bool | None = None
    cases: tuple[str, ...] = field(default=())
    note: str = ""

    def to_json(self) -> dict[str, Any]:
        """The row's figures."""
        out: dict[str, Any] = {"key": self.key, "text": self.text}
        out |= self.share.to_json() if self.share is not None else {"value": self.value, "unit": self.unit}
        return out | {"goal": self.goal, "reached": self.reached, "cases": list(self.cases), "note": self.note}


def at_least(key: str, text: str, hits: Sequence[tuple[str, bool]], goal: float | None, note: str = "") -> Row:
    """A share of (case, right) that is to be at least ``goal``; the cases that are not right are listed."""
    found = share([good for _, good in hits])
    return Row(
        key=key,
        text=text,
        share=found,
        goal="" if goal is None else f"at least {100 * goal:g} %",
        reached=None if goal is None or not found.of else found.rate >= goal - 1e-12,
        cases=once(name for name, good in hits if not good),
        note=note,
    )


def at_most(key: str, text: str, hits: Sequence[tuple[str, bool]], goal: float | None, note: str = "") -> Row:
    """A share of (case, wrong) that is to be at most ``goal``; the wrong ones are listed."""
    found = share([bad for _, bad in hits])
    words = "" if goal is None else "none" if goal == 0.0 else f"at most {100 * goal:g} %"
    reached = None if goal is None or not found.of else found.rate <= goal + 1e-12
    return Row(
        key=key, text=text, share=found, goal=words, reached=reached, note=note,
        cases=once(name for name, bad in hits if bad),
    )  # fmt: skip


def figure(
    key: str, text: str, value: float | None, unit: str, *, goal: str = "", reached: bool | None = None, note: str = ""
) -> Row:
    """A single number."""
    return Row(key=key, text=text, value=value, unit=unit, goal=goal, note=note, reached=reached)


def once(names: Iterable[str]) -> tuple[str, ...]:
    """Names in order, each once."""
    return tuple(dict.fromkeys(names))
