"""Printed or moulded gears: no grade, errors of 30 to 100 um, soft material."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearpoly.proving.chain import Chain, campaign_turns
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.effects import Effect, instance
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.life import records
from gearpoly.proving.life.base import LifeCase, Setting, finish, plain_recipe, turns
from gearpoly.proving.rig import Rig
from gearpoly.proving.scenes import campaign, design_torque

LARGE_PAIRS = ("18/25 m2", "13/40 m1", "24/36 m1", "17/22 m4 22.5deg")
HIDDEN_IN_LARGE = (
    "eccentricity",
    "cumulative_pitch",
    "profile_crowning",
    "tooth_pitch",
    "profile_slope",
    "",
    "tooth_spall",
    "wear",
)
LARGE_SIZE_WITHIN_PART = 0.10
"""Part of a large size to which it is to be found, or told honestly: models of one pair differ by less."""
YOUNGS_GPA = (2.6, 1.8, 206.0)
"""Polyamide, ABS, and brass teeth as stiff as steel's law has them."""


def make(seed: int, entry: CaseEntry, rng: np.random.Generator) -> LifeCase:
    """One case."""
    v = entry.variant
    name = LARGE_PAIRS[v % len(LARGE_PAIRS)]
    pair = make_pair(name)
    youngs = YOUNGS_GPA[v % 3]
    soft = youngs < 100.0
    full = 0.01 * design_torque(pair)
    kind = "two" if soft else "free"
    conditions = campaign_turns(campaign(kind, pair, rng, cycles=1.0), turns(entry, name, 2.2 * pair.hunting_turns))
    # Plastic carries a hundredth of what steel does; a heavier load would bend teeth by their own height.
    conditions = tuple(replace(c, torque=round(full * (1.0 if c.torque > full else 0.03), 4) if soft else 0.0)
                       for c in conditions)  # fmt: skip
    what = HIDDEN_IN_LARGE[(v + v // 8) % len(HIDDEN_IN_LARGE)]
    effects: tuple[Effect, ...] = ()
    if what:
        one = instance(what, pair, conditions, rng)
        m = pair.driving.m
        size = float(rng.uniform(30.0, 100.0)) * min(1.0, 0.4 + 0.3 * m)
        if what in ("profile_slope", "profile_crowning", "wear", "tooth_spall"):
            size *= 0.4
        effects = (one.scaled(size),)
    zeros = (float(rng.uniform(0, 360)), float(rng.uniform(0, 360)))
    chain = Chain(
        noise_um=float(rng.choice([1.0, 3.0])), known=bool(rng.random() < 0.5), zeros_deg=zeros, steps_deg=(1e-4, 1e-4)
    )
    made = plain_recipe(
        entry, name, conditions, chain, effects, grade=10, deflect=soft, fixed=True,
        concealed_by="gears that nobody graded, printed or moulded",
    )  # fmt: skip

    def plastic(rig: Rig) -> Rig:
        return replace(rig, youngs_mpa=1000.0 * youngs)

    def declared(text: str) -> str:
        lines = [line for line in text.splitlines() if not line.startswith(("grade =", "E_s", "[driving.limits]",
                                                                            "[driven.limits]"))]  # fmt: skip
        return "\n".join([*lines, "[material]", f"youngs_modulus_gpa = {youngs:g}", ""])

    told = {"youngs_modulus_gpa": youngs, "within": LARGE_SIZE_WITHIN_PART}
    return finish(
        seed, entry, Setting(made=made, record=records.both_angles, rig=plastic, declared=declared, told=told), rng
    )  # fmt: skip
