"""An effect put into a rig, an example of it, and the truth that the scorer reads of it."""

from __future__ import annotations

from typing import Any

import numpy as np

from gearpoly.proving.chain import Chain, RecordedCondition
from gearpoly.proving.gears import IdealPair
from gearpoly.proving.physics import CATALOGUE, PHYSICS_BY_NAME
from gearpoly.proving.physics.base import Effect, Site
from gearpoly.proving.rig import Rig
from gearpoly.proving.shapes import shapes


def apply(rig: Rig, effect: Effect) -> Rig:
    """The rig with one effect in it."""
    return PHYSICS_BY_NAME[effect.physics].apply(rig, effect)


def instance(
    physics: str, pair: IdealPair, conditions: tuple[RecordedCondition, ...], rng: np.random.Generator, *, gear: int = 0
) -> Effect:
    """One effect with all but its size drawn; its size is a first guess that leaves about a micrometre."""
    one = PHYSICS_BY_NAME[physics]
    index = gear or int(rng.integers(1, 3))
    sign = -1.0 if rng.random() < 0.5 else 1.0
    tooth = int(rng.integers(pair.gear(index).z))
    angle, phase = float(rng.uniform(0, 360)), float(rng.uniform(0, 2 * np.pi))
    drawn = shapes(pair, index, rng) if one.gear else None
    site = Site(
        pair=pair, conditions=conditions, gear=index, sign=sign, tooth=tooth, angle_deg=angle, phase=phase, rng=rng,
        drawn=drawn,
    )  # fmt: skip
    return one.example(site)


def truth(rig: Rig, effect: Effect, chain: Chain, conditions: tuple[RecordedCondition, ...]) -> dict[str, Any]:
    """What the scorer is told of one effect: the contract's names and units; encoder_deg where it sits on one tooth.
    What is outside the catalogue has a shape and no name."""
    one, more = PHYSICS_BY_NAME[effect.physics], effect.more
    if one.outside:
        assert one.told is not None
        return one.told(rig, effect, conditions)
    out: dict[str, Any] = {"physics": effect.physics}
    if effect.gear:
        out["gear"] = effect.gear
    if one.told is not None:
        out |= one.told(rig, effect, conditions)
    else:
        out |= {one.size: effect.size} | {key: more[key] for key in one.tells}
    if "tooth" in more:
        gear = rig.pair.gear(effect.gear)
        k = effect.gear - 1
        reading = chain.zeros_deg[k] + chain.directions[k] * more["tooth"] * 360.0 / gear.z
        out |= {"tooth": more["tooth"], "teeth": gear.z, "encoder_deg": reading % 360.0}
    return out


__all__ = ["CATALOGUE", "Effect", "apply", "instance", "truth"]
