"""What trains of pulses are looked for in: the lines of whitened residuals, but those that belong to the gears."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearpoly.compare.families import log_tail_line
from gearpoly.compare.lines import SLOWEST_BLIND
from gearpoly.compare.noise import Noise
from gearpoly.compare.peak import Domain
from gearpoly.compare.sampling import Sampling
from gearpoly.compare.spectrum import ComplexArray
from gearpoly.units import BoolArray, FloatArray, IntArray

OTHERS = 1e-3
"""Chance with which all lines but the strongest may be noise: what stands out in one line is looked for elsewhere."""

LEAST_WEIGHT = 1e-300
"""Chances and weights below this count as this, so that logarithms and quotients stay finite."""


@dataclass(frozen=True, kw_only=True)
class Train:
    """Harmonics 1 to ``count`` of ``frequency``, in units of the spectra's, in the ``recordings``; ``log_false`` log of
    the expected number of such finds in noise. Of bumps ``gain`` is half of what they take of the misfit, and the
    frequency the best between the spectra's places; 0 where powers were added up."""

    frequency: float
    count: int
    recordings: tuple[int, ...]
    log_false: float
    gain: float = 0.0


def together(many: int) -> list[tuple[int, ...]]:
    """In which of ``many`` recordings trains are looked for: in each, and in all at once."""
    each: list[tuple[int, ...]] = [(k,) for k in range(many)]
    return each if many < 2 else [*each, tuple(range(many))]


def likelier(
    best: Train | None, log_false: FloatArray, last: IntArray, *, step: float, count: int, recordings: tuple[int, ...]
) -> Train | None:
    """The ``best`` train so far, or that of ``log_false`` (b,) which noise makes less often, if it makes it less than
    once; its last harmonic is at place ``last`` (b,) of places ``step`` apart."""
    place = int(np.argmin(log_false)) if log_false.size else 0
    if not log_false.size or log_false[place] >= min(0.0, best.log_false if best is not None else 0.0):
        return best
    return Train(
        frequency=float(last[place]) * step / count, count=count, recordings=recordings,
        log_false=float(log_false[place]),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Lines:
    """One recording's lines at places (m,) that several recordings have in common: ``amplitude`` about the middle of
    the record, of mean square 1 in noise, the whitened spectrum ``rest`` there, the ``count`` of lines that this was
    estimated from, and whether a place ``repeats`` with the pair. Where nothing is looked for the amplitude is 0."""

    amplitude: ComplexArray
    rest: FloatArray
    count: FloatArray
    repeats: BoolArray

    @property
    def free(self) -> BoolArray:
        """Where something is looked for (m,)."""
        return np.asarray(self.amplitude != 0.0)

    @property
    def chances(self) -> FloatArray:
        """Log chance (m,) that noise exceeds a line, 0 where nothing is looked for."""
        return log_tail_line(self.amplitude.real**2 + self.amplitude.imag**2, self.count)


def lines_of(sampling: Sampling, domain: Domain, white: FloatArray, noise: Noise, *, step: float) -> Lines:
    """The lines of a whitened residual (n,) below half the sampling rate at places ``step`` apart, without orders of
    the shafts and what is no faster than drift."""
    x, grid, span, per_mesh = sampling.over(domain)
    below = min(grid.count, int(sampling.nyquist / per_mesh / grid.step))
    # Onto common places: half a place off is a quarter of a line at most.
    size = int((below - 1) * grid.step / step)
    at = np.rint(step / grid.step * np.arange(size, dtype=np.float64)).astype(np.int64)
    frequency: FloatArray = grid.step * at.astype(np.float64)
    rest, count = sampling.rest_at(domain, frequency, noise)
    sums = grid.transform(white)[at] * np.exp((1j * np.pi * (x[0] + x[-1])) * frequency)
    sums /= np.sqrt(white.size * rest)
    sums[sampling.own(frequency * per_mesh) | (frequency * span < SLOWEST_BLIND)] = 0.0
    return Lines(amplitude=sums, rest=rest, count=count, repeats=sampling.repeats(frequency * per_mesh))
