"""The real-life ground: eight classes that the bench has not, from a seed alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.life import coarse, controls, even, large, outside, train, wander, wrong_file
from gearpoly.proving.life.base import LifeCase

CLASSES: dict[str, Callable[[int, CaseEntry, np.random.Generator], LifeCase]] = {
    "wander": wander.make, "coarse": coarse.make, "train": train.make, "even": even.make, "large": large.make,
    "wrong_file": wrong_file.make, "outside": outside.make, "controls": controls.make,
}  # fmt: skip
LIFE_CONCEALED_BY = {
    "wander": "red noise of 10 to 1000 times the gears' effects, an angle from the clock, few samples per mesh",
    "coarse": "encoders of 12 to 14 bits, readings that repeat, turning by hand",
    "train": "waves of the other stages of the drive",
    "even": "samples at even steps, in which a wave and its aliases are one",
    "large": "no grade, errors of 30 to 100 um, soft material",
    "wrong_file": "a file that says what is not so",
    "outside": "no mechanism of the catalogue makes it",
    "controls": "another pair of nearly the same ratio: nothing to find",
}
"""What conceals the effects of a class."""
EACH = 32
"""Cases of each class, 256 in all: a share of one half is known to 17 %, of all classes together to 6 %."""
CLASSES_WITH_SHORT_CASES = ("coarse", "train", "even", "large", "wrong_file", "outside")
"""Classes of which every second case holds half a hunting cycle to two: 96 of 256, more than a third."""
LIFE_HUNTING_CYCLES = (0.5, 0.8, 1.2, 1.6, 2.0)
LIFE_SIZES_OVER_LIMIT = (8.0, 30.0, 12.0, 60.0, 20.0, 5.0)
"""Sizes over the limit: what real life shows is mostly plain, or hopeless."""


def plan(seed: int, *, quick: bool = False) -> list[CaseEntry]:
    """All cases, in an order that tells nothing; quick: one of each class."""
    rng = np.random.default_rng([seed, 0x11FE])
    turn = int(rng.integers(1000)) if quick else 0
    rows = [(klass, v) for klass in CLASSES for v in range(turn, turn + (1 if quick else EACH))]
    mixed = [rows[k] for k in rng.permutation(len(rows))]
    return [
        CaseEntry(
            index=i, klass=klass, physics=(),
            over=LIFE_SIZES_OVER_LIMIT[(v + v // len(LIFE_SIZES_OVER_LIMIT)) % len(LIFE_SIZES_OVER_LIMIT)],
            variant=v, quick=quick,
            cycles=LIFE_HUNTING_CYCLES[(v // 2) % len(LIFE_HUNTING_CYCLES)]
            if klass in CLASSES_WITH_SHORT_CASES and v % 2 else 0.0,
        )
        for i, (klass, v) in enumerate(mixed)
    ]  # fmt: skip


def make(seed: int, entry: CaseEntry) -> LifeCase:
    """The case of one line of the plan."""
    return CLASSES[entry.klass](seed, entry, np.random.default_rng([seed, entry.index, 0x11FE]))
