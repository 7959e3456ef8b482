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

LEAST = 8
"""Least meshes from which a correlation means anything."""

COVERED = 0.5
"""Part of the hunting cycle's meshes that both recordings must hold."""


def turns_between(first: Curve, other: Curve, cycle: Cycle) -> int | None:
    """How many turns of its encoder's shaft, modulo the hunting cycle, ``other`` lies further on than ``first``; None
    where the recordings do not tell. Both count from the same zero.

    After whole turns of one shaft its teeth are the same and the mate's are not. Means over each mesh know all teeth,
    also those that nobody inspected, and little of load, which changes all meshes alike. They know nothing of the other
    flank, on which an eccentricity comes at another angle and teeth have other errors.
    """
    if first.template.flank != other.template.flank:
        return None
    one, two = _by_mesh(first, cycle), _by_mesh(other, cycle)
    ways = cycle.meshes // math.gcd(other.turn, cycle.meshes)
    alike, count = np.full(ways, -1.0), np.zeros(ways)
    for n in range(ways):
        there = np.roll(two, -n * other.turn)
        both = np.isfinite(one) & np.isfinite(there)
        if np.count_nonzero(both) < max(COVERED * cycle.meshes, LEAST):
            continue
        a, b = one[both] - one[both].mean(), there[both] - there[both].mean()
        size = math.sqrt(float(a @ a) * float(b @ b))
        alike[n], count[n] = float(a @ b) / size if size > 0.0 else -1.0, a.size
    order: list[int] = np.argsort(-alike, kind="stable").tolist()
    best, *others = order
    if alike[best] <= ALIKE:
        return None
    if not others:
        return best
    # Fisher (1921): the inverse hyperbolic tangent of a correlation is normal, its variance 1/(n - 3).
    sure, doubt = np.arctanh(np.clip(alike[[best, others[0]]], -PERFECT, PERFECT))
    told = float(sure - doubt) / math.sqrt(2.0 / (count[best] - 3.0)) > CLEARLY
    return best if told else None


def _by_mesh(curve: Curve, cycle: Cycle) -> FloatArray:
    """Mean transmission error (meshes,) in mm of every mesh of the hunting cycle; nan where none was recorded."""
    mesh = np.mod(np.floor(curve.theta_2 / cycle.pitch), cycle.meshes).astype(np.int64)
    weight = np.bincount(mesh, weights=curve.weight, minlength=cycle.meshes)
    total = np.bincount(mesh, weights=curve.weight * curve.te, minlength=cycle.meshes)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(weight > 0.0, total / weight, np.nan))
