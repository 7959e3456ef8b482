"""Trains of bumps: what strikes once in a while, always alike, found by its shape.

The harmonics of a train of bumps are in step: at one moment of each round all of them have their crest. Sums that keep
their phases pay for one number instead of two for every line, and need a third less energy than sums of powers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import minimum_filter1d
from scipy.special import gammaincc

from gearpoly.compare.pieces import pieces
from gearpoly.compare.spectrum import ComplexArray
from gearpoly.compare.trains import LEAST_WEIGHT, OTHERS, Lines, Train, likelier, together
from gearpoly.units import BoolArray, FloatArray, IntArray

BUMP_WIDTHS_RAD = (0.6, 0.35, 0.2)
"""Standard deviations in rad of the round of bumps that are looked for: from 0.2 to 0.75 no more than a thirtieth of
the gain is lost."""

BUMP_REACH_HARMONICS = 2.0
"""Harmonics times width up to which a bump has any to speak of: there an eighth of the first's amplitude is left."""

PER_HARMONIC = 4
"""Moments of the round at which a bump is tried, per harmonic."""

FEET_PLACES = 4
"""Places, half a line each or less, within which a stronger train may have its feet."""

TRAIN_PLACES, PLACED = 41, 1.5
"""Frequencies at which a train is placed, and the lines of the last harmonic within which they lie: where the first few
harmonics hold most, the last says little."""

PARTS_OF_RECORD, TWO_PARTS_MOST = 6, 0.75
"""Parts of a record, and the part of a bump's whole that two neighbours of them may hold: what comes once only is no
train, though any train would take a part of it. Of a train at the threshold two hold a third, give or
take an eighth."""


def find_bumps(lines: list[Lines], *, step: float, share: float) -> Train | None:
    """The train of bumps that noise would least make in the ``lines`` of recordings, at places ``step`` apart; ``None``
    where noise makes its like with more than chance ``share`` anywhere. A train that owes more than half to what
    repeats with the pair is the pair's own.

    Matched filter over the moment of the round. Its largest value exceeds a level with at most the chance at one moment
    and the expected number of crossings of a round (Rice 1945); every fundamental and width counts as a test.
    """
    sets = together(len(lines))
    best: Train | None = None
    size = min(one.amplitude.size for one in lines)
    for width in BUMP_WIDTHS_RAD:
        harmonics = np.arange(1, int(BUMP_REACH_HARMONICS / width) + 1)
        shape = np.exp(-0.5 * (width * harmonics) ** 2)
        most = int(harmonics[-1])
        for here in pieces(max(size - most, 0)):
            # The last harmonic moves as many times as fast as the first.
            last = np.arange(most + here.start, most + here.stop)
            at = np.rint(last[:, None] * (harmonics / most)).astype(np.int64)
            filtered = [_filtered(one, at, harmonics, shape) for one in lines]
            for recordings in sets:
                parts = [filtered[k] for k in recordings]
                tests = math.log(size * len(BUMP_WIDTHS_RAD) * len(sets) / share)
                log_false = tests + _log_sum(parts, 0)
                others = _log_sum(parts, 1)
                own = np.all([part[2] for part in parts], axis=0)
                # Beside a train that repeats with the pair stand its feet.
                beaten = minimum_filter1d(np.where(own, log_false, 0.0), 2 * FEET_PLACES + 1) < log_false
                log_false[(others > math.log(OTHERS)) | own | beaten] = 0.0
                best = likelier(best, log_false, last, step=step, count=most, recordings=recordings)
    return best


