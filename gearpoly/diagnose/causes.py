"""What may be behind a place that was located and that no claim was made about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import EVERY_MESH_KINDS, Entry
from gearpoly.diagnose.at_place import at_place
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.foreign import wave_in_each
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.trial import SAME_WAVE_POWER_PART, held_by
from gearpoly.infer.posterior import Posterior
from gearpoly.infer.prior import kind_of, order_of
from gearpoly.physics.base import Claim, Physics
from gearpoly.physics.place import Place

PLACES_ASKED_FOR_CAUSES = 12
"""Places that are asked for their causes, the foremost first: each takes a look at every physics there."""


def causes(search: Fit, comparison: Comparison, entries: Sequence[Entry]) -> list[Posterior | None]:
    """The probabilities at the places of ``entries``, beside all that is believed; None where no physics of the
    catalogue could be, or where nothing is left of it."""
    out: list[Posterior | None] = []
    for one in entries:
        asked = (
            one.companion_of is None
            and one.probability is None
            and len(out) < PLACES_ASKED_FOR_CAUSES
            and not search.over
        )
        possible = _at(search, one, _tooth(comparison, one)) if asked else []
        found = None
        if possible:
            linear = _without_its_waves(search, comparison, one)
            found = at_place(search.model, search.scenes, linear, possible, looked=search.looked)
        out.append(None if found is None else found.posterior)
    return out


def _without_its_waves(search: Fit, comparison: Comparison, entry: Entry) -> Linear:
    """The linear system without those waves of no cause that are in the fit where an ``entry`` is: beside them nothing
    is left that a cause could do. Of 1.5 um five times per turn none was told."""
    linear = search.linear
    if entry.kind != "shaft_order" or not search.model.strangers:
        return linear
    columns = wave_in_each(entry, comparison)
    there = [noise.whitened(one) for noise, one in zip(linear.noises, columns, strict=True)]
    gone: list[int] = []
    for wave in search.model.strangers:
        places = [linear.layout.foreign.start + column for column in wave]
        if held_by([white.part(places) for white in linear.system.white], there) > SAME_WAVE_POWER_PART:
            gone += places
    return replace(linear, system=linear.system.fixed_at_zero(gone))


def _tooth(comparison: Comparison, entry: Entry) -> int | None:
    """The tooth that an entry is about, by its number, or by where it passes where numbers are open."""
    if entry.kind != "tooth" or entry.gear is None or entry.tooth is not None:
        return entry.tooth
    return comparison.gears[("driving", "driven").index(entry.gear)].tooth_at(entry.encoder_deg)


def _at(search: Fit, entry: Entry, tooth: int | None) -> list[tuple[Physics, Place]]:
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
                "mesh": entry.kind in EVERY_MESH_KINDS,
                "means": entry.kind == "condition",
                "slow": entry.drift,
            }[kind]
            if same:
                found.append((physics, place))
    return found
