"""Closed forms of a gear pair's unloaded transmission error: what the drawn polygons must give without being told."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from gearpoly.errors import GeometryError, JammedError
from gearpoly.gear.deviations import Deviations, Index, Slope, pitch_and_thickness
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.gear.modules import module_at
from gearpoly.mesh.contact import Feature
from gearpoly.mesh.pair import GearPair, active_start, mount
from gearpoly.mesh.transmission import FlankContacts, both_flanks, contacts, mean_pairs
from gearpoly.units import ARCMIN, DEG, UM, FloatArray, read_only
from tests.oracles.involute_pair import conjugate_rotation, make_pair

NM = 1e-6
ALPHA = 20.0 * DEG

# um. Rotations round at 1e-15 rad and come certified to 2.5e-13 rad, together below 1e-5 nm at any radius here.
ROUNDING = 1e-8 * UM


def inv(angle: float) -> float:
    return math.tan(angle) - angle


def make(
    z: tuple[int, int] = (18, 25),
    *,
    m: float = 2.0,
    x: tuple[float, float] = (0.0, 0.0),
    deviations: tuple[Deviations | None, Deviations | None] = (None, None),
    points: int = 1000,
    a: float | None = None,
    eccentricity: tuple[tuple[float, float], tuple[float, float]] = ((0.0, 0.0), (0.0, 0.0)),
) -> GearPair:
    gears = [Gear(z=z[k], m=m, x=x[k]) for k in range(2)]
    flanks = [
        draw_flanks(gears[k], deviations[k], l_start=active_start(gears[k], gears[1 - k], l_form=0.0), points=points)
        for k in range(2)
    ]
    return mount(flanks[0], flanks[1], a=a, eccentricity_1=eccentricity[0], eccentricity_2=eccentricity[1])


def te_mm(pair: GearPair, found: FlankContacts) -> FloatArray:
    return found.te * pair.r_b2


def one_tooth(z: int, tooth: int, p: float) -> FloatArray:
    index = np.zeros(z)
    index[tooth] = p
    return read_only(index)


def one_pitch(pair: GearPair, count: int, *, start: float = 0.0) -> FloatArray:
    return (start + np.arange(count) / count) * pair.driven.gear.tau


# Chords: the only error of perfect gears.


def test_perfect_gears_of_2000_points_transmit_within_0_15_nm() -> None:
    pair = make(points=2000)
    theta_2 = np.concatenate((one_pitch(pair, 600), np.arange(361) * DEG))
    te = te_mm(pair, contacts(pair, theta_2))
    # Chords lie inside the flank, so contact is late and TE negative, but for rounding.
    assert np.max(te) <= ROUNDING
    assert np.min(te) >= -0.15 * NM
    # The stated bound is a bound, and no idle one.
    assert -pair.chord_noise <= np.min(te) <= -0.3 * pair.chord_noise


def assert_second_order(counts: tuple[int, ...], positions: int) -> None:
    worst = []
    for n in counts:
        pair = make(points=n)
        worst.append(float(np.max(np.abs(te_mm(pair, contacts(pair, one_pitch(pair, positions)))))))
        assert worst[-1] < 0.6 * NM * (1000.0 / n) ** 2
    rate = np.polyfit(np.log(counts), np.log(worst), 1)[0]
    # Sagittas go as the square of the spacing; 0.1 for where the worst position falls among the samples.
    assert rate == pytest.approx(-2.0, abs=0.1)


@pytest.mark.long
def test_chord_noise_falls_with_the_square_of_the_points() -> None:
    assert_second_order((50, 100, 200, 500, 1000, 2000), 300)


@pytest.mark.slow
def test_chord_noise_falls_with_the_square_of_the_points_to_20_000() -> None:
    assert_second_order((50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000), 1500)


# Contact ratio.


def pairs_on_the_path(theta_2: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Number of deviation-free 18/25 pairs, m 2, on the path of contact, and how far the nearest end of it is, mm."""
    r = (18.0, 25.0)
    r_b = tuple(v * math.cos(ALPHA) for v in r)
    l_tip = tuple(math.sqrt((v + 2.0) ** 2 - (v * math.cos(ALPHA)) ** 2) for v in r)
    path = sum(r) * math.sin(ALPHA)
    # Driving roll length of mesh n: the pitch point's at its own theta_2 = n tau_2, and r_b2 further per radian.
    n = np.arange(-3, 30)
    rho = r[0] * math.sin(ALPHA) + r_b[1] * (theta_2[:, None] - n * 2.0 * math.pi / 25)
    inside = np.minimum(rho - (path - l_tip[1]), l_tip[0] - rho)
    return np.count_nonzero(inside >= 0.0, axis=1), np.min(np.abs(inside), axis=1)


