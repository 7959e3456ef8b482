"""The virtual bench against closed forms: geometry, unloaded contact, load, and the measuring chain."""

from __future__ import annotations

from dataclasses import replace
from math import cos, log, pi, radians, sin, sqrt, tan

import numpy as np
import pytest

from proving.chain import Chain, Condition, motion, noise, te
from proving.compliance import LAWS, beam, compliance
from proving.drawn import PAIRS, draw, limits, make_pair
from proving.flanks import Teeth, deviation, table
from proving.gears import UM, FloatArray, Pair, inv
from proving.rig import Disturbance, Encoder, Rig, ideal, mesh

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


@pytest.mark.parametrize("name", PAIRS)
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
    got = order(mesh(replace(ideal(PAIR), **off), theta_2, torque=0.0, flank=flank).x / UM, turned, 1)
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
    drive, coast = (mesh(rig, theta_2, torque=0.0, flank=f).x / UM for f in ("drive", "coast"))
    got = abs(order(coast - drive, theta_2 * Z_2 / Z_1, 1))
    assert got == pytest.approx(2 * 5.0 * sin(radians(20)), rel=2e-3)  # 0.68 e; second order as above


def test_large_eccentricity_follows_the_moved_axes() -> None:
    """Two true involutes on moved centres: the string's length gives theta_1 without any linearisation."""
    e, angle = 60.0, 25.0
    rig = replace(ideal(PAIR, E_s=-200.0), eccentric_2=(e, angle))
    theta_2 = driven(500, turns=3)
    x = mesh(rig, theta_2, torque=0.0).x
    cx = PAIR.a - UM * e * np.cos(radians(angle) - theta_2)
    cy = -UM * e * np.sin(radians(angle) - theta_2)
    far, turn = np.hypot(cx, cy), np.arctan2(cy, cx)
    r_1, r_2 = PAIR.driving.r_b, PAIR.driven.r_b
    alpha = np.arccos((r_1 + r_2) / far)
    # l_1 + l_2 = far sin(alpha) with l_i read off each string's angle turn - alpha.
    sums = far * np.sin(alpha) + (r_1 + r_2) * (PAIR.alpha_w + turn - alpha) - PAIR.l_work(1) - PAIR.l_work(2)
    assert np.abs(x - (-sums)).max() < NM  # the same equation: rounding, and the solver's 0.1 nm
    assert np.abs(order(x / UM, theta_2, 2)) > 0.005  # there is a second order to get right


@pytest.mark.parametrize("index", [1, 2])
def test_pitch_error_holds_while_that_pair_is_ahead(index: int) -> None:
    z = PAIR.gear(index).z
    p = np.zeros(z)
    p[4] = 3.0
    rig = with_p(ideal(PAIR), index, p)
    theta_2 = driven(9000, turns=1 if index == 2 else Z_1 / Z_2)
    got = mesh(rig, theta_2, torque=0.0)
    touches = (got.x / UM > 2.9).mean()
    assert got.x.max() / UM == pytest.approx(3.0, abs=1e-3)  # index deviation is normal, so it is the TE itself
    # It carries over its whole path, eps pitches, and a little beyond at both corners.
    assert touches * z == pytest.approx(
        PAIR.eps, abs=0.03
    )  # corners add sqrt(gap / curvature), some hundredths of a pitch
    lag = with_p(ideal(PAIR), index, -p)
    behind = mesh(lag, theta_2, torque=0.0).x / UM
    assert behind.min() == pytest.approx(-3.0, abs=1e-3)
    # A tooth that lags touches where it is alone: less than 2 - eps pitches, for its neighbours stay on at the corners.
    corners = 2 * sqrt(2 * 3.0 * UM * 2.5) / PAIR.p_b  # gap = y^2 / (2 rho), rho about 2.5 mm near the ends of the path
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
    at = (beyond > 0.03) & (beyond < 0.1) & (got.x > 0.05 * UM)
    fall = 3.0 * UM - got.x[at]
    # The corner lags the flank's continuation by y of roll, that is y l_1 / r_b of arc, in a gap of relative curvature.
    law = beyond[at] ** 2 * 0.5 * (l_1 / PAIR.driving.r_b) ** 2 * (1 / l_1 + 1 / l_2)
    assert at.sum() > 50
    assert np.median(fall / law) == pytest.approx(1.0, abs=0.08)  # third order: y / l_2 is up to 4 %, twice


