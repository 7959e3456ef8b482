"""Waves in coloured noise and at the orders of the sampling: what tells of them, and what only seems to."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.noise import Noise
from gearpoly.diagnose.fidelity import FAINT_EFFECT_MM
from gearpoly.diagnose.floors import reading_floor
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.scan import LIKELY_ORDERS_PER_SHAFT, Candidate, _enlarged, _likely_orders
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.units import UM, FloatArray
from tests.made_fits import MadeFit
from tests.physics_cases import rough, scope_of

N, PER_TURN, R_B = 6000, 720, 10.0


def angles(rng: np.random.Generator, uneven: float) -> FloatArray:
    """Angles of a shaft, so many samples a turn, each off its place by up to ``uneven`` of their spacing."""
    return np.asarray(2.0 * math.pi * (np.arange(N) + rng.uniform(-uneven, uneven, N)) / PER_TURN)


def noise(ar: tuple[float, ...], level: float = UM) -> Noise:
    lines = np.array([0.0, 1.0])
    return Noise(
        level=level, level_std=0.01 * level, innovation=level * math.sqrt(1.0 - sum(a * a for a in ar)),
        ar=np.array(ar), frequency=lines, density=lines, rest=lines, count=lines, cycles=2, basis="", repeatable=None,
    )  # fmt: skip


@pytest.mark.parametrize("order", [5, 317, 716, 1444, 2048, 4803])
def test_whitening_enlarges_waves_between_uneven_samples_as_it_does(order: int) -> None:
    """Whitened outright, cosine and sine, at orders below and far above half the sampling: 1444 is the alias of order 4
    in even samples, of which these keep little."""
    theta, coloured = angles(np.random.default_rng(1), 0.2), noise((0.6,))
    waves = np.column_stack([np.cos(order * theta), np.sin(order * theta)])
    outright = float(np.sum(coloured.whitened(waves) ** 2)) / N
    assert _enlarged(coloured, theta / (2.0 * math.pi))[order] == pytest.approx(outright, rel=0.01)


@pytest.mark.long
def test_even_samples_are_asked_at_orders_where_something_can_be() -> None:
    """720 even samples a turn show order 88 at 632, 808, 1352 ... as well, 22 of them up to 8192, and each of two
    shafts: more than are looked at closely. Asked about undulations up to half the sampling, it is the first."""
    theta = np.asarray(2.0 * math.pi * np.arange(N) / PER_TURN)
    white = noise(())
    samples = SimpleNamespace(theta_1=theta, theta_2=theta, size=N)
    left = 0.2 * UM * (np.cos(88 * theta) + np.cos(91 * theta) + np.cos(95 * theta)) / white.innovation
    linear: Any = SimpleNamespace(noises=[white], system=SimpleNamespace(left=[left]))
    scenes: Any = [SimpleNamespace(samples=samples)]
    physics = catalogue()["undulation"]
    asked = [(physics, Place(gear=1, order=order, flank="drive")) for order in range(30, 360)]
    assert _likely_orders(asked, scenes, linear) == (set(), {88, 91, 95})
    every = [(physics, Place(gear=1, order=order, flank="drive")) for order in range(30, 8192)]
    assert len(_likely_orders(every, scenes, linear)[1]) == LIKELY_ORDERS_PER_SHAFT


def fit_of(theta: FloatArray, level: float) -> Any:
    samples = SimpleNamespace(theta_1=theta, theta_2=theta)
    scenes = [SimpleNamespace(samples=samples, gear=lambda k: SimpleNamespace(r_b=R_B))]
    return MadeFit(scenes=scenes, noises=[noise((), level)])


def wave(order: int) -> Candidate:
    place = Place(gear=0, order=order)
    return Candidate(
        claim=Claim(physics=catalogue()["encoder_interpolation"], place=place, values=(1.0, 1.0)), gain=30.0, freedoms=2
    )


def fitted(theta: FloatArray, y: FloatArray, order: int) -> float:
    """Rms of the wave of an order that fits best beside the mean."""
    columns = np.column_stack([np.ones(N), np.cos(order * theta), np.sin(order * theta)])
    size = np.linalg.lstsq(columns, y, rcond=None)[0]
    return float(np.std(columns[:, 1:] @ size[1:]))


def test_a_reading_that_is_noisy_itself_makes_waves_at_the_orders_of_the_sampling_only() -> None:
    """The noise is on the reading too by which waves are drawn, so a wave moves with what is fitted; where samples
    come at much the same phase of it each turn, chance does not average that out. At 720 samples a turn the order 720
    is such a one. In 2 um of noise white noise alone leaves 2 um / sqrt(6000) x 1.4 = 0.036 um of any wave."""
    rng = np.random.default_rng(2)
    level = 2.0 * UM
    lies = rng.normal(0.0, level, N)
    theta = angles(rng, 0.2) + lies / R_B
    fit = fit_of(theta, level)
    seen = {order: fitted(theta, lies, order) for order in (PER_TURN, 2 * PER_TURN, 101)}
    by_chance = 3.0 * level / math.sqrt(N)
    assert seen[PER_TURN] > 3.0 * by_chance
    assert seen[101] < by_chance
    for order in (PER_TURN, 2 * PER_TURN):
        assert reading_floor(fit, wave(order)) > seen[order]
    # Elsewhere it is no burden: less than chance leaves of any wave.
    assert reading_floor(fit, wave(101)) < by_chance
    assert reading_floor(fit, Candidate(claim=Claim(
        physics=catalogue()["friction"], place=Place(), values=(0.1,)), gain=30.0, freedoms=1)) == 0.0  # fmt: skip


def test_an_encoder_may_have_as_many_lines_as_a_high_mesh_order() -> None:
    """360 lines are 24 for each of 15 teeth; at the low mesh orders the teeth themselves err."""
    physics = catalogue()["encoder_interpolation"]
    scope = scope_of(rough())
    orders = {place.order for place in physics.places(scope) if place.gear == 0}
    z = scope.gears[0].z
    assert {8 * z, 24 * z, 25 * z} <= orders
    assert not {z, 2 * z, 7 * z} & orders
    undulation = catalogue()["undulation"]
    instead = [place.order for place in undulation.instead(scope, Place(gear=0, order=24 * z))]
    assert set(instead) == {24 * z}


@pytest.mark.parametrize("level", [0.0, 0.001, 0.3])
def test_no_recording_tells_more_than_the_simulation_is_known_to(level: float) -> None:
    """Where a recording has less noise, the simulation's own 12 nm are left; more stays what it is."""
    heard = Method().noise(noise((), level * UM))
    assert heard.level == pytest.approx(max(level * UM, FAINT_EFFECT_MM))
    assert heard.innovation == pytest.approx(max(level * UM, FAINT_EFFECT_MM))
