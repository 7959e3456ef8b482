"""At which angles a recording's columns are drawn: those of the shafts as estimated, not as read.

A reading's own noise stands in the transmission error too. A fast wave that is drawn at the reading would follow that
noise and explain it: at 1000 even samples a turn cos(1000 reading + phase) is sin(1000 te). So the transmission error
is drawn smooth, and its noise is taken off the shafts in the shares that they have of it. Derived here.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.ndimage import correlate1d

from gearpoly.units import FloatArray

PARABOLA_SAMPLES = 17
"""Samples under the parabola that smooths an angle: it keeps 13 % of a sample's own noise, and of a wave of as many
samples half. What it takes off a real wave moves a column of an encoder by less than the transmission error itself, an
angle of seconds of arc. The pair is simulated at the angles as read: at 20 samples a mesh the parabola takes so much
off teeth that lean by 30 um that the fit ends elsewhere (`tests/test_contest.py`)."""

SAMPLES_FOR_NOISE_SHARES = 100_000
"""Samples, the first ones, from which the shares of noise are taken."""

NOISIER_SIGMAS = 3.0
"""Standard errors by which one shaft's reading has to be the noisier; else each is taken to have half of the noise."""


def smoothed(te: FloatArray) -> FloatArray:
    """A transmission error (n,) without the noise of single samples; its ends lie on the parabolas there."""
    if te.size < PARABOLA_SAMPLES:
        return te
    half = PARABOLA_SAMPLES // 2
    # The value that a parabola through so many samples has at each of them (Savitzky and Golay 1964); scipy.signal
    # takes longer to import than all of this takes.
    powers = np.vander(np.arange(-half, half + 1), 3)
    onto = powers @ np.linalg.pinv(powers)
    out = np.asarray(correlate1d(te, onto[half]))
    out[:half] = onto[:half] @ te[:PARABOLA_SAMPLES]
    out[-half:] = onto[-half:] @ te[-PARABOLA_SAMPLES:]
    return out


def driven_share(theta_1: FloatArray, theta_2: FloatArray, *, ratio: float) -> float:
    """Part, 0 to 1, of the noise of te = theta_2 - ratio theta_1 (n,) in rad that the driven reading has.

    Both readings bend with the true motion; with their own noise, each by itself. So second differences of both share
    what the motion makes, and the difference of their mean squares is that of their noise.
    """
    a, b = np.diff(theta_2[:SAMPLES_FOR_NOISE_SHARES], 2), ratio * np.diff(theta_1[:SAMPLES_FOR_NOISE_SHARES], 2)
    noise, motion = a - b, 0.5 * (a + b)
    product, power = float(noise @ motion), float(noise @ noise)
    if power == 0.0 or abs(product) < NOISIER_SIGMAS * math.sqrt(power * float(motion @ motion) / max(a.size, 1)):
        return 0.5
    return min(max(0.5 + product / power, 0.0), 1.0)
