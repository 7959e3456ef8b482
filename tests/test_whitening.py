"""The compiled whitening against sums written out in numpy."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.compare.whitening import backward, forward

AR = np.random.default_rng(1).normal(0.0, 0.2, 7)
INNOVATION = 0.7


@pytest.mark.parametrize("shape", [(200, 1), (200, 5), (8, 1), (7, 1), (7, 3), (3, 1), (3, 2)])
def test_whitening_is_the_sum_of_what_went_before(shape: tuple[int, int]) -> None:
    """To the last bit: both add in one order. Records shorter than the model's memory have nothing left."""
    values = np.random.default_rng(2).normal(size=shape)
    want = values / INNOVATION
    for k, a in enumerate(AR, start=1):
        want[k:] -= (a / INNOVATION) * values[:-k]
    want[: AR.size] = 0.0
    assert np.array_equal(forward(values, AR, INNOVATION), want)


@pytest.mark.parametrize("shape", [(200, 1), (200, 5), (8, 1), (3, 1), (3, 2)])
def test_backward_is_the_adjoint_of_whitening(shape: tuple[int, int]) -> None:
    """x . W y = W' x . y for all x that are 0 where W leaves 0, to rounding of 1000 sums."""
    rng = np.random.default_rng(3)
    x, y = rng.normal(size=shape), rng.normal(size=shape)
    x[: AR.size] = 0.0
    there, back = forward(y, AR, INNOVATION), backward(x, AR, INNOVATION)
    assert float(np.sum(x * there)) == pytest.approx(float(np.sum(back * y)), abs=1e-11)
