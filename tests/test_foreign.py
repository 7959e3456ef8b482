"""Waves of unknown make that are fitted beside everything, and let go of once something claimed has explained them."""

from __future__ import annotations

import numpy as np

from gearpoly.diagnose.foreign import faded, found_alone
from gearpoly.diagnose.system import System

N = 4000


def wave(order: float) -> np.ndarray:
    angle = 2.0 * np.pi * order * np.arange(N) / N
    return np.column_stack((np.cos(angle), np.sin(angle)))


def made(orders: list[float], recorded: np.ndarray, beside: np.ndarray | None = None) -> tuple[System, list[list[int]]]:
    """A system of a claim's column, if any, after waves; noise of one unit."""
    columns = [wave(order) for order in orders] + ([] if beside is None else [beside[:, None]])
    white = np.concatenate(columns, axis=1)
    m = white.shape[1]
    target = recorded + np.random.default_rng(3).normal(0.0, 1.0, N)
    system = System(white=[white], target=[target], precision=np.zeros((m, m)), prior=np.zeros(m))
    return system, [[2 * k, 2 * k + 1] for k in range(len(orders))]


def test_a_wave_stays_as_long_as_nothing_else_explains_it() -> None:
    """An error that swells over the recording shows as lines on either side of its order, until it has a column."""
    swelling = wave(40.0)[:, 0] * np.linspace(0.0, 1.0, N)
    orders = [39.4, 40.6, 300.3]
    recorded = swelling + 0.3 * wave(300.3)[:, 1]
    system, waves = made(orders, recorded)
    assert faded(system, waves, slice(0, 6)) == []
    system, waves = made(orders, recorded, swelling)
    assert faded(system, waves, slice(0, 6)) == [0, 1]


def test_of_waves_so_near_that_either_would_do_not_all_go() -> None:
    """A tenth of an independent line apart each is weak beside the other, and both are not."""
    system, waves = made([40.0, 40.1], 0.2 * wave(40.05)[:, 0])
    gone = faded(system, waves, slice(0, 4))
    assert len(gone) == 1


def test_what_is_no_wave_is_asked_for_column_by_column() -> None:
    """Two waves, the second in two recordings, and a jump between them."""
    assert found_alone([(0, 1), (3, 4, 5, 6)], slice(10, 18)) == [[10, 11], [13, 14, 15, 16], [12], [17]]
