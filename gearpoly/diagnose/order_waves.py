"""Waves of whole orders of the shafts that are free beside what is asked of teeth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearpoly.physics.samples import Samples
from gearpoly.units import FloatArray

STRONGEST = 6
"""Waves that were located which are free so. One part of a drive makes one or two, an eccentricity under load its side
bands, an undulation one and its images; forms and damaged teeth make dozens. A judgement."""

Order = tuple[int, float]
"""A shaft (0 driving, 1 driven) and a whole order of it."""


def order_waves(samples: Sequence[Samples], orders: Sequence[Order]) -> list[FloatArray]:
    """Columns (n_k, 2 q f) of unit size of the waves of q ``orders`` in each recording, for each of f flanks its own: a
    cosine and a sine of the shaft's angle per order, the same in all recordings of a flank."""
    flanks = list(dict.fromkeys(one.flank for one in samples))
    out = []
    for one in samples:
        turned = [order * (one.theta_1, one.theta_2)[gear] for gear, order in orders]
        wide = np.zeros((one.size, len(flanks), 2 * len(orders)))
        for k, angle in enumerate(turned):
            wide[:, flanks.index(one.flank), 2 * k : 2 * k + 2] = np.column_stack((np.cos(angle), np.sin(angle)))
        out.append(wide.reshape(one.size, 2 * len(orders) * len(flanks)))
    return out
