"""Slow courses that bend more than a cubic: a rig that settles or creeps at first, and less and less after it."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import chdtrc

from gearpoly.compare.families import SHARES
from gearpoly.compare.model import JointModel, State
from gearpoly.compare.noise import Noise
from gearpoly.compare.peak import Peak
from gearpoly.compare.regression import Solution
from gearpoly.compare.slow import ALL_TERMS, FINE_TERMS, SLOW_CURVE_TERMS, course_curves, slow_curves
from gearpoly.units import FloatArray, IntArray

SLOW_LINES = 25
"""Turns of the record up to which the noise's wandering is read off for its power law."""

FITTED_STRETCHES = 4096
"""Stretches of the record whose sums stand for it there."""

MORE_LINES = 60
"""The same where curves that settle have taken a part of the slowest: from the fourth line on 25 tell the law to a
factor of 9 only, where a recording holds two hunting cycles."""

EXPONENTS, KNEES = np.linspace(0.0, 3.0, 9), np.geomspace(0.5, 100.0, 24)
"""Exponents of the power law that are tried, and turns of the record at which it comes down to the level of all faster
noise. A random walk has 2; a course as smooth as 4 is no noise that wanders, but a drift: with exponents up to 4 one of
2 um was not told, up to 2 two of 30 walks had a wave, up to 2.5 or 3 neither."""

A_WAVE = 3
"""Freedoms of a wave: cosine, sine and frequency."""

FEWEST_TURNS_FOR_SLOW_NOISE = 12
"""Turns of the slower shaft from which on it is asked: of fewer, what falls within a seventh of them looks like a part
of what comes once per turn. A judgement."""


def follow_courses(search: JointModel, solution: Solution) -> tuple[Solution, bool]:
    """Everything fitted again with what settles for the recordings whose slow course a cubic does not follow, and
    whether there is one. What settles within an eighth of a recording left 9 times the noise on a cubic, and nothing
    beside it had a name."""
    bent = [k for k in range(len(search.states)) if _bends(search, solution, k)]
    if not bent:
        return solution, False
    for k in bent:
        s, left = search.states[k], solution.left[k]
        s.slow = course_curves(_along(s), ALL_TERMS)
        # So slow a wave was a part of the course, and beside these curves it has no size.
        s.orders = [one for one in s.orders if not _slow(s, one)]
        s.times = [one for one in s.times if not _slow(s, one)]
        # Noise that was known with the course in it wanders, and would let the course stay there.
        s.noise = s.estimator.estimate(left - s.slow @ np.linalg.lstsq(s.slow, left, rcond=None)[0])
    solution = search.fit(passes=1)
    search.renew_noise(solution)
    return search.fit(passes=1), True


def _bends(search: JointModel, solution: Solution, k: int) -> bool:
    """Whether what is left of recording ``k`` holds slow polynomials beyond a cubic that its noise does not foretell:
    that is a power law through the lines which are faster than all of these. What wanders has it too, and no more
    slowly than the law says; what settles is smooth and has nothing there. Where slow waves were found, the curves have
    to explain the recording better than these, each freedom paid for (Schwarz 1978): two waves and a cubic stood in for
    10 um that settled."""
    s = search.states[k]
    known = s.slow.shape[1]
    u = s.data.u
    if s.jumps or known == ALL_TERMS or float(np.ptp(u)) < FEWEST_TURNS_FOR_SLOW_NOISE * max(search.z_1, search.z_2):
        return False
    x = _along(s)
    curves, left = course_curves(x, ALL_TERMS), solution.left[k]
    waves = _of_slow_waves(s, solution.beta, search.places[k])
    if waves:
        whole = left + s.slow @ solution.beta[search.places[k]["slow"]] + np.sum(waves, axis=0)
        if not _better(s.noise, curves, whole, left, freedoms=ALL_TERMS - known - A_WAVE * len(waves)):
            return False
        left = whole
    course = curves @ np.linalg.lstsq(curves, left, rcond=None)[0]
    degree = np.arange(known, FINE_TERMS)
    at = np.asarray(0.5 * degree, dtype=np.float64)
    level, doubt = slow_noise(x, left - course, at=at, skip=s.noise.cycles, beside=ALL_TERMS)
    ratio = of_degrees(x, course)[known:] ** 2 * u.size / (2.0 * degree + 1.0)
    return float(np.min(chances(ratio, level, doubt))) * degree.size * len(search.states) < SHARES.drift


