"""Where a recording's encoders stand on the teeth: zeros and tooth numberings, found from the curves themselves.

A pair repeats itself after one hunting cycle and never before, so the simulated curve over a whole cycle, laid against
the recorded one, fits at one place only, wherever inspected pitch, eccentricity or the shape of the mesh leave a mark.
All places are tried at once by circular correlation; the best are refined below the grid, and what fits almost as well
stays as a rival. All recordings of a set share one place, up to whole turns that their encoders did not count; the mean
transmission error tells those.

Teeth that nobody inspected deviate alike in every turn, however many samples see it. So teeth are told from one another
by how much teeth may deviate, and only the place within a pitch by every sample.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.among import counted_with, further_on
from gearpoly.compare.curve import MESH_ORDERS_IN_DOUBT, Cycle, Misfit, RecordedCurve, folded, without_ramp
from gearpoly.compare.place import Attempt, Laying, are_apart, is_worse
from gearpoly.units import UM, BoolArray, FloatArray, IntArray

CANDIDATES = 12
"""Places that are refined, at least half a pitch apart; the grid ranks them well enough that the best is among the
first few."""

PLACES_BESIDE_STATED = 4
"""Places that are refined whatever is stated: they show whether the curves alone would have found the teeth."""

COARSE_PLACES = 40_000
"""Places of the hunting cycle while candidates are compared; the final fit sees up to ``curve.FOLDED``."""

SLACK = 0.6
"""Tooth pitches by which a stated zero may be wrong; the contract's half, and a tenth for eccentricity in the mean."""

STATED = 0.25
"""Tooth pitches, one sigma, by which a stated zero is wrong."""

PHASED = 0.1
"""Pitches. A zero known worse than this is not told from the data: evenly spread over a pitch would be 0.29."""

DIPS = 16
"""Places within a pitch from which the best is refined; dips are a tenth of a pitch wide, as corners are."""

TOLD_CHI2 = 1.0
"""Sigmas squared by which some turns must fit worse than others for the simulation to tell them."""

WARY = 12
"""Mesh orders in doubt where the standard error is asked for. Corners place the teeth, and where laws of compliance put
them differs by as much as these orders can tell."""

STRETCHES_PER_MESH = 32
"""Of a mesh, within each of which the simulation misses the mean tooth alike: half a wave of what ``WARY`` leaves."""

PROBES = (-0.25, 0.25, 0.5)
"""Pitches beside the place found at which the curves must fit worse; the standard error only knows how sharp the
place itself is."""

TURNS_SIGMAS = 2.5
"""Standard errors by which those must fit worse: they are few, and not chosen by their fit."""

SIGMAS_PER_PITCH = 5.0
"""Standard errors of a turn that a pitch has to hold for the tooth to be told: half a tooth is then 2.5 of them."""

GAUGE_STD_MM = 0.2 * UM
"""mm. No tooth is known better, whatever its file says: the uncertainty of a good gauge."""

