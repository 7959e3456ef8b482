"""What load and shafts do beyond bending sound teeth: friction, misalignment, cracks, a scaled compliance, wind-up.
Closed forms, energy, limits, and a second way to the same numbers."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad

from gearpoly.errors import OutOfRangeError
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.deflection import Elasticity, pair_compliance
from gearpoly.mesh.loaded import LoadedContacts
from gearpoly.mesh.pair import Flank, GearPair
from gearpoly.simulate import simulate
from gearpoly.units import NM, UM, URAD, FloatArray
from tests.pair_files import made, one_pitch, pair_file, under, unloaded_te

FLANKS: tuple[Flank, ...] = ("drive", "coast")
SENSE = {"drive": 1.0, "coast": -1.0}
TORQUE = 20.0
MU = 0.08

# Chords turn normals by half a chord's angle, 2e-4 rad at 1200 points, on a lever of about half the base radius.
CHORD = 2e-4


@cache
def loads(flank: Flank, mu: float = 0.0, torque: float = TORQUE) -> LoadedContacts:
    file = pair_file(pair={"friction_coefficient": mu})
    assembled = made(file)
    return under(assembled, one_pitch(assembled), torque, flank=flank)[0]


def alone(load: LoadedContacts) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Positions at which one pair carries, its force in N, and the distances in mm of its contact from the ends of the
    line of action on both base circles."""
    held = (load.force > 0.0) & (load.pairs == 1)[load.contacts.position]
    point = load.contacts.point[held]
    pair = load_pair()
    rho_1 = np.sqrt(np.sum(point**2, axis=1) - pair.r_b1**2)
    rho_2 = np.sqrt(np.sum((point - [pair.a, 0.0]) ** 2, axis=1) - pair.r_b2**2)
    return load.contacts.position[held], load.force[held], rho_1, rho_2


@cache
def load_pair() -> GearPair:
    return made(pair_file()).pair


# Friction.


def test_friction_changes_the_normal_force_as_the_closed_form_says() -> None:
    """N = F/(1 -+ mu rho_2/r_b2): more in approach, less in recess (driven torque given)."""
    pair = load_pair()
    _, force, rho_1, rho_2 = alone(loads("drive", MU))
    approach = rho_1 < pair.driving.gear.l_pitch
    assert 0.2 < np.mean(approach) < 0.8
    expected = TORQUE * NM / pair.r_b2 / (1.0 - np.where(approach, MU, -MU) * rho_2 / pair.r_b2)
    clear = np.abs(rho_1 - pair.driving.gear.l_pitch) > 0.02  # mm: two chords, within which the sign is open
    np.testing.assert_allclose(force[clear], expected[clear], rtol=CHORD)


def test_friction_on_the_coast_flank_is_the_mirror_image_run_backwards() -> None:
    """There the driven gear pushes: contact begins at the driving tip, and more normal force is needed there."""
    pair = load_pair()
    _, force, rho_1, rho_2 = alone(loads("coast", MU))
    first = rho_1 > pair.driving.gear.l_pitch
    expected = TORQUE * NM / pair.r_b2 / (1.0 - np.where(first, MU, -MU) * rho_2 / pair.r_b2)
    clear = np.abs(rho_1 - pair.driving.gear.l_pitch) > 0.02
    np.testing.assert_allclose(force[clear], expected[clear], rtol=CHORD)
    # It does begin there: along the coast flank contact runs down the driving tooth.
    order = np.argsort(alone(loads("coast", MU))[0])
    steps = np.diff(rho_1[order])
    assert np.mean(steps < 0.0) > 0.95


@pytest.mark.parametrize("flank", FLANKS)
def test_friction_takes_power_from_whichever_gear_pushes(flank: Flank) -> None:
    """What goes in less what comes out is mu N times the sliding speed, and never negative."""
    pair = load_pair()
    _, force, rho_1, rho_2 = alone(loads(flank, MU))
    # The friction on the driven tooth, over the normal force, from the moments about the driven axis.
    drag = (pair.r_b2 - TORQUE * NM / force) / rho_2
    torque_1 = force * (pair.r_b1 - rho_1 * drag)
    speed_1, speed_2 = 1.0, pair.ratio
    lost = SENSE[flank] * (torque_1 * speed_1 - TORQUE * NM * speed_2)
    sliding = np.abs(rho_1 * speed_1 - rho_2 * speed_2)
    clear = sliding > 0.05
    # Of the power lost: a chord's error of N is divided by mu rho_2/r_b2, about 0.03.
    np.testing.assert_allclose(lost[clear], (MU * force * sliding)[clear], rtol=CHORD / 0.03)
    assert np.all(lost[clear] > 0.0)


