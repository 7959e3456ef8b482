"""Forward, backward, and all together again: which physics the evidence makes necessary."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.diagnose.claimed import accepted, claimed, laws_anew
from gearpoly.diagnose.exchange import SUBSTITUTE_GAIN_PART, gained_since, misfit_saved, without_idle
from gearpoly.diagnose.fit import BETTER_STATE_GAIN, Fit, better_of, forgotten, joined, settled, shared
from gearpoly.diagnose.kept import Kept, come_back, kept
from gearpoly.diagnose.leaning import leaning
from gearpoly.diagnose.multi_start import multi_started
from gearpoly.diagnose.placing import anywhere, phases_tried
from gearpoly.diagnose.relaxed import relaxed
from gearpoly.diagnose.relieved import relieved
from gearpoly.diagnose.scan import Candidate, polished, scan
from gearpoly.diagnose.softness import with_best_law, with_declared_law, with_wider_laws
from gearpoly.diagnose.unnamed import (
    is_weighed,
    left_unnamed,
    likeliest,
    more_unnamed,
    slow_unnamed,
    waves_unnamed,
    weigh_at,
)
from gearpoly.diagnose.weigh import MOSTLY, gain_without, hopeful, matters, pays, significant, within_grade
from gearpoly.errors import GearpolyError
from gearpoly.infer.prior import order_of
from gearpoly.physics.base import Claim
from gearpoly.threads import each

OTHER_STEPS_GONE_BACK_TO, LEFT_TO_GO_BACK = 2, 0.2
"""Other steps that are gone back to, where the search ended with more misfit beyond noise than this part of noise's
own."""

MOST_CLAIMS = 8
"""Claims after which the search stops: so many mean that the pair file is wrong as a whole."""

DOUBTED = 2.0
"""Mean square of what is left, in noise, from which on the pair file is doubted as a whole: as much repeats as is
noise."""

CLAIMS_TO_DOUBT_ONE_END = 4
"""Claims from which on one end is doubted however well it fits: so many may each take a little of what two are."""

LEFT_BESIDE_BENDING, TOLD_BESIDE_BENDING = 0.05, 0.1
"""Misfit beyond noise over noise's own that is left beside teeth that bend, and part of it that the best candidate
explains, from and below which reliefs are asked at once. In the shipped set of three torques 0.13 was left, of which a
missing tip explained a twentieth; with both reliefs 0.00. Four such tips took 270 s before they were asked."""

POLISHED = 4
"""Candidates of different kinds that are polished before one is taken."""

MINIMA_APART = 200.0
"""Misfit in sigmas squared by which local minima of unloaded teeth may differ: claims of nothing had gained 41 to 93 in
three pairs of grade 6 that were recorded at 8 to 10 samples per mesh."""

SHORTLIST = 160
"""Candidates from which those are chosen, best first."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Road:
    """A step that might have been taken: the ``claim`` instead of the one that was, from the ``state`` before; it
    gained this ``part`` of what that one did, more than all of it where its place was chosen among more."""

    state: Kept
    claim: Claim
    part: float


def run_search(fit: Fit) -> tuple[Fit, list[Candidate]]:
    """Make claims until none pays; the fit with them, and the candidates of the last look.

    Where much is left then, a step that was contested may have been wrong: wind-up takes all that several torques
    show of bending at first, and the reliefs that would tell them apart come later. So bending and reliefs are
    tried together, also where few claims or many seem to do; the other steps are gone too, and the best end is
    kept. Many are not waited for where those few explain more.
    """
    fit = forgotten(fit)
    start, missing = kept(fit), fit.linear.system.beyond
    fit, found, roads = forward(fit, CLAIMS_TO_DOUBT_ONE_END, until=beside_bending)
    before, early = fit, beside_bending(fit, found)
    if early or len(fit.model.claims) >= CLAIMS_TO_DOUBT_ONE_END:
        fit, found = otherwise(fit, start, relieved(fit.model), found, most=CLAIMS_TO_DOUBT_ONE_END)
    if (early and fit is before) or len(fit.model.claims) >= CLAIMS_TO_DOUBT_ONE_END:
        # Those few are tried once more at the end, without a limit: beside them others may be many as well.
        fit, found, more = forward(fit)
        roads += more
    if strained(fit) or several_of_all(fit):
        fit, found = otherwise(fit, start, relieved(fit.model), found)
    fit, found = _leant(fit, start, found)
    for road in sorted(roads, key=lambda one: -one.part)[:OTHER_STEPS_GONE_BACK_TO]:
        if strained(fit):
            fit, found = otherwise(fit, road.state, [road.claim], found)
    law, fit = fit.model.law, laws_anew(fit)
    if fit.model.law != law:
        fit, found, _ = forward(fit)
    end = finished(fit, missing)
    if end.over or misfit_saved(end, fit) <= BETTER_STATE_GAIN:
        return end, found
    # A claim had kept the teeth in a local minimum, and what was looked at was looked at from there.
    further, looked, _ = forward(end)
    return (end, found) if further.model is end.model else (finished(further, missing), looked)


