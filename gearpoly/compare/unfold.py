"""Waves above half the sampling rate, seen by their images below: samples that do not come evenly tell which it is."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.compare.even import GAP_MIDDLE_STEPS, STRAY
from gearpoly.compare.sinusoids import line_power, refined
from gearpoly.units import FloatArray

FOLDS = 8
"""Multiples of the sampling rate about which a wave may lie whose image is seen. An encoder's line 470 times per turn
in 144 samples a turn lies beside the third."""

FOLD_ODDS = 6.0 + 2.0 * math.log(2.0 * FOLDS)
"""Twice the log likelihood by which a wave has to explain more than its image: odds of 20 (``TIE``) against each of so
many that are looked at."""


def regular_rate(x: FloatArray) -> float | None:
    """Samples per unit of ``x`` (n,), where each strays by itself about its place in an even row: from 0.016 steps,
    below which a wave and its images are alike, to a quarter of one, beyond which there are no images; else ``None``.
    """
    n = x.size
    steps = np.diff(x)
    if n < 3 or not np.all(steps > 0.0) or float(np.max(steps)) > 2.0 * GAP_MIDDLE_STEPS * float(np.median(steps)):
        return None
    number = np.arange(n) - 0.5 * (n - 1)
    along = x - np.mean(x)
    step = float(number @ along) / float(number @ number)
    stray = float(np.std(along - step * number)) / step
    return 1.0 / step if STRAY < stray < 0.25 else None


def unfolded(x: FloatArray, white: FloatArray, frequency: float, *, rate: float, span: float) -> tuple[float, float]:
    """The frequency, of a wave at ``frequency`` and those that it may be an image of about multiples of the sampling
    ``rate``, that explains most of a whitened residual ``white`` (n,) at ``x`` (n,), and its power over that of the
    first; lines are 1 / ``span`` wide."""
    own = line_power(x, white, frequency)
    image = frequency - rate * math.floor(frequency / rate + 0.5)
    best, most = frequency, own
    for k in range(1, FOLDS + 1):
        for there in (k * rate - abs(image), k * rate + abs(image)):
            if abs(there - frequency) * span > 1.0:
                there, _ = refined(x, white, there, span)
                power = line_power(x, white, there)
                if power > most:
                    best, most = there, power
    return best, most / own
