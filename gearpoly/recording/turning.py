"""How a shaft turns, as its readings have it: turns, wraps, stops, reversals, repeats and spikes over all samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearpoly.recording.repeats import new_readings
from gearpoly.recording.reversals import reversals
from gearpoly.recording.spikes import single_spikes
from gearpoly.recording.steady import STANDS_SHARE
from gearpoly.recording.unwrapping import STEPS_FOR_USUAL_STEP, continuous
from gearpoly.units import DEG, FloatArray, IntArray

STAND_SAMPLES = 12
"""Least samples of a stop: an encoder that is read slowly repeats its value for fewer."""

FEWEST_SAMPLES_FOR_TURNS = 8
"""Samples below which nothing is said of rates and turns."""


@dataclass(frozen=True, kw_only=True)
class Turning:
    """How a shaft turns: ``turns`` from the lowest to the highest angle, ``wraps``, and the ``modulus`` in the file's
    own unit where readings begin again; ``stops`` as rows (first, last), ``reversals`` as rows, ``repeats`` of the
    reading before and single ``spikes`` as counts."""

    turns: float
    wraps: int
    modulus: float | None
    stops: tuple[tuple[int, int], ...]
    reversals: tuple[int, ...]
    repeats: int
    spikes: int


@np.errstate(over="ignore", invalid="ignore")  # a damaged file may hold anything
def turning_of(degrees: FloatArray, values: FloatArray, time: FloatArray | None) -> Turning | None:
    """How a shaft with readings (n,) in deg, which are ``values`` in the file, turns."""
    rows = np.flatnonzero(np.isfinite(degrees) & (np.isfinite(time) if time is not None else True))
    if rows.size < FEWEST_SAMPLES_FOR_TURNS:
        return None
    if rows.size < degrees.size:  # else there is nothing to leave out, and millions of numbers to copy
        degrees, values, time = degrees[rows], values[rows], time if time is None else time[rows]
    position = time if time is not None and not np.any(time[1:] < time[:-1]) else rows.astype(np.float64)
    one = continuous(degrees * DEG, position, rows)
    angle = one.angle
    spikes = single_spikes(angle, moving=True)
    held = np.flatnonzero(~spikes) if spikes.any() else None  # without spikes their numbers would be those of all
    plain = angle if held is None else angle[held]
    repeats = 0
    if np.any(degrees[1:] == degrees[:-1]):
        repeats = rows.size - new_readings(np.arange(rows.size), {"shaft": degrees}, position, []).keep.size
    around = np.flatnonzero(one.wraps)
    jumps, steps = np.abs(values[around + 1] - values[around]), np.abs(np.diff(values[: STEPS_FOR_USUAL_STEP + 1]))
    return Turning(
        turns=float(np.ptp(plain)) / (360.0 * DEG),
        wraps=around.size,
        modulus=float(np.median(jumps) + np.median(steps)) if around.size else None,
        stops=_stops(angle, rows),
        reversals=tuple(int(rows[k if held is None else held[k]]) + 1 for k in reversals(plain)),
        repeats=repeats,
        spikes=int(rows.size - plain.size),
    )


def _stops(angle: FloatArray, rows: IntArray) -> tuple[tuple[int, int], ...]:
    """Rows (first, last) between which a shaft stands: below a fiftieth of its usual speed."""
    moves = angle[1:] != angle[:-1]
    count = int(np.count_nonzero(moves))
    if not count:
        return ((int(rows[0]) + 1, int(rows[-1]) + 1),)
    # Samples between two new readings: an encoder that is read slowly does not stand still.
    hold = angle.size / count
    window = max(STAND_SAMPLES, round(3.0 * hold))
    if angle.size <= window:
        return ()
    every = max(1, count // STEPS_FOR_USUAL_STEP)
    some = np.flatnonzero(moves)[::every] if count < moves.size else np.arange(0, count, every)
    usual = float(np.median(np.abs(angle[some + 1] - angle[some]))) / hold
    if np.all(np.abs(angle[window:] - angle[:-window]) >= STANDS_SHARE * usual * window):
        return ()  # the commonest case: every window has more way from end to end
    from scipy.ndimage import maximum_filter1d, minimum_filter1d  # which takes longer to import than to run

    # The reach, not the way from end to end, which is nothing where a shaft turns round.
    size, middle = window + 1, slice((window + 1) // 2, angle.size - window + (window + 1) // 2)
    reach = (maximum_filter1d(angle, size) - minimum_filter1d(angle, size))[middle]
    still = reach < STANDS_SHARE * usual * window
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still.astype(np.int8), [0]])))
    return tuple(
        (int(rows[a]) + 1, int(rows[b - 1 + window]) + 1) for a, b in zip(edges[::2], edges[1::2], strict=True)
    )
