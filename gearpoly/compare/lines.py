"""Waves in a whitened residual: shaft and mesh orders, orders that are no integer, and frequencies fixed in time.

A wave fixed to a shaft is one line over the shaft's angle, however unsteadily it turns, and a smear over time; hum is
the other way round. Both spectra are searched, and the sharper line says which it is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from gearpoly.compare.families import SHARES, log_false_any
from gearpoly.compare.noise import Noise, spacing_of
from gearpoly.compare.regression import WaveSums
from gearpoly.compare.spectrum import Grid
from gearpoly.units import FloatArray, IntArray

Domain = Literal["order", "time"]

APART = 1.5
"""Independent lines from a stronger peak within which a peak is its foot, not its own; what is really there shows when
the stronger one is taken off."""

SLOWEST = 1.75
"""Turns of the record below which a wave cannot be told from drift, whose curves were taken off."""

SLOWEST_BLIND = 6.0
"""The same for waves of no known order: fewer turns are what wandering noise does too."""

SNAP = 0.15
"""Independent lines by which a peak may miss an integer order and still be it, beside three standard errors: what a
neighbour's foot can push it."""

TIE = 6.0
"""Difference in likelihood (twice its log) below which a wave may as well be fixed in time as in angle: odds of 20."""


@dataclass(frozen=True, kw_only=True)
class Peak:
    """A wave found: ``frequency`` in cycles per mesh, or in Hz; ``gain`` twice the log likelihood that it brings;
    ``log_false`` log of the expected number of such finds in noise; ``known``: it is an integer order of a shaft.
    ``std`` of the frequency; ``rival`` the gain of the best wave of the other kind at its place."""

    domain: Domain
    frequency: float
    std: float
    gain: float
    log_false: float
    known: bool
    rival: float = 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class KnownOrders:
    """Integer orders of both shafts below the sampling's limit, and the lowest sums and differences of both shafts.

    ``place`` (k,) frequencies in cycles per mesh times lcm(z_1, z_2): first ``first`` orders of the driving shaft
    from 1 on, then those of the driven shaft that are none of the driving, then the sums and differences.
    """

    z_1: int
    z_2: int
    first: int
    second: IntArray
    place: IntArray

    @property
    def period(self) -> int:
        """Meshes in a hunting cycle."""
        return math.lcm(self.z_1, self.z_2)

    @property
    def frequency(self) -> FloatArray:
        """Frequencies (k,) in cycles per mesh."""
        return self.place / float(self.period)


