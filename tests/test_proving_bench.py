"""The virtual bench against closed forms: geometry and unloaded contact."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, radians, sin, sqrt, tan

import numpy as np
import pytest

from gearpoly.proving.drawn import BENCH_PAIRS, draw, limits, make_pair
from gearpoly.proving.flanks import ToothDeviations, deviation, table
from gearpoly.proving.gears import MM_PER_UM, FloatArray, IdealPair, inv
from gearpoly.proving.rig import BenchError, Rig, ideal, mesh

PAIR = make_pair("18/25 m2")
Z_1, Z_2 = 18, 25
NM = 1e-6
"""mm per nm."""


def driven(n: int, turns: float = 18.0, start: float = 0.0137) -> FloatArray:
    return start + np.linspace(0, 2 * pi * turns, n, endpoint=False)


def with_p(rig: Rig, index: int, p: FloatArray) -> Rig:
    return rig.with_teeth(index, replace(rig.teeth(index), p=p))


def order(x: FloatArray, angle: FloatArray, k: float) -> complex:
    """Amplitude and phase of cos(k angle + phase) in x, by least squares with a mean."""
    A = np.stack([np.cos(k * angle), np.sin(k * angle), np.ones_like(angle)], axis=1)
    c, s, _ = np.linalg.lstsq(A, x, rcond=None)[0]
    return complex(c, -s)


@pytest.mark.parametrize("name", BENCH_PAIRS)
def test_ideal_gears_run_without_error_and_without_play(name: str) -> None:
    pair = make_pair(name)
    for flank in ("drive", "coast"):
        x = mesh(ideal(pair), driven(700), torque=0.0, flank=flank).x
        assert np.abs(x).max() < 1e-9  # rounding of angles of a hundred radians times the base radius
    assert pair.eps > 1.3
    for index in (1, 2):  # the mate's tip must not reach the fillet
        assert pair.l_start(index) > pair.gear(index).l_form


def test_contact_ratio_of_the_research_pair() -> None:
    assert pytest.approx(1.570708, abs=5e-7) == PAIR.eps  # the figure known to six decimals


@pytest.mark.parametrize("index", [1, 2])
@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_eccentricity_has_the_contracts_phase_on_both_flanks(index: int, flank: str) -> None:
    e, angle = 5.0, 40.0
    off = {f"eccentric_{index}": (e, angle)}
    theta_2 = driven(3600)
    turned = theta_2 * (Z_2 / Z_1) if index == 1 else theta_2
    got = order(mesh(replace(ideal(PAIR), **off), theta_2, torque=0.0, flank=flank).x / MM_PER_UM, turned, 1)
    # Displacement of the centre along the line of action: sin(theta - angle +- alpha), mirrored on the coast flank.
    side = 1 if flank == "drive" else -1
    alpha = radians(20)
    if index == 1:
        wave = e * np.sin(turned - radians(angle) + side * alpha)
    else:
        wave = e * np.sin(radians(angle) - turned + side * alpha)
    assert abs(got - order(wave, turned, 1)) < 2e-3  # second order: e^2 / mm of path


def test_eccentricity_difference_of_flanks() -> None:
    theta_2 = driven(3600)
    rig = replace(ideal(PAIR), eccentric_1=(5.0, 100.0))
    drive, coast = (mesh(rig, theta_2, torque=0.0, flank=f).x / MM_PER_UM for f in ("drive", "coast"))
    got = abs(order(coast - drive, theta_2 * Z_2 / Z_1, 1))
    assert got == pytest.approx(2 * 5.0 * sin(radians(20)), rel=2e-3)  # 0.68 e; second order as above


def test_large_eccentricity_follows_the_moved_axes() -> None:
    """Two true involutes on moved centres: the string's length gives theta_1 without any linearisation."""
    e, angle = 60.0, 25.0
    rig = replace(ideal(PAIR, E_s=-200.0), eccentric_2=(e, angle))
    theta_2 = driven(500, turns=3)
    x = mesh(rig, theta_2, torque=0.0).x
    cx = PAIR.a - MM_PER_UM * e * np.cos(radians(angle) - theta_2)
    cy = -MM_PER_UM * e * np.sin(radians(angle) - theta_2)
    far, turn = np.hypot(cx, cy), np.arctan2(cy, cx)
    r_1, r_2 = PAIR.driving.r_b, PAIR.driven.r_b
    alpha = np.arccos((r_1 + r_2) / far)
    # l_1 + l_2 = far sin(alpha) with l_i read off each string's angle turn - alpha.
    sums = far * np.sin(alpha) + (r_1 + r_2) * (PAIR.alpha_w + turn - alpha) - PAIR.l_work(1) - PAIR.l_work(2)
    assert np.abs(x - (-sums)).max() < NM  # the same equation: rounding, and the solver's 0.1 nm
    assert np.abs(order(x / MM_PER_UM, theta_2, 2)) > 0.005  # there is a second order to get right


