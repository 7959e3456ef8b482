"""A rolling bearing: a line at no whole order whose balls slip, so that it is not quite periodic."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import Any

import numpy as np

from gearpoly.proving.chain import RecordedCondition
from gearpoly.proving.gears import MM_PER_UM, FloatArray
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Extra, Rig


@dataclass(frozen=True, kw_only=True)
class Balls(Extra):
    """The cage order of a bearing on shaft 1 or 2, in um along the line of action; slip: part of a period by which it
    wanders in ten turns of the shaft, as a slow wave does."""

    amplitude: float
    gear: int
    order: float
    phase: float
    slip: float

    def x(self, time: FloatArray, theta_1: FloatArray, theta_2: FloatArray, span: tuple[float, float]) -> FloatArray:
        """A wave whose phase wanders."""
        theta = theta_1 if self.gear == 1 else theta_2
        wander = 2 * pi * self.slip * np.sin(theta / 10.0 + self.phase)
        return np.asarray(MM_PER_UM * self.amplitude * np.cos(self.order * theta + self.phase + wander))


def apply(rig: Rig, effect: Effect) -> Rig:
    """One more bearing."""
    more = effect.more
    balls = Balls(amplitude=effect.size, gear=effect.gear, order=more["order"], phase=more["phase"], slip=more["slip"])
    return replace(rig, extras=(*rig.extras, balls))


def example(site: Site) -> Effect:
    """1 um at the cage order of 7 to 11 balls: 0.5 (1 - d/D cos) of a turn times the balls."""
    balls = int(site.rng.integers(7, 12))
    order = round(0.5 * balls * (1.0 - float(site.rng.uniform(0.2, 0.3))), 3)
    if abs(order - round(order)) < 0.12:  # whole orders are other things
        order += 0.21
    more = {"order": round(order, 3), "phase": site.phase, "slip": float(site.rng.uniform(0.02, 0.1))}
    return Effect(physics="bearing", gear=site.gear, size=1.0, more=more)


def told(rig: Rig, effect: Effect, conditions: tuple[RecordedCondition, ...]) -> dict[str, Any]:
    """A line at an order of its shaft."""
    return {
        "shape": "line", "cause": "bearing", "amplitude_um": effect.size, "order": effect.more["order"],
        "gear": effect.gear,
    }  # fmt: skip


PHYSICS = ConcealedPhysics(
    name="bearing",
    size="",
    apply=apply,
    example=example,
    cap=10.0,
    plain=True,
    told=told,
    outside=True,
    source="kinematics of rolling bearings: outer race order n/2 (1 - d/D cos alpha)",
)
