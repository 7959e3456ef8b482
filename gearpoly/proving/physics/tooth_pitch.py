"""One tooth stands where its pitch does not put it."""

from __future__ import annotations

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """The index deviation of one tooth."""
    return rig.with_teeth(effect.gear, rig.teeth(effect.gear).index_plus(effect.more["tooth"], effect.size))


def example(site: Site) -> Effect:
    """1 um either way."""
    return Effect(physics="tooth_pitch", gear=site.gear, size=site.sign, more={"tooth": site.tooth})


PHYSICS = ConcealedPhysics(
    name="tooth_pitch",
    size="deviation_um",
    apply=apply,
    example=example,
    cap=40.0,
    as_built="index",
    place="tooth",
    nearby=("tooth_flank",),
    rivals=("tooth_crack", "tooth_spall"),
    source="ISO 1328-1: index deviation",
)
