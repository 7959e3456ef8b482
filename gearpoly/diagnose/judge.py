"""How probable a claim is beside all that could stand in its place: its look-alikes, and what has no cause."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.noise import mean_innovation
from gearpoly.diagnose.absent import misfit_without_mesh, misfit_without_sheet, of_the_sheet
from gearpoly.diagnose.conditions import with_and_without
from gearpoly.diagnose.contest import Key, Refitted
from gearpoly.diagnose.fidelity import BESIDE_ANOTHER, FAINT_EFFECT_MM, OF_CORNERS
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.scan import Candidate, polished, scan
from gearpoly.diagnose.system import System
from gearpoly.diagnose.teeth_scale import counted, gain_beside_any
from gearpoly.diagnose.tooth_forms import gain_beside_form
from gearpoly.diagnose.trial import POSSIBLE, Trial, ordinary_rms
from gearpoly.infer.posterior import Explanation, Posterior, Sized, weighed
from gearpoly.infer.prior import (
    AS_WRONG_KEYS,
    AT_THE_EDGE,
    LEAST_SHARE,
    NOT_IN_RECORDINGS,
    PRESENT,
    SHAPED_BY_KEYS,
    TIPS,
    WRONG_KEY,
    WRONG_UM,
    log_size,
    share_of_causes,
    unknown_share,
)
from gearpoly.physics.base import Claim, Physics
from gearpoly.physics.place import Place
from gearpoly.scene import Scene
from gearpoly.units import BoolArray, FloatArray

MATE_DAMAGE_GAIN_PART = 0.25
"""The same for a damage of the mate's tooth, whose coarse shapes are laid elsewhere than those of the claim: where two
teeth always meet, either has it."""

PIT, TIP = "tooth_spall", "tooth_chip"
"""Two physics that say the same where the pit ends at the tip circle: the flank is gone there."""

MISSING_TIP_BEHIND_PART, PIT_AT_TIP_MODULES = 0.1, 0.05
"""Part of its gain by which a missing tip may be behind such a pit and be as likely, and modules from the tip circle at
which a pit ends there: no tip breaks off with the sharp edge that is drawn. Of one 0.84 mm high the pit had 1850 of
misfit, and the missing tip 131 less. Judgements."""

REACHES = 2.0 * math.log(4.0)
"""Misfit that it costs a pit to reach the tip circle: every fourth does, as of the windows in which one is looked for.
A judgement."""

RIVALS_LOOKED_AT = 12
"""Rivals that are looked at closely."""

SHARED_SAMPLES_PART = 0.1
"""Part of the samples in which a claimed tooth is in mesh that another must share to be looked at: what shares less can
explain about as little of it, and a look-alike has to explain at least ``MATE_DAMAGE_GAIN_PART``."""


@dataclass(frozen=True, kw_only=True)
class Judged:
    """A claim with its ``gain`` in misfit and the probabilities at its place; ``in_vain``: that of nothing being there
    of what the pair file foretells at that place, were no other cause unknown."""

    gain: float
    posterior: Posterior
    in_vain: float = 0.0


def judge(
    model: Model,
    scenes: list[Scene],
    linear: Linear,
    k: int,
    *,
    refitted: Sequence[Refitted] = (),
    places: int = 1,
    without: float | None = None,
    gone: Collection[Key] = (),
    deflection: float = 0.0,
    by_chance: float = 0.0,
) -> Judged:
    """Fit claim ``k`` against everything that could stand in its place, all else fitted again; ``places``: how many
    of its kind were looked at; ``without``: by how much the misfit rises where all is fitted to its end without it
    (None: as much as to first order); ``gone``: what was given up already, where a curve of no cause stands now: it
    explains still what it did there, and nothing here; ``by_chance``: waves of no cause that are expected there."""
    claim = model.claims[k]
    plain, wider = with_and_without(model, scenes, linear, k)
    bare = linear.without(linear.layout.places(k) + linear.layout.form_places(model, k))
    gain = bare.system.misfit - bare.system.with_columns(linear.white_of(k)).misfit
    drawn = model.drawn_without(claim, scenes) if claim.takes_contact else scenes
    trial = Trial(
        others=model.but(claim), scenes=drawn, linear=linear, plain=plain, dispersion=max(1.0, linear.system.whiteness)
    )
    effect = model.change(scenes, claim, claim.values, but=claim)
    columns = [one.part(linear.layout.claims[k]) for one in linear.columns]
    trial, without_cause = trial.at(claim, size=ordinary_rms(model, claim, columns, effect), effect=effect)
    ways = (_standing(trial, claim, linear, k, wider, effect, loose=loose) for loose in (False, True))
    mine = trial.either_form(ways)
    rise = 0.0 if without is None else without - (plain.misfit - linear.system.misfit)
    # Of all teeth the whole counts that was simulated; what is one wave or one mean, an unknown cause does as well.
    more = max(0.0, rise) if claim.physics.mean_tooth else 0.0
    mine += 0.5 * more / trial.dispersion
    found: dict[Key, tuple[Claim, float]] = {claim.key: (claim, mine)}
    for refit in refitted:
        found[refit.claim.key] = (refit.claim, mine - 0.5 * _behind(model, claim, refit, gain) / trial.dispersion)
    # Look-alikes are drawn to first order, so the claim is too where it is weighed against them.
    flat = replace(trial, plain=bare.system.without(trial.dropped))
    plainly = (flat.sized(claim, columns, effect, loose=loose) for loose in (False, True))
    ahead = mine - flat.either_form(plainly) if claim.simulated else 0.0
    for one in _look_alikes(model, trial, bare, claim, gain, gone):
        # What was fitted to its end is known better than straight lines tell.
        if one.claim.key not in found:
            found[one.claim.key] = (one.claim, ahead + flat.of(one.claim))
    places_of = (Claim(physics=physics, place=place, values=()) for physics, place in _possible(model, claim))
    weights = share_of_causes(claim, (claim, *places_of))
    # Of the other gear or shaft it is as common as at the place of the claim.
    common = {name: share for (name, _), share in weights.items()}
    explanations = [
        Explanation(claim=one, log_evidence=log, weight=common.get(one.physics.name, LEAST_SHARE))
        for one, log in found.values()
    ]
    known, vain = list(explanations), _in_vain(model, trial, claim, mine, more)
    explanations += [*trial.explanations(without_cause), *vain]
    odds = 1.0 / (1.0 / unknown_share(claim, model.scope) - 1.0) + by_chance  # either makes it
    share = odds / (1.0 + odds)
    if claim.physics.name in SHAPED_BY_KEYS:
        usual = claim.physics.ordinary[0]
        likelier = log_size(claim.values[0], WRONG_UM) - log_size(claim.values[0], usual)
        weight = WRONG_KEY * (1.0 - share) / share * common.get(claim.physics.name, LEAST_SHARE)
        explanations.append(Explanation(claim=None, log_evidence=mine + likelier, weight=weight))
    if _as_other_tips(model, claim):
        as_likely = (1.0 - share) / share * common.get(claim.physics.name, LEAST_SHARE)
        explanations.append(Explanation(claim=None, log_evidence=mine, weight=TIPS * as_likely))
    # Where all fits better without than straight lines tell, whatever stands there has gained so much less.
    less = 0.5 * min(0.0, rise) / trial.dispersion
    beside_form = gain_beside_form(model, scenes, linear, k, gain)
    as_graded = gain - beside_form + _by_scale(model, linear, claim, beside_form)
    less -= 0.5 * min(as_graded, gain) / trial.dispersion
    explanations = [replace(one, log_evidence=one.log_evidence + less) for one in explanations]
    explanations = _told_apart(trial, claim, explanations, effect=effect, deflection=deflection)
    in_vain = weighed([*known, *vain], unknown_share=share, places=places).unknown
    return Judged(gain=gain, posterior=weighed(explanations, unknown_share=share, places=places), in_vain=in_vain)


def _as_other_tips(model: Model, claim: Claim) -> bool:
    """Whether tips that nobody measured do what a ``claim`` does: on one flank of uninspected gears what sets axes or
    flanks apart, and anywhere what takes so little off a tip."""
    scope, gear = model.scope, claim.place.gear or 0
    if claim.physics.name == "tip_relief":
        return not scope.inspected[gear] and claim.values[1] < AT_THE_EDGE * scope.gears[gear].m
    return claim.physics.name in AS_WRONG_KEYS and len(model.as_built.flanks) == 1 and not all(scope.inspected)


def _by_scale(model: Model, linear: Linear, claim: Claim, gain: float) -> float:
    """By how much a ``gain`` counts for less where teeth may make it whose scale nobody stated, or for more where they
    are finer than the grade that they keep. What all teeth do is not asked, and what no teeth of any scale can do
    counts as it is: no index deviation makes the edges of a pit of 15 um, which gained 2700."""
    gear = claim.place.gear
    if gear is None or claim.physics.mean_tooth or not model.as_built.gears[gear].graded:
        return 0.0
    return gain - counted(linear, model, claim, gain, beside_any=gain_beside_any(linear, model, gear, claim))


def _behind(model: Model, claim: Claim, refit: Refitted, gain: float) -> float:
    """How far a rival that was fitted to its end is behind the ``claim`` in misfit, or ahead of it (negative). Of a
    missing tip and a pit that ends at the tip circle, the tip is not behind, but for how the edge was drawn; nor is the
    pit on one flank alone: its end, its depth and its wall tell nothing there, and only that it reaches the tip costs.
    Of 40 um off the upper 0.6 mm of one flank a missing tip was made, 99 in 100."""
    behind = refit.behind + freer(refit.claim, claim, gain)
    fits = refit.behind + 2.0 * (len(claim.values) - len(refit.claim.values))
    if {refit.claim.physics.name, claim.physics.name} != {PIT, TIP} or abs(fits) >= MISSING_TIP_BEHIND_PART * gain:
        return behind
    is_pit = refit.claim.physics.name == PIT
    if not _at_tip(model, refit.claim if is_pit else claim):
        return behind
    if len(model.as_built.flanks) > 1:
        return behind if is_pit else min(behind, 0.0)
    return REACHES if is_pit else -REACHES


def _at_tip(model: Model, claim: Claim) -> bool:
    """Whether a pit reaches the tip circle of its gear to less than its wall."""
    gear = model.scope.gears[claim.place.gear or 0]
    return claim.physics.name == PIT and gear.r_a - max(claim.values[1:3]) < max(
        claim.values[3], PIT_AT_TIP_MODULES * gear.m
    )


def freer(one: Claim, other: Claim, gain: float) -> float:
    """What the freedoms cost in misfit that a claim has more than another of this ``gain``. Each costs as much as it
    might have told (Schwarz 1978), of which a refit counts 2: a spall that ends at the tip makes all that a missing tip
    makes, and has edges, a wall and a depth to make it with."""
    return (len(one.values) - len(other.values)) * (max(2.0, math.log(max(gain, 1.0))) - 2.0)


def _in_vain(model: Model, trial: Trial, claim: Claim, mine: float, more: float) -> list[Explanation]:
    """That what is foretold at the place of a ``claim`` is not in the recordings at all; nothing where nothing is.
    ``mine`` is the claim's own log evidence, ``more`` the rise in misfit without it that no straight line tells."""
    linear, leave, gear = trial.linear, trial.dropped, claim.place.gear
    if claim.physics.mean_tooth:
        misfit = misfit_without_mesh(model, trial.scenes, linear, leave=leave)
        others = sum(one.physics.mean_tooth for one in model.claims) - 1
    elif gear is not None and (alike := of_the_sheet(model, claim)):
        misfit, others = misfit_without_sheet(model, linear, gear, alike, leave=leave), len(alike) - 1
    else:
        return []
    with_it = linear.system.without(leave).misfit
    whole = 0.5 * (trial.plain.misfit - with_it + more) / trial.dispersion
    behind = 0.5 * (misfit - with_it) / trial.dispersion
    # The others that cancel it together have each to be there, and pay for their freedoms as this one does.
    log = whole - behind + others * max(0.0, whole - mine - math.log(PRESENT))
    return [Explanation(claim=None, log_evidence=log, weight=NOT_IN_RECORDINGS)]


