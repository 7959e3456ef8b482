"""The pair is one stage of a drive: what turns with its shafts makes waves at whole and rational orders."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from gearpoly.proving.chain import Chain, RecordedCondition
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.effects import Effect, instance
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.life import records
from gearpoly.proving.life.base import LifeCase, Setting, finish, plain_recipe, turns
from gearpoly.proving.scenes import COMMON_PAIRS, COPRIME

HIDDEN_IN_TRAIN: tuple[tuple[str, ...], ...] = (
    (), ("eccentricity",), (), ("tooth_pitch",), ("profile_slope",), (), ("tooth_spall",), ("cumulative_pitch",),
)  # fmt: skip


def make(seed: int, entry: CaseEntry, rng: np.random.Generator) -> LifeCase:
    """One case: waves of a wheel on either shaft (whole orders) and of shafts that turn in another ratio."""
    v = entry.variant
    name = str(rng.choice(COPRIME + COMMON_PAIRS))
    pair = make_pair(name)
    condition = RecordedCondition(
        torque=0.0, speed=30.0, turns=turns(entry, name, 2.2 * pair.hunting_turns), per_mesh=14,
        wobble=float(rng.uniform(0.001, 0.008)), uneven=float(rng.uniform(0.05, 0.25)),
    )  # fmt: skip
    gear = 1 + v % 2
    other = int(rng.choice([q for q in range(11, 40) if q != pair.gear(gear).z]))
    next_z = int(rng.choice([31, 37, 53, 61]))
    orders = [float(other), round(other / next_z, 4), round(2 * other / next_z, 4), float(rng.choice([2, 3, 4, 5]))]
    chosen = orders[: 2 + v % 3]
    waves = tuple(
        Effect(physics="disturbance", more={"shape": Disturbance(
            kind="line", amplitude=1.0, gear=gear, order=order, phase=float(rng.uniform(0, 2 * pi)))})
        for order in chosen
    )  # fmt: skip
    chain = Chain(
        noise_um=float(rng.choice([0.3, 1.0])), known=bool(rng.random() < 0.5),
        zeros_deg=(float(rng.uniform(0, 360)), float(rng.uniform(0, 360))), steps_deg=(1e-5, 1e-5),
    )  # fmt: skip
    stated = v % 4 < 2
    made = plain_recipe(
        entry, name, (condition,), chain,
        tuple(instance(one, pair, (condition,), rng) for one in HIDDEN_IN_TRAIN[(v + v // 8) % len(HIDDEN_IN_TRAIN)]),
        background=waves, background_over=tuple(float(rng.choice([10.0, 30.0, 100.0])) for _ in waves),
        concealed_by="waves of the other stages of the drive",
    )  # fmt: skip
    side = "driving" if gear == 1 else "driven"

    def declared(text: str) -> str:
        if not stated:
            return text
        return text + (
            f'\n[[also_turns]]\nname = "wheel beside it"\nturns_per_{side} = 1\nteeth = {other}\n'
            f'\n[[also_turns]]\nname = "next wheel"\nturns_per_{side} = {other / next_z:.6f}\nteeth = {next_z}\n'
        )

    told: dict[str, Any] = {
        "turns_with": side,
        "other_wheel_teeth": other,
        "next_wheel_teeth": next_z,
        "stated": stated,
    }
    return finish(
        seed, entry, Setting(made=made, record=records.both_angles, declared=declared, told=told), rng
    )  # fmt: skip
