"""Samples at even steps of the angle or the time: what is faster than half of them shows at an alias."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gearpoly.proving.chain import Chain, Motion, RecordedCondition, motion
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.effects import Effect, instance
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.life import records
from gearpoly.proving.life.base import LifeCase, Setting, finish, plain_recipe, turns
from gearpoly.proving.life.wander import folded
from gearpoly.proving.rig import Rig
from gearpoly.proving.scenes import COPRIME

HIDDEN_IN_EVEN_SAMPLES = (
    "encoder_interpolation",
    "",
    "hum",
    "undulation",
    "",
    "tooth_pitch",
    "encoder_interpolation",
    "hum",
)


def even_angles(rig: Rig, condition: RecordedCondition, rng: np.random.Generator) -> Motion:
    """The same running, sampled at even steps of the driven angle."""
    path = motion(rig, replace(condition, uneven=0.0), rng)
    fine = np.linspace(path.span[0], path.span[1], 20 * path.time.size)
    theta_2 = np.linspace(path.theta_2[0], path.theta_2[-1], path.time.size)
    time = np.interp(theta_2, path.angle(fine), fine)
    for _ in range(3):  # Newton's method: the angle is nearly straight between points
        time = time - (path.angle(time) - theta_2) / path.rate
    return replace(path, time=time, theta_2=path.angle(time))


def make(seed: int, entry: CaseEntry, rng: np.random.Generator) -> LifeCase:
    """One case: half of them even in angle, half in time (at an even speed)."""
    v = entry.variant
    name = str(rng.choice(COPRIME))
    pair = make_pair(name)
    by_angle = v % 2 == 0
    per_mesh = (6, 8, 10)[v % 3]
    what = HIDDEN_IN_EVEN_SAMPLES[(v + v // 8) % len(HIDDEN_IN_EVEN_SAMPLES)]
    condition = RecordedCondition(
        torque=0.0, speed=26.0, turns=turns(entry, name, 2.2 * pair.hunting_turns), per_mesh=per_mesh, uneven=0.0,
        wobble=0.004 if by_angle else 0.0,
    )  # fmt: skip
    effects: tuple[Effect, ...] = ()
    if what == "hum":
        shape = Disturbance(kind="hum", amplitude=1.0, hz=float(rng.choice([50.0, 60.0, 100.0])))
        effects = (Effect(physics="disturbance", more={"shape": shape}),)
    elif what:
        effects = (instance(what, pair, (condition,), rng),)
    zeros = (float(rng.uniform(0, 360)), float(rng.uniform(0, 360)))
    chain = Chain(noise_um=0.3, known=bool(rng.random() < 0.6), zeros_deg=zeros, column="te_um")

    def record(rig: Rig, condition: RecordedCondition, chain: Chain, path: Motion, rng: np.random.Generator) -> str:
        table = records.te_table(rig, condition, chain, path, rng)
        return records.text(records.heading(condition, chain, rng), table)

    n = round(condition.turns * pair.driving.z * per_mesh)
    first_last = condition.turns * pair.driving.z / pair.driven.z * (n - 1) / n
    per_turn = (n - 1) / first_last

    def aliases(item: dict[str, Any]) -> list[float]:
        return folded(item, pair.driving.z, pair.driven.z, per_turn)

    made = plain_recipe(
        entry, name, (condition,), chain, effects, concealed_by="samples at even steps: a wave and its aliases are one"
    )
    told = {"even": "angle" if by_angle else "time", "samples_per_driven_turn": round(per_turn, 4)}
    setting = Setting(made=made, record=record, aliases=aliases, told=told)
    return finish(seed, entry, replace(setting, move=even_angles) if by_angle else setting, rng)
