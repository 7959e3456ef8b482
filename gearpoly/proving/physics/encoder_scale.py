"""Counts per turn are wrongly set, or a coupling slips."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import Any

from gearpoly.proving.chain import RecordedCondition
from gearpoly.proving.gears import MM_PER_UM
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """An encoder that counts too many or too few."""
    old = rig.encoder(effect.gear)
    return rig.with_encoder(effect.gear, replace(old, ratio=old.ratio * (1 + effect.size)))


def example(site: Site) -> Effect:
    """1 um at the end of the longest recording."""
    g = site.pair.gear(site.gear)
    turns = max(c.turns for c in site.conditions) * (site.pair.driving.z / g.z)
    return Effect(physics="encoder_scale", gear=site.gear, size=site.sign * MM_PER_UM / g.r_b / (2 * pi * turns))


def told(rig: Rig, effect: Effect, conditions: tuple[RecordedCondition, ...]) -> dict[str, Any]:
    """Counts over true counts."""
    return {"ratio": 1 + effect.size}


PHYSICS = ConcealedPhysics(
    name="encoder_scale",
    size="ratio",
    from_one=True,
    apply=apply,
    example=example,
    cap=1e-3,
    unit=1e-7,
    plain=True,
    told=told,
    place="course",
    rivals=("encoder_scale'", "thermal_drift"),
    source="counts over true counts",
)
