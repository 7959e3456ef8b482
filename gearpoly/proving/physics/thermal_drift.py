"""The rig warms up while it records."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gearpoly.proving.chain import RecordedCondition
from gearpoly.proving.gears import FloatArray
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Kind, RivalSetting, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """A rise from start to end of every recording that flattens."""
    return replace(rig, drift=rig.drift + effect.size, drift_bend=effect.more.get("bend", rig.drift_bend))


def example(site: Site) -> Effect:
    """1 um either way."""
    return Effect(physics="thermal_drift", size=site.sign, more={"bend": float(site.rng.uniform(1.0, 4.0))})


def told(rig: Rig, effect: Effect, conditions: tuple[RecordedCondition, ...]) -> dict[str, Any]:
    """How far it goes, whichever way."""
    return {"amplitude_um": abs(effect.size)}


def kind(physics: ConcealedPhysics, beside: RivalSetting) -> Kind:
    """A drift of any size and bend."""

    def drift(v: FloatArray) -> Effect:
        return Effect(physics="thermal_drift", size=float(v[0]), more={"bend": float(v[1])})

    cap = 2 * physics.cap
    return Kind(
        make=drift, low=np.array([-cap, 0.01]), high=np.array([cap, 8.0]), step=np.array([1.0, 0.1]), amplitudes=1,
        starts=((0.1,), (3.0,)),
    )  # fmt: skip


PHYSICS = ConcealedPhysics(
    name="thermal_drift",
    size="amplitude_um",
    apply=apply,
    example=example,
    cap=40.0,
    gear=False,
    plain=True,
    told=told,
    kind=kind,
    place="course",
    rivals=("encoder_scale", "encoder_scale'"),
    source="an exponential approach",
)
