"""What may be behind a place that was located and that no claim was made about."""

from __future__ import annotations

from collections.abc import Sequence

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import EVERY_MESH, Entry
from gearpoly.diagnose.linear import derivatives
from gearpoly.diagnose.scan import scan
from gearpoly.diagnose.search import Search
from gearpoly.diagnose.trial import Trial, ordinary_rms
from gearpoly.infer.posterior import Explanation, Posterior, weighed
from gearpoly.infer.prior import kind_of, order_of, same_place, share_of_causes, unknown_share
from gearpoly.physics.base import Claim, Physics
from gearpoly.physics.place import Place

MANY = 12
"""Places that are asked for their causes, the foremost first: each takes a look at every physics there."""


def causes(search: Search, comparison: Comparison, entries: Sequence[Entry]) -> list[Posterior | None]:
    """The probabilities at the places of ``entries``, beside all that is believed; None where no physics of the
    catalogue could be, or where nothing is left of it."""
    out: list[Posterior | None] = []
    trial = Trial(
        others=search.model, scenes=search.scenes, linear=search.linear, plain=search.linear.system,
        dispersion=max(1.0, search.linear.system.whiteness),
    )  # fmt: skip
    for one in entries:
        asked = one.companion_of is None and one.probability is None and len(out) < MANY and not search.over
        out.append(_posterior(search, trial, _at(search, one, _tooth(comparison, one))) if asked else None)
    return out


def _tooth(comparison: Comparison, entry: Entry) -> int | None:
    """The tooth that an entry is about, by its number, or by where it passes where numbers are open."""
    if entry.kind != "tooth" or entry.gear is None or entry.tooth is not None:
        return entry.tooth
    known = comparison.gears[("driving", "driven").index(entry.gear)]
    passes = (tooth for tooth in range(known.z) if known.encoder_deg(tooth) == entry.encoder_deg)
    return next(passes, None)


def _at(search: Search, entry: Entry, tooth: int | None) -> list[tuple[Physics, Place]]:
    """Every physics that may be at the place of an entry."""
    scope = search.model.scope
    gear = {"driving": 0, "driven": 1}.get(entry.gear or "")
    order = entry.order if entry.kind == "shaft_order" else None
    if entry.kind == "shaft_order" and (order is None or not float(order).is_integer()):
        return []
    taken = {claim.key for claim in search.model.claims}
    found = []
    for physics in search.model.method.physics:
        for place in filter(scope.shows, physics.places(scope)):
            claim = Claim(physics=physics, place=place, values=())
            if claim.key in taken:
                continue
            kind = kind_of(claim)
            same = {
                "tooth": entry.kind == "tooth" and (place.gear, place.tooth) == (gear, tooth),
                "wave": order is not None and (place.gear, order_of(claim)) == (gear, int(order)),
                "mesh": entry.kind in EVERY_MESH,
                "means": entry.kind == "condition",
                "slow": entry.kind == "time" and entry.hz == 0.0 and entry.moment is None and entry.burst is None,
            }[kind]
            if same:
                found.append((physics, place))
    return found


def _posterior(search: Search, trial: Trial, possible: list[tuple[Physics, Place]]) -> Posterior | None:
    if not possible:
        return None
    found, _ = scan(search.model, search.scenes, search.linear, only=possible)
    best: dict[tuple[object, ...], Claim] = {}
    for one in found:
        best.setdefault(one.claim.key, one.claim)
    if not best:
        return None
    claims = list(best.values())
    first = claims[0]
    weights = share_of_causes(first, (Claim(physics=physics, place=place, values=()) for physics, place in possible))
    columns = derivatives(search.model, search.scenes, first)
    effect = search.model.change(search.scenes, first, first.values)
    trial, without_cause = trial.at(first, size=ordinary_rms(first, columns, effect), effect=effect)
    explanations = [
        Explanation(claim=claim, log_evidence=trial.of(claim), weight=weights[claim.physics.name, claim.place.gear])
        for claim in claims
        if same_place(claim, first)
    ]
    explanations += trial.explanations(without_cause)
    places = search.looked.own.get(first.physics.name, 1)
    share = max(unknown_share(claim, search.model.scope) for claim in claims)
    return weighed(explanations, unknown_share=share, places=places)