@pytest.mark.long
def test_contact_ratio_of_perfect_gears() -> None:
    pair = make(points=2000)
    assert pair.eps_alpha == pytest.approx(1.570708, abs=5e-7)  # its last digit
    found = contacts(pair, one_pitch(pair, 100, start=0.0037))
    # 1e-4 of a pitch is what the changes are located to, at two changes a pitch of either sign.
    assert mean_pairs(pair, found) == pytest.approx(1.570708, abs=1e-4)


@pytest.mark.long
def test_touching_pairs_at_the_papers_361_positions() -> None:
    pair = make(points=2000)
    theta_2 = np.arange(361) * DEG
    found = contacts(pair, theta_2)
    expected, margin = pairs_on_the_path(theta_2)
    # A corner that left the path by x stands off by about x^2/2 rho: within the chords' 0.1 nm up to 1 um, and no
    # whole degree comes that near to an end of the path.
    assert np.min(margin) > 1.0 * UM
    np.testing.assert_array_equal(found.pairs, expected)
    # The paper printed 1.5709 but 0.52 % off, which is 570/361 = 1.5789; exact counting gives one more, since
    # position 360 deg is position 0 again. Both are 1 deg steps' view of 1.5707.
    assert int(np.sum(found.pairs)) == int(np.sum(expected)) == 571


def test_at_most_the_flanks_touch_not_the_corners_that_left() -> None:
    pair = make(points=500)
    found = contacts(pair, one_pitch(pair, 400))
    corners = found.feature != int(Feature.FLANK)
    assert np.count_nonzero(corners) > 0
    assert not np.any(found.touching & corners)


# Eccentricity.


@pytest.mark.long
@pytest.mark.parametrize("gear", [0, 1])
def test_one_eccentricity_gives_twice_itself(gear: int) -> None:
    e = 12.0 * UM
    eccentricity = [(0.0, 0.0), (0.0, 0.0)]
    eccentricity[gear] = (e, 0.7)
    pair = make(eccentricity=(eccentricity[0], eccentricity[1]))
    turn = (pair.driving, pair.driven)[gear].gear.z * pair.driven.gear.tau
    te = te_mm(pair, contacts(pair, np.arange(720) / 720 * turn))
    # 0.1 %: second order in e/a is 0.03 %, 720 positions find the extremes to 0.001 %.
    assert np.ptp(te) == pytest.approx(2.0 * e, rel=1e-3)


@pytest.mark.parametrize("gear", [0, 1])
@pytest.mark.parametrize("phi", [0.0, 40.0 * DEG, 250.0 * DEG])
def test_eccentricity_has_the_phase_of_the_contract(gear: int, phi: float) -> None:
    """The contract counts the angle from tooth 0's pitch point in the order of meshing: derived here, not taken over.

    The common normal at the pitch point is n = (sin alpha, cos alpha). The driving gear's later teeth follow clockwise,
    so its centre stands at theta_1 - phi and pushes the flank ahead by n.c; the driven gear's follow counter-clockwise
    from pi, its centre stands at pi + phi - theta_2 and takes the flank away by n.c.
    """
    e = 10.0 * UM
    eccentricity = [(0.0, 0.0), (0.0, 0.0)]
    eccentricity[gear] = (e, phi)
    pair = make(eccentricity=(eccentricity[0], eccentricity[1]))
    theta_2 = np.arange(450) / 450 * pair.cycle
    te = te_mm(pair, contacts(pair, theta_2))
    direction = theta_2 / pair.ratio - phi if gear == 0 else math.pi + phi - theta_2
    along = math.sin(ALPHA) * np.cos(direction) + math.cos(ALPHA) * np.sin(direction)
    expected = e * along * (1.0 if gear == 0 else -1.0)
    # Second order: e^2 over the centre distance and over the curvature radii, below e/2000 here.
    np.testing.assert_allclose(te, expected, atol=e / 1000.0, rtol=0.0)