@pytest.mark.parametrize("flank", FLANKS)
def test_friction_lowers_te_in_approach_and_raises_it_in_recess(flank: Flank) -> None:
    """On the coast flank, where load raises TE and the first part of the contact carries more, it raises, then
    lowers."""
    pair, with_, without = load_pair(), loads(flank, MU), loads(flank)
    position, _, rho_1, _ = alone(with_)
    change = (with_.te - without.te)[position] * pair.r_b2
    first = rho_1 < pair.driving.gear.l_pitch if flank == "drive" else rho_1 > pair.driving.gear.l_pitch
    clear = np.abs(rho_1 - pair.driving.gear.l_pitch) > 0.02
    assert np.all(SENSE[flank] * change[clear & first] < 0.0)
    assert np.all(SENSE[flank] * change[clear & ~first] > 0.0)


def test_friction_jumps_at_the_pitch_point() -> None:
    """Force drops from F/(1 - mu t) to F/(1 + mu t), t = rho_2/r_b2 = tan(alpha_w) there."""
    assembled = made(pair_file(pair={"friction_coefficient": MU}))
    pair = assembled.pair
    # Tooth 0's pitch point passes the line of centres at 0.
    load, _ = under(assembled, np.array([-1e-3, 1e-3]), TORQUE)
    position, force, rho_1, _ = alone(load)
    assert position.tolist() == [0, 1]
    t = math.tan(pair.alpha_w)
    F = TORQUE * NM / pair.r_b2
    assert rho_1[0] < pair.driving.gear.l_pitch < rho_1[1]
    # 1e-3 rad of rotation moves rho_2 by 0.1 % of itself, the force by mu t times that; and chords.
    np.testing.assert_allclose(force, [F / (1.0 - MU * t), F / (1.0 + MU * t)], rtol=CHORD + 1e-3 * MU * t)


def test_friction_moves_te_by_its_size_and_not_at_all_at_zero() -> None:
    base, one, two = loads("drive"), loads("drive", 0.01), loads("drive", 0.02)
    np.testing.assert_array_equal(loads("drive", 0.0).te, base.te)
    position, _, rho_1, _ = alone(one)
    position = position[np.abs(rho_1 - load_pair().driving.gear.l_pitch) > 0.02]
    # Second order: mu t of the first, 0.005 at mu = 0.01.
    np.testing.assert_allclose((two.te - base.te)[position], 2.0 * (one.te - base.te)[position], rtol=0.02)


def test_much_friction_finds_its_pairs_or_says_that_the_mesh_locks() -> None:
    """On the driven gear's tip rho_2/r_b2 is 0.73 with 12 teeth: mu = 1 still turns, and needs nearly four times the
    force. With 8 teeth and more addendum it is above 1: friction holds any load."""
    assembled = made(pair_file((12, 12), pair={"friction_coefficient": 1.0}))
    load, _ = under(assembled, one_pitch(assembled), 5.0)
    assert np.all(np.isfinite(load.te)) and np.all(load.force >= 0.0)
    locking = made(pair_file((20, 8), pair={"friction_coefficient": 1.0}, driven={"profile_shift": 0.5}))
    with pytest.raises(OutOfRangeError, match="friction_coefficient"):
        under(locking, one_pitch(locking), 5.0)


# Misalignment.


def gap_law(F: float, K: float, g: float) -> float:
    """Approach in mm under ``F`` in N: every slice of the face gives K/b per length, its gap grows from 0 to g."""
    low, high = 0.0, 10.0 * (F / K + g)
    for _ in range(200):
        middle = 0.5 * (low + high)
        touching = min(1.0, middle / g)
        carried = quad(lambda y, at=middle: K * (at - g * y), 0.0, touching)[0]
        low, high = (middle, high) if carried < F else (low, middle)
    return 0.5 * (low + high)


@pytest.mark.parametrize("part", [0.05, 0.6, 0.999, 1.001, 1.7, 20.0])
def test_a_gap_across_the_face_gives_as_its_slices_do(part: float) -> None:
    """``part`` of the load K g/2 at which the gap is just closed."""
    g = 6.0 * UM
    elasticity = Elasticity(contact="linear", misalignment=g)
    by = pair_compliance(load_pair(), elasticity)
    point = np.array([[18.0, 0.0]])
    zero = np.zeros(1, dtype=np.int64)
    teeth = by.teeth(zero, zero, point)
    K = 1.0 / float(pair_compliance(load_pair(), Elasticity(contact="linear")).secant(np.ones(1), teeth, point)[0])
    F = part * 0.5 * K * g
    found = F * float(by.secant(np.array([F]), teeth, point)[0])
    # The bisection stops at 1e-16, the integral at 1e-8.
    assert found == pytest.approx(gap_law(F, K, g), rel=1e-7)
    assert found == pytest.approx(math.sqrt(2.0 * F * g / K) if part < 1.0 else F / K + 0.5 * g, rel=1e-12)


