"""The way of a fit on problems whose bottom is known: a bent valley, a curve with kinks, a straight line."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from gearpoly.diagnose.sparse import full
from gearpoly.diagnose.system import System
from gearpoly.diagnose.way import Way
from gearpoly.units import FloatArray

Curve = Callable[[FloatArray], FloatArray]


def system(of: Curve, x: FloatArray, *, step: float = 1e-7) -> System:
    """The residuals ``of`` (n,) linear about ``x`` (m,), every parameter known to 1000 beforehand."""
    here = of(x)
    columns = np.column_stack([(here - of(x + step * unit)) / step for unit in np.eye(x.size)])
    return System(
        white=[full(columns)], target=[here + columns @ x], precision=1e-6 * np.eye(x.size), prior=np.zeros(x.size)
    )


def walked(of: Curve, start: FloatArray, *, most: int) -> tuple[FloatArray, int, list[float]]:
    """Where a fit comes to rest, after how many looks at the curve, and the square misfits of the states it kept."""
    way, x, good, kept = Way(), start.copy(), start.copy(), []
    for n in range(1, most + 1):
        linear = system(of, x)
        if way.overshot(linear, x):
            if not way.again():
                return good, n, kept
            x = good + way.step
            continue
        kept.append(float(of(x) @ of(x)))
        good = x.copy()
        way.go(linear, x)
        if way.rests:
            return x, n, kept
        x = x + way.step
    return x, most, kept


def valley(x: FloatArray) -> FloatArray:
    """Rosenbrock's valley: a floor ten times as flat as its walls are steep, and bent."""
    return np.array([300.0 * (x[1] - x[0] ** 2), 30.0 * (1.0 - x[0])])


def test_a_straight_problem_takes_one_step() -> None:
    a = np.array([[3.0, 1.0], [1.0, 2.0], [0.5, -1.0]])
    x, looks, _ = walked(lambda x: 10.0 * (a @ x - a @ np.array([2.0, -1.0])), np.zeros(2), most=10)
    assert looks <= 3
    np.testing.assert_allclose(x, [2.0, -1.0], atol=1e-4)  # the prior of 1000 pulls by a millionth


def test_a_bent_valley_is_walked_to_its_end() -> None:
    """A misfit of 1 is what a fit leaves undone; the valley's floor falls by 4000 to (1, 1)."""
    x, looks, kept = walked(valley, np.array([-1.2, 1.0]), most=40)
    assert looks < 40
    assert float(valley(x) @ valley(x)) < 1.0
    assert kept == sorted(kept, reverse=True) or max(np.diff(kept)) < 1.0  # no kept state is worse than is negligible


def hand_over(x: FloatArray) -> FloatArray:
    """Two flanks of which the higher one counts, as without load, against the same with 1 and -2."""
    s = np.linspace(-1.0, 1.0, 200)

    def highest(x: FloatArray) -> FloatArray:
        return np.maximum(x[0] * (s + 0.6), x[1] * (s - 0.5))

    return 20.0 * (highest(x) - highest(np.array([1.0, -2.0])))


@pytest.mark.parametrize("start", [(0.2, -0.1), (0.1, 0.0), (4.0, -0.5), (0.3, -8.0)])
def test_a_curve_with_kinks_is_fitted_whatever_it_begins_with(start: tuple[float, float]) -> None:
    """Which flank counts changes with every step, so that whole steps overshoot."""
    x, looks, _ = walked(hand_over, np.array(start), most=40)
    assert looks < 40
    np.testing.assert_allclose(x, [1.0, -2.0], atol=0.02)  # a misfit of 1 of 200 samples at 20 each is 0.004


def test_what_is_not_in_the_simulation_is_where_it_fits_best() -> None:
    """The misfit at a state with an open parameter is that of the best value of it."""
    rng = np.random.default_rng(2)
    one = System(
        white=[full(rng.standard_normal((30, 3)))],
        target=[rng.standard_normal(30)],
        precision=np.eye(3),
        prior=np.zeros(3),
    )
    state = np.array([0.3, -0.2, np.nan])
    tried = [one.misfit_at(np.array([0.3, -0.2, z])) for z in np.linspace(-2.0, 2.0, 4001)]
    assert one.misfit_at(state) == pytest.approx(min(tried), rel=1e-6)
    assert one.misfit_at(one.solution) == pytest.approx(one.misfit)


def test_what_neither_data_nor_priors_fix_stays_where_it_is() -> None:
    """A parameter that nothing depends on makes the normal matrix singular; damped steps leave it alone."""
    a = np.array([[3.0, 0.0], [0.5, 0.0]])
    free = System(white=[full(a)], target=[a @ np.array([2.0, 0.0])], precision=np.zeros((2, 2)), prior=np.zeros(2))
    plain, damped = (free.damped(free.normal @ free.solution, np.full(2, more)) for more in (0.0, 1.0))
    np.testing.assert_allclose(plain, [2.0, 0.0], atol=1e-8)
    np.testing.assert_allclose(damped, [1.0, 0.0], atol=1e-8)  # the diagonal counts twice
