"""The rig swings on the springs of its teeth."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt
from typing import Any

from gearpoly.proving.chain import RecordedCondition
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Rig

STIFFEST = 0.0025
"""Least (mesh frequency over natural frequency) squared: a spring twenty times as fast as the mesh."""


def apply(rig: Rig, effect: Effect) -> Rig:
    """A natural frequency that is the highest mesh frequency over the root of the size."""
    return replace(rig, resonance=(effect.more["mesh_hz"] / sqrt(effect.size), effect.more["damping_ratio"]))


def example(site: Site) -> Effect:
    """A natural frequency 4.5 times the highest mesh frequency."""
    fastest = max(c.speed for c in site.conditions) / 60 * site.pair.driving.z
    more = {"mesh_hz": fastest, "damping_ratio": float(site.rng.uniform(0.03, 0.1))}
    return Effect(physics="mesh_resonance", size=0.05, more=more)


def told(rig: Rig, effect: Effect, conditions: tuple[RecordedCondition, ...]) -> dict[str, Any]:
    """Damping and natural frequency."""
    ratio = effect.more["damping_ratio"]
    return {"damping_ratio": ratio, "frequency_hz": effect.more["mesh_hz"] / sqrt(effect.size)}


PHYSICS = ConcealedPhysics(
    name="mesh_resonance",
    size="frequency_hz",
    apply=apply,
    example=example,
    cap=1.6,
    least=STIFFEST,
    gear=False,
    shows="speeds",
    plain=True,
    nearby=("tone",),
    told=told,
    rivals=("profile_crowning", "tip_relief", "tip_relief'", "profile_slope", "friction", "misalignment"),
    source="one mass on a spring, forced by the static transmission error",
)