def _along(s: State) -> FloatArray:
    """What a course goes over (n,), the way it was recorded: a rig settles at the beginning of a run back as well."""
    x = s.data.u if s.data.time_s is None else s.data.time_s
    return -x if s.data.backward else x


def _slow(s: State, wave: Peak) -> bool:
    return wave.frequency * s.sampling.over(wave.domain)[2] < 0.5 * FINE_TERMS


def _better(noise: Noise, curves: FloatArray, whole: FloatArray, left: FloatArray, *, freedoms: int) -> bool:
    """Whether ``curves`` (n, q) explain the ``whole`` (n,) better than what leaves ``left`` (n,), so many more freedoms
    paid for."""
    white, columns = noise.whitened(whole), noise.whitened(curves)
    course = columns @ np.linalg.lstsq(columns, white, rcond=None)[0]
    gain = float(np.sum(noise.whitened(left) ** 2) - np.sum((white - course) ** 2))
    return gain > freedoms * math.log(left.size)


def _of_slow_waves(s: State, beta: FloatArray, places: dict[str, IntArray]) -> list[FloatArray]:
    """What each wave as slow as the curves adds (n,) to a recording."""
    out = []
    for name, x, peaks in (("orders", s.data.u, s.orders), ("times", s.data.time_s, s.times)):
        for j, peak in enumerate(peaks):
            if _slow(s, peak) and x is not None:
                angle = 2.0 * math.pi * peak.frequency * x
                cosine, sine = beta[places[name][2 * j : 2 * j + 2]]
                out.append(cosine * np.cos(angle) + sine * np.sin(angle))
    return out


def of_degrees(x: FloatArray, course: FloatArray) -> FloatArray:
    """Amplitudes of the polynomials (``FINE_TERMS``,) that make up a slow ``course`` (n,) over ``x``."""
    return np.asarray(np.linalg.lstsq(slow_curves(x, FINE_TERMS), course, rcond=None)[0])


def chances(power: FloatArray, level: FloatArray, doubt: FloatArray, *, freedoms: int = 1) -> FloatArray:
    """Chance (k,) that noise raises a ``power`` (k,) in mm^2 per sample or more, of ``freedoms`` (chi-square); the
    log of the noise is ``level`` (k,) with a normal ``doubt`` (k,), over which it is averaged (Gauss and Hermite)."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(24)
    each = power[:, None] / np.exp(level[:, None] + doubt[:, None] * nodes[None, :])
    return np.asarray(np.asarray(chdtrc(freedoms, each)) @ (weights / np.sum(weights)))


def slow_noise(
    x: FloatArray, left: FloatArray, *, at: FloatArray, skip: int, beside: int
) -> tuple[FloatArray, FloatArray]:
    """Noise at ``at`` (k,) turns of the record, in mm^2 per sample: mean and standard error of its log.

    A power law and a level through the slow lines of ``left`` (n,) over ``x``, drawn on to where no line is; every
    ``skip``-th line repeats with the pair and is left out, and so are the first ones where it was left ``beside`` more
    curves than a cubic's. What wanders rises, so the law never falls towards zero. Every law of a grid counts by its
    likelihood (Whittle 1953), its size by the mean of the lines over it.
    """
    first, last = (2, SLOW_LINES) if beside <= SLOW_CURVE_TERMS else (4, MORE_LINES)
    # Means over short stretches change lines of a few dozen turns by nothing and cost nothing.
    stretch = np.minimum(((x - x[0]) / (x[-1] - x[0]) * FITTED_STRETCHES).astype(np.int64), FITTED_STRETCHES - 1)
    total = np.bincount(stretch, weights=left, minlength=FITTED_STRETCHES)
    turns = np.array([k for k in range(first, last) if skip == 0 or k % skip], dtype=np.float64)
    angle = 2.0 * np.pi * np.outer(turns, (np.arange(FITTED_STRETCHES) + 0.5) / FITTED_STRETCHES)
    power = np.maximum(np.abs(np.exp(-1j * angle) @ total) ** 2 / x.size, 1e-300)
    exponent, knee = (axis.ravel()[:, None] for axis in np.meshgrid(EXPONENTS, KNEES))
    shape, there = ((knee / one) ** exponent + 1.0 for one in (turns, at))
    size = np.mean(power / shape, axis=1)
    log = -np.sum(np.log(shape), axis=1) - turns.size * np.log(size)
    weight = np.exp(log - np.max(log))
    weight /= np.sum(weight)
    level = np.log(size[:, None] * there)
    mean = weight @ level
    return mean, np.sqrt(weight @ (level - mean) ** 2 + 1.0 / turns.size)
