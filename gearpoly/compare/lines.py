"""Waves in a whitened residual: shaft and mesh orders, orders that are no integer, and frequencies fixed in time.

A wave fixed to a shaft is one line over the shaft's angle, however unsteadily it turns, and a smear over time; hum is
the other way round. Both spectra are searched, and the sharper line says which it is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from gearpoly.compare.even import GAP, even_in_time
from gearpoly.compare.families import SHARES, log_false_any
from gearpoly.compare.noise import Noise, spacing_of
from gearpoly.compare.orders import known_orders
from gearpoly.compare.pieces import PIECE, pieces
from gearpoly.compare.regression import WaveSums
from gearpoly.compare.spectrum import Grid, placed_to
from gearpoly.units import BoolArray, FloatArray, IntArray

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

MAINS = (50.0, 60.0)
"""Hz at whose multiples a wave that may as well be fixed in time as in angle is hum; elsewhere something turns."""

MAINS_STRAYS, HIGHEST_HUM = 0.002, 20
"""Part by which a mains frequency strays, and the highest multiple of it that is taken for hum: beyond, what strays so
far is near some multiple anyway."""

HALF_WAY = 2.0
"""Independent lines about half the sampling rate in which nothing is looked for over time."""

TWICE = 100_000
"""Samples up to which hum is looked for up to the sampling rate, not half of it: times that are a little uneven tell a
wave above from its image below."""

WHOLE_TURN, REPEATS = 1.5, 0.4
"""Hunting cycles from which on frequencies that repeat with the pair stand apart from others, and the independent lines
within which a wave of any frequency may be one of them."""

TIE = 6.0
"""Difference in likelihood (twice its log) below which a wave may as well be fixed in time as in angle: odds of 20."""


@dataclass(frozen=True, kw_only=True)
class Peak:
    """A wave found: ``frequency`` in cycles per mesh, or in Hz; ``gain`` twice the log likelihood that it brings;
    ``log_false`` log of the expected number of such finds in noise; ``known``: it is an integer order of a shaft.
    ``std`` of the frequency, in its unit; ``rival`` the gain of the best wave of the other kind at its place, ``image``
    that of the wave in time which the same samples show where the sampling is even. ``faint``: it was found together
    with others only, as ``harmonic`` of a train of pulses (0: of none); ``leads``: it is the strongest of them.
    ``few``: the order of a shaft of which the recording holds too few turns to tell it from a drift (0: any other)."""

    domain: Domain
    frequency: float
    std: float
    gain: float
    log_false: float
    known: bool
    rival: float = 0.0
    image: float = 0.0
    harmonic: int = 0
    faint: bool = False
    leads: bool = False
    few: int = 0

    @property
    def hum(self) -> bool:
        """Whether its frequency is a multiple of the mains'."""
        off = MAINS_STRAYS * self.frequency + 3.0 * self.std
        return self.domain == "time" and any(
            abs(self.frequency - mains * multiple) < off
            for mains in MAINS
            if 1 <= (multiple := round(self.frequency / mains)) <= HIGHEST_HUM
        )