LEAST_MISFIT = 0.02 * UM
"""mm. Misfit is never taken to be less than what the template itself misses; a perfect curve would have no scale."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Laid:
    """The place found, with its doubt and rivals.

    ``std`` in rad of ``best.shift``, inf where the curves say nothing; ``offset_std`` in mm of ``best.offset``.
    ``spread`` (driving, driven) in rad is how far the turns of both shafts scatter over all places by how likely each
    is, given what is stated. ``rivals`` fit nearly as well, best first; ``contradicted`` is a place that fits much
    better but lies outside what the stated zeros allow. ``phased``: the place within a pitch comes from the data;
    ``numbered``: so does the tooth, given what is stated, and ``certain``: without anything stated.
    """

    best: Laying
    std: float
    offset_std: float
    spread: tuple[float, float]
    rivals: tuple[Laying, ...]
    contradicted: Laying | None
    phased: bool
    numbered: bool
    certain: bool


@dataclass(frozen=True, kw_only=True)
class StatedZeros:
    """Whether the present zeros of the driving and the driven shaft are right to half a tooth."""

    driving: bool
    driven: bool


def lay(curves: tuple[RecordedCurve, ...], cycle: Cycle, *, stated: StatedZeros) -> Laid:
    """Find the place of a set of recordings on the hunting cycle of their pair.

    All curves go by the same zeros of both shafts, which are right to half a tooth where ``stated`` says so.
    """
    flat = [_level(curve) for curve in curves]
    coarse = tuple(folded(curve, cycle, places=COARSE_PLACES) for curve in flat)
    apart = _turns_apart(coarse, cycle)
    left = [_left(curve, cycle) for curve in coarse]
    # Which tooth is which is asked of the teeth, not of their samples.
    fits = [_misfit(curve, cycle, of_teeth) for curve, (_, of_teeth) in zip(coarse, left, strict=True)]
    total, turns = _total(fits, cycle, apart)
    allowed = _allowed(fits[0], cycle, stated)
    within = _peaks(np.where(allowed, total, np.inf), cycle)
    anywhere = _peaks(total, cycle, most=PLACES_BESIDE_STATED)
    starts = np.unique(np.concatenate((within, _beside(within[:1], allowed, cycle), anywhere)))
    further = turns.astype(np.float64) * cycle.step
    tries = [Attempt.make(fits, cycle, h * cycle.step, further[:, h]) for h in starts.tolist()]

    def off(one: Attempt) -> float:
        return _off(one, fits[0], cycle, stated)

    best, rivals = _chosen(tries, cycle, off)
    fine = [_misfit(folded(curve, cycle), cycle, of_samples) for curve, (of_samples, _) in zip(flat, left, strict=True)]
    wary = [_misfit(fit.curve, cycle, of_samples, WARY) for fit, (of_samples, _) in zip(fits, left, strict=True)]
    final = _within(fine, cycle, best, off)
    std, offset_std, phased = _phase(final, wary)
    if phased:
        # Teeth are told from one another at the place within the pitch that the mean tooth has told.
        tries = [one.moved(math.remainder(final.shift - one.shift, cycle.pitch)) for one in tries]
        best, rivals = _chosen(tries, cycle, off)
        if are_apart(best, final, cycle):
            final = _within(fine, cycle, best, off)
    outside = min(tries, key=lambda one: one.misfit)
    others = [one for one in tries if are_apart(one, best, cycle)]
    certain = not are_apart(outside, best, cycle) and all(is_worse(one, best, cycle) for one in others)
    contradicted = are_apart(outside, best, cycle) and is_worse(best, outside, cycle)
    spread = _spread(np.where(allowed, total, np.inf) / len(fits), cycle, best.shift)
    pitches = cycle.pitch / cycle.ratio, cycle.pitch
    sharp = phased or all(turn < pitch / SIGMAS_PER_PITCH for turn, pitch in zip(spread, pitches, strict=True))
    return Laid(
        best=(final if phased else best).place(),
        std=std,
        offset_std=offset_std,
        spread=spread,
        rivals=tuple(one.place() for one in rivals),
        contradicted=outside.place() if contradicted else None,
        phased=phased,
        numbered=sharp and not rivals,
        certain=sharp and certain,
    )


def _chosen(tries: list[Attempt], cycle: Cycle, off: Callable[[Attempt], float]) -> tuple[Attempt, list[Attempt]]:
    """The likeliest place, and what fits nearly as well, best first; ``off`` is how far one lies from the stated zeros,
    in pitches."""
    ordered = sorted(tries, key=lambda one: one.misfit)
    mine = [one for one in ordered if off(one) <= SLACK + 2.0 / cycle.per_mesh] or ordered
    level = mine[:1]
    for one in mine[1:]:
        if all(are_apart(one, other, cycle) for other in level) and not is_worse(one, level[0], cycle):
            level.append(one)
    # Where the curves hardly choose, the stated zeros do.
    best = min(level, key=lambda one: one.misfit / len(one.fits) + (off(one) / STATED) ** 2)
    return best, [one for one in level if one is not best]


def _level(curve: RecordedCurve) -> RecordedCurve:
    """The curve without its ramp: what goes on for the whole recording cannot be folded."""
    te, _ = without_ramp(curve.theta_2, curve.te)
    return replace(curve, te=te)


def _misfit(curve: RecordedCurve, cycle: Cycle, sigma: float, mesh_orders: int = MESH_ORDERS_IN_DOUBT) -> Misfit:
    in_time = bool(np.all(curve.weight == 1.0))
    return Misfit(curve, cycle, sigma=sigma, in_time=in_time, mesh_orders=mesh_orders)


def _left(curve: RecordedCurve, cycle: Cycle) -> tuple[float, float]:
    """What the best place on the grid leaves of a curve in mm: rms by samples, and by teeth.

    Teeth that nobody inspected leave the same in every turn, and a thousand samples of one tooth are one. So the
    second is the variance of sums over a tooth, of both gears, per sample in them.
    """
    fit = _misfit(curve, cycle, LEAST_MISFIT)
    misfit = fit.over_all_shifts()
    best = int(np.argmin(misfit))
    of_samples = max(float(misfit[best]) / fit.count, LEAST_MISFIT**2)
    r = fit.residual(best * cycle.step)
    left = curve.weight * (r - fit.drawn(fit.explained(r)))
    _, *teeth = fit.labels(best * cycle.step)
    sums = sum(float(np.sum(np.bincount(tooth, weights=left) ** 2)) for tooth in teeth)
    of_teeth = max(sums / fit.count - of_samples, of_samples, GAUGE_STD_MM**2 * fit.count / (cycle.z_1 + cycle.z_2))
    return math.sqrt(of_samples), math.sqrt(of_teeth)


def _within(fits: list[Misfit], cycle: Cycle, best: Attempt, off: Callable[[Attempt], float]) -> Attempt:
    """The place that fits best within half a pitch of ``best``, by ``fits`` that take every sample for its own: what
    the mean tooth looks like is seen by all of them. It lies no farther ``off`` the stated zeros than those may be."""
    here = Attempt.make(fits, cycle, best.shift, best.turns)
    beside = [here.moved(n * cycle.pitch / DIPS) for n in range(-DIPS // 2, DIPS // 2)]
    dip = min((here, *(one for one in beside if off(one) <= SLACK)), key=lambda one: one.misfit)
    return Attempt.make(fits, cycle, dip.shift, dip.turns).polished()


def _phase(one: Attempt, wary: list[Misfit]) -> tuple[float, float, bool]:
    """Standard errors of the place within a pitch (rad) and of the mean (mm), and whether the curves tell that place;
    ``wary`` are the misfits by which the errors are judged."""
    doubted = replace(one, fits=wary)
    scattered, offset_std = doubted.errors()
    std = math.hypot(scattered, _common(doubted))
    told = std < PHASED * one.cycle.pitch and all(
        is_worse(one.moved(part * one.cycle.pitch), one, one.cycle, sigmas=TURNS_SIGMAS) for part in PROBES
    )
    return std, offset_std, told


def _common(one: Attempt) -> float:
    """Standard error of the shift in rad that no number of teeth averages out: what the simulation lacks of the mean
    tooth, independent from stretch to stretch of the mesh, beyond twice what scattered meshes would sum up to."""
    curvature, places = 0.0, one.cycle.meshes * STRETCHES_PER_MESH
    cells = np.zeros(places)
    for fit, more in zip(one.fits, one.turns.tolist(), strict=True):
        r, t = fit.residual(one.shift + more), fit.slope(one.shift + more)
        left, rest = (x - fit.drawn(fit.explained(x)) for x in (r, t))
        score = fit.curve.weight * rest / fit.sigma**2
        curvature += float(score @ t)
        place = np.floor((fit.curve.theta_2 - one.shift - more) * (STRETCHES_PER_MESH / one.cycle.pitch))
        cells += np.bincount(np.mod(place, places).astype(np.int64), score * left, places)
    stretches = cells.reshape(-1, STRETCHES_PER_MESH).sum(axis=0)
    spread = max(float(stretches @ stretches - 2.0 * (cells @ cells)), 0.0)
    return math.sqrt(spread) / curvature if curvature > 0.0 else math.inf


def _spread(misfit: FloatArray, cycle: Cycle, best: float) -> tuple[float, float]:
    """How far the turns of the driving and the driven shaft scatter about ``best`` in rad, rms in rad, over places that
    are as likely as their ``misfit`` (size,) in sigmas squared says."""
    likely = np.exp(-0.5 * (misfit - np.min(misfit)))
    off = np.arange(cycle.size) * cycle.step - best
    out = []
    for angle in (off / cycle.ratio, off):
        apart = np.remainder(angle + math.pi, 2.0 * math.pi) - math.pi
        out.append(math.sqrt(float(likely @ apart**2) / float(np.sum(likely))))
    return out[0], out[1]


def _turns_apart(curves: tuple[RecordedCurve, ...], cycle: Cycle) -> IntArray:
    """Whole driven turns (recordings,) by which each recording's count differs from the first counted one's, modulo the
    cycle; -1 where its transmission error does not tell.

    All recordings share their zeros, so mean TE differs by deflection and lost motion only, far less than half a
    pitch. What is more is i driven and j driving turns that the encoders did not count: i z_2 - j z_1 pitches (derived
    here).
    """
    g = math.gcd(cycle.z_1, cycle.z_2)
    period = cycle.z_1 // g
    inverse = pow(cycle.z_2 // g, -1, period) if period > 1 else 0
    out = np.full(len(curves), -1, dtype=np.int64)
    base: float | None = None
    for k, curve in enumerate(curves):
        if curve.counted:
            mean = float(np.average(curve.te, weights=curve.weight)) - curve.template.mean
            base = mean if base is None else base
            out[k] = (round((mean - base) / (g * cycle.pitch * cycle.r_b2)) * inverse) % period
    return out


def _total(fits: list[Misfit], cycle: Cycle, apart: IntArray) -> tuple[FloatArray, IntArray]:
    """Misfit (size,) of the whole set over shifts of the first recording, in sigmas squared, and the places
    (recordings, size) that each recording then lies further on."""
    index = np.arange(cycle.size)
    total = np.zeros(cycle.size)
    turns = np.zeros((len(fits), cycle.size), dtype=np.int64)
    # The first curve is where shifts count from; the first counted one is where turns count from.
    origin = next((k for k, turn in enumerate(apart) if turn >= 0), 0)
    for k, fit in enumerate(fits):
        misfit = fit.over_all_shifts() / fit.sigma**2
        turn = fit.curve.turn * cycle.per_mesh
        if k == 0:
            total += misfit
            continue
        if apart[k] >= 0 and k != origin:
            turns[k] = turns[origin] + ((apart[k] - apart[origin]) * cycle.z_2 % cycle.meshes) * cycle.per_mesh
        elif (same := counted_with([fit.curve for fit in fits], k)) is not None:
            turns[k] = turns[same]
        else:
            ways = [np.roll(misfit, -n * turn) for n in range(cycle.size // math.gcd(turn, cycle.size))]
            blind = float(np.max(np.ptp(ways, axis=0))) < TOLD_CHI2
            known = further_on(fit.curve, [(turns[j], fits[j].curve) for j in range(k)], cycle, blind=blind)
            turns[k] = np.argmin(ways, axis=0) * turn if known is None else known
        total += misfit[(index + turns[k]) % cycle.size]
    return total, turns


def _zeros(shift: float | FloatArray, offset: float | FloatArray, cycle: Cycle) -> tuple[FloatArray, FloatArray]:
    """By how much the present zeros of the driving and the driven shaft are late, rad within half a turn."""
    turn = 2.0 * math.pi
    driven = np.asarray(shift, dtype=np.float64)
    driving = (driven - np.asarray(offset, dtype=np.float64) / cycle.r_b2) / cycle.ratio
    return np.remainder(driving + math.pi, turn) - math.pi, np.remainder(driven + math.pi, turn) - math.pi


def _reach(
    shift: float | FloatArray, offset: float | FloatArray, curve: RecordedCurve, cycle: Cycle, stated: StatedZeros
) -> FloatArray:
    """How far a place lies from the stated zeros, the larger of both shafts in pitches; 0 where none is stated."""
    driving, driven = _zeros(shift, offset, cycle)
    far = np.zeros(np.shape(driven))
    if stated.driven and (curve.counted or curve.turn == cycle.z_2):
        far = np.maximum(far, np.abs(driven) * (cycle.z_2 / (2.0 * math.pi)))
    if stated.driving and curve.counted:
        far = np.maximum(far, np.abs(driving) * (cycle.z_1 / (2.0 * math.pi)))
    elif stated.driving and curve.turn == cycle.z_1:
        # Only the driving encoder was read: it is the one that places the teeth.
        driving, _ = _zeros(shift, 0.0, cycle)
        far = np.maximum(far, np.abs(driving) * (cycle.z_1 / (2.0 * math.pi)))
    return far


def _allowed(fit: Misfit, cycle: Cycle, stated: StatedZeros) -> BoolArray:
    """Which places (size,) agree with the stated zeros; the nearest ones where none does."""
    far = _reach(
        np.arange(cycle.size, dtype=np.float64) * cycle.step,
        fit.level - fit.curve.template.mean,
        fit.curve,
        cycle,
        stated,
    )
    return far <= max(SLACK, float(np.min(far)) + SLACK - 0.5)


def _off(one: Attempt, fit: Misfit, cycle: Cycle, stated: StatedZeros) -> float:
    """How far a refined place lies from the stated zeros, in pitches."""
    return float(_reach(one.shift, fit.level - fit.curve.template.mean, fit.curve, cycle, stated))


def _peaks(misfit: FloatArray, cycle: Cycle, *, most: int = CANDIDATES) -> IntArray:
    """The best places of the grid, half a pitch apart at least, best first."""
    left = misfit.copy()
    out: list[int] = []
    half = cycle.per_mesh // 2
    while len(out) < most:
        h = int(np.argmin(left))
        if not np.isfinite(left[h]):
            break
        out.append(h)
        left[np.arange(h - half, h + half + 1) % cycle.size] = np.inf
    return np.array(out, dtype=np.int64)


def _beside(best: IntArray, allowed: BoolArray, cycle: Cycle) -> IntArray:
    """One and two teeth beside the best place: the likeliest mistakes, whatever the grid thinks of them."""
    out = (best[:, None] + np.array([-2, -1, 1, 2]) * cycle.per_mesh).ravel() % cycle.size
    kept: IntArray = out[allowed[out]]
    return kept
