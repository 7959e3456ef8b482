"""Something that no mechanism of a catalogue makes is added to the readings."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from gearpoly.proving.chain import RecordedCondition
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """One more disturbance, of the effect's size."""
    return replace(rig, extras=(*rig.extras, replace(effect.more["shape"], amplitude=effect.size)))


def example(site: Site) -> Effect:
    """A line of 1 um that swells and fades, at no whole order."""
    shape = Disturbance(kind="asymmetric", amplitude=1.0, gear=site.gear, order=3.37, phase=site.phase)
    return Effect(physics="disturbance", more={"shape": shape})


def told(rig: Rig, effect: Effect, conditions: tuple[RecordedCondition, ...]) -> dict[str, Any]:
    """Shape and place, no name."""
    shape: Disturbance = effect.more["shape"]
    out: dict[str, Any] = {"shape": shape.kind, "amplitude_um": effect.size}
    if shape.kind == "hum":
        out["hz"] = shape.hz
        # Even samples in time show what is faster than half their rate below it as well.
        rates = [c.per_mesh * rig.pair.driving.z * c.speed / 60.0 for c in conditions]
        images = {round(abs(shape.hz - round(shape.hz / rate) * rate), 4) for rate in rates}
        out["images_hz"] = sorted(images - {round(shape.hz, 4)})
    elif shape.kind == "jump":
        out["at"] = shape.at
    else:
        out |= {"order": shape.order, "gear": shape.gear}
    return out


PHYSICS = ConcealedPhysics(
    name="disturbance",
    size="",
    apply=apply,
    example=example,
    cap=10.0,
    plain=True,
    told=told,
    outside=True,
    source="none",
)
