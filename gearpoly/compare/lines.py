"""Waves in a whitened residual: shaft and mesh orders, orders that are no integer, and frequencies fixed in time.

A wave fixed to a shaft is one line over the shaft's angle, however unsteadily it turns, and a smear over time; hum is
the other way round. Both spectra are searched, and the sharper line says which it is.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearpoly.compare.even import aliases
from gearpoly.compare.families import SHARES, log_false_any
from gearpoly.compare.noise import Noise
from gearpoly.compare.peak import Domain, Peak, is_hum
from gearpoly.compare.pieces import pieces
from gearpoly.compare.sampling import FOOT_OF_PEAK_LINES, Sampling
from gearpoly.compare.sinusoids import line_power, refined
from gearpoly.compare.spectrum import placed_to
from gearpoly.compare.unfold import FOLD_ODDS, unfolded
from gearpoly.units import FloatArray

FOOT = 30.0
"""Independent lines about a wave in which its smear over the other of angle and time may stand."""

SLOWEST_BLIND = 6.0
"""The same for waves of no known order: fewer turns are what wandering noise does too."""

SNAP = 0.15
"""Independent lines by which a peak may miss an integer order and still be it, beside three standard errors: what a
neighbour's foot can push it."""

HALF_WAY_LINES = 2.0
"""Independent lines about half the sampling rate, and its odd multiples, in which nothing is looked for over time."""

TIE = 6.0
"""Difference in likelihood (twice its log) below which a wave may as well be fixed in time as in angle: odds of 20."""


def find_peaks(
    sampling: Sampling, white: FloatArray, noise: Noise, *, recordings: int = 1, most: int = 12, least: float = 0.0
) -> list[Peak]:
    """Significant waves of any frequency in a whitened residual (n,), strongest first, where ``recordings`` are
    searched alike. Waves below ``least`` cycles per mesh are placed to the nearest line only."""
    lines = sampling.nyquist * sampling.span * recordings / SHARES.between
    found = _blind(sampling, "order", white, noise, lines=lines, most=most, least=least)
    timed = sampling.timed
    if timed is not None and timed.grid is not None:
        lines = timed.top * timed.duration * recordings / SHARES.time
        found += _blind(sampling, "time", white, noise, lines=lines, most=most, least=least)
        found += [_of_other_kind(sampling, one, white) for one in found if one.frequency > sampling.top(one.domain)]
    return _sorted_out(sampling, found)


def _blind(
    sampling: Sampling, domain: Domain, white: FloatArray, noise: Noise, *, lines: float, most: int, least: float
) -> list[Peak]:
    """The strongest waves over angle or over time, ``lines`` independent ones sharing the chance of a false
    find."""
    x, grid, span, per_mesh = sampling.over(domain)
    z = grid.power(white)
    held, false = [], []
    for here in pieces(z.size):
        frequency: FloatArray = grid.step * np.arange(here.start, here.stop, dtype=np.float64)
        rest, count = sampling.rest_at(domain, frequency, noise)
        z[here] /= white.size * rest
        log_false = log_false_any(z[here], count, lines=lines)
        seen = sampling.image(domain, frequency) > SLOWEST_BLIND / span
        if domain == "time":
            # Half way a wave and its image are one, and even samples see one of its two phases only.
            seen &= np.abs(sampling.image(domain, frequency) - 0.5 * sampling.rate) > HALF_WAY_LINES / span
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
        if any(abs(best - p.frequency) * span < FOOT_OF_PEAK_LINES for p in out):
            continue
        if len(out) == most or here_z < 0.02 * z[places[order[0]]]:
            break
        if best * per_mesh > least - FOOT / sampling.span:
            best, _ = refined(x, white, best, span)
            # Summed anew: angle and time differ by units of gains of ten thousand, as a grid's interpolation errs.
            there, _ = sampling.rest_at(domain, np.array([best]), noise)
            here_z = line_power(x, white, best) / (white.size * float(there[0]))
        std = placed_to(2.0 * here_z, span=span)
        peak = Peak(domain=domain, frequency=best, std=std, gain=2.0 * here_z, log_false=log_p, known=False)
        told = _told_from_image(sampling, _true_of_images(sampling, peak, white), white)
        if told is not None and all(abs(told.frequency - p.frequency) * span >= FOOT_OF_PEAK_LINES for p in out):
            out.append(told)
    return out


def _true_of_images(sampling: Sampling, peak: Peak, white: FloatArray) -> Peak:
    """A peak of the whitened residual (n,), or the wave above half the sampling rate whose image it is, where samples
    stray so much that this explains more."""
    rate = sampling.strays(peak.domain)
    if rate is None:
        return peak
    x, _, span, _ = sampling.over(peak.domain)
    frequency, more = unfolded(x, white, peak.frequency, rate=rate, span=span)
    if (more - 1.0) * peak.gain <= FOLD_ODDS:
        return peak
    return replace(peak, frequency=frequency, gain=more * peak.gain, std=placed_to(more * peak.gain, span=span))


