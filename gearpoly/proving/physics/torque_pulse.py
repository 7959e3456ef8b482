"""The torque pulses once per turn of a shaft."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import Any

import numpy as np

from gearpoly.proving.chain import RecordedCondition
from gearpoly.proving.gears import FloatArray
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Extra, Rig


@dataclass(frozen=True, kw_only=True)
class Pulse(Extra):
    """A part of the torque that comes and goes once per turn of the driven shaft."""

    part: float
    phase: float
    teeth = True

    def torque(self, theta_2: FloatArray, span: tuple[float, float]) -> FloatArray:
        """1 and a wave."""
        return np.asarray(1.0 + self.part * np.cos(theta_2 + self.phase))


def apply(rig: Rig, effect: Effect) -> Rig:
    """A torque that pulses."""
    return replace(rig, extras=(*rig.extras, Pulse(part=effect.size, phase=effect.more["phase"])))


def example(site: Site) -> Effect:
    """5 % of the torque."""
    return Effect(physics="torque_pulse", size=0.05, more={"phase": float(site.rng.uniform(0, 2 * pi))})


def told(rig: Rig, effect: Effect, conditions: tuple[RecordedCondition, ...]) -> dict[str, Any]:
    """Once per turn of the driven shaft, the more the higher the torque."""
    return {"shape": "line", "cause": "torque_pulse", "order": 1, "gear": 2, "part_of_torque": effect.size}


PHYSICS = ConcealedPhysics(
    name="torque_pulse",
    size="",
    apply=apply,
    example=example,
    cap=0.4,
    unit=0.01,
    gear=False,
    shows="load",
    told=told,
    outside=True,
    source="statics: teeth bend in step with the torque",
)
