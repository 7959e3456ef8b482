"""Recordings of one set laid on one another: whole turns that no encoder counted, told by the teeth themselves."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.compare.curve import Curve, Cycle
from gearpoly.units import FloatArray

ALIKE = 0.5
"""Least correlation of the two recordings, mesh by mesh, at the place taken."""

CLEARLY = 4.0
"""Standard errors by which the place taken must be more alike than any other."""

PERFECT = 1.0 - 1e-12
"""Correlation of a recording with itself, short of what has no transformation."""

COVERED = 0.5
"""Part of the hunting cycle's meshes that both recordings must hold."""


def turns_between(first: Curve, other: Curve, cycle: Cycle) -> int | None:
    """How many turns of its encoder's shaft, modulo the hunting cycle, ``other`` lies further on than ``first``; None
    where the recordings do not tell.

    After whole turns of one shaft its teeth are the same and the mate's are not. Means over each mesh know all teeth,
    also those that nobody inspected, and little of load, which changes all meshes alike.
    """
    one, two = _by_mesh(first, cycle), _by_mesh(other, cycle)
    ways = cycle.meshes // math.gcd(other.turn, cycle.meshes)
    alike = np.full(ways, -1.0)
    held = 0
    for n in range(ways):
        there = np.roll(two, -n * other.turn)
        both = np.isfinite(one) & np.isfinite(there)
        held = int(both.sum())
        if held < COVERED * cycle.meshes or held < 3:
            continue
        a, b = one[both] - one[both].mean(), there[both] - there[both].mean()
        size = math.sqrt(float(a @ a) * float(b @ b))
        alike[n] = float(a @ b) / size if size > 0.0 else -1.0
    best = int(np.argmax(alike))
    next_best = float(np.max(np.delete(alike, best), initial=-1.0))
    # By Fisher's transformation a correlation is normal with this standard error.
    sure, doubt = np.arctanh(np.clip([alike[best], next_best], -PERFECT, PERFECT))
    apart = (sure - doubt) * math.sqrt(max(held - 3, 0))
    return best if alike[best] > ALIKE and apart > CLEARLY else None


def _by_mesh(curve: Curve, cycle: Cycle) -> FloatArray:
    """Mean transmission error (meshes,) in mm of every mesh of the hunting cycle; nan where none was recorded."""
    mesh = np.mod(np.floor(curve.theta_2 / cycle.pitch), cycle.meshes).astype(np.int64)
    weight = np.bincount(mesh, weights=curve.weight, minlength=cycle.meshes)
    total = np.bincount(mesh, weights=curve.weight * curve.te, minlength=cycle.meshes)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(weight > 0.0, total / weight, np.nan))
