"""Whether a candidate is more than chance, more than what the simulation leaves of others, and worth a claim."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.compare.lines import SNAP
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.floors import (
    clock_floor,
    columns_beside,
    law_floor,
    reading_floor,
    simulation_floor,
    size_of,
)
from gearpoly.diagnose.heldout import SLOW_BLOCKS_BETWEEN_JUMPS, blocks, log_predictive
from gearpoly.diagnose.scan import LEAST_INFORMATION_PART, Candidate, columns_of, together
from gearpoly.diagnose.system import System
from gearpoly.diagnose.teeth_scale import WORTH_COUNTING, beside_finer, is_unstated, of_pitches
from gearpoly.infer.prior import order_of
from gearpoly.physics.base import Claim
from gearpoly.units import FloatArray

HEALTHY_SET_CHANCE = 0.01
"""Chance that a healthy set of recordings raises any claim: of 5 % the other part is left to what is only located,
which is no name."""


PARTLY, MOSTLY = 0.03, 0.1
"""Parts of the misfit beyond noise that a claim must explain: any, and a further one of the mean tooth."""

SETS_IN, UNSTATED_SETS_IN = 0.25, 0.5
"""Part of the form that a grade leaves open by which tips may fall off that nobody relieved: a reference of the tool
that is not straight does that. Twice as much where nobody stated a grade, so that its limits were told by the teeth
themselves. Of printed gears as grade 8 to 11 has them, 3.1 um were named a relief, 0.16 of it, of others 1.3 to 1.5 and
3.6 um, 0.3 to 0.35 of it."""


GRADE_FORM_MISFIT_PART = 0.5
"""The same from which on a form that a grade leaves open is what most of the misfit is."""


SIMILAR = 0.5
"""Part of a wave's size from which on another may be of its kind."""

COINCIDENCE = 0.1
"""Waves of unknown make that may be expected to lie at an order of a shaft by chance, beyond which none is named."""

STEP_MOMENTS_TRIED, STEP_MOMENT_ROUNDS = 48, 2
"""Moments of a recording at which a step is tried, at first in all of it, and how often so: the second time between the
neighbours of the best."""

SLOW_OVER_STEP_GAIN = 4.0
"""Gain by which what is slow must be better than the best step to be told from one: of steps at 5 to 8 standard
deviations whose moment nobody knows, three slow terms gained more than that in 1 of 100."""

POLISH = 1.6
"""Gain of a polished shape over the nearest that was tried, at most to be hoped for."""


def hopeful(fit: Fit, one: Candidate) -> bool:
    """Whether a candidate may be significant once its shape is polished."""
    return significant(fit, replace(one, gain=POLISH * one.gain) if one.claim.physics.shaped else one)


def significant(fit: Fit, one: Candidate) -> bool:
    """Whether chance would hardly gain as much anywhere in the search, noise as it is left."""
    return beyond_chance(fit, one) and not as_sudden(fit, one)


def beyond_chance(fit: Fit, one: Candidate) -> bool:
    """The same of a candidate that may stand for something sudden."""
    return beyond_floors(fit, one) and not by_coincidence(fit, one)


def beyond_floors(fit: Fit, one: Candidate) -> bool:
    """The same of a wave that may be any of many."""
    physics, place = one.claim.physics, one.claim.place
    if not physics.sensible(fit.model.scope, place, one.claim.values):
        return False
    if within_grade(fit, one):
        return False
    honest = replace(one, gain=counted(fit, one) / max(1.0, fit.linear.system.whiteness))
    if honest.log_chance(tests=fit.looked.tests(one.claim)) >= math.log(HEALTHY_SET_CHANCE):
        return False
    floors = law_floor(fit, one), reading_floor(fit, one), simulation_floor(fit, one), clock_floor(fit, one)
    return size_of(fit, one) > max(floors)


