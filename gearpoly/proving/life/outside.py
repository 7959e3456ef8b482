"""What no catalogue held when the bench was made: located, and given no name that stands for something else."""

from __future__ import annotations

import numpy as np

from gearpoly.proving.chain import Chain, campaign_turns
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.effects import instance
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.ground import SINGLE
from gearpoly.proving.life import records
from gearpoly.proving.life.base import LifeCase, Setting, finish, plain_recipe, turns
from gearpoly.proving.physics import PHYSICS_BY_NAME
from gearpoly.proving.scenes import COPRIME, campaign

LATER = tuple(name for name in PHYSICS_BY_NAME if name not in SINGLE and name != "disturbance")
"""Every physics that came to the bench after its 478 cases; a new file is here by itself."""


def make(seed: int, entry: CaseEntry, rng: np.random.Generator) -> LifeCase:
    """One case."""
    v = entry.variant
    what = LATER[v % len(LATER)]
    name = str(rng.choice(COPRIME))
    pair = make_pair(name)
    loaded = PHYSICS_BY_NAME[what].shows == "load"
    kind = "load" if loaded else "two" if PHYSICS_BY_NAME[what].place == "tooth" else "free"
    conditions = campaign_turns(campaign(kind, pair, rng, cycles=1.0), turns(entry, name, 2.1 * pair.hunting_turns))
    one = instance(what, pair, conditions, rng)
    fixed = what == "tooth_chip"
    if fixed:  # how much shows is a matter of how far the neighbours bridge it, so it is no size to search for
        one = one.scaled(round(one.size * float(rng.uniform(0.7, 1.3)), 3))
    zeros = (float(rng.uniform(0, 360)), float(rng.uniform(0, 360)))
    chain = Chain(
        noise_um=float(rng.choice([0.3, 1.0])), known=bool(rng.random() < 0.7), zeros_deg=zeros, steps_deg=(1e-5, 1e-5)
    )
    made = plain_recipe(
        entry, name, conditions, chain, (one,), grade=5, inspected=bool(rng.random() < 0.6), deflect=kind != "free",
        fixed=fixed, concealed_by="no mechanism of the catalogue makes it",
    )  # fmt: skip
    told = {"outside": what, "in_contract": not PHYSICS_BY_NAME[what].outside}
    return finish(seed, entry, Setting(made=made, record=records.both_angles, told=told), rng)
