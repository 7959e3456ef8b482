"""One ordinary fault of every physics that a pair could have, before anything is known of it."""

from __future__ import annotations

from collections.abc import Sequence

from gearpoly.diagnose.model import Model
from gearpoly.diagnose.prepare import reaches
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim, Physics, Scope
from gearpoly.physics.place import Place
from gearpoly.scene import Scene


def scope_of(model: Model, scenes: Sequence[Scene]) -> Scope:
    """What would be known of recordings of the ``model`` that are only thought of."""
    pair, samples = scenes[0].pair, [scene.samples for scene in scenes]
    driving, driven = model.as_built.gears
    return Scope(
        file=model.declared,
        gears=(pair.driving.gear, pair.driven.gear),
        flanks=tuple(one.flank for one in samples),
        torques=tuple(one.torque for one in samples),
        speeds=tuple(one.speed for one in samples),
        encoders=(True, True),
        timed=all(one.time is not None for one in samples),
        counted=True,
        span=2.0 * pair.meshes_per_cycle / pair.driving.gear.z,
        inspected=(not driving.graded, not driven.graded),
        reach=reaches(pair),
    )


def ordinary_claims(scope: Scope) -> list[Claim]:
    """One ordinary fault of every physics on each gear and at each of its ordinary orders: on the drive flank, a tooth
    and a shape in the middle of where it may be, in all recordings."""
    out = []
    for physics in catalogue().values():
        places = list(physics.places(scope))
        for gear in sorted({place.gear for place in places}, key=str):
            orders = (None,) if gear is None else physics.ordinary_orders(scope.gears[gear]) or (None,)
            out += [_claim(physics, _typical(places, gear, order, scope)) for order in orders]
    return out


def _typical(places: list[Place], gear: int | None, order: int | None, scope: Scope) -> Place:
    tooth = None if gear is None else scope.gears[gear].z // 3
    found = [p for p in places if p.gear == gear and p.order == order and p.tooth in (None, tooth)]
    for flank in (None, "drive"):
        found = [p for p in found if p.flank == flank] or found
    most = max(len(p.recordings) for p in found)
    found = [p for p in found if len(p.recordings) == most]
    return found[len(found) // 2]


def _claim(physics: Physics, place: Place) -> Claim:
    return Claim(physics=physics, place=place, values=(*physics.ordinary, *place.shape))


def label(claim: Claim) -> str:
    """The physics with its gear and order, for lists."""
    place, physics = claim.place, claim.physics
    words = [physics.name] if place.gear_name is None else [physics.name, place.gear_name]
    return " ".join(words if place.order is None else [*words, "order", str(place.order)])


def not_asked(claims: Sequence[Claim]) -> list[str]:
    """Physics of the catalogue of which no recording could show anything."""
    asked = {claim.physics.name for claim in claims}
    return [name for name in catalogue() if name not in asked]
