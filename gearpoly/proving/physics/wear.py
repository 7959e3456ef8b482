"""All teeth are worn, most where they slide most."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """The same on all teeth of the gear."""
    teeth = rig.teeth(effect.gear)
    return rig.with_teeth(effect.gear, replace(teeth, wear=effect.size))


def example(site: Site) -> Effect:
    """A micrometre or a few."""
    return Effect(physics="wear", gear=site.gear, size=2.0)


PHYSICS = ConcealedPhysics(
    name="wear",
    size="depth_um",
    apply=apply,
    example=example,
    cap=20.0,
    one_sign=True,
    rivals=(
        "wear'",
        "profile_crowning",
        "profile_crowning'",
        "profile_slope",
        "profile_slope'",
        "tip_relief",
        "tip_relief'",
        "tooth_deflection",
    ),
    source="the contract's law: in proportion to the distance from the pitch point",
)
