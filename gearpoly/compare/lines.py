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
from gearpoly.compare.pieces import PIECE, pieces
from gearpoly.compare.regression import WaveSums
from gearpoly.compare.spectrum import Grid
from gearpoly.units import FloatArray, IntArray

Domain = Literal["order", "time"]

APART = 1.5
"""Independent lines from a stronger peak within which a peak is its foot, not its own; what is really there shows when
the stronger one is taken off."""

FOOT = 30.0
"""Independent lines about a wave in which its smear over the other of angle and time may stand."""

SLOWEST = 1.75
"""Turns of the record below which a wave cannot be told from drift, whose curves were taken off."""

SLOWEST_BLIND = 6.0
"""The same for waves of no known order: fewer turns are what wandering noise does too."""

SNAP = 0.15
"""Independent lines by which a peak may miss an integer order and still be it, beside three standard errors: what a
neighbour's foot can push it."""

STRETCHES = 2048
"""Stretches of a record whose sums and moments stand for it where a wave is placed: over half of one a wave that is a
line off turns by 0.0015 rad, whose third power is left out."""

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

    def peaks(
        self, white: FloatArray, noise: Noise, *, recordings: int = 1, most: int = 12, least: float = 0.0
    ) -> list[Peak]:
        """Significant waves of any frequency in a whitened residual (n,), strongest first, where ``recordings`` are
        searched alike. Waves below ``least`` cycles per mesh are placed to the nearest line only."""
        lines = self.nyquist * self.span * recordings / SHARES.between
        found = self._blind("order", white, noise, lines=lines, most=most, least=least)
        if self.time_grid is not None:
            lines = 0.5 / self.dt * self.duration * recordings / SHARES.time
            found += self._blind("time", white, noise, lines=lines, most=most, least=least)
        return self._sorted_out(found)

    def _blind(
        self, domain: Domain, white: FloatArray, noise: Noise, *, lines: float, most: int, least: float
    ) -> list[Peak]:
        """The strongest waves over angle or over time, ``lines`` independent ones sharing the chance of a false
        find."""
        x, grid, span, per_mesh = self.u, self.order_grid, self.span, 1.0
        if domain == "time":
            assert self.t is not None
            assert self.time_grid is not None
            x, grid, span, per_mesh = self.t, self.time_grid, self.duration, self.dt / self.spacing
        z = grid.power(white)
        held, false = [], []
        for here in pieces(z.size):
            frequency = np.arange(here.start, here.stop) * grid.step
            rest, count = noise.rest_at(frequency * per_mesh)
            z[here] /= white.size * rest
            log_false = log_false_any(z[here], count, lines=lines)
            top = np.flatnonzero((log_false < 0.0) & (frequency > SLOWEST_BLIND / span))
            held.append(here.start + top)
            false.append(log_false[top])
        places, log_false = np.concatenate(held), np.concatenate(false)
        peaked = (z[places] >= z[places - 1]) & (z[places] >= z[np.minimum(places + 1, z.size - 1)])
        places, log_false = places[peaked], log_false[peaked]
        order = np.argsort(-z[places])[: 3 * most]
        out: list[Peak] = []
        for place, log_p in zip(places[order].tolist(), log_false[order].tolist(), strict=True):
            best, here_z = place * grid.step, float(z[place])
            if any(abs(best - p.frequency) * span < APART for p in out):
                continue
            if len(out) == most or here_z < 0.02 * z[places[order[0]]]:
                break
            if best * per_mesh > least - FOOT / self.span:
                best, higher = _refined(x, white, best, span)
                here_z *= max(higher, 1.0)
            # Half a turn of phase over the record costs the line; a wave of z is placed to sqrt(12)/(2 pi sqrt(2 z)).
            std = 0.551 / span / math.sqrt(2.0 * here_z)
            out.append(
                Peak(domain=domain, frequency=best, std=std, gain=2.0 * here_z, log_false=log_p, known=False)
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
                if apart < APART or (peak.gain < 0.3 * kept.gain and apart < FOOT and peak.domain != kept.domain):
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
    # The frequency moves by less than a line, so neighbours stay nearly in step: sums over them and their first moments
    # stand for them.
    group = max(1, x.size // STRETCHES)
    middle = 0.5 * (x[0] + x[-1])
    held = []
    for here in pieces(x.size, size=group * max(1, PIECE // group)):
        y = x[here] - middle
        begin = np.arange(0, y.size, group)
        wave = white[here] * np.exp((-2j * np.pi * frequency) * y)
        size = np.diff(begin, append=y.size)
        mean = np.add.reduceat(y, begin) / size
        y = y - np.repeat(mean, size)
        held.append([mean, *(np.add.reduceat(wave * y**k, begin) for k in (0, 1, 2))])
    along, sums, moments, squares = (np.concatenate(part) for part in zip(*held, strict=True))
    start = 0.0
    off = 0.0
    power = 0.0
    for step in range(4):
        turn = -2j * np.pi * off
        turned = np.exp(turn * along)
        wave = turned * (sums + turn * (moments + 0.5 * turn * squares))
        beside = turned * (moments + turn * squares)
        total = complex(np.sum(wave))
        first = complex(np.sum(along * wave + beside)) * (-2j * np.pi)
        second = complex(np.sum(along * (along * wave + 2.0 * beside) + turned * squares)) * (-2j * np.pi) ** 2
        power = abs(total) ** 2
        if step == 0:
            start = power
        slope = 2.0 * (total.conjugate() * first).real
        bend = 2.0 * (abs(first) ** 2 + (total.conjugate() * second).real)
        if bend >= 0.0:
            break
        # Not further than a quarter of a line at once: beyond, the parabola is no guide.
        off += float(np.clip(-slope / bend, -0.25 / span, 0.25 / span))
    if abs(off) > 0.75 / span:
        return frequency, 1.0
    return frequency + off, power / start if start > 0.0 else 1.0
