"""Waves that stand out together only: trains of pulses, and the same faint wave in every recording.

What strikes once in a while (a bearing's ball over a pit, a belt's joint) makes a line at every multiple of how often
it strikes, and what is fixed to a shaft or to the mains is there whenever somebody records. Sums over the lines that
belong together see what none of them shows.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.special import gammaincc

from gearpoly.compare.bumps import Heard, find_bumps, followed
from gearpoly.compare.families import SHARES
from gearpoly.compare.lines import TIE
from gearpoly.compare.noise import Noise
from gearpoly.compare.peak import Domain, Peak
from gearpoly.compare.sampling import FOOT_OF_PEAK_LINES, Sampling
from gearpoly.compare.trains import LEAST_WEIGHT, OTHERS, Train, likelier, lines_of, together
from gearpoly.units import BoolArray, FloatArray, IntArray

HARMONICS_ADDED = (1, 2, 3, 4, 6, 8)
"""Numbers of harmonics that are added up: a pulse as long as a seventh of its period has about six."""

PLACES_IN_LINE = 21
"""Frequencies within a line of the last harmonic at which a train is placed."""


def faint_waves(searches: list[Sampling], whites: list[FloatArray], noises: list[Noise]) -> list[list[Peak]]:
    """The waves, per recording, of the least likely train in the whitened residuals ``whites`` (n_k,), over angle or
    time, strongest first; none where noise may make all of them."""
    domains: list[Domain] = ["order"]
    if all(one.time_grid is not None for one in searches):
        domains.append("time")
    trains: dict[Domain, Train] = {}
    for domain in domains:
        step = min(one.over(domain)[1].step for one in searches)
        lines = [lines_of(s, domain, white, n, step=step) for s, white, n in zip(searches, whites, noises, strict=True)]
        # One that is hardly less likely than the other decides with it, though it alone might be noise.
        share = math.exp(0.5 * TIE) * SHARES.faint / (2 * len(domains))
        chances, repeats = [one.chances for one in lines], [one.repeats for one in lines]
        train = find_train(chances, step=step, repeats=repeats, share=share)
        bumps = find_bumps(lines, step=step, share=share)
        if bumps is not None and (train is None or bumps.log_false < train.log_false):
            train = followed(bumps, _heard(bumps, domain, searches, whites, noises)) or train
        if train is not None:
            trains[domain] = replace(train, log_false=train.log_false + 0.5 * TIE)
    strongest = min(trains, key=lambda domain: trains[domain].log_false, default=domains[0])
    if len(domains) == 2 and strongest in trains and trains[strongest].gain > 0.0:
        trains = _both_ways(trains[strongest], strongest, searches, whites, noises)
    found = {domain: _peaks(train, domain, searches, whites, noises) for domain, train in trains.items()}
    # Lines beside an order of a shaft may fall to it once they are placed.
    found = {domain: peaks for domain, peaks in found.items() if any(peaks)}
    if len(found) == 2 and not _share_a_line(searches, found["order"], found["time"]):
        del found["time" if strongest == "order" else "order"]
    likeliest = min((trains[domain].log_false for domain in found), default=0.0)
    if likeliest >= 0.0:
        return [[] for _ in searches]
    if len(found) == 1:
        return next(iter(found.values()))
    # What turns is likelier than what is fixed in time where both explain it alike, but for hum.
    angle, time = trains["order"], trains["time"]
    ahead = 2.0 * (time.gain - angle.gain if time.gain * angle.gain > 0.0 else angle.log_false - time.log_false)
    hums = any(one.leads and one.hum for mine in found["time"] for one in mine)
    named: Domain = "time" if ahead > TIE or (ahead > -TIE and hums) else "order"
    return [[replace(one, rival=one.gain - abs(ahead), log_false=likeliest) for one in mine] for mine in found[named]]


def _both_ways(
    train: Train, domain: Domain, searches: list[Sampling], whites: list[FloatArray], noises: list[Noise]
) -> dict[Domain, Train]:
    """A train of bumps over angle or time, and what it is over the other, by the same of its lines: one that lies
    beside an order of a shaft would count for one of them only."""
    other: Domain = "time" if domain == "order" else "order"
    first = searches[train.recordings[0]]
    frequency = train.frequency * first.over(domain)[3] / first.over(other)[3]
    here = _heard(train, domain, searches, whites, noises)
    there = [replace(one, x=searches[k].over(other)[0]) for k, one in zip(train.recordings, here, strict=True)]
    same = followed(train, here) or train
    turned = followed(replace(train, frequency=frequency), there)
    return {domain: same} if turned is None else {domain: same, other: turned}


def _heard(
    train: Train, domain: Domain, searches: list[Sampling], whites: list[FloatArray], noises: list[Noise]
) -> list[Heard]:
    """The recordings in which a train was found."""
    frequency: FloatArray = train.frequency * np.arange(1.0, train.count + 1.0)
    out = []
    for k in train.recordings:
        x, _, _, per_mesh = searches[k].over(domain)
        rest, _ = searches[k].rest_at(domain, frequency, noises[k])
        rest = np.where(searches[k].own(frequency * per_mesh), 0.0, rest)
        out.append(Heard(x=x, white=whites[k], rest=rest))
    return out


def _share_a_line(searches: list[Sampling], angle: list[list[Peak]], time: list[list[Peak]]) -> bool:
    """Whether two trains, over angle and over time, are of the same waves: at the mean speed one line is."""
    return any(
        abs(sampling.per_mesh(one) - sampling.per_mesh(other)) * sampling.span < FOOT_OF_PEAK_LINES
        for sampling, mine, others in zip(searches, angle, time, strict=True)
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
    sets = together(len(chances))
    found = list[Train | None]()
    for count in HARMONICS_ADDED:
        each = [_added(chance, mine, count) for chance, mine in zip(chances, repeats, strict=True)]
        for recordings in sets:
            if count * len(recordings) == 1:
                continue
            size = min(each[k][0].size for k in recordings)
            if not size:
                continue
            total, free, own = (np.sum([each[k][which][:size] for k in recordings], axis=0) for which in range(3))
            tests = math.log(size * len(HARMONICS_ADDED) * len(sets) / share)
            # Noise makes such a sum with a chance of exp(-total) at the least, that of one line: others are no find.
            at = np.flatnonzero(total > tests)
            total, free, own = total[at], free[at], own[at]
            largest = np.max([each[k][3][at] for k in recordings], axis=0)
            log_false = tests + np.log(np.maximum(gammaincc(free, total), LEAST_WEIGHT))
            alone = (free < 2) | (gammaincc(np.maximum(free - 1, 1), total - largest) > OTHERS)
            log_false[alone | (own > (0.5 if count > 1 else 1.0) * total)] = 0.0
            found.append(likelier(None, log_false, at + count, step=step, count=count, recordings=recordings))
    # Where chances are too small to tell apart, one recording before all and few harmonics before many.
    told = (one for one in found if one is not None)
    return min(told, key=lambda one: (one.log_false, sets.index(one.recordings), one.count), default=None)


def _added(chance: FloatArray, repeats: BoolArray, count: int) -> tuple[FloatArray, IntArray, FloatArray, FloatArray]:
    """Of one recording's log chances (m,), for trains of ``count`` harmonics whose last lies at place ``count`` and
    beyond: their sums with a minus sign, how many are not 0 (lines at orders of the shafts say nothing, and are none),
    what of the sums ``repeats`` (m,), and the largest of each."""
    # The last harmonic moves count times as fast as the first.
    first = np.arange(count, chance.size)
    total, own, largest = np.zeros(first.size), np.zeros(first.size), np.zeros(first.size)
    free = np.zeros(first.size, dtype=np.int64)
    for h in range(1, count + 1):
        at = np.rint(first * (h / count)).astype(np.int64)
        line = -chance[at]
        total += line
        own += np.where(repeats[at], line, 0.0)
        free += line > 0.0
        np.maximum(largest, line, out=largest)
    return total, free, own, largest


def _peaks(
    train: Train, domain: Domain, searches: list[Sampling], whites: list[FloatArray], noises: list[Noise]
) -> list[list[Peak]]:
    """The waves of a train, per recording: its fundamental where the lines hold most, of orders of the shafts none."""
    multiples: FloatArray = np.arange(1.0, train.count + 1.0)
    longest = max(searches[k].over(domain)[2] for k in train.recordings)
    near = train.frequency + (1.0 if train.gain == 0.0 else 0.0) * np.linspace(-0.5, 0.5, PLACES_IN_LINE) / (
        longest * train.count
    )
    power = np.zeros((len(searches), PLACES_IN_LINE, train.count))
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
    # A line of noise holds 1, which says nothing of the place.
    said = max(float(np.sum(np.maximum(held - 1.0, 0.0) * multiples**2)), 1.0)
    std = 0.551 / longest / math.sqrt(2.0 * said)
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