def finished(fit: Fit, missing: float) -> Fit:
    """A search's end: without claims that do not stand beside the others, of the misfit beyond noise that was
    ``missing`` before any."""
    return with_wider_laws(withdrawn(disowned(fit, missing)))


def doubted(fit: Fit) -> bool:
    """Whether as much is left as is noise, so that the pair file is doubted as a whole."""
    return fit.linear.system.whiteness > DOUBTED


def strained(fit: Fit) -> bool:
    """Whether the search has ended with much left, or with so many claims that few others may be what they are."""
    much = fit.linear.system.beyond >= LEFT_TO_GO_BACK * fit.linear.system.samples
    return much or len(fit.model.claims) >= CLAIMS_TO_DOUBT_ONE_END


def several_of_all(fit: Fit) -> bool:
    """Whether several physics of all teeth are claimed that may be what bending leaves of reliefs together."""
    ones = [one.physics for one in fit.model.claims if one.physics.mean_tooth]
    return len(ones) > 1 and sum(one.shaped for one in ones) < 2


def beside_bending(fit: Fit, found: Sequence[Candidate]) -> bool:
    """Whether teeth that bend are claimed and none of the candidates ``found`` beside them explains a fair part of what
    is left: reliefs that cancel the bending show as little of everything then."""
    left = fit.linear.system.beyond
    much = left > LEFT_BESIDE_BENDING * fit.linear.system.samples
    if not much or max((one.gain for one in found), default=0.0) > TOLD_BESIDE_BENDING * left:
        return False
    claims, state = {one.physics.name for one in fit.model.claims}, relieved(fit.model)
    there = {one.physics.shaped for one in state if one.physics.name in claims}
    return there == {False}  # bending is claimed, and no relief


def otherwise(
    fit: Fit, state: Kept, claims: list[Claim], found: list[Candidate], *, most: int = MOST_CLAIMS
) -> tuple[Fit, list[Candidate]]:
    """Search once more from a ``state`` on with ``claims``, unless there are none, and keep the end that fits better,
    if it comes before ``most`` claims where few were asked for; with the candidates of its last look, ``found`` or
    others."""
    if not claims or fit.over:
        return fit, found
    begun = accepted(come_back(state, fit), claims)
    if begun is None:
        return fit, found
    other, looked, _ = forward(begun, most)
    ended = most == MOST_CLAIMS or len(other.model.claims) < most
    return (other, looked) if ended and gained_since(other, fit) > BETTER_STATE_GAIN else (fit, found)


def _leant(fit: Fit, start: Kept, found: list[Candidate]) -> tuple[Fit, list[Candidate]]:
    """Search once more from the ``start`` on with flanks that all lean, where they may, and keep the end that fits
    better."""
    there = leaning(fit, start)
    if there is None:
        return fit, found
    other, looked, _ = forward(there)
    return (other, looked) if gained_since(other, fit) > BETTER_STATE_GAIN else (fit, found)