def counted(fit: Fit, one: Candidate) -> float:
    """The gain of a candidate, beside teeth that may be finer than their grade."""
    if one.gain < WORTH_COUNTING or not of_pitches(fit.model, one.claim):
        return one.gain
    columns, system = columns_beside(fit, one)
    linear = replace(fit.linear, system=system.with_columns(columns))
    return beside_finer(linear, fit.model, one.claim, one.gain)


def as_sudden(fit: Fit, one: Candidate) -> bool:
    """Whether what a slow candidate explains may as well have happened at once."""
    return one.claim.physics.slow and one.gain < step_gain(fit, one.claim.place.recordings) + SLOW_OVER_STEP_GAIN


def matters(fit: Fit, one: Candidate) -> bool:
    """Whether a candidate explains enough of what is left beyond noise. Where much is left that it does not touch,
    the simulation is wrong in some way of its own (a law of compliance, corners), and small parts of that look like
    anything; most of all like a further physics of the mean tooth. Makers relieve both gears, so a relief explains
    what both do together."""
    physics, gain = one.claim.physics, one.gain
    further = physics.mean_tooth and any(c.physics.mean_tooth for c in fit.model.claims)
    if further and physics.shaped:
        gain = max(gain, together(fit.model, fit.scenes, fit.linear, physics)[0])
    beyond = fit.linear.system.beyond
    # A form of all teeth that their grade leaves open is not claimed; nor are its likenesses, tooth by tooth.
    as_one = one.claim.place.tooth is not None and fit.formed > GRADE_FORM_MISFIT_PART * beyond
    return gain > (MOSTLY if further or as_one else PARTLY) * beyond


def within_grade(fit: Fit, one: Candidate) -> bool:
    """Whether what all teeth of a gear have is no more than its grade leaves open: a slope, a bulge, and a part of
    that where it only sets in on the way up the flank."""
    gear, physics = one.claim.place.gear, one.claim.physics
    if gear is None or not physics.mean_tooth:
        return False
    sets_in = UNSTATED_SETS_IN if is_unstated(fit.model, gear) else SETS_IN
    part = sets_in if physics.shaped else 1.0
    return abs(one.claim.values[0]) < part * fit.model.scope.form[gear]


def by_coincidence(fit: Fit, one: Candidate) -> bool:
    """Whether a wave may as well be one of those that no gear pair makes, where the recordings hold many of them
    that are as large: in so many turns each is at an order of either shaft by chance now and then."""
    if one.claim.place.order is None:
        return False
    chance = sum(_chance_at_order(fit, gear) for gear in (0, 1))
    if len(fit.model.strangers) * chance <= COINCIDENCE:
        return False
    effect = fit.model.changed(fit.scenes, one.claim) or [np.zeros(1)]  # no gears run with so much of it
    return as_large(fit, max(float(np.std(part)) for part in effect)) * chance > COINCIDENCE


def by_chance_once_per_turn(fit: Fit, claim: Claim) -> float:
    """How many waves of no cause, as large as what a ``claim`` has once per turn of its shaft, are expected there by
    chance; none at other orders. In 4.4 turns of a sound gear a belt that turned 1.0135 times as fast, beside two more
    waves of the drive, was named an eccentricity of 9.5 um."""
    if order_of(claim) != 1 or not fit.model.strangers:
        return 0.0
    return _chance_at_order(fit, claim.place.gear or 0) * as_large(fit, fit.model.rms_of(fit.scenes, claim))


def _chance_at_order(fit: Fit, gear: int) -> float:
    """Chance that a wave of any order is taken for one of a whole order of a shaft, in as many turns as there are."""
    angles = [(scene.samples.theta_1, scene.samples.theta_2)[gear] for scene in fit.scenes]
    return 2.0 * SNAP * 2.0 * math.pi / max(float(np.ptp(angle)) for angle in angles)


def as_large(fit: Fit, rms: float) -> int:
    """How many waves of unknown make are still fitted that have at least half of an ``rms`` in mm: large claims
    that nobody has made yet leave small ones at all places."""
    fitted = fit.linear.system.solution[fit.linear.layout.foreign] / math.sqrt(2.0)
    sizes = [max(math.hypot(fitted[at], fitted[at + 1]) for at in one[::2]) for one in fit.model.strangers]
    return sum(size > SIMILAR * rms for size in sizes)


