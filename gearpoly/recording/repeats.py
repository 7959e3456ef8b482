"""Readings that repeat the one before while the pair turns on: an encoder that is read less often than it is logged, a
frozen line, rows that were written twice, or counts that are coarser than the steps from sample to sample.

Derived here. A reading is true when it changes: then it was just read, or its count just passed. Until the next change
the other shaft runs on beside it, which makes a staircase: saw teeth in the transmission error as high as a shaft turns
meanwhile, 340 um at 0.8 deg. So the samples at which a reading changes are kept and the others left out. Where the two
shafts seldom change together, those count at which the coarser one changes; the finer one is then old by a few samples,
the same number at most places.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gearpoly.recording.deeds import Deed, note
from gearpoly.units import FloatArray, IntArray

TOGETHER_LEAST = 1.0 / 3.0
"""Share of the coarser shaft's changes at which the finer one has to change too for only those samples to be kept.
Shafts that are read every third and every fifth sample reach it, and so do two counters of about one count a sample.
"""


STANDING = 2.0
"""Longest repeat within the recording, in so many of which a repeat at its ends is a pair that stands still there."""


def new_readings(
    keep: IntArray, readings: Mapping[str, FloatArray | None], done: list[Deed]
) -> tuple[IntArray, IntArray]:
    """The samples (k,) among ``keep`` (m,) whose readings are new, and their numbers (k,) when repeats are not counted,
    so that only drop-outs leave gaps; what was left out is put into ``done``.

    ``readings`` (n,) by shaft, without drop-outs at ``keep``. A pair that stands still at either end of the recording
    repeats its readings rightly.
    """
    held = {shaft: values[keep] for shaft, values in readings.items() if values is not None and keep.size}
    moved = {shaft: np.concatenate([[True], values[1:] != values[:-1]]) for shaft, values in held.items()}
    if all(bool(one.all()) for one in moved.values()):
        return keep, keep
    coarse = min(moved, key=lambda shaft: np.count_nonzero(moved[shaft]), default="")
    turns = np.flatnonzero(moved[coarse][1:]) + 1 if moved else np.empty(0, dtype=np.int64)
    if turns.size < 2:
        return keep, keep
    longest = STANDING * float(np.max(np.diff(turns)))
    inside = slice(
        turns[0] if turns[0] > longest else 0, turns[-1] + 1 if keep.size - turns[-1] > longest else keep.size
    )
    stale = {shaft: int(np.count_nonzero(~one[inside])) for shaft, one in moved.items()}
    new = moved[coarse].copy()
    for one in moved.values():
        both = new & one
        if np.count_nonzero(both[inside]) >= TOGETHER_LEAST * np.count_nonzero(new[inside]):
            new = both
    new[: inside.start] = new[inside.stop :] = True
    for shaft, count in stale.items():
        says = f"{shaft} readings repeat the one before: read less often than logged, or coarser than the steps"
        note(done, f"{shaft} repeats", count, f"of {keep.size} {says}")
    note(done, "repeats", int(np.count_nonzero(~new)), "samples without a new reading left out")
    return keep[new], (keep - np.cumsum(~new))[new]