def disowned(fit: Fit, missing: float) -> Fit:
    """Without claims about single teeth that do not end and leave a good part of the misfit beyond noise that was
    ``missing`` before any, and all others that explain less than is left: whatever it is, it looks like each of
    them here and there, and keeps no name."""
    left = fit.linear.system.beyond
    if len(fit.model.claims) < MOST_CLAIMS or left < MOSTLY * missing:
        return fit
    ones = enumerate(fit.model.claims)
    stay = tuple(one for k, one in ones if one.place.tooth is None and gain_without(fit, k) > left)
    gone = len(fit.model.claims) - len(stay)
    without = better_of(fit, lambda one: settled(one.believing(claims=stay)), better=-math.inf)
    return without_idle(fit if without is fit else replace(without, disowned=gone))


def forward(
    fit: Fit, most: int = MOST_CLAIMS, *, until: Callable[[Fit, Sequence[Candidate]], bool] = lambda *_: False
) -> tuple[Fit, list[Candidate], list[Road]]:
    """Make claims until none pays, there are so many, or a look is one that is waited for; the fit with them, the
    candidates of the last look, and the steps that might have been taken."""
    refused: set[tuple[object, ...]] = set()
    found: list[Candidate] = []
    roads: list[Road] = []
    looked = False
    while len(fit.model.claims) < most and len(refused) <= MOST_CLAIMS and not fit.over:
        if not looked:
            fit.step(f"looking for what is missing ({len(fit.model.claims)} found)")
            found, places = scan(fit.model, fit.scenes, fit.linear)
            formed = max((one.gain for one in found if within_grade(fit, one)), default=0.0)
            fit = replace(fit, looked=places, formed=formed)
            if until(fit, found):
                break
        ones = likely_ones(fit, found, refused)
        best = next((one for one in ones if matters(fit, one) and (is_weighed(one.claim) or pays(fit, one))), None)
        left = fit
        if best is None:
            left = waves_unnamed(slow_unnamed(fit, ones), found[:SHORTLIST])
        elif best is not ones[0] and ones[0].claim.physics.slow:
            # What gains most of all and is not told hides what the others do to unseen data.
            left = slow_unnamed(fit, ones[:1])
        there = None if left is fit else _settled(left)
        if there is not None:
            fit, looked = there, False
            continue
        if best is None:
            break
        weighed = weigh_at(fit, best)
        unnamed = None if weighed is None else left_unnamed(fit, best.claim, weighed)
        if unnamed is not None:
            there = _settled(more_unnamed(unnamed, found[:SHORTLIST], besides=best.claim))
            looked = there is None
            refused |= {best.claim.key} if there is None else set()
            fit = there or fit
            continue
        first = best.claim.key
        chosen = likeliest(best, weighed)
        if chosen is not None and chosen.claim.key in refused:
            # What was likelier to first order did not stand, so nothing speaks against the candidate itself.
            chosen = best
        looked = True  # where nothing changes, the next best of the same look is tried
        if chosen is None:
            refused.add(first)
            continue
        best = chosen
        fit.step(f"fitting {best.claim.physics.name.replace('_', ' ')}")
        there = claimed(fit, best, found)
        if there is None:
            refused.add(best.claim.key)
            continue
        before, fit, looked = kept(fit), there, False
        roads += [
            Road(state=before, claim=one.claim, part=one.gain / best.gain)
            for one in ones
            if one.claim.physics is not best.claim.physics and one.gain > SUBSTITUTE_GAIN_PART * best.gain
        ]
        refused -= {best.claim.key, first}
    return fit, found, roads


def _settled(fit: Fit) -> Fit | None:
    """Settled with the curves that were left without a name; None where gears cannot run with them."""
    try:
        return settled(fit)
    except GearpolyError:
        return None


def likely_ones(fit: Fit, found: list[Candidate], refused: set[tuple[object, ...]]) -> list[Candidate]:
    """The candidates that explain most, of several kinds, shapes polished, if they are more than chance."""
    chosen: list[Candidate] = []
    for one in found[:SHORTLIST]:
        alike = [other.claim.key for other in chosen if other.claim.physics is one.claim.physics]
        if len(alike) > 1 or one.claim.key in alike or one.claim.key in refused or not hopeful(fit, one):
            continue
        chosen.append(one)
        if len(chosen) == POLISHED:
            break
    done = each(lambda one: polished(fit.model, fit.scenes, fit.linear, one, roughly=True), chosen)
    done.sort(key=lambda one: -fit.looked.worth(one))
    return [one for one in done if significant(fit, one)]


