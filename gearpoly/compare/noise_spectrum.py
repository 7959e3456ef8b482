"""A noise spectrum from its lines: smooth, blind to what is narrow, and as an autoregressive model."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gearpoly.mesh.radial_search import compiled
from gearpoly.units import FloatArray, IntArray

AR_ORDER = 24
"""Longest memory of the noise in samples; the shortest that does as well is taken."""

CUT = 7.0
"""A line this often above the middle of its neighbours (in power) is no noise: one in e^7 = 1100 of honest ones is
cut, and the mean of the others is corrected for it."""

SLOWEST_LINES_EXTRAPOLATED = 24
"""Slowest lines whose power law is drawn on to zero frequency."""

_CUT_MEAN = 1.0 - CUT * math.exp(-CUT) / (1.0 - math.exp(-CUT))
"""Mean of an exponential of mean 1 cut at CUT."""


def windows(count: int, *, least: int = 12, most: int = 400) -> tuple[IntArray, IntArray]:
    """Bounds [low, high) of the neighbourhood from which the noise at each of ``count`` lines is estimated: two thirds
    to one and a half of its frequency, at least ``least`` and at most ``most`` lines."""
    k = np.arange(count, dtype=np.float64)
    half = np.clip(0.4 * (k + 1.0), 0.5 * least, 0.5 * most)
    low = np.clip(np.floor(k - half), 0.0, max(0.0, count - least))
    high = np.clip(np.ceil(k + half) + 1.0, min(least, count), count)
    return low.astype(np.int64), high.astype(np.int64)


@compiled
def _medians(power: FloatArray, low: IntArray, high: IntArray) -> FloatArray:
    """Medians (q,) of ``power`` (m,) between the places ``low`` and ``high`` (q,)."""
    out = np.empty(low.size)
    for k in range(low.size):
        out[k] = np.median(power[low[k] : high[k]])
    return out


def smooth_spectrum(power: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Level (m,) of a noise spectrum from its independent lines ``power`` (m,), blind to narrow peaks, and the number
    of lines (m,) each value rests on.

    Middle of the neighbours first; then the mean of those that are below CUT of it.
    """
    m = power.size
    low, high = windows(m)
    # Medians where the neighbourhood has grown by a tenth, drawn through in between.
    at = np.unique(
        np.minimum(m - 1, np.concatenate([np.arange(min(m, 40)), np.geomspace(40, max(m, 41), 160)]).astype(int))
    )
    at = np.unique(np.concatenate([at, np.arange(0, m, 100)]))
    middle = np.maximum(_medians(power, low[at], high[at]) / math.log(2.0), 1e-300)
    level = np.exp(np.interp(np.arange(m), at, np.log(middle)))
    for _ in range(2):
        kept = power <= CUT * level
        total = np.concatenate([[0.0], np.cumsum(np.where(kept, power / level, 0.0))])
        number = np.concatenate([[0], np.cumsum(kept)])
        n = np.maximum(number[high] - number[low], 1).astype(np.float64)
        level *= np.maximum((total[high] - total[low]) / n / _CUT_MEAN, 1e-6)
    # Wandering rises towards the slowest lines faster than any mean follows: there the power law of the first few dozen
    # lines goes on, of which it takes at least as much as the means.
    few = min(SLOWEST_LINES_EXTRAPOLATED, m)
    if few >= 12:
        x = np.log(np.arange(1.0, few + 1.0))
        y = np.log(np.maximum(power[:few], 1e-300)) + np.euler_gamma
        # A peak among them must not draw the law upward: clip at CUT above the first level.
        y = np.minimum(y, np.log(CUT * level[:few]))
        slope, start = np.polyfit(x, y, 1)
        law = np.exp(start + min(slope, 0.0) * x + (0.0 if slope < 0.0 else slope * float(np.mean(x))))
        near = x < np.log(0.5 * few)
        level[:few] = np.where(near, np.maximum(level[:few], law), level[:few])
        n[:few] = np.where(near, np.minimum(n[:few], 0.5 * few), n[:few])
    return level, n


def ar_model(frequency: FloatArray, density: FloatArray, *, nyquist: float, samples: int) -> tuple[FloatArray, float]:
    """Autoregressive coefficients and innovation rms of a spectrum ``density`` over ``frequency`` up to ``nyquist``."""
    even = np.interp(np.linspace(0.0, nyquist, 4097), frequency, density)
    covariance = np.fft.irfft(even)
    best: tuple[float, FloatArray, float] | None = None
    for order, (ar, left) in enumerate(_orders(covariance, min(AR_ORDER, samples // 20))):
        # Hannan and Quinn's criterion: a longer memory has to pay for its coefficient, and white noise stays white.
        price = samples * math.log(max(left, 1e-300)) + 2.0 * math.log(math.log(samples)) * order
        if best is None or price < best[0] - 1e-9:
            best = (price, ar, math.sqrt(max(left, 1e-300)))
    assert best is not None
    return best[1], best[2]


def _orders(covariance: FloatArray, most: int) -> Iterator[tuple[FloatArray, float]]:
    """Coefficients (p,) of each order p from 0 to ``most`` of a ``covariance`` (most + 1 or more,), and the variance
    that they leave, each from the order before (Levinson 1947, Durbin 1960)."""
    ar, left = np.empty(0), float(covariance[0])
    yield ar, left
    for order in range(1, most + 1):
        # What is left may be rounded away where one line is all.
        reflected = float(covariance[order] - ar @ covariance[order - 1 : 0 : -1]) / max(left, 1e-300)
        ar = np.append(ar - reflected * ar[::-1], reflected)
        left *= 1.0 - reflected**2
        yield ar, left
