"""The gear turns about an axis that is not its own."""

from __future__ import annotations

from dataclasses import replace
from math import atan2, cos, sin, sqrt
from typing import Any

from gearpoly.proving.gears import RAD_PER_DEG
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site, once_per_turn
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """The gear's centre moved on from where it is."""
    key = f"eccentric_{effect.gear}"
    amplitude, angle = getattr(rig, key)
    x = amplitude * cos(angle * RAD_PER_DEG) + effect.size * cos(effect.more["angle_deg"] * RAD_PER_DEG)
    y = amplitude * sin(angle * RAD_PER_DEG) + effect.size * sin(effect.more["angle_deg"] * RAD_PER_DEG)
    moved: dict[str, Any] = {key: (sqrt(x * x + y * y), atan2(y, x) / RAD_PER_DEG % 360.0)}
    return replace(rig, **moved)


def example(site: Site) -> Effect:
    """1 um."""
    return Effect(physics="eccentricity", gear=site.gear, size=1.0, more={"angle_deg": site.angle_deg})


PHYSICS = ConcealedPhysics(
    name="eccentricity",
    size="amplitude_um",
    apply=apply,
    example=example,
    cap=80.0,
    shows="coast",
    tells=("angle_deg",),
    place="wave",
    rivals=("cumulative_pitch", "encoder_eccentricity"),
    kind=once_per_turn,
    source="geometry: the centre runs on a circle about the axis",
)
