"""Load sharing of one position, a second time: nested root finding on the exact law of every pair, no iteration of
stiffness, no arrays.

Pair i closes when the driving gear has turned on by ``closing`` (rad). Turned on by phi it gives
``c W + A W^p = lever_1 (phi - closing)`` under its force W >= 0, and the moments ``lever_2 W`` add up to the torque.
W grows with phi, so phi is the one root of the sum. Derived here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from scipy.optimize import brentq

# Relative; brentq cannot be asked for less than four roundings.
ROOT = 1e-14


@dataclass(frozen=True)
class Spring:
    """One pair of teeth: ``closing`` in rad, levers in mm, ``c`` of both teeth in mm/N; its contact flattens by
    A W^p mm under W N (p = 1: Hertz as Yang and Sun take it, 0.9: Palmgren, A = 0: rigid)."""

    closing: float
    lever_1: float
    lever_2: float
    c: float
    A: float = 0.0
    p: float = 1.0

    def give(self, W: float) -> float:
        """How far the pair gives in mm under ``W`` N."""
        return self.c * W + self.A * W**self.p

    def force(self, phi: float) -> float:
        """Force in N with the driving gear turned on by ``phi`` rad; a pair that is not pressed carries nothing."""
        pressed = self.lever_1 * (phi - self.closing)
        if pressed <= 0.0:
            return 0.0
        if self.A == 0.0 or self.p == 1.0:
            return pressed / (self.c + self.A)
        # A contact only adds to what gives, so the force without it is above the root.
        return _root(lambda W: self.give(W) - pressed, 0.0, pressed / self.c)

    def energy(self, W: float) -> float:
        """Complementary energy in N.mm, the integral of what gives over the force."""
        return 0.5 * self.c * W**2 + self.A * W ** (self.p + 1.0) / (self.p + 1.0)


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    # The absolute tolerance is left to the relative one: forces may be of any size.
    return float(brentq(f, low, high, xtol=1e-300, rtol=ROOT, maxiter=500))


def equilibrium(springs: Sequence[Spring], torque: float) -> tuple[float, list[float]]:
    """Rotation phi in rad and the forces in N that balance ``torque`` in N.mm, compression only."""
    if torque == 0.0:
        return min(s.closing for s in springs), [0.0] * len(springs)
    # Any one pair alone under the whole torque turns further than all together.
    alone = [s.closing + s.give(torque / s.lever_2) / s.lever_1 for s in springs]
    low = min(s.closing for s in springs)
    phi = _root(lambda x: sum(s.lever_2 * s.force(x) for s in springs) - torque, low, min(alone) * (1.0 + 1e-12))
    return phi, [s.force(phi) for s in springs]


def energy(springs: Sequence[Spring], forces: Sequence[float]) -> float:
    """What equilibrium makes least among all forces >= 0 that balance the torque: complementary energy plus the work
    of the gaps, each pair weighted by lever_2 over lever_1, in N.mm."""
    return math.fsum(
        s.lever_2 / s.lever_1 * (s.energy(W) + s.lever_1 * s.closing * W) for s, W in zip(springs, forces, strict=True)
    )


def study(springs: Sequence[Spring], torque: float) -> tuple[float, list[float]]:
    """The study's procedure: the first pair takes the whole torque; all pairs that this turn reaches join, and the
    turn is found again, until none joins. None that joined is let go, so its force may come out negative.

    The contact is linear here (p = 1). Source: Liu et al. (2020), Eqs. 17-21.
    """
    order = sorted(range(len(springs)), key=lambda i: springs[i].closing)
    joined = 1
    while True:
        among = [springs[i] for i in order[:joined]]
        k = [s.lever_1 * s.lever_2 / (s.c + s.A) for s in among]
        phi = (torque + math.fsum(a * s.closing for a, s in zip(k, among, strict=True))) / math.fsum(k)
        reached = sum(springs[i].closing < phi for i in order)
        if reached <= joined:
            break
        joined = reached
    forces = [0.0] * len(springs)
    for i in order[:joined]:
        s = springs[i]
        forces[i] = s.lever_1 * (phi - s.closing) / (s.c + s.A)
    return phi, forces
