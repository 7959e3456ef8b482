"""Sums over uneven samples at many frequencies: own code beside finufft and astropy, where these are installed.

``python -m benchmarks.uneven``; ``pip install finufft astropy`` brings them, and gearpoly wants neither.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np

from gearpoly.compare.spectrum import ComplexArray, FrequencyGrid
from gearpoly.units import FloatArray

SAMPLES = (20_000, 1_000_000)
TRIED = 60
"""Frequencies at which the sums are made one by one, for the error."""


def own(x: FloatArray, step: float, count: int, values: FloatArray) -> ComplexArray:
    """By gearpoly."""
    return FrequencyGrid(x, step=step, count=count).transform(values)


def finufft(x: FloatArray, step: float, count: int, values: FloatArray) -> ComplexArray:
    """By finufft, whose modes run from -count to count - 1."""
    turned = np.mod(2.0 * np.pi * step * x, 2.0 * np.pi)
    made: Any = import_module("finufft").nufft1d1(
        turned, values.astype(np.complex128), 2 * count, eps=1e-6, isign=-1, nthreads=1
    )
    return np.asarray(made)[count:]


def astropy(x: FloatArray, step: float, count: int, values: FloatArray) -> ComplexArray:
    """By the sums inside astropy's fast periodogram (Press and Rybicki 1989)."""
    inside = import_module("astropy.timeseries.periodograms.lombscargle.implementations.utils")
    sines, cosines = inside.trig_sum(x, values, step, count, 0.0, use_fft=True)
    return np.asarray(cosines - 1j * sines)


def main() -> None:
    """Time and greatest error of each, for a wave in noise at steps of 1 +- 0.3."""
    for samples in SAMPLES:
        rng = np.random.default_rng(3)
        x = np.cumsum(1.0 + 0.3 * rng.standard_normal(samples).clip(-2.0, 2.0))
        values = rng.standard_normal(samples) + 10.0 * np.cos(2.0 * np.pi * 0.1234 * x)
        step = 0.5 / samples  # up to half the mean rate
        tried = np.append(rng.integers(0, samples, TRIED), round(0.1234 / step))
        exact = np.array([np.sum(values * np.exp(-2j * np.pi * k * step * x)) for k in tried])
        ways: tuple[Callable[..., ComplexArray], ...] = (own, finufft, astropy)
        for way in ways:
            try:
                spent, found = min((_timed(way, x, step, values) for _ in range(3)), key=lambda one: one[0])
            except ImportError:
                print(f"{samples:8d} samples, {way.__name__}: not installed")
                continue
            error = np.max(np.abs(found[tried] - exact)) / np.max(np.abs(exact))
            print(f"{samples:8d} samples, {way.__name__}: {spent:.3f} s, error {error:.0e} of the largest line")


def _timed(way: Callable[..., ComplexArray], x: FloatArray, step: float, values: FloatArray) -> tuple[float, Any]:
    begun = time.process_time()
    found = way(x, step, x.size, values)
    return time.process_time() - begun, found


if __name__ == "__main__":
    main()