def step_gain(fit: Fit, recordings: Sequence[int] = ()) -> float:
    """Gain of the best steps in ``recordings`` (none: in all), one in each. What happens at once looks like
    something slow, and is not. Every step but the first costs its freedom and the choice of its moment."""
    these = [k for k, _ in enumerate(fit.model.observed) if not recordings or k in recordings]
    best, *others = sorted((_best_step(fit, [k]) for k in these), reverse=True)
    apart = best + sum(max(0.0, gain - 2.0 * (1.0 + math.log(STEP_MOMENTS_TRIED))) for gain in others)
    # Recordings that drift alike may jump alike.
    return max(apart, _best_step(fit, these))


def _best_step(fit: Fit, recordings: Sequence[int]) -> float:
    """Gain of the best step of ``recordings`` that all jump alike and at the same part of each, its moment found
    coarsely and then between the neighbours: one that is tried beside the true moment loses part of its gain."""
    most, low, high = 0.0, 0.0, 1.0
    for _ in range(STEP_MOMENT_ROUNDS):
        moments = np.linspace(low, high, STEP_MOMENTS_TRIED + 2)[1:-1]
        gains = _steps(fit, recordings, moments)
        at, apart = int(np.argmax(gains)), float(moments[1] - moments[0])
        most, low, high = max(most, float(gains[at])), moments[at] - apart, moments[at] + apart
    return most


def _steps(fit: Fit, recordings: Sequence[int], moments: FloatArray) -> FloatArray:
    """Gain (q,) of a step at each of ``moments`` (q,), parts of a recording, in all of ``recordings`` alike; 0
    where it is told from nothing."""
    sums = []
    for k in recordings:
        n = fit.model.observed[k].samples.size
        sums.append(fit.linear.sums(k, (np.arange(n)[:, None] >= n * moments).astype(np.float64)))
    score, information = fit.linear.system.beside(sums)
    known = np.diag(information)
    told = known > LEAST_INFORMATION_PART * np.max(known, initial=0.0)
    return np.where(told, score**2 / np.where(told, known, 1.0), 0.0)


def pays(fit: Fit, one: Candidate) -> bool:
    """Whether the halves of the recordings are likelier with the candidate, each by what the other tells."""
    columns = columns_of(fit.model, fit.scenes, fit.linear, one)
    return paid_by(fit, one.claim, fit.linear.system, fit.linear.system.with_columns(columns))


def paid_by(fit: Fit, claim: Claim, plain: System, wider: System) -> bool:
    """The same of a ``claim`` that ``wider`` has and ``plain`` has not."""
    slow = claim.physics.slow
    masks = [
        blocks(one.fit.size, one.jumps, parts=SLOW_BLOCKS_BETWEEN_JUMPS) if slow else one.fit
        for one in fit.model.observed
    ]
    others = [~mask for mask in masks]
    if not all(np.any(mask) for mask in others):
        return True
    halves = masks, others
    return sum(log_predictive(wider, one) - log_predictive(plain, one) for one in halves) > 0.0


def gain_without(fit: Fit, k: int) -> float:
    """What claim ``k`` gains, all else fitted again without it; nothing where the fit would have less of it than
    none, as of a pit where it wants a bump, or more than there can be: then it is something else."""
    system, claim = fit.linear.system, fit.model.claims[k]
    a = claim.physics.amplitudes
    sizes = system.solution[fit.linear.layout.places(k)[:a]]
    bounds = [one.bounds(fit.model.scope, claim.place) for one in claim.physics.coordinates[:a]]
    fixed = claim.physics.fixed_amplitudes  # held at what they are, which is their largest
    if any(size <= low or (size >= high and not fixed) for size, (low, high) in zip(sizes, bounds, strict=True)):
        return 0.0
    return system.without(fit.linear.layout.places(k)).misfit - system.misfit
