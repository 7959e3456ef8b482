"""The forms of a claim, each fitted to its end: what they differ by is in doubt where recordings hardly tell them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from gearpoly.diagnose.contest import Key, rested
from gearpoly.diagnose.exchange import gained_since
from gearpoly.diagnose.fit import Fit, joined
from gearpoly.diagnose.linear import out_of_mesh
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Values
from gearpoly.physics.words import Reported

LARGER_SIZE_TRIED, SIZE_COMES_TO_REST, LARGER_SIZE_MISFIT = 3.0, 1.3, 9.0
"""Times the size of a shaped claim about a single tooth that is tried in its stead, times that size beyond which it has
to come to rest, and the misfit that it may then cost, three standard deviations, for the first to be only the least. Of
24 pits of 2 to 12 um four were so: the true one cost up to 5 of misfit, and one of five times the depth as little."""


@dataclass(frozen=True, kw_only=True)
class ClaimInForm:
    """The ``claim`` in another form than it stands in, and the ``chance`` that this is the true one."""

    claim: Claim
    chance: float


def forms(search: Fit) -> tuple[Fit, Mapping[Key, tuple[ClaimInForm, ...]]]:
    """Fit every claim in its other forms; the fit with the best of each, and the others by the claim's key.

    Of forms with as many parameters, equally likely beforehand, one that is behind by d in misfit has exp(-d/2) of the
    best one's chance.
    """
    out: dict[Key, tuple[ClaimInForm, ...]] = {}
    for k in range(len(search.model.claims)):
        others = search.model.claims[k].otherwise(search.model.scope)
        if not others or search.over:
            continue
        search = rested(search)
        stands, most, best = search.model.claims[k], 0.0, search
        fitted: list[tuple[Claim, float]] = [(stands, 0.0)]
        for one in others:
            search.step(f"fitting {one.physics.name.replace('_', ' ')} in another form")
            try:
                there = rested(joined(search, [one], instead=[k]))
            except GearpolyError:
                continue
            made, gained = there.model.claims[k], gained_since(there, search)
            fitted.append((made, gained))
            if gained > most:
                stands, most, best = made, gained, there
        search = best
        odds = [math.exp(0.5 * (gained - most)) for _, gained in fitted]
        out[stands.key] = tuple(
            ClaimInForm(claim=claim, chance=one / sum(odds))
            for (claim, _), one in zip(fitted, odds, strict=True)
            if claim is not stands
        )
    return search, out


def in_doubt(found: Reported, others: Iterable[tuple[Reported, float]]) -> Reported:
    """Parameters whose standard errors hold that another form may be the true one: of each, what is ``found`` in it and
    its chance."""
    listed = list(others)
    return {
        name: (value, math.hypot(std, *(math.sqrt(chance) * (one[name][0] - value) for one, chance in listed)))
        for name, (value, std) in found.items()
    }


def only_the_least(search: Fit, k: int, others: Sequence[ClaimInForm]) -> bool:
    """Whether of the size of claim ``k`` only the least is known: its tooth has left the mesh, or its pit is one over
    which others carry, and several times as deep fits as well, in one of its ``others`` forms, or begun with walls as
    they are or as steep as any."""
    claim = search.model.claims[k]
    if out_of_mesh(search.model, search.scenes, claim):
        return True
    if not claim.shapes_tooth or claim.physics.fixed_amplitudes or search.over:
        return False
    deeper = [one.chance for one in others if one.claim.values[0] > SIZE_COMES_TO_REST * claim.values[0]]
    if max(deeper, default=0.0) > math.exp(-0.5 * LARGER_SIZE_MISFIT):
        return True
    steep = (*claim.values[1:-1], claim.physics.coordinates[-1].low)
    return any(_as_well_deeper(search, k, shape) for shape in (claim.values[1:], steep))


def _as_well_deeper(search: Fit, k: int, shape: Values) -> bool:
    """Whether claim ``k``, begun several times as deep and in this ``shape``, comes to rest deeper and fits as well."""
    claim = search.model.claims[k]
    try:
        there = rested(
            joined(search, [replace(claim, values=(LARGER_SIZE_TRIED * claim.values[0], *shape))], instead=[k])
        )
    except GearpolyError:
        return False
    deep = there.model.claims[k].values[0] > SIZE_COMES_TO_REST * claim.values[0]
    return deep and gained_since(there, search) > -LARGER_SIZE_MISFIT
