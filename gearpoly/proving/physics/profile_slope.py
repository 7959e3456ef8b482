"""Profiles of all teeth rise from root to tip, or fall."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """The same on all teeth of the gear."""
    teeth = rig.teeth(effect.gear)
    return rig.with_teeth(effect.gear, replace(teeth, slope=teeth.slope + effect.size))


def example(site: Site) -> Effect:
    """A micrometre or a few."""
    return Effect(physics="profile_slope", gear=site.gear, size=site.sign)


PHYSICS = ConcealedPhysics(
    name="profile_slope",
    size="slope_um",
    apply=apply,
    example=example,
    cap=20.0,
    as_built="slope",
    rivals=("profile_slope'", "wear", "wear'", "tip_relief", "tip_relief'", "friction"),
    source="ISO 1328-1: f_Halpha; the contract's straight line over the roll length",
)
