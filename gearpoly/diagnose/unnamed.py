"""Places that are left without a name: an unknown cause stands there, as columns beside all else, and nothing is
simulated anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.diagnose.at_place import PlaceWeighed, at_place
from gearpoly.diagnose.fit import Fit, forgotten, settled
from gearpoly.diagnose.floors import size_of
from gearpoly.diagnose.scan import Candidate, all_places
from gearpoly.diagnose.unearned import Unearned
from gearpoly.diagnose.weigh import beyond_floors, by_coincidence
from gearpoly.infer.load_wave import LOAD_WAVE, apart
from gearpoly.infer.posterior import NAMED_PROBABILITY, Posterior
from gearpoly.infer.prior import TWIST_OVER_TEETH, kind_of, order_of, same_place
from gearpoly.infer.unknown import waves
from gearpoly.physics.base import Claim
from gearpoly.units import FloatArray

UNCLAIMED_PROBABILITY = 0.5
"""Probability that nothing is at a place from which on nothing is claimed there."""

AT_ONCE = 6
"""Places that are left without a name after one look: as many as cost what another look does."""

UNKNOWN_TEETH_FITTED = 4
"""Teeth that are fitted though an unknown cause is likelier to first order. Where more deviate so, it is no single
tooth that is unknown, and each fit would cost up to 12 processor s (measured on a printed pair)."""

UNNAMED = 24
"""Places that are left without a name in one search: each costs columns, and beyond these `compare` has said what there
is to say."""


def leaving(
    fit: Fit, columns: Sequence[FloatArray], *, slow: bool = False, waves: Sequence[Sequence[int]] | None = None
) -> Fit:
    """With ``columns`` (n_k, q) in mm that have no cause beside all else from now on; ``slow`` ones are no wave.
    ``waves``: the columns of each wave among them (None: they are one)."""
    many = columns[0].shape[1]
    both = list(zip(columns, fit.foreign, strict=True))
    if slow:
        foreign = [np.concatenate((own, mine), axis=1) for mine, own in both]
        there = fit.believing(slow_courses=fit.model.slow_courses + many)
    else:
        foreign = [np.concatenate((mine, own), axis=1) for mine, own in both]
        moved = tuple(tuple(column + many for column in wave) for wave in fit.model.strangers)
        new = (range(many),) if waves is None else waves
        there = fit.believing(strangers=(*map(tuple, new), *moved))
    return replace(there, foreign=foreign).linearised()


def with_waves(fit: Fit, columns: Sequence[FloatArray], orders: Sequence[Sequence[int]]) -> Fit:
    """With waves of no cause whose ``columns`` (n_k, q) are in mm, those of each of its ``orders`` a wave of its own,
    everything fitted again. Those stay that the teeth within their grade do not hold: beside a scale's wave of 6.6 um
    twice per turn 2.5 um once per turn were told, which its side bands had taken off the teeth. Raises
    ``GearpolyError`` where gears cannot run so."""
    there = settled(leaving(fit, columns, waves=orders))
    bare = forgotten(there)
    return there if bare is there else settled(bare)


def is_weighed(claim: Claim) -> bool:
    """Whether a claim is weighed at its place before it is fitted: a wave, or what one tooth has. What all teeth do
    bends the curve, and is told to its end only."""
    return kind_of(claim) in ("wave", "tooth") and not claim.physics.once_per_turn


def weigh_at(fit: Fit, best: Candidate) -> PlaceWeighed | None:
    """What may be at the place of the ``best`` candidate; None where that is not weighed before it is fitted, or gears
    cannot run with it, as its fit will tell."""
    claim = best.claim
    if claim.physics is LOAD_WAVE:
        alone = Posterior(claims=(), unknown=1.0, nothing=0.0)
        return PlaceWeighed(posterior=alone, unknown=apart(fit.scenes, claim.place))
    return _weighed_at(fit, claim) if is_weighed(claim) else None


def _weighed_at(fit: Fit, claim: Claim) -> PlaceWeighed | None:
    """What may be at the place of a ``claim``; None where gears cannot run with it."""
    if fit.model.changed(fit.scenes, claim) is None:
        return None
    possible = [
        one for one in all_places(fit.model) if same_place(Claim(physics=one[0], place=one[1], values=()), claim)
    ]
    return at_place(fit.model, fit.scenes, fit.linear, possible, looked=fit.looked, polish=True)


def left_unnamed(fit: Fit, claim: Claim, weighed: PlaceWeighed) -> Fit | None:
    """With an unknown cause in the place of a ``claim`` from now on, where that is likelier than every physics
    together; else None. The first ``UNKNOWN_TEETH_FITTED`` teeth are fitted all the same, and weighed against a curve
    of their flanks at the end, which then stands in the fitted file."""
    surely = weighed.posterior.unknown > NAMED_PROBABILITY and len(fit.model.unnamed) < UNNAMED
    fitted = claim.place.tooth is not None and _teeth(fit) < UNKNOWN_TEETH_FITTED
    # A wave of no cause at the order of a claim takes over what that one does: they are weighed at the end.
    here = [one for one in fit.model.claims if order_of(claim) is not None and same_place(one, claim)]
    beside = any(not _may_twist(fit, claim, one) for one in here)
    if not surely or fitted or beside or weighed.unknown is None:
        return None
    where = f"order {order_of(claim)}" if claim.place.tooth is None else "a tooth"
    fit.step(f"leaving {where} of the {claim.place.gear_name} gear without a name")
    return _without_name(fit, claim, weighed, weighed.unknown)


def _without_name(fit: Fit, claim: Claim, weighed: PlaceWeighed, columns: Sequence[FloatArray]) -> Fit:
    """With ``columns`` of no cause (n_k, q) in the place of a ``claim``, which keeps what it was ``weighed`` at."""
    effect = fit.model.change(fit.scenes, claim, claim.values)
    rms = float(np.sqrt(np.mean(np.concatenate(effect) ** 2)))
    pulses = claim.physics is LOAD_WAVE
    place = Unearned(claim=claim, rms=rms, posterior=weighed.posterior, seen=not pulses)
    there = leaving(fit, columns, slow=claim.physics.slow).believing(unnamed=(*fit.model.unnamed, place))
    if not pulses:
        return there
    scope, here = there.model.scope, (claim.place.gear or 0, claim.place.order or 1, rms)
    return there.believing(scope=replace(scope, pulses=(*scope.pulses, here)))


def _may_twist(fit: Fit, pulses: Claim, other: Claim) -> bool:
    """Whether a torque that pulses may twist shafts by as much as another claim at its order makes."""
    if pulses.physics is not LOAD_WAVE:
        return False
    rms = fit.model.rms_of(fit.scenes, pulses)
    return TWIST_OVER_TEETH * rms > fit.model.rms_of(fit.scenes, other)


def slow_unnamed(fit: Fit, ones: Sequence[Candidate]) -> Fit:
    """With the slow course of the likeliest of some candidates left without a name, where it is more than chance and
    likelier of no cause; the same ``fit`` where there is none. Left out, it speaks against all else: beside 0.9 um of a
    shaft that turned once in five and a half turns, 18 um of a spall were not found."""
    slow = next((one for one in ones if one.claim.physics.slow), None)
    if slow is None or len(fit.model.unnamed) >= UNNAMED or fit.over:
        return fit
    weighed = _weighed_at(fit, slow.claim)
    if weighed is None or weighed.unknown is None or weighed.posterior.unknown <= NAMED_PROBABILITY:
        return fit
    fit.step("leaving a slow course without a name")
    return _without_name(fit, slow.claim, weighed, weighed.unknown)


def more_unnamed(fit: Fit, found: Sequence[Candidate], *, besides: Claim) -> Fit:
    """With further places of one look left without a name, before all is fitted again: where there is one, there are
    more, and each is weighed beside those before it."""
    seen = {_place(besides)}
    for one in found:
        if len(seen) > AT_ONCE or fit.over:
            break
        if _place(one.claim) in seen or one.claim.physics is LOAD_WAVE:
            continue
        seen.add(_place(one.claim))
        weighed = weigh_at(fit, one)
        if weighed is not None:
            fit = left_unnamed(fit, one.claim, weighed) or fit
    return fit


def waves_unnamed(fit: Fit, found: Sequence[Candidate]) -> Fit:
    """With the waves of one look left without a name that may as well be of those that no gear pair makes, and lie at
    an order of a shaft by chance; the same ``fit`` where there are none. Left out of the fit, they would speak against
    what is claimed: one of 0.9 um, two orders below the mesh's, against 24 um of a cumulative pitch, which has a side
    band there."""
    seen: set[float] = set()
    for one in found:
        order, gear = order_of(one.claim), one.claim.place.gear
        if len(fit.model.unnamed) >= UNNAMED or len(seen) == AT_ONCE or fit.over:
            break
        if order is None or gear is None or kind_of(one.claim) != "wave":
            continue
        per_mesh = order / fit.model.scope.gears[gear].z
        if per_mesh in seen or not (beyond_floors(fit, one) and by_coincidence(fit, one)):
            continue
        seen.add(per_mesh)
        alone = Posterior(claims=(), unknown=1.0, nothing=0.0)
        place = Unearned(claim=one.claim, rms=size_of(fit, one), posterior=alone, seen=True)
        by_reading = waves(fit.scenes, gear, (order,))
        # For each recording, if there are several.
        fit = leaving(fit, by_reading[len(by_reading) // 2 - 1].columns).believing(unnamed=(*fit.model.unnamed, place))
    return fit


def _teeth(fit: Fit) -> int:
    """Claims about single teeth that stand in the fit."""
    return sum(one.place.tooth is not None for one in fit.model.claims)


def likeliest(best: Candidate, weighed: PlaceWeighed | None) -> Candidate | None:
    """The ``best`` candidate, or what is likelier at its place than it; None where nothing is to be fitted there."""
    if weighed is None:
        return best
    posterior = weighed.posterior
    wave = best.claim.place.tooth is None and posterior.unknown > NAMED_PROBABILITY
    if posterior.nothing > UNCLAIMED_PROBABILITY or wave or not posterior.claims:
        return None
    claim, chance = posterior.claims[0]
    if claim.key == best.claim.key or chance <= posterior.of(best.claim):
        return best
    return replace(best, claim=claim, freedoms=len(claim.values))


def _place(claim: Claim) -> tuple[int | None, int | None, int | None]:
    """Gear, tooth and order that a claim is about."""
    return claim.place.gear, claim.place.tooth, order_of(claim)
