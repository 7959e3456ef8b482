"""States of a fit to come back to, without what the next fit makes anew, which is large: a hundred columns at all
samples."""

from __future__ import annotations

from dataclasses import dataclass, replace

from gearpoly.compare.noise import Noise
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.nuisance import LawModes, Nuisance
from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Kept:
    """A fit without its scenes and its linear system."""

    model: Model
    foreign: list[FloatArray]
    noises: list[Noise]
    nuisance: Nuisance
    laws: LawModes | None
    largest: float
    deflections: tuple[float, ...]
    of_teeth: float


def kept(fit: Fit) -> Kept:
    """A ``fit`` to come back to."""
    return Kept(
        model=fit.model, foreign=fit.foreign, noises=fit.noises, nuisance=fit.nuisance, laws=fit.laws,
        largest=fit.largest, deflections=fit.deflections, of_teeth=fit.of_teeth,
    )  # fmt: skip


def come_back(state: Kept, fit: Fit) -> Fit:
    """The fit of a kept ``state``, simulated and linearised anew, with what the search of a ``fit`` has learned since:
    where its looks were, what turns with the shafts, and what time it has."""
    model = replace(state.model, scope=fit.model.scope, budget=fit.model.budget)
    there = replace(
        fit, model=model, foreign=state.foreign, noises=state.noises, nuisance=state.nuisance, laws=state.laws,
        largest=state.largest, deflections=state.deflections, of_teeth=state.of_teeth, scenes=model.scenes(),
    )  # fmt: skip
    return there.linearised()
