"""How far a shaft truly turned where its angle was made from time: the rate of its motor, and what pulses added.

The lines of a pair stand at whole orders of its shafts. A guide pulse turns the worm by a part between nothing and all
of what it says, and a motor runs at the rate of the sun or of a drifting crystal; wrong angles smear those lines and
move them. Both are nuisance parameters with priors of their own, and the angle at which the lines are likeliest is
taken.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.ndimage import maximum_filter, median_filter

from gearpoly.compare.spectrum import FrequencyGrid
from gearpoly.recording.recording import Recording
from gearpoly.recording.unwrapping import only_goes_on
from gearpoly.units import FloatArray, IntArray

RATE_STD = 1.5e-3
"""Relative standard deviation, beforehand, of the rate of an angle that was made from time: the solar rate is 2.7e-3
below the sidereal one, and lines of four mounts lay within 3e-3 of whole orders."""

LARGEST_RATE_CHANGE = 4e-3
"""Relative rate by which it is asked at most."""

ORDER_SHOWS = 0.1
"""Prior probability that a whole order of a shaft, or the mesh, shows a line at all: of 120 orders of a worm's turn a
guide log shows about a dozen."""

STRENGTH = 30.0
"""Mean power, over that of the background, of a line that shows: lines found in guide logs have 6 to 1000."""

RATE_STEP_CYCLES = 0.25
"""Cycles of the highest order over the whole recording by which the angle changes from one trial to the next: a line
loses a twentieth of its power by half of that."""

PARAMETER_TRIALS = 161
"""Most trials of either parameter; a night of ten hours with pulses of one per cent takes as many."""

LINE_SWELLS = 0.1
"""Part of itself by which a line swells and sways along a recording: no drive repeats better, and a line that stands
out a thousandfold would else count the last ten-thousandth of its power, which other lines and the drift leak into."""

BACKGROUND_WIDTH = 8.0
"""Lines of the recording's own width on either side from which the background at an order is taken."""

SKY_DEGREE = 6
"""Degree of the polynomial in time that is no line: refraction, and an axis that is not aimed at the pole."""

MOST_SAMPLES_FOR_RATE = 20_000
"""Samples above which nothing is asked: no guide log has as many, and pulses beside an encoder's angle are none."""


@dataclass(frozen=True, kw_only=True)
class Clock:
    """What was found: ``share`` of the pulses that turned the shaft, and ``rate`` of the motor over the stated one,
    each with its standard deviation; ``log_odds`` of the lines' evidence over that of the angle as stated."""

    share: float
    share_std: float
    rate: float
    rate_std: float
    log_odds: float

    @property
    def says(self) -> str:
        """The remark for the user."""
        return (
            f"pulses turned the shaft by {self.share:.2f} +- {self.share_std:.2f} of what they say, and its motor ran "
            f"at {self.rate:.5f} +- {self.rate_std:.5f} of the stated rate, as the lines of the pair tell"
        )


def turned(recording: Recording, *, z_1: int, z_2: int) -> tuple[Recording, Clock | None]:
    """The recording with its angle as it was likeliest turned, and what was found; as it is, and None, where no column
    says what a shaft may have turned beside its angle."""
    for shaft, teeth in (("driven", z_2), ("driving", z_1)):
        pulses, angle = (getattr(recording, f"{shaft}_{what}_rad") for what in ("correction", "angle"))
        te = recording.te_mm if recording.te_rad is None else recording.te_rad
        if pulses is None or angle is None or te is None or recording.size > MOST_SAMPLES_FOR_RATE:
            continue
        good = np.isfinite(angle) & np.isfinite(pulses) & np.isfinite(te)
        timed = shaft in recording.from_time
        whole = angle[good] if only_goes_on(angle[good]) else np.unwrap(angle[good])
        clock = found(whole, pulses[good], te[good], teeth=teeth, mate=z_1 + z_2 - teeth, timed=timed)
        there = np.full(recording.size, math.nan)
        there[good] = clock.rate * whole + clock.share * pulses[good]
        changes: dict[str, Any] = {f"{shaft}_angle_rad": there, "remarks": (*recording.remarks, clock.says)}
        return replace(recording, **changes), clock
    return recording, None


