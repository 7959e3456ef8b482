"""Compiled loops of a study's inner pipeline; importing this imports numba."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.mesh.radial_search import compiled
from gearpoly.units import FloatArray

STOP = 1e-15
"""mm per mm of roll length at the tip: rounding of a roll length. Larger moves flanks by more than their own rounding,
smaller never ends."""

SEARCH_ROUNDS = 200
"""The search contracts by |d'|, a few um per mm, so that six rounds are usual; what needs more than these
folds over."""


@compiled
def roll_lengths(
    L: FloatArray,
    p: FloatArray,
    s: FloatArray,
    a: FloatArray,
    amount: float,
    l_relief: float,
    power: float,
    l_start: float,
    l_a: float,
) -> tuple[FloatArray, bool]:
    """Roll lengths l (z, n) in mm with l + d(l) = L for string lengths ``L`` (n,), and whether all were found.

    The deviation d of each tooth: ``p`` (z,) everywhere, ``s`` (z,) (u - 1/2), form sum over k of ``a`` (z, K)
    cos((k + 2) pi u), and relief of ``amount`` from ``l_relief`` on; u from 0 at ``l_start`` to 1 at ``l_a``. All mm.
    """
    z, n = p.size, L.size
    out = np.empty((z, n))
    scale = 1.0 / (l_a - l_start)
    stop = STOP * max(1.0, l_a)
    for t in range(z):
        d = p[t]
        for k in range(n):
            l = L[k] - d  # the neighbour's deviation is nearly this one's
            found = False
            for _ in range(SEARCH_ROUNDS):
                u = (l - l_start) * scale
                d = p[t] + s[t] * (u - 0.5)
                if amount != 0.0 and l > l_relief:
                    d -= amount * ((l - l_relief) / (l_a - l_relief)) ** power
                # cos of whole multiples by their recurrence: one cosine for all waves.
                c = math.cos(math.pi * min(max(u, 0.0), 1.0))
                before, wave = c, 2.0 * c * c - 1.0
                for q in range(a.shape[1]):
                    d += a[t, q] * wave
                    before, wave = wave, 2.0 * c * wave - before
                change = L[k] - d - l
                l += change
                if abs(change) <= stop:
                    found = True
                    break
            if not found:
                return out, False
            out[t, k] = l
    return out, True
