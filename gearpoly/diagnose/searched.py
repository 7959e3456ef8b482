"""The search for what is missing with the teeth where they were placed, and again where what it found stands better.

Where neither zeros nor curves place a pair, its teeth were placed by what it was declared to be. What is missing moves
the place where they hand over: of 29 um of wear, placed wrongly, a relief and a slope were found.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.beside import Comparison
from gearpoly.compare.locate import Located
from gearpoly.diagnose.begin import Begun
from gearpoly.diagnose.beneath import LEAST_SMOOTH_WAVE_GAIN, smooth_waves, waves_beneath
from gearpoly.diagnose.budget import Watch
from gearpoly.diagnose.compare_as_built import located_beside, teeth_are_open, with_teeth_of
from gearpoly.diagnose.conditions import without_dear
from gearpoly.diagnose.contest import Key, Refitted, contest
from gearpoly.diagnose.exchange import freedoms, gained_since
from gearpoly.diagnose.fit import BETTER_STATE_GAIN, Fit
from gearpoly.diagnose.kept import Kept, come_back, kept
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model, noises
from gearpoly.diagnose.one_for_all import one_for_all
from gearpoly.diagnose.placing import BETTER_PLACE_GAINS, well_placed
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.diagnose.remounted import Remounted, remounted
from gearpoly.diagnose.scan import Candidate
from gearpoly.diagnose.thinned import search_thinned_first
from gearpoly.diagnose.unseen import without_unfinished
from gearpoly.diagnose.unstated import as_fitted
from gearpoly.physics.base import Claim


@dataclass(frozen=True, kw_only=True, eq=False)
class Searched:
    """A ``search`` that has come to its end: the ``comparison`` with the teeth where it has them, the system at its
    ``start`` and the state that it had ``begun`` in, the candidates of its last look, ``looked_at``, what was
    ``refitted`` in the stead of its claims, what was ``assumed`` on the way; ``anew``: what was mounted anew between
    recordings, so that nothing was looked for, as where they are of another pair; ``stopped``: time was over, and
    claims were taken back as ``unfinished``, each with its rms in mm."""

    search: Fit
    comparison: Comparison
    start: Linear
    begun: Kept
    looked_at: Sequence[Candidate]
    refitted: Mapping[Key, tuple[Refitted, ...]]
    unfinished: Sequence[tuple[Claim, float]]
    assumed: tuple[str, ...]
    anew: Remounted | None
    stopped: bool


def searched(model: Model, start: Begun, watch: Watch) -> Searched:
    """The search at the place of a ``model`` whose teeth were placed, or at another place of their pitch where another
    physics of all teeth fits better than what was found, if it ends better there. Raises what ``compare`` does."""
    first = _searched_at(model, start, watch)
    way = _better_place(first)
    if way is None or first.stopped:
        return first
    second = _searched_at(model.moved(way + first.search.model.offset - model.offset), start, watch)
    ahead = _ahead(second, first)
    if second.stopped or ahead <= BETTER_PLACE_GAINS[0]:
        return first
    return replace(second, refitted=_known(second.refitted, first.search.model.claims, ahead))


def _known(
    refitted: Mapping[Key, tuple[Refitted, ...]], claims: Sequence[Claim], ahead: float
) -> Mapping[Key, tuple[Refitted, ...]]:
    """The same with how far the ``claims`` of a whole search elsewhere are behind; a part of the samples told of them
    roughly."""
    keys = {one.key for one in claims}
    return {
        key: tuple(replace(one, behind=ahead) if one.elsewhere and one.claim.key in keys else one for one in each)
        for key, each in refitted.items()
    }


def _searched_at(model: Model, start: Begun, watch: Watch) -> Searched:
    preparing, assumed = watch.stage("prepare"), start.assumed
    preparing("fitting the teeth as they were built")
    search = well_placed(model, lambda one: from_declared(one, start.all_waves, preparing))
    if (coarser := as_fitted(search)) is not None:
        model, assumed = coarser
        search = Fit.begun(model, start.all_waves, preparing)
    anew = remounted(search.model, search.linear, deflection=search.deflection)
    comparison, located = _placed_alike(start.comparison, search)
    search = replace(search, step=watch.stage("search"))
    of_this_pair, none_smooth = anew is None and comparison.another is None, False
    if of_this_pair:
        smooth = smooth_waves(search, comparison)
        none_smooth = smooth is search and search.linear.system.beyond >= LEAST_SMOOTH_WAVE_GAIN
        # Where no wave turned out to be a smooth one, what stands out beside the teeth is known already.
        search = waves_beneath(smooth, comparison, located if smooth is search else None)
    search = _without_ghosts(search, start)
    first, begun = search.linear, kept(search)
    looked_at: Sequence[Candidate] = []
    if of_this_pair:
        search, looked_at = search_thinned_first(search)
    if not none_smooth and any(one.place.tooth is not None for one in search.model.claims):
        # What one tooth has may be how a smooth wave differs from one of teeth, too little to be asked before.
        back = come_back(begun, search)
        asked = smooth_waves(back, comparison, least=0.0)
        if asked is not back:
            other, looked_again = search_thinned_first(asked)
            # Else what was found till then is told, or explains more than a smooth wave with what is left beside it.
            if not other.over and gained_since(search, other) <= BETTER_STATE_GAIN:
                first, begun, search, looked_at = asked.linear, kept(asked), other, looked_again
    stopped, unfinished = search.over, list[tuple[Claim, float]]()
    search = replace(search.believing(budget=search.model.budget.further), step=watch.stage("rivals"))
    if stopped:
        # Before their rivals are asked, or nothing is left of the time for what may be named.
        search, unfinished = without_unfinished(search)
    search, refitted = contest(one_for_all(search), start.likely)
    cheaper = without_dear(search)
    if cheaper is not search:
        search, refitted = contest(cheaper, start.likely)
    return Searched(
        search=search, comparison=comparison, start=first, begun=begun, looked_at=looked_at, refitted=refitted,
        unfinished=unfinished, assumed=assumed, anew=anew, stopped=stopped,
    )  # fmt: skip


def _without_ghosts(search: Fit, start: Begun) -> Fit:
    """With nothing at ghost orders any more: what is there is looked for from now on, about teeth that have not settled
    for it."""
    many = start.ghosts[0].shape[1]
    if not many:
        return search
    bare = replace(search, foreign=[one[:, : one.shape[1] - many] for one in search.foreign]).linearised()
    heard = noises(bare.model, bare.linear.left())
    return replace(bare, noises=heard, linear=bare.linear.under(heard))


def _placed_alike(comparison: Comparison, search: Fit) -> tuple[Comparison, Located | None]:
    """The comparison with the teeth where the search has them, and as they were built where they are open; and what was
    located beside those."""
    model, located = search.model, None
    if model.offset:
        comparison = comparison.moved(model.offset)
    if model.turned_by:
        comparison = comparison.turned(model.turned_by)
    if teeth_are_open(comparison) and not search.over:
        every = [np.arange(one.samples.size) for one in model.observed]
        located = located_beside(search, comparison)
        comparison = with_teeth_of(search, comparison, located, seen_at=every)
    return comparison, located


def _better_place(found: Searched) -> float | None:
    """How far on in rad of driven rotation the teeth stand where another physics does best that is clearly better there
    than what was found is anywhere; None where there is none."""
    others = [one for each in found.refitted.values() for one in each if one.elsewhere]
    best = min(others, key=lambda one: one.behind, default=None)
    return None if best is None or best.behind > -BETTER_PLACE_GAINS[0] else best.way


def _ahead(one: Searched, other: Searched) -> float:
    """By how much less a search misfits than another, both by the noise and the teeth of the other and with their
    freedoms."""
    by, here = other.search, one.search
    misfit = here.linear.under(by.noises, by.model.as_built).system.misfit
    return by.linear.system.misfit - misfit + 2.0 * (freedoms(by.model.claims) - freedoms(here.model.claims))
