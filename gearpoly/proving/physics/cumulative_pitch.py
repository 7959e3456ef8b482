"""Index deviations of a gear run through a wave per turn."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Kind, RivalSetting, Site, wave
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """A wave on the index deviations of the drive flanks."""
    teeth, z = rig.teeth(effect.gear), rig.pair.gear(effect.gear).z
    added = np.cos(effect.more["order"] * 2 * pi * np.arange(z) / z + effect.more["phase"])
    return rig.with_teeth(effect.gear, replace(teeth, p=teeth.p + effect.size * added))


def example(site: Site) -> Effect:
    """1 um, one to four times per turn."""
    more = {"order": site.shapes.pitch_order, "phase": site.phase}
    return Effect(physics="cumulative_pitch", gear=site.gear, size=1.0, more=more)


def kind(physics: ConcealedPhysics, beside: RivalSetting) -> Kind | None:
    """A wave of no more periods than half the teeth."""
    found = wave(physics, beside)
    if found is None or found.make(np.ones(2)).more["order"] > beside.rig.pair.gear(beside.gear).z // 2:
        return None
    return found


PHYSICS = ConcealedPhysics(
    name="cumulative_pitch",
    size="amplitude_um",
    apply=apply,
    example=example,
    cap=40.0,
    tells=("order",),
    as_built="index",
    place="wave",
    rivals=("eccentricity", "encoder_eccentricity", "undulation", "cumulative_pitch'"),
    kind=kind,
    source="ISO 1328-1: index deviation; the contract: normal to the flank",
)
