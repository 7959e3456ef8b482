"""Waves that stand out together only: trains of pulses, and the same faint wave in every recording.

What strikes once in a while (a bearing's ball over a pit, a belt's joint) makes a line at every multiple of how often
it strikes, and what is fixed to a shaft or to the mains is there whenever somebody records. Sums over the lines that
belong together see what none of them shows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaincc

from gearpoly.compare.families import SHARES
from gearpoly.compare.lines import APART, TIE, Domain, LineSearch, Peak
from gearpoly.compare.noise import Noise
from gearpoly.units import BoolArray, FloatArray

HARMONICS = (1, 2, 3, 4, 6, 8)
"""Numbers of harmonics that are added up: a pulse as long as a seventh of its period has about six."""

OTHERS = 1e-3
"""Chance with which all lines but the strongest may be noise: what stands out in one line is looked for elsewhere."""

PLACES = 21
"""Frequencies within a line of the last harmonic at which a train is placed."""

TINY = 1e-300


@dataclass(frozen=True, kw_only=True)
class Train:
    """Harmonics 1 to ``count`` of ``frequency``, in units of the spectra's, in the ``recordings``; ``log_false`` log of
    the expected number of such finds in noise."""

    frequency: float
    count: int
    recordings: tuple[int, ...]
    log_false: float


def faint_waves(searches: list[LineSearch], whites: list[FloatArray], noises: list[Noise]) -> list[list[Peak]]:
    """The waves, per recording, of the least likely train in the whitened residuals ``whites`` (n_k,), over angle or
    time, strongest first; none where noise may make all of them."""
    domains: list[Domain] = ["order"]
    if all(one.time_grid is not None for one in searches):
        domains.append("time")
    found: list[list[list[Peak]]] = []
    for domain in domains:
        over = [one.over(domain) for one in searches]
        step = min(grid.step for _, grid, _, _ in over)
        chances = [s.chances(domain, white, noise) for s, white, noise in zip(searches, whites, noises, strict=True)]
        repeats = []
        for k, (_, grid, _, per_mesh) in enumerate(over):
            # Onto common places: half a place off is a quarter of a line at most.
            size = int((chances[k].size - 1) * grid.step / step)
            at: FloatArray = step * np.arange(size, dtype=np.float64)
            chances[k] = chances[k][np.rint(at / grid.step).astype(np.int64)]
            repeats.append(searches[k].repeats(at * per_mesh))
        # One that is hardly less likely than the other decides with it, though it alone might be noise.
        share = math.exp(0.5 * TIE) * SHARES.faint / len(domains)
        train = find_train(chances, step=step, repeats=repeats, share=share)
        if train is not None:
            train = replace(train, log_false=train.log_false + 0.5 * TIE)
            found.append(_peaks(train, domain, searches, whites, noises))
    # Lines beside an order of a shaft may fall to it once they are placed.
    found = [peaks for peaks in found if any(peaks)]
    if len(found) == 2 and not _share_a_line(searches, *found):
        found.sort(key=_log_false)
        del found[1]
    if not found or min(map(_log_false, found)) >= 0.0:
        return [[] for _ in searches]
    if len(found) == 1:
        return found[0]
    # What turns is likelier than what is fixed in time where both explain it alike, but for hum.
    angle, time = map(_log_false, found)
    ahead = 2.0 * (angle - time)
    hums = any(one.leads and one.hum for mine in found[1] for one in mine)
    first = 1 if ahead > TIE or (ahead > -TIE and hums) else 0
    return [
        [replace(one, rival=one.gain - abs(ahead), log_false=min(angle, time)) for one in mine] for mine in found[first]
    ]


def _log_false(peaks: list[list[Peak]]) -> float:
    """Log of the expected number of such trains in noise, which all waves of one carry alike."""
    return next(one.log_false for mine in peaks for one in mine)


def _share_a_line(searches: list[LineSearch], angle: list[list[Peak]], time: list[list[Peak]]) -> bool:
    """Whether two trains, over angle and over time, are of the same waves: at the mean speed one line is."""
    return any(
        abs(search.per_mesh(one) - search.per_mesh(other)) * search.span < APART
        for search, mine, others in zip(searches, angle, time, strict=True)
        for one in mine
        for other in others
    )


def find_train(chances: list[FloatArray], *, step: float, repeats: list[BoolArray], share: float) -> Train | None:
    """The train that noise would least make in spectra of which each place, ``step`` apart, has the log chance (m_k,)
    that noise exceeds it, 0 where nothing is looked for; ``None`` where noise makes its like with more than chance
    ``share`` anywhere. ``repeats`` (m_k,) marks what repeats with the pair: a train that owes more than half to it is
    the pair's own.

    Minus log chances are exponential in noise, so sums of q of them follow Gamma(q) (Fisher 1925); every fundamental
    that is tried counts as a test (union bound), though neighbours are hardly two.
    """
    sets: list[tuple[int, ...]] = [(k,) for k in range(len(chances))]
    if len(chances) > 1:
        sets.append(tuple(range(len(chances))))
    best: Train | None = None
    for recordings in sets:
        size = min(chances[k].size for k in recordings)
        for count in HARMONICS:
            if count * len(recordings) == 1:
                continue
            # The last harmonic moves count times as fast as the first.
            first = np.arange(count, size)
            lines, own = [], np.zeros(first.size)
            for h in range(1, count + 1):
                at = np.rint(first * (h / count)).astype(np.int64)
                lines += [-chances[k][at] for k in recordings]
                own -= np.sum([np.where(repeats[k][at], chances[k][at], 0.0) for k in recordings], axis=0)
            # Lines at orders of the shafts say nothing, and are none.
            free = np.sum([line > 0.0 for line in lines], axis=0)
            total, largest = np.sum(lines, axis=0), np.max(lines, axis=0)
            tests = math.log(first.size * len(HARMONICS) * len(sets) / share)
            log_false = tests + np.log(np.maximum(gammaincc(np.maximum(free, 1), total), TINY))
            alone = (free < 2) | (gammaincc(np.maximum(free - 1, 1), total - largest) > OTHERS)
            log_false[alone | (own > (0.5 if count > 1 else 1.0) * total)] = 0.0
            place = int(np.argmin(log_false)) if first.size else 0
            if first.size and log_false[place] < min(0.0, best.log_false if best is not None else 0.0):
                best = Train(
                    frequency=float(first[place]) * step / count, count=count, recordings=recordings,
                    log_false=float(log_false[place]),
                )  # fmt: skip
    return best


def _peaks(
    train: Train, domain: Domain, searches: list[LineSearch], whites: list[FloatArray], noises: list[Noise]
) -> list[list[Peak]]:
    """The waves of a train, per recording: its fundamental where the lines hold most, of orders of the shafts none."""
    multiples: FloatArray = np.arange(1.0, train.count + 1.0)
    longest = max(searches[k].over(domain)[2] for k in train.recordings)
    near = train.frequency + np.linspace(-0.5, 0.5, PLACES) / (longest * train.count)
    power = np.zeros((len(searches), PLACES, train.count))
    for k in train.recordings:
        x, _, _, per_mesh = searches[k].over(domain)
        for j, frequency in enumerate(near):
            wave = np.exp((-2j * np.pi * frequency) * x)
            turned = whites[k].astype(np.complex128)
            for h in range(train.count):
                turned *= wave
                power[k, j, h] = abs(np.sum(turned)) ** 2 / x.size
        power[k] /= searches[k].rest_at(domain, train.frequency * multiples, noises[k])[0]
        power[k][:, searches[k].own(train.frequency * multiples * per_mesh)] = 0.0
    best = int(np.argmax(np.sum(power, axis=(0, 2))))
    held = power[:, best]
    if not np.any(held):
        return [[] for _ in searches]
    std = 0.551 / longest / math.sqrt(2.0 * float(np.sum(held * multiples**2)))
    out: list[list[Peak]] = []
    for mine in held:
        peaks = [
            Peak(
                domain=domain, frequency=float(h * near[best]), std=h * std, gain=2.0 * float(mine[h - 1]),
                log_false=train.log_false, known=False, harmonic=h if train.count > 1 else 0, faint=True,
                leads=mine[h - 1] == np.max(held),
            ) for h in range(1, train.count + 1) if mine[h - 1] > 0.0
        ]  # fmt: skip
        out.append(sorted(peaks, key=lambda one: -one.gain))
    return out
