"""One way to lay recordings on the hunting cycle: refined below the grid, with its doubt, and set against another."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.compare.curve import Cycle, Misfit
from gearpoly.units import FloatArray, IntArray

RIVAL = 4.0
"""Standard errors of the difference in misfit. Among a thousand meshes one passes three by chance."""

ROUNDING_MISFIT_PART = 1e-9
"""Part of the misfit by which two places differ that doubles alone make. Where ideal teeth have no curve all places fit
alike: 4e-14 in 55 had been called "much better", and right zeros doubted."""

NEARBY = 1.0 / 24.0
"""Pitches on either side that the last search covers: a step of the grid on which places are first tried."""

SCANNED = 16
"""Places on either side that it tries, 0.04 deg apart on an 18/25 pair: several per dip that a corner makes."""

PLACE_TOLERANCE_PITCHES = 1e-5
"""Pitches at which it stops, below any standard error."""

TAKEN = 5
"""Freedoms of the teeth of one gear that its mean and its first two orders take."""

INDEPENDENT_BLOCKS = 24
"""Contiguous blocks of a recording whose scores are taken as independent: long against the correlation of noise, and
enough to show a spread."""

NEWTON = 25
"""Gauss-Newton steps; hand-overs bend the curve, so the last digits come linearly, two or three steps each."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Laying:
    """One way to lay all recordings on the cycle.

    ``shift`` in rad: driven rotation of the first recording by its present zero minus the true one, in [0, cycle).
    ``shifts`` (recordings,) the same for each, whole turns apart. ``offset`` (recordings,) in mm: recorded minus
    simulated mean TE by the present zeros. ``rms`` in mm of what is left, doubts not taken off, about each mean.
    """

    shift: float
    shifts: FloatArray
    offset: FloatArray
    rms: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Attempt:
    """All recordings at one refined place: residuals and doubts taken off, in sigmas squared."""

    fits: list[Misfit]
    cycle: Cycle
    shift: float
    turns: FloatArray
    misfit: float
    penalty: float

    @staticmethod
    def make(fits: list[Misfit], cycle: Cycle, shift: float, further: FloatArray) -> Attempt:
        """Refine ``shift`` in rad by Gauss-Newton, within half a pitch of where it starts; ``further`` (recordings,)
        in rad is how much further on each recording lies."""
        start, (value, penalty) = shift, _value(fits, shift, further)
        for _ in range(NEWTON):
            gradient = curvature = 0.0
            for fit, more in zip(fits, further.tolist(), strict=True):
                r, t = fit.residual(shift + more), fit.slope(shift + more)
                rest = t - fit.drawn(fit.explained(t))
                gradient += float((fit.curve.weight * rest) @ r) / fit.sigma**2
                curvature += float((fit.curve.weight * rest) @ t) / fit.sigma**2
            if curvature <= 0.0:
                break
            step = float(np.clip(-gradient / curvature, -cycle.pitch / 16.0, cycle.pitch / 16.0))
            for _ in range(6):
                trial = shift + step
                after, price = _value(fits, trial, further)
                if after < value and abs(trial - start) < 0.5 * cycle.pitch:
                    break
                step *= 0.4
            else:
                break
            gained = value - after
            shift, value, penalty = trial, after, price
            if gained < 1e-4:  # a hundredth of a standard error
                break
        return Attempt(
            fits=fits, cycle=cycle, shift=shift % cycle.span, turns=further, misfit=value, penalty=penalty
        )  # fmt: skip

    def polished(self) -> Attempt:
        """The lowest place within ``NEARBY``: steep corners make dips beside the true one, in which Gauss-Newton may
        stop. All of a fine grid is looked at, then the lowest dip is halved down."""
        best, step = self, NEARBY * self.cycle.pitch / SCANNED
        for n in range(-SCANNED, SCANNED + 1):
            trial = self.moved(n * step)
            best = trial if trial.misfit < best.misfit else best
        while step > PLACE_TOLERANCE_PITCHES * self.cycle.pitch:
            step *= 0.5
            best = min((best, best.moved(-step), best.moved(step)), key=lambda one: one.misfit)
        return best

    def moved(self, by: float) -> Attempt:
        """The place ``by`` rad further on, not refined."""
        value, penalty = _value(self.fits, self.shift + by, self.turns)
        return Attempt(
            fits=self.fits,
            cycle=self.cycle,
            shift=self.shift + by,
            turns=self.turns,
            misfit=value,
            penalty=penalty,
        )

    def place(self) -> Laying:
        """As the outside sees it."""
        offsets, square, count = [], 0.0, 0.0
        for fit, more in zip(self.fits, self.turns.tolist(), strict=True):
            r = fit.residual(self.shift + more)
            # The mean by the doubts' own column: a broken turn of an eccentricity does not count as mean.
            offsets.append(fit.level + float(fit.explained(r)[0]) - fit.curve.template.mean)
            square += float(fit.curve.weight @ (r - np.average(r, weights=fit.curve.weight)) ** 2)
            count += fit.count
        return Laying(
            shift=self.shift,
            shifts=self.shift + self.turns,
            offset=np.array(offsets),
            rms=math.sqrt(square / count),
        )

    def errors(self) -> tuple[float, float]:
        """Standard errors of the shift in rad and of the mean in mm.

        What the simulation lacks repeats with a tooth, with a pair of teeth or not at all, so scores are summed by
        driving tooth, by driven tooth, and by contiguous block, and what they count twice is taken off (Cameron,
        Gelbach and Miller 2011, multiway clusters). To this comes what the doubts could hide.
        """
        curvature = hidden = count = 0.0
        parts: list[tuple[FloatArray, FloatArray]] = []
        groups: list[list[IntArray]] = [[], [], [], []]
        for k, (fit, more) in enumerate(zip(self.fits, self.turns.tolist(), strict=True)):
            r, t = fit.residual(self.shift + more), fit.slope(self.shift + more)
            c = fit.explained(t)
            rest = t - fit.drawn(c)
            left = r - fit.drawn(fit.explained(r))
            weight = fit.curve.weight
            curvature += float((weight * rest) @ t) / fit.sigma**2
            hidden += float(c**2 @ fit.prior) / fit.sigma**2
            count += fit.count
            parts.append((weight * rest * left / fit.sigma**2, weight * left))
            for group, label in zip(groups, _labels(fit, self, k), strict=True):
                group.append(label)
        if curvature <= 0.0:
            return math.inf, math.inf
        scores, means = (np.concatenate([part[n] for part in parts]) for n in (0, 1))
        labels = [np.concatenate(group) for group in groups]
        # Errors of one compliance law or relief pull all recordings the same way: the doubts do not average out.
        spread = _clustered(scores, labels) + len(self.fits) * hidden
        return math.sqrt(spread) / curvature, math.sqrt(_clustered(means, labels)) / count


