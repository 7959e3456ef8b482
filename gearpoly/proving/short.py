"""Short recordings are the ordinary case: 120 further cases of the bench that hold half a hunting cycle to two."""

from __future__ import annotations

import numpy as np

from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.ground import (
    LOOK_ALIKES,
    MASKED,
    ONE_FLANK,
    PHYSICS_BESIDE_BACKGROUND,
    SINGLE,
    SIZES_OVER_LIMIT,
    TWO,
)

SHORT_HUNTING_CYCLES = (0.5, 0.7, 1.0, 1.3, 1.6, 2.0)
"""Hunting cycles in a recording: below one no pair of teeth meets twice, below two none is seen thrice."""

SHORT_CASES_BY_CLASS = {
    "healthy": 30, "single": 42, "two": 12, "masked": 6, "one_flank": 6, "look_alike": 8, "beside": 8, "stranger": 8,
}  # fmt: skip
"""Cases by class, the classes of the bench: a quarter healthy, every physics twice, small and large."""

SHORT_CONCEALED_BY = {
    f"short_{klass}": f"in half a hunting cycle to two, as {klass} of the bench" for klass in SHORT_CASES_BY_CLASS
}
"""What conceals the effects of a class."""


def _concealed(klass: str, v: int) -> tuple[tuple[str, ...], float]:
    """What the case v of a class conceals, and its size over the limit (0: fixed)."""
    sizes = [size for size in SIZES_OVER_LIMIT if size >= 3.0]
    if klass == "healthy":
        return (), 0.0
    if klass == "two":
        return TWO[v % len(TWO)], (10.0, 20.0, 30.0)[v % 3]
    if klass == "masked":
        return (MASKED[v % len(MASKED)],), 0.0
    if klass == "stranger":
        return ("disturbance",), (8.0, 14.0, 25.0, 30.0)[v % 4]
    names = {"single": SINGLE, "one_flank": ONE_FLANK, "look_alike": LOOK_ALIKES, "beside": PHYSICS_BESIDE_BACKGROUND}[
        klass
    ]
    lap = v // len(names)
    return (names[v % len(names)],), sizes[(3 * v + 4 * lap) % len(sizes)]


def plan(seed: int, *, quick: bool = False) -> list[CaseEntry]:
    """All cases of the ground, in an order that tells nothing; quick: one of each class."""
    rng = np.random.default_rng([seed, 0x5C0])
    turn = int(rng.integers(1000)) if quick else 0
    rows = [
        (klass, *_concealed(klass, v), v)
        for klass, count in SHORT_CASES_BY_CLASS.items() for v in range(turn, turn + (1 if quick else count))
    ]  # fmt: skip
    return [
        CaseEntry(
            index=i, klass=klass, physics=physics, over=over, variant=v, quick=quick,
            cycles=SHORT_HUNTING_CYCLES[v % len(SHORT_HUNTING_CYCLES)],
        )
        for i, (klass, physics, over, v) in enumerate(rows[k] for k in rng.permutation(len(rows)))
    ]  # fmt: skip
