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
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.noise_spectrum import ar_model, smooth_spectrum
from gearpoly.compare.pieces import pieces
from gearpoly.compare.slow import Slow
from gearpoly.compare.spectrum import ComplexArray, FrequencyGrid, Repeating
from gearpoly.compare.whitening import backward, forward
from gearpoly.units import BoolArray, FloatArray, IntArray, read_only

MISSING_SHARE = 0.003
"""Share of a cycle that may be missing at the ends of a record that is meant to hold whole cycles. The gap it leaves
blurs the repeating frequencies by as little as this share of their spacing."""

FEWEST_SAMPLES = 64
"""Samples from which on a spectrum says anything."""

HIGHEST_CYCLES_PER_MESH = 24.0
"""Cycles per mesh up to which what repeats is fitted; finer shapes no tooth makes in a recording."""

REPEATED_STEPS, SOME = 0.02, 64
"""Part of the steps that may be none before single steps no longer tell the spacing, and the samples over which they do
then: an encoder's step is at most a dozen samples long at speed, so this is off by a fiftieth of it at most."""

SPARSE = 0.1
"""Terms per sample below which the fit of what repeats takes nothing worth correcting from the lines between."""

MESH_PHASES_COMPARED = 32
"""Phases of the mesh at which what does not repeat is compared: a hand-over takes one or two of them, and of 18 000
samples 560 fall on each."""

UNUSUAL = 4.0
"""Standard errors by which a phase has to hold more than the middle of all: by chance three records in a thousand have
one."""