def _filtered(
    lines: Lines, at: IntArray, harmonics: IntArray, shape: FloatArray
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Of one recording, for trains with their harmonics at places ``at`` (b, h): log chance (b,) of the best bump or
    dip at any moment, the same without its strongest line, and whether more than half of it repeats with the pair."""
    weight = np.where(lines.free[at], shape / np.sqrt(lines.rest[at]), 0.0)
    seen = lines.amplitude[at] * weight
    filtered = np.abs(_at_moments(seen))
    when = np.argmax(filtered, axis=1)
    # What every line adds at the best moment, with the sign that makes the sum positive.
    mine = (seen * _moments(harmonics.size)[:, when].T).real
    mine *= np.sign(np.sum(mine, axis=1))[:, None]
    strongest = np.argmax(mine, axis=1)[:, None]
    square = weight**2
    others = np.where(np.arange(harmonics.size) == strongest, 0.0, 1.0)
    own = np.sum(mine * lines.repeats[at], axis=1) > 0.5 * np.sum(mine, axis=1)
    chances = [
        _log_chance(np.sum(mine * part, axis=1), square * part, harmonics, lines.count[at])
        for part in (np.ones(1), others)
    ]
    return chances[0], chances[1], own


def _log_chance(total: FloatArray, square: FloatArray, harmonics: IntArray, count: FloatArray) -> FloatArray:
    """Log chance (b,) that noise filtered with weights of ``square`` (b, h) exceeds ``total`` (b,) at any moment of the
    round, the level at each estimated from ``count`` lines (b, h); 0 where fewer than two lines are looked at."""
    power = np.sum(square, axis=1)
    # Levels of several harmonics were estimated each on its own (Satterthwaite 1946), but one that came out too low
    # makes its line count for more: the middle of that number and of one line's is what noise shows (test_bumps.py).
    alone = np.sum(square * count, axis=1) / np.maximum(power, LEAST_WEIGHT)
    count = np.sqrt(alone * power**2 / np.maximum(np.sum(square**2 / count, axis=1), LEAST_WEIGHT))
    # A wave's real part has half the mean square of its amplitude.
    gain = np.maximum(total, 0.0) ** 2 / np.maximum(power, LEAST_WEIGHT)
    crossings = np.sqrt(np.sum(square * harmonics**2, axis=1) / np.maximum(power, LEAST_WEIGHT))
    out = np.log1p(2.0 * crossings) - count * np.log1p(gain / np.maximum(count, 1.0))
    return np.asarray(np.where(np.count_nonzero(square, axis=1) < 2, 0.0, np.minimum(out, 0.0)))


def _log_sum(parts: list[tuple[FloatArray, FloatArray, BoolArray]], which: int) -> FloatArray:
    """Log chance (b,) of all recordings together: minus log chances are exponential, so their sum follows Gamma."""
    total = -np.sum([part[which] for part in parts], axis=0)
    if len(parts) == 1:
        return np.asarray(-total)
    return np.asarray(np.log(np.maximum(gammaincc(len(parts), total), LEAST_WEIGHT)))


@dataclass(frozen=True, kw_only=True, eq=False)
class Heard:
    """One recording in which a train was found: whitened values ``white`` (n,) at ``x`` (n,), and of its harmonics the
    whitened spectrum ``rest`` (h,), 0 at those that are not looked at."""

    x: FloatArray
    white: FloatArray
    rest: FloatArray


def followed(train: Train, heard: list[Heard]) -> Train | None:
    """The train with its frequency as the bumps of all recordings tell it; ``None`` where they do not come all along
    any record."""
    most = max(float(np.ptp(one.x)) for one in heard) * train.count
    near = train.frequency + np.linspace(-PLACED, PLACED, TRAIN_PLACES) / most
    gains = [sum(float(np.max(np.sum(_struck(f, one), axis=0) ** 2)) / one.x.size for one in heard) for f in near]
    frequency = float(near[int(np.argmax(gains))])
    if not any(_lasts(_struck(frequency, one)) for one in heard):
        return None
    return replace(train, frequency=frequency, gain=max(gains))


def _struck(frequency: float, heard: Heard) -> FloatArray:
    """What every part of a record adds to a train's bump at any moment (``PARTS_OF_RECORD``, m), in one unit for
    all."""
    count = heard.rest.size
    harmonics = np.arange(1, count + 1)
    shape = np.exp(-0.5 * (BUMP_REACH_HARMONICS / count * harmonics) ** 2)
    weight = np.where(heard.rest > 0.0, shape / np.maximum(heard.rest, LEAST_WEIGHT), 0.0)
    weight /= math.sqrt(float(np.sum(weight**2 * heard.rest)) or 1.0)
    turned = np.exp((-2j * np.pi * frequency) * (heard.x - 0.5 * (heard.x[0] + heard.x[-1])))
    begin = np.linspace(0, heard.x.size, PARTS_OF_RECORD, endpoint=False).astype(np.int64)
    sums = np.stack([np.add.reduceat(heard.white * turned**h, begin) for h in harmonics], axis=1)
    return _at_moments(sums * weight)


def _lasts(struck: FloatArray) -> bool:
    """Whether no two neighbouring parts of a record hold nearly all of a bump."""
    total = np.sum(struck, axis=0)
    best = int(np.argmax(np.abs(total)))
    if total[best] == 0.0:  # of a train all of whose harmonics are left out nothing is heard
        return False
    mine = struck[:, best] / total[best]
    return bool(np.max(mine[1:] + mine[:-1]) < TWO_PARTS_MOST)


def _moments(count: int) -> ComplexArray:
    """Turns (h, m) of ``count`` harmonics at the moments of the round at which a bump is tried."""
    many = PER_HARMONIC * count
    return np.asarray(np.exp(2j * np.pi / many * np.outer(np.arange(1, count + 1), np.arange(many))))


def _at_moments(amplitudes: ComplexArray) -> FloatArray:
    """Waves (b, m) of harmonics with these ``amplitudes`` (b, h) at the moments of the round."""
    turns = _moments(amplitudes.shape[1])
    return np.asarray(amplitudes.real @ turns.real - amplitudes.imag @ turns.imag)
