"""Certificates: every contact proven on whole faces, and solved again there where windows were wrong.

A half tooth is a solid, and the solid of the turning tooth must stand clear of its mate's whole face just before the
contact. Just after it, the two faces must cross. Both hold only if the first touch lies between.
"""

from __future__ import annotations

import numpy as np
import shapely

from gearpoly.errors import NotConvergedError
from gearpoly.mesh.bodies import ComplexArray, Jobs, Meeting, complex_points, lines
from gearpoly.mesh.impact import CONVERGED, IMPACT_STEPS, impact
from gearpoly.units import BoolArray, FloatArray

HALF_BRACKET = 2.5e-13
"""rad. Half the width of the certified bracket. Rounding of coordinates moves a contact by about 1e-15 rad, so a
smaller one would begin to fail for no geometric reason; a larger one would spoil the 1e-12 rad promised."""

AIMS = 8
"""How often an uncertified contact is aimed at again, where the whole faces overlap, before plain bisection takes
over. Smooth flanks need one, rough ones a few, since each aim finds an earlier peak."""

FIRST_BRACKET = 1e-6
"""rad. First reach of the search for a bracket around an uncertified answer; doubles up to the back-off."""

CLIP_PLACES = 24
"""Faces are clipped for certificates at so many places, so that jobs alike go through in one array."""

DEPTH_VERTICES = 64
"""Vertices looked at to find how far down the mate's face the turning body reaches."""

PEEK = 1e-8
"""rad. How far past a repaired touch its place is read off as the crossing of both faces: 0.2 nm deep, so 0.05 mm
wide at most."""


def certify(m: Meeting, jobs: Jobs) -> BoolArray:
    """Certify every contact on whole faces; solves again what fails. Returns which rows were repaired."""
    failed = uncertified(m, jobs)
    repaired = np.zeros(len(jobs), dtype=bool)
    for attempt in range(AIMS + 1):
        rows = np.flatnonzero(failed)
        if rows.size == 0:
            return repaired
        bad = jobs.take(rows)
        (_bisect if attempt == AIMS else _aim_again)(m, bad)
        jobs.rotation[rows], jobs.at_turning[rows], jobs.at_fixed[rows] = (
            bad.rotation,
            bad.at_turning,
            bad.at_fixed,
        )
        repaired[rows] = True
        failed[rows] = uncertified(m, bad)
    if np.any(failed):
        worst = int(np.argmax(failed))
        raise NotConvergedError(
            f"contact of turning tooth {jobs.turning[worst]} with fixed tooth {jobs.fixed[worst]} could not be "
            "certified; "
            "the outlines may cross themselves"
        )
    return repaired


def overlapping(m: Meeting, jobs: Jobs) -> BoolArray:
    """Which rows do not stand clear on whole faces at their rotation, so that they have touched before it."""
    return ~_clear(m, jobs, jobs.rotation)


def uncertified(m: Meeting, jobs: Jobs) -> BoolArray:
    """Which rows lack a certificate: clear on whole faces just before, crossing near the contact (hence somewhere)
    just after."""
    mine, mates = jobs.windows(m)
    faces = lines(m.turning.points[jobs.turning[:, None], mine])
    seen = jobs.seen(m, m.fixed.points[jobs.fixed[:, None], mates], jobs.rotation + HALF_BRACKET)
    cross: BoolArray = shapely.intersects(faces, lines(seen))
    return ~(cross & _clear(m, jobs, jobs.rotation - HALF_BRACKET))


def _crossings(m: Meeting, jobs: Jobs, rotation: FloatArray) -> ComplexArray:
    """Middle (jobs,) of the widest lens in which each pair of whole faces overlaps at ``rotation``; nan where they do
    not cross."""
    seen = jobs.seen(m, m.fixed.points[jobs.fixed], rotation)
    crossing = shapely.intersection(lines(m.turning.points[jobs.turning]), lines(seen))
    middle = np.full(len(jobs), np.nan + 0j)
    for row, shape in enumerate(crossing):
        points = complex_points(shapely.get_coordinates(shape))
        if points.size == 0:
            continue
        points = points[np.argsort(np.abs(points))]
        # The roots stand clear of each other, so lenses lie between the first and second crossing, the third and
        # fourth ...
        ends = points[1::2]
        starts = points[0::2][: max(1, ends.size)]
        widest = int(np.argmax(np.abs(ends - starts))) if ends.size else 0
        middle[row] = 0.5 * (starts[widest] + (ends[widest] if ends.size else starts[widest]))
    return middle


