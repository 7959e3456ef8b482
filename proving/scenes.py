"""What a recording campaign looks like, so that one physics can show, and one instance of every physics with where it
sits."""

from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np

from proving.chain import Chain, Condition
from proving.drawn import make_pair
from proving.effects import Effect
from proving.gears import UM, Pair
from proving.rig import Disturbance

COPRIME = ("18/25 m2", "19/24 m3 25deg", "15/28 m1.5 shifted", "17/22 m4 22.5deg")
COMMON = ("24/36 m1", "20/30 m6", "30/45 m0.5")

LOADED = ("tooth_crack", "tooth_deflection", "misalignment", "friction", "shaft_windup")
BOTH_FLANKS = ("centre_distance", "tooth_thickness")
TIMED = ("thermal_drift", "mesh_resonance", "disturbance", "encoder_scale")
SHAFT = ("encoder_eccentricity", "encoder_interpolation", "encoder_scale")

CAPS = {
    "eccentricity": 80.0, "cumulative_pitch": 40.0, "tooth_pitch": 40.0, "profile_slope": 20.0, "profile_crowning":
    20.0,
    "tip_relief": 25.0, "undulation": 6.0, "wear": 20.0, "tooth_spall": 50.0, "tooth_crack": 3.0, "misalignment": 40.0,
    "friction": 0.2, "centre_distance": 100.0, "tooth_thickness": 40.0, "mesh_resonance": 1.6, "thermal_drift": 40.0,
    "encoder_eccentricity": 3000.0, "encoder_interpolation": 500.0, "encoder_scale": 1e-3, "shaft_windup": 300.0,
    "disturbance": 10.0,
}  # fmt: skip
"""No larger than a rig could have it, in the unit of the effect's size."""


def design_torque(pair: Pair) -> float:
    """Driven torque in N.m at 75 N per mm of face width and mm of module: a well used case-hardened pair."""
    return 75.0 * pair.driving.m * pair.driving.b * pair.driven.r_b / 1000


def cycle_turns(pair: Pair, cycles: float) -> float:
    """Driving turns of a number of hunting cycles; pairs with a common factor, whose cycle is short, get at least ten
    turns for two."""
    short = max(1, round(12 / pair.hunting_turns))
    return cycles * pair.hunting_turns * short


def campaign(kind: str, pair: Pair, rng: np.random.Generator, *, cycles: float) -> tuple[Condition, ...]:
    """The recordings of one case: free, coast (both flanks, light), load (three torques), one (one torque), two,
    flanks (both, loaded), speeds, all."""
    full = design_torque(pair)
    turns = cycle_turns(pair, cycles)
    common: dict[str, Any] = {
        "turns": turns,
        "per_mesh": int(rng.choice([12, 14, 16])),
        "speed": float(rng.choice([20.0, 30.0, 60.0])),
        "wobble": float(rng.uniform(0.001, 0.008)),
        "uneven": float(rng.uniform(0.05, 0.25)),
    }
    light = round(0.01 * full, 3)
    torques = {
        "free": [(0.0, "drive")],
        "coast": [(light, "drive"), (light, "coast")],
        "load": [(round(0.02 * full, 3), "drive"), (round(0.5 * full, 3), "drive"), (round(full, 3), "drive")],
        "one": [(round(full, 3), "drive")],
        "two": [(round(0.03 * full, 3), "drive"), (round(full, 3), "drive")],
        "flanks": [(round(full, 3), "drive"), (round(full, 3), "coast")],
        "all": [(round(0.02 * full, 3), "drive"), (round(full, 3), "drive"), (round(full, 3), "coast")],
    }
    if kind == "speeds":
        top = float(rng.choice([120.0, 300.0]))
        common.pop("speed")
        # Lightly loaded, or the ripple of bending teeth would ring so loud that only the stiffest spring were hidden.
        light = round(0.05 * full, 3)
        return tuple(Condition(torque=light, speed=round(top * part, 1), **common) for part in (0.25, 0.6, 1.0))
    return tuple(Condition(torque=t, flank=flank, **common) for t, flank in torques[kind])


def chain(rng: np.random.Generator, *, noise_um: float, colour: float, inspected: bool, plain: bool) -> Chain:
    """A measuring chain: zeros anywhere, stated or not, counting up or down. plain: angles with times, since the case
    needs them."""
    te_column = not plain and rng.random() < 0.15
    counts = 2.0 ** rng.integers(22, 26, 2)
    return Chain(
        noise_um=noise_um,
        colour=colour,
        zeros_deg=(float(rng.uniform(0, 360)), float(rng.uniform(0, 360))),
        known=bool(rng.random() < (0.85 if inspected else 0.6)),
        directions=(-1 if rng.random() < 0.1 else 1, -1 if rng.random() < 0.1 else 1),
        steps_deg=(360.0 / counts[0], 360.0 / counts[1]),
        column="te_um" if te_column else "angles",
        timed=plain or bool(rng.random() > 0.1),
    )


