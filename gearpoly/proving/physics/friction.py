"""Teeth slide with friction."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site, loaded
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """More of it than the rig has."""
    return replace(rig, friction=rig.friction + effect.size)


def example(site: Site) -> Effect:
    """A coefficient of 0.05."""
    return Effect(physics="friction", size=0.05)


PHYSICS = ConcealedPhysics(
    name="friction",
    size="coefficient",
    apply=apply,
    example=example,
    cap=0.2,
    gear=False,
    unit=0.02,
    shows="load",
    one_sign=True,
    possible=loaded,
    rivals=("profile_slope", "profile_slope'", "profile_crowning", "profile_crowning'", "misalignment"),
    source="Coulomb; the arm changes sign at the pitch point",
)
