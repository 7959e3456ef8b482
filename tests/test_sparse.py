"""Columns in blocks of samples: every product against that of the same matrix as an array."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from gearpoly.compare.whitening import backward, forward
from gearpoly.diagnose.sparse import Sparse, full, stacked
from gearpoly.diagnose.system import System
from gearpoly.units import FloatArray

ROUNDING = 1e-12
"""Sums of a few hundred products of order 1, in another order."""


def a_matrix(seed: int = 0) -> tuple[Sparse, FloatArray]:
    """A band of 3 of 12 columns that moves on along 200 rows, in blocks of uneven length, and one column everywhere."""
    rng = np.random.default_rng(seed)
    dense = np.zeros((200, 12))
    for row in range(200):
        dense[row, row // 20 : row // 20 + 3] = rng.normal(size=3)
    dense[:, 11] = rng.normal(size=200)
    starts = np.array([0, 7, 40, 41, 90, 160, 200])
    at, values = [], []
    for row, end in itertools.pairwise(starts):
        seen = np.flatnonzero(dense[row:end].any(axis=0))
        at.append(seen)
        values.append(dense[row:end, seen].ravel())
    first = np.concatenate(([0], np.cumsum([one.size for one in at])))
    sparse = Sparse(
        shape=dense.shape, starts=starts, first=first, at=np.concatenate(at), values=np.concatenate(values)
    )  # fmt: skip
    return sparse, dense


@pytest.mark.parametrize("q", [4, 20])
def test_products_are_those_of_the_array(q: int) -> None:
    sparse, dense = a_matrix()
    rng = np.random.default_rng(1)
    for x, y in ((rng.normal(size=12), rng.normal(size=200)), (rng.normal(size=(12, q)), rng.normal(size=(200, q)))):
        np.testing.assert_allclose(sparse @ x, dense @ x, atol=ROUNDING)
        np.testing.assert_allclose(sparse.T @ y, dense.T @ y, atol=ROUNDING * 200)
    np.testing.assert_allclose(sparse.gram(), dense.T @ dense, atol=ROUNDING * 200)
    np.testing.assert_allclose(sparse.times([5, 2], np.array([1.0, -2.0])), dense[:, [5, 2]] @ [1.0, -2.0])


def test_parts_are_those_of_the_array() -> None:
    sparse, dense = a_matrix()
    np.testing.assert_array_equal(sparse.dense(), dense)
    np.testing.assert_array_equal(sparse.part([9, 0, 11]), dense[:, [9, 0, 11]])
    np.testing.assert_array_equal(sparse.part(slice(2, 5)), dense[:, 2:5])
    np.testing.assert_array_equal(sparse.only(np.array([1, 4, 11])).dense(), dense[:, [1, 4, 11]])
    marked = np.random.default_rng(2).random(200) < 0.3
    marked[7:41] = False  # whole blocks without a row
    for where in (marked, np.flatnonzero(marked)):
        np.testing.assert_array_equal(sparse.rows(where).dense(), dense[marked])
        y = np.random.default_rng(3).normal(size=(np.count_nonzero(marked), 5))
        at = np.flatnonzero(marked)
        np.testing.assert_allclose(sparse.transposed_at(at, y), dense[at].T @ y, atol=ROUNDING * 200)
    none = np.zeros(0, dtype=np.int64)
    bare = sparse.only(none)
    assert not np.any(bare @ np.zeros(0)) and (bare @ np.zeros((0, 2))).shape == (200, 2)
    assert (bare.T @ np.ones(200)).shape == (0,) and (sparse.T @ np.ones((200, 0))).shape == (12, 0)
    assert not np.any(sparse.transposed_at(none, np.zeros((0, 5))))
    assert sparse.only(none).shape == (200, 0)
    more = np.zeros((200, 3))
    more[100:, 1], more[:, 2] = 1.0, 2.0
    np.testing.assert_array_equal(sparse.beside(more).dense(), np.concatenate((dense, more), axis=1))
    other, below = a_matrix(3)
    np.testing.assert_array_equal(stacked([sparse, other]).dense(), np.concatenate((dense, below)))
    np.testing.assert_array_equal(full(dense).dense(), dense)


@pytest.mark.parametrize("taps", [1, 5, 45])
def test_whitening_reaches_over_the_ends_of_blocks(taps: int) -> None:
    """Forth from samples of earlier blocks, back from those of later ones, also where a block is shorter than that."""
    sparse, dense = a_matrix()
    ar = np.random.default_rng(4).normal(size=taps) * 0.1
    forth, back = sparse.forward(ar, 0.5), sparse.backward(ar, 0.5)
    np.testing.assert_allclose(forth.dense(), forward(dense, ar, 0.5), atol=ROUNDING * 10)
    np.testing.assert_allclose(back.dense(), backward(dense, ar, 0.5), atol=ROUNDING * 10)


def test_a_system_that_grows_knows_its_normal_matrix() -> None:
    """With further columns the products of the old ones are not made again: they have to be the same."""
    sparse, dense = a_matrix()
    rng = np.random.default_rng(5)
    more, target = rng.normal(size=(200, 2)), rng.normal(size=200)
    system = System(white=[sparse], target=[target], precision=np.diag(np.arange(1.0, 13.0)), prior=np.ones(12))
    fresh = system.with_columns([more])
    assert system.normal.shape == (12, 12)
    grown = system.with_columns([more])
    np.testing.assert_allclose(grown.normal, fresh.normal, atol=ROUNDING * 200)
    wide = np.concatenate((dense, more), axis=1)
    known = np.diag([*np.arange(1.0, 13.0), 0.0, 0.0])
    right = wide.T @ target + known @ np.append(np.ones(12), [0.0, 0.0])
    np.testing.assert_allclose(grown.solution, np.linalg.solve(wide.T @ wide + known, right), rtol=1e-6)
