"""What waves a recording can show, by the angles and times at which it was sampled."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearpoly.compare.even import GAP_MIDDLE_STEPS, even_in_time
from gearpoly.compare.noise import Noise, spacing_of
from gearpoly.compare.orders import KnownOrders, known_orders
from gearpoly.compare.peak import Domain, Peak
from gearpoly.compare.regression import WaveSums
from gearpoly.compare.spectrum import FrequencyGrid
from gearpoly.compare.unfold import regular_rate
from gearpoly.units import BoolArray, FloatArray, IntArray

FOOT_OF_PEAK_LINES = 1.5
"""Independent lines from a stronger peak within which a peak is its foot, not its own; what is really there shows when
the stronger one is taken off."""

SLOWEST = 1.75
"""Turns of the record below which a wave cannot be told from drift, whose curves were taken off."""

RATES, UNEVEN_UP_TO = 2.0, 100_000
"""Sampling rates up to which hum is looked for, and samples up to which it is, where times are a little uneven: those
tell a wave above half the rate from its image below. Hum of 100 Hz in 66 samples per second was told as four lines at
35 Hz, or as none."""

GAP_SIGMAS = 4.0
"""Standard deviations of the steps beyond which one is a gap. Samples that came a quarter of a step early or late had
2056 Hz in the place of 2040 without their steps above 1.5 usual ones: a drift that turned 1.4 times was told as two
tones at 2040 Hz, since nobody saw that it is their image."""

WHOLE_TURN, REPEATS = 1.5, 0.4
"""Hunting cycles from which on frequencies that repeat with the pair stand apart from others, and the independent lines
within which a wave of any frequency may be one of them."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Timed:
    """Samples ``t`` (n,) in s that last ``duration`` s: ``pace`` in s per mesh, ``rate`` of sampling and ``top``, the
    highest frequency that is looked for, in Hz; ``even``: they come evenly, and are no means; ``grid`` of
    frequencies."""

    t: FloatArray
    duration: float
    pace: float
    rate: float = 0.0
    top: float = 0.0
    even: bool = False
    grid: FrequencyGrid | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Sampling:
    """Which waves show in a recording sampled at ``u`` (n,) meshes and, where known, ``timed``.

    ``spacing``, ``span`` and hunting ``period`` in meshes, ``nyquist`` in cycles per mesh; ``order_grid`` with ``fine``
    places per order; ``orders`` that teeth and shafts make, ``known`` their places on the grid, which are ``searched``,
    and the places ``apart`` that the record tells from one another; ``averaged``: samples are means over neighbours.
    """

    u: FloatArray
    z_1: int
    z_2: int
    spacing: float
    nyquist: float
    span: float
    period: float
    fine: int
    order_grid: FrequencyGrid
    orders: KnownOrders
    known: IntArray
    searched: BoolArray
    apart: IntArray
    timed: Timed | None
    averaged: bool = False

    @property
    def time_grid(self) -> FrequencyGrid | None:
        """Frequencies in Hz that are looked for; ``None`` where time is not known or does not pass."""
        return None if self.timed is None else self.timed.grid

    @property
    def pace(self) -> float:
        """Mean s per mesh; 0 where time is not known."""
        return 0.0 if self.timed is None else self.timed.pace

    @property
    def rate(self) -> float:
        """Sampling rate in Hz; 0 where it is not known."""
        return 0.0 if self.timed is None else self.timed.rate

    @cached_property
    def wave_sums(self) -> WaveSums:
        """Sums over the waves of all known orders that are searched."""
        return WaveSums(self.u, step=1.0 / self.period, place=self.orders.place[self.searched])

    def over(self, domain: Domain) -> tuple[FloatArray, FrequencyGrid, float, float]:
        """Samples (n,) in angle or time, their grid, their span, and cycles per mesh in one of the grid's unit."""
        if domain == "order":
            return self.u, self.order_grid, self.span, 1.0
        assert self.timed is not None
        assert self.timed.grid is not None
        return self.timed.t, self.timed.grid, self.timed.duration, self.timed.pace

    def strays(self, domain: Domain) -> float | None:
        """Sampling rate over angle or time where samples stray about an even row, so that a wave above half of it is
        told from its images; ``None`` where they come evenly or anyhow, are means, or are very many."""
        return self._over_angle if domain == "order" else self._over_time

    def top(self, domain: Domain) -> float:
        """The highest frequency that is looked for over angle or time."""
        return self.nyquist if domain == "order" or self.timed is None else self.timed.top

    @cached_property
    def _over_angle(self) -> float | None:
        return None if self.averaged or self.u.size > UNEVEN_UP_TO else regular_rate(self.u)

    @cached_property
    def _over_time(self) -> float | None:
        timed = self.timed
        few = timed is not None and not self.averaged and timed.t.size <= UNEVEN_UP_TO
        return regular_rate(timed.t) if timed is not None and few else None

    def image(self, domain: Domain, frequency: FloatArray) -> FloatArray:
        """The frequencies (k,) below half the sampling rate that even samples in time show alike, in the same unit."""
        if domain == "order" or self.rate == 0.0:
            return frequency
        return np.asarray(np.abs(frequency - self.rate * np.rint(frequency / self.rate)))

    def alike(self, hz: float) -> float:
        """The frequency in Hz that even samples in time show alike: of a wave above half the sampling rate its image
        below, of one below the next above."""
        return float(self.image("time", np.array([hz]))[0]) if hz > 0.5 * self.rate else self.rate - hz

    def rest_at(self, domain: Domain, frequency: FloatArray, noise: Noise) -> tuple[FloatArray, FloatArray]:
        """Whitened spectrum at ``frequency`` (k,) over angle or time, and the number of lines it was estimated from."""
        rest, count = noise.rest_at(self.image(domain, frequency) * self.over(domain)[3])
        if domain == "time":
            # Uneven times spread noise of all frequencies over those above half the rate.
            rest = np.where(frequency > 0.5 * self.rate, np.maximum(rest, 1.0), rest)
        return rest, count

    def per_mesh(self, peak: Peak) -> float:
        """Frequency of a wave in cycles per mesh, at the mean speed where it is fixed in time."""
        return peak.frequency * (self.pace if peak.domain == "time" else 1.0)

    def lines_from(self, peak: Peak, frequency: float) -> float:
        """Independent lines between a wave, or its image below half the sampling rate, and a ``frequency`` in cycles
        per mesh."""
        own: FloatArray = np.array([peak.frequency])
        both = np.append(own, self.image(peak.domain, own)) * self.over(peak.domain)[3]
        return self.span * float(np.min(np.abs(both - frequency)))

    def own(self, frequency: FloatArray) -> BoolArray:
        """Whether waves (k,), in cycles per mesh, may be orders of the shafts. Sums and differences are none: what they
        have is little, and where it is more, it has been found as theirs."""
        places, known = frequency * self.period, np.sort(self.orders.whole)
        near = np.clip(np.searchsorted(known, places), 1, known.size - 1)
        off = np.minimum(np.abs(places - known[near - 1]), np.abs(places - known[near]))
        return np.asarray(off * self.span / self.period < FOOT_OF_PEAK_LINES)

    def repeats(self, frequency: FloatArray) -> BoolArray:
        """Whether waves (k,), in cycles per mesh, repeat with the pair as far as so long a record shows."""
        return np.asarray(self._may_repeat(frequency) & (self.span / self.period > WHOLE_TURN))

    def strange(self, frequency: FloatArray) -> BoolArray:
        """Whether waves (k,), in cycles per mesh, do not repeat with the pair, as no error of a simulation does."""
        return np.asarray(~self._may_repeat(frequency) & (self.span / self.period > WHOLE_TURN))

    def _may_repeat(self, frequency: FloatArray) -> BoolArray:
        places = frequency * self.period
        return np.asarray(np.abs(places - np.rint(places)) * self.span / self.period < REPEATS)


