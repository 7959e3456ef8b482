"""The pair under torque: a second way to share the load, balance, limits, symmetries and signs."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from gearpoly.assemble import assemble
from gearpoly.errors import GeometryError, OutOfRangeError
from gearpoly.files.pairfile import read_pair
from gearpoly.gear.deviations import Deviations, pitch_and_thickness, tip_relief
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.mesh.compliance import ContactPair, contact_deflection, law_names
from gearpoly.mesh.compliance.contact import LAWS
from gearpoly.mesh.contact import Feature
from gearpoly.mesh.deflection import Elasticity, PairCompliance, ToothTable, pair_compliance
from gearpoly.mesh.loaded import SMALL, LoadedContacts, Sharing, load_reach, loaded
from gearpoly.mesh.pair import Flank, GearPair, active_start, mount
from gearpoly.mesh.transmission import NEAR, FlankContacts, contacts
from gearpoly.simulate import Simulation, cycle_positions, simulate, strength_remarks
from gearpoly.units import NM, UM, FloatArray, read_only
from tests.oracles.load_sharing import Spring, energy, equilibrium, study

LINEAR = Elasticity(contact="linear")
PALMGREN = Elasticity()

# Of the torque. The forces settle to 1e-12 of it; a lever of a corner contact may be a tenth of r_b, and both root
# searches round at 1e-14.
BALANCE = 1e-9


def make(
    z: tuple[int, int] = (18, 25),
    *,
    b: float = 20.0,
    deviations: tuple[Deviations | None, Deviations | None] = (None, None),
    points: int = 600,
    a: float | None = None,
    eccentricity: tuple[tuple[float, float], tuple[float, float]] = ((0.0, 0.0), (0.0, 0.0)),
) -> GearPair:
    gears = [Gear(z=z[k], m=2.0, b=b) for k in range(2)]
    flanks = [
        draw_flanks(gears[k], deviations[k], l_start=active_start(gears[k], gears[1 - k], l_form=0.0), points=points)
        for k in range(2)
    ]
    return mount(flanks[0], flanks[1], a=a, eccentricity_1=eccentricity[0], eccentricity_2=eccentricity[1])


@cache
def perfect(b: float = 20.0) -> GearPair:
    return make(b=b)


@cache
def wrong() -> GearPair:
    """Pitch and thickness as rough gears have them, both gears off their axes."""
    rng = np.random.default_rng(7)
    deviations = [
        pitch_and_thickness(
            Gear(z=z, m=2.0),
            index=read_only(rng.uniform(-6.0, 6.0, z) * UM),
            E_s=read_only(rng.uniform(-90.0, -50.0, z) * UM),
        )
        for z in (18, 25)
    ]
    return make(deviations=(deviations[0], deviations[1]), a=43.02, eccentricity=((15.0 * UM, 0.7), (10.0 * UM, 2.0)))


def one_pitch(pair: GearPair, count: int = 160) -> FloatArray:
    # A start off every mark, so that no position falls on the end of a path.
    return (0.0037 + np.arange(count) / count) * pair.driven.gear.tau


_FOUND: dict[tuple[int, Flank, int], tuple[GearPair, FlankContacts]] = {}


def near_contacts(pair: GearPair, flank: Flank = "drive", meshes: int = 1, count: int = 160) -> FlankContacts:
    """Contacts that suffice for the greatest torque used here, found once for each pair."""
    key = (id(pair), flank, meshes)
    if key not in _FOUND:
        # The pair is kept too, so that no other takes its id.
        _FOUND[key] = (pair, _near_contacts(pair, flank, meshes, count))
    return _FOUND[key][1]


def _near_contacts(pair: GearPair, flank: Flank, meshes: int, count: int) -> FlankContacts:
    reach = max(
        load_reach(pair_compliance(pair, Elasticity(contact=law), flank=flank), 250.0 * NM)
        for law in ("palmgren", "weber_banaschek")
    )
    theta_2 = one_pitch(pair, count) if meshes == 1 else np.arange(count) * (meshes * pair.driven.gear.tau / count)
    return contacts(pair, theta_2, flank=flank, near=NEAR + reach)


def under(
    pair: GearPair,
    torque_nm: float,
    elasticity: Elasticity = PALMGREN,
    *,
    flank: Flank = "drive",
    sharing: Sharing = "equilibrium",
    meshes: int = 1,
) -> LoadedContacts:
    compliance = pair_compliance(pair, elasticity, flank=flank)
    return loaded(near_contacts(pair, flank, meshes), compliance, torque=torque_nm * NM, sharing=sharing)


def levers(pair: GearPair, found: FlankContacts) -> tuple[FloatArray, FloatArray]:
    """Distances of each line of action from both axes, mm."""
    (x, y), (nx, ny) = found.point.T, found.normal.T
    return np.abs(x * ny - y * nx), np.abs((x - pair.a) * ny - y * nx)


def per_position(result: LoadedContacts, rows: FloatArray) -> FloatArray:
    return np.bincount(result.contacts.position, weights=rows, minlength=result.te.size)


def same_set(*results: LoadedContacts) -> FloatArray:
    """Positions at which the same pairs carry in all ``results``."""
    first = results[0].force > 0.0
    differ = np.zeros(results[0].te.size)
    for result in results[1:]:
        differ += per_position(result, ((result.force > 0.0) != first).astype(float))
    return differ == 0.0


# A second way to the same forces.


def tables(pair: GearPair, rng: np.random.Generator) -> list[ToothTable]:
    """Tooth compliances of no gear, from 1e-6 to 1e-5 mm/N, rising and falling anyhow."""
    return [
        ToothTable(
            r=read_only(np.linspace(gear.r_b, gear.r_a, 9)), c=read_only(10.0 ** rng.uniform(-6.0, -5.0, (gear.z, 9)))
        )
        for gear in (pair.driving.gear, pair.driven.gear)
    ]


def random_contacts(pair: GearPair, rng: np.random.Generator, *, positions: int, spread: float) -> FlankContacts:
    """Contacts of no gears: up to 5 near pairs whose gaps (mm, up to ``spread``), places and normals are random."""
    count = rng.integers(1, 6, positions)
    position = np.repeat(np.arange(positions), count)
    gap = np.concatenate([np.concatenate(([0.0], np.sort(rng.uniform(0.0, spread, n - 1)))) for n in count])
    angle = np.deg2rad(rng.uniform(60.0, 80.0, position.size))
    return FlankContacts(
        flank="drive",
        theta_2=np.arange(positions) * 0.01,
        te=np.zeros(positions),
        position=position,
        driving=rng.integers(0, 18, position.size),
        driven=rng.integers(0, 25, position.size),
        gap=gap,
        point=np.column_stack((18.0 + rng.uniform(-1.5, 1.5, gap.size), rng.uniform(-4.0, 4.0, gap.size))),
        normal=np.column_stack((np.cos(angle), np.sin(angle))),
        feature=np.zeros(gap.size, dtype=np.int64),
        overrun=np.zeros(gap.size),
        touching=gap == 0.0,
        pairs=np.bincount(position[gap == 0.0], minlength=positions),
        certified=0,
        repaired=0,
    )


def springs(compliance: PairCompliance, found: FlankContacts) -> Iterator[list[Spring]]:
    """The oracle's problem at each position, read from the tables without the code's own reading of them."""
    pair, E, nu, b = compliance.pair, compliance.elasticity.E, compliance.elasticity.nu, compliance.b
    A, p = {
        "palmgren": (1.275 / (E**0.9 * b**0.8), 0.9),
        "linear": (4.0 * (1.0 - nu**2) / (np.pi * E * b), 1.0),
    }[compliance.elasticity.contact]
    lever_1, lever_2 = levers(pair, found)
    for n in range(found.theta_2.size):
        out = []
        for i in np.flatnonzero(found.position == n):
            c = 0.0
            for table, tooth, x in (
                (compliance.driving, found.driving[i], found.point[i, 0]),
                (compliance.driven, found.driven[i], found.point[i, 0] - pair.a),
            ):
                c += float(np.interp(np.hypot(x, found.point[i, 1]), table.r, table.c[tooth]))
            out.append(Spring(found.gap[i] / pair.r_b1, lever_1[i], lever_2[i], c, A, p))
        yield out


@pytest.mark.parametrize("contact", ["palmgren", "linear"])
@pytest.mark.parametrize(("torque_nm", "spread_um"), [(1e-3, 2e-4), (5.0, 1.0), (25.0, 20.0), (120.0, 5.0)])
def test_forces_are_those_of_nested_root_finding(contact: str, torque_nm: float, spread_um: float) -> None:
    rng = np.random.default_rng(3)
    pair, torque = perfect(), torque_nm * NM
    driving, driven = tables(pair, rng)
    elasticity = Elasticity(contact=contact)
    compliance = PairCompliance(pair=pair, elasticity=elasticity, b=20.0, driving=driving, driven=driven)
    found = random_contacts(pair, rng, positions=120, spread=spread_um * UM)
    result = loaded(found, compliance, torque=torque)
    force = torque / pair.r_b2
    carrying = []
    for n, problem in enumerate(springs(compliance, found)):
        phi, forces = equilibrium(problem, torque)
        mine = result.force[found.position == n]
        np.testing.assert_allclose(mine, forces, atol=BALANCE * force, rtol=0.0)
        assert result.approach[n] == pytest.approx(phi * pair.r_b1, rel=BALANCE)
        assert -result.te[n] == pytest.approx(phi * pair.ratio, rel=BALANCE)
        carrying.append(np.count_nonzero(mine))
        # Equilibrium is the least of complementary energy: moving a hundredth of the load anywhere costs energy.
        least = energy(problem, forces)
        for i in range(len(problem)):
            moved = [0.99 * W for W in forces]
            moved[i] += 0.01 * torque / problem[i].lever_2
            # Nothing moves where that pair carries it all.
            assert energy(problem, moved) > least or forces[i] * problem[i].lever_2 > 0.999 * torque
    # The trial holds problems of one and of many carrying pairs.
    assert min(carrying) == 1
    assert max(carrying) >= 4


@pytest.mark.parametrize("contact", ["palmgren", "linear"])
def test_forces_on_error_gears_are_those_of_nested_root_finding(contact: str) -> None:
    pair, torque = wrong(), 40.0 * NM
    compliance = pair_compliance(pair, Elasticity(contact=contact))
    found = near_contacts(pair, "drive", 25)
    result = loaded(found, compliance, torque=torque)
    for n, problem in enumerate(springs(compliance, found)):
        _, forces = equilibrium(problem, torque)
        np.testing.assert_allclose(
            result.force[found.position == n], forces, atol=BALANCE * torque / pair.r_b2, rtol=0.0
        )


# Balance and compression.


@pytest.mark.parametrize("flank", ["drive", "coast"])
@pytest.mark.parametrize("torque_nm", [0.01, 5.0, 200.0])
def test_moments_balance_and_only_pressed_pairs_carry(torque_nm: float, flank: Flank) -> None:
    for pair in (perfect(), wrong()):
        meshes = 1 if pair is perfect() else 25
        result = under(pair, torque_nm, flank=flank, meshes=meshes)
        lever_1, lever_2 = levers(pair, result.contacts)
        moment = per_position(result, result.force * lever_2)
        np.testing.assert_allclose(moment, torque_nm * NM, rtol=BALANCE)
        assert np.min(result.force) >= 0.0
        # Shares are of the force sum; roundings of up to 3 summands.
        np.testing.assert_allclose(per_position(result, result.share), 1.0, rtol=1e-14)
        np.testing.assert_array_equal(per_position(result, (result.force > 0.0).astype(float)), result.pairs)
        # A pair that carries is pressed, a pair that does not stands off: the approach of each against its gap.
        pressed = result.approach[result.contacts.position] - result.contacts.gap
        # 1e-12 mm: rounding of the gap over its lever.
        assert np.all(pressed[result.force > 0.0] > -1e-12)
        assert np.all(pressed[result.force == 0.0] < 1e-12)
        # On the flanks of gears on their own axes both levers are the base radii. Chords touch with a vertex up to
        # half their 8 um from the true place, and the normal there is off by that over the radius of curvature.
        if pair is perfect():
            flanks = result.contacts.feature == int(Feature.FLANK)
            np.testing.assert_allclose(lever_1[flanks], pair.r_b1, rtol=1e-3)


def test_virtual_work_of_the_loads() -> None:
    """Energy of the springs grows by torque times the turn: dU/dT = T dphi/dT (r_b2 measures the torque, r_b1 phi)."""
    pair = perfect()
    torques = np.linspace(0.0, 60.0, 41)
    runs = [under(pair, float(t), LINEAR) for t in torques]
    compliance = pair_compliance(pair, LINEAR)
    found = runs[0].contacts
    contact = 4.0 * (1.0 - 0.3**2) / (np.pi * 206000.0 * 20.0)
    c = compliance.teeth(found.driving, found.driven, found.point) + contact
    stored = np.array([per_position(run, 0.5 * c * run.force**2) for run in runs])
    work = np.zeros(stored.shape)
    for k in range(1, len(runs)):
        mean = 0.5 * (torques[k] + torques[k - 1]) * NM / pair.r_b2
        work[k] = work[k - 1] + mean * (runs[k].approach - runs[k - 1].approach)
    # Both levers of a corner contact shrink by up to 3 %, and trapezoids cut the kinks where a pair joins by 1/40^2.
    np.testing.assert_allclose(work[-1], stored[-1], rtol=0.01)
    flanks = per_position(runs[-1], (found.feature != int(Feature.FLANK)) * runs[-1].force) == 0.0
    # Without corners nothing joins late: quadratic, which trapezoids of the force take exactly, but for chord gaps
    # of 1e-3 um under 3 um.
    assert np.count_nonzero(flanks) > 50
    np.testing.assert_allclose(work[-1][flanks], stored[-1][flanks], rtol=2e-3)


# Hooke.


def test_half_the_torque_bends_half_as_far() -> None:
    pair = perfect()
    half, whole = under(pair, 30.0, LINEAR), under(pair, 60.0, LINEAR)
    flanks = per_position(whole, (whole.contacts.feature != int(Feature.FLANK)) * whole.force) == 0.0
    same = same_set(half, whole) & flanks
    assert np.count_nonzero(same) > 50
    # Chords hold one of two touching pairs back by up to their sagittas.
    np.testing.assert_allclose(2.0 * half.approach[same], whole.approach[same], rtol=0.0, atol=2.0 * pair.chord_noise)
    # A pair that joins makes the mesh stiffer, so elsewhere half the torque gives more than half.
    assert np.all(2.0 * half.approach >= whole.approach - 2.0 * pair.chord_noise)
    assert np.max(2.0 * half.approach / whole.approach) > 1.05


def test_palmgren_keeps_between_hooke_and_the_tenth_power() -> None:
    pair = perfect()
    half, whole = under(pair, 30.0), under(pair, 60.0)
    same = same_set(half, whole)
    alone = same & (whole.pairs == 1)
    ratio = whole.approach[alone] / half.approach[alone]
    assert np.all((ratio > 2.0**0.9) & (ratio < 2.0))
    # One pair alone: the teeth's part doubles and the contact's grows by 2^0.9, exactly.
    force = 30.0 * NM / pair.r_b2
    flattening, _ = contact_deflection(force, ContactPair(b=20.0, E_1=206e3, E_2=206e3))
    expected = 2.0 + (2.0**0.9 - 2.0) * float(flattening) / half.approach[alone]
    # 1e-4: levers off r_b by the chords' slope.
    np.testing.assert_allclose(ratio, expected, rtol=1e-4)


def test_twice_the_width_halves_the_deflection() -> None:
    """20 and 40 mm are both wide; where the contact is linear, too, width only divides the compliance."""
    found = near_contacts(perfect())
    width = {b: pair_compliance(perfect(b), LINEAR) for b in (20.0, 40.0)}
    single, alike = (loaded(found, width[b], torque=50.0 * NM) for b in (20.0, 40.0))
    # Twice the width under twice the torque: the same everywhere, corners too. Rounding of the gaps, 1e-12 mm.
    double = loaded(found, width[40.0], torque=100.0 * NM)
    np.testing.assert_allclose(double.approach, single.approach, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(double.force, 2.0 * single.force, rtol=0.0, atol=1e-5)
    # Under the same torque, half, where one pair carries before and after.
    alone = same_set(single, alike) & (single.pairs == 1)
    assert np.count_nonzero(alone) > 40
    np.testing.assert_allclose(2.0 * alike.approach[alone], single.approach[alone], rtol=1e-9)


def test_the_narrower_face_carries() -> None:
    gears = [Gear(z=18, m=2.0, b=12.0), Gear(z=25, m=2.0, b=30.0)]
    flanks = [draw_flanks(gear, points=100) for gear in gears]
    assert pair_compliance(mount(flanks[0], flanks[1]), PALMGREN).b == 12.0


# Torque to nought.


def test_no_torque_is_the_unloaded_kernel() -> None:
    for pair in (perfect(), wrong()):
        result = under(pair, 0.0)
        np.testing.assert_array_equal(result.te, result.contacts.te)
        np.testing.assert_array_equal(result.pairs, result.contacts.pairs)
        assert np.all(result.force == 0.0)
        assert np.all(result.approach == 0.0)


def test_little_torque_meets_the_unloaded_kernel_at_hookes_rate() -> None:
    pair = wrong()
    torques = np.array([1e-6, 1e-5, 1e-4, 1e-3])
    off = np.array([under(pair, float(t), LINEAR).approach for t in torques])
    # Every torque a tenth: first order. 1e-6 of the deflection is what rounding of 1e-15 rad leaves at 1e-6 N.m.
    rate = np.log10(off[1:] / off[:-1])
    lone = per_position(under(pair, 1e-3, LINEAR), np.ones(near_contacts(pair).gap.size))
    assert lone.size == off.shape[1]
    assert np.median(rate) == pytest.approx(1.0, abs=1e-6)
    assert np.all(rate <= 1.0 + 1e-6)
    # The first pair alone under the torque is the most that the mesh gives.
    compliance = pair_compliance(pair, LINEAR)
    for k, torque in enumerate(torques):
        assert np.max(off[k]) < load_reach(compliance, float(torque) * NM)
    # With Palmgren's contact the rate is the tenth power's in the end, and never above first order.
    off = np.array([under(pair, float(t)).approach for t in torques])
    rate = np.log10(off[1:] / off[:-1])
    assert np.all((rate > 0.9 - 1e-6) & (rate < 1.0))


# Signs and symmetries.


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
        found = contacts(pair, theta_2, flank=side, near=NEAR + load_reach(compliance, 25.0 * NM))
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
        found = contacts(pair, theta_2, near=NEAR + load_reach(compliance, 25.0 * NM))
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


@pytest.mark.parametrize("torque_nm", [0.1, 5.0])
def test_mean_pairs_at_40_positions_a_mesh_is_the_fine_count(torque_nm: float) -> None:
    pair = wrong()
    compliance = pair_compliance(pair, PALMGREN)
    found = contacts(pair, cycle_positions(pair, turns=4.0), near=NEAR + load_reach(compliance, torque_nm * NM))
    result = loaded(found, compliance, torque=torque_nm * NM)
    # One pair at least touches everywhere.
    assert result.mean_pairs >= 1.0
    # Plain counting at 4000 positions leaves half a step, 1/80, at a few of 100 ends: 0.003 in the mean.
    assert result.mean_pairs == pytest.approx(float(np.mean(result.pairs)), abs=0.005)


# Relief.


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


# Each tooth of an error gear is its own beam.


def thin_tooth(b: float, E_s: float) -> GearPair:
    thickness = np.zeros(18)
    thickness[5] = E_s
    deviations = pitch_and_thickness(Gear(z=18, m=2.0), index=read_only(np.zeros(18)), E_s=read_only(thickness))
    return make(b=b, deviations=(deviations, None), points=200)


@pytest.mark.parametrize("law", [name for name in law_names() if name != "iso6336"])
def test_a_thin_tooth_is_softer(law: str) -> None:
    c = pair_compliance(thin_tooth(20.0, -100.0 * UM), Elasticity(law=law)).driving.c
    others = np.delete(c, 5, axis=0)
    # Teeth alike are alike to rounding.
    np.testing.assert_allclose(others, np.broadcast_to(others[0], others.shape), rtol=1e-12)
    assert np.all(c[5] > others[0])
    # Bending goes with 1/h^3: 3 % off the thickness is up to 10 % at the tip.
    assert 1.03 < c[5, -1] / others[0, -1] < 1.12


def test_a_thin_tooth_is_softer_at_any_width() -> None:
    # H_p is 3.138 mm, so 15.65 mm is 4.99 of it: the thin tooth alone counts as wide, 9 % stiffer.
    c = pair_compliance(thin_tooth(15.65, -20.0 * UM), PALMGREN).driving.c
    assert np.all(c[5] > c[0])


def test_coast_flanks_have_tables_of_their_own() -> None:
    relief = Deviations(drive=(tip_relief(Gear(z=18, m=2.0), amount=50.0 * UM, length=1.0, shape="linear"),))
    pair = make(deviations=(relief, None), points=200)
    drive, coast = (pair_compliance(pair, PALMGREN, flank=flank) for flank in ("drive", "coast"))
    assert np.max(np.abs(drive.driving.c - coast.driving.c)) > 0.0
    np.testing.assert_allclose(drive.driven.c, coast.driven.c, rtol=1e-12)


@pytest.mark.parametrize("law", law_names())
@pytest.mark.parametrize("contact", sorted(LAWS))
def test_every_law_runs_and_balances(law: str, contact: str) -> None:
    pair = wrong()
    result = under(pair, 25.0, Elasticity(law=law, contact=contact))
    _, lever_2 = levers(pair, result.contacts)
    np.testing.assert_allclose(per_position(result, result.force * lever_2), 25.0 * NM, rtol=BALANCE)
    per_width = float(np.mean(result.stiffness)) * UM / 20.0
    # ISO 6336-1 gives a mesh of 18/25 (0.75 eps + 0.25) 14.7 = 21 N/(mm um); the laws stand within a quarter of that,
    # and error gears share less.
    assert 12.0 < per_width < 27.0


# Bad input.


def test_deflections_that_are_not_small_are_refused() -> None:
    pair = perfect()
    compliance = pair_compliance(pair, PALMGREN)
    with pytest.raises(OutOfRangeError, match="small deflections no longer hold"):
        loaded(near_contacts(pair), compliance, torque=2000.0 * NM)
    # Within the bound it runs, and close to it.
    high = loaded(near_contacts(pair), compliance, torque=600.0 * NM)
    assert 0.7 * SMALL * 2.0 < np.max(high.approach) < SMALL * 2.0


@pytest.mark.parametrize("torque", [-1.0, float("nan")])
def test_a_torque_that_is_none_is_refused(torque: float) -> None:
    with pytest.raises(OutOfRangeError, match="0 or more"):
        loaded(near_contacts(perfect()), pair_compliance(perfect(), PALMGREN), torque=torque)


def test_teeth_without_a_width_do_not_bend() -> None:
    gears = [Gear(z=18, m=2.0), Gear(z=25, m=2.0)]
    with pytest.raises(GeometryError, match=r"driving\.face_width_mm is missing"):
        pair_compliance(mount(*(draw_flanks(gear, points=50) for gear in gears)), PALMGREN)


# Files and the command line.

PAIR = """\
[pair]
torque_nm = {torque}
{model}
[driving]
teeth = 18
module_mm = 2.0
points_per_flank = 150
{width}
[driven]
teeth = 25
module_mm = 2.0
points_per_flank = 150
{width}
"""


def pair_file(folder: Path, *, torque: float = 25.0, model: str = "", width: str = "face_width_mm = 20.0") -> Path:
    path = folder / "pair.toml"
    path.write_text(PAIR.format(torque=torque, model=f"[model]\n{model}\n" if model else "", width=width))
    return path


def run(path: Path, *, torque_nm: float) -> Simulation:
    assembled = assemble(read_pair(path), path=path, seed=0)
    return simulate(
        assembled,
        one_pitch(assembled.pair, 40),
        torque=torque_nm * NM,
        flank="drive",
        seed=0,
        evenly=False,
        progress=lambda done: None,
    )


def test_rigid_teeth_stay_rigid(tmp_path: Path) -> None:
    rigid = run(pair_file(tmp_path, model="tooth_deflection = false"), torque_nm=120.0)
    assert rigid.load is None
    np.testing.assert_array_equal(rigid.te, rigid.contacts.te)
    # Rigid teeth need no width either.
    narrow = run(pair_file(tmp_path, model="tooth_deflection = false", width=""), torque_nm=120.0)
    np.testing.assert_array_equal(narrow.te, rigid.te)
    bent = run(pair_file(tmp_path), torque_nm=120.0)
    assert np.all(bent.te < rigid.te)


def test_the_file_chooses_laws_and_material(tmp_path: Path) -> None:
    plain = run(pair_file(tmp_path, model='contact = "linear"'), torque_nm=50.0)
    soft = run(pair_file(tmp_path, model='contact = "linear"\n[material]\nyoungs_modulus_gpa = 103.0'), torque_nm=25.0)
    assert plain.load is not None
    assert soft.load is not None
    # Half the modulus under half the torque is the same shape; rounding.
    np.testing.assert_allclose(soft.load.approach, plain.load.approach, rtol=1e-9)
    means = {}
    for law in law_names():
        found = run(pair_file(tmp_path, model=f'compliance = "{law}"'), torque_nm=25.0).load
        assert found is not None
        means[law] = float(np.mean(found.approach))
    assert len(set(means.values())) == len(means)


def test_yield_is_remarked_with_its_stress(tmp_path: Path) -> None:
    path = pair_file(tmp_path)
    assert strength_remarks(run(path, torque_nm=25.0)) == []
    (remark,) = strength_remarks(run(path, torque_nm=500.0))
    assert "would yield" in remark
    # Lewis's own section is that with the greatest h/s^2. The remark takes the whole height and the least thickness,
    # which do not belong to one section, and stays above it by up to a quarter.
    flanks = assemble(read_pair(path), path=path, seed=0).pair.driving.flanks
    half = flanks.psi_drive[0]
    height, thickness = flanks.gear.r_a - flanks.r * np.cos(half), 2.0 * flanks.r * np.sin(half)
    stress = 6.0 * (500.0 * NM / 23.4923) / 20.0 * float(np.max(height / thickness**2))
    assert 1.0 < float(remark.split(" is ")[1].split(" MPa")[0]) / stress < 1.3


def command(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "gearpoly", *arguments], capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("torque", "width", "says"),
    [
        (-5.0, "face_width_mm = 20.0", "torque_nm"),
        (25.0, "face_width_mm = 0.0", "face_width_mm"),
        (25.0, "", "face_width_mm"),
        (1e6, "face_width_mm = 20.0", "small deflections"),
    ],
)
def test_bad_loads_exit_2_and_leave_nothing(tmp_path: Path, torque: float, width: str, says: str) -> None:
    out = tmp_path / "out.csv"
    path = pair_file(tmp_path, torque=torque, width=width)
    done = command("simulate", str(path), "--turns", "0.04", "--points-per-mesh", "4", "--csv", str(out))
    assert done.returncode == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert not out.exists()
