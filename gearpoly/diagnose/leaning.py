"""Teeth that all lean far beyond their grade: unloaded ones then touch elsewhere, where no small step leads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearpoly.diagnose.exchange import gained_since
from gearpoly.diagnose.fit import BETTER_STATE_GAIN, Fit, settled
from gearpoly.diagnose.kept import Kept, come_back
from gearpoly.diagnose.placing import TRIAL_ROUNDS
from gearpoly.diagnose.shortened import PLACING_SAMPLES, shortened
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.threads import each

LEAN_SIGMAS = 12.0
"""Slope that is begun with, in standard deviations of a gear's mean slope within its grade: three times the limit. Of a
slope of 19 um, where the grade allows 7, a fit that began with none ended at -12 um, and one that began with 20 um at
18.5 and 0.70 of the misfit."""


def leaning(fit: Fit, start: Kept) -> Fit | None:
    """The state at the ``start`` of a search that came to a ``fit``, begun anew with teeth alike and a slope of the
    driving gear's flanks, rising or falling, if a trial of fewer samples says that it fits better so than begun alike
    without; None where it does not, or load brings all teeth to touch, or nobody left them open. What leans of one gear
    is to first order what leans of the other, the other way."""
    physics = {one.name: one for one in fit.model.method.physics}.get("profile_slope")
    prior = fit.model.as_built.gears[0]
    if physics is None or not prior.graded or all(scene.bends for scene in fit.scenes) or fit.over:
        return None
    size = LEAN_SIGMAS * prior.mean_slope
    fit = come_back(start, fit)
    model = fit.model
    claims = [Claim(physics=physics, place=Place(gear=0), values=(way * size,)) for way in (1.0, -1.0)]
    if claims[0].key in {one.key for one in model.claims}:
        return None
    alike = replace(model, built=np.zeros_like(model.built))
    trial, columns = shortened(alike, fit.foreign, few=PLACING_SAMPLES[-1])
    starts = [model.claims, *((*model.claims, one) for one in claims)]

    def tried(claims: tuple[Claim, ...]) -> Fit | None:
        try:
            return Fit.begun(replace(trial, claims=claims), columns, lambda _: None, trial=TRIAL_ROUNDS[-1])
        except GearpolyError:
            return None

    alike_without, *leant = each(tried, starts)
    if alike_without is None:
        return None
    best = max(
        (one for one in leant if one is not None), key=lambda one: gained_since(one, alike_without), default=None
    )
    if best is None or gained_since(best, alike_without) < BETTER_STATE_GAIN:
        return None
    try:
        return settled(fit.believing(built=np.zeros_like(model.built), claims=best.model.claims))
    except GearpolyError:
        return None
