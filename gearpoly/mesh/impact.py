"""Time of impact on windows of few points: how far the turning body may turn until two faces touch, for many pairs at
once.

While the windows stand apart, their distance over the lever arm of the witness line says how far to turn; that lands
within the square of the gap. Once they overlap, a share of the bracket is given back. So it is bisection with a
better guess, as in conservative advancement. Windows can miss the first touch; ``certificate`` finds out.
"""

from __future__ import annotations

import numpy as np
import shapely

from gearpoly.mesh.bodies import REFINE, Jobs, Meeting, complex_points, lines
from gearpoly.units import IntArray

CONVERGED = 5e-14
"""rad. The guess is settled when its next step is below this: a fifth of the bracket, so that the bracket holds the
answer."""

SETTLED_COARSE = 1e-5
"""rad. Where the coarsest level stops: below the sagitta of its chords, so that stopping costs no aim; each finer
level stops REFINE^2 times earlier, as its sagittas do."""

FIRST_RETREAT = 1.0 / 1024.0
"""Share of the bracket given back after an overlap; four times more each time, up to one half (bisection). A
time-of-impact step overshoots by its square only, so a small share mostly clears it."""

IMPACT_STEPS = 60
"""Bisection or impact steps after which a search that has not settled is handed to the repair (or, there, given up)."""


def impact(
    m: Meeting,
    jobs: Jobs,
    windows: tuple[IntArray, IntArray],
    settled: float,
    *,
    opening: bool = False,
) -> None:
    """Turn every job to the first touch of its two windows, within ``settled`` rad; updates rotation and nearest
    vertices.

    Apart: turn by distance over lever arm. Overlapping: give back a share of the bracket, at last one half, or, where
    nothing was clear yet, retreat ever further. With ``opening``, pairs whose gap opens as they turn end at rotation
    inf.
    """
    mine = m.turning.points[jobs.turning[:, None], windows[0]]
    mates = m.fixed.points[jobs.fixed[:, None], windows[1]]
    faces = lines(mine)
    clear, hit = np.full(len(jobs), -np.inf), np.full(len(jobs), np.inf)
    retreat = np.full(len(jobs), FIRST_RETREAT)
    before = np.full(len(jobs), np.inf)
    ends = np.zeros((len(jobs), 2), dtype=np.complex128)
    live = np.arange(len(jobs))
    for _ in range(IMPACT_STEPS):
        rotation = jobs.rotation[live]
        seen = jobs.take(live).seen(m, mates[live], rotation)
        witness = complex_points(
            shapely.get_coordinates(shapely.shortest_line(faces[live], lines(seen))).reshape(-1, 2, 2)
        )
        gap = witness[:, 1] - witness[:, 0]
        distance = np.abs(gap)
        apart = distance > 0.0
        clear[live[apart]], hit[live[~apart]] = rotation[apart], rotation[~apart]
        ends[live[apart]] = witness[apart]
        moment = (witness[:, 0].conj() * gap).imag
        # Distance over the witness line's lever lands on the contact to second order. A line with hardly any lever
        # (rough flanks, or a pair that passes by) gets a step that is safe instead: no point moves faster than the
        # reach times the turn.
        step = distance / m.turning.reach
        np.divide(distance**2, moment, out=step, where=moment > m.turning.lever * distance)
        low, high = clear[live], hit[live]
        bracket = np.subtract(high, low, out=np.full(live.size, m.back_off), where=np.isfinite(low) & np.isfinite(high))
        share = np.minimum(retreat[live], np.where(np.isfinite(low), 0.5, np.inf))
        retreat[live] *= np.where(apart, 1.0, 4.0)
        # Behind its mate and falling back further: such a pair never closes.
        opens = opening & (moment <= 0.0) & (distance > before[live])
        before[live] = distance
        guess = np.where(apart & ~opens, rotation + step, np.inf)
        jobs.rotation[live] = np.where((guess < high) | np.isinf(high), guess, high - share * bracket)
        done = (apart & (step <= settled)) | (high - low <= settled) | ~(np.abs(jobs.rotation[live]) < m.lost)
        live = live[~done]
        if live.size == 0:
            break
    last_clear = np.where(np.isfinite(clear), clear, 0.0)
    rows = np.arange(len(jobs))
    seen = jobs.seen(m, mates, last_clear)
    jobs.at_turning = windows[0][rows, np.argmin(np.abs(mine - ends[:, :1]), axis=1)]
    jobs.at_fixed = windows[1][rows, np.argmin(np.abs(seen - ends[:, 1:]), axis=1)]


def coarse(m: Meeting, jobs: Jobs, *, near: float) -> Jobs:
    """First touch of the thinned working faces; drops pairs that turn apart, or close later than ``near`` (rad) after
    the first."""
    mine, mates = (np.broadcast_to(grid, (len(jobs), grid.size)) for grid in m.grids)
    impact(m, jobs, (mine, mates), SETTLED_COARSE, opening=True)
    rotation = np.where(np.abs(jobs.rotation) < m.lost, jobs.rotation, np.inf)
    first = np.full(int(jobs.pose.max(initial=-1)) + 1, np.inf)
    np.minimum.at(first, jobs.pose, rotation)
    # Thinned faces may touch late by their stand-off, one pair by all of it and its neighbour by nothing.
    late = 2.0 * m.coarse_stand_off
    jobs = jobs.take(np.isfinite(rotation) & (rotation <= first[jobs.pose] + near + late))
    jobs.rotation = jobs.rotation - late
    return jobs


def refine(m: Meeting, jobs: Jobs) -> None:
    """Touch again on ever finer windows around the last contact, down to every vertex."""
    for level, (mine, mates, stand_off) in enumerate(m.levels, start=1):
        last = level == len(m.levels)
        before = jobs.rotation
        jobs.rotation = before.copy()
        settled = CONVERGED if last else SETTLED_COARSE / REFINE ** (2 * level)
        impact(m, jobs, jobs.windows(m, (mine, mates)), settled)
        # A window that lost its contact leaves it to the next one, at last to the repair.
        jobs.rotation = np.where(np.abs(jobs.rotation) < m.lost, jobs.rotation, before)
        if not last:
            jobs.rotation = jobs.rotation - stand_off