def _of_other_kind(sampling: Sampling, peak: Peak, white: FloatArray) -> Peak:
    """The wave over time where ``peak`` is one over angle, and the other way round: beyond what is searched only one of
    the two may have been seen by its image."""
    domain: Domain = "time" if peak.domain == "order" else "order"
    x, _, span, per_mesh = sampling.over(domain)
    frequency, _ = refined(x, white, sampling.per_mesh(peak) / per_mesh, span)
    own = sampling.over(peak.domain)[0]
    gain = peak.gain * line_power(x, white, frequency) / line_power(own, white, peak.frequency)
    return replace(peak, domain=domain, frequency=frequency, gain=gain, std=placed_to(gain, span=span))


def _told_from_image(sampling: Sampling, peak: Peak, white: FloatArray) -> Peak | None:
    """A peak of the whitened residual (n,) beside its image about half the sampling rate; ``None`` for a wave above
    it that explains hardly more than its image below."""
    timed = sampling.timed
    if peak.domain == "order" or timed is None:
        return peak
    image = sampling.alike(peak.frequency)
    if not 0.0 < image < timed.top:
        return peak
    image, _ = refined(timed.t, white, image, timed.duration)
    gain = peak.gain * line_power(timed.t, white, image) / line_power(timed.t, white, peak.frequency)
    peak = replace(peak, image=gain)
    # A wave above half the sampling rate has to explain more than its image below, which few recordings show.
    return peak if not _fast(sampling, peak) or peak.gain > gain + TIE else None


def snapped(sampling: Sampling, frequency: float, std: float) -> float | None:
    """The integer order (or low sum of both shafts) in cycles per mesh that ``frequency`` is, if it is one."""
    place = frequency * sampling.period * sampling.fine
    near = int(sampling.apart[np.argmin(np.abs(sampling.apart - place))]) if sampling.apart.size else -1
    within = max(SNAP / sampling.span, 3.0 * std)
    exact = near / (sampling.period * sampling.fine)
    return exact if near > 0 and abs(exact - frequency) < within else None


def _sorted_out(sampling: Sampling, found: list[Peak]) -> list[Peak]:
    """One peak per place, the sharper of angle and time; what is another's foot left out."""
    out: list[Peak] = []
    for peak in sorted(found, key=lambda p: (-p.gain, not p.known)):
        here = sampling.per_mesh(peak)
        rival, foot = False, False
        for j, kept in enumerate(out):
            there = sampling.per_mesh(kept)
            apart = abs(here - there) * sampling.span
            if apart >= FOOT_OF_PEAK_LINES and (_fast(sampling, peak) or _fast(sampling, kept)):
                images = sampling.image("time", np.array([here, there]) / sampling.pace) * sampling.pace
                if abs(float(images[0] - images[1])) * sampling.span < FOOT:
                    foot = True
                    break
            if apart < FOOT_OF_PEAK_LINES or (
                peak.gain < 0.3 * kept.gain and apart < FOOT and peak.domain != kept.domain
            ):
                foot = True
                if kept.domain != peak.domain and apart < FOOT_OF_PEAK_LINES and peak.gain > kept.rival:
                    rival = True
                    out[j] = likelier(sampling, kept, peak)
                break
        if not foot and not rival:
            out.append(peak)
    final = []
    for peak in out:
        if peak.domain == "order" and not peak.known:
            exact = snapped(sampling, peak.frequency, peak.std)
            if exact is not None:
                peak = replace(peak, frequency=exact, std=0.0, known=True)
        final.append(peak)
    return final


def likelier(sampling: Sampling, best: Peak, other: Peak) -> Peak:
    """Of a wave over angle and the same over time the one to report: that which explains more, and of equals that
    over angle, since something turns; but hum, and what is slower than any shaft of the pair, over time."""
    if other.gain > best.gain:
        best, other = other, best
    timely = _hums(sampling, best, other) or sampling.per_mesh(best) * max(sampling.z_1, sampling.z_2) < 1.0
    if best.gain - other.gain <= TIE and (other.domain == "time") == timely:
        best, other = other, best
    return replace(best, rival=other.gain, image=max(best.image, other.image))


def _hums(sampling: Sampling, best: Peak, other: Peak) -> bool:
    """Whether a wave over angle or over time is hum, or at no whole order of a shaft and as even samples show hum: 60
    Hz in 70.6 samples per second as 10.6 Hz."""
    if best.hum or other.hum:
        return True
    timely, turning = (best, other) if best.domain == "time" else (other, best)
    timed = sampling.timed
    if timely.domain == turning.domain or timed is None or not timed.even:
        return False
    # Low sums of both shafts' orders lie so near that any wave of a short recording is one.
    for z in (sampling.z_1, sampling.z_2):
        if abs(turning.frequency - round(turning.frequency * z) / z) * sampling.span < SNAP:
            return False
    return any(is_hum(one, std=timely.std) for one in aliases(timely.frequency, sampling.rate))


def _fast(sampling: Sampling, peak: Peak) -> bool:
    """Whether a wave in time is faster than half the sampling rate."""
    return peak.domain == "time" and peak.frequency > 0.5 * sampling.rate