def _told_apart(
    trial: Trial,
    claim: Claim,
    explanations: Sequence[Explanation],
    *,
    effect: Sequence[FloatArray],
    deflection: float,
) -> list[Explanation]:
    """The ``explanations`` of a place, those that only the simulation's own error tells from the ``claim`` as likely as
    it. What turns once with a shaft is known as far as corners hand over its ``effect`` (n_k,) in mm; a physics of all
    teeth beside another as far as laws of compliance have the ``deflection`` in mm right. A curve of no cause stands
    beside what no law has right already, so it counts as it is."""
    if claim.physics.once_per_turn:
        corners = OF_CORNERS * math.sqrt(float(np.mean(np.concatenate([one**2 for one in effect]))))
        return _as_far_as_simulated(trial, claim, explanations, max(FAINT_EFFECT_MM, corners))
    mean_tooth = claim.physics.mean_tooth
    if mean_tooth or claim.shapes_tooth:
        # Pits of two teeth that always meet differ in how flanks roll in their walls alone.
        alike = [one for one in explanations if one.claim and (mean_tooth or one.claim.physics is claim.physics)]
        known_to = max(FAINT_EFFECT_MM, BESIDE_ANOTHER * deflection if mean_tooth else 0.0)
        others = [one for one in explanations if not any(one is other for other in alike)]
        return [*_as_far_as_simulated(trial, claim, alike, known_to), *others]
    return list(explanations)


