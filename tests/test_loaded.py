"""The pair under torque: a second way to share the load, balance, limits, symmetries and signs."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.errors import NotConvergedError
from gearpoly.gear.flank import draw_flanks
from gearpoly.gear.gear import Gear
from gearpoly.mesh.balance import balance
from gearpoly.mesh.compliance import ContactPair, contact_deflection
from gearpoly.mesh.contact import Feature
from gearpoly.mesh.deflection import LEAST_LOAD, Elasticity, PairCompliance, pair_compliance
from gearpoly.mesh.loaded import Sharing, load_reach, loaded
from gearpoly.mesh.pair import Flank, mount
from gearpoly.units import NM, UM
from tests.made_loaded import (
    BALANCE,
    LINEAR,
    PALMGREN,
    levers,
    near_contacts,
    per_position,
    perfect,
    random_contacts,
    same_set,
    springs,
    tables,
    under,
    wrong,
)
from tests.oracles.load_sharing import energy, equilibrium


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


@pytest.mark.parametrize("contact", ["palmgren", "linear", "weber_banaschek"])
@pytest.mark.parametrize("gap_um", [0.0, 0.5, 15.0])
@pytest.mark.parametrize("torque_nm", [1e-3, 1.0, 60.0])
def test_every_pair_gives_as_its_law_has_it(contact: str, gap_um: float, torque_nm: float) -> None:
    """The compiled balance writes the laws a second time; here its forces are put into the first."""
    rng = np.random.default_rng(11)
    pair = wrong()
    by = pair_compliance(pair, Elasticity(contact=contact, misalignment=gap_um * UM))
    found = random_contacts(pair, rng, positions=200, spread=(5.0 if torque_nm > 0.1 else 1e-3) * UM)
    result = loaded(found, by, torque=torque_nm * NM)
    closed = (result.approach[found.position] - found.gap) / pair.r_b1 * levers(pair, found)[0]
    carries = result.force > 0.0
    teeth = by.teeth(found.driving, found.driven, found.point)
    least = np.maximum(result.force, LEAST_LOAD * torque_nm * NM / pair.r_b2)
    gives = result.force * by.secant(least, teeth, found.point)
    # Roundings of closings of some um, against what the pair that carries most gives.
    np.testing.assert_allclose(gives[carries], closed[carries], atol=1e-10 * np.max(gives), rtol=0.0)
    assert np.max(closed[~carries], initial=-1.0) <= 1e-10 * np.max(gives)
    np.testing.assert_allclose(
        per_position(result, result.force * levers(pair, found)[1]), torque_nm * NM, rtol=BALANCE
    )
    # The trial holds positions of one and of several carrying pairs.
    assert np.min(result.pairs) == 1 < np.max(result.pairs)


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


@pytest.mark.parametrize(
    ("closing_2", "lever", "locked"), [(0.005, 27.0, 0), (0.0003, 27.0, 1), (0.005, -27.0, 1)], ids=str
)
def test_a_pair_that_friction_turns_backward_stays_open_or_locks(closing_2: float, lever: float, locked: int) -> None:
    """A spring alone closes by F c: a second one of negative lever changes nothing until it is reached."""
    moment, softness = 700.0, 2.6e-4
    rows = np.array([17.0, 11.0]), np.array([lever, -7.0]), np.full(2, softness)
    laws = {"level": np.zeros(2), "power": 0.0, "logarithm": 0.0, "gap": 0.0}
    phi, force, restless = balance(
        np.array([0, 2]), np.array([0.0, closing_2]), *rows, **laws, moment=moment, whole=30.0, least=3e-8, still=3e-11
    )
    assert restless == locked
    if not locked:
        np.testing.assert_allclose(force, [moment / 27.0, 0.0], rtol=1e-12)
        assert phi[0] == pytest.approx(moment * softness / (17.0 * 27.0), rel=1e-12)


@pytest.mark.parametrize("sharing", ["equilibrium", "paper"])
def test_teeth_that_friction_locks_do_not_settle(sharing: Sharing) -> None:
    """Friction of three times the load turns every pair backward that slides against it."""
    rng = np.random.default_rng(5)
    pair = perfect()
    driving, driven = tables(pair, rng)
    compliance = PairCompliance(pair=pair, elasticity=Elasticity(friction=3.0), b=20.0, driving=driving, driven=driven)
    contacts = random_contacts(pair, rng, positions=60, spread=0.2 * UM)
    with pytest.raises(NotConvergedError, match="friction"):
        loaded(contacts, compliance, torque=25.0 * NM, sharing=sharing)