THIN = 20_000
"""Lines of a spectrum that are kept for good: of a million samples every 25th, when each is a mean over 400."""

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
        return forward(_columns(values), self.ar, self.innovation).reshape(values.shape)

    def whitened_at(self, values: FloatArray, where: IntArray) -> FloatArray:
        """What ``whitened`` makes of columns (n, m) that are 0 but at the samples ``where`` (r,), at the samples (s,)
        where it is not 0."""
        reach = np.unique(where[:, None] + np.arange(self.ar.size + 1))
        reach = reach[(reach >= self.ar.size) & (reach < values.shape[0])]
        out = values[reach] / self.innovation
        for k, a in enumerate(self.ar, start=1):
            out -= (a / self.innovation) * values[reach - k]
        return np.asarray(out)

    def score(self, whitened: FloatArray) -> FloatArray:
        """The whitening of ``whitened`` (n,) run backward: its product with any column, (n,) or (n, m), is that
        column's score."""
        return backward(_columns(whitened), self.ar, self.innovation).reshape(whitened.shape)

    def thinned(self) -> Noise:
        """The same with every so-many-th line of a long record: neighbours were estimated from the same lines."""
        step = max(1, self.frequency.size // THIN)
        at = np.unique(np.append(np.arange(0, self.frequency.size, step), self.frequency.size - 1))
        return replace(
            self,
            frequency=read_only(self.frequency[at]),
            density=read_only(self.density[at]),
            rest=read_only(self.rest[at]),
            count=read_only(self.count[at]),
        )

    def rest_at(self, frequency: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Whitened spectrum at ``frequency`` (cycles per mesh), and the number of lines it was estimated from."""
        return (
            np.interp(frequency, self.frequency, self.rest),
            np.interp(frequency, self.frequency, self.count),
        )

    def gain(self, frequency: FloatArray, *, spacing: float) -> ComplexArray:
        """Factor by which the whitening turns and enlarges a wave of ``frequency`` (cycles per mesh) at samples
        ``spacing`` meshes apart."""
        out: ComplexArray = np.empty(frequency.shape, dtype=np.complex128)
        for here in pieces(frequency.size):
            late = np.exp((-2j * np.pi * spacing) * frequency[here])
            remembered = np.zeros_like(late)
            for a in self.ar[::-1]:
                remembered = (remembered + a) * late
            out[here] = (1.0 - remembered) / self.innovation
        return out


def _columns(values: FloatArray) -> FloatArray:
    """The same (n,) or (n, m) as columns (n, m) that lie row by row."""
    return np.ascontiguousarray(values, dtype=np.float64).reshape(len(values), -1)


def spacing_of(u: FloatArray) -> float:
    """Meshes from sample to sample, in the middle of all; where readings repeat, over so many samples that few do."""
    step = np.diff(u)
    middle = float(np.median(step))
    if middle > 0.0 and np.count_nonzero(step <= 0.0) <= REPEATED_STEPS * step.size:
        return middle
    apart = min(SOME, u.size // 2)
    middle = float(np.median(u[apart:] - u[:-apart])) / apart
    return middle if middle > 0.0 else float(u[-1] - u[0]) / (u.size - 1)


def whole_cycles(u: FloatArray, period: float) -> int:
    """Whole hunting cycles of ``period`` meshes in the record ``u``."""
    span = float(u[-1] - u[0]) + spacing_of(u)
    return math.floor(span / period + MISSING_SHARE)


def _between_orders(frequency: FloatArray, *, z_1: int, z_2: int, spacing: float) -> BoolArray:
    """Lines that are no order of either shaft; all of them where hardly any would be left."""
    away = np.ones(frequency.size, dtype=bool)
    for z in (z_1, z_2):
        order = frequency * z
        away &= np.abs(order - np.round(order)) > 0.75 * spacing * z
    if np.count_nonzero(away) < max(24, 0.25 * frequency.size):
        return np.ones(frequency.size, dtype=bool)
    return away


def _kept_part(u: FloatArray, *, period: float, grid: FrequencyGrid, repeating: Repeating) -> FloatArray:
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
        if u.size < FEWEST_SAMPLES:
            raise ValueError(f"{u.size} samples are too few to estimate noise from; {FEWEST_SAMPLES} would do")
        period = float(math.lcm(z_1, z_2))
        self._spacing = spacing_of(u)
        cycles = whole_cycles(u, period)
        self._cycles = cycles if cycles >= 2 else 0
        beyond = np.flatnonzero(u - u[0] >= self._cycles * period) if self._cycles else np.empty(0)
        self.kept = slice(0, int(beyond[0]) if beyond.size else u.size)
        self._u = u = u[self.kept]
        self._nyquist = 0.5 / self._spacing
        span = self._cycles * period if self._cycles else float(u[-1] - u[0]) + self._spacing
        count = int(self._nyquist * span)
        self._grid = FrequencyGrid(u, step=1.0 / span, count=count)
        self._harmonics = 0
        self._repeating: Repeating | None = None
        self._kept_part: FloatArray | None = None
        if self._cycles:
            free = np.arange(count) % self._cycles != 0
            free[0] = False
            self._harmonics = max(2, int(min(self._nyquist, HIGHEST_CYCLES_PER_MESH) * period))
            self._repeating = Repeating(u, period=period, count=self._harmonics)
            self.basis = f"what does not repeat over {self._cycles} whole hunting cycles"
            if 2 * self._harmonics > SPARSE * u.size:
                kept = _kept_part(u, period=period, grid=self._grid, repeating=self._repeating)
                self._kept_part = kept[free]
        else:
            free = _between_orders(np.arange(count) / span, z_1=z_1, z_2=z_2, spacing=1.0 / span)
            free[:2] = False
            self.basis = (
                "a smooth spectrum through what lies between the shaft orders, since the recording holds only "
                f"{span / period:.2g} hunting cycles and nothing repeats"
            )
        self._free = free
        self._frequency = np.flatnonzero(free) / span
        self._frequency.setflags(write=False)
        self._slow = Slow(u, repeating=self._repeating)

    def _lines(self, values: FloatArray) -> FloatArray:
        power = self._grid.power(values)[self._free]
        power /= values.size
        return power if self._kept_part is None else np.asarray(power / self._kept_part)

    def parted(self, residual: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What of ``residual`` (n,) in mm does not repeat and is not slow, over the whole cycles (m,), and what
        repeats."""
        return self._slow.parted(residual[self.kept])

    def _evened(self, rest: FloatArray) -> FloatArray:
        """``rest`` (n,), less than it was at phases of the mesh where more is left than at most.

        Noise does not know the teeth. Where pairs hand over, what repeats bends faster than samples follow, and its
        finest part is left over as if it did not repeat.
        """
        cell = np.empty(rest.size, dtype=np.int8)
        count, power = np.zeros(MESH_PHASES_COMPARED), np.zeros(MESH_PHASES_COMPARED)
        for here in pieces(rest.size):
            u = self._u[here]
            cell[here] = np.minimum((u - np.floor(u)) * MESH_PHASES_COMPARED, MESH_PHASES_COMPARED - 1)
            count += np.bincount(cell[here], minlength=MESH_PHASES_COMPARED)
            power += np.bincount(cell[here], weights=rest[here] ** 2, minlength=MESH_PHASES_COMPARED)
        mean = power / np.maximum(count, 1.0)
        # Samples of one visit to a phase are neighbours in the noise, so visits count.
        visits = np.minimum(count, self._u[-1] - self._u[0])
        scatter = np.sqrt(2.0 / np.maximum(visits, 1.0))
        usual = mean <= float(np.median(mean[count > 0])) * (1.0 + UNUSUAL * scatter)
        if usual.all():
            return rest
        level = float(np.sum(power[usual]) / np.sum(count[usual]))
        return rest * np.where(usual, 1.0, np.sqrt(level / np.where(usual, 1.0, mean)))[cell]

    def estimate(self, residual: FloatArray) -> Noise:
        """The noise in ``residual`` (n,) in mm."""
        rest, repeating = self.parted(residual)
        return self.noise_in(rest, repeats=float(np.std(repeating)))

    def noise_in(self, rest: FloatArray, *, repeats: float) -> Noise:
        """The noise in ``rest`` (m,) in mm, as ``parted`` from what repeats, whose rms is ``repeats``."""
        if self._cycles:
            rest = self._evened(rest)
        frequency, nyquist, n = self._frequency, self._nyquist, rest.size
        density, number = smooth_spectrum(self._lines(rest))
        noise = Noise(
            level=1.0,
            level_std=0.0,
            ar=np.empty(0),
            innovation=1.0,
            frequency=frequency,
            density=density,
            rest=density,
            count=number,
            cycles=self._cycles,
            basis=self.basis,
            repeatable=None,
        )
        for _ in range(2):
            ar, innovation = ar_model(frequency, density, nyquist=nyquist, samples=n)
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
            repeatable = math.sqrt(max(0.0, repeats**2 - taken))
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


def mean_innovation(noises: Sequence[Noise]) -> float:
    """Rms in mm of the innovations of the noise of several recordings, each counted alike."""
    return math.sqrt(sum(one.innovation**2 for one in noises) / len(noises))


def pooled_level(noises: list[Noise], sizes: list[int]) -> float:
    """Rms noise in mm of all samples of a set of recordings with ``sizes`` samples."""
    return math.sqrt(sum(n.level**2 * size for n, size in zip(noises, sizes, strict=True)) / sum(sizes))