@pytest.mark.parametrize("contact", ["linear", "palmgren"])
@pytest.mark.parametrize("gap_um", [0.0, 4.0])
@pytest.mark.parametrize("force", [3.0, 40.0, 900.0])
def test_tangent_is_the_slope_of_what_secant_gives(contact: str, gap_um: float, force: float) -> None:
    by = pair_compliance(load_pair(), Elasticity(contact=contact, misalignment=gap_um * UM))
    point = np.array([[18.0, 0.0]])
    zero = np.zeros(1, dtype=np.int64)
    teeth = by.teeth(zero, zero, point)
    step = 1e-4 * force

    def given(F: float) -> float:
        return F * float(by.secant(np.array([F]), teeth, point)[0])

    slope = (given(force + step) - given(force - step)) / (2.0 * step)
    # Central differences of a power law: (step/F)^2 = 1e-8, and rounding 1e-16/1e-4.
    assert float(by.tangent(np.array([force]), teeth, point)[0]) == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("torque", [0.5, 60.0])
def test_misalignment_through_the_kernel(flank: Flank, torque: float) -> None:
    """Where one pair carries, the mesh gives sqrt(2 F g/K) under a light torque and F/K + g/2 under a heavy one."""
    g = 8.0
    model = {"contact": "linear"}
    sound, askew = made(pair_file(model=model)), made(pair_file(model=model, pair={"misalignment_um": g}))
    theta = one_pitch(sound)
    straight, tilted = under(sound, theta, torque, flank=flank)[0], under(askew, theta, torque, flank=flank)[0]
    # Its own approach is at rotations of the shafts, levers nearly r_b: chords again.
    rigid = straight.contacts.te
    moved = -SENSE[flank] * (straight.te - rigid) * sound.pair.r_b2
    more = -SENSE[flank] * (tilted.te - tilted.contacts.te) * sound.pair.r_b2
    one = (straight.pairs == 1) & (tilted.pairs == 1)
    assert np.count_nonzero(one) > 30
    expected = np.where(moved < 0.5 * g * UM, np.sqrt(2.0 * moved * g * UM), moved + 0.5 * g * UM)
    assert (torque < 1.0) == bool(np.all(moved[one] < 0.5 * g * UM))
    np.testing.assert_allclose(more[one], expected[one], rtol=2.0 * CHORD)


def test_a_closing_gap_changes_nothing() -> None:
    sound, nearly = made(pair_file()), made(pair_file(pair={"misalignment_um": 1e-6}))
    theta = one_pitch(sound, 60)
    a, b = under(sound, theta, TORQUE)[0], under(nearly, theta, TORQUE)[0]
    # Half the gap, 0.5e-9 mm, on every pair.
    np.testing.assert_allclose(b.te * sound.pair.r_b2, a.te * sound.pair.r_b2, atol=1e-9)


@pytest.mark.long
def test_misalignment_hardens() -> None:
    """Under more torque the wider line of contact makes the mesh stiffer, up to that of straight flanks."""
    askew = made(pair_file(model={"contact": "linear"}, pair={"misalignment_um": 8.0}))
    theta = one_pitch(askew, 40)
    stiffness = [float(np.mean(under(askew, theta, t)[0].stiffness)) for t in (0.5, 2.0, 8.0, 400.0)]
    assert stiffness == sorted(stiffness)
    sound = made(pair_file(model={"contact": "linear"}))
    heavy, straight = under(askew, theta, 400.0)[0], under(sound, theta, 400.0)[0]
    one = (heavy.pairs == 1) & (straight.pairs == 1)
    assert np.count_nonzero(one) > 5
    np.testing.assert_allclose(heavy.stiffness[one], straight.stiffness[one], rtol=1e-12)


# Cracks and a scaled compliance.


@pytest.mark.parametrize("gear", [0, 1])
def test_a_crack_softens_its_own_tooth_on_the_drive_flank_only(gear: int) -> None:
    factor, tooth = 1.7, 3
    name = ("driving", "driven")[gear]
    pair = load_pair()
    cracked = made(pair_file(**{name: {"crack": [{"tooth": tooth, "compliance_factor": factor}]}})).elasticity
    assert cracked is not None
    for flank in FLANKS:
        sound, by = (pair_compliance(pair, e, flank=flank) for e in (Elasticity(), cracked))
        tables = ((sound.driving, by.driving), (sound.driven, by.driven))
        for k, (before, after) in enumerate(tables):
            expected = np.ones(before.c.shape[0])
            if k == gear and flank == "drive":
                expected[tooth] = factor
            np.testing.assert_allclose(after.c, before.c * expected[:, None], rtol=1e-14)
        force, point = np.array([500.0]), np.array([[18.0, 0.0]])
        assert sound.contact(force, point) == by.contact(force, point)


