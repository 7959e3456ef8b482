"""What recordings state of themselves, held against their own numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from gearpoly.compare.beside import Aligned
from gearpoly.errors import InputFileError
from gearpoly.recording.clean import Cleaned
from gearpoly.units import RPM, FloatArray

OFF = 0.2
"""Part by which a stated speed may miss the one of the angles over their times: speeds are rounded, and wobble."""

LIKE = 0.1
"""The same within which the miss is taken for that of another unit."""

UNITS = ((math.pi / 180.0, "are the angles in rad?"), (1e-3, "are the times in ms?"), (60.0, "is the speed in Hz?"))
"""Speed by angles and times over the stated one, where a unit is mistaken."""


def refuse_twins(cleaned: Sequence[Cleaned]) -> None:
    """Refuse recordings of which one is another once more: whatever it shows would count twice.

    Raises ``InputFileError``.
    """
    for k, one in enumerate(cleaned):
        same = (o for o in cleaned[:k] if _alike(one.te, o.te) and _alike(one.theta_2, o.theta_2))
        twin = next(same, None)
        if twin is not None:
            found = f"the same samples as {twin.recording.source}"
            wish = "want every recording once, or what it shows counts twice"
            raise InputFileError(one.recording.source, found=found, wish=wish)


def _alike(one: FloatArray, other: FloatArray) -> bool:
    return one.size == other.size and np.array_equal(one, other)


def speed_remarks(aligned: Sequence[Aligned]) -> Iterator[str]:
    """Where a stated speed is not that of the angles over their times."""
    for k, one in enumerate(aligned):
        stated, time = one.cleaned.recording.speed_rpm, one.time_s
        if stated is None or time is None or time[-1] <= time[0]:
            continue
        turning = abs(float(one.theta_1[-1] - one.theta_1[0])) / float(time[-1] - time[0]) / RPM
        part = turning / stated
        if abs(part - 1.0) < OFF:
            continue
        hint = next((f": {asked}" for unit, asked in UNITS if abs(part / unit - 1.0) < LIKE), "")
        yield f"recording {k} states {stated:g} rpm, but turns at {turning:.3g} rpm by its angles and times{hint}"
