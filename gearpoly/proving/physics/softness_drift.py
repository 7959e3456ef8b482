"""Teeth grow softer while the rig records, as plastic that warms does."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearpoly.proving.chain import RecordedCondition
from gearpoly.proving.gears import FloatArray
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Extra, Rig


@dataclass(frozen=True, kw_only=True)
class Softening(Extra):
    """A part by which the compliance of all teeth has grown at the end of each recording, evenly from its start."""

    part: float
    teeth = True

    def softness(self, theta_2: FloatArray, span: tuple[float, float]) -> FloatArray:
        """1 at the start, 1 and the part at the end."""
        return np.asarray(1.0 + self.part * (theta_2 - span[0]) / (span[1] - span[0]))


def apply(rig: Rig, effect: Effect) -> Rig:
    """Teeth that grow softer."""
    return replace(rig, extras=(*rig.extras, Softening(part=effect.size)))


def example(site: Site) -> Effect:
    """5 %."""
    return Effect(physics="softness_drift", size=0.05)


def told(rig: Rig, effect: Effect, conditions: tuple[RecordedCondition, ...]) -> dict[str, Any]:
    """A slow course that mesh ripple follows, the more the higher the torque."""
    return {"shape": "course", "cause": "softness_drift", "part_at_end": effect.size}


PHYSICS = ConcealedPhysics(
    name="softness_drift",
    size="",
    apply=apply,
    example=example,
    cap=0.5,
    unit=0.01,
    gear=False,
    shows="load",
    told=told,
    outside=True,
    source="the compliance of teeth is in proportion to 1/E",
)
