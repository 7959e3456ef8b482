"""Material is taken off near the tips."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import numpy as np

from gearpoly.proving.gears import FloatArray
from gearpoly.proving.physics.base import ConcealedPhysics, Effect, Kind, RivalSetting, Site
from gearpoly.proving.rig import Rig


def apply(rig: Rig, effect: Effect) -> Rig:
    """Another relief on all teeth of the gear."""
    more = effect.more
    relief = replace(
        rig.teeth(effect.gear), relief=effect.size, relief_mm=more["length_mm"], power=more.get("power", 1.0)
    )
    return rig.with_teeth(effect.gear, relief)


def example(site: Site) -> Effect:
    """2 um over a third to a half of the module, linear or parabolic."""
    more = {"length_mm": site.shapes.relief_mm, "power": site.shapes.relief_power}
    return Effect(physics="tip_relief", gear=site.gear, size=2.0, more=more)


def kind(physics: ConcealedPhysics, beside: RivalSetting) -> Kind:
    """A relief of any length; where one is declared, more or less of it at its own length."""
    cap, gear = 2 * physics.cap, beside.gear
    g, teeth = beside.rig.pair.gear(gear), beside.rig.teeth(gear)

    def relief(v: FloatArray) -> Effect:
        length = float(v[1]) if v.size > 1 else teeth.relief_mm
        more = {"length_mm": length, "power": teeth.power}
        return Effect(physics="tip_relief", gear=gear, size=teeth.relief + float(v[0]), more=more)

    if teeth.relief:
        return Kind(make=relief, low=np.array([-teeth.relief]), high=np.array([cap]), step=np.ones(1), amplitudes=1)
    deepest = g.r_a - sqrt(g.r_b**2 + beside.rig.pair.l_start(gear) ** 2)
    return Kind(
        make=relief, low=np.array([0.0, 0.1 * g.m]), high=np.array([cap, 0.95 * deepest]),
        step=np.array([1.0, 0.02 * g.m]), amplitudes=1, starts=((0.25 * g.m,), (0.6 * g.m,), (0.9 * deepest,)),
    )  # fmt: skip


PHYSICS = ConcealedPhysics(
    name="tip_relief",
    size="amount_um",
    apply=apply,
    example=example,
    cap=25.0,
    tells=("length_mm",),
    one_sign=True,
    kind=kind,
    rivals=(
        "tip_relief'",
        "profile_slope",
        "profile_slope'",
        "profile_crowning",
        "profile_crowning'",
        "wear",
        "wear'",
        "tooth_deflection",
    ),
    source="the contract's power of the roll length",
)