def test_two_eccentricities_and_a_centre_distance_follow_the_exact_form() -> None:
    pair = make(eccentricity=((25.0 * UM, 0.4), (18.0 * UM, 2.0)), a=43.05)
    theta_2 = np.linspace(0.0, pair.cycle, 200)
    te = contacts(pair, theta_2).te
    centres = [tuple(float(v) for v in mounted.centre) for mounted in (pair.driving, pair.driven)]
    oracle = make_pair(18, 25, ecc=((centres[0][0], centres[0][1]), (centres[1][0], centres[1][1])))
    exact = np.array([conjugate_rotation(oracle, float(t), axis_distance=pair.a) for t in theta_2])
    late = (theta_2 - pair.ratio * exact - te) * pair.r_b2
    # Chords make it late, by both sagittas at most; root finding at 100 rad rounds at 1e-14 rad.
    assert np.min(late) > -1e-12
    assert np.max(late) < 1.01 * pair.chord_noise


def test_eccentricities_of_the_ottewill_pair() -> None:
    e_1, e_2, r_b = 55.88 * UM, 48.26 * UM, 54.0 * math.cos(ALPHA)
    theta_2 = np.arange(120) / 120 * 2.0 * math.pi
    seen = []
    # TE r_b = e_1 sin(theta - phi_1 + alpha) - e_2 sin(theta - phi_2 - alpha) with equal tooth numbers.
    for phase in np.arange(12) / 12 * 2.0 * math.pi:
        phi_2 = phase - 2.0 * ALPHA
        pair = make((18, 18), m=6.0, eccentricity=((e_1, 0.0), (e_2, phi_2)), points=500)
        pp = float(np.ptp(contacts(pair, theta_2).te)) / ARCMIN
        exact = 2.0 * math.sqrt(e_1**2 + e_2**2 - 2.0 * e_1 * e_2 * math.cos(phase)) / r_b / ARCMIN
        # Second harmonics of order e^2/a = 0.03 um of 15 to 208 um, and 120 positions: 0.5 %.
        assert pp == pytest.approx(exact, rel=5e-3)
        seen.append(pp)
    assert min(seen) == pytest.approx(1.03, abs=0.005 * 1.03)
    assert max(seen) == pytest.approx(14.11, abs=0.005 * 14.11)


# Backlash.


@pytest.mark.parametrize("z", [(18, 25), (25, 18), (40, 30)])
def test_constant_thinning_is_backlash(z: tuple[int, int]) -> None:
    E_s = (-50.0 * UM, -30.0 * UM)
    thin = [pitch_and_thickness(Gear(z=z[k], m=2.0), index=np.zeros(z[k]), E_s=np.full(z[k], E_s[k])) for k in range(2)]
    pair = make(z, deviations=(thin[0], thin[1]))
    run = both_flanks(pair, one_pitch(pair, 90))
    j_bn = 80.0 * UM * math.cos(ALPHA)
    # The drive flanks stay where pitch has them; chords are late on either flank by at most both sagittas.
    assert np.max(np.abs(te_mm(pair, run.drive))) <= pair.chord_noise
    np.testing.assert_allclose(te_mm(pair, run.coast), j_bn, atol=1.01 * pair.chord_noise, rtol=0.0)
    assert np.all(run.j_bn >= j_bn - ROUNDING)
    assert np.all(run.j_bn <= j_bn + 2.02 * pair.chord_noise)


