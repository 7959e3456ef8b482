"""The noise estimate against noise that is known, under all that is no noise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_toeplitz
from scipy.signal import savgol_filter

from gearpoly.compare.angles import PARABOLA_SAMPLES, smoothed
from gearpoly.compare.noise import estimate_noise, pooled_level
from gearpoly.compare.noise_spectrum import _orders
from gearpoly.compare.slow import slow_curves
from gearpoly.compare.spectrum import FrequencyGrid, Repeating
from tests.residuals import noise, samples


def test_every_order_of_the_autoregressive_model_solves_its_equations() -> None:
    """Of noise that rises towards slow lines by a factor of 1e4, against a solver of each order by itself."""
    power = 1.0 / (1e-4 + np.linspace(0.0, 1.0, 513)) + 3.0 * np.exp(
        -(((np.linspace(0.0, 1.0, 513) - 0.3) / 0.02) ** 2)
    )
    covariance = np.fft.irfft(power)
    orders = list(_orders(covariance, 24))
    assert [ar.size for ar, _ in orders] == list(range(25))
    for order, (ar, left) in enumerate(orders[1:], start=1):
        expected = solve_toeplitz(covariance[:order], covariance[1 : order + 1])
        np.testing.assert_allclose(ar, expected, rtol=1e-7, atol=1e-10)
        assert left == pytest.approx(float(covariance[0] - expected @ covariance[1 : order + 1]), rel=1e-8)


@pytest.mark.parametrize("size", [PARABOLA_SAMPLES, 18, 300])
def test_smoothing_is_that_of_a_second_implementation(size: int) -> None:
    """The middle of a parabola through 17 samples, and the parabolas themselves at both ends."""
    te = np.cumsum(np.random.default_rng(size).normal(size=size))
    np.testing.assert_allclose(smoothed(te), savgol_filter(te, PARABOLA_SAMPLES, 2), atol=1e-12)
    np.testing.assert_array_equal(smoothed(te[:5]), te[:5])


def test_transform_is_the_sum_it_stands_for() -> None:
    rng = np.random.default_rng(1)
    x = np.cumsum(rng.uniform(0.5, 1.5, 700)) / 20.0
    values = rng.normal(size=x.size)
    grid = FrequencyGrid(x, step=0.01, count=400)
    direct = np.exp(-2j * np.pi * np.outer(np.arange(400) * 0.01, x)) @ values
    # The bell is good to a few millionths of the largest sum.
    assert np.max(np.abs(grid.transform(values) - direct)) < 1e-5 * np.max(np.abs(direct))
    amplitudes = rng.normal(size=400) + 1j * rng.normal(size=400)
    wave = (np.exp(2j * np.pi * np.outer(x, np.arange(400) * 0.01)) @ amplitudes).real
    assert np.max(np.abs(grid.wave(amplitudes) - wave)) < 1e-5 * np.sum(np.abs(amplitudes))


@pytest.mark.long
@pytest.mark.parametrize("wrapped", [False, True])
def test_a_grid_held_in_parts_gives_the_sums_it_stands_for(wrapped: bool) -> None:
    """400 000 places, and samples that go round them once, or so often that none has its neighbour beside it."""
    rng = np.random.default_rng(1)
    x = np.cumsum(rng.uniform(0.5, 1.5, 5000)) + 1e4
    x = 1e9 * rng.uniform(size=5000) if wrapped else x
    values = rng.normal(size=x.size)
    grid = FrequencyGrid(x, step=1e-5, count=100_000)
    at = np.concatenate([np.arange(5), rng.integers(0, 100_000, 200), [49_999, 50_000, 50_001, 99_999]])
    direct = np.exp(-2j * np.pi * np.outer(at * 1e-5, x)) @ values
    # The bell is good to a few millionths of the largest sum.
    assert np.max(np.abs(grid.transform(values)[at] - direct)) < 1e-5 * np.max(np.abs(direct))
    assert np.max(np.abs(grid.power(values)[at] - np.abs(direct) ** 2)) < 1e-5 * np.max(np.abs(direct)) ** 2
    assert np.max(np.abs(grid.transforms(values[:, None], at=at)[:, 0] - direct)) < 1e-5 * np.max(np.abs(direct))


def test_repeating_part_takes_all_that_repeats() -> None:
    rng = np.random.default_rng(2)
    u, _ = samples(rng, z_1=18, z_2=25, cycles=2)
    pattern = rng.normal(size=450)
    values = pattern[np.floor(u).astype(int) % 450] * np.sin(np.pi * u) ** 2
    left = values - Repeating(u, period=450.0, count=4500).part(values)
    # The pattern's kinks have harmonics beyond the fit; they hold less than 1 % of its amplitude.
    assert np.std(left) < 0.01 * np.std(values)


@pytest.mark.long
@pytest.mark.parametrize("kind", ["white", "ar"])
@pytest.mark.parametrize(("z_1", "z_2", "cycles"), [(18, 25, 2), (12, 47, 2), (18, 18, 10)])
def test_level_beside_what_is_no_noise(kind: str, z_1: int, z_2: int, cycles: int) -> None:
    errors = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        u, t = samples(rng, z_1=z_1, z_2=z_2, cycles=cycles)
        x = noise(rng, u.size, kind)
        other = 5e-3 * np.cos(2 * np.pi * u / z_1) + 2e-3 * np.cos(2 * np.pi * u * (3 / z_1 + 1 / z_2))
        other += 0.3e-3 * np.cos(2 * np.pi * 50.0 * t) + 0.5e-3 * np.cos(2 * np.pi * 4.41 / z_1 * u) + 2e-3 * t / t[-1]
        found = estimate_noise(u, x + other, z_1=z_1, z_2=z_2)
        assert found.cycles == cycles
        errors.append(found.level / np.std(x) - 1.0)
    # The issue asks for 5 %; the scatter at 3600 samples and more is 1 to 2 %.
    assert np.max(np.abs(errors)) < 0.05


@pytest.mark.long
def test_hand_overs_steeper_than_samples_are_no_noise() -> None:
    """Every mesh steps by 3 um where its own pair of teeth hands over: all of it repeats, but no wave that 20 samples
    per mesh can follow is as steep."""
    errors = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        u, _ = samples(rng, z_1=18, z_2=25, cycles=2)
        x = noise(rng, u.size, "ar", 0.3e-3)
        n = np.floor(u).astype(int)
        place = 0.4 + rng.uniform(-0.015, 0.015, 18)[n % 18] + rng.uniform(-0.015, 0.015, 25)[n % 25]
        steps = 3e-3 * (u - n > place) - 3e-3 * (u - n)
        errors.append(estimate_noise(u, x + steps, z_1=18, z_2=25).level / np.std(x) - 1.0)
    # The issue asks for 5 %; taken for noise the steps would make it a fifth larger.
    assert np.max(np.abs(errors)) < 0.05


@pytest.mark.long
def test_noise_is_taken_off_no_phase_of_the_mesh() -> None:
    """Honest noise is as it was: one phase in some hundred lies beyond four standard errors by chance."""
    levels = []
    for seed in range(10):
        rng = np.random.default_rng(seed)
        u, _ = samples(rng, z_1=18, z_2=18, cycles=20)
        levels.append(estimate_noise(u, noise(rng, u.size, "white"), z_1=18, z_2=18).level / 1e-3 - 1.0)
    # Ten of 7200 samples scatter by 0.9 % each, and by 0.3 % together; four of these.
    assert abs(np.mean(levels)) < 0.012


@pytest.mark.long
def test_a_thinned_spectrum_is_the_spectrum() -> None:
    rng = np.random.default_rng(10)
    u, _ = samples(rng, z_1=18, z_2=18, cycles=100, per_mesh=60)
    whole = estimate_noise(u, noise(rng, u.size, "ar"), z_1=18, z_2=18)
    thin = whole.thinned()
    assert thin.frequency.size < 0.6 * whole.frequency.size
    at = np.linspace(whole.frequency[0], whole.frequency[-1], 1000)
    # Each line is a mean over up to 400, known to 5 %; its neighbours share nearly all of them.
    for old, new in zip(whole.rest_at(at), thin.rest_at(at), strict=True):
        assert new == pytest.approx(old, rel=0.02)


def test_level_states_its_own_error() -> None:
    pulls = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        u, _ = samples(rng, z_1=18, z_2=18, cycles=10)
        found = estimate_noise(u, noise(rng, u.size, "ar"), z_1=18, z_2=18)
        pulls.append((found.level - 1e-3) / found.level_std)
    # 60 pulls of spread 1 have a spread within 0.73 and 1.3 (3 sigma); smoothing adds some.
    assert 0.6 < np.std(pulls) < 1.5
    assert abs(np.mean(pulls)) < 0.8


@pytest.mark.parametrize("kind", ["ar", "wandering"])
def test_model_whitens(kind: str) -> None:
    rng = np.random.default_rng(5)
    u, _ = samples(rng, z_1=18, z_2=25, cycles=2)
    x = noise(rng, u.size, kind)
    found = estimate_noise(u, x, z_1=18, z_2=25)
    # Slower than the record is drift, which every fit takes off by the same curves.
    curves = slow_curves(u)
    white = found.whitened(x - curves @ np.linalg.lstsq(curves, x, rcond=None)[0])[100:]
    assert np.std(white) == pytest.approx(1.0, abs=0.04)  # 18000 samples scatter by 0.5 %, the slow lines add some
    # Correlations of 18000 white samples scatter by 0.0075; four of these and what the model smooths over.
    for lag in range(1, 10):
        assert abs(np.mean(white[lag:] * white[:-lag])) < 0.04


def test_score_is_the_transpose_of_whitening() -> None:
    rng = np.random.default_rng(6)
    u, _ = samples(rng, z_1=18, z_2=18, cycles=4)
    found = estimate_noise(u, noise(rng, u.size, "ar"), z_1=18, z_2=18)
    a, b = rng.normal(size=(2, u.size))
    a[:50] = 0.0  # the first samples have no past and are left out
    assert found.whitened(a) @ found.whitened(b) == pytest.approx(a @ found.score(found.whitened(b)), rel=1e-9)


def test_repeatable_rms() -> None:
    rng = np.random.default_rng(7)
    u, _ = samples(rng, z_1=18, z_2=25, cycles=2)
    signal = 0.4e-3 * np.cos(2 * np.pi * u * 3 / 25)
    found = estimate_noise(u, signal + noise(rng, u.size, "white"), z_1=18, z_2=25)
    # 0.4/sqrt 2 um under 1 um of noise: 9000 fitted terms take along half its power, known to 1.5 %.
    assert found.repeatable == pytest.approx(0.4e-3 / np.sqrt(2), rel=0.2)


def test_short_record_says_what_stands_in_for_repetition() -> None:
    rng = np.random.default_rng(8)
    u, _ = samples(rng, z_1=12, z_2=47, cycles=0.3)
    found = estimate_noise(u, noise(rng, u.size, "ar") + 3e-3 * np.cos(2 * np.pi * u / 12), z_1=12, z_2=47)
    assert found.cycles == 0
    assert found.repeatable is None
    assert "0.3 hunting cycles" in found.basis
    assert abs(found.level - 1e-3) < 3.0 * found.level_std
    assert found.level_std > 0.05 * found.level  # the model's doubt is more than the scatter


def test_too_few_samples() -> None:
    with pytest.raises(ValueError, match="64 would do"):
        estimate_noise(np.arange(20.0), np.zeros(20), z_1=18, z_2=25)


def test_pooled_level_weighs_samples() -> None:
    rng = np.random.default_rng(9)
    u, _ = samples(rng, z_1=18, z_2=18, cycles=4)
    one = estimate_noise(u, noise(rng, u.size, "white"), z_1=18, z_2=18)
    two = estimate_noise(u, noise(rng, u.size, "white", 3e-3), z_1=18, z_2=18)
    assert pooled_level([one, two], [1, 3]) ** 2 == pytest.approx((one.level**2 + 3 * two.level**2) / 4)
