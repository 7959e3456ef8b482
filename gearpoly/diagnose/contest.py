"""Likenesses of what all teeth do, and of what shapes one tooth, fitted in a claim's stead: to first order the claim
always has an advantage."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from gearpoly.diagnose.exchange import gained_since
from gearpoly.diagnose.fit import Fit, joined, number_of, settled
from gearpoly.diagnose.placing import anywhere
from gearpoly.diagnose.relaxed import relaxed
from gearpoly.diagnose.scan import Candidate, all_places, polished, scan
from gearpoly.diagnose.way import NEGLIGIBLE
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim, Physics
from gearpoly.physics.place import Place

Key = tuple[object, ...]

TWIN_GAIN_PART, RIVAL_GAIN_PART = 0.3, 0.8
"""Parts of a claim's gain that another physics must reach to first order to be fitted in its stead: the same of the
other gear, whose teeth as built have leant the claim's way so far, a pit for a missing tip, over which teeth lose touch
as no column shows, and any other."""

LIKENESSES_FITTED = 3
"""Likenesses of one claim that are fitted: the twin, and the two nearest others; each fit is half a search."""

RESTS = 4
"""Times that a fit is taken up again, at most, until that gains nothing more."""


MISFIT_BEHIND_TO_BE_FITTED = 100.0
"""Misfit by which another form may be behind after a rough fit to a part of the samples, scaled to all, to be fitted to
all. A relief that was 54 ahead so ended 14 behind. A judgement."""


@dataclass(frozen=True, kw_only=True)
class Refitted:
    """A ``claim`` as it came out in another's stead, and by how much it fits worse, in misfit and freedoms' cost;
    ``elsewhere``: with the teeth at another place of their pitch, ``way`` in rad of driven rotation further on."""

    claim: Claim
    behind: float
    elsewhere: bool = False
    way: float = 0.0


def contest(search: Fit, likely: Claim | None = None) -> tuple[Fit, Mapping[Key, tuple[Refitted, ...]]]:
    """Fit the likenesses of every claim about all teeth of a gear, or the shape of one, in its stead; the fit with the
    best there, and what became of the others, by the key of the claim that stands. What is ``likely`` from the
    beginning is one of those of every claim about all teeth: far from where a claim has brought the teeth, first order
    says nothing of it. Of a file with another pressure angle 4 um of relief were named, where a centre distance left a
    tenth of what that did.

    Teeth as built have settled beside a claim, and where pairs hand over has moved with it, so columns drawn about it
    say too little of what is like it. All are fitted until they rest: a last small step can open a further one, and
    whoever came later would win by the steps that it was given.
    """
    out: dict[Key, tuple[Refitted, ...]] = {}
    for k in range(len(search.model.claims)):
        tried = _elsewhere(search, k)
        if search.over:
            break
        # What does best where the teeth stand already is fitted to all samples, as others are.
        anywhere_else = tuple(one for one in tried if one.way)
        likenesses = [one.claim for one in _likenesses(search, k)]
        named = {one.key for one in likenesses}
        likenesses += [
            one.claim
            for one in tried
            if not one.way and one.behind < MISFIT_BEHIND_TO_BE_FITTED and one.claim.key not in named
        ]
        if likely is not None and _stands_for(likely, search, k):
            likenesses = [likely, *(one for one in likenesses if one.key != likely.key)]
        if not likenesses:
            out[search.model.claims[k].key] = anywhere_else
            continue
        search = rested(search)
        best, most, stands = search, 0.0, search.model.claims[k]
        others: list[tuple[Claim, float]] = []
        for one in likenesses:
            search.step(f"fitting {one.physics.name.replace('_', ' ')} instead")
            there = refitted(search, one, instead=[k])
            if there is not None:
                made, gained = there.model.claims[k], gained_since(there, search)
                # Neither had to come first, so the better stands, however little it is ahead.
                if gained > most:
                    made, stands, gained, most, best = stands, made, most, gained, there
                others.append((made, gained))
        search = best
        fitted = tuple(Refitted(claim=claim, behind=most - gained) for claim, gained in others)
        elsewhere = tuple(one for one in anywhere_else if one.claim.key != stands.key)
        beyond = {one.claim.key for one in elsewhere}
        out[stands.key] = (*(one for one in fitted if one.claim.key not in beyond), *elsewhere)
    return search, out


def _elsewhere(search: Fit, k: int) -> tuple[Refitted, ...]:
    """What may stand in the place of claim ``k`` of all teeth of a gear wherever in their pitch these then stand, where
    neither curves nor zeros say where: the same of the other gear, its mirror image about the pitch point, and every
    other form of all teeth of either. Of 13 um of wear of an unplaced pair 11 um of the other gear were named, of 22 um
    of slope a relief."""
    model = search.model
    claim = model.claims[k]
    if model.phased or model.stated or search.over or not claim.physics.mean_tooth or claim.place.gear is None:
        return ()
    taken = {one.key for one in model.claims}
    others: dict[tuple[str, int], Claim] = {}
    for physics in model.method.physics:
        for place in physics.places(model.scope) if physics.mean_tooth else ():
            if physics is claim.physics and place.gear is not None:
                place = replace(claim.place, gear=place.gear)
            values = claim.values if physics is claim.physics else (*physics.ordinary, *place.shape)
            one = Claim(physics=physics, place=place, values=values)
            if place.gear is not None and one.key not in taken:
                others.setdefault((physics.name, place.gear), one)
    search.step(f"placing the teeth with others than {claim.physics.name.replace('_', ' ')}")
    starts = [(*model.claims[:k], one, *model.claims[k + 1 :]) for one in (claim, *others.values())]
    (here, _), *there = anywhere(model, search.foreign, starts)
    if not math.isfinite(here):
        return ()
    return tuple(
        Refitted(claim=one, behind=misfit - here, elsewhere=True, way=way)
        for one, (misfit, way) in zip(others.values(), there, strict=True)
        if math.isfinite(misfit)
    )


def _stands_for(likely: Claim, search: Fit, k: int) -> bool:
    """Whether a physics of all teeth that nobody claims yet may stand in the place of claim ``k``."""
    claims = search.model.claims
    return claims[k].physics.mean_tooth and all(one.key != likely.key for one in claims)


def refitted(search: Fit, claim: Claim, *, instead: Sequence[int]) -> Fit | None:
    """With a ``claim`` fitted until it rests, in the place of those of the numbers ``instead``; None where gears cannot
    run with it."""
    try:
        return rested(relaxed(settled(joined(search, [claim], instead=instead))))
    except GearpolyError:
        return None


def rested(search: Fit) -> Fit:
    """Fitted on until that gains nothing more."""
    for _ in range(0 if search.over else RESTS):
        before, search = search, settled(search)
        if gained_since(search, before) < NEGLIGIBLE:
            break
    return search


def has_likenesses(claim: Claim) -> bool:
    """Whether to first order a claim has always an advantage over what is like it, so that this has to be fitted."""
    return claim.physics.mean_tooth or claim.physics.whole_gear or claim.shapes_tooth


def _likenesses(search: Fit, k: int) -> Iterator[Candidate]:
    """What may stand in the place of claim ``k``, as far as first order tells: for what is the same at every mesh all
    else that is so, for a gear whose flanks stand off the other gear, for what shapes a tooth what else it may
    have, as a missing tip for a pit that reaches it; nothing for other claims."""
    claim = search.model.claims[k]
    if not has_likenesses(claim):
        return
    mean_tooth, one_tooth = claim.physics.mean_tooth, claim.shapes_tooth
    scenes = search.model.drawn_without(claim, search.scenes) if one_tooth else search.scenes
    bare = search.linear.without(search.linear.layout.places(k))
    gain = bare.system.misfit - bare.system.with_columns(search.linear.white_of(k)).misfit
    others = search.model.but(claim)
    taken = {one.key for one in search.model.claims}

    def alike(physics: Physics, place: Place) -> bool:
        if mean_tooth:
            return physics.mean_tooth
        return _of_its_tooth(physics, place, claim) if one_tooth else physics is claim.physics

    places = [(physics, place) for physics, place in all_places(others) if alike(physics, place)]
    found, _ = scan(others, scenes, bare, only=places)
    seen: set[Key] = set()
    for one in found:
        twin = one.claim.physics is claim.physics and one.claim.place.gear != claim.place.gear
        least = TWIN_GAIN_PART if twin or one_tooth else RIVAL_GAIN_PART
        if one_tooth and not one.claim.physics.shaped:
            # First order says nothing of a tooth that stands back so far that its neighbours carry: of a pitch of 40 um
            # it told 1.3 in misfit, of the pit over all its flank that stood for it 200.
            least = 0.0
        if one.claim.key in taken or one.claim.key in seen or one.gain < least * gain:
            continue
        seen.add(one.claim.key)
        if len(seen) > LIKENESSES_FITTED:
            return
        yield polished(others, scenes, bare, one)


def _of_its_tooth(physics: Physics, place: Place, claim: Claim) -> bool:
    """Whether something else at a ``place`` is about the tooth of a ``claim`` too. One that stands so far back that its
    neighbours carry over it looks like a pit of nearly all its flank: a pitch of 40 um had been named a spall of 33."""
    mine = (claim.place.gear, claim.place.tooth)
    return physics is not claim.physics and (place.gear, place.tooth) == mine


def others_turning(search: Fit, claim: Claim) -> tuple[Refitted, ...]:
    """What else turns once with the shaft of a ``claim``, fitted to its end in its stead.

    An eccentric gear is simulated as it is, second order and all. About it straight lines say too little of an encoder:
    what is left of the second order would speak against it.
    """
    k, there = number_of(search, claim), search.linear.system.misfit
    shares = [
        Claim(physics=physics, place=place, values=(*physics.ordinary, *place.shape))
        for physics in search.model.method.physics
        if physics.once_per_turn and physics is not claim.physics
        for place in physics.places(search.model.scope)
        if place.gear == claim.place.gear and search.model.scope.shows(place, once=True)
    ]
    beside = {one.key for one in search.model.claims}
    out = []
    for other in shares:
        if other.key in beside or search.over:
            continue
        try:
            instead = settled(joined(search, [other], instead=[k]))
        except GearpolyError:
            continue
        behind = instead.linear.under(search.noises).system.misfit - there
        out.append(Refitted(claim=instead.model.claims[k], behind=behind))
    return tuple(out)
