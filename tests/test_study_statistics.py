"""Percentiles, yields and sensitivities against closed forms and against what intervals promise."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import qmc

from gearpoly.study.statistics import factorial_indices, mean, percentile, saltelli_indices, share
from gearpoly.units import FloatArray


@pytest.mark.parametrize(("n", "p"), [(20, 50.0), (100, 90.0), (500, 99.0)])
def test_intervals_of_percentiles_cover_as_often_as_they_say(n: int, p: float) -> None:
    rng = np.random.default_rng(1)
    runs = 300
    inside = 0
    for _ in range(runs):
        found = percentile(rng.exponential(size=n), p)
        inside += found.low <= -math.log(1.0 - p / 100.0) <= found.high
    # Never below 95 % but for the scatter of 300 runs (3 standard errors: 0.038); above it since ranks are whole.
    assert inside / runs >= 0.95 - 0.038


def test_ends_that_few_values_cannot_place_are_open() -> None:
    found = percentile(np.arange(20.0), 99.0)
    assert found.high == math.inf
    assert found.low == 18.0  # P(19 or more of 20 below the 99th percentile) = 0.983 > 0.975, for 20 of 20 it is 0.82
    assert percentile(np.arange(20.0), 1.0).low == -math.inf
    assert math.isnan(percentile(np.empty(0), 50.0).value)
    assert percentile(np.array([3.0]), 50.0).width == math.inf


def test_interval_of_a_median_by_hand() -> None:
    """n = 10: ranks 2 and 9, since P(B <= 1) = 11/1024 is below 2.5 % and P(B <= 2) = 56/1024 is above."""
    found = percentile(np.arange(1.0, 11.0), 50.0)
    assert (found.low, found.high) == (2.0, 9.0)
    assert found.value == 5.5


def test_shares_are_clopper_pearson() -> None:
    # All of n good: the lower end is (alpha/2)^(1/n).
    assert share(30, 30).low == pytest.approx(0.025 ** (1 / 30))
    assert share(30, 30).high == 1.0
    assert share(0, 30).high == pytest.approx(1 - 0.025 ** (1 / 30))
    # Mirror image: the share of bad ones.
    assert share(7, 20).low == pytest.approx(1.0 - share(13, 20).high)
    n = math.ceil(math.log(0.025) / math.log(0.99))  # as many in a row that more than 99 % are good
    assert share(n, n).low >= 0.99 > share(n - 1, n - 1).low


def test_mean_covers() -> None:
    rng = np.random.default_rng(2)
    inside = sum(one.low <= 1.0 <= one.high for one in (mean(rng.normal(1.0, 2.0, 12)) for _ in range(2000)))
    assert inside / 2000 == pytest.approx(0.95, abs=0.015)  # 3 standard errors


def test_indices_of_an_additive_table_are_shares_of_its_variance() -> None:
    rng = np.random.default_rng(4)
    a, b, chance = np.array([0.0, 1.0, 5.0]), np.array([0.0, 2.0]), rng.normal(size=400)
    table = a[:, None, None] + b[None, :, None] + chance[None, None, :]
    found = {one.factor: one for one in factorial_indices(table, ["a", "b", "chance"], resamples=50)}
    whole = np.var(a) + np.var(b) + np.var(chance)
    for name, values in (("a", a), ("b", b), ("chance", chance)):
        # No interplay: first and total agree and are exact, to rounding.
        assert found[name].first.value == pytest.approx(np.var(values) / whole, abs=1e-12)
        assert found[name].total.value == pytest.approx(np.var(values) / whole, abs=1e-12)
        assert found[name].first.low <= found[name].first.value <= found[name].first.high


def test_indices_of_a_product_are_all_interplay() -> None:
    """y = x c with x = -1, 1 and c of mean 0: neither makes anything on its own, both have a part in all of it."""
    rng = np.random.default_rng(5)
    chance = rng.normal(size=500)
    found = factorial_indices(np.array([-1.0, 1.0])[:, None] * chance, ["x", "chance"], resamples=50)
    assert found[0].first.value < 0.01  # the mean of 500 draws, squared: 1/500
    assert found[0].total.value == pytest.approx(1.0, abs=0.01)
    assert found[1].first.value == pytest.approx(0.0, abs=1e-12)
    assert found[1].total.value == pytest.approx(1.0, abs=0.01)


def test_indices_of_what_does_not_vary_are_none() -> None:
    assert factorial_indices(np.ones((3, 8)), ["x", "chance"]) == []
    assert factorial_indices(np.arange(3.0)[:, None], ["x", "chance"]) == []
    assert saltelli_indices(np.ones((8, 4)), ["a", "b"]) == []


def test_saltelli_gives_ishigami_its_indices() -> None:
    """Ishigami and Homma 1990 with a = 7, b = 0.1: indices in closed form."""

    def f(x: FloatArray) -> FloatArray:
        return np.asarray(np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0]))

    points = qmc.Sobol(6, rng=np.random.default_rng(6)).random_base2(13) * 2 * np.pi - np.pi
    A, B = points[:, :3], points[:, 3:]
    columns = [f(A), f(B)]
    for k in range(3):
        mixed = A.copy()
        mixed[:, k] = B[:, k]
        columns.append(f(mixed))
    found = saltelli_indices(np.stack(columns, axis=1), ["1", "2", "3"], resamples=30)
    variance = 0.1 * math.pi**4 / 5 + 0.01 * math.pi**8 / 18 + 0.5 + 49 / 8
    first = [0.5 * (1 + 0.1 * math.pi**4 / 5) ** 2 / variance, 49 / 8 / variance, 0.0]
    joint = 0.01 * math.pi**8 * (1 / 18 - 1 / 50) / variance
    for one, expected, total in zip(found, first, (first[0] + joint, first[1], joint), strict=True):
        # 8192 points: the estimator of the first order scatters by 1/sqrt(n), 0.011, that of the total by less.
        assert one.first.value == pytest.approx(expected, abs=0.03)
        assert one.total.value == pytest.approx(total, abs=0.02)
        assert one.first.low <= expected <= one.first.high
