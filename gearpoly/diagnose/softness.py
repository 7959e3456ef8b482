"""How soft teeth are: which compliance law, and how much of it, beside what is claimed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.diagnose.fit import BETTER, CLEARLY, Fit
from gearpoly.diagnose.nuisance import SCALE_STD, law_changes

WIDER, WIDEST = 1.2, 5.0
"""Factors on the doubt about laws: below the first nothing is fitted again, above the second no law is believed."""

SOFT = 2.0
"""Standard deviations of the declared compliance from which on it is doubted that teeth are what is so soft."""


@dataclass(kw_only=True, eq=False)
class Softness(Fit):
    """The fit, with compliance laws to come back from."""

    def declared_law(self) -> None:
        """Come back to the declared compliance law, unless another still fits clearly better: one that was taken for
        want of a physics is in the way once that is found."""
        if self.model.law is None:
            return

        def as_declared() -> None:
            self.take_declared_law()
            self.settle()

        self.tried(as_declared, better=-CLEARLY)

    def declared_softness(self) -> None:
        """Begin once more with teeth as soft as declared where they came out far from it, if that ends better: what
        else gives way under load was taken for teeth before it was claimed, and what hardens and what is soft all along
        are two valleys."""
        if not self.model.declared.model.tooth_deflection or not self.model.claims:
            return
        softer = self.model.scale * self.declared_ratio()
        if abs(softer - 1.0) < SOFT * SCALE_STD:
            return

        def as_soft() -> None:
            self.model.soften(1.0 / softer)
            self.settle()

        self.tried(as_soft, better=BETTER)

    def take_declared_law(self) -> None:
        """Take the declared compliance law, teeth giving as much as before in the mean, without fitting again."""
        if self.model.law is not None:
            self.model.soften(self.declared_ratio())
            self.model.law = None
            self.laws = None

    def declared_ratio(self) -> float:
        """Compliance by the declared law over that by the law in use where teeth give as much in the mean."""
        if self.model.law is None:
            return 1.0
        named = self.model.declared.model
        law = named.compliance, named.contact
        back = law_changes(self.scenes, only=law).get(law)
        return 1.0 if back is None else back.ratio

    def widen(self) -> None:
        """Fit once more with as much doubt about the compliance law as it turned out to be wrong.

        The search holds laws to what is known of them, or a relief would be taken for a law; sizes and their errors
        are to be honest about the law that was met.
        """
        if self.laws is None:
            return
        modes = len(self.laws.mix)
        met = self.linear.system.solution[self.linear.layout.nuisance][-modes:]
        wider = min(WIDEST, math.sqrt(float(np.mean(met**2))))
        if wider > WIDER:
            laws = self.laws.widened(wider)

            def widened() -> None:
                self.laws = laws
                self.settle()

            self.tried(widened, better=-math.inf)
