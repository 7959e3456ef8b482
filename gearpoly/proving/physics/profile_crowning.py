"""Profiles of all teeth bulge."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """The same on all teeth of the gear."""
    teeth = rig.teeth(effect.gear)
    return rig.with_teeth(effect.gear, replace(teeth, crowning=teeth.crowning + effect.size))


def example(site: Site) -> Effect:
    """A micrometre or a few."""
    return Effect(physics="profile_crowning", gear=site.gear, size=1.0)


PHYSICS = ConcealedPhysics(
    name="profile_crowning",
    size="crowning_um",
    apply=apply,
    example=example,
    cap=20.0,
    as_built="form",
    rivals=(
        "profile_crowning'",
        "wear",
        "wear'",
        "tip_relief",
        "tip_relief'",
        "tooth_deflection",
        "misalignment",
    ),
    source="the contract's parabola over the roll length",
)