def test_a_crack_lowers_te_by_force_times_its_further_compliance() -> None:
    """Where the cracked tooth's pair carries alone; other teeth do not feel it."""
    factor, tooth = 1.5, 2
    sound = made(pair_file(model={"contact": "linear"}))
    cracked = made(
        pair_file(model={"contact": "linear"}, driven={"crack": [{"tooth": tooth, "compliance_factor": factor}]})
    )
    theta = one_pitch(sound, 720, meshes=6)
    (a, by), (b, _) = under(sound, theta, TORQUE), under(cracked, theta, TORQUE)
    change = (b.te - a.te) * sound.pair.r_b2
    pairs = np.bincount(a.contacts.position, weights=(a.force > 0.0) * (a.contacts.driven == tooth))
    assert np.all(change[pairs == 0.0] == 0.0)
    position, force, _, rho_2 = alone(a)
    mine = a.contacts.driven[(a.force > 0.0) & (a.pairs == 1)[a.contacts.position]] == tooth
    own = by.driven.at(np.full(rho_2.size, tooth), np.hypot(rho_2, sound.pair.r_b2))
    assert np.count_nonzero(mine) > 30
    also = (b.pairs == 1)[position] & mine
    np.testing.assert_allclose(change[position[also]], -(factor - 1.0) * (force * own)[also], rtol=3.0 * CHORD)


@pytest.mark.parametrize("contact", ["linear", "palmgren", "weber_banaschek"])
def test_a_scaled_compliance_scales_every_deflection_of_a_single_pair(contact: str) -> None:
    """Contact included, at the same force: approach is scale times as large."""
    sound, soft = (made(pair_file(model={"contact": contact, "compliance_scale": s})) for s in (1.0, 1.3))
    theta = one_pitch(sound)
    a, b = under(sound, theta, TORQUE)[0], under(soft, theta, TORQUE)[0]
    one = (a.pairs == 1) & (b.pairs == 1)
    # Forces settle to 1e-12; nothing else is approximate.
    np.testing.assert_allclose(b.approach[one], 1.3 * a.approach[one], rtol=1e-9)


# Shafts.


@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("rigid", [False, True])
def test_wind_up_moves_te_in_step_with_torque(flank: Flank, rigid: bool) -> None:
    """The driven side lags on the drive flank and leads on the coast flank, rigid teeth or not."""
    c = 2.5
    model = {"tooth_deflection": not rigid}
    stiff, soft = made(pair_file(model=model)), made(pair_file(model=model, pair={"windup_urad_per_nm": c}))
    theta = one_pitch(stiff, 12)
    for torque in (0.0, 7.0, 30.0):
        a, b = (
            simulate(
                one,
                theta,
                Condition(flank=flank, torque=torque * NM),
                seed=0,
                evenly=False,
                fast=True,
                progress=lambda *_: None,
            )
            for one in (stiff, soft)
        )
        np.testing.assert_allclose(b.te - a.te, -SENSE[flank] * c * torque * URAD, atol=1e-15)
        # The reading of the driving shaft goes with it; contacts do not.
        np.testing.assert_allclose(
            (b.theta_1 - a.theta_1) * stiff.pair.ratio, SENSE[flank] * c * torque * URAD, atol=1e-13
        )
        np.testing.assert_array_equal(b.backlash.j_bn, a.backlash.j_bn)


def test_nothing_of_load_shows_without_load() -> None:
    """Friction, misalignment, cracks and a scaled compliance leave unloaded TE alone."""
    further = {"friction_coefficient": 0.1, "misalignment_um": 10.0, "windup_urad_per_nm": 5.0}
    crack = {"crack": [{"tooth": 1, "compliance_factor": 3.0}]}
    bad, good = made(pair_file(pair=further, driving=crack, model={"compliance_scale": 2.0})), made(pair_file())
    theta = one_pitch(good, 40)
    for flank in FLANKS:
        np.testing.assert_array_equal(unloaded_te(bad, theta, flank=flank), unloaded_te(good, theta, flank=flank))
        load, _ = under(bad, theta, 0.0, flank=flank)
        np.testing.assert_array_equal(load.te, load.contacts.te)
