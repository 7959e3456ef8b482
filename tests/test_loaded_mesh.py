"""What a mesh under torque does: signs, symmetries, more pairs than in theory, relief, and the study's sharing."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.gear.deviations import Deviations, tip_relief
from gearpoly.gear.gear import Gear
from gearpoly.mesh.contact import Feature
from gearpoly.mesh.deflection import Elasticity, pair_compliance
from gearpoly.mesh.loaded import load_reach, loaded
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.mesh.transmission import NEAR_PAIR_MM, FlankContacts, contacts
from gearpoly.positions import cycle_positions
from gearpoly.units import NM, UM
from tests.made_loaded import (
    LINEAR,
    PALMGREN,
    make,
    one_pitch,
    per_position,
    perfect,
    random_contacts,
    same_set,
    springs,
    under,
    wrong,
)
from tests.oracles.load_sharing import study


def test_load_makes_drive_negative_and_coast_positive() -> None:
    pair = wrong()
    drive, coast = under(pair, 25.0), under(pair, 25.0, flank="coast")
    assert np.all(drive.te < drive.contacts.te)
    assert np.all(coast.te > coast.contacts.te)
    for result in (drive, coast):
        np.testing.assert_allclose(
            np.abs(result.te - result.contacts.te) * pair.r_b2,
            result.approach,
            rtol=1e-12,  # rounding of TE against the deflection
        )


def test_coast_is_the_mirror_image_of_drive() -> None:
    """Perfect gears mirrored in the line of centres turn backwards, and their coast flanks are half a thickness off."""
    pair = perfect()
    t = one_pitch(pair, 60)
    runs = []
    for flank, theta_2 in (("drive", t), ("coast", -0.5 * pair.driven.gear.tau - t)):
        side: Flank = "drive" if flank == "drive" else "coast"
        compliance = pair_compliance(pair, PALMGREN, flank=side)
        found = contacts(pair, theta_2, flank=side, near=NEAR_PAIR_MM + load_reach(compliance, 25.0 * NM))
        runs.append(loaded(found, compliance, torque=25.0 * NM))
    drive, coast = runs
    # The kernel certifies rotations to 2.5e-13 rad, 5e-12 mm here; stiffness asks for no more.
    np.testing.assert_allclose(coast.approach, drive.approach, rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(coast.stiffness, drive.stiffness, rtol=1e-6)
    np.testing.assert_array_equal(coast.pairs, drive.pairs)


def test_equal_gears_share_alike_before_and_after_the_pitch_point() -> None:
    """Half a turn about the pitch point swaps two equal gears, so approach and shares are even about it."""
    pair = make((20, 20))
    t = (np.arange(40) + 0.5) / 80 * pair.driven.gear.tau
    runs = []
    for theta_2 in (t, -t):
        compliance = pair_compliance(pair, PALMGREN)
        found = contacts(pair, theta_2, near=NEAR_PAIR_MM + load_reach(compliance, 25.0 * NM))
        runs.append(loaded(found, compliance, torque=25.0 * NM))
    flanks = [per_position(run, (run.contacts.feature != int(Feature.FLANK)) * run.force) == 0.0 for run in runs]
    both = flanks[0] & flanks[1]
    assert np.count_nonzero(both) > 30
    # On flanks by the chords only. A corner's two levers differ by up to 3 %, and torque and turn are counted on
    # one gear each, so half a turn changes a corner's part of them.
    np.testing.assert_allclose(runs[0].approach[both], runs[1].approach[both], rtol=0.0, atol=2.0 * pair.chord_noise)
    np.testing.assert_allclose(runs[0].approach, runs[1].approach, rtol=0.03)
    share = []
    for run in runs:
        mine = run.contacts.driven == 0
        share.append(np.zeros(t.size))
        np.add.at(share[-1], run.contacts.position[mine], run.share[mine])
    # 1e-3 of the load: chord noise of 0.7 nm each under 3 um; for the corners as above.
    np.testing.assert_allclose(share[0][both], share[1][both], atol=1e-3)
    np.testing.assert_allclose(share[0], share[1], atol=0.03)
    assert np.max(share[0]) == 1.0
    # Half a pitch on, two pairs stand alike on both sides; the last position is 1/160 short of it.
    assert np.min(share[0]) == pytest.approx(0.5, abs=0.01)


def test_stiffness_is_the_slope_of_force_over_approach() -> None:
    for elasticity in (LINEAR, PALMGREN, Elasticity(contact="weber_banaschek"), Elasticity(law="iso6336")):
        pair = wrong()
        step = 1e-4
        low, here, high = (under(pair, 25.0 * f, elasticity) for f in (1.0 - step, 1.0, 1.0 + step))
        same = same_set(low, here, high)
        slope = 2.0 * step * 25.0 * NM / pair.r_b2 / (high.approach - low.approach)
        assert np.count_nonzero(same) > 100
        # Central difference, second order in 1e-4, but for a pair that has just joined, whose own Palmgren stiffness
        # runs off within the step.
        np.testing.assert_allclose(slope[same], here.stiffness[same], rtol=2e-4)
        assert np.median(np.abs(slope[same] / here.stiffness[same] - 1.0)) < 1e-7


# More pairs touch under load, corners before and after the path.


def test_contact_ratio_grows_with_torque_beyond_theory() -> None:
    pair = perfect()
    # Whole pitches at a fine step; counting it by itself, to half a step at either end.
    counted = [float(np.mean(under(pair, t).pairs)) for t in (0.5, 5.0, 25.0, 120.0, 250.0)]
    assert counted[0] == pytest.approx(pair.eps_alpha, abs=0.02)
    assert np.all(np.diff(counted) > 0.0)
    assert counted[2] > pair.eps_alpha + 0.05


def test_tip_corners_carry_before_and_after_the_path() -> None:
    pair = perfect()
    result = under(pair, 60.0)
    found = result.contacts
    carries = result.force > 0.0
    # Place along the line of action: roll length of the driving gear from the normal's distance.
    entering = carries & (found.feature == int(Feature.FIXED_CORNER))
    leaving = carries & (found.feature == int(Feature.TURNING_CORNER))
    assert np.count_nonzero(entering) > 2
    assert np.count_nonzero(leaving) > 2
    pitch = pair.driven.gear.tau
    # Mesh n is at its pitch point at theta_2 = n tau_2: before it the driven tip comes in, after it the driving tip
    # goes out, further from the pitch point than the path reaches.
    turn = (
        found.theta_2[found.position] - np.where(found.driven > 12, found.driven - 25, found.driven) * pitch
    ) / pitch
    path = pair.a * np.sin(pair.alpha_w)
    gear_1, gear_2 = pair.driving.gear, pair.driven.gear
    approach = (gear_2.l_a - pair.r_b2 * np.tan(pair.alpha_w)) / gear_2.p_b
    recess = (gear_1.l_a - pair.r_b1 * np.tan(pair.alpha_w)) / gear_1.p_b
    assert approach + recess == pytest.approx(pair.eps_alpha, rel=1e-12)
    assert path > 0.0
    assert np.all(turn[entering] < -approach)
    assert np.all(turn[leaving] > recess)
    # The tips themselves, to the chords and the deviation-free outline.
    x, y = found.point.T
    np.testing.assert_allclose(np.hypot(x - pair.a, y)[entering], gear_2.r_a, atol=1e-9)
    np.testing.assert_allclose(np.hypot(x, y)[leaving], gear_1.r_a, atol=1e-9)
    # Forces rise from nothing as a corner comes in: no jump of TE where the number of pairs changes.
    finer = loaded(contacts(pair, one_pitch(pair, 640), near=0.05), pair_compliance(pair, PALMGREN), torque=60.0 * NM)
    # Steps four times as fine are so much smaller, the slope's own change left aside.
    assert np.max(np.abs(np.diff(finer.te))) < 0.4 * np.max(np.abs(np.diff(result.te)))


@pytest.mark.long
@pytest.mark.parametrize("torque_nm", [pytest.param(0.1, marks=pytest.mark.slow), 5.0])
def test_mean_pairs_at_40_positions_a_mesh_is_the_fine_count(torque_nm: float) -> None:
    pair = wrong()
    compliance = pair_compliance(pair, PALMGREN)
    found = contacts(pair, cycle_positions(pair, turns=4.0), near=NEAR_PAIR_MM + load_reach(compliance, torque_nm * NM))
    result = loaded(found, compliance, torque=torque_nm * NM)
    # One pair at least touches everywhere.
    assert result.mean_pairs >= 1.0
    # Plain counting at 4000 positions leaves half a step, 1/80, at a few of 100 ends: 0.003 in the mean.
    assert result.mean_pairs == pytest.approx(float(np.mean(result.pairs)), abs=0.005)


def test_long_parabolic_relief_flattens_te_at_its_design_torque() -> None:
    """Relief from about where single contact begins, as deep as the teeth give there, fills the step that a second
    pair makes."""

    def relieved(gear: Gear) -> Deviations:
        shape = (tip_relief(gear, amount=12.0 * UM, length=1.6, shape="parabolic"),)
        return Deviations(drive=shape, coast=shape)

    pair = make(deviations=(relieved(Gear(z=18, m=2.0)), relieved(Gear(z=25, m=2.0))))
    torques = (10.0, 25.0, 40.0, 55.0, 70.0, 90.0, 120.0)
    te_pp = [float(np.ptp(under(pair, t).te)) * pair.r_b2 / UM for t in torques]
    plain = float(np.ptp(under(perfect(), 55.0).te)) * pair.r_b2 / UM
    assert te_pp[3] == min(te_pp)
    assert plain > 3.0 * te_pp[3]
    # Off its torque it is worse on either side, and at little load worse than no relief at all.
    assert te_pp[0] > 2.0 * te_pp[3]
    assert te_pp[-1] > 2.0 * te_pp[3]
    assert te_pp[0] > 2.0 * float(np.ptp(under(perfect(), 10.0).te)) * pair.r_b2 / UM


# The study's sharing.


def test_the_studys_sharing_is_equilibrium_on_perfect_gears() -> None:
    for torque_nm in (1.0, 25.0, 200.0):
        ours, theirs = under(perfect(), torque_nm), under(perfect(), torque_nm, sharing="paper")
        # Rounding of the same sums.
        np.testing.assert_allclose(theirs.force, ours.force, rtol=1e-12, atol=1e-12)


def three_pairs(pair: GearPair, gaps_um: tuple[float, float]) -> FlankContacts:
    """One position with three near pairs at the pitch point."""
    found = random_contacts(pair, np.random.default_rng(0), positions=1, spread=1.0 * UM)
    normal = np.array([np.sin(pair.alpha_w), np.cos(pair.alpha_w)])
    return FlankContacts(
        **{name: getattr(found, name) for name in ("flank", "theta_2", "te", "pairs", "certified", "repaired")},
        position=np.zeros(3, dtype=np.int64),
        driving=np.arange(3),
        driven=np.arange(3),
        gap=np.array([0.0, *gaps_um]) * UM,
        point=np.tile([18.0, 0.0], (3, 1)),
        normal=np.tile(normal, (3, 1)),
        feature=np.zeros(3, dtype=np.int64),
        overrun=np.zeros(3),
        touching=np.array([True, False, False]),
    )


def test_three_pairs_by_hand() -> None:
    """Equal pairs that close at 0, 1 and 4 um and give 5 um alone: the second brings them to 3 um, so the third is
    never reached."""
    pair = perfect()
    compliance = pair_compliance(pair, LINEAR)
    found = three_pairs(pair, (1.0, 4.0))
    contact = 4.0 * (1.0 - 0.3**2) / (np.pi * 206000.0 * 20.0)
    c = float(compliance.teeth(found.driving, found.driven, found.point)[0]) + contact
    torque = 5.0 * UM / c * pair.r_b2
    result = loaded(found, compliance, torque=torque)
    # Rounding only: all three stand at the pitch point, where both levers are the base radii.
    np.testing.assert_allclose(result.force * c / UM, [3.0, 2.0, 0.0], atol=1e-9)
    assert result.approach[0] == pytest.approx(3.0 * UM, rel=1e-12)
    assert result.pairs[0] == 2


def test_the_studys_sharing_pulls_where_one_turn_reaches_two_pairs() -> None:
    """The same three pairs by the study: the first turn, 5 um, reaches both others; sharing then gives 10/3 um, short
    of the third's 4 um, so it pulls."""
    pair = perfect()
    compliance = pair_compliance(pair, LINEAR)
    found = three_pairs(pair, (1.0, 4.0))
    (problem,) = springs(compliance, found)
    torque = 5.0 * UM / (problem[0].c + problem[0].A) * pair.r_b2
    phi, forces = study(problem, torque)
    assert phi * pair.r_b1 == pytest.approx(10.0 / 3.0 * UM, rel=1e-9)
    assert forces[2] < 0.0
    result = loaded(found, compliance, torque=torque, sharing="paper")
    np.testing.assert_allclose(result.force, forces, rtol=1e-9)