def known_orders(z_1: int, z_2: int, *, nyquist: float, slowest: float) -> KnownOrders:
    """The orders between ``slowest`` and ``nyquist`` cycles per mesh (the slower ones stand in the list all the
    same)."""
    period = math.lcm(z_1, z_2)
    one, two = period // z_1, period // z_2
    top = max(int(nyquist * period), one + 1)
    driving = np.arange(one, top, one)
    driven = np.arange(two, top, two)
    driven = driven[driven % one != 0]
    both = set(driving.tolist()) | set(driven.tolist())
    mixed = {abs(i * one + j * two) for i in (1, 2) for j in (-2, -1, 1, 2)}
    rest = np.array(sorted(k for k in mixed - both if slowest * period < k < top), dtype=np.int64)
    return KnownOrders(
        z_1=z_1, z_2=z_2, first=driving.size, second=driven // two, place=np.concatenate([driving, driven, rest])
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Spectra:
    """One recording's whitened spectra: over orders (``z_order``) and over time (``z_time``), each in units of its
    local noise, at multiples of the grids' steps; ``count`` lines the noise rests on."""

    order: Grid
    z_order: FloatArray
    count_order: FloatArray
    time: Grid | None
    z_time: FloatArray | None
    count_time: FloatArray | None


class LineSearch:
    """The search for waves in one recording, sampled at ``u`` (n,) meshes and, where known, ``time`` (n,) s."""

    def __init__(self, *, u: FloatArray, time: FloatArray | None, z_1: int, z_2: int) -> None:
        self.u = u
        self.t = time
        self.z_1, self.z_2 = z_1, z_2
        self.spacing = spacing_of(u)
        self.nyquist = 0.5 / self.spacing
        self.span = float(u[-1] - u[0]) + self.spacing
        self.period = float(math.lcm(z_1, z_2))
        # Every order of either shaft falls on the grid, two places or more per independent line.
        self.fine = max(1, math.ceil(2.0 * self.span / self.period))
        self.order_grid = Grid(
            u, step=1.0 / (self.period * self.fine), count=int(self.nyquist * self.period * self.fine)
        )
        self.time_grid: Grid | None = None
        self.dt = 0.0
        if time is not None:
            self.dt = float(np.median(np.diff(time)))
            self.duration = float(time[-1] - time[0]) + self.dt
            if self.dt > 0.0:
                count = int(0.5 / self.dt * 2.0 * self.duration)
                self.time_grid = Grid(time, step=0.5 / self.duration, count=count)
        self.orders = known_orders(z_1, z_2, nyquist=self.nyquist, slowest=SLOWEST / self.span)
        self.known: IntArray = self.orders.place * self.fine
        self.searched = self.orders.frequency > SLOWEST / self.span

    @cached_property
    def wave_sums(self) -> WaveSums:
        """Sums over the waves of all known orders."""
        return WaveSums(self.u, step=1.0 / self.period, place=self.orders.place)

    def per_mesh(self, peak: Peak) -> float:
        """Frequency of a wave in cycles per mesh, at the mean speed where it is fixed in time."""
        return peak.frequency * (self.duration / self.span if peak.domain == "time" else 1.0)

    def _z(self, grid: Grid, white: FloatArray, noise: Noise, per_mesh: float) -> tuple[FloatArray, FloatArray]:
        frequency = np.asarray(np.arange(grid.count) * (grid.step * per_mesh), dtype=np.float64)
        rest, count = noise.rest_at(frequency)
        return np.abs(grid.transform(white)) ** 2 / (white.size * rest), count

    def spectra(self, white: FloatArray, noise: Noise) -> Spectra:
        """Spectra of a whitened residual (n,)."""
        z, count = self._z(self.order_grid, white, noise, 1.0)
        if self.time_grid is None:
            return Spectra(order=self.order_grid, z_order=z, count_order=count, time=None, z_time=None, count_time=None)
        z_time, count_time = self._z(self.time_grid, white, noise, self.dt / self.spacing)
        return Spectra(
            order=self.order_grid, z_order=z, count_order=count,
            time=self.time_grid, z_time=z_time, count_time=count_time,
        )  # fmt: skip

    def peaks(self, white: FloatArray, noise: Noise, *, recordings: int = 1, most: int = 12) -> list[Peak]:
        """Significant waves of any frequency, strongest first, where ``recordings`` are searched alike."""
        s = self.spectra(white, noise)
        found: list[Peak] = []
        frequency: FloatArray = np.asarray(np.arange(s.z_order.size) * self.order_grid.step, dtype=np.float64)
        independent = self.nyquist * self.span
        any_false = log_false_any(s.z_order, s.count_order, lines=independent * recordings / SHARES.between)
        found += self._blind("order", self.u, white, frequency, s.z_order, any_false, self.span, most)
        if s.z_time is not None and self.time_grid is not None and s.count_time is not None:
            hertz: FloatArray = np.asarray(np.arange(s.z_time.size) * self.time_grid.step, dtype=np.float64)
            lines = 0.5 / self.dt * self.duration
            any_false = log_false_any(s.z_time, s.count_time, lines=lines * recordings / SHARES.time)
            assert self.t is not None
            found += self._blind("time", self.t, white, hertz, s.z_time, any_false, self.duration, most)
        return self._sorted_out(found)

    def _blind(
        self, domain: Domain, x: FloatArray, white: FloatArray, frequency: FloatArray, z: FloatArray,
        log_false: FloatArray, span: float, most: int,
    ) -> list[Peak]:  # fmt: skip
        top = (log_false < 0.0) & (frequency > SLOWEST_BLIND / span)
        top[1:] &= z[1:] >= z[:-1]
        top[:-1] &= z[:-1] >= z[1:]
        places = np.flatnonzero(top)
        places = places[np.argsort(-z[places])][: 3 * most]
        out: list[Peak] = []
        for place in places:
            if any(abs(frequency[place] - p.frequency) * span < APART for p in out):
                continue
            if len(out) == most or z[place] < 0.02 * z[places[0]]:
                break
            best, higher = _refined(x, white, float(frequency[place]), span)
            here = float(z[place]) * max(higher, 1.0)
            # Half a turn of phase over the record costs the line; a wave of z is placed to sqrt(12)/(2 pi sqrt(2 z)).
            std = 0.551 / span / math.sqrt(2.0 * here)
            out.append(
                Peak(
                    domain=domain, frequency=best, std=std, gain=2.0 * here,
                    log_false=float(log_false[place]), known=False,
                )
            )  # fmt: skip
        return out

    def snapped(self, frequency: float, std: float) -> float | None:
        """The integer order (or low sum of both shafts) in cycles per mesh that ``frequency`` is, if it is one."""
        place = frequency * self.period * self.fine
        near = int(self.known[np.argmin(np.abs(self.known - place))]) if self.known.size else -1
        within = max(SNAP / self.span, 3.0 * std)
        exact = near / (self.period * self.fine)
        return exact if near > 0 and abs(exact - frequency) < within else None

    def _sorted_out(self, found: list[Peak]) -> list[Peak]:
        """One peak per place, the sharper of angle and time; what is another's foot left out."""
        scale = self.dt / self.spacing if self.time_grid is not None else 1.0
        out: list[Peak] = []
        for peak in sorted(found, key=lambda p: (-p.gain, not p.known)):
            here = peak.frequency if peak.domain == "order" else peak.frequency * scale
            rival, foot = False, False
            for j, kept in enumerate(out):
                there = kept.frequency if kept.domain == "order" else kept.frequency * scale
                apart = abs(here - there) * self.span
                if apart < APART or (peak.gain < 0.3 * kept.gain and apart < 30.0 and peak.domain != kept.domain):
                    foot = True
                    if kept.domain != peak.domain and apart < APART and peak.gain > kept.rival:
                        rival = True
                        out[j] = _with_rival(kept, peak.gain)
                    break
            if not foot and not rival:
                out.append(peak)
        final = []
        for peak in out:
            if peak.domain == "order" and not peak.known:
                exact = self.snapped(peak.frequency, peak.std)
                if exact is not None:
                    peak = Peak(
                        domain="order", frequency=exact, std=0.0, gain=peak.gain, log_false=peak.log_false,
                        known=True, rival=peak.rival,
                    )  # fmt: skip
            final.append(peak)
        return final


def _with_rival(peak: Peak, gain: float) -> Peak:
    return Peak(
        domain=peak.domain, frequency=peak.frequency, std=peak.std, gain=peak.gain, log_false=peak.log_false,
        known=peak.known, rival=gain,
    )  # fmt: skip


def _refined(x: FloatArray, white: FloatArray, frequency: float, span: float) -> tuple[float, float]:
    """Frequency of the largest sum near ``frequency``, and how much larger (in power) than at the start.

    Newton on the log power; the middle of the record as origin keeps the steps small.
    """
    y = x - 0.5 * (x[0] + x[-1])
    start = 0.0
    f = frequency
    power = 0.0
    for step in range(4):
        wave = white * np.exp(-2j * np.pi * f * y)
        total = complex(np.sum(wave))
        first = complex(np.sum(y * wave)) * (-2j * np.pi)
        second = complex(np.sum(y * y * wave)) * (-2j * np.pi) ** 2
        power = abs(total) ** 2
        if step == 0:
            start = power
        slope = 2.0 * (total.conjugate() * first).real
        bend = 2.0 * (abs(first) ** 2 + (total.conjugate() * second).real)
        if bend >= 0.0:
            break
        # Not further than a quarter of a line at once: beyond, the parabola is no guide.
        f += float(np.clip(-slope / bend, -0.25 / span, 0.25 / span))
    if abs(f - frequency) > 0.75 / span:
        return frequency, 1.0
    return f, power / start if start > 0.0 else 1.0