@pytest.mark.parametrize("delta", [0.02, 0.1, 0.5])
def test_centre_distance_in_mean_te_and_backlash(delta: float) -> None:
    pair = make(a=43.0 + delta)
    run = both_flanks(pair, one_pitch(pair, 90))
    alpha_w = math.acos(43.0 * math.cos(ALPHA) / (43.0 + delta))
    wedge = 43.0 * math.cos(ALPHA) * (inv(alpha_w) - inv(ALPHA))
    if delta == 0.1:
        assert wedge == pytest.approx(34.50 * UM, abs=0.005 * UM)  # as printed in the derivation
    np.testing.assert_allclose(te_mm(pair, run.drive), -wedge, atol=1.01 * pair.chord_noise, rtol=0.0)
    np.testing.assert_allclose(run.j_bn, 2.0 * wedge, atol=2.02 * pair.chord_noise, rtol=0.0)


def test_lost_motion_is_the_same_on_both_shafts() -> None:
    pair = make(a=43.1)
    run = both_flanks(pair, one_pitch(pair, 20))
    theta_1 = [(found.theta_2 - found.te) / pair.ratio for found in (run.drive, run.coast)]
    # Lost motion is the driving rotation between the contacts, times r_b1 the normal backlash; sums of 1 rad round.
    np.testing.assert_allclose((theta_1[0] - theta_1[1]) * pair.r_b1, run.j_bn, atol=1e-12, rtol=0.0)


# Deviations, with the contract's signs.


@pytest.mark.parametrize("gear", [0, 1])
@pytest.mark.parametrize("p", [4.0 * UM, -4.0 * UM])
def test_index_deviation_moves_te_by_itself_where_its_pair_carries_alone(gear: int, p: float) -> None:
    z, tooth = (18, 25), 7
    deviations: list[Deviations | None] = [None, None]
    deviations[gear] = Deviations(drive=(Index(one_tooth(z[gear], tooth, p)),))
    pair = make(z, deviations=(deviations[0], deviations[1]))
    tau_2 = pair.driven.gear.tau
    theta_2 = np.array([tooth - 1.0, tooth, tooth + 1.0]) * tau_2  # pitch points: one pair only on each
    found = contacts(pair, theta_2)
    np.testing.assert_allclose(te_mm(pair, found), [0.0, p, 0.0], atol=1.01 * pair.chord_noise, rtol=0.0)
    first = np.flatnonzero(found.touching)
    np.testing.assert_array_equal(found.driving[first], [tooth - 1, tooth, tooth + 1])
    np.testing.assert_array_equal(found.driven[first], [tooth - 1, tooth, tooth + 1])
    # The same tooth a turn of its own gear later, on another mate.
    mesh = tooth + z[gear]
    again = contacts(pair, np.array([mesh * tau_2]))
    assert te_mm(pair, again)[0] == pytest.approx(p, abs=1.01 * pair.chord_noise)
    assert (int(again.driving[0]), int(again.driven[0])) == (mesh % z[0], mesh % z[1])


def test_a_thick_tooth_leads_and_a_thin_one_lets_its_neighbours_carry() -> None:
    p = 4.0 * UM
    for sign in (1.0, -1.0):
        deviation = Deviations(drive=(Index(one_tooth(18, 7, sign * p)),))
        pair = make(deviations=(deviation, None))
        theta_2 = (7.0 + np.linspace(-0.9, 0.9, 181)) * pair.driven.gear.tau
        te = te_mm(pair, contacts(pair, theta_2))
        # A tooth in two-pair contact touches only if it leads; corners carry over for a while beyond the path's ends.
        expected, _ = pairs_on_the_path(theta_2)
        inside = np.abs(theta_2 / pair.driven.gear.tau - 7.0) < 0.5
        shared = (expected == 2) & inside
        np.testing.assert_allclose(te[shared], max(0.0, sign * p), atol=1.01 * pair.chord_noise, rtol=0.0)


