"""The recording is of another pair, of nearly the same ratio: nothing may be named, and that is to be said."""

from __future__ import annotations

import numpy as np

from gearpoly.proving.chain import Chain, Motion, RecordedCondition
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.effects import instance
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.life import records
from gearpoly.proving.life.base import LifeCase, Setting, finish, plain_recipe, turns
from gearpoly.proving.rig import Rig

TRUE = ("13/18", "23/32", "21/29", "28/39")
"""Pairs on the centre distance of the declared one; ratios differ from 18/25 by 0.3 to 0.6 %."""
DECLARED = """name = "18/25, as declared"

[pair]
speed_rpm = 30

[model]
tooth_deflection = false

[driving]
teeth = 18
module_mm = 2
face_width_mm = 20
grade = 6

[driven]
teeth = 25
module_mm = 2
face_width_mm = 20
grade = 6
"""
HIDDEN_IN_CONTROLS: tuple[tuple[str, ...], ...] = (
    ("eccentricity", "profile_crowning"), (), ("profile_crowning",), ("cumulative_pitch", "profile_slope"),
)  # fmt: skip


def make(seed: int, entry: CaseEntry, rng: np.random.Generator) -> LifeCase:
    """One case: half with both angles, whose ratio tells; half with the transmission error of a rig that knew it."""
    v = entry.variant
    name = TRUE[v % len(TRUE)]
    pair = make_pair(name)
    condition = RecordedCondition(
        torque=0.0, speed=30.0, turns=turns(entry, "18/25 m2", float(rng.uniform(30.0, 55.0))), per_mesh=14,
        wobble=0.004, uneven=0.15,
    )  # fmt: skip
    effects = tuple(
        instance(one, pair, (condition,), rng) for one in HIDDEN_IN_CONTROLS[(v // 4) % len(HIDDEN_IN_CONTROLS)]
    )
    by_angle = v % 8 < 4
    zeros = (float(rng.uniform(0, 360)), float(rng.uniform(0, 360)))
    chain = Chain(noise_um=0.3, known=False, zeros_deg=zeros, steps_deg=(1e-5, 1e-5))

    def record(rig: Rig, condition: RecordedCondition, chain: Chain, path: Motion, rng: np.random.Generator) -> str:
        table = (records.angle_table if by_angle else records.te_table)(rig, condition, chain, path, rng)
        return records.text(records.heading(condition, chain, rng), table)

    made = plain_recipe(
        entry, name, (condition,), chain, effects, grade=6, concealed_by="another pair of nearly the same ratio"
    )

    def declared(text: str) -> str:
        return DECLARED

    file = {
        "wrong": "another_pair", "says": ["pair", "teeth", "ratio"], "over_limit": None,
        "true_teeth": [pair.driving.z, pair.driven.z], "by": "angles" if by_angle else "te_um",
    }  # fmt: skip
    # What the true pair has is of that pair: of the declared one nothing may be named, nothing need be located.
    told = {"file": file, "may_name": [], "truth": [], "control": True}
    return finish(
        seed, entry, Setting(made=made, record=record, declared=declared, kind="wrong_file", told=told), rng
    )  # fmt: skip