def found(angle: FloatArray, pulses: FloatArray, te: FloatArray, *, teeth: int, mate: int, timed: bool) -> Clock:
    """Share and rate by the evidence of the lines in ``te`` (n,) at whole orders of the shaft of ``teeth`` teeth, whose
    stated ``angle`` (n,) and ``pulses`` (n,) are in rad, at those of its ``mate``, and at the mesh's; ``timed``: the
    angle is time, so its rate is open too."""
    turns, more = angle / (2.0 * math.pi), pulses / (2.0 * math.pi)
    length = float(np.ptp(turns))
    highest = min(0.5 * turns.size / length, 2.0 * teeth)
    comb = _comb(teeth, mate, highest, lowest=1.5 / length)
    # Orders that this recording does not resolve (the taper's line is two lines wide) are places of one line.
    first = np.flatnonzero(np.diff(comb, prepend=-math.inf) > 2.0 * mate / length)
    x = np.linspace(-1.0, 1.0, turns.size)
    slow = np.polynomial.legendre.legvander((turns - turns[0]) / length * 2.0 - 1.0, SKY_DEGREE)
    left = te - slow @ np.linalg.lstsq(slow, te, rcond=None)[0]
    taper = 0.5 + 0.5 * np.cos(math.pi * x)
    share = _trials(0.0, 1.0, highest * float(np.ptp(more)))
    rate = (
        _trials(1.0 - LARGEST_RATE_CHANGE, 1.0 + LARGEST_RATE_CHANGE, 2.0 * LARGEST_RATE_CHANGE * highest * length)
        if timed
        else np.ones(1)
    )
    count = int(comb.max(initial=1)) + math.ceil(BACKGROUND_WIDTH * mate / length) + 1

    def power(share: float, rate: float) -> FloatArray:
        return FrequencyGrid(rate * turns + share * more, step=1.0 / mate, count=count).power(taper * left)

    # A smeared line is background to its neighbours, so the background is the least that any share leaves.
    seen = np.array([power(one, 1.0) for one in (0.0, 0.5, 1.0)])
    wide, near = (2 * max(1, round(lines * mate / length)) + 1 for lines in (BACKGROUND_WIDTH, 2.0))
    # The power of noise is exponential: its median is log 2 of its mean.
    background = np.min(median_filter(seen, size=(1, wide), mode="nearest"), axis=0) / math.log(2.0)
    background += LINE_SWELLS**2 * np.max(maximum_filter(seen, size=(1, near), mode="nearest"), axis=0)
    log = np.array([[_evidence((power(s, r) / background)[comb], first) for r in rate] for s in share])
    log -= 0.5 * ((rate - 1.0) / RATE_STD)[None, :] ** 2
    at = np.unravel_index(int(np.argmax(log)), log.shape)
    weight = np.exp(log - log[at])
    weight /= weight.sum()
    stated = log[0, int(np.argmin(np.abs(rate - 1.0)))]

    def spread(values: FloatArray, weights: FloatArray, about: float) -> float:
        grid = 0.3 * float(values[1] - values[0]) if values.size > 1 else 0.0
        return math.hypot(math.sqrt(float(weights @ (values - about) ** 2)), grid)

    best_share, best_rate = float(share[at[0]]), float(rate[at[1]])
    return Clock(
        share=best_share, share_std=spread(share, weight.sum(axis=1), best_share),
        rate=best_rate, rate_std=spread(rate, weight.sum(axis=0), best_rate),
        log_odds=float(log[at] - stated),
    )  # fmt: skip


def _comb(teeth: int, mate: int, highest: float, *, lowest: float) -> IntArray:
    """Orders of the shaft of ``teeth`` at which a pair has lines, from ``lowest`` to ``highest``, in units of 1 over
    the mate's teeth: whole ones of this shaft, and those of the mate, which turns teeth/mate times as fast."""
    own = mate * np.arange(1, int(highest) + 1)
    mates = teeth * np.arange(1, int(highest * mate / teeth) + 1)
    out = np.unique(np.concatenate((own, mates)))
    return np.asarray(out[out >= lowest * mate])


def _trials(low: float, high: float, cycles: float) -> FloatArray:
    """Values from ``low`` to ``high`` that are ``RATE_STEP_CYCLES`` of the ``cycles`` between the ends apart."""
    return np.linspace(low, high, min(PARAMETER_TRIALS, max(3, 2 * math.ceil(0.5 * cycles / RATE_STEP_CYCLES) + 1)))


def _evidence(power: FloatArray, first: IntArray) -> float:
    """Log evidence of lines at orders with ``power`` over the background, against none anywhere.

    In each stretch of orders, that begin at ``first``, one line is there with probability ``ORDER_SHOWS``, at any of
    them alike; its power is then exponential about ``STRENGTH`` (the marginal likelihood of a wave of normal cosine and
    sine in normal noise).
    """
    there = power * STRENGTH / (1.0 + STRENGTH) - math.log1p(STRENGTH)
    many = np.diff(first, append=power.size)
    one = np.logaddexp.reduceat(there, first) - np.log(many)
    return float(np.sum(np.logaddexp(math.log1p(-ORDER_SHOWS), math.log(ORDER_SHOWS) + one)))
