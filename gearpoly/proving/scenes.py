"""What a recording campaign looks like, so that one physics can show."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from gearpoly.proving.chain import Chain, RecordedCondition
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.effects import Effect
from gearpoly.proving.gears import IdealPair

COPRIME = ("18/25 m2", "19/24 m3 25deg", "15/28 m1.5 shifted", "17/22 m4 22.5deg")
COMMON_PAIRS = ("24/36 m1", "20/30 m6", "30/45 m0.5")


def design_torque(pair: IdealPair) -> float:
    """Driven torque in N.m at 75 N per mm of face width and mm of module: a well used case-hardened pair."""
    return 75.0 * pair.driving.m * pair.driving.b * pair.driven.r_b / 1000


def cycle_turns(pair: IdealPair, cycles: float) -> float:
    """Driving turns of a number of hunting cycles; pairs with a common factor, whose cycle is short, get at least ten
    turns for two."""
    short = max(1, round(12 / pair.hunting_turns))
    return cycles * pair.hunting_turns * short


def campaign(kind: str, pair: IdealPair, rng: np.random.Generator, *, cycles: float) -> tuple[RecordedCondition, ...]:
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
        return tuple(RecordedCondition(torque=light, speed=round(top * part, 1), **common) for part in (0.25, 0.6, 1.0))
    return tuple(RecordedCondition(torque=t, flank=flank, **common) for t, flank in torques[kind])


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


def odd_order(pair: IdealPair, gear: int, low: float, high: float, rng: np.random.Generator) -> float:
    """An order of the shaft of gear 1 or 2, between low and high, that is no whole order of either shaft and no sum of
    few of them."""
    ratio = pair.driving.z / pair.driven.z
    while True:
        order = round(float(rng.uniform(low, high)), 2)
        of_1, of_2 = (order, order / ratio) if gear == 1 else (order * ratio, order)
        if min(abs(of_1 - round(of_1)), abs(of_2 - round(of_2))) > 0.12:
            return order


def stranger(
    variant: int, pair: IdealPair, conditions: tuple[RecordedCondition, ...], rng: np.random.Generator
) -> Effect:
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