def sampling_of(*, u: FloatArray, time: FloatArray | None, z_1: int, z_2: int, averaged: bool = False) -> Sampling:
    """What waves show in a recording sampled at ``u`` (n,) meshes and, where known, ``time`` (n,) s; ``averaged``:
    samples are means over neighbours."""
    spacing = spacing_of(u)
    nyquist = 0.5 / spacing
    span = float(u[-1] - u[0]) + spacing
    period = float(math.lcm(z_1, z_2))
    # Every order of either shaft falls on the grid, two places or more per independent line.
    fine = max(1, math.ceil(2.0 * span / period))
    orders = known_orders(z_1, z_2, nyquist=nyquist, slowest=SLOWEST / span)
    apart = orders.told_apart(span)
    apart &= orders.told_by(u)
    known: IntArray = orders.place * fine
    return Sampling(
        u=u,
        z_1=z_1,
        z_2=z_2,
        spacing=spacing,
        nyquist=nyquist,
        span=span,
        period=period,
        fine=fine,
        order_grid=FrequencyGrid(u, step=1.0 / (period * fine), count=int(nyquist * period * fine)),
        orders=orders,
        known=known,
        searched=apart & (orders.frequency > SLOWEST / span),
        apart=known[apart],
        timed=None if time is None else _timed(time, span=span, averaged=averaged),
        averaged=averaged,
    )


def _shortest_gap(step: FloatArray, middle: float) -> float:
    """Step in s from which on one of these ``step`` (n,) about a ``middle`` one is a gap: steps scatter where samples
    come a little early or late, and a mean without the longest of them would be too short."""
    scatter = 1.4826 * float(np.median(np.abs(step - middle)))
    return max(GAP_MIDDLE_STEPS * middle, middle + GAP_SIGMAS * scatter)


def _timed(time: FloatArray, *, span: float, averaged: bool) -> Timed:
    """The same samples in time; there is no grid where no time passes."""
    step = np.diff(time)
    dt = spacing_of(time)
    duration = float(time[-1] - time[0]) + dt
    if dt <= 0.0:
        return Timed(t=time, duration=duration, pace=duration / span)
    # Uneven sampling has no middle step to go by, and gaps belong to no step.
    rate = 1.0 / float(np.mean(step[step < _shortest_gap(step, dt)]))
    # Even samples, and means over neighbours, hold nothing above half their rate.
    even = even_in_time(time) is not None
    tells = time.size <= UNEVEN_UP_TO and not averaged and not even
    top = (RATES if tells else 0.5) * rate
    grid = FrequencyGrid(time, step=0.5 / duration, count=int(top * 2.0 * duration))
    return Timed(
        t=time, duration=duration, pace=duration / span, rate=rate, top=top, even=even and not averaged, grid=grid
    )
