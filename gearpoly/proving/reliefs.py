"""Tip reliefs that take up what the teeth give: at one torque the step between one and two pairs in contact vanishes.

A relief rises in roll length from the end of single contact to the tip. Two equal pairs of stiffness k then share a
force F so that their mean sag is F/(2 k) + C/2 wherever they touch, which is that of one pair alone where C = F/k.
Derived here; teeth that are softer at their tips, and Hertz's law, shift the two amounts a little, so they are found by
least squares."""

from __future__ import annotations

from dataclasses import replace
from math import hypot

import numpy as np
from scipy.optimize import least_squares

from gearpoly.proving.compliance import compliance
from gearpoly.proving.effects import Effect, apply
from gearpoly.proving.gears import MM_PER_UM, FloatArray, IdealPair
from gearpoly.proving.rig import Rig, meshing

RIPPLE_POSITIONS = 64
"""Positions over one pitch at which mesh ripple is looked at: enough for the step between one and two pairs."""


def spanning(pair: IdealPair, index: int) -> float:
    """Radial length in mm of a relief of one gear from the end of single contact to the tip."""
    g = pair.gear(index)
    return g.r_a - hypot(g.r_b, g.l_tip - (pair.eps - 1) * pair.p_b)


def sag(rig: Rig, torque: float) -> float:
    """Deflection in um of one pair of teeth that carries a torque (N.m) alone at the pitch point."""
    law = compliance(rig.pair, law=rig.law, scale=rig.scale)
    force = torque * 1000 / rig.pair.driven.r_b
    return law.single(rig.pair.l_work(1), rig.pair.l_work(2), force) * force / MM_PER_UM


def mean_tooth(rig: Rig) -> Rig:
    """The same rig with every tooth as its gear's mean one, on centre: what is left repeats at every mesh."""
    out = replace(rig, eccentric_1=(0.0, 0.0), eccentric_2=(0.0, 0.0))
    for index in (1, 2):
        teeth, z = rig.teeth(index), rig.pair.gear(index).z
        slope, crowning, E_s = (np.full(z, v.mean()) for v in (teeth.slope, teeth.crowning, teeth.E_s))
        even = replace(teeth, p=np.zeros(z), own=np.ones(z), slope=slope, crowning=crowning, E_s=E_s)
        out = out.with_teeth(index, even)
    return out


def over_a_pitch(rig: Rig, torque: float) -> FloatArray:
    """Transmission error in um of a rig without differences between its teeth, over one pitch, about its mean."""
    theta_2 = np.linspace(0.0, rig.pair.driven.tau, RIPPLE_POSITIONS, endpoint=False)
    x = meshing(rig, theta_2, torque=torque) / MM_PER_UM
    return np.asarray(x - x.mean())


def cancelling(rig: Rig, torque: float) -> tuple[Effect, Effect]:
    """Reliefs of both gears with which bending teeth leave, at a torque in N.m, the mesh ripple that rigid ones of the
    same slopes have, as nearly as amounts to 0.1 um can."""
    pair, rigid = rig.pair, replace(mean_tooth(rig), deflect=False)

    def reliefs(amounts: FloatArray) -> tuple[Effect, Effect]:
        one, two = (
            Effect(
                physics="tip_relief", gear=index, size=float(amount),
                more={"length_mm": round(spanning(pair, index), 3), "power": 1.0},
            ) for index, amount in zip((1, 2), amounts, strict=True)
        )  # fmt: skip
        return one, two

    def ripple(amounts: FloatArray) -> FloatArray:
        one, two = reliefs(amounts)
        bent = replace(apply(apply(rigid, one), two), deflect=True)
        return over_a_pitch(bent, torque) - over_a_pitch(rigid, torque)

    start = np.full(2, sag(rig, torque))
    found = least_squares(ripple, start, bounds=(0.3 * start, 2.0 * start), diff_step=[0.05, 0.05])
    return reliefs(np.round(found.x, 1))
