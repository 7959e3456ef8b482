"""Waves, lengths and pits that a gear may have, drawn at random."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from gearpoly.proving.gears import IdealPair


@dataclass(frozen=True, kw_only=True)
class Shapes:
    """Order of a pitch wave; length (mm) and power of a relief; order of a ghost; radii (mm) of a pit; order of an
    encoder's lines."""

    pitch_order: int
    relief_mm: float
    relief_power: float
    ghost_order: int
    pit_mm: tuple[float, float]
    line_order: int


def shapes(pair: IdealPair, index: int, rng: np.random.Generator) -> Shapes:
    """Draw all shapes of gear 1 or 2, used or not: what else a case draws must not hang on what is hidden in it."""
    g = pair.gear(index)
    return Shapes(
        pitch_order=int(rng.choice([1, 2, 2, 3, 4])),
        relief_mm=round(float(rng.uniform(0.3, 0.5)) * g.m, 3),
        relief_power=float(rng.choice([1.0, 2.0])),
        ghost_order=_ghost(g.z, rng),
        pit_mm=_pit(pair, index, rng),
        line_order=int(rng.choice([360, 500, 720, 1024])),
    )


def _ghost(z: int, rng: np.random.Generator) -> int:
    """An order that is no mesh harmonic and no neighbour of one."""
    while True:
        order = int(rng.integers(2 * z, 4 * z))
        if 2 < order % z < z - 2:
            return order


def _pit(pair: IdealPair, index: int, rng: np.random.Generator) -> tuple[float, float]:
    """Radii of a pit on the part of a tooth that carries alone, about a third to a half of that part and more."""
    g = pair.gear(index)
    start, tip = pair.l_start(index), g.l_tip
    middle = start + (tip - start) * rng.uniform(0.42, 0.6)
    half = 0.5 * (tip - start) * rng.uniform(0.16, 0.3)
    low, high = (round(sqrt(g.r_b**2 + l * l), 4) for l in (middle - half, middle + half))
    return low, high
