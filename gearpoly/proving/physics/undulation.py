"""A wave runs over the flanks of all teeth, as a ghost of the wheel that cut them."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site, wave
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """A wave that runs on from tooth to tooth."""
    phase = effect.more["phase"]
    waves = ((effect.more["order"], effect.size, phase, phase + 2.0),)
    return rig.with_teeth(effect.gear, replace(rig.teeth(effect.gear), waves=waves))


def example(site: Site) -> Effect:
    """0.5 um at an order that is no mesh harmonic."""
    more = {"order": site.shapes.ghost_order, "phase": site.phase}
    return Effect(physics="undulation", gear=site.gear, size=0.5, more=more)


PHYSICS = ConcealedPhysics(
    name="undulation",
    size="amplitude_um",
    apply=apply,
    example=example,
    cap=6.0,
    tells=("order",),
    kind=wave,
    place="wave",
    rivals=("encoder_interpolation", "cumulative_pitch", "undulation'"),
    source="the contract: A cos(n theta + phase)",
)