def test_slopes_show_only_as_their_difference() -> None:
    rig = ideal(PAIR)
    theta_2 = driven(20000, turns=2)
    one = rig.with_teeth(1, replace(rig.teeth_1, slope=np.full(Z_1, 2.0)))
    both = one.with_teeth(2, replace(one.teeth_2, slope=np.full(Z_2, 2.0)))
    x, cancelled = mesh(one, theta_2, torque=0.0).x / UM, mesh(both, theta_2, torque=0.0).x / UM
    assert np.ptp(x) > 0.5
    # e = f (s / eps - 1/2): the pair nearer to its exit touches: f / 2 there, and when it
    # leaves, the next one is at s = eps - 1, u = 1 - 1 / eps.
    assert x.max() == pytest.approx(1.0, abs=4e-3)  # the nearest of 400 samples per mesh
    assert x.min() == pytest.approx(2.0 * (0.5 - 1 / PAIR.eps), abs=0.04)  # the corner rounds the lowest point
    assert np.abs(cancelled).max() < 0.01  # second order of the slope


def test_relief_and_crowning_by_their_formulas() -> None:
    teeth = replace(Teeth.ideal(Z_1), crowning=np.full(Z_1, 3.0), relief=8.0, relief_mm=0.7, power=2.0, wear=2.0)
    row = table(PAIR, 1, teeth, "drive")[0]
    gear, start = PAIR.driving, PAIR.l_start(1)
    l = gear.l_tip - 0.4
    u = (l - start) / (gear.l_tip - start)
    begin = gear.roll(gear.r_a - 0.7)
    t = (l - begin) / (gear.l_tip - begin)
    by_hand = -3.0 * (2 * u - 1) ** 2 - 8.0 * t**2 - 2.0 * abs(l - gear.l_ref) / (gear.l_tip - gear.l_ref)
    d, slope = deviation(row, l)
    assert d / UM == pytest.approx(by_hand, abs=1e-9)
    step = 1e-5
    numeric = (deviation(row, l + step)[0] - deviation(row, l - step)[0]) / (2 * step)
    assert slope == pytest.approx(numeric, rel=1e-6)  # central difference of a parabola: rounding only


def test_a_pit_that_is_alone_in_contact_shows_its_depth() -> None:
    g = PAIR.driving
    middle = PAIR.l_work(1)
    ends = [sqrt(g.r_b**2 + (middle + h) ** 2) for h in (-1.2, 1.2)]
    teeth = replace(Teeth.ideal(Z_1), pits=((3, 4.0, ends[0], ends[1]),))
    x = mesh(ideal(PAIR).with_teeth(1, teeth), driven(6000, turns=Z_1 / Z_2), torque=0.0).x / UM
    assert x.min() == pytest.approx(-4.0, abs=0.01)  # the flat floor is wide enough for the flank to rest on
    narrow = replace(teeth, pits=((3, 4.0, g.r - 0.005, g.r + 0.005),))
    bridged = mesh(ideal(PAIR).with_teeth(1, narrow), driven(6000, turns=Z_1 / Z_2), torque=0.0).x / UM
    assert bridged.min() > -0.1  # the mate bridges a pit much narrower than sqrt(2 depth / curvature)


def test_backlash_from_thickness_and_from_centre_distance() -> None:
    theta_2 = driven(300, turns=1)
    thin = ideal(PAIR, E_s=-60.0)
    play = mesh(thin, theta_2, torque=0.0, flank="coast").x - mesh(thin, theta_2, torque=0.0).x
    assert np.allclose(play, 2 * 60 * UM * cos(radians(20)), atol=NM)  # closed form
    wide = ideal(replace(PAIR, offset=0.1))
    alpha = np.arccos((PAIR.driving.r_b + PAIR.driven.r_b) / wide.pair.a)
    side = (PAIR.driving.r_b + PAIR.driven.r_b) * (inv(float(alpha)) - inv(radians(20)))
    assert side / UM == pytest.approx(34.50, abs=0.005)  # published to two decimals
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


def test_beam_against_the_uniform_cantilever() -> None:
    L, t, b, E, nu = 6.0, 3.0, 10.0, 206000.0, 0.3
    x = np.linspace(0, L, 2001)
    got = beam(x, np.full(x.size, t / 2), y_load=0.0, slant=0.0, b=b, E=E, nu=nu)
    bending, shear = L**3 / (3 * E * b * t**3 / 12), 1.2 * L / (E / (2 * (1 + nu)) * b * t)
    assert got == pytest.approx(bending + shear, rel=1e-6)  # trapezoid rule with 2000 steps


