"""Teeth bend under load."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from gearpoly.proving.chain import RecordedCondition
from gearpoly.proving.compliance import compliance
from gearpoly.proving.gears import MM_PER_UM
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, RivalSetting, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """Teeth that bend by the rig's law."""
    return replace(rig, deflect=True)


def example(site: Site) -> Effect:
    """All of it: the torque makes the size."""
    return Effect(physics="tooth_deflection", size=1.0)


def told(rig: Rig, effect: Effect, conditions: tuple[RecordedCondition, ...]) -> dict[str, Any]:
    """The compliance of one pair at the pitch point, at the highest torque."""
    force = max(c.torque for c in conditions) * 1000 / rig.pair.driven.r_b
    law = compliance(rig.pair, law=rig.law, scale=rig.scale)
    return {"compliance_um_per_n": law.single(rig.pair.l_work(1), rig.pair.l_work(2), max(force, 1.0)) / MM_PER_UM}


def possible(beside: RivalSetting) -> bool:
    """Rigid teeth under a torque."""
    return bool(beside.torque) and not beside.rig.deflect


PHYSICS = ConcealedPhysics(
    name="tooth_deflection",
    size="compliance_um_per_n",
    apply=apply,
    example=example,
    cap=1.0,
    unit=0.1,
    gear=False,
    shows="load",
    told=told,
    one_sign=True,
    possible=possible,
    rivals=(
        "profile_crowning",
        "profile_crowning'",
        "tip_relief",
        "tip_relief'",
        "wear",
        "wear'",
        "shaft_windup",
    ),
    source="three laws of the literature, see compliance.py",
)