def _place_at(m: Meeting, jobs: Jobs, rotation: FloatArray) -> None:
    """Point both faces' windows at the place where they overlap at ``rotation``, where there is one."""
    middle = _crossings(m, jobs, rotation)[:, None]
    seen = jobs.seen(m, m.fixed.points[jobs.fixed], rotation)
    found = np.isfinite(middle[:, 0])
    mine, mates = (
        np.argmin(np.where(found[:, None], np.abs(points - middle), 0.0), axis=1)
        for points in (m.turning.points[jobs.turning], seen)
    )
    jobs.at_turning = np.where(found, mine, jobs.at_turning)
    jobs.at_fixed = np.where(found, mates, jobs.at_fixed)


def _aim_again(m: Meeting, jobs: Jobs) -> None:
    """Touch again where whole faces overlap just before the uncertified answer."""
    jobs.rotation = np.where(np.abs(jobs.rotation) < m.lost, jobs.rotation, 0.0)
    start = jobs.rotation - HALF_BRACKET
    _place_at(m, jobs, start)
    jobs.rotation = start.copy()
    impact(m, jobs, jobs.windows(m), CONVERGED)
    jobs.rotation = np.where(np.abs(jobs.rotation) < m.lost, jobs.rotation, start)


def _bisect(m: Meeting, jobs: Jobs) -> None:
    """First touch on whole faces by plain bisection; slow (a whole-face test per halving), for what windows cannot
    find."""
    low, high = jobs.rotation - HALF_BRACKET, jobs.rotation + HALF_BRACKET
    reach = FIRST_BRACKET
    for _ in range(IMPACT_STEPS):
        clear, cross = _clear(m, jobs, low), ~_clear(m, jobs, high)
        if np.all(clear & cross):
            break
        # Where the lower end is already in contact it is the new upper end; and the other way round.
        low, high = (
            np.where(clear, np.where(cross, low, high), low - reach),
            np.where(cross, np.where(clear, high, low), high + reach),
        )
        reach = min(2.0 * reach, m.back_off)
    for _ in range(IMPACT_STEPS):
        if np.max(high - low) <= HALF_BRACKET:
            break
        middle = 0.5 * (low + high)
        clear = _clear(m, jobs, middle)
        low, high = np.where(clear, middle, low), np.where(clear, high, middle)
    jobs.rotation = 0.5 * (low + high)
    _place_at(m, jobs, jobs.rotation + PEEK)


def _clear(m: Meeting, jobs: Jobs, rotation: FloatArray) -> BoolArray:
    """Whether each solid turning tooth stands clear of its mate's whole face at ``rotation`` (jobs,) in rad."""
    clear = np.zeros(len(jobs), dtype=bool)
    n = m.fixed.faces.shape[1]
    sample = np.arange(0, n, max(1, n // DEPTH_VERTICES))
    reached = np.abs(jobs.seen(m, m.fixed.points[jobs.fixed[:, None], sample], rotation)) <= m.turning.reach
    # Vertices beyond the turning body's reach cannot touch it. Leaving out those below the lowest reached sample,
    # less one, is exact.
    lowest = sample[np.maximum(0, np.argmax(reached, axis=1) - 1)]
    parts = lowest * CLIP_PLACES // n
    for part in np.unique(parts):
        rows = np.flatnonzero(parts == part)
        points = m.fixed.points[jobs.fixed[rows], part * n // CLIP_PLACES :]
        faces = lines(jobs.take(rows).seen(m, points, rotation[rows]))
        clear[rows] = ~shapely.intersects(m.turning.solids[jobs.turning[rows]], faces)
    return clear
