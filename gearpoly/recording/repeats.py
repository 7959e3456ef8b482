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
from dataclasses import dataclass

import numpy as np

from gearpoly.recording.deeds import Deed, note
from gearpoly.recording.read_instants import instants_of, read_beside
from gearpoly.recording.unwrapping import without_turns
from gearpoly.units import ARCSEC, BoolArray, FloatArray, IntArray

TOGETHER_LEAST = 1.0 / 3.0
"""Share of the coarser shaft's changes at which the finer one has to change too for only those samples to be kept.
Shafts that are read every third and every fifth sample reach it, and so do two counters of about one count a sample.
"""


STANDING = 2.0
"""Longest repeat within the recording, in so many of which a repeat at its ends is a pair that stands still there."""

AT_REST, GOES_ON = 10.0, 3.0
"""Usual repeats in one, and usual steps by which every shaft goes on after it at most, where a pair stands still: one
that had turned on meanwhile would have gone ten steps. Left out, a stop of 7.4 s was taken for so long a turning, and
8855 um rms were told of 3.0. Judgements: of counts every third or fourth sample repeats differ by a third."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NewReadings:
    """The samples ``keep`` (k,) that are new, their ``number`` (k,) when repeats are not counted, so that only
    drop-outs leave gaps, the ``position`` (k,) at which they were read, and the ``readings`` (k,) in rad there by
    shaft; ``doubt`` is the rms in rad of those that lie between readings."""

    keep: IntArray
    number: IntArray
    position: FloatArray
    readings: dict[str, FloatArray]
    doubt: dict[str, float]


def new_readings(
    keep: IntArray, readings: Mapping[str, FloatArray | None], position: FloatArray, done: list[Deed]
) -> NewReadings:
    """The samples among ``keep`` (m,) whose readings are new; what was left out is put into ``done``.

    ``readings`` (n,) in rad by shaft, without drop-outs at ``keep``; ``position`` (m,) the time in s or the sample's
    number. A pair that stands still, at either end of the recording or in between, repeats its readings rightly.
    """
    held = {shaft: values[keep] for shaft, values in readings.items() if values is not None and keep.size}
    moved = {shaft: np.concatenate([[True], values[1:] != values[:-1]]) for shaft, values in held.items()}
    every = NewReadings(keep=keep, number=keep, position=position, readings=held, doubt={})
    if all(bool(one.all()) for one in moved.values()):
        return every
    coarse = min(moved, key=lambda shaft: np.count_nonzero(moved[shaft]), default="")
    turns = np.flatnonzero(moved[coarse][1:]) + 1 if moved else np.empty(0, dtype=np.int64)
    if turns.size < 2:
        return every
    rests = _at_rest(turns, held)
    runs = np.diff(turns)
    longest = STANDING * float(np.max(runs[~rests], initial=1.0))
    inside = slice(
        turns[0] if turns[0] > longest else 0, turns[-1] + 1 if keep.size - turns[-1] > longest else keep.size
    )
    still = np.zeros(keep.size, dtype=np.bool_)
    still[turns[0] : turns[-1]] = np.repeat(rests, runs)
    stale = {shaft: int(np.count_nonzero(~(one | still)[inside])) for shaft, one in moved.items()}
    if not any(stale.values()):
        return every
    for shaft, count in stale.items():
        says = f"{shaft} readings repeat the one before: read less often than logged, or coarser than the steps"
        note(done, f"{shaft} repeats", count, f"of {keep.size} {says}")
    new = moved[coarse].copy()
    for one in moved.values():
        both = new & one
        if np.count_nonzero(both[inside]) >= TOGETHER_LEAST * np.count_nonzero(new[inside]):
            new = both
    samples = keep.astype(np.float64)
    clock = position if np.all(np.diff(position) > 0.0) else samples
    doubt: dict[str, float] = {}
    beside = _put_beside(moved, held, coarse, clock, done)
    if beside is not None:
        new, instants, held, doubt = beside
        position = instants if clock is position else np.interp(instants, samples, position)
    new[: inside.start] = new[inside.stop :] = True
    new |= still
    note(done, "repeats", int(np.count_nonzero(~new)), "samples without a new reading left out")
    return NewReadings(
        keep=keep[new],
        number=(keep - np.cumsum(~new))[new],
        position=position[new],
        readings={shaft: values[new] for shaft, values in held.items()},
        doubt=doubt,
    )


def _put_beside(
    moved: Mapping[str, BoolArray], held: Mapping[str, FloatArray], coarse: str, position: FloatArray, done: list[Deed]
) -> tuple[BoolArray, FloatArray, dict[str, FloatArray], dict[str, float]] | None:
    """Which samples (m,) are new readings of the ``coarse`` shaft, the ``position`` (m,) with the instants at which
    these were taken, the readings (m,) with the other shaft's put at the same, and the doubt of these; none where both
    are new together, or one shaft alone was read."""
    if all(np.array_equal(one, moved[coarse]) for one in moved.values()):
        return None
    rows = {shaft: np.flatnonzero(one[1:]) + 1 for shaft, one in moved.items()}
    at = {shaft: instants_of(position[one], position[one - 1], held[shaft][one]) for shaft, one in rows.items()}
    together = np.count_nonzero(moved[coarse] & np.logical_and.reduce(list(moved.values())))
    in_step = all(np.array_equal(at[shaft], position[one]) for shaft, one in rows.items())
    if in_step and together >= TOGETHER_LEAST * rows[coarse].size:
        return None
    (other,) = moved.keys() - {coarse}
    beside = read_beside(at[other], held[other][rows[other]], at[coarse])
    known, samples = beside.known, rows[coarse][beside.known]
    new = np.zeros(position.size, dtype=np.bool_)
    new[samples] = True
    values, instants = held[other].copy(), position.copy()
    values[samples], instants[samples] = beside.reading[known], at[coarse][known]
    says = (
        f"{other} readings put at the instants of the {coarse} ones, between its own, to {beside.doubt / ARCSEC:.2g} "
    )
    note(done, "put beside", samples.size, f"{says}arcsec rms: the two shafts were not read at the same instants")
    return new, instants, {**held, other: values}, {other: beside.doubt}


def _at_rest(turns: IntArray, held: Mapping[str, FloatArray]) -> BoolArray:
    """Which of the repeats (k-1,) between the samples ``turns`` (k,) of a new reading are of a pair that stands still;
    ``held`` (m,) the readings in rad by shaft."""
    runs = np.diff(turns)
    rests: BoolArray = runs > AT_REST * np.median(runs)
    for values in held.values():
        step = np.abs(without_turns(values[turns[1:]] - values[turns[:-1]]))
        usual = np.median(step[step > 0.0]) if np.any(step > 0.0) else 0.0
        rests = rests & (step <= GOES_ON * usual)
    return rests
