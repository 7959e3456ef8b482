"""The noise of a recording: what does not repeat from one hunting cycle to the next.

All that two gears can do to each other repeats after one hunting cycle. Over C whole cycles it lies at every C-th
frequency of the record, so the frequencies between hold nothing but noise, and what is no property of the pair: hum,
orders that are no integer, drift. Those are narrow and are kept out by robust means; they belong to ``locate``. The
noise is smooth over the orders and stationary from sample to sample: an autoregressive model whitens it.

A record shorter than two cycles does not show its repetition. There the same smooth curve is drawn through what lies
between the shaft orders of both gears, and ``basis`` says so.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.linalg import solve_toeplitz

from gearpoly.compare.spectrum import ComplexArray, Grid, Repeating
from gearpoly.units import BoolArray, FloatArray, read_only

WHOLE = 0.003
"""Share of a cycle that may be missing at the ends of a record that is meant to hold whole cycles. The gap it leaves
blurs the repeating frequencies by as little as this share of their spacing."""

SLOW = 4
"""Terms of the slow curve (mean, ramp, bow, S) that is taken off first: drift, which is no noise of this kind."""

AR_ORDER = 24
"""Longest memory of the noise in samples; the shortest that does as well is taken."""

CUT = 7.0
"""A line this often above the middle of its neighbours (in power) is no noise: one in e^7 = 1100 of honest ones is
cut, and the mean of the others is corrected for it."""

FEWEST = 64
"""Samples from which on a spectrum says anything."""

HIGHEST = 24.0
"""Cycles per mesh up to which what repeats is fitted; finer shapes no tooth makes in a recording."""

SPARSE = 0.1
"""Terms per sample below which the fit of what repeats takes nothing worth correcting from the lines between."""

LOWEST = 24
"""Slowest lines whose power law is drawn on to zero frequency."""

_CUT_MEAN = 1.0 - CUT * math.exp(-CUT) / (1.0 - math.exp(-CUT))
"""Mean of an exponential of mean 1 cut at CUT."""

SHORT_BIAS = 0.10
"""Relative one-sigma doubt about the level where only the model stands for repetition: sums of shaft orders and side
bands of both gears lie between their orders and cannot be told from noise. Found on synthetic pairs whose residual is
as large as their noise."""


@dataclass(frozen=True, kw_only=True)
class Noise:
    """The noise of one recording.

    ``level`` in mm, rms of one sample, and ``level_std`` its standard error; ``ar`` (p,) coefficients of the
    autoregressive model e_i = (r_i - sum ar_k r_(i-k)) / innovation, with ``innovation`` in mm; ``frequency`` (m,) in
    cycles per mesh and ``density`` (m,), the smoothed spectrum over it, whose mean is level^2; ``rest`` (m,), what the
    model leaves of it, near 1, from ``count`` (m,) independent lines each. ``cycles`` whole hunting cycles it rests
    on (0: none) and ``basis`` the same in words. ``repeatable`` rms in mm of what does repeat, noise taken off, or
    ``None`` where the record is too short to tell.
    """

    level: float
    level_std: float
    ar: FloatArray
    innovation: float
    frequency: FloatArray
    density: FloatArray
    rest: FloatArray
    count: FloatArray
    cycles: int
    basis: str
    repeatable: float | None

    def whitened(self, values: FloatArray) -> FloatArray:
        """Values (n,) or columns (n, m) with this noise made white, of variance 1; the first samples, which have no
        past, are 0."""
        out = values / self.innovation
        for k, a in enumerate(self.ar, start=1):
            out[k:] -= (a / self.innovation) * values[:-k]
        out[: self.ar.size] = 0.0
        return out

    def score(self, whitened: FloatArray) -> FloatArray:
        """The whitening of ``whitened`` (n,) run backward: its product with any column, (n,) or (n, m), is that
        column's score."""
        out = whitened / self.innovation
        for k, a in enumerate(self.ar, start=1):
            out[:-k] -= (a / self.innovation) * whitened[k:]
        return out

    def rest_at(self, frequency: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Whitened spectrum at ``frequency`` (cycles per mesh), and the number of lines it was estimated from."""
        return (
            np.interp(frequency, self.frequency, self.rest),
            np.interp(frequency, self.frequency, self.count),
        )

    def gain(self, frequency: FloatArray, *, spacing: float) -> ComplexArray:
        """Factor by which the whitening turns and enlarges a wave of ``frequency`` (cycles per mesh) at samples
        ``spacing`` meshes apart."""
        angle = 2.0 * np.pi * np.outer(np.asarray(frequency) * spacing, 1.0 + np.arange(self.ar.size))
        return np.asarray((1.0 - np.exp(-1j * angle) @ self.ar) / self.innovation)


def slow_curves(x: FloatArray, terms: int = SLOW) -> FloatArray:
    """Legendre polynomials (n, terms) over the span of ``x`` (n,)."""
    low, high = float(np.min(x)), float(np.max(x))
    along = (2.0 * x - low - high) / max(high - low, 1e-300)
    return np.asarray(np.polynomial.legendre.legvander(along, terms - 1), dtype=np.float64)


def spacing_of(u: FloatArray) -> float:
    """Meshes from sample to sample, in the middle of all."""
    return float(np.median(np.diff(u)))


def whole_cycles(u: FloatArray, period: float) -> int:
    """Whole hunting cycles of ``period`` meshes in the record ``u``."""
    span = float(u[-1] - u[0]) + spacing_of(u)
    return math.floor(span / period + WHOLE)


def windows(count: int, *, least: int = 12, most: int = 400) -> tuple[FloatArray, FloatArray]:
    """Bounds [low, high) of the neighbourhood from which the noise at each of ``count`` lines is estimated: two thirds
    to one and a half of its frequency, at least ``least`` and at most ``most`` lines."""
    k = np.arange(count, dtype=np.float64)
    half = np.clip(0.4 * (k + 1.0), 0.5 * least, 0.5 * most)
    low = np.clip(np.floor(k - half), 0.0, max(0.0, count - least))
    high = np.clip(np.ceil(k + half) + 1.0, min(least, count), count)
    return low, high


def smooth_spectrum(power: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Level (m,) of a noise spectrum from its independent lines ``power`` (m,), blind to narrow peaks, and the number
    of lines (m,) each value rests on.

    Middle of the neighbours first; then the mean of those that are below CUT of it.
    """
    m = power.size
    low, high = windows(m)
    # Medians where the neighbourhood has grown by a tenth, drawn through in between.
    at = np.unique(
        np.minimum(m - 1, np.concatenate([np.arange(min(m, 40)), np.geomspace(40, max(m, 41), 160)]).astype(int))
    )
    at = np.unique(np.concatenate([at, np.arange(0, m, 100)]))
    middle = np.empty(at.size)
    width = np.asarray(high[at] - low[at], dtype=np.int64)
    for same in np.unique(width).tolist():
        here = np.flatnonzero(width == same)
        middle[here] = np.median(sliding_window_view(power, same)[low[at[here]].astype(int)], axis=1)
    middle /= math.log(2.0)
    middle = np.maximum(middle, 1e-300)
    level = np.exp(np.interp(np.arange(m), at, np.log(middle)))
    for _ in range(2):
        kept = power <= CUT * level
        total = np.concatenate([[0.0], np.cumsum(np.where(kept, power / level, 0.0))])
        number = np.concatenate([[0.0], np.cumsum(kept)])
        lo, hi = low.astype(int), high.astype(int)
        n = np.maximum(number[hi] - number[lo], 1.0)
        level = level * np.maximum((total[hi] - total[lo]) / n / _CUT_MEAN, 1e-6)
    # Wandering rises towards the slowest lines faster than any mean follows: there the power law of the first few dozen
    # lines goes on, of which it takes at least as much as the means.
    few = min(LOWEST, m)
    if few >= 12:
        x = np.log(np.arange(1.0, few + 1.0))
        y = np.log(np.maximum(power[:few], 1e-300)) + np.euler_gamma
        # A peak among them must not draw the law upward: clip at CUT above the first level.
        y = np.minimum(y, np.log(CUT * level[:few]))
        slope, start = np.polyfit(x, y, 1)
        law = np.exp(start + min(slope, 0.0) * x + (0.0 if slope < 0.0 else slope * float(np.mean(x))))
        near = x < np.log(0.5 * few)
        level[:few] = np.where(near, np.maximum(level[:few], law), level[:few])
        n[:few] = np.where(near, np.minimum(n[:few], 0.5 * few), n[:few])
    return level, n


def _model(frequency: FloatArray, density: FloatArray, *, nyquist: float, samples: int) -> tuple[FloatArray, float]:
    """Autoregressive coefficients and innovation rms of a spectrum ``density`` over ``frequency`` up to ``nyquist``."""
    even = np.interp(np.linspace(0.0, nyquist, 4097), frequency, density)
    covariance = np.fft.irfft(even)
    best: tuple[float, FloatArray, float] | None = None
    for order in range(min(AR_ORDER, samples // 20) + 1):
        if order == 0:
            ar, left = np.empty(0), float(covariance[0])
        else:
            ar = solve_toeplitz(covariance[:order], covariance[1 : order + 1])
            left = float(covariance[0] - ar @ covariance[1 : order + 1])
        # Hannan and Quinn's criterion: a longer memory has to pay for its coefficient, and white noise stays white.
        price = samples * math.log(max(left, 1e-300)) + 2.0 * math.log(math.log(samples)) * order
        if best is None or price < best[0] - 1e-9:
            best = (price, ar, math.sqrt(max(left, 1e-300)))
    assert best is not None
    return best[1], best[2]


def _between_orders(frequency: FloatArray, *, z_1: int, z_2: int, spacing: float) -> BoolArray:
    """Lines that are no order of either shaft; all of them where hardly any would be left."""
    away = np.ones(frequency.size, dtype=bool)
    for z in (z_1, z_2):
        order = frequency * z
        away &= np.abs(order - np.round(order)) > 0.75 * spacing * z
    if np.count_nonzero(away) < max(24, 0.25 * frequency.size):
        return np.ones(frequency.size, dtype=bool)
    return away


def _kept_part(u: FloatArray, *, period: float, grid: Grid, repeating: Repeating) -> FloatArray:
    """Part (count,) of white noise's power that is left at each line once what repeats has been taken off.

    Sampled unevenly, lines run into one another, and a fit of all harmonics takes something from the lines between.
    Seen on one seeded white record, drawn smooth over the frequency as an even polynomial.
    """
    probe = np.random.default_rng(2020).normal(size=u.size)
    left = probe - repeating.part(probe)
    before, after = np.abs(grid.transform(probe)) ** 2, np.abs(grid.transform(left)) ** 2
    x = np.linspace(0.0, 1.0, grid.count)
    whole = np.abs(np.arange(grid.count) * grid.step * period % 1.0 - 0.5) < 0.5 - 1e-6
    shape = np.stack([np.ones_like(x), x**2, x**4], axis=1)[whole]
    # The same noise before and after: what both share of chance cancels in the ratio of the two fits.
    top = shape @ np.linalg.lstsq(shape, after[whole], rcond=None)[0]
    bottom = shape @ np.linalg.lstsq(shape, before[whole], rcond=None)[0]
    out = np.ones(grid.count)
    out[whole] = np.clip(top / bottom, 0.3, 1.5)
    return out


class NoiseEstimator:
    """Estimates noise at samples ``u`` (n,), meshes of driven rotation (increasing), of a pair of ``z_1`` and ``z_2``
    teeth, as often as the residual there changes.

    Raises ``ValueError`` for fewer than 64 samples, too few for any spectrum.
    """

    def __init__(self, u: FloatArray, *, z_1: int, z_2: int) -> None:
        if u.size < FEWEST:
            raise ValueError(f"{u.size} samples are too few to estimate noise from; {FEWEST} would do")
        period = float(math.lcm(z_1, z_2))
        self._spacing = spacing_of(u)
        cycles = whole_cycles(u, period)
        self._cycles = cycles if cycles >= 2 else 0
        self.kept = u - u[0] < (self._cycles * period if self._cycles else math.inf)
        u = u[self.kept]
        self._u = u
        self._nyquist = 0.5 / self._spacing
        self._curves = self._alone = slow_curves(u)
        self._repeating: Repeating | None = None
        if self._cycles:
            span = self._cycles * period
            count = int(self._nyquist * span)
            self._grid = Grid(u, step=1.0 / span, count=count)
            free = np.arange(count) % self._cycles != 0
            free[0] = False
            self._harmonics = max(2, int(min(self._nyquist, HIGHEST) * period))
            self._repeating = Repeating(u, period=period, count=self._harmonics)
            # Slow curves are fitted beside what repeats, not before it: of a strong order 1 they would take a part, and
            # leave it as what does not repeat. What is level repeats.
            self._curves = self._curves[:, 1:]
            self._alone = np.column_stack([curve - self._repeating.part(curve) for curve in self._curves.T])
            self.basis = f"what does not repeat over {self._cycles} whole hunting cycles"
            kept_part = np.ones(count)
            if 2 * self._harmonics > SPARSE * u.size:
                kept_part = _kept_part(u, period=period, grid=self._grid, repeating=self._repeating)
        else:
            span = float(u[-1] - u[0]) + self._spacing
            count = int(self._nyquist * span)
            self._grid = Grid(u, step=1.0 / span, count=count)
            free = _between_orders(np.arange(count) / span, z_1=z_1, z_2=z_2, spacing=1.0 / span)
            free[:2] = False
            self._harmonics = 0
            self.basis = (
                "a smooth spectrum through what lies between the shaft orders, since the recording holds only "
                f"{span / period:.2g} hunting cycles and nothing repeats"
            )
            kept_part = np.ones(count)
        self._free = free
        self._kept_part = kept_part[free]
        self._frequency = np.flatnonzero(free) / span

    def _lines(self, values: FloatArray) -> FloatArray:
        return np.asarray(np.abs(self._grid.transform(values)[self._free]) ** 2 / values.size / self._kept_part)

    def parted(self, residual: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What of ``residual`` (n,) in mm does not repeat and is not slow, over the whole cycles (m,), and what
        repeats."""
        residual = residual[self.kept]
        rest = residual - self._curves @ np.linalg.lstsq(self._alone, residual, rcond=None)[0]
        if self._repeating is None:
            return rest, np.zeros(1)
        repeating = self._repeating.part(rest)
        return rest - repeating, repeating

    def estimate(self, residual: FloatArray) -> Noise:
        """The noise in ``residual`` (n,) in mm."""
        rest, repeating = self.parted(residual)
        frequency, nyquist, n = self._frequency, self._nyquist, rest.size
        density, number = smooth_spectrum(self._lines(rest))
        noise = Noise(
            level=1.0,
            level_std=0.0,
            ar=np.empty(0),
            innovation=1.0,
            frequency=read_only(frequency),
            density=density,
            rest=density,
            count=number,
            cycles=self._cycles,
            basis=self.basis,
            repeatable=None,
        )
        for _ in range(2):
            ar, innovation = _model(frequency, density, nyquist=nyquist, samples=n)
            noise = replace(noise, ar=read_only(ar), innovation=innovation)
            # Steep spectra spill over the whole record; whitened ones do not, so the second look is the true one.
            left, number = smooth_spectrum(self._lines(noise.whitened(rest)))
            density = left / np.abs(noise.gain(frequency, spacing=self._spacing)) ** 2
        even = np.interp(np.linspace(0.0, nyquist, 8193), frequency, density)
        level = math.sqrt(float(np.mean(even)))
        # Var of the mean square = 2 int S^2 / n for a stationary Gaussian; only the free lines were seen.
        share = max(frequency.size / self._grid.count, 1e-3)
        level_std = 0.5 * level * math.sqrt(2.0 * float(np.mean(even**2)) / level**4 / (n * share))
        repeatable = None
        if self._cycles:
            # A fit of 2 K terms takes along 2 K / n of white noise.
            taken = level**2 * 2.0 * self._harmonics / n
            repeatable = math.sqrt(max(0.0, float(np.var(repeating)) - taken))
        else:
            level_std = math.hypot(level_std, SHORT_BIAS * level)
        return replace(
            noise,
            level=level,
            level_std=level_std,
            density=read_only(density),
            rest=read_only(left),
            count=read_only(number),
            repeatable=repeatable,
        )


def estimate_noise(u: FloatArray, residual: FloatArray, *, z_1: int, z_2: int) -> Noise:
    """The noise in ``residual`` (n,) in mm, as ``NoiseEstimator`` gives it."""
    return NoiseEstimator(u, z_1=z_1, z_2=z_2).estimate(residual)


def pooled_level(noises: list[Noise], sizes: list[int]) -> float:
    """Rms noise in mm of all samples of a set of recordings with ``sizes`` samples."""
    return math.sqrt(sum(n.level**2 * size for n, size in zip(noises, sizes, strict=True)) / sum(sizes))
