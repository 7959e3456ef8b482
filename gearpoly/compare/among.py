"""Recordings of one set laid on one another: whole turns that no encoder counted, told by the teeth themselves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gearpoly.compare.curve import Cycle, RecordedCurve
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray, IntArray

LEAST_CORRELATION = 0.5
"""Least correlation of the two recordings, mesh by mesh, at the place taken."""

MORE_ALIKE_SIGMAS = 4.0
"""Standard errors by which the place taken must be more alike than any other."""

PERFECT = 1.0 - 1e-12
"""Correlation of a recording with itself, short of what has no transformation."""

LEAST_MESHES = 8
"""Least meshes from which a correlation means anything."""

COVERED = 0.5
"""Part of the hunting cycle's meshes that both recordings must hold."""

REPEATED_TURNS = 2
"""Turns from which on what a tooth of the shaft that turned wholly makes in the mean is known apart from its mates."""


ZEROED = 1e-3
"""Part of the scatter of a computed transmission error below which its mean was taken off by the rig."""


class Turns(NamedTuple):
    """Whole ``turns`` of the encoder's shaft by which one recording lies further on than another, modulo the hunting
    cycle: the most alike; ``clear``: more so than any other beyond chance."""

    turns: int
    clear: bool


def shared_counts(recordings: Sequence[Recording]) -> list[int]:
    """Numbers from 0 of the counts of turns that ``recordings`` go by: runs of one stretch of a file share theirs; -1
    where nobody shares it."""
    runs = [None if one.run is None else (one.run.file, one.run.stretch) for one in recordings]
    return [-1 if one is None else runs.index(one) for one in runs]


def means_compare(recordings: Sequence[Recording]) -> tuple[bool, ...]:
    """Whether the mean of each recording compares with those of the others of its set.

    Encoders keep their zeros. A transmission error that the rig computed keeps its own zero as well, unless the rig
    took the mean off, or began at nothing; it does not compare with readings of encoders. Runs of one stretch have one
    zero whatever it is.
    """
    runs = {(r.run.file, r.run.stretch) if r.run is not None else None for r in recordings}
    if len(runs) == 1 and None not in runs:
        return (True,) * len(recordings)
    computed = [r.computed for r in recordings]
    if not all(computed):
        return tuple(not one for one in computed)
    return (len(recordings) > 1 and not any(r.own_zero or _zeroed(r) for r in recordings),) * len(recordings)


def _zeroed(recording: Recording) -> bool:
    """Whether a computed transmission error was moved to a zero of its own: its mean or its first value is nothing."""
    te = recording.te_rad if recording.te_mm is None else recording.te_mm
    if te is None:
        return False
    known = te[np.isfinite(te)]
    return bool(known[0] == 0.0 or abs(float(np.mean(known))) < ZEROED * float(np.std(known)))


def counted_with(curves: Sequence[RecordedCurve], k: int) -> int | None:
    """An earlier one of the ``curves`` whose count of turns is that of number ``k``; None where there is none."""
    count = curves[k].count
    return next((j for j in range(k) if curves[j].count == count), None) if count >= 0 else None


def further_on(
    other: RecordedCurve, among: Sequence[tuple[IntArray, RecordedCurve]], cycle: Cycle, *, blind: bool
) -> IntArray | None:
    """Steps (size,) of the cycle that ``other`` lies further on, told by the recordings ``among`` which it lies, each
    with its own steps; None where none tells it clearly. ``blind``: nothing else tells, so the most alike will do, or
    else the angles as they read."""
    told = [(lies, turns) for lies, one in among if (turns := turns_between(one, other, cycle)) is not None]
    told.sort(key=lambda one: not one[1].clear)
    if told and (told[0][1].clear or blind):
        lies, turns = told[0]
        return lies + turns.turns * other.turn * cycle.per_mesh
    return among[0][0] if blind else None


def turns_between(first: RecordedCurve, other: RecordedCurve, cycle: Cycle) -> Turns | None:
    """How many turns of its encoder's shaft ``other`` lies further on than ``first``; None where they are alike
    nowhere. Both count from the same zero.

    After whole turns of one shaft its teeth are the same and the mate's are not. Means over each mesh know all teeth,
    also those that nobody inspected, and little of load, which changes all meshes alike. What teeth of that shaft make
    in the mean is the same wherever the other lies, and load changes it, so it is taken off. Means know nothing of the
    other flank, on which an eccentricity comes at another angle and teeth have other errors.
    """
    if first.template.flank != other.template.flank:
        return None
    one, two = _by_mesh(first, cycle), _by_mesh(other, cycle)
    if min(np.count_nonzero(np.isfinite(means)) for means in (one, two)) >= REPEATED_TURNS * other.turn:
        one, two = _of_the_mate(one, other.turn), _of_the_mate(two, other.turn)
    ways = cycle.meshes // math.gcd(other.turn, cycle.meshes)
    alike, count = np.full(ways, -1.0), np.zeros(ways)
    for n in range(ways):
        there = np.roll(two, -n * other.turn)
        both = np.isfinite(one) & np.isfinite(there)
        if np.count_nonzero(both) < max(COVERED * cycle.meshes, LEAST_MESHES):
            continue
        a, b = one[both] - one[both].mean(), there[both] - there[both].mean()
        size = math.sqrt(float(a @ a) * float(b @ b))
        alike[n], count[n] = float(a @ b) / size if size > 0.0 else -1.0, a.size
    order: list[int] = np.argsort(-alike, kind="stable").tolist()
    best, *others = order
    if alike[best] <= LEAST_CORRELATION:
        return None
    if not others:
        return Turns(best, clear=True)
    # Fisher (1921): the inverse hyperbolic tangent of a correlation is normal, its variance 1/(n - 3).
    sure, doubt = np.arctanh(np.clip(alike[[best, others[0]]], -PERFECT, PERFECT))
    return Turns(best, clear=float(sure - doubt) / math.sqrt(2.0 / (count[best] - 3.0)) > MORE_ALIKE_SIGMAS)


def _of_the_mate(means: FloatArray, turn: int) -> FloatArray:
    """The same (meshes,) without what each of the ``turn`` teeth of the shaft that turns wholly makes in the mean."""
    turns = means.reshape(-1, turn)
    seen = np.isfinite(turns)
    mean = np.where(seen, turns, 0.0).sum(axis=0) / np.maximum(np.count_nonzero(seen, axis=0), 1)
    return np.asarray((turns - mean).ravel())


def _by_mesh(curve: RecordedCurve, cycle: Cycle) -> FloatArray:
    """Mean transmission error (meshes,) in mm of every mesh of the hunting cycle; nan where none was recorded."""
    mesh = np.mod(np.floor(curve.theta_2 / cycle.pitch), cycle.meshes).astype(np.int64)
    weight = np.bincount(mesh, weights=curve.weight, minlength=cycle.meshes)
    total = np.bincount(mesh, weights=curve.weight * curve.te, minlength=cycle.meshes)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(weight > 0.0, total / weight, np.nan))
