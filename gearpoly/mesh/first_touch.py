"""The first touch of unloaded teeth as a smooth maximum over the near pairs, for fits that have to find which of them
touches."""

from __future__ import annotations

import numpy as np

from gearpoly.mesh.transmission import FlankContacts
from gearpoly.units import FloatArray

REACHED = 8.0
"""Widths within which other pairs are looked for: farther ones have less than exp(-8) of the weight of the first."""

FAINTEST_SHARE = 1e-3
"""Weight below which a pair counts as not touching: it would move nothing by more than this part."""


def smooth_first(rows: FlankContacts, *, width: float) -> tuple[FloatArray, FloatArray]:
    """Weight (k,) of each near pair in a smooth maximum of ``width`` mm over what each pair by itself would transmit,
    and by how much that maximum lies above the first touch (N,) in mm of transmission error.

    width log sum exp(x_i / width): as the width goes to 0, the first touch. Two pairs that touch at once share it.
    """
    share = np.exp(-np.maximum(rows.gap, 0.0) / width)
    whole = np.bincount(rows.position, weights=share, minlength=rows.theta_2.size)
    weight = share / whole[rows.position]
    sense = 1.0 if rows.flank == "drive" else -1.0
    return np.where(weight < FAINTEST_SHARE, 0.0, weight), sense * width * np.log(whole)