class LineSearch:
    """The search for waves in one recording, sampled at ``u`` (n,) meshes and, where known, ``time`` (n,) s."""

    def __init__(self, *, u: FloatArray, time: FloatArray | None, z_1: int, z_2: int, averaged: bool = False) -> None:
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
        self.pace = self.rate = 0.0
        if time is not None:
            step = np.diff(time)
            dt = spacing_of(time)
            self.duration = float(time[-1] - time[0]) + dt
            self.pace = self.duration / self.span
            if dt > 0.0:
                # Uneven sampling has no middle step to go by, and gaps belong to no step.
                self.rate = 1.0 / float(np.mean(step[step < GAP * dt]))
                # Even samples, and means over neighbours, hold nothing above half their rate.
                tells = u.size <= TWICE and not averaged and even_in_time(time) is None
                self.top = (1.0 if tells else 0.5) * self.rate
                self.time_grid = Grid(time, step=0.5 / self.duration, count=int(self.top * 2.0 * self.duration))
        self.orders = known_orders(z_1, z_2, nyquist=self.nyquist, slowest=SLOWEST / self.span)
        self.known: IntArray = self.orders.place * self.fine
        apart = self.orders.told_apart(self.span)
        apart &= self.orders.told_by(u)
        self.searched = apart & (self.orders.frequency > SLOWEST / self.span)
        self._snaps = self.known[apart]

    @cached_property
    def wave_sums(self) -> WaveSums:
        """Sums over the waves of all known orders that are searched."""
        return WaveSums(self.u, step=1.0 / self.period, place=self.orders.place[self.searched])

    def lines_from(self, peak: Peak, frequency: float) -> float:
        """Independent lines between a wave, or its image below half the sampling rate, and a ``frequency`` in cycles
        per mesh."""
        own: FloatArray = np.array([peak.frequency])
        both = np.append(own, self.image(peak.domain, own)) * self.over(peak.domain)[3]
        return self.span * float(np.min(np.abs(both - frequency)))

    def image(self, domain: Domain, frequency: FloatArray) -> FloatArray:
        """The frequencies (k,) below half the sampling rate that even samples in time show alike, in the same unit."""
        return np.minimum(frequency, self.rate - frequency) if domain == "time" else frequency

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

    def peaks(
        self, white: FloatArray, noise: Noise, *, recordings: int = 1, most: int = 12, least: float = 0.0
    ) -> list[Peak]:
        """Significant waves of any frequency in a whitened residual (n,), strongest first, where ``recordings`` are
        searched alike. Waves below ``least`` cycles per mesh are placed to the nearest line only."""
        lines = self.nyquist * self.span * recordings / SHARES.between
        found = self._blind("order", white, noise, lines=lines, most=most, least=least)
        if self.time_grid is not None:
            lines = self.top * self.duration * recordings / SHARES.time
            found += self._blind("time", white, noise, lines=lines, most=most, least=least)
        return self._sorted_out(found)

    def _blind(
        self, domain: Domain, white: FloatArray, noise: Noise, *, lines: float, most: int, least: float
    ) -> list[Peak]:
        """The strongest waves over angle or over time, ``lines`` independent ones sharing the chance of a false
        find."""
        x, grid, span, per_mesh = self.over(domain)
        z = grid.power(white)
        held, false = [], []
        for here in pieces(z.size):
            frequency: FloatArray = grid.step * np.arange(here.start, here.stop, dtype=np.float64)
            rest, count = self.rest_at(domain, frequency, noise)
            z[here] /= white.size * rest
            log_false = log_false_any(z[here], count, lines=lines)
            seen = self.image(domain, frequency) > SLOWEST_BLIND / span
            if domain == "time":
                # Half way a wave and its image are one, and even samples see one of its two phases only.
                seen &= np.abs(frequency - 0.5 * self.rate) > HALF_WAY / span
            top = np.flatnonzero((log_false < 0.0) & seen)
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
                best, _ = refined(x, white, best, span)
                # Summed anew: angle and time differ by units of gains of ten thousand, as a grid's interpolation errs.
                there, _ = self.rest_at(domain, np.array([best]), noise)
                sums = (np.sum(white[k] * np.exp((-2j * np.pi * best) * x[k])) for k in pieces(x.size))
                here_z = float(abs(sum(sums)) ** 2) / (white.size * float(there[0]))
            std = placed_to(2.0 * here_z, span=span)
            peak = Peak(domain=domain, frequency=best, std=std, gain=2.0 * here_z, log_false=log_p, known=False)
            told = self._told_from_image(peak, white)
            if told is not None and all(abs(told.frequency - p.frequency) * span >= APART for p in out):
                out.append(told)
        return out

    def _told_from_image(self, peak: Peak, white: FloatArray) -> Peak | None:
        """A peak of the whitened residual (n,) beside its image about half the sampling rate; ``None`` for a wave above
        it that explains hardly more than its image below."""
        image = self.rate - peak.frequency
        if peak.domain == "order" or self.t is None or not 0.0 < image < self.top:
            return peak
        image, _ = refined(self.t, white, image, self.duration)
        there, here = (abs(np.sum(white * np.exp(-2j * np.pi * f * self.t))) ** 2 for f in (image, peak.frequency))
        gain = peak.gain * float(there / here)
        peak = replace(peak, image=gain)
        # A wave above half the sampling rate has to explain more than its image below, which few recordings show.
        return peak if not self._fast(peak) or peak.gain > gain + TIE else None

    def over(self, domain: Domain) -> tuple[FloatArray, Grid, float, float]:
        """Samples (n,) in angle or time, their grid, their span, and cycles per mesh in one of the grid's unit."""
        if domain == "order":
            return self.u, self.order_grid, self.span, 1.0
        assert self.t is not None
        assert self.time_grid is not None
        return self.t, self.time_grid, self.duration, self.pace

    def own(self, frequency: FloatArray) -> BoolArray:
        """Whether waves (k,), in cycles per mesh, may be orders of the shafts. Sums and differences are none: what they
        have is little, and where it is more, it has been found as theirs."""
        places, known = frequency * self.period, np.sort(self.orders.whole)
        near = np.clip(np.searchsorted(known, places), 1, known.size - 1)
        off = np.minimum(np.abs(places - known[near - 1]), np.abs(places - known[near]))
        return np.asarray(off * self.span / self.period < APART)

    def repeats(self, frequency: FloatArray) -> BoolArray:
        """Whether waves (k,), in cycles per mesh, repeat with the pair as far as so long a record shows."""
        return np.asarray(self._may_repeat(frequency) & (self.span / self.period > WHOLE_TURN))

    def strange(self, frequency: FloatArray) -> BoolArray:
        """Whether waves (k,), in cycles per mesh, do not repeat with the pair, as no error of a simulation does."""
        return np.asarray(~self._may_repeat(frequency) & (self.span / self.period > WHOLE_TURN))

    def _may_repeat(self, frequency: FloatArray) -> BoolArray:
        places = frequency * self.period
        return np.asarray(np.abs(places - np.rint(places)) * self.span / self.period < REPEATS)

    def snapped(self, frequency: float, std: float) -> float | None:
        """The integer order (or low sum of both shafts) in cycles per mesh that ``frequency`` is, if it is one."""
        place = frequency * self.period * self.fine
        near = int(self._snaps[np.argmin(np.abs(self._snaps - place))]) if self._snaps.size else -1
        within = max(SNAP / self.span, 3.0 * std)
        exact = near / (self.period * self.fine)
        return exact if near > 0 and abs(exact - frequency) < within else None

    def _sorted_out(self, found: list[Peak]) -> list[Peak]:
        """One peak per place, the sharper of angle and time; what is another's foot left out."""
        out: list[Peak] = []
        for peak in sorted(found, key=lambda p: (-p.gain, not p.known)):
            here = self.per_mesh(peak)
            rival, foot = False, False
            for j, kept in enumerate(out):
                there = self.per_mesh(kept)
                apart = abs(here - there) * self.span
                if self._fast(peak) or self._fast(kept):
                    image = abs(self.rate * self.pace - here - there) * self.span
                    if image < FOOT:
                        foot = True
                        break
                if apart < APART or (peak.gain < 0.3 * kept.gain and apart < FOOT and peak.domain != kept.domain):
                    foot = True
                    if kept.domain != peak.domain and apart < APART and peak.gain > kept.rival:
                        rival = True
                        out[j] = self.likelier(kept, peak)
                    break
            if not foot and not rival:
                out.append(peak)
        final = []
        for peak in out:
            if peak.domain == "order" and not peak.known:
                exact = self.snapped(peak.frequency, peak.std)
                if exact is not None:
                    peak = replace(peak, frequency=exact, std=0.0, known=True)
            final.append(peak)
        return final

    def likelier(self, best: Peak, other: Peak) -> Peak:
        """Of a wave over angle and the same over time the one to report: that which explains more, and of equals that
        over angle, since something turns; but hum, and what is slower than any shaft of the pair, over time."""
        if other.gain > best.gain:
            best, other = other, best
        timely = best.hum or other.hum or self.per_mesh(best) * max(self.z_1, self.z_2) < 1.0
        if best.gain - other.gain <= TIE and (other.domain == "time") == timely:
            best, other = other, best
        return replace(best, rival=other.gain, image=max(best.image, other.image))

    def _fast(self, peak: Peak) -> bool:
        """Whether a wave in time is faster than half the sampling rate."""
        return peak.domain == "time" and peak.frequency > 0.5 * self.rate


def refined(x: FloatArray, white: FloatArray, frequency: float, span: float) -> tuple[float, float]:
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
    start = off = power = 0.0
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