def _value(fits: list[Misfit], shift: float, further: FloatArray) -> tuple[float, float]:
    """Penalised misfit of the set in sigmas squared, and how much of it is the price of the doubts."""
    total = price = 0.0
    for fit, more in zip(fits, further.tolist(), strict=True):
        r = fit.residual(shift + more)
        product = fit.weighted @ r
        c = fit.inverse @ product
        total += (float(fit.curve.weight @ r**2) - float(product @ c)) / fit.sigma**2
        price += float(c**2 @ fit.prior) / fit.sigma**2
    return total, price


def _clustered(scores: FloatArray, labels: list[IntArray]) -> float:
    """Variance of the sum of ``scores`` (n,) whose errors are shared within each kind of label: mesh, driving tooth,
    driven tooth, block. The doubts have taken ``TAKEN`` freedoms of each gear's teeth."""
    out = []
    for label, taken in zip(labels, (1, TAKEN, TAKEN, 1), strict=True):
        _, index = np.unique(label, return_inverse=True)
        sums = np.bincount(index, weights=scores)
        groups = sums.size
        out.append(float(sums @ sums) * groups / max(groups - taken, 1))
    mesh, *ways = out
    return max(sum(ways) - 2.0 * mesh, *ways)


def are_apart(one: Attempt, best: Attempt, cycle: Cycle) -> bool:
    """Whether two places differ by a tooth or more, not only within a pitch."""
    off = np.remainder(one.shift - best.shift + 0.5 * cycle.span, cycle.span) - 0.5 * cycle.span
    return bool(abs(off) > 0.5 * cycle.pitch)


def is_worse(one: Attempt, best: Attempt, cycle: Cycle, *, sigmas: float = RIVAL) -> bool:
    """Whether ``one`` fits worse than ``best`` by more than ``sigmas`` standard errors.

    The difference of squares is -2 r D + D^2 with r what ``best`` leaves and D what the two places differ by, so its
    standard error is that of 2 r D, over teeth, pairs and blocks; the price of the doubts scatters as a likelihood
    ratio does. Where r itself follows the teeth (load smooths their steps, say) that is too much; but no wrong place
    takes more than sigmas^2 shares of one tooth from the misfit of the right one, if errors are each tooth's own.
    """
    scores: list[FloatArray] = []
    groups: list[list[IntArray]] = [[], [], [], []]
    for k, fit in enumerate(best.fits):
        r, other = (fit.residual(way.shift + float(way.turns[k])) for way in (best, one))
        left, apart = (x - fit.drawn(fit.explained(x)) for x in (r, other - r))
        scores.append(fit.curve.weight * left * apart / fit.sigma**2)
        for group, label in zip(groups, _labels(fit, best, k), strict=True):
            group.append(label)
    spread = 4.0 * _clustered(np.concatenate(scores), [np.concatenate(group) for group in groups])
    spread += 4.0 * abs(one.penalty - best.penalty)
    gained = one.misfit - best.misfit
    by_chance = sigmas**2 / (cycle.z_1 + cycle.z_2)
    return (
        gained > max(sigmas * math.sqrt(spread), ROUNDING_MISFIT_PART * one.misfit) or gained > by_chance * one.misfit
    )


def _labels(fit: Misfit, one: Attempt, k: int) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Mesh, driving tooth, driven tooth and block (n,) of the samples of recording ``k``."""
    mesh, driving, driven = fit.labels(one.shift + float(one.turns[k]))
    return mesh, driving, driven, k * INDEPENDENT_BLOCKS + np.arange(mesh.size) * INDEPENDENT_BLOCKS // mesh.size
