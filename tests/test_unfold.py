"""Waves above half the sampling rate, told from their images by samples that stray about an even row."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.compare.lines import find_peaks
from gearpoly.compare.noise import NoiseEstimator
from gearpoly.compare.sampling import sampling_of
from gearpoly.compare.unfold import FOLD_ODDS, regular_rate, unfolded
from gearpoly.units import FloatArray

N = 3000


def row(stray: float, seed: int = 1) -> FloatArray:
    """100 samples per unit, each about its place by ``stray`` steps rms."""
    rng = np.random.default_rng(seed)
    return np.asarray((np.arange(N) + np.clip(stray * rng.standard_normal(N), -0.45, 0.45)) / 100.0)


@pytest.mark.parametrize("true", [80.0, 131.7, 270.3, 470.0, 633.3])
def test_a_wave_above_half_the_rate_is_told_by_its_image(true: float) -> None:
    x = row(0.12)
    white = np.cos(2.0 * np.pi * true * x + 1.0) + np.random.default_rng(2).standard_normal(N)
    rate = regular_rate(x)
    assert rate == pytest.approx(100.0, rel=1e-5)
    image = abs(true - 100.0 * round(true / 100.0)) or 100.0
    found, more = unfolded(x, white, image, rate=rate, span=30.0)
    assert found == pytest.approx(true, abs=0.1 / 30.0)  # a tenth of a line; its standard error is a fiftieth
    # The image has the square of the mean phasor of what samples stray, exp(-(2 pi k 0.12)^2), of the wave's power.
    assert more > 1.5


@pytest.mark.parametrize("true", [3.3, 17.0, 41.2])
def test_a_wave_below_half_the_rate_stays(true: float) -> None:
    x = row(0.12)
    white = np.cos(2.0 * np.pi * true * x + 1.0) + np.random.default_rng(2).standard_normal(N)
    assert unfolded(x, white, true, rate=100.0, span=30.0) == (true, 1.0)


def test_noise_has_no_place_above() -> None:
    """The strongest line of noise, 200 draws: seldom more than one in twenty of the odds that are asked is exceeded."""
    x, above = row(0.12), 0
    for seed in range(200):
        white = np.random.default_rng(seed).standard_normal(N)
        lines = np.abs(np.fft.rfft(white))[1:-1]
        k = int(np.argmax(lines)) + 1
        _, more = unfolded(x, white, k / 30.0, rate=100.0, span=30.0)
        gain = 2.0 * lines[k - 1] ** 2 / N
        above += (more - 1.0) * gain > FOLD_ODDS
    assert above <= 10


def test_even_rows_gaps_and_chance_have_no_images_to_tell() -> None:
    rng = np.random.default_rng(3)
    assert regular_rate(row(0.0)) is None
    assert regular_rate(row(0.005)) is None
    assert regular_rate(np.sort(rng.uniform(0.0, 30.0, N))) is None
    gap = row(0.1)
    gap[N // 2 :] += 1.0
    assert regular_rate(gap) is None


def test_peaks_are_told_where_they_are_and_by_the_shaft() -> None:
    """A line 470 times per turn of 9 teeth, in 144 samples a turn: over angle and over time it is as large, and a turn
    makes it."""
    rng = np.random.default_rng(4)
    time = (np.arange(N) + np.clip(0.12 * rng.standard_normal(N), -0.45, 0.45)) / 1440.0
    u = 9.0 * 10.0 * time  # meshes at 10 turns per s
    residual = np.cos(2.0 * np.pi * 470.0 / 9.0 * u) + 0.3 * rng.standard_normal(N)
    estimator = NoiseEstimator(u, z_1=9, z_2=11)
    noise = estimator.estimate(0.3 * rng.standard_normal(N))
    found = find_peaks(sampling_of(u=u, time=time, z_1=9, z_2=11), noise.whitened(residual), noise)
    assert found[0].domain == "order"
    assert 9.0 * found[0].frequency == pytest.approx(470.0, abs=1e-3)
    assert all(one.gain < 0.02 * found[0].gain for one in found[1:])