def _as_far_as_simulated(
    trial: Trial, claim: Claim, explanations: Sequence[Explanation], known_to: float
) -> list[Explanation]:
    """The same where the claim is ahead of each other, or behind it, only by more than the simulation itself is
    ``known_to`` in mm rms. What turns once with a shaft differs in second order alone, of which chords, contacts and
    corners leave as much now and then; what is the same at every mesh under load differs by what no law of compliance
    has right. Of plastic gears the driven one was called worn by 18.7 um: the driving one was, by 14.5 um, and came out
    behind by 32 of misfit in 24 000 samples, 0.036 um rms, where teeth gave by some 15 um."""
    mine = next(one for one in explanations if one.claim is not None and one.claim.key == claim.key)
    faint = math.sqrt(trial.plain.samples) * known_to / mean_innovation(trial.linear.noises)

    def told(one: Explanation) -> Explanation:
        ahead = mine.log_evidence - one.log_evidence
        if not math.isfinite(ahead):
            return one
        apart = 0.5 * max(0.0, math.sqrt(2.0 * trial.dispersion * abs(ahead)) - faint) ** 2 / trial.dispersion
        return replace(one, log_evidence=mine.log_evidence - math.copysign(apart, ahead))

    return [told(one) for one in explanations]


def _standing(
    trial: Trial, claim: Claim, linear: Linear, k: int, wider: System, effect: Sequence[FloatArray], *, loose: bool
) -> Sized:
    """The claim that stands, by all that it does where that is simulated; ``loose``: with the doubt about its form."""
    columns = [one.part(linear.layout.claims[k]) for one in linear.columns]
    sized = trial.sized(claim, columns, effect, loose=loose)
    if not claim.simulated:
        return sized
    unit = abs(claim.values[0]) or 1.0
    whole = [a.part([wider.size - 1]) for a in wider.white]
    std = sized.std.copy()
    std[0] /= unit
    low, high = (one / claim.values[0] if claim.values[0] else one for one in sized.bounds)
    return replace(
        sized,
        columns=[np.concatenate((one, mine[:, 1:]), axis=1) for one, mine in zip(whole, sized.columns, strict=True)],
        std=std,
        bounds=(min(low, high), max(low, high)),
    )


