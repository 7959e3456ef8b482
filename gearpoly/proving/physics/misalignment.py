"""Axes are not parallel: a gap across the face width closes under load."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site, loaded
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """More of it than the rig has."""
    return replace(rig, lead=rig.lead + effect.size)


def example(site: Site) -> Effect:
    """6 um."""
    return Effect(physics="misalignment", size=6.0)


PHYSICS = ConcealedPhysics(
    name="misalignment",
    size="lead_um",
    apply=apply,
    example=example,
    cap=40.0,
    gear=False,
    shows="load",
    one_sign=True,
    possible=loaded,
    rivals=(
        "profile_crowning",
        "profile_crowning'",
        "friction",
        "shaft_windup",
        "centre_distance",
        "tooth_thickness",
    ),
    source="derived in sharing.py: a strip that grows with the load",
)