@pytest.mark.parametrize("gear", [0, 1])
@pytest.mark.parametrize("s", [2.0 * UM, -2.0 * UM])
def test_profile_slope_rises_towards_the_tip(gear: int, s: float) -> None:
    z = (18, 25)
    deviations: list[Deviations | None] = [None, None]
    deviations[gear] = Deviations(drive=(Slope(np.full(z[gear], s)),))
    pair = make(z, deviations=(deviations[0], deviations[1]))
    expected, _ = pairs_on_the_path(np.linspace(-0.5, 0.5, 101) * pair.driven.gear.tau)
    theta_2 = (np.linspace(-0.5, 0.5, 101) * pair.driven.gear.tau)[expected == 1][2:-2]
    te = te_mm(pair, contacts(pair, theta_2))
    # Roll length of the deviated flank at the contact of tooth 0: up the driving flank, down the driven one.
    path = 43.0 * math.sin(ALPHA)
    rho = 18.0 * math.sin(ALPHA) + pair.r_b2 * theta_2
    l, r = (rho, 18.0) if gear == 0 else (path - rho, 25.0)
    mate = 43.0 - r
    l_tip, mate_tip = (math.sqrt((v + 2.0) ** 2 - (v * math.cos(ALPHA)) ** 2) for v in (r, mate))
    l_start = path - mate_tip
    u = (l - l_start) / (l_tip - l_start)
    # The contact leaves the straight line of action by a slope of s/5 mm: (s/5)^2 rho/2 = 0.3 nm.
    np.testing.assert_allclose(te, s * (u - 0.5), atol=0.6 * NM + pair.chord_noise, rtol=0.0)
    assert np.ptp(te) > 0.2 * abs(s)  # the single-pair part of the profile is a quarter of it
    # More material at the tip: a driving tip leaves the mesh, a driven tip enters it.
    assert (te[-1] > te[0]) == ((s > 0) == (gear == 0))


def test_deviations_of_one_flank_leave_the_other_alone() -> None:
    deviation = Deviations(coast=(Index(np.full(18, -3.0 * UM)), Slope(np.full(18, 2.0 * UM))))
    pair = make(deviations=(deviation, None), points=500)
    plain = make(points=500)
    theta_2 = one_pitch(pair, 40)
    np.testing.assert_array_equal(contacts(pair, theta_2).te, contacts(plain, theta_2).te)
    assert np.max(te_mm(pair, contacts(pair, theta_2, flank="coast"))) > 2.0 * UM


# Symmetry.


def rough(z: int, seed: int) -> tuple[FloatArray, FloatArray]:
    rng = np.random.default_rng(seed)
    return rng.uniform(-5.0, 5.0, z) * UM, rng.uniform(-4.0, 4.0, z) * UM


def test_mirrored_gears_and_sense_change_the_flank_and_nothing_else() -> None:
    """Seen in the line of centres, driving tooth m becomes tooth -m, driven tooth m becomes 1 - m, drive becomes coast.

    Both gears then stand half a pitch on (a tooth is half a pitch thick), so theta -> tau/2 - theta on both shafts,
    TE -> -TE, and an eccentricity's angle phi -> tau/2 - phi. Derived here.
    """
    z = (18, 25)
    drive = [rough(z[k], k) for k in range(2)]
    coast = [(-p, s) for p, s in (rough(z[k], 5 + k) for k in range(2))]
    phi = (0.5, 2.2)
    tau = [2.0 * math.pi / v for v in z]
    image = [np.arange(z[0]) * -1 % z[0], (1 - np.arange(z[1])) % z[1]]

    def pair_of(
        sides: list[tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]], angles: tuple[float, float]
    ) -> GearPair:
        deviations = [
            Deviations(drive=(Index(d[0]), Slope(d[1])), coast=(Index(c[0] - 60.0 * UM), Slope(c[1]))) for d, c in sides
        ]
        return make(
            z,
            deviations=(deviations[0], deviations[1]),
            points=400,
            eccentricity=((0.02, angles[0]), (0.015, angles[1])),
            a=43.04,
        )

    pair = pair_of([(drive[k], coast[k]) for k in range(2)], phi)
    # The mirrored gear carries the drive flanks' deviations on its coast flanks.
    swapped = [
        tuple((p[image[k]] + shift, s[image[k]]) for (p, s), shift in ((coast[k], -60.0 * UM), (drive[k], 60.0 * UM)))
        for k in range(2)
    ]
    mirrored = pair_of(swapped, (0.5 * tau[0] - phi[0], 0.5 * tau[1] - phi[1]))  # type: ignore[arg-type]
    theta_2 = np.random.default_rng(3).uniform(0.0, pair.cycle, 250)
    there, back = contacts(pair, theta_2), contacts(mirrored, 0.5 * tau[1] - theta_2, flank="coast")
    # Angles of 100 rad round at 1e-14 rad, brackets at 2.5e-13.
    np.testing.assert_allclose(back.te, -there.te, atol=1e-12, rtol=0.0)
    rows = np.flatnonzero(np.diff(there.position, prepend=-1)), np.flatnonzero(np.diff(back.position, prepend=-1))
    np.testing.assert_array_equal(back.driving[rows[1]], image[0][there.driving[rows[0]]])
    np.testing.assert_array_equal(back.driven[rows[1]], image[1][there.driven[rows[0]]])
    flip = np.array([1.0, -1.0])
    # Contact points are only as sharp as a 400-point flank is curved: 1e-12 rad moves them by 1e-12 * rho / spacing.
    np.testing.assert_allclose(back.point[rows[1]], there.point[rows[0]] * flip, atol=1e-7, rtol=0.0)
    np.testing.assert_allclose(back.normal[rows[1]], there.normal[rows[0]] * flip, atol=1e-7, rtol=0.0)


