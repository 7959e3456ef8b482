"""Compiled waves and the periodic curve against numpy's own."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.compare.periodic import periodic
from gearpoly.compare.sinusoids import cosine_and_sine, line_power, refined
from gearpoly.units import FloatArray


def uneven(n: int, *, seed: int = 3) -> FloatArray:
    return np.sort(np.random.default_rng(seed).uniform(-120.0, 280.0, n))


@pytest.mark.parametrize("n", [1, 255, 256, 3001])
def test_cosines_and_sines_are_numpy_s(n: int) -> None:
    x, frequency = uneven(n), np.array([0.25, 1.0, 1.2345, 17.7])
    turns = np.outer(x, frequency)
    turns -= np.rint(turns)
    columns = cosine_and_sine(x, frequency)
    # Four roundings of numbers up to 1.
    assert columns[:, 0::2] == pytest.approx(np.cos(2.0 * np.pi * turns), abs=1e-15)
    assert columns[:, 1::2] == pytest.approx(np.sin(2.0 * np.pi * turns), abs=1e-15)


def test_quarters_of_a_turn_are_exact() -> None:
    columns = cosine_and_sine(np.arange(8) / 4.0, np.ones(1))
    assert np.array_equal(columns[:, 0], [1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0])
    assert np.array_equal(columns[:, 1], [0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0])


def test_the_power_of_a_line_is_its_sum_squared() -> None:
    x = uneven(5000)
    values = np.random.default_rng(1).normal(size=x.size)
    own = abs(np.sum(values * np.exp(-2j * np.pi * 1.2345 * x))) ** 2
    # Both add 5000 numbers of size 1 whose sum is of size 70.
    assert line_power(x, values, 1.2345) == pytest.approx(own, rel=1e-10)


@pytest.mark.parametrize("n", [900, 5000, 40_001])
@pytest.mark.parametrize("off", [-0.4, -0.1, 0.0, 0.3])
def test_a_line_is_placed_where_its_power_is_largest(n: int, off: float) -> None:
    """``off`` lines from where it is looked for; a scan of a thousandth of a line finds no larger power."""
    x = uneven(n)
    span = float(np.ptp(x))
    true = 1.2345
    values = np.cos(2.0 * np.pi * true * x + 0.7) + 0.3 * np.random.default_rng(2).normal(size=n)
    found, more = refined(x, values, true + off / span, span)
    assert more == pytest.approx(line_power(x, values, found) / line_power(x, values, true + off / span), rel=1e-3)
    there = [line_power(x, values, found + k * 1e-3 / span) for k in range(-20, 21)]
    # A thousandth of a line off, a line loses a millionth of its power.
    assert max(there) <= there[20] * (1.0 + 2e-6)


def test_further_than_a_line_stands_another_one() -> None:
    """Of noise alone, what climbs away is left where it was."""
    x = uneven(2000)
    values, span = np.random.default_rng(8).normal(size=x.size), float(np.ptp(x))
    for k in range(40):
        found, more = refined(x, values, 1.0 + k * 0.37 / span, span)
        assert abs(found - (1.0 + k * 0.37 / span)) * span <= 0.75
        assert more > 0.0


@pytest.mark.parametrize("turned", [1, -1])
def test_a_periodic_curve_is_drawn_straight_between_its_points(turned: int) -> None:
    rng = np.random.default_rng(5)
    points = np.concatenate(([0.0], np.sort(rng.uniform(0.0, 17.3, 4000)), [17.3]))
    values = np.cumsum(rng.normal(size=points.size)) * 1e-3
    values[-1] = values[0]
    for x in (np.sort(rng.uniform(-100.0, 300.0, 9000))[::turned], rng.uniform(-100.0, 300.0, 9000), points):
        # Between points a micrometre apart the curve is 1e4 steep; turns of 300 are rounded to 3e-14.
        assert periodic(x, points, values) == pytest.approx(np.interp(np.mod(x, 17.3), points, values), abs=1e-9)
