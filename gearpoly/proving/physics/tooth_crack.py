"""One tooth bends more than the others."""

from __future__ import annotations

from typing import Any

from gearpoly.proving.chain import RecordedCondition
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site, loaded
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """The compliance of one tooth, contact left out, times a factor."""
    teeth = rig.teeth(effect.gear).softer(effect.more["tooth"], 1 + effect.size)
    return rig.with_teeth(effect.gear, teeth)


def example(site: Site) -> Effect:
    """30 % softer."""
    return Effect(physics="tooth_crack", gear=site.gear, size=0.3, more={"tooth": site.tooth})


def told(rig: Rig, effect: Effect, conditions: tuple[RecordedCondition, ...]) -> dict[str, Any]:
    """The factor."""
    return {"compliance_factor": 1 + effect.size}


PHYSICS = ConcealedPhysics(
    name="tooth_crack",
    size="compliance_factor",
    from_one=True,
    apply=apply,
    example=example,
    cap=3.0,
    unit=0.1,
    shows="load",
    told=told,
    one_sign=True,
    possible=loaded,
    place="tooth",
    nearby=("tooth_flank",),
    rivals=("tooth_pitch", "tooth_spall"),
    source="the contract: a factor on that tooth's own compliance",
)
