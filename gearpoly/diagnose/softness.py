"""How soft teeth are: which compliance law, and how much of it, beside what is claimed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearpoly.diagnose.fit import BETTER_STATE_GAIN, Fit, better_of, settled
from gearpoly.diagnose.nuisance import SCALE_STD, law_changes

OTHER_LAW_GAIN = 30.0
"""Gain in misfit by which another compliance law must fit better than the present one to take its place."""

WIDER_LAWS_FACTOR, WIDEST_LAWS_FACTOR = 1.2, 5.0
"""Factors on the doubt about laws: below the first nothing is fitted again, above the second no law is believed."""

SOFT = 2.0
"""Standard deviations of the declared compliance from which on it is doubted that teeth are what is so soft."""


def with_best_law(fit: Fit) -> Fit:
    """By the compliance law that fits best, if one is clearly better than the present one."""
    changes = law_changes(fit.scenes)
    if not changes:
        return fit
    at = fit.linear.layout.nuisance
    modes = list(range(at.stop - (0 if fit.laws is None else len(fit.laws.mix)), at.stop))
    bare = fit.linear.without(modes)
    # The change as it is, with all else fitted again beside it.
    gains = bare.gains([change.parts for change in changes.values()])
    best = int(np.argmax(gains))
    if gains[best] < OTHER_LAW_GAIN:
        return fit
    law, ratio = list(changes)[best], list(changes.values())[best].ratio

    def by_that_law(one: Fit) -> Fit:
        return settled(replace(one, model=replace(one.model, law=law).softer(ratio), laws=None))

    return better_of(fit, by_that_law, better=-math.inf)


def with_declared_law(fit: Fit) -> Fit:
    """By the declared compliance law again, unless another still fits clearly better: one that was taken for want of a
    physics is in the way once that is found."""
    if fit.model.law is None:
        return fit
    return better_of(fit, lambda one: settled(by_declared_law(one)), better=-OTHER_LAW_GAIN)


def with_declared_softness(fit: Fit) -> Fit:
    """Begun once more with teeth as soft as declared where they came out far from it, if that ends better: what else
    gives way under load was taken for teeth before it was claimed, and what hardens and what is soft all along are two
    valleys."""
    if not fit.model.declared.model.tooth_deflection or not fit.model.claims:
        return fit
    softer = fit.model.scale * declared_ratio(fit)
    if abs(softer - 1.0) < SOFT * SCALE_STD:
        return fit
    return better_of(
        fit, lambda one: settled(replace(one, model=one.model.softer(1.0 / softer))), better=BETTER_STATE_GAIN
    )


def by_declared_law(fit: Fit) -> Fit:
    """By the declared compliance law, teeth giving as much as before in the mean, without fitting again."""
    if fit.model.law is None:
        return fit
    return replace(fit, model=replace(fit.model.softer(declared_ratio(fit)), law=None), laws=None)


def declared_ratio(fit: Fit) -> float:
    """Compliance by the declared law over that by the law in use where teeth give as much in the mean."""
    if fit.model.law is None:
        return 1.0
    named = fit.model.declared.model
    law = named.compliance, named.contact
    back = law_changes(fit.scenes, only=law).get(law)
    return 1.0 if back is None else back.ratio


def with_wider_laws(fit: Fit) -> Fit:
    """Fitted once more with as much doubt about the compliance law as it turned out to be wrong.

    The search holds laws to what is known of them, or a relief would be taken for a law; sizes and their errors are to
    be honest about the law that was met.
    """
    if fit.laws is None:
        return fit
    modes = len(fit.laws.mix)
    met = fit.linear.system.solution[fit.linear.layout.nuisance][-modes:]
    wider = min(WIDEST_LAWS_FACTOR, math.sqrt(float(np.mean(met**2))))
    if wider <= WIDER_LAWS_FACTOR:
        return fit
    laws = fit.laws.widened(wider)
    return better_of(fit, lambda one: settled(replace(one, laws=laws)), better=-math.inf)
