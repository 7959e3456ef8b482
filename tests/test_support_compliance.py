"""Shafts and bearings that give way: what a centre distance that grows with the torque does to an involute pair."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearpoly.errors import GeometryError
from gearpoly.files.models import PairFile
from gearpoly.gear.gear import inv
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.pair import Flank
from gearpoly.simulate import Simulation, simulate
from gearpoly.units import NM, UM, FloatArray
from tests.pair_files import Table, made, one_pitch, pair_file

FLANKS: tuple[Flank, Flank] = ("drive", "coast")
SUPPORT = 4.0
"""um/(N.m): 80 um at 20 N.m, where second order shows."""


def pair(support: float = SUPPORT, *, bends: bool = False, centre_distance: float | None = None) -> PairFile:
    keys: Table = {"support_um_per_nm": support}
    if centre_distance is not None:
        keys["centre_distance_mm"] = centre_distance
    return pair_file(pair=keys, model={"tooth_deflection": bends})


def run(file: PairFile, torque_nm: float, *, flank: Flank = "drive", off: FloatArray | None = None) -> Simulation:
    assembled = made(file)
    condition = Condition(flank=flank, torque=torque_nm * NM)
    theta_2 = one_pitch(assembled, 24)
    return simulate(
        assembled, theta_2, condition, seed=0, evenly=False, fast=True, off=off, progress=lambda *_: None
    )  # fmt: skip


@pytest.mark.parametrize("flank", FLANKS)
def test_an_involute_pair_transmits_evenly_at_any_distance_and_its_sides_open(flank: Flank) -> None:
    """cos(alpha_w) = (r_b1 + r_b2)/a, each side opens by (r_b1 + r_b2)(inv alpha' - inv alpha), the backlash twice."""
    still, apart = run(pair(), 0.0, flank=flank), run(pair(), 20.0, flank=flank)
    p = still.pair
    r_b = p.r_b1 + p.r_b2
    alpha = math.acos(r_b / p.a)
    after = math.acos(r_b / (p.a + 20.0 * SUPPORT * UM))
    assert apart.pair.alpha_w == pytest.approx(after, abs=1e-14)
    opens = r_b * (inv(after) - inv(alpha))
    # Chords let the driven side lag by up to chord_noise, elsewhere at another distance.
    exact = 2.0 * p.chord_noise
    assert np.ptp(apart.te) * p.r_b2 < exact
    sense = -1.0 if flank == "drive" else 1.0
    np.testing.assert_allclose((apart.te - still.te) * p.r_b2, sense * opens, atol=exact)
    np.testing.assert_allclose(apart.backlash.j_bn - still.backlash.j_bn, 2.0 * opens, atol=2.0 * exact)
    # To first order 2 da tan(alpha) along the pitch circle, times cos(alpha) along the line of action.
    first = 2.0 * (p.a * (math.cos(alpha) / math.cos(after) - 1.0)) * math.sin(alpha)
    assert 2.0 * opens == pytest.approx(first, rel=0.01)


@pytest.mark.parametrize("bends", [False, True])
def test_under_one_torque_it_is_a_centre_distance(bends: bool) -> None:
    """To the last bit, contact ratio and load sharing included."""
    a = made(pair(0.0)).pair.a
    gives, set_apart = (
        run(pair(bends=bends), 20.0),
        run(pair(0.0, bends=bends, centre_distance=a + 20.0 * NM * (SUPPORT * UM / NM)), 20.0),
    )
    np.testing.assert_array_equal(gives.te, set_apart.te)
    np.testing.assert_array_equal(gives.pairs, set_apart.pairs)
    assert gives.pair.eps_alpha < made(pair(0.0)).pair.eps_alpha


@pytest.mark.parametrize("flank", FLANKS)
def test_a_torque_that_varies_moves_the_axes_along(flank: Flank) -> None:
    """By 5 % more and less, rigid teeth follow as under steady torques; 4 um of growth leave 0.2 % to second order."""
    off = np.where(np.arange(24) % 2, 0.05, -0.05)
    varied = run(pair(), 20.0, flank=flank, off=off)
    steady = {part: run(pair(), (1.0 + part) * 20.0, flank=flank) for part in (0.05, -0.05)}
    expected = np.where(off > 0.0, steady[0.05].te, steady[-0.05].te)
    moved = np.abs(expected - run(pair(), 20.0, flank=flank).te)
    assert np.min(moved) * varied.pair.r_b2 > 1.0 * UM
    np.testing.assert_allclose(varied.te, expected, atol=0.01 * float(np.max(moved)))


def test_without_torque_nothing_moves() -> None:
    np.testing.assert_array_equal(run(pair(), 0.0).te, run(pair(0.0), 0.0).te)


def test_axes_that_come_too_far_apart_are_refused() -> None:
    """Tips of 18/25 teeth of module 2 end to reach each other 4 mm apart."""
    with pytest.raises(GeometryError, match="cannot reach each other"):
        run(pair(1000.0), 5.0)
