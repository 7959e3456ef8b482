"""One physics of all teeth in the stead of several, where it explains as much as they do together.

A search that goes step by step may begin with the wrong form and mend it with another: of 29 um of wear it made a
relief of 37 um and a slope of 79 um.
"""

from __future__ import annotations

import math

from gearpoly.diagnose.contest import LIKENESSES_FITTED, refitted, rested
from gearpoly.diagnose.exchange import gained_since
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.scan import Candidate, all_places, polished, scan
from gearpoly.physics.base import Claim

ONE_FOR_ALL_GAIN_PART = 0.5
"""Part of what several claims gain together that one has to reach to first order to be fitted in their stead: drawn
about a state that they have bent. A judgement; what is fitted to its end decides."""


def one_for_all(search: Fit) -> Fit:
    """With the best single physics of all teeth of one gear where several stand, if each freedom that it saves, at
    what it might have told (Schwarz 1978), is worth what it misfits more."""
    these = [k for k, one in enumerate(search.model.claims) if _of_all(one)]
    if len(these) < 2 or search.over:
        return search
    search = rested(search)
    others = search.model
    leave = [place for k in these for place in search.linear.layout.places(k)]
    freedoms = sum(len(search.model.claims[k].values) for k in these)
    for k in these:
        others = others.but(search.model.claims[k])
    bare = search.linear.without(leave)
    gain = bare.system.misfit - search.linear.system.misfit
    price = max(2.0, math.log(max(gain, 1.0)))
    best, most = search, 0.0
    for one in _singles(search, others, bare, gain):
        search.step(f"fitting {one.claim.physics.name.replace('_', ' ')} instead of {len(these)} physics of all teeth")
        there = refitted(search, one.claim, instead=these)
        if there is not None:
            # What a fit costs counts 2 for each freedom already.
            ahead = gained_since(there, search) + (price - 2.0) * (freedoms - len(one.claim.values))
            if ahead > most:
                best, most = there, ahead
    return best


def _of_all(claim: Claim) -> bool:
    return claim.physics.mean_tooth and claim.place.gear is not None


def _singles(search: Fit, others: Model, bare: Linear, gain: float) -> list[Candidate]:
    """The physics of all teeth of one gear that gain most where none of the claims stands, each at its best shape."""
    places = [
        (physics, place) for physics, place in all_places(others) if physics.mean_tooth and place.gear is not None
    ]
    found, _ = scan(others, search.scenes, bare, only=places)
    best: dict[object, Candidate] = {}
    for one in found:
        if one.gain > ONE_FOR_ALL_GAIN_PART * gain and len(best) < LIKENESSES_FITTED:
            best.setdefault(one.claim.key, one)
    return [polished(others, search.scenes, bare, one) for one in best.values()]
