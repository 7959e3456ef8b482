"""Exchange of claims, now that all the rest is known: for others, for other forms, for twins, for none."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from gearpoly.diagnose.fit import BETTER_STATE_GAIN, Fit, better_of, joined, settled
from gearpoly.diagnose.scan import Candidate, all_places, polished, scan, together
from gearpoly.diagnose.softness import by_declared_law, with_best_law
from gearpoly.diagnose.unearned import Unearned
from gearpoly.diagnose.unnamed import leaving
from gearpoly.diagnose.weigh import HEALTHY_SET_CHANCE, gain_without, significant
from gearpoly.errors import GearpolyError
from gearpoly.infer.prior import kind_of, order_of
from gearpoly.infer.unknown import Unknown, at_place
from gearpoly.physics.base import Claim
from gearpoly.physics.tooth_pitch import PHYSICS as PITCH
from gearpoly.units import UM

TWINS_ALIKE_PART = 0.1
"""Part of its mean by which a value of twins may differ for both to be alike."""

SWAPS = 4
"""Most exchanges after a claim."""

LIGHT_LOAD_PART, SET_BACK_MULTIPLE = 0.5, 4.0
"""Part of what other teeth of its gear carry, in the mean, below which a tooth may have left the mesh; and how far back
it is set for a trial, as a multiple of what its claim does and pairs are bent: well out of it."""

LEFT_OF_TOOTH, RESHAPED_STEPS = 0.5, 16.0
"""Misfit beyond noise over that of noise, where a claimed tooth is in mesh, from which its shape is doubted; and the
steps of a coordinate by which it is begun elsewhere: twice what a shape was polished by."""

SUBSTITUTE_GAIN_PART = 0.7
"""Part of a claim's gain that its substitute must reach by its coarse shapes to be polished, and that another first
step must have reached to be gone back to."""


def gained_since(fit: Fit, before: Fit) -> float:
    """By how much less a ``fit`` costs than the one ``before``, in misfit and in freedoms, both by the noise of that
    and by what is known of teeth now: misfits under different priors do not compare."""
    return misfit_saved(fit, before) + 2.0 * (freedoms(before.model.claims) - freedoms(fit.model.claims))


def misfit_saved(fit: Fit, before: Fit) -> float:
    """By how much less a ``fit`` misfits than the one ``before``, both by the noise of that and by what is known of
    teeth now."""
    teeth, there = fit.model.as_built, before.linear
    if before.model.as_built is not teeth:
        there = there.under(before.noises, teeth)
    return there.system.misfit - fit.linear.under(before.noises).system.misfit


def promised_more(fit: Fit, claim: Claim) -> float:
    """By how much more the present state misfits than a straight line from it promises, where a ``claim`` shapes a
    single tooth: much if no step led on, and what no step made true is not explained. Else nothing."""
    if not claim.shapes_tooth:
        return 0.0
    return fit.linear.system.misfit_at(fit.present()) - fit.linear.system.misfit


def swapped(fit: Fit) -> Fit:
    """With claims exchanged for others that explain more, now that all the rest is known."""
    for _ in range(0 if fit.over else SWAPS):
        better = max(
            (one for k in range(len(fit.model.claims)) for one in _better(fit, k)),
            key=lambda one: one[1],
            default=None,
        )
        if better is None:
            break
        k, _, claims = better
        try:
            fit = settled(joined(fit, claims, instead=[k]))
        except GearpolyError:  # first order promised what gears that run cannot do
            break
        fit = without_idle(fit)
    return fit


def _better(fit: Fit, k: int) -> list[tuple[int, float, list[Claim]]]:
    """What would explain more in the place of claim ``k``, with how much more: another physics, or one of both
    gears, of which it may be the likeness."""
    claim = fit.model.claims[k]
    if claim.physics.wavelike:
        return []
    leave = fit.linear.layout.places(k) + fit.linear.layout.form_places(fit.model, k)
    bare = fit.linear.without(leave)
    gain = bare.system.misfit - bare.system.with_columns(fit.linear.white_of(k)).misfit
    others = fit.model.but(claim)
    places = [
        (physics, place)
        for physics, place in all_places(others)
        if (not physics.wavelike and (place.gear, place.tooth) == (claim.place.gear, claim.place.tooth))
        or (place.tooth is None and claim.place.tooth is None and not physics.wavelike)
    ]
    found, _ = scan(others, fit.scenes, bare, only=places)
    out = []
    known = claim.physics
    shaped = [one for one in fit.model.method.physics if one.mean_tooth and one.shaped and one is not known]
    for physics in shaped if known.mean_tooth else ():
        both, claims = together(others, fit.scenes, bare, physics)
        if claims and both - 2.0 * freedoms(claims) > gain - 2.0 * len(claim.values) + BETTER_STATE_GAIN:
            out.append((k, both - gain, claims))
    for one in [c for c in found if c.claim.key != claim.key and c.gain > SUBSTITUTE_GAIN_PART * gain][:2]:
        done = polished(others, fit.scenes, bare, one)
        if done.gain - 2.0 * done.freedoms > gain - 2.0 * len(claim.values) + BETTER_STATE_GAIN:
            out.append((k, done.gain - gain, [done.claim]))
    return out


def reshaped(fit: Fit, claims: Sequence[Claim] | None = None) -> Fit:
    """With ``claims`` of the fit (None: all) exchanged for the same in another form, where that fits better: else other
    physics draw the rest."""
    these = None if claims is None else {one.key for one in claims}
    for k, claim in enumerate(() if fit.over else fit.model.claims):
        if these is not None and claim.key not in these:
            continue
        # What takes less of a flank and has no other form need only be as good.
        by = BETTER_STATE_GAIN if claim.place.form else 0.0
        for _ in range(SWAPS):
            before = fit
            # What came of another beginning may have another form in turn: a bowl, as pits with a flat bottom.
            fit = _first_exchanged(fit, k, fit.model.claims[k].otherwise(fit.model.scope), by=by)
            for one in _aside(fit, fit.model.claims[k]):
                fit = _exchanged(fit, k, one, by=BETTER_STATE_GAIN)
            if fit is before:
                break
    return fit


def _aside(fit: Fit, claim: Claim) -> list[Claim]:
    """A shaped claim about a single tooth with each coordinate of its shape moved, where it leaves more than noise
    of that tooth: an edge may have come to rest beside the true one. None where nothing is left."""
    gear, tooth, a = claim.place.gear or 0, claim.place.tooth, claim.physics.amplitudes
    if tooth is None or len(claim.values) == a:
        return []
    lefts = [
        left[scene.samples.meshing(gear, tooth, z=scene.gear(gear).z)]
        for scene, left in zip(fit.scenes, fit.linear.system.left, strict=True)
    ]
    if float(np.mean(np.concatenate(lefts) ** 2)) < 1.0 + LEFT_OF_TOOTH:
        return []
    out = []
    for k, one in enumerate(claim.physics.coordinates[a:], start=a):
        for step in (-RESHAPED_STEPS * one.step, RESHAPED_STEPS * one.step):
            low, high = one.bounds(fit.model.scope, claim.place)
            moved = min(max(claim.values[k] + step, low), high)
            out.append(replace(claim, values=(*claim.values[:k], moved, *claim.values[k + 1 :])))
    return out


def set_back(fit: Fit) -> Fit:
    """With a claim about a tooth that hardly carries exchanged for one that it stands back, where that fits better.
    Once it has left the mesh no column tells so: to first order a tooth that gives way is all that is left of it."""
    for k, claim in enumerate(fit.model.claims):
        # A pit over all of a flank does as much, with more to choose.
        back = _first_exchanged(fit, k, _standing_back(fit, claim), by=0.0)
        if back is not fit:
            return back
    return fit


def _first_exchanged(fit: Fit, k: int, others: Iterable[Claim], *, by: float) -> Fit:
    """With the first of ``others`` in the place of claim ``k`` that fits better by more than ``by``; the same ``fit``
    where none does."""
    for one in others:
        there = _exchanged(fit, k, one, by=by)
        if there is not fit:
            return there
    return fit


def _exchanged(fit: Fit, k: int, made: Claim, *, by: float) -> Fit:
    """With ``made`` in the place of claim ``k``, where that fits better by more than ``by`` in misfit; else the same
    ``fit``."""
    try:
        there = settled(joined(fit, [made], instead=[k]))
    except GearpolyError:
        return fit
    return there if gained_since(there, fit) > by else fit


def _standing_back(fit: Fit, claim: Claim) -> list[Claim]:
    """Claims that the tooth of ``claim`` stands well out of the mesh, on any flank; none where it carries as others
    do."""
    gear, tooth = claim.place.gear, claim.place.tooth
    if gear is None or tooth is None or claim.physics is PITCH or PITCH not in fit.model.method.physics:
        return []
    if all(scene.carried(gear, tooth) > LIGHT_LOAD_PART for scene in fit.scenes):
        return []
    without = fit.model.but(claim).scenes()
    most = max(float(np.max(np.abs(here.te - gone.te))) for here, gone in zip(fit.scenes, without, strict=True))
    values = (-SET_BACK_MULTIPLE * max(most, fit.deflection) / UM,)
    taken = {one.key for one in fit.model.claims}
    places = [p for p in PITCH.places(fit.model.scope) if (p.gear, p.tooth) == (gear, tooth)]
    made = [Claim(physics=PITCH, place=place, values=values) for place in places]
    return [one for one in made if one.key not in taken]


def alike_again(fit: Fit) -> Fit:
    """Begun once more with both gears alike, by the declared compliance law, where a shaped physics is claimed of both,
    if that ends better: what one takes of the other bends the valley between them into several, each with a law of its
    own, and makers relieve both gears alike."""
    for k, one in enumerate(fit.model.claims):
        twins = [j for j, other in enumerate(fit.model.claims) if _are_twins(one, other)]
        if not twins:
            continue
        both = np.array([one.values, fit.model.claims[twins[0]].values])
        values = tuple(np.mean(both, axis=0).tolist())
        if np.all(np.ptp(both, axis=0) < TWINS_ALIKE_PART * np.abs(values)):
            return fit
        return better_of(fit, partial(_alike, ones=(k, twins[0]), values=values), better=BETTER_STATE_GAIN)
    return fit


def _alike(fit: Fit, *, ones: Sequence[int], values: tuple[float, ...]) -> Fit:
    """Fitted on from the same ``values`` of the claims of these numbers, by the declared compliance law."""
    claims = tuple(replace(one, values=values) if j in ones else one for j, one in enumerate(fit.model.claims))
    return with_best_law(settled(by_declared_law(fit.believing(claims=claims))))


def without_idle(fit: Fit) -> Fit:
    """Without claims that no longer gain more than chance would, the weakest first.

    What no column tells but as the set-up with it is simulated bends with its size: of a gap that has closed the next
    micrometre is like softer teeth, the whole of it is not; and so does a pit over which teeth lose touch, of which the
    next micrometre is hardly seen. Such a claim goes only if all fits well without.
    """
    needed: set[tuple[object, ...]] = set()
    while True:
        claims = [(k, claim) for k, claim in enumerate(fit.model.claims) if claim.key not in needed]
        gains = {k: gain_without(fit, k) for k, _ in claims}
        ones = {k: Candidate(claim=one, gain=gains[k], freedoms=len(one.values)) for k, one in claims}
        weakest = min((k for k, one in ones.items() if not significant(fit, one)), key=gains.__getitem__, default=None)
        if weakest is None:
            return fit
        gone, promised = fit.model.claims[weakest], promised_more(fit, fit.model.claims[weakest])
        try:
            without = settled(_without(fit, weakest, ones[weakest]))
        except GearpolyError:  # gears that cannot run without it need it
            needed.add(gone.key)
            continue
        lost = 2.0 * len(gone.values) - gained_since(without, fit) - promised
        if gone.simulated and significant(without, replace(ones[weakest], gain=lost)):
            needed.add(gone.key)
        else:
            fit = without


def _without(fit: Fit, k: int, one: Candidate) -> Fit:
    """Without claim ``k``, of which a wave without a name stays where chance hardly gains so much, nothing fitted
    anew."""
    waves = _wave_without_name(fit, one)
    bare = fit.believing(claims=(*fit.model.claims[:k], *fit.model.claims[k + 1 :]))
    if waves is None:
        return bare
    rms = fit.model.rms_of(fit.scenes, one.claim)
    place = Unearned(claim=one.claim, rms=rms, posterior=None, seen=True)
    return leaving(bare.believing(unnamed=(*fit.model.unnamed, place)), waves.columns, waves=waves.by_order)


def _wave_without_name(fit: Fit, one: Candidate) -> Unknown | None:
    """A wave of no cause at the order of a claim that goes; None where it is about no order, or chance gains so."""
    order = order_of(one.claim)
    if order is None or kind_of(one.claim) != "wave" or one.log_chance(tests=1) >= math.log(HEALTHY_SET_CHANCE):
        return None
    effect = fit.model.change(fit.scenes, one.claim, one.claim.values, but=one.claim)
    return at_place(one.claim, fit.scenes, order=order, effect=effect)


def freedoms(claims: Sequence[Claim]) -> int:
    """Coordinates of all ``claims``."""
    return sum(len(claim.values) for claim in claims)


def _are_twins(one: Claim, other: Claim) -> bool:
    """Whether two claims are the same shaped physics of the mean tooth in the same form, one of each gear."""
    alike = one.physics.shaped and one.physics.mean_tooth and other.physics is one.physics
    return alike and one.place.form == other.place.form and one.place.gear == 0 and other.place.gear == 1
