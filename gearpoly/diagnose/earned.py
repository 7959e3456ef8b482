"""Which claims earn their name against causes that nobody knows; what does not is left as a place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.diagnose.contest import Key, Refitted
from gearpoly.diagnose.judge import Judged, judge
from gearpoly.diagnose.search import Search
from gearpoly.errors import GearpolyError
from gearpoly.infer.posterior import Posterior
from gearpoly.infer.prior import order_of
from gearpoly.infer.unknown import at_place
from gearpoly.physics.base import Claim
from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True)
class Unearned:
    """A ``claim`` that did not earn its name: the ``rms`` in mm of what it did, and the probabilities at its place."""

    claim: Claim
    rms: float
    posterior: Posterior


def earned(search: Search, refitted: Mapping[Key, Sequence[Refitted]]) -> tuple[list[Judged], tuple[Unearned, ...]]:
    """Judge every claim of the ``search``, in the order of its model, and give up those that are no likelier than an
    unknown cause, the least likely first: a curve of no cause then stands in their place, and the rest is judged anew.
    """
    gone: list[Unearned] = []
    taken: set[Key] = set()
    while True:
        search.step("weighing names against unknown causes")
        judged = [
            judge(
                search.model, search.scenes, search.linear, k,
                refitted=refitted.get(claim.key, ()), places=search.looked.own.get(claim.physics.name, 1),
            ) for k, claim in enumerate(search.model.claims)
        ]  # fmt: skip
        better = _likelier(search, judged, taken)
        if better is not None:
            k, claim = better
            taken |= {search.model.claims[k].key, claim.key}
            _take(search, k, claim)
            continue
        least = max(
            (k for k, one in enumerate(judged) if not one.posterior.named),
            key=lambda k: judged[k].posterior.unknown + judged[k].posterior.nothing,
            default=None,
        )
        if least is None:
            return judged, tuple(gone)
        claim = search.model.claims[least]
        effect = search.model.change(search.scenes, claim, claim.values, but=claim)
        rms = float(np.sqrt(np.mean(np.concatenate(effect) ** 2)))
        gone.append(Unearned(claim=claim, rms=rms, posterior=judged[least].posterior))
        _give_up(search, least, effect)


def _likelier(search: Search, judged: Sequence[Judged], taken: set[Key]) -> tuple[int, Claim] | None:
    """A claim that is likelier than the one in whose place it may stand, and that one's number; no claim twice."""
    for k, one in enumerate(judged):
        claim, chance = one.posterior.claims[0]
        stands = search.model.claims[k]
        beside = {other.key for other in search.model.claims}
        if claim.key not in beside | taken and stands.key not in taken and chance > one.posterior.of(stands):
            return k, claim
    return None


def _take(search: Search, k: int, claim: Claim) -> None:
    """Let a ``claim`` take the place of claim ``k``, unless gears cannot run so."""
    begun = search.kept()
    try:
        search.join([claim], instead=k)
        search.settle()
    except GearpolyError:
        search.restore(begun)


def _give_up(search: Search, k: int, effect: Sequence[FloatArray]) -> None:
    """Let a curve of no cause stand in the place of claim ``k``, which has this ``effect`` (n_k,) in mm, and fit
    everything again."""
    claim = search.model.claims[k]
    curve = at_place(claim, search.scenes, order=order_of(claim), effect=effect)
    begun = search.kept()
    try:
        search.join([], instead=k)
        many = curve[0].shape[1]
        both = zip(curve, search.foreign, strict=True)
        if claim.physics.slow:
            search.foreign = [np.concatenate((own, mine), axis=1) for mine, own in both]
            search.model.slow_courses += many
        else:
            search.foreign = [np.concatenate((mine, own), axis=1) for mine, own in both]
            moved = tuple(tuple(column + many for column in wave) for wave in search.model.strangers)
            search.model.strangers = (tuple(range(many)), *moved)
        search.linear = search.linearised()
        search.settle()
    except GearpolyError:
        # Gears that cannot run without it: its place stays as it was fitted, and is not named either.
        search.restore(begun)
        search.model.claims = [one for one in search.model.claims if one is not claim]
        search.linear = search.linearised()