def test_the_hunting_cycle_is_the_period_and_a_turn_is_not() -> None:
    deviations = [Deviations(drive=(Index(read_only(rough(z, z)[0])),)) for z in (18, 25)]
    pair = make(deviations=(deviations[0], deviations[1]), points=400)
    assert pair.meshes_per_cycle == 450
    assert pair.cycle == pytest.approx(18 * 2.0 * math.pi, rel=1e-15)
    theta_2 = np.linspace(0.0, 2.0 * math.pi, 60)
    te, later, turn = (contacts(pair, theta_2 + shift).te for shift in (0.0, pair.cycle, 2.0 * math.pi))
    # Angles of 226 rad round at 3e-14 rad; the brackets are 2.5e-13 rad.
    np.testing.assert_allclose(later, te, atol=1e-12, rtol=0.0)
    assert np.max(np.abs(turn - te)) * pair.r_b2 > 1.0 * UM


@pytest.mark.parametrize(("flank", "shift"), [("drive", 0), ("coast", 1)])
def test_teeth_meet_in_the_order_of_the_contract(flank: str, shift: int) -> None:
    deviations = [Deviations(coast=(Index(np.full(z, -20.0 * UM)),)) for z in (18, 25)]
    pair = make(deviations=(deviations[0], deviations[1]), points=200)
    theta_2 = np.random.default_rng(0).uniform(0.0, pair.cycle, 300)
    found = contacts(pair, theta_2, flank="coast" if flank == "coast" else "drive")
    meshes = np.arange(pair.meshes_per_cycle)
    number = {(int(n % 18), int((n + shift) % 25)): int(n) for n in meshes}
    mesh = np.array([number[int(i), int(j)] for i, j in zip(found.driving, found.driven, strict=True)])
    # Contact stays within a pitch of the pitch point (half a pitch on for the coast flank), modulo the cycle.
    lag = theta_2[found.position] / pair.driven.gear.tau - mesh - 0.5 * shift
    lag = (lag + 225.0) % 450.0 - 225.0
    assert np.max(np.abs(lag)) < 1.0


# Profile shift.


