"""Another pair of the same ratio, by where its mesh stands in what was recorded."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearpoly.compare.ratio import OrderPower
from gearpoly.compare.same_ratio import other_teeth_of_ratio, same_ratio
from gearpoly.keys.also_turns import Part

MESH = {21: 4.7, 42: 0.6, 63: 0.2}
"""Amplitudes in um at orders of the driving shaft: a mesh of 21 teeth and its multiples."""

SLOW = {1: 30.0, 2: 8.0, 0.5: 12.0, 4.5: 3.0}
"""What any gear has of its own, far larger."""

OWN = {20: 0.09, 40: 0.04, 60: 0.08}
"""Side bands of it where 20 teeth were declared."""


def lines(*waves: dict[float, float] | dict[int, float], noise: float = 0.3) -> list[OrderPower]:
    """A recording of 8 turns in white noise of so many um."""
    turns = np.linspace(0.0, 8.0, 8 * 500)
    te = np.random.default_rng(3).normal(0.0, noise, turns.size)
    for each in waves:
        for order, um in each.items():
            te += um * np.cos(2.0 * math.pi * order * turns + order)
    return [OrderPower(turns, te)]


def test_a_line_s_power_is_that_of_its_amplitude() -> None:
    """A wave of 3 and one of 6 um differ by 4 in power, whatever the noise's background."""
    (one,) = lines({5: 3.0, 9: 6.0})
    low, high = one.at(np.array([5.0, 9.0]))
    assert high / low == pytest.approx(4.0, rel=0.02)  # noise of 0.3 um has 0.01 um in a line
    assert one.at(np.array([1e6])).tolist() == [0.0]


def test_the_mesh_of_other_teeth_is_told_with_them() -> None:
    found = same_ratio(lines(SLOW, MESH, OWN), z=(20, 40))
    assert found is not None
    assert (found.teeth, found.orders) == ((21, 42), (21, 42, 63))
    assert "21 on 42" in found.says


def test_pitches_of_every_order_do_not_hide_it() -> None:
    """Where teeth err there is a line at every order, a tooth among them, as long as those of the mesh are larger."""
    pitches = {k: 0.15 for k in range(3, 80) if k not in MESH}
    assert same_ratio(lines(SLOW, MESH, pitches), z=(20, 40)) is not None


@pytest.mark.parametrize(
    ("waves", "z"),
    [
        ((SLOW, {21: 4.7, 42: 0.6}), (20, 40)),  # a wheel on the shaft leaves two
        ((SLOW, MESH, {20: 5.0}), (20, 40)),  # the declared mesh is larger
        ((SLOW, MESH), (20, 41)),  # no other teeth near have that ratio
        ((SLOW, MESH), (22, 33)),  # nor 21 on any
        ((SLOW, {30: 4.7, 60: 0.6, 90: 0.2}), (20, 40)),  # nobody counts wrong by half
        ((SLOW, {21: 4.7, 41: 0.6, 19: 4.0}), (20, 40)),  # side bands of an eccentricity
        ((SLOW, {20: 5.0, 40: 1.0, 60: 0.5}), (20, 40)),  # its own mesh
        ((SLOW, {k: um * 0.001 for k, um in MESH.items()}), (20, 40)),  # beneath the noise
        ((SLOW,), (20, 40)),  # no mesh at all
    ],
)
def test_what_no_other_pair_makes_is_none(waves: tuple[dict[float, float], ...], z: tuple[int, int]) -> None:
    assert same_ratio(lines(*waves), z=z) is None


@pytest.mark.parametrize(("teeth", "excused"), [(21, True), (17, False)])
def test_a_wheel_that_the_file_states_is_none(teeth: int, excused: bool) -> None:
    """On the driving shaft, which turns twice per driven turn, 21 teeth have these lines; 17 have other ones."""
    part = Part(name="belt wheel", turns=2.0, teeth=teeth)
    assert (same_ratio(lines(SLOW, MESH), z=(20, 40), parts=(part,)) is None) == excused


@pytest.mark.parametrize(
    ("z", "others"),
    [((20, 40), [15, 16, 17, 18, 19, 21, 22, 23, 24, 25]), ((20, 41), []), ((24, 36), [18, 20, 22, 26, 28, 30])],
)
def test_other_teeth_of_a_ratio(z: tuple[int, int], others: list[int]) -> None:
    """Whole pairs whose ratio is the same, within a quarter of the teeth."""
    assert other_teeth_of_ratio(z) == others