@pytest.mark.parametrize("index", [1, 2])
def test_pitch_error_holds_while_that_pair_is_ahead(index: int) -> None:
    z = PAIR.gear(index).z
    p = np.zeros(z)
    p[4] = 3.0
    rig = with_p(ideal(PAIR), index, p)
    theta_2 = driven(9000, turns=1 if index == 2 else Z_1 / Z_2)
    got = mesh(rig, theta_2, torque=0.0)
    touches = (got.x / MM_PER_UM > 2.9).mean()
    assert got.x.max() / MM_PER_UM == pytest.approx(3.0, abs=1e-3)  # index deviation is normal, so it is the TE itself
    # It carries over its whole path, eps pitches, and a little beyond at both corners.
    assert touches * z == pytest.approx(
        PAIR.eps, abs=0.03
    )  # corners add sqrt(gap / curvature), some hundredths of a pitch
    lag = with_p(ideal(PAIR), index, -p)
    behind = mesh(lag, theta_2, torque=0.0).x / MM_PER_UM
    assert behind.min() == pytest.approx(-3.0, abs=1e-3)
    # A tooth that lags touches where it is alone: less than 2 - eps pitches, for its neighbours stay on at the corners.
    corners = (
        2 * sqrt(2 * 3.0 * MM_PER_UM * 2.5) / PAIR.p_b
    )  # gap = y^2 / (2 rho), rho about 2.5 mm near the ends of the path
    assert (2 - PAIR.eps) - corners - 0.05 < (behind < -2.9).mean() * z < 2 - PAIR.eps


def test_corner_gap_grows_with_the_distance_beyond_the_path() -> None:
    """The driving tip leads by 3 um: beyond its path TE falls with the square of the distance."""
    p = np.zeros(Z_1)
    p[4] = 3.0
    rig = with_p(ideal(PAIR), 1, p)
    theta_2 = driven(40000, turns=0.2, start=4 * 2 * pi / Z_2)
    got = mesh(rig, theta_2, torque=0.0)
    l_1 = PAIR.driving.l_tip
    l_2 = PAIR.a_w * sin(PAIR.alpha_w) - l_1
    beyond = PAIR.l_work(1) + PAIR.driven.r_b * theta_2 - 4 * PAIR.p_b - PAIR.driving.l_tip
    at = (beyond > 0.03) & (beyond < 0.1) & (got.x > 0.05 * MM_PER_UM)
    fall = 3.0 * MM_PER_UM - got.x[at]
    # The corner lags the flank's continuation by y of roll, that is y l_1 / r_b of arc, in a gap of relative curvature.
    law = beyond[at] ** 2 * 0.5 * (l_1 / PAIR.driving.r_b) ** 2 * (1 / l_1 + 1 / l_2)
    assert at.sum() > 50
    assert np.median(fall / law) == pytest.approx(1.0, abs=0.08)  # third order: y / l_2 is up to 4 %, twice


def test_slopes_show_only_as_their_difference() -> None:
    rig = ideal(PAIR)
    theta_2 = driven(20000, turns=2)
    one = rig.with_teeth(1, replace(rig.teeth_1, slope=np.full(Z_1, 2.0)))
    both = one.with_teeth(2, replace(one.teeth_2, slope=np.full(Z_2, 2.0)))
    x, cancelled = mesh(one, theta_2, torque=0.0).x / MM_PER_UM, mesh(both, theta_2, torque=0.0).x / MM_PER_UM
    assert np.ptp(x) > 0.5
    # e = f (s / eps - 1/2): the pair nearer to its exit touches: f / 2 there, and when it
    # leaves, the next one is at s = eps - 1, u = 1 - 1 / eps.
    assert x.max() == pytest.approx(1.0, abs=4e-3)  # the nearest of 400 samples per mesh
    assert x.min() == pytest.approx(2.0 * (0.5 - 1 / PAIR.eps), abs=0.04)  # the corner rounds the lowest point
    assert np.abs(cancelled).max() < 0.01  # second order of the slope


def test_relief_and_crowning_by_their_formulas() -> None:
    teeth = replace(
        ToothDeviations.ideal(Z_1), crowning=np.full(Z_1, 3.0), relief=8.0, relief_mm=0.7, power=2.0, wear=2.0
    )
    row = table(PAIR, 1, teeth, "drive")[0]
    gear, start = PAIR.driving, PAIR.l_start(1)
    l = gear.l_tip - 0.4
    u = (l - start) / (gear.l_tip - start)
    begin = gear.roll(gear.r_a - 0.7)
    t = (l - begin) / (gear.l_tip - begin)
    by_hand = -3.0 * (2 * u - 1) ** 2 - 8.0 * t**2 - 2.0 * abs(l - gear.l_ref) / (gear.l_tip - gear.l_ref)
    d, slope = deviation(row, l)
    assert d / MM_PER_UM == pytest.approx(by_hand, abs=1e-9)
    step = 1e-5
    numeric = (deviation(row, l + step)[0] - deviation(row, l - step)[0]) / (2 * step)
    assert slope == pytest.approx(numeric, rel=1e-6)  # central difference of a parabola: rounding only