def _look_alikes(
    model: Model, trial: Trial, bare: Linear, claim: Claim, gain: float, gone: Collection[Key]
) -> Iterator[Candidate]:
    """Claims that may stand in another's place as far as their coarse shapes tell, at the shapes that gain most: what
    gains as much beside the claim explains something else."""
    others, scenes = trial.others, trial.scenes
    candidates, _ = scan(others, scenes, bare, only=_possible(others, claim))

    def part(one: Candidate) -> float:
        twin = one.claim.physics is claim.physics and claim.physics.shaped and one.claim.place.gear != claim.place.gear
        return MATE_DAMAGE_GAIN_PART if twin and claim.place.tooth is not None else POSSIBLE

    ones = [c for c in candidates if c.gain > part(c) * gain][: 4 * RIVALS_LOOKED_AT]
    there = {(one.claim.physics.name, one.claim.place): one.claim for one in ones}
    beside, _ = scan(model, scenes, trial.linear, only=[(one.physics, one.place) for one in there.values()])
    kept = {(one.claim.physics.name, one.claim.place): one.gain for one in beside}
    seen = {claim.key, *gone}
    for one in ones:
        if one.claim.key in seen or len(seen) > RIVALS_LOOKED_AT + len(gone):
            continue
        if one.gain - kept.get((one.claim.physics.name, one.claim.place), 0.0) < part(one) * gain:
            continue
        seen.add(one.claim.key)
        yield polished(others, scenes, bare, one)