def instance(
    physics: str, pair: Pair, conditions: tuple[Condition, ...], rng: np.random.Generator, *, gear: int = 0
) -> Effect:
    """One effect of the catalogue with all but its size drawn; its size is a first guess that leaves about a
    micrometre."""
    index = gear or int(rng.integers(1, 3))
    g = pair.gear(index)
    sign = -1.0 if rng.random() < 0.5 else 1.0
    tooth = int(rng.integers(g.z))
    angle, phase = float(rng.uniform(0, 360)), float(rng.uniform(0, 2 * pi))
    top = max(c.torque for c in conditions)
    whole = {
        "tooth_deflection": 1.0, "misalignment": 6.0, "friction": 0.05,
        "shaft_windup": UM / pair.driven.r_b / max(top, 1e-6) * 1e6,
    }  # fmt: skip
    if physics in whole:
        return Effect(physics=physics, size=whole[physics])
    if physics == "thermal_drift":
        return Effect(physics=physics, size=sign, more={"bend": float(rng.uniform(1.0, 4.0))})
    if physics == "centre_distance":
        return Effect(physics=physics, size=sign * 3.0)
    if physics == "mesh_resonance":
        fastest = max(c.speed for c in conditions) / 60 * pair.driving.z
        return Effect(
            physics=physics, size=0.05, more={"mesh_hz": fastest, "damping_ratio": float(rng.uniform(0.03, 0.1))}
        )
    per_um = UM / g.r_b * 1e6
    turns = max(c.turns for c in conditions) * (pair.driving.z / g.z)
    sized: dict[str, tuple[float, dict[str, Any]]] = {
        "eccentricity": (1.0, {"angle_deg": angle}),
        "cumulative_pitch": (1.0, {"order": int(rng.choice([1, 2, 2, 3, 4])), "phase": phase}),
        "tooth_pitch": (sign, {"tooth": tooth}),
        "profile_slope": (sign, {}),
        "profile_crowning": (1.0, {}),
        "tip_relief": (
            2.0,
            {"length_mm": round(float(rng.uniform(0.3, 0.5)) * g.m, 3), "power": float(rng.choice([1.0, 2.0]))},
        ),
        "undulation": (0.5, {"order": _ghost(g.z, rng), "phase": phase}),
        "wear": (2.0, {}),
        "tooth_spall": (4.0, {"tooth": tooth, **_pit(pair, index, rng)}),
        "tooth_crack": (0.3, {"tooth": tooth}),
        "tooth_thickness": (sign * 3.0, {}),
        "encoder_eccentricity": (per_um, {"angle_deg": angle}),
        "encoder_interpolation": (per_um, {"order": int(rng.choice([360, 500, 720, 1024])), "phase": phase}),
        "encoder_scale": (sign * UM / g.r_b / (2 * pi * turns), {}),
    }
    size, more = sized[physics]
    return Effect(physics=physics, gear=index, size=size, more=more)


def _ghost(z: int, rng: np.random.Generator) -> int:
    """An order that is no mesh harmonic and no neighbour of one."""
    while True:
        order = int(rng.integers(2 * z, 4 * z))
        if 2 < order % z < z - 2:
            return order


def _pit(pair: Pair, index: int, rng: np.random.Generator) -> dict[str, float]:
    """Radii of a pit on the part of a tooth that carries alone, about a third to a half of that part and more."""
    g = pair.gear(index)
    start, tip = pair.l_start(index), g.l_tip
    middle = start + (tip - start) * rng.uniform(0.42, 0.6)
    half = 0.5 * (tip - start) * rng.uniform(0.16, 0.3)
    return {
        "from_mm": round(sqrt(g.r_b**2 + (middle - half) ** 2), 4),
        "to_mm": round(sqrt(g.r_b**2 + (middle + half) ** 2), 4),
    }


def odd_order(pair: Pair, gear: int, low: float, high: float, rng: np.random.Generator) -> float:
    """An order of the shaft of gear 1 or 2, between low and high, that is no whole order of either shaft and no sum of
    few of them."""
    ratio = pair.driving.z / pair.driven.z
    while True:
        order = round(float(rng.uniform(low, high)), 2)
        of_1, of_2 = (order, order / ratio) if gear == 1 else (order * ratio, order)
        if min(abs(of_1 - round(of_1)), abs(of_2 - round(of_2))) > 0.12:
            return order


def stranger(variant: int, pair: Pair, conditions: tuple[Condition, ...], rng: np.random.Generator) -> Effect:
    """Something from outside the catalogue: a bearing's order, hum, a jump, a pulse in no shaft's time, an asymmetric
    modulated wave."""
    index = int(rng.integers(1, 3))

    def odd(low: float, high: float) -> float:
        return odd_order(pair, index, low, high, rng)

    phase = float(rng.uniform(0, 2 * pi))
    shape = (
        Disturbance(kind="line", amplitude=1.0, gear=index, order=odd(2.5, 9.5), phase=phase),
        Disturbance(kind="hum", amplitude=1.0, hz=50.0, phase=phase),
        Disturbance(kind="jump", amplitude=1.0, at=float(rng.uniform(0.25, 0.75))),
        Disturbance(kind="pulse", amplitude=1.0, gear=index, order=odd(0.2, 0.9), phase=phase),
        Disturbance(kind="asymmetric", amplitude=1.0, gear=index, order=odd(2.2, 6.8), phase=phase),
    )[variant % 5]
    return Effect(physics="disturbance", size=1.0, more={"shape": shape})


__all__ = [
    "CAPS", "campaign", "chain", "cycle_turns", "design_torque", "instance", "make_pair", "odd_order", "stranger",
]  # fmt: skip