def test_a_pit_that_is_alone_in_contact_shows_its_depth() -> None:
    g = PAIR.driving
    middle = PAIR.l_work(1)
    ends = [sqrt(g.r_b**2 + (middle + h) ** 2) for h in (-1.2, 1.2)]
    teeth = replace(ToothDeviations.ideal(Z_1), pits=((3, 4.0, ends[0], ends[1]),))
    x = mesh(ideal(PAIR).with_teeth(1, teeth), driven(6000, turns=Z_1 / Z_2), torque=0.0).x / MM_PER_UM
    assert x.min() == pytest.approx(-4.0, abs=0.01)  # the flat floor is wide enough for the flank to rest on
    narrow = replace(teeth, pits=((3, 4.0, g.r - 0.005, g.r + 0.005),))
    bridged = mesh(ideal(PAIR).with_teeth(1, narrow), driven(6000, turns=Z_1 / Z_2), torque=0.0).x / MM_PER_UM
    assert bridged.min() > -0.1  # the mate bridges a pit much narrower than sqrt(2 depth / curvature)


def test_backlash_from_thickness_and_from_centre_distance() -> None:
    theta_2 = driven(300, turns=1)
    thin = ideal(PAIR, E_s=-60.0)
    play = mesh(thin, theta_2, torque=0.0, flank="coast").x - mesh(thin, theta_2, torque=0.0).x
    assert np.allclose(play, 2 * 60 * MM_PER_UM * cos(radians(20)), atol=NM)  # closed form
    wide = ideal(replace(PAIR, offset=0.1))
    alpha = np.arccos((PAIR.driving.r_b + PAIR.driven.r_b) / wide.pair.a)
    side = (PAIR.driving.r_b + PAIR.driven.r_b) * (inv(float(alpha)) - inv(radians(20)))
    assert side / MM_PER_UM == pytest.approx(34.50, abs=0.005)  # published to two decimals
    for flank, sign in (("drive", -1), ("coast", 1)):
        x = mesh(wide, theta_2, torque=0.0, flank=flank).x
        assert np.allclose(x, sign * side, atol=NM)


def test_the_coast_flank_is_the_drive_flank_in_a_mirror() -> None:
    rng = np.random.default_rng(3)
    rig = replace(ideal(PAIR), eccentric_1=(20.0, 70.0))
    rig = with_p(with_p(rig, 1, rng.normal(0, 4, Z_1)), 2, rng.normal(0, 4, Z_2))
    back = replace(rig, eccentric_1=(20.0, -70.0))
    # In the mirror tooth k is tooth -k; the coast deviation is -p, and tooth n of the driving gear meets n + 1, so the
    # zero of both gears moves to the coast flank of tooth 0: by the driving tooth's thickness.
    n_1, n_2 = (-np.arange(Z_1)) % Z_1, (1 - np.arange(Z_2)) % Z_2
    back = with_p(with_p(back, 1, -rig.teeth_1.p[n_1]), 2, -rig.teeth_2.p[n_2])
    sigma = PAIR.thickness_angle(1)
    shifted = replace(back, eccentric_1=(20.0, -70.0 + np.degrees(sigma)))
    theta_2 = driven(2000, turns=1.7, start=0.3)
    drive = mesh(rig, theta_2, torque=0.0).x
    mirrored = mesh(shifted, -theta_2 + sigma * Z_1 / Z_2, torque=0.0, flank="coast").x
    assert np.abs(drive + mirrored).max() < NM  # exact symmetry, the solver's 0.1 nm


def test_drawn_gears_fit_their_grade() -> None:
    rng = np.random.default_rng(5)
    for grade in (4, 8):
        limit = limits(PAIR.driven, grade)
        teeth = [draw(PAIR.driven, grade, -60.0, rng) for _ in range(30)]
        spread = [np.ptp(t.p) / cos(radians(20)) for t in teeth]
        assert max(spread) <= limit.F_p
        assert np.mean(spread) > 0.3 * limit.F_p  # and use a good part of it
        assert max(np.abs(t.slope).max() for t in teeth) <= limit.f_H


def test_tight_mesh_of_shifted_gears() -> None:
    pair: IdealPair = make_pair("15/28 m1.5 shifted")
    wanted = inv(radians(20)) + 2 * tan(radians(20)) * 0.25 / 43
    assert inv(pair.alpha_w) == pytest.approx(wanted, rel=1e-12)
    both = pair.thickness_angle(1) * pair.driving.z + pair.thickness_angle(2) * pair.driven.z
    assert both == pytest.approx(2 * pi, rel=1e-12)  # the two tooth thicknesses fill the working pitch


def test_no_number_is_no_equilibrium() -> None:
    """A rival that cannot run, such as a gear bent out of reach, is refused rather than compared as NaN."""
    rig = with_p(ideal(PAIR), 1, np.full(Z_1, np.nan))
    with pytest.raises(BenchError):
        mesh(rig, driven(20), torque=0.0)
