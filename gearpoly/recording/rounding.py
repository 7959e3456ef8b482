"""The step to which an encoder's angle was rounded, read off its own readings: counts, or decimals of a file.

Derived here. Differences of rounded readings are whole multiples of one step. Where samples come evenly and no two
differences differ nothing tells a step, and none is told.
"""

from __future__ import annotations

import numpy as np

from gearpoly.units import FloatArray

DIFFERENCES_FOR_STEP = 20_000
"""Differences, the first ones, from which the step is read."""

STEP_LEAST_PART_OF_LARGEST = 0.3
"""Part of the largest distance between neighbouring differences from which a distance is one of steps, no scatter."""

WHOLE_STEPS_OFF = 0.05
"""Steps by which 99 of 100 differences may miss a whole number: decimals of a file beside the counts of an encoder."""

SEVERAL = 0.01
"""Part of the differences that has to be another multiple than the commonest one: single drop-outs tell no step."""


def reading_step(angle: FloatArray) -> float | None:
    """The step of which the continuous readings (n,) are multiples, in their unit, or ``None`` where none shows."""
    differences = np.diff(angle[: DIFFERENCES_FOR_STEP + 1])
    apart = np.diff(np.sort(differences))
    largest = float(np.max(apart, initial=0.0))
    if largest == 0.0:
        return None
    usual = float(np.median(apart[apart > STEP_LEAST_PART_OF_LARGEST * largest]))
    # The commonest distance may be of two or three steps, where samples are so even that others are rare.
    for step in sorted({largest, usual, usual / 2.0, usual / 3.0}, reverse=True):
        number = np.rint(differences / step)
        if not np.any(number) or np.quantile(np.abs(differences / step - number), 0.99) > WHOLE_STEPS_OFF:
            continue
        common = float(np.max(np.unique(number, return_counts=True)[1])) / number.size
        if common <= 1.0 - SEVERAL:
            return float(differences @ number) / float(number @ number)
    return None
