"""Fits of which a test says what they are, for moves that need no gears."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any


@dataclass(kw_only=True, eq=False)
class MadeFit:
    """What stands for a ``Fit``: whatever a move asks of it."""

    model: Any = None
    linear: Any = None
    scenes: Any = ()
    noises: Any = ()
    foreign: Any = ()
    nuisance: Any = None
    laws: Any = None
    trial: bool = False
    step: Callable[[str], None] = lambda text: None
    over: bool = False
    looked: Any = None
    formed: float = 0.0
    disowned: int = 0
    rises: Any = None
    largest: float = 0.0
    of_teeth: float = 0.0
    deflections: tuple[float, ...] = ()

    @property
    def deflection(self) -> float:
        return max(self.deflections, default=0.0)

    def believing(self, **changes: Any) -> MadeFit:
        return replace(self, model=SimpleNamespace(**{**vars(self.model), **changes}))

    def linearised(self) -> MadeFit:
        return self