def _possible(model: Model, claim: Claim) -> Iterator[tuple[Physics, Place]]:
    """Places at which something like the claim could be: no tooth is mistaken for one that is seldom in
    mesh with it, or for a wave, nor order 61 for order 12."""
    taken = {one.key for one in model.claims if one is not claim}
    together = None if claim.place.tooth is None else _in_mesh_with(model, claim.place)
    for physics in model.method.physics:
        if physics.wavelike and claim.place.order is None:
            continue
        for place in (*physics.places(model.scope), *physics.instead(model.scope, claim.place)):
            if physics.wavelike and not _same_wave(model, place, claim.place):
                continue
            if place.tooth is not None and (together is None or (place.gear or 0, place.tooth) not in together):
                continue
            key = Claim(physics=physics, place=place, values=()).key
            if key not in taken and key != claim.key and model.scope.shows(place, by_teeth=physics.by_teeth):
                yield physics, place


def _in_mesh_with(model: Model, place: Place) -> set[tuple[int, int]]:
    """Gears and teeth that are in mesh in at least a part ``SHARED_SAMPLES_PART`` of the samples in which a tooth
    is."""
    gears, samples = model.scope.gears, model.samples()

    def where(gear: int, tooth: int) -> BoolArray:
        parts = [np.isin(np.arange(one.size), one.meshing(gear, tooth, z=gears[gear].z)) for one in samples]
        return np.concatenate(parts)

    own = where(place.gear or 0, place.tooth or 0)
    least = SHARED_SAMPLES_PART * float(np.count_nonzero(own))
    return {
        (gear, tooth)
        for gear in (0, 1)
        for tooth in range(gears[gear].z)
        if float(np.count_nonzero(where(gear, tooth) & own)) >= least
    }


def _same_wave(model: Model, one: Place, other: Place) -> bool:
    """Whether waves on either shaft have the same frequency, or on one shaft the same order."""
    z = [gear.z for gear in model.scope.gears]
    if one.order is None or other.order is None or one.gear is None or other.gear is None:
        return False
    return one.order * z[other.gear] == other.order * z[one.gear]
