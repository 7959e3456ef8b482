"""What else a claim could be: everything that the recordings cannot tell from it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.diagnose.contest import Refitted
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.scan import Candidate, columns_of, polished, scan
from gearpoly.physics.base import Claim, Physics
from gearpoly.physics.place import Place
from gearpoly.scene import Scene

CLOSE = 9.0
"""Difference in misfit within which two explanations are not told apart: three standard deviations."""

LIKE = 0.05
"""Sine of the angle below which two signals differ by what only a perfect simulation could tell: corners, second
order, the fourth figure of a shape."""

EITHER = 0.1
"""The same of what all teeth of one gear have or all of the other: a wear of either differed by a sine of 0.076 in what
another simulation made under load, and the wrong gear was ahead, by what compliance laws differ in."""

CORNERS, FINE = 0.02, 0.01
"""Parts of a claim's whole effect below which two signals differ by what no two models agree on, of all teeth in corner
contact, and of anything else: a slope or a crowning of one gear and of the other, which are one on the path of contact,
differ by 0.011 and 0.016 beside it, the stairs of a pitch wave from an encoder's by more than that. The effect counts
with all that teeth as built might take of it."""

POSSIBLE = 0.5
"""Part of a claim's gain that a rival must reach by its coarse shapes to be looked at closely."""

TWIN = 0.25
"""The same for a damage of the mate's tooth, whose coarse shapes are laid elsewhere than those of the claim: where two
teeth always meet, either has it."""

LOOKED_AT = 12
"""Rivals that are looked at closely."""


@dataclass(frozen=True, kw_only=True)
class Judged:
    """A claim with its ``gain`` in misfit, and the rivals within the evidence, best first."""

    gain: float
    rivals: tuple[Candidate, ...]


def judge(model: Model, scenes: list[Scene], linear: Linear, k: int, *, refitted: Sequence[Refitted] = ()) -> Judged:
    """Weigh claim ``k`` against everything that could stand in its place, all else fitted again.

    Rivals are drawn to first order about the set-up with the claim in it, but for those that were ``refitted`` in its
    stead; the freedom of form that a claimed tooth has is left out on both sides.
    """
    claim = model.claims[k]
    plain = linear.without(linear.layout.places(k) + linear.layout.form_places(model, k))
    bare = plain.system
    gain = bare.misfit - bare.with_columns(linear.white_of(k)).misfit
    alone = sum(float(np.sum((white @ np.array(claim.values)) ** 2)) for white in linear.white_of(k))
    others = model.but(claim)
    found, _ = scan(others, scenes, plain, only=_possible(model, claim))
    rivals: list[Candidate] = []
    seen = {claim.key}

    def like(one: Candidate, reached: float) -> bool:
        # A simpler rival may explain a little less; a richer one that explains as much is not refuted by being rich.
        simpler = max(0.0, 2.0 * (len(claim.values) - one.freedoms))
        told = reached <= gain - CLOSE - simpler
        both = claim.physics.mean_tooth and one.claim.physics.mean_tooth
        sine = EITHER if both and one.claim.physics is claim.physics else LIKE
        return not told or gain - reached < max(sine**2 * gain, (CORNERS if both else FINE) ** 2 * alone)

    for refit in refitted:
        seen.add(refit.claim.key)
        freedoms = len(refit.claim.values)
        reached = gain - refit.behind + 2.0 * (freedoms - len(claim.values))
        one = Candidate(claim=refit.claim, gain=reached, freedoms=freedoms)
        if like(one, reached):
            rivals.append(one)

    def possible(one: Candidate) -> bool:
        twin = one.claim.physics is claim.physics and claim.physics.shaped and one.claim.place.gear != claim.place.gear
        return one.gain > (TWIN if twin and claim.place.tooth is not None else POSSIBLE) * gain

    for one in [c for c in found if possible(c)][: 4 * LOOKED_AT]:
        if one.claim.key in seen or len(seen) > LOOKED_AT:
            continue
        seen.add(one.claim.key)
        better = polished(others, scenes, plain, one)
        columns = columns_of(others, scenes, plain, better)
        reached = bare.misfit - bare.with_columns(columns).misfit
        if like(better, reached):
            rivals.append(better)
    return Judged(gain=gain, rivals=tuple(sorted(rivals, key=lambda one: -one.gain)))


def _possible(model: Model, claim: Claim) -> Iterator[tuple[Physics, Place]]:
    """Places at which something like the claim could be: another tooth is never mistaken for a wave, nor order 61 for
    order 12."""
    taken = {one.key for one in model.claims}
    for physics in model.method.physics:
        for place in filter(
            model.scope.shows, (*physics.places(model.scope), *physics.instead(model.scope, claim.place))
        ):
            key = Claim(physics=physics, place=place, values=()).key
            if key in taken:
                continue
            if physics.wavelike and not _same_wave(model, place, claim.place):
                continue
            tooth, mine = place.tooth is not None, claim.place.tooth is not None
            if tooth and not mine:
                continue
            yield physics, place


def _same_wave(model: Model, one: Place, other: Place) -> bool:
    """Whether waves on either shaft have the same frequency, or on one shaft the same order."""
    z = [gear.z for gear in model.scope.gears]
    if one.order is None or other.order is None or one.gear is None or other.gear is None:
        return False
    return one.order * z[other.gear] == other.order * z[one.gear]
