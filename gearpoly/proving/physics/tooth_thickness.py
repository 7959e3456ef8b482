"""All teeth are thinner or thicker; only the coast flanks move."""

from __future__ import annotations

from dataclasses import replace

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """The same on all teeth of the gear."""
    teeth = rig.teeth(effect.gear)
    return rig.with_teeth(effect.gear, replace(teeth, E_s=teeth.E_s + effect.size))


def example(site: Site) -> Effect:
    """A micrometre or a few."""
    return Effect(physics="tooth_thickness", gear=site.gear, size=site.sign * 3.0)


PHYSICS = ConcealedPhysics(
    name="tooth_thickness",
    size="deviation_um",
    apply=apply,
    example=example,
    cap=40.0,
    shows="flanks",
    place="step",
    rivals=("tooth_thickness'", "centre_distance", "shaft_windup"),
    source="ISO 21771: tooth thickness deviation along the reference circle",
)