@pytest.mark.parametrize("law", LAWS)
def test_stiffness_of_steel_teeth(law: str) -> None:
    c = compliance(PAIR, law=law)
    l_1, l_2 = PAIR.l_work(1), PAIR.l_work(2)
    stiffness = 1 / (c.single(l_1, l_2, 3000.0) * 20.0) / 1000  # N/(mm um)
    assert 12 < stiffness < 20  # ISO 6336-1 gives 14 with its correction 0.8, 17.5 without
    tip = np.interp(PAIR.driving.l_tip, c.l_1, c.c_1) / np.interp(PAIR.l_start(1), c.l_1, c.c_1)
    assert tip > 2  # a tooth is softest at its tip


def test_contact_laws_against_their_formulas() -> None:
    E, nu, b, F = 206000.0, 0.3, 20.0, 3000.0
    assert compliance(PAIR, law="sainsot").contact(F, 4.0) == pytest.approx(4 * (1 - nu**2) / (pi * E * b))
    # Palmgren's 3.84e-5 F^0.9 / L^0.8 (mm, N) for steel rollers, of which 1.275 / E^0.9 is the general form.
    assert compliance(PAIR, law="palmgren").contact(F, 4.0) * F == pytest.approx(3.84e-5 * F**0.9 / b**0.8, rel=0.5)
    got = compliance(PAIR, law="weber")
    # Twice the load on a line contact: the logarithm falls by ln 2.
    drop = 2 * (1 - nu**2) / (pi * E * b) * log(2)
    assert got.contact(F, 4.0) - got.contact(2 * F, 4.0) == pytest.approx(drop, rel=1e-9)


def test_load_on_a_single_pair_deflects_it_by_its_own_compliance() -> None:
    rig = replace(ideal(PAIR), deflect=True)
    at = np.array([0.0])  # the pitch point: one pair carries, all of the load
    torque = 60.0
    x = mesh(rig, at, torque=torque).x[0]
    force = torque * 1000 / PAIR.driven.r_b
    want = compliance(PAIR).single(PAIR.l_work(1), PAIR.l_work(2), force) * force
    assert -x == pytest.approx(want, rel=1e-3)  # the contact point moves by the deflection
    assert mesh(rig, at, torque=torque, flank="coast").x[0] > 0  # load makes the coast error more positive


def test_misalignment_by_the_two_branches() -> None:
    g, at = 10.0, np.array([0.0])
    base = replace(ideal(PAIR), deflect=True, lead=g)
    c = compliance(PAIR).single(PAIR.l_work(1), PAIR.l_work(2), 1.0)
    for torque in (20.0, 200.0):
        F = torque * 1000 / PAIR.driven.r_b
        want = sqrt(2 * F * g * UM * c) if F * c < g * UM / 2 else F * c + g * UM / 2
        assert -mesh(base, at, torque=torque).x[0] == pytest.approx(want, rel=2e-3)  # as above


def test_friction_lowers_approach_and_raises_recess() -> None:
    rig = replace(ideal(PAIR), deflect=True)
    theta_2 = np.array([-0.02, 0.02])  # just before and after tooth 0's pitch point, one pair
    mu, torque = 0.08, 60.0
    dry, bare = (mesh(replace(rig, friction=f), theta_2, torque=torque) for f in (mu, 0.0))
    for k, sign in ((0, -1.0), (1, 1.0)):
        rho_2 = PAIR.l_work(2) - PAIR.driven.r_b * theta_2[k]
        assert dry.x[k] / bare.x[k] == pytest.approx(1 / (1 + sign * mu * rho_2 / PAIR.driven.r_b), rel=2e-4)
    assert dry.x[0] < bare.x[0] < 0
    assert bare.x[1] < dry.x[1] < 0


