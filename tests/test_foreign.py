"""Waves of unknown make that are fitted beside everything, and let go of once something claimed has explained them."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, Literal

import numpy as np

from gearpoly.compare.entries import Entry
from gearpoly.diagnose.foreign import _images, faded, foreign_entries, found_alone, smooth_orders, swells_by
from gearpoly.diagnose.sparse import full
from gearpoly.diagnose.system import System
from gearpoly.keys.also_turns import Part
from gearpoly.units import FloatArray

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
    system = System(white=[full(white)], target=[target], precision=np.zeros((m, m)), prior=np.zeros(m))
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


def at_turns(recorded: Callable[[FloatArray], FloatArray], orders: list[float]) -> tuple[Any, list[tuple[int, Any]]]:
    """What an alignment leaves of 40 turns at 200 samples a turn, taken unevenly by a third of their distance, and
    waves of the driven shaft that were located there."""
    turns = 40.0 * np.arange(8000) / 8000
    turns += np.sin(2.0 * np.pi * turns * 0.7) * 0.3 / 200.0
    theta = 2.0 * np.pi * turns
    angles = theta * 7.0 / 5.0, theta
    aligned = SimpleNamespace(
        residual=recorded(theta), theta_1=angles[0], theta_2=theta, estimated=angles, time_s=None, averaged=0.0
    )
    waves = [SimpleNamespace(kind="shaft_order", gear="driven", order=order, hz=None, moment=None) for order in orders]
    return SimpleNamespace(aligned=[aligned]), [(0, one) for one in waves]


def test_lines_of_an_encoder_above_half_the_sampling_rate_leave_no_foreign_waves() -> None:
    """Order 480 shows at 80 and beside it; a bearing's 33.3 is its own."""
    lines = [80.0, 79.3, 80.7, 33.3]
    beside, waves = at_turns(lambda theta: np.cos(480.0 * theta) + 0.4 * np.cos(33.3 * theta), lines)
    images = _images(beside, waves)
    assert [one.order for _, one in waves if id(one) not in images] == [33.3]


def test_as_many_waves_as_no_encoder_has_lines_stay_where_they_were_located() -> None:
    """A search asks after encoders' lines alone above half the sampling rate: 470 waves a turn are fitted as they are,
    480 are left to it."""
    for order, stays in ((470.0, [470.0]), (480.0, [])):
        beside, waves = at_turns(lambda theta, order=order: np.cos(order * theta), [order])  # type: ignore[misc]
        images = _images(beside, waves)
        assert [one.order for _, one in waves if id(one) not in images] == stays


def test_a_wave_is_no_image_of_what_would_be_its_own_image() -> None:
    """At order 70 itself, samples that come so unevenly show less of it anywhere else."""
    beside, waves = at_turns(lambda theta: np.cos(70.0 * theta), [70.0, 33.3])
    assert not _images(beside, waves)


def test_lines_beside_the_mesh_are_its_own_swelling_in_a_run_up() -> None:
    """Of 18 on 25 teeth: what stands within half an order of a mesh order, of either shaft; not a low order, however
    near to nothing, and nothing that is no wave of a shaft."""

    def swells(order: float, gear: Literal["driving", "driven"] = "driving") -> bool:
        return swells_by(Entry(kind="shaft_order", gear=gear, order=order, p_value=0.0, recordings=(0,)), 18, 25)

    assert [swells(order) for order in (17.99, 18.01, 35.86, 17.4, 0.3, 27.0)] == [
        True,
        True,
        True,
        False,
        False,
        False,
    ]
    assert swells(24.98, "driven") and not swells(18.01, "driven")
    assert not swells_by(Entry(kind="time", hz=18.0, p_value=0.0, recordings=(0,)), 18, 25)


def test_the_mesh_of_a_wheel_that_the_file_states_is_fitted_where_nothing_was_located() -> None:
    """A wheel of 16 teeth that turns with 5/7 of the driven gear: 16, 32 and 48 times 7/5. Not where a wave was located
    already, at the pair's own mesh (order 7), or above half the sampling rate (100 per turn)."""
    beside, _ = at_turns(np.cos, [])
    beside.gears = tuple(SimpleNamespace(z=z) for z in (5, 7))
    beside.located = SimpleNamespace(entries=[])
    wheel = Part(name="wheel", turns=7.0 / 5.0, teeth=16)

    def orders(*parts: Part) -> list[float]:
        return [round(entry.order or 0.0, 9) for _, entry in foreign_entries(beside, parts)]

    assert orders() == []
    assert orders(wheel) == [22.4, 44.8, 67.2]
    assert orders(wheel, wheel) == [22.4, 44.8, 67.2]
    assert orders(Part(name="motor", turns=3.0)) == []
    assert orders(Part(name="twin", turns=1.0, teeth=7)) == []
    assert orders(Part(name="fine", turns=1.0, teeth=45)) == [45.0, 90.0]


def test_a_wave_at_a_whole_order_of_both_shafts_may_be_of_either_gear() -> None:
    """Of 24 and 36 teeth order 2 of the driving shaft is order 3 of the driven one, order 3 is none, and a jump has
    none."""

    def wave_at(gear: Literal["driving", "driven"], order: float) -> Entry:
        return Entry(kind="shaft_order", gear=gear, order=order, p_value=0.0, recordings=(0,))

    ones = [wave_at("driving", order) for order in (2.0, 3.0, 1.7)]
    jump = Entry(kind="step", driving_turn=0.5, p_value=0.0, recordings=(0,))
    assert smooth_orders([(0, one) for one in (*ones, jump)], z=(24, 36)) == {(0, 2), (1, 3), (0, 3)}
    assert smooth_orders([(0, wave_at("driven", 3.0))], z=(24, 36)) == {(1, 3), (0, 2)}