@pytest.mark.parametrize("x", [(0.3, 0.2), (0.5, -0.2), (-0.1, -0.15), (0.4, -0.4)])
def test_shifted_gears_mesh_tight_at_a_w_and_meet_at_the_working_pitch_point(x: tuple[float, float]) -> None:
    pair = make(x=x)
    target = inv(ALPHA) + 2.0 * math.tan(ALPHA) * sum(x) / 43.0
    low, high = 0.05, 1.0
    for _ in range(60):  # plain bisection, to 1e-18 of the bracket
        middle = 0.5 * (low + high)
        low, high = (middle, high) if inv(middle) < target else (low, middle)
    a_w = 43.0 * math.cos(ALPHA) / math.cos(low)
    assert pair.a == pytest.approx(a_w, rel=1e-12)
    run = both_flanks(pair, one_pitch(pair, 60))
    assert np.max(np.abs(te_mm(pair, run.drive))) <= 1.01 * pair.chord_noise
    assert np.max(np.abs(run.j_bn)) <= 2.02 * pair.chord_noise
    # Both angles are 0 where tooth 0 touches tooth 0 at the working pitch point.
    touching = np.flatnonzero((run.drive.position == 0) & run.drive.touching)
    rows = [k for k in touching if run.drive.driving[k] == 0 and run.drive.driven[k] == 0]
    assert len(rows) == 1
    spacing = 2.0 * 10.0 / 1000  # mm: twice the mean point spacing on a flank that is no longer than 10 mm
    np.testing.assert_allclose(run.drive.point[rows[0]], [a_w * 18 / 43, 0.0], atol=spacing, rtol=0.0)
    np.testing.assert_allclose(run.drive.normal[rows[0]], [math.sin(low), math.cos(low)], atol=2e-3, rtol=0.0)


def test_contact_points_lie_on_the_line_of_action() -> None:
    pair = make(points=2000)
    found = contacts(pair, one_pitch(pair, 50))
    touching = found.touching
    n = np.array([math.sin(ALPHA), math.cos(ALPHA)])
    offset = found.point[touching] - np.array([18.0, 0.0])
    across = offset[:, 0] * n[1] - offset[:, 1] * n[0]
    # The touching vertex lies within half a spacing (4 um) of the true point, along the flank, so across the line.
    assert np.max(np.abs(across)) < 8.0 * UM
    # Normals are those of the smooth flank at that vertex: the same 4 um over a radius of curvature above 2 mm.
    np.testing.assert_allclose(found.normal[touching], np.broadcast_to(n, (touching.sum(), 2)), atol=4e-3, rtol=0.0)


# Gears that cannot.


def test_a_jam_says_where() -> None:
    thick = Deviations(coast=(Index(one_tooth(18, 5, 6.0 * UM)),))
    pair = make(deviations=(thick, None), points=300)
    theta_2 = np.arange(0.0, 180.0, 1.0) * DEG  # the thick tooth passes once
    with pytest.raises(JammedError) as caught:
        both_flanks(pair, theta_2)
    text = str(caught.value)
    angle = re.search(r"driven angle ([\d.]+) deg", text)
    size = re.search(r"overlap by ([\d.]+) um", text)
    assert angle is not None
    assert size is not None
    assert float(size[1]) == pytest.approx(6.0, abs=0.01)  # the whole deviation, less chords of 5 nm
    # Coast flank of driving tooth 5 on driven tooth 6, which meet 5.5 pitches after zero.
    assert float(angle[1]) / 14.4 == pytest.approx(5.5, abs=1.0)
    assert "coast flank: 5 on 6" in text
    assert "tooth_thickness_um" in text


def test_gears_apart_and_gears_too_near_are_refused() -> None:
    with pytest.raises(GeometryError, match="cannot reach each other"):
        make(a=47.1)
    with pytest.raises(GeometryError, match=r"cuts .* into its mate's root"):
        make(a=42.4)


def test_a_centre_distance_of_another_module_says_which() -> None:
    """2 a / (z_1 + z_2) of pairs without profile shift; between two modules nothing is said."""
    assert module_at(84.0, z=(24, 60)) == 2.0
    assert module_at(0.5 * 0.3 * 84, z=(70, 14)) == 0.3
    assert module_at(86.0, z=(24, 60)) is None
    z_1, z_2 = (one.gear.z for one in (make().driving, make().driven))
    with pytest.raises(GeometryError, match=r"cannot reach each other.*module_mm = 2\.5"):
        make(a=1.25 * (z_1 + z_2))
    with pytest.raises(GeometryError, match=r"root; .*module_mm = 1\.75"):
        make(a=0.875 * (z_1 + z_2))
