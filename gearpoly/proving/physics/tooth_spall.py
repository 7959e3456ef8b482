"""A pit in one flank."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import numpy as np

from gearpoly.proving.gears import FloatArray
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Kind, RivalSetting, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """A pit between two radii of one drive flank."""
    more = effect.more
    pits = ((more["tooth"], effect.size, more["from_mm"], more["to_mm"]),)
    return rig.with_teeth(effect.gear, replace(rig.teeth(effect.gear), pits=pits))


def example(site: Site) -> Effect:
    """4 um deep."""
    low, high = site.shapes.pit_mm
    more = {"tooth": site.tooth, "from_mm": low, "to_mm": high}
    return Effect(physics="tooth_spall", gear=site.gear, size=4.0, more=more)


def kind(physics: ConcealedPhysics, beside: RivalSetting) -> Kind:
    """A pit wherever it may be: depth, middle and half width, the latter two in parts of the active flank."""
    gear, tooth = beside.gear, beside.effect.more["tooth"]
    g, start = beside.rig.pair.gear(gear), beside.rig.pair.l_start(gear)
    span = g.l_tip - start

    def pit(v: FloatArray) -> Effect:
        ends = [start + span * float(np.clip(v[1] + side * v[2], 0.0, 1.0)) for side in (-1, 1)]
        low, high = (sqrt(g.r_b**2 + l * l) for l in ends)
        more = {"tooth": tooth, "from_mm": low, "to_mm": high}
        return Effect(physics="tooth_spall", gear=gear, size=float(v[0]), more=more)

    return Kind(
        make=pit, low=np.array([0.0, 0.05, 0.04]), high=np.array([2 * physics.cap, 0.95, 0.5]),
        step=np.array([1.0, 0.02, 0.02]), amplitudes=1, starts=((0.5, 0.5), (0.3, 0.2), (0.5, 0.2), (0.7, 0.2)),
    )  # fmt: skip


PHYSICS = ConcealedPhysics(
    name="tooth_spall",
    size="depth_um",
    apply=apply,
    example=example,
    cap=50.0,
    tells=("from_mm", "to_mm"),
    one_sign=True,
    kind=kind,
    place="tooth",
    nearby=("tooth_flank",),
    rivals=("tooth_pitch", "tooth_crack"),
    source="the contract: a depth between two radii; walls of half a cosine",
)
