"""The grounds there are: what each conceals, and how its cases are made."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

from gearpoly.proving import case, ground, short
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.life import ground as life


class GroundPlan(Protocol):
    """The cases of a ground from its seed."""

    def __call__(self, seed: int, *, quick: bool = False) -> list[CaseEntry]: ...


class Made(Protocol):
    """A case that is ready to be written."""

    def truth_text(self) -> str:
        """The truth file's text."""
        ...

    def files(self) -> Iterator[tuple[str, str]]:
        """Names and texts of the case's folder."""
        ...


@dataclass(frozen=True, kw_only=True)
class Ground:
    """One ground: its plan, how a case of it is made, and what conceals the effects of each class."""

    plan: GroundPlan
    make: Callable[[int, CaseEntry], Made]
    concealed: dict[str, str]


BENCH = "bench"
GROUNDS: dict[str, Ground] = {
    BENCH: Ground(plan=ground.plan, make=case.make, concealed=ground.BENCH_CONCEALED_BY),
    "short": Ground(plan=short.plan, make=case.make, concealed=short.SHORT_CONCEALED_BY),
    "real-life": Ground(plan=life.plan, make=life.make, concealed=life.LIFE_CONCEALED_BY),
}
"""By the name that `gearpoly prove --ground` takes."""
ALL_CONCEALED_BY = {klass: text for one in GROUNDS.values() for klass, text in one.concealed.items()}
"""What conceals the effects of a class, of all grounds."""
