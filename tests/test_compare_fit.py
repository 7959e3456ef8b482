"""The fit of compare: what changes at a few samples is whitened there alone, and pairs of teeth carry the load."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.compare.columns import Dense, Scattered, waves
from gearpoly.compare.noise import estimate_noise
from gearpoly.compare.regression import Stack, solve
from gearpoly.compare.sharing import Carried
from tests.residuals import noise, samples


@pytest.mark.parametrize("kind", ["white", "ar"])
def test_columns_that_differ_at_some_samples_give_the_same_normal_matrix(kind: str) -> None:
    rng = np.random.default_rng(1)
    u, _ = samples(rng, z_1=18, z_2=18, cycles=4)
    values = noise(rng, u.size, kind)
    level = estimate_noise(u, values, z_1=18, z_2=18)
    slow, index = rng.normal(size=(u.size, 3)), rng.integers(0, 20, (4, u.size))

    def stack(weight: np.ndarray) -> Stack:
        parts = [
            Scattered(columns=20, index=index, value=weight),
            Dense(columns=slow),
            waves(u, np.array([0.1, 0.7])),
        ]
        ends = np.cumsum([part.size for part in parts])
        return Stack(
            values=values,
            noise=level,
            parts=[(part, np.arange(end - part.size, end)) for part, end in zip(parts, ends, strict=True)],
        )

    weight = rng.normal(size=(4, u.size))
    later = weight.copy()
    moved = np.unique(np.concatenate([[0, 1, u.size - 1], rng.integers(0, u.size, 60)]))
    later[:, moved] = rng.normal(size=(4, moved.size))
    precision = np.ones(27)
    first = stack(weight)
    solve([first], precision=precision)
    again, fresh = stack(later), stack(later)
    found = solve([again], precision=precision, before=[first])
    expected = solve([fresh], precision=precision)
    assert first.white.size == 0  # used up: it was not whitened anew
    # Rounding of sums of 1440 products.
    np.testing.assert_allclose(again.white, fresh.white, rtol=0.0, atol=1e-9 * np.max(np.abs(fresh.white)))
    np.testing.assert_allclose(found.covariance, expected.covariance, rtol=0.0, atol=1e-9 * np.max(expected.covariance))
    np.testing.assert_allclose(found.beta, expected.beta, rtol=0.0, atol=1e-9 * np.max(np.abs(expected.beta)))


def test_pairs_carry_the_load_between_them() -> None:
    """Whatever the teeth deviate by, the forces of the pairs that touch add up to the load, and none of them pulls."""
    rng = np.random.default_rng(2)
    pairs, n = 5, 400
    gap = np.abs(rng.normal(0.0, 20e-3, (pairs, n)))
    gap[rng.uniform(size=gap.shape) < 0.3] = 1e3
    gap[0, np.min(gap, axis=0) > 1.0] = 0.0
    stiffness = rng.uniform(50.0, 150.0, (pairs, n))
    carried = Carried(
        z_1=18,
        z_2=25,
        mesh=np.zeros((pairs, n), dtype=np.int64),
        phase=np.zeros((pairs, n)),
        gap=gap,
        share=np.ones((pairs, n)),
        contact=(-0.8, 0.8),
        stiffness=stiffness,
    )
    deviation = rng.normal(0.0, 5e-3, (pairs, n))

    def place(height: np.ndarray) -> np.ndarray:
        """By bisection, since the force falls as the driven gear moves forward."""
        low, high = np.max(height, axis=0) - 1.0, np.max(height, axis=0)
        for _ in range(60):
            middle = 0.5 * (low + high)
            more = np.sum(stiffness * np.maximum(height - middle, 0.0), axis=0) > 1.0
            low, high = np.where(more, middle, low), np.where(more, high, middle)
        return 0.5 * (low + high)

    before, after = place(-gap), place(deviation - gap)
    # 60 halvings of 1 mm, and rounding.
    np.testing.assert_allclose(carried.change(deviation), after - before, rtol=0.0, atol=1e-12)
    touching = deviation - gap > after
    np.testing.assert_allclose(carried.weights(deviation) > 0.0, touching)
    np.testing.assert_allclose(np.sum(carried.weights(deviation), axis=0), 1.0, rtol=1e-12)


def test_waves_are_the_same_held_or_made_piece_by_piece(monkeypatch: pytest.MonkeyPatch) -> None:
    """Columns that an earlier fit held are those of their frequency, in whatever place it stands now."""
    rng = np.random.default_rng(4)
    u, values, beta = rng.uniform(0.0, 90.0, 40_000), rng.normal(size=40_000), rng.normal(size=6)
    first = waves(u, np.array([0.1, 0.7, 1.3]))
    held = waves(u, np.array([1.3, 0.2, 0.1]), before=first)
    monkeypatch.setattr("gearpoly.compare.columns.HELD_VALUES", 0)
    piecewise = waves(u, np.array([1.3, 0.2, 0.1]))
    assert held.held is not None and piecewise.held is None
    np.testing.assert_allclose(held.apply(beta), piecewise.apply(beta), atol=1e-12)
    np.testing.assert_allclose(held.adjoint(values), piecewise.adjoint(values), atol=1e-9)
    np.testing.assert_array_equal(held.rows(slice(5, 9)), piecewise.rows(slice(5, 9)))
    assert held.changed(first).all() and not held.changed(piecewise).any()