def test_crack_softens_one_tooth_only() -> None:
    rig = replace(ideal(PAIR), deflect=True)
    cracked = rig.with_teeth(2, rig.teeth_2.softer(6, 1.5))
    theta_2 = driven(2500, turns=1, start=0.0)
    diff = mesh(cracked, theta_2, torque=60.0).x - mesh(rig, theta_2, torque=60.0).x
    where = theta_2[np.abs(diff) > 1e-3 * UM] / PAIR.driven.tau
    assert where.min() > 5
    assert where.max() < 7
    at = mesh(cracked, np.array([6 * PAIR.driven.tau]), torque=60.0).x[0]
    c = compliance(PAIR)
    own = np.interp(PAIR.l_work(2), c.l_2, c.c_2)
    more = at - mesh(rig, np.array([6 * PAIR.driven.tau]), torque=60.0).x[0]
    assert -more == pytest.approx(0.5 * own * 60000 / PAIR.driven.r_b, rel=2e-3)  # half its own compliance more


def test_undulation_is_a_wave_of_its_order() -> None:
    teeth = replace(Teeth.ideal(Z_2), waves=((61, 0.4, 0.3, 1.0),))
    theta_2 = driven(8000, turns=2)
    x = mesh(ideal(PAIR).with_teeth(2, teeth), theta_2, torque=0.0).x / UM
    assert 0.3 < abs(order(x, theta_2, 61)) < 0.4  # the leading of two pairs cuts into it


def test_wind_up_and_encoders_add_what_they_should() -> None:
    rig = ideal(PAIR)
    condition = Condition(torque=10.0, turns=4)
    path = motion(rig, condition, np.random.default_rng(1))
    wound = te(replace(rig, windup=0.5), condition, path)
    assert np.allclose(wound, -PAIR.driven.r_b * 5e-6, atol=1e-9)  # 0.5 urad/(N.m) at 10 N.m
    off = te(replace(rig, encoder_1=Encoder(eccentricity_urad=50.0, angle_deg=30.0)), condition, path)
    theta_1 = path.theta_2 * Z_2 / Z_1
    assert np.allclose(off, -PAIR.driving.r_b * 50e-6 * np.sin(theta_1 - radians(30)), atol=1e-9)
    lines = te(replace(rig, encoder_2=Encoder(interp_urad=2.0, interp_order=1024)), condition, path)
    assert np.allclose(lines, PAIR.driven.r_b * 2e-6 * np.cos(1024 * path.theta_2), atol=1e-9)
    hum = te(replace(rig, disturbances=(Disturbance(kind="hum", amplitude=0.7, hz=50.0),)), condition, path)
    assert np.allclose(hum, 0.7 * UM * np.cos(2 * pi * 50 * path.time), atol=1e-9)
    warm = te(replace(rig, drift=3.0), condition, path)
    assert warm[-1] - warm[0] == pytest.approx(3 * UM, rel=0.02)  # the samples end one interval early


def test_resonance_has_the_gain_of_one_degree_of_freedom() -> None:
    rig = ideal(PAIR)
    rig = rig.with_teeth(1, replace(rig.teeth_1, slope=np.full(Z_1, 3.0)))
    condition = Condition(torque=0.0, speed=120.0, turns=40, per_mesh=40, wobble=0.0, uneven=0.0)
    path = motion(rig, condition, np.random.default_rng(2))
    f, f_n, zeta = 120 / 60 * Z_1, 60.0, 0.05
    still, moved = te(rig, condition, path), te(replace(rig, resonance=(f_n, zeta)), condition, path)
    late = path.time > 4
    ratio = order(moved[late], path.theta_2[late], Z_2) / order(still[late], path.theta_2[late], Z_2)
    r = f / f_n
    assert abs(ratio - 1 / complex(1 - r * r, 2 * zeta * r)) < 0.02  # steps of 1/48 mesh period between kinks


def test_noise_has_the_stated_level_and_colour() -> None:
    x = noise(Chain(noise_um=0.7, colour=0.6), 200_000, np.random.default_rng(4)) / UM
    assert x.std() == pytest.approx(0.7, rel=0.01)  # 200 000 samples, four times fewer independent ones
    assert np.corrcoef(x[1:], x[:-1])[0, 1] == pytest.approx(0.6, abs=0.01)


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
    pair: Pair = make_pair("15/28 m1.5 shifted")
    wanted = inv(radians(20)) + 2 * tan(radians(20)) * 0.25 / 43
    assert inv(pair.alpha_w) == pytest.approx(wanted, rel=1e-12)
    both = pair.thickness_angle(1) * pair.driving.z + pair.thickness_angle(2) * pair.driven.z
    assert both == pytest.approx(2 * pi, rel=1e-12)  # the two tooth thicknesses fill the working pitch