def withdrawn(fit: Fit) -> Fit:
    """Without claims without which the rest fits hardly worse, and what was believed beside them only.

    Teeth of a grade had settled for the claim, and where unloaded ones touch had moved with it: to first order
    nothing can stand in its place, and a fit that had come to rest too early is taken for a claim. So it is beside
    a relief, whose length the claim has moved and with it the place where pairs hand over.
    """
    gone = False
    for k in reversed(range(len(fit.model.claims))):
        many = len(fit.model.claims)
        fit = _withdrawn(fit, k)
        gone = gone or len(fit.model.claims) < many
    return without_idle(shared(with_best_law(with_declared_law(fit)))) if gone else fit


def _withdrawn(fit: Fit, k: int) -> Fit:
    """Without claim ``k``, all fitted again, where that costs no more than chance; else with what it costs."""
    claim = fit.model.claims[k]
    if fit.over or not _settled_for(fit, claim):
        return fit
    fit.step(f"fitting without {claim.physics.name.replace('_', ' ')}")
    try:
        without = _fitted_without(fit, k)
    except GearpolyError:
        return fit
    few = len(claim.values)
    lost = 2.0 * few - gained_since(without, fit)
    if significant(without, Candidate(claim=claim, gain=lost, freedoms=few)):
        return replace(fit, rises=(fit.linear, {**_rises_here(fit), claim.key: lost}))
    return without


def _rises_here(fit: Fit) -> dict[tuple[object, ...], float]:
    """What ``rises`` knows of the present linear system."""
    return fit.rises[1] if fit.rises is not None and fit.rises[0] is fit.linear else {}


def rise_without(fit: Fit, k: int) -> float | None:
    """By how much the misfit rises where all is fitted to its end without claim ``k``, by the present noise; None
    where to first order nothing can have come to rest for it, or gears cannot run so."""
    claim = fit.model.claims[k]
    if fit.over or not _settled_for(fit, claim):
        return None
    if claim.key in (known := _rises_here(fit)):
        return known[claim.key]
    try:
        return _fitted_without(fit, k).linear.under(fit.noises).system.misfit - fit.linear.system.misfit
    except GearpolyError:
        return None


def _fitted_without(fit: Fit, k: int) -> Fit:
    """Everything fitted to its end without claim ``k``."""
    there = fit.linear.system.misfit
    without = relaxed(settled(joined(fit, [], instead=[k])))
    if without.linear.under(fit.noises).system.misfit < there + MINIMA_APART:
        without = multi_started(without, enough=there)
    unplaced = not fit.model.phased and not fit.model.stated
    return _placed_anew(without, fit) if unplaced and fit.model.claims[k].physics.mean_tooth else without


def _placed_anew(without: Fit, fit: Fit) -> Fit:
    """A fit ``without`` a claim, begun again where in their pitch its teeth fit best, if that leaves less misfit by the
    noise of the ``fit`` with it: neither curves nor zeros say where they stand. Where they stood wrong by 0.06 of a
    pitch a relief of 3 um was named, which gained 64; 0.06 of a pitch further on it gained 4."""
    model = without.model
    ((_, way),) = anywhere(model, without.foreign, [model.claims], phases=phases_tried(model))
    if way == 0.0:
        return without
    moved = replace(model, built=np.zeros_like(model.built)).moved(way)
    try:
        there = relaxed(Fit.begun(moved, without.foreign, without.step))
    except GearpolyError:
        return without
    there = replace(there, looked=without.looked, formed=without.formed, disowned=without.disowned)
    return min((without, there), key=lambda one: one.linear.under(fit.noises).system.misfit)


def _settled_for(fit: Fit, claim: Claim) -> bool:
    """Whether what stands beside a claim may have come to rest in another local minimum for it."""
    graded = any(gear.graded for gear in fit.model.as_built.gears)
    if graded and not all(scene.bends for scene in fit.scenes):
        return claim.place.tooth is None and order_of(claim) is None and not claim.physics.slow
    if not claim.physics.mean_tooth:
        return False
    beside = [one.physics for one in fit.model.claims if one is not claim]
    return (graded and claim.place.gear is not None) or any(one.mean_tooth and one.shaped for one in beside)
