"""Sizes of waves that nothing explains, read off sums made once for all of them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.slow import slow_curves
from gearpoly.diagnose.as_recorded import CLOSE, _sums

MESHES, NOISE_MM = 300.0, 0.003
ORDERS = [2.0 / 18.0, 5.0 / 18.0, 3.0 / 25.0, 1.0, 19.0 / 18.0, 1.0 / 18.0]


def recorded(values_of: Any) -> tuple[Any, Any, Any]:
    rng = np.random.default_rng(1)
    u = np.sort(rng.uniform(0.0, MESHES, 4000))
    values = values_of(u) + rng.normal(0.0, NOISE_MM, u.size)
    tau = 0.2
    # Density of white noise whose samples are one apart: its mean is the square of the level.
    noise = SimpleNamespace(frequency=np.array([0.0, 3.0]), density=np.full(2, NOISE_MM**2))
    search: Any = SimpleNamespace(
        scenes=[SimpleNamespace(samples=SimpleNamespace(theta_2=u * tau))],
        model=SimpleNamespace(scope=SimpleNamespace(gears=(SimpleNamespace(tau=0.3), SimpleNamespace(tau=tau)))),
        noises=[noise],
    )
    return search, u, values


def test_each_is_as_large_as_a_fit_of_all_has_it() -> None:
    """Against least squares of the waves themselves, to rounding; and the sizes that were put in, to three of their
    standard errors."""
    search, u, values = recorded(lambda u: sum(0.01 * np.cos(2.0 * np.pi * f * u + f) for f in ORDERS) + 1e-5 * u)
    sums = _sums(search, 0, values, ORDERS)
    for own in ORDERS:
        every = [own, *(f for f in ORDERS if f != own)]
        angle = 2.0 * np.pi * np.outer(u, every)
        waves = np.stack([np.cos(angle), np.sin(angle)], axis=2).reshape(u.size, -1)
        columns = np.concatenate([waves, slow_curves(u)], axis=1)
        heights = np.linalg.lstsq(columns, values, rcond=None)[0][:2]
        along = heights / np.hypot(*heights)
        size, std, phase = sums.wave([own, *ORDERS])
        assert size == pytest.approx(np.hypot(*heights), rel=1e-10)
        assert std == pytest.approx(NOISE_MM * np.linalg.norm(along @ np.linalg.pinv(columns)[:2]), rel=1e-8)
        assert phase == pytest.approx(np.arctan2(heights[1], heights[0]), abs=1e-8)
        assert abs(size - 0.01) < 3.0 * std


def test_of_two_orders_too_near_for_two_sizes_the_first_is_told() -> None:
    """Half a line apart: beside each other both would have any size."""
    near = ORDERS[0] + 0.5 * CLOSE / MESHES
    search, _, values = recorded(lambda u: 0.01 * np.cos(2.0 * np.pi * ORDERS[0] * u))
    size, std, _ = _sums(search, 0, values, [ORDERS[0], near]).wave([ORDERS[0], near])
    assert abs(size - 0.01) < 3.0 * std
    assert std < 2.0 * NOISE_MM * np.sqrt(2.0 / values.size)
