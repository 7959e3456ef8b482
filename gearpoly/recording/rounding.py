"""The step to which an encoder's angle was rounded, read off its own readings: counts, or decimals of a file.

Derived here. Differences of rounded readings are whole multiples of one step. Where samples come evenly and no two
differences differ nothing tells a step, and none is told.
"""

from __future__ import annotations

import numpy as np

from gearpoly.units import FloatArray

DIFFERENCES_FOR_STEP = 20_000
"""Differences, the first ones, from which the step is read."""

ANOTHER_DISTANCE_PART = 0.9
"""Part of one distance between neighbouring differences below which the next is another: distances are of one step, of
two, of three, beside what the decimals of a file leave of each. One of ten steps and one of nine are two; it decides
nothing but how many are tried."""

DIFFERENCES_TRIED_FIRST = 500
"""Differences, of all that differ, by which a step is tried before all are asked: most fail there. It decides nothing
but speed."""

ROUNDED_TO_53_BITS = 100.0 * float(np.finfo(np.float64).eps)
"""Part of an angle below which differences are of its own rounding to 53 bits."""

WHOLE_STEPS_OFF = 0.05
"""Steps by which 99 of 100 differences may miss a whole number: decimals of a file beside the counts of an encoder."""

SEVERAL = 0.01
"""Part of the differences that has to be another multiple than the commonest one: single drop-outs tell no step."""


def reading_step(angle: FloatArray) -> float | None:
    """The step of which the continuous readings (n,) are multiples, in their unit, or ``None`` where none shows."""
    differences = np.diff(angle[: DIFFERENCES_FOR_STEP + 1])
    unlike = np.unique(differences)
    glance = unlike[:: max(1, unlike.size // DIFFERENCES_TRIED_FIRST)]
    # A stop leaves a gap to all that moves, and few counts stand next to each other where speeds differ.
    distances = _unlike(np.diff(unlike), least=ROUNDED_TO_53_BITS * float(np.max(np.abs(angle), initial=0.0)))
    # The commonest distance may be of two or three steps, where samples are so even that others are rare.
    parts = sorted((one / many for one in distances for many in (2, 3)), reverse=True)
    for step in (*distances, *parts):
        if not _are_whole(glance, step) or not _are_whole(differences, step):
            continue
        number = np.rint(differences / step)
        common = float(np.max(np.unique(number, return_counts=True)[1])) / number.size
        if np.any(number) and common <= 1.0 - SEVERAL:
            return float(differences @ number) / float(number @ number)
    return None


def _unlike(distances: FloatArray, *, least: float) -> list[float]:
    """The largest of ``distances`` (n,), and each that is another than the one before, falling to the ``least``."""
    out: list[float] = []
    falling = np.sort(distances[distances > least])[::-1]
    while falling.size:
        out.append(float(falling[0]))
        falling = falling[falling <= ANOTHER_DISTANCE_PART * falling[0]]
    return out


def _are_whole(values: FloatArray, step: float) -> bool:
    """Whether nearly all ``values`` (n,) are whole multiples of a ``step``."""
    number = values / step
    return bool(np.quantile(np.abs(number - np.rint(number)), 0.99) <= WHOLE_STEPS_OFF)
