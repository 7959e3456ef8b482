"""The axes stand further apart, or closer."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.gears import MM_PER_UM
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """More of it than the rig has."""
    return replace(rig, pair=replace(rig.pair, offset=rig.pair.offset + MM_PER_UM * effect.size))


def example(site: Site) -> Effect:
    """3 um either way."""
    return Effect(physics="centre_distance", size=site.sign * 3.0)


PHYSICS = ConcealedPhysics(
    name="centre_distance",
    size="offset_um",
    apply=apply,
    example=example,
    cap=100.0,
    gear=False,
    shows="flanks",
    nearby=("step",),
    rivals=("tooth_thickness", "tooth_thickness'", "shaft_windup", "misalignment"),
    source="ISO 21771: working pressure angle",
)
