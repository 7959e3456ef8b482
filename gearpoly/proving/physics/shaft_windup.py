"""A shaft twists under torque."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.gears import MM_PER_UM
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, RivalSetting, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """More of it than the rig has."""
    return replace(rig, windup=rig.windup + effect.size)


def example(site: Site) -> Effect:
    """1 um at the highest torque."""
    return Effect(physics="shaft_windup", size=MM_PER_UM / site.pair.driven.r_b / max(site.torque, 1e-6) * 1e6)


def twists(beside: RivalSetting) -> bool:
    """Whether there is a torque."""
    return bool(beside.torque)


PHYSICS = ConcealedPhysics(
    name="shaft_windup",
    size="compliance_urad_per_nm",
    apply=apply,
    example=example,
    cap=300.0,
    gear=False,
    shows="load",
    one_sign=True,
    possible=twists,
    place="step",
    rivals=("misalignment", "centre_distance", "tooth_thickness", "tooth_thickness'"),
    source="Hooke: in step with torque",
)
