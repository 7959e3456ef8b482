"""Why pairs have no result: reasons taken together by cause, each with one row as an example."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearpoly.study.design import Design
from gearpoly.study.pipeline import DONE, JAMS, NO_CONTACT, REFUSED
from gearpoly.study.store import Store

_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
"""Every pair has its own angles and sizes in its message; reasons that differ in numbers alone are one cause."""

_WORDS = {JAMS: ("jams", "jam"), NO_CONTACT: ("loses contact", "lose contact"),
          REFUSED: ("is refused", "are refused")}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class FailureCause:
    """``pairs`` without a result for one cause, and the first of them: row ``index``, its ``seed``, the ``values`` of
    its swept keys and its ``reason``. ``status`` as in the table."""

    status: str
    pairs: int
    reason: str
    index: int
    seed: int
    values: dict[str, Any]

    @property
    def says(self) -> str:
        """The cause in words, with its example."""
        one, many = _WORDS[self.status]
        return (
            f"{self.pairs} {'pair' if self.pairs == 1 else 'pairs'} {one if self.pairs == 1 else many}: {self.reason}"
        )

    @property
    def example(self) -> str:
        """Which row the reason is of, in words."""
        values = "".join(f"{key} = {value:g}, " if isinstance(value, float) else f"{key} = {value}, "
                         for key, value in self.values.items())  # fmt: skip
        return f"row {self.index} ({values}seed {self.seed})"


def count_words(found: tuple[FailureCause, ...], *, pairs: int) -> list[str]:
    """How many of all ``pairs`` have no result, and what yields make of them: a sentence for each kind there is."""
    counted = {status: sum(one.pairs for one in found if one.status == status) for status in _WORDS}
    bad = counted[JAMS] + counted[NO_CONTACT]
    out = []
    if counted[REFUSED]:
        out.append(
            f"{counted[REFUSED]} of {pairs} pairs are refused: they could not be drawn, mounted or computed, and count "
            "in no yield."
        )
    if bad:
        out.append(f"{bad} of {pairs} pairs were drawn, but do not turn: they count as bad in every yield.")
    return out


def causes(store: Store, *, rows: int | None = None) -> tuple[FailureCause, ...]:
    """Every cause among the first ``rows`` rows of ``store`` (None: all), refused pairs first, the most frequent ones
    before the others."""
    found = store.columns(["index", "combination", "seed", "status", "reason"])
    without = found["status"] != DONE
    if rows is not None:
        without &= found["index"] < rows
    return _grouped(store.plan.design, {name: column[without] for name, column in found.items()})


def _grouped(design: Design, found: dict[str, Any]) -> tuple[FailureCause, ...]:
    members: dict[tuple[str, str], list[int]] = {}
    for k, (status, reason) in enumerate(zip(found["status"], found["reason"], strict=True)):
        members.setdefault((status, _NUMBER.sub("#", reason)), []).append(k)
    out = []
    for (status, _), rows in members.items():
        first = rows[int(np.argmin(found["index"][rows]))]
        out.append(
            FailureCause(
                status=status,
                pairs=len(rows),
                reason=str(found["reason"][first]),
                index=int(found["index"][first]),
                seed=int(found["seed"][first]),
                values=design.values(int(found["combination"][first])),
            )
        )
    return tuple(sorted(out, key=lambda one: (one.status != REFUSED, -one.pairs, one.index)))
