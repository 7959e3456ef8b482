"""One line of the plan of a ground."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class CaseEntry:
    """One case that is to be made: index, class, what is concealed (none for a healthy case), and its size over the
    limit (0: fixed).

    cycles: hunting cycles that a recording holds; 0: as its class has it."""

    index: int
    klass: str
    physics: tuple[str, ...]
    over: float
    variant: int
    quick: bool = False
    cycles: float = 0.0

    @property
    def name(self) -> str:
        """Folder of the case; says nothing of what is in it."""
        return f"case_{self.index:03d}"
