"""Zeros and tooth numberings found again from recordings whose zeros are known."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.assemble import Assembled
from gearpoly.compare import align
from gearpoly.compare.compare import lay_beside
from gearpoly.compare.curve import Cycle
from gearpoly.compare.place import Attempt, is_worse
from gearpoly.compare.template import make_template
from gearpoly.errors import InputFileError
from gearpoly.files.pairfile import read_pair
from gearpoly.mesh.condition import Condition
from gearpoly.recording.recording import Flank, Recording
from gearpoly.units import DEG, NM, UM
from tests import made_recordings
from tests.made_recordings import HALF_1, HALF_2, RIG, TURN, Rig, errors, flat_pair, inspected, off_deg, te_of

NEEDED = 0.02
"""deg. What alignment has to reach."""


def teeth() -> np.random.Generator:
    """Draws one and the same pair for all tests, whose simulation is found once."""
    return np.random.default_rng(1)


def record(made: Assembled, rig: Rig, rng: np.random.Generator, *, per_mesh: int = 8, **how: Any) -> Recording:
    """3600 samples of a hunting cycle, half as many as recordings of other tests."""
    return made_recordings.record(made, rig, rng, per_mesh=per_mesh, **how)


# The simulated curve.


@pytest.mark.long
@pytest.mark.parametrize(("flank", "torque"), [("drive", 0.0), ("coast", 0.0), ("drive", 80.0)])
def test_template_is_the_simulation_at_any_angle(tmp_path: Path, flank: str, torque: float) -> None:
    side: Flank = "coast" if flank == "coast" else "drive"
    _, _, made = inspected(tmp_path, teeth(), bends=torque > 0.0)
    template = make_template(made, Condition(flank=side, torque=torque * NM))
    assert template.error <= 0.021 * UM  # what it was asked for, and the rounding of its last halving
    theta_2 = np.random.default_rng(2).uniform(-3.0, 2.0, 2000) * made.pair.cycle
    exact = te_of(made, theta_2, flank=side, torque_nm=torque) * made.pair.r_b2
    # The error is measured where lines were halved, and two bends within one interval may hide twice as much; chords
    # bend the curve everywhere, by their sagitta.
    atol = 2.0 * template.error + made.pair.chord_noise
    np.testing.assert_allclose(template.at(theta_2), exact, atol=atol)
    np.testing.assert_allclose(template.at(theta_2 + template.cycle), template.at(theta_2), atol=1e-9)


@pytest.mark.long
def test_template_says_which_pairs_carry(tmp_path: Path) -> None:
    _, _, made = inspected(tmp_path, teeth(), bends=True)
    template = make_template(made, Condition(flank="drive", torque=100.0 * NM))
    share = template.sharing.share
    assert share is not None
    np.testing.assert_allclose(share.sum(axis=0), 1.0, atol=1e-12)  # shares of one whole, to rounding
    begin, end = template.sharing.contact
    # A pair is in touch for the contact ratio's number of pitches.
    assert end - begin == pytest.approx(made.pair.eps_alpha, abs=1e-9)
    bend = template.deflection(template.theta_2)
    assert bend is not None
    assert bend.max() < 0.0  # load lets the driven gear fall back, everywhere


# One recording.


@pytest.mark.long
@pytest.mark.parametrize(
    ("rig", "wrapped"),
    [
        (RIG, False),
        (Rig(zero_1=0.3, zero_2=5.9, direction_1=-1), True),
        (Rig(zero_1=6.1, zero_2=0.2, direction_1=-1, direction_2=-1), True),
        (Rig(zero_1=1.0, zero_2=3.0, noise=1.0, correlation=0.6), False),
    ],
    ids=["plain", "one counts down", "both count down, wrapped", "loud coloured noise"],
)
def test_zeros_and_numberings_are_found_from_nothing(tmp_path: Path, rig: Rig, wrapped: bool) -> None:
    rng = np.random.default_rng(4)
    file, path, made = inspected(tmp_path, teeth(), gauge=0.2)
    beside = lay_beside(file, [record(made, rig, rng, wrapped=wrapped)], path=path)
    found = beside.alignment
    assert found.phased
    assert found.numbering == "curves"
    assert not found.rivals
    error_1, error_2 = errors(beside, rig)
    # Four stated standard errors: one honest case in 10^4 lies beyond.
    assert abs(error_1) < 4.0 * found.std_driving / DEG
    assert abs(error_2) < 4.0 * found.std_driven / DEG
    assert found.std_driven / DEG < NEEDED
    assert abs(error_2) < NEEDED
    # What is left is the noise and the gauge's 0.2 um of four numbers per pair of teeth, not the pair's own curve.
    assert beside.aligned[0].rms < math.hypot(rig.noise, 4.0 * 0.2) * UM


@pytest.mark.parametrize("wrong", [(0.95, 0.95), (-0.95, 0.95), (0.3, -0.9)], ids=["both late", "apart", "mixed"])
def test_zeros_wrong_by_half_a_tooth_are_refined(tmp_path: Path, wrong: tuple[float, float]) -> None:
    rng = np.random.default_rng(5)
    file, path, made = inspected(tmp_path, teeth(), gauge=0.2)
    stated = (RIG.zero_1 + wrong[0] * HALF_1, RIG.zero_2 + wrong[1] * HALF_2)
    beside = lay_beside(file, [record(made, RIG, rng, stated=stated)], path=path)
    assert all(beside.alignment.numbered)
    assert np.max(np.abs(errors(beside, RIG))) < NEEDED
    assert beside.alignment.contradicted is None


@pytest.mark.long
def test_aligned_angles_are_the_true_ones(tmp_path: Path) -> None:
    """Teeth are told by both rotations, so both have to be right by whole turns too, not only the zeros."""
    rng = np.random.default_rng(6)
    file, path, made = inspected(tmp_path, teeth())
    recording = record(made, RIG, rng, per_mesh=16)
    one = lay_beside(file, [recording], path=path).aligned[0]
    assert recording.driven_angle_rad is not None
    late = np.remainder(one.theta_2 - (recording.driven_angle_rad - RIG.zero_2) + 1.0, TURN) - 1.0
    np.testing.assert_allclose(late, 0.0, atol=NEEDED * DEG)
    exact = te_of(made, one.theta_2, flank="drive", torque_nm=0.0) * made.pair.r_b2
    # The noise, within four of its own standard errors and a tenth.
    assert np.std(one.recorded - exact) < 1.1 * RIG.noise * UM
    te = (one.theta_2 - made.pair.ratio * one.theta_1) * made.pair.r_b2
    np.testing.assert_allclose(te, one.recorded, atol=1e-9)  # rounding of angles of some hundred rad
    # What a parabola takes off the steps between teeth (0.6 um here) moves the angles as estimated by arcseconds.
    read_1, read_2 = one.estimated
    assert np.std((read_2 - made.pair.ratio * read_1) * made.pair.r_b2 - exact) < 1.0 * UM


def test_places_that_differ_by_rounding_are_equal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Gears without a curve fit everywhere alike, and a zero that is right had been doubted for 4e-14 in 55."""
    seen: list[tuple[list[Attempt], Cycle]] = []
    chosen = align._chosen

    def watched(tries: list[Attempt], cycle: Cycle, off: Any) -> tuple[Attempt, list[Attempt]]:
        seen.append((tries, cycle))
        return chosen(tries, cycle, off)

    monkeypatch.setattr(align, "_chosen", watched)
    _, _, made = inspected(tmp_path, teeth())
    path = flat_pair(tmp_path)
    rng, stated = np.random.default_rng(3), (RIG.zero_1, RIG.zero_2)
    beside = lay_beside(read_pair(path), [record(made, RIG, rng, cycles=0.5, stated=stated)], path=path)
    assert beside.alignment.contradicted is None
    (one, *_), cycle = seen[0]
    assert not is_worse(replace(one, misfit=one.misfit * (1.0 + 1e-15)), one, cycle)
    assert is_worse(replace(one, misfit=one.misfit * (1.0 + 1e-3)), one, cycle)


@pytest.mark.long
def test_a_stated_zero_off_by_three_teeth_is_told(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    file, path, made = inspected(tmp_path, teeth())
    stated = (RIG.zero_1 + 3.0 * TURN / 18, RIG.zero_2 + 3.0 * TURN / 25)
    beside = lay_beside(file, [record(made, RIG, rng, per_mesh=16, stated=stated)], path=path)
    wrong = beside.alignment.contradicted
    assert wrong is not None
    assert abs(off_deg(wrong.driven, RIG.zero_2)) < NEEDED
    assert any("check the stated zeros" in remark for remark in beside.remarks)


@pytest.mark.long
@pytest.mark.parametrize("cycles", [0.12, 0.3])
def test_recordings_shorter_than_a_hunting_cycle(tmp_path: Path, cycles: float) -> None:
    """Three and seven driving turns of the 25 after which the teeth meet again."""
    rng = np.random.default_rng(8)
    file, path, made = inspected(tmp_path, teeth(), gauge=0.2)
    beside = lay_beside(file, [record(made, RIG, rng, cycles=cycles)], path=path)
    found = beside.alignment
    error_1, error_2 = errors(beside, RIG)
    assert all(found.numbered)
    # Seen less often, so less sure; four stated standard errors as above.
    assert abs(error_2) < 4.0 * found.std_driven / DEG < 10.0 * NEEDED
    assert abs(error_1) < 4.0 * found.std_driving / DEG


@pytest.mark.long
def test_a_slow_drift_does_not_move_the_zero(tmp_path: Path) -> None:
    rng = np.random.default_rng(9)
    file, path, made = inspected(tmp_path, teeth())
    beside = lay_beside(file, [record(made, RIG, rng, drift_um=8.0)], path=path)
    assert abs(errors(beside, RIG)[1]) < NEEDED


@pytest.mark.long
def test_an_undeclared_eccentricity_does_not_move_the_zero(tmp_path: Path) -> None:
    """12 um that the file does not know of, larger than all that it knows."""
    rng = np.random.default_rng(10)
    hidden = "[driving.eccentricity]\namplitude_um = 12.0\nangle_deg = 130.0"
    file, path, made = inspected(tmp_path, teeth(), hidden=hidden)
    beside = lay_beside(file, [record(made, RIG, rng)], path=path)
    found = beside.alignment
    assert found.numbering == "curves"
    error = errors(beside, RIG)[1]
    assert abs(error) < 4.0 * found.std_driven / DEG
    assert abs(error) < 2.0 * NEEDED
    # Its wave stays in the residual: rms of a sine.
    assert beside.aligned[0].rms / UM == pytest.approx(12.0 / math.sqrt(2.0), rel=0.05)  # second order and noise


@pytest.mark.long
@pytest.mark.parametrize("only", ["driven", "driving"])
def test_te_with_one_angle_is_enough(tmp_path: Path, only: str) -> None:
    rng = np.random.default_rng(11)
    file, path, made = inspected(tmp_path, teeth())
    beside = lay_beside(file, [record(made, RIG, rng, only=only)], path=path)
    zeros = beside.alignment.zeros
    assert beside.alignment.numbering == "curves"
    if only == "driven":
        assert zeros.driving is None
        assert abs(off_deg(zeros.driven, RIG.zero_2)) < NEEDED
    else:
        assert zeros.driven is None
        # A deg of the driving shaft is 0.72 of the driven one.
        assert abs(off_deg(zeros.driving, RIG.zero_1)) < NEEDED / 0.72


# Sets.


@pytest.mark.long
def test_a_set_of_three_torques_shares_its_zeros(tmp_path: Path) -> None:
    """Each recording begins at a turn of its own; mean TE tells which."""
    rng = np.random.default_rng(12)
    file, path, made = inspected(tmp_path, teeth(), bends=True, gauge=0.2)
    recordings = [record(made, RIG, rng, cycles=0.6, torque_nm=torque) for torque in (5.0, 60.0, 120.0)]
    beside = lay_beside(file, recordings, path=path)
    assert beside.alignment.numbering == "curves"
    assert np.max(np.abs(errors(beside, RIG))) < NEEDED
    # Same pair, same law: deflection is all in the simulation, and means compare across the set. What is left of a
    # mean is the gauge's 0.2 um over some thirty teeth, of both gears, pitch and slope.
    assert np.max(np.abs([one.mean for one in beside.aligned])) < 0.2 * UM
    assert max(one.rms for one in beside.aligned) < 1.0 * UM  # one place misjudged by a turn would leave 3 um


@pytest.mark.long
def test_drive_and_coast_share_their_zeros(tmp_path: Path) -> None:
    rng = np.random.default_rng(13)
    file, path, made = inspected(tmp_path, teeth())
    recordings = [record(made, RIG, rng, flank=flank) for flank in ("drive", "coast")]
    beside = lay_beside(file, recordings, path=path)
    assert np.max(np.abs(errors(beside, RIG))) < NEEDED
    # Lost motion is the pair's own, 2 * 60 um cos(20 deg), and no part of the residual.
    recorded = [float(np.mean(one.recorded)) / UM for one in beside.aligned]
    assert recorded[1] - recorded[0] == pytest.approx(120.0 * math.cos(math.radians(20.0)), rel=0.05)
    np.testing.assert_allclose([one.mean for one in beside.aligned], 0.0, atol=0.1 * UM)  # noise over the place's doubt
    assert max(one.rms for one in beside.aligned) < 1.2 * RIG.noise * UM  # coast teeth numbered wrongly leave microns


@pytest.mark.long
def test_rough_zeros_of_a_set_are_one_zero(tmp_path: Path) -> None:
    rng = np.random.default_rng(14)
    file, path, made = inspected(tmp_path, teeth())
    rough = [(RIG.zero_1 + 0.3 * HALF_1, RIG.zero_2), (RIG.zero_1 - 0.3 * HALF_1, None), (None, None)]
    recordings = [record(made, RIG, rng, cycles=0.5, stated=stated) for stated in rough]
    beside = lay_beside(file, recordings, path=path)
    assert np.max(np.abs(errors(beside, RIG))) < NEEDED
    assert max(one.rms for one in beside.aligned) < 1.2 * RIG.noise * UM


@pytest.mark.long
def test_zeros_more_than_half_a_tooth_apart_contradict_each_other(tmp_path: Path) -> None:
    rng = np.random.default_rng(15)
    file, path, made = inspected(tmp_path, teeth())
    near = [record(made, RIG, rng, cycles=0.1, stated=(None, zero)) for zero in (0.01, TURN - 0.01)]
    lay_beside(file, near, path=path)  # 1.1 deg apart, across the encoder's own zero
    far = [record(made, RIG, rng, cycles=0.1, stated=(None, zero)) for zero in (1.0, 1.0 + 1.1 * HALF_2)]
    with pytest.raises(InputFileError, match=r"driven_zero_deg.*half a tooth \(7\.200 deg\)"):
        lay_beside(file, far, path=path)


# Where nothing fixes the teeth.


@pytest.mark.long
def test_a_flat_curve_says_nothing_and_the_stated_zeros_stay(tmp_path: Path) -> None:
    rng = np.random.default_rng(16)
    _, _, made = inspected(tmp_path, teeth())
    path = flat_pair(tmp_path)
    rough = (RIG.zero_1 + 0.2 * HALF_1, RIG.zero_2 - 0.2 * HALF_2)
    for stated in (rough, (None, None)):
        beside = lay_beside(read_pair(path), [record(made, RIG, rng, stated=stated)], path=path)
        found = beside.alignment
        assert not found.phased
        assert found.numbering == ("open" if stated[0] is None else "stated")
        assert any("too flat" in remark for remark in beside.remarks)
        if stated[0] is not None:
            assert np.max(np.abs(errors(beside, RIG))) < 360.0 / 25 / 2  # half a tooth, as stated
            # Their difference is what mean TE gives; deviations that nobody inspected and backlash of 50 um move it.
            one, two = errors(beside, RIG)
            assert abs(two - 0.72 * one) < 0.3
            assert found.std / DEG > 1.0  # nothing better is claimed


def test_an_encoder_does_not_count_both_ways_in_one_set(tmp_path: Path) -> None:
    rng = np.random.default_rng(25)
    file, path, made = inspected(tmp_path, teeth())
    other = Rig(zero_1=RIG.zero_1, zero_2=RIG.zero_2, direction_2=-1)
    recordings = [record(made, rig, rng, cycles=0.1) for rig in (RIG, other)]
    with pytest.raises(InputFileError, match=r"driven_direction: -1, but 1 in .* compare one by one"):
        lay_beside(file, recordings, path=path)


@pytest.mark.slow
def test_stated_errors_cover_the_truth(tmp_path: Path) -> None:
    """40 pairs with 0.2 um of gauge noise and coloured noise of 0.5 um: the errors follow their stated sigma."""
    scores = []
    for seed in range(40):
        rng = np.random.default_rng(100 + seed)
        rig = Rig(zero_1=rng.uniform(0.0, TURN), zero_2=rng.uniform(0.0, TURN), noise=0.5, correlation=0.5)
        file, path, made = inspected(tmp_path, rng, gauge=0.2)
        beside = lay_beside(file, [record(made, rig, rng)], path=path)
        error_1, error_2 = errors(beside, rig)
        assert abs(error_2) < 0.3  # never another tooth, 14.4 deg off; half the samples tell up to 0.1 deg
        scores.append((error_1 * DEG / beside.alignment.std_driving, error_2 * DEG / beside.alignment.std_driven))
    z = np.array(scores)
    # Of 40 normal numbers at least 34 lie within two sigma with 99.8 %, and the rms lies within 0.7 and 1.35.
    assert np.all(np.count_nonzero(np.abs(z) < 2.0, axis=0) >= 34)
    rms = np.sqrt(np.mean(z**2, axis=0))
    assert np.all((rms > 0.7) & (rms < 1.35))


@pytest.mark.long
def test_both_angles_and_te_need_no_whole_turns(tmp_path: Path) -> None:
    """A rig that computed TE itself has its own zero of TE; two such recordings are laid one by one."""
    rng = np.random.default_rng(19)
    file, path, made = inspected(tmp_path, teeth())
    recordings: list[Recording] = [record(made, RIG, rng, cycles=0.5, only="driven") for _ in range(2)]
    beside = lay_beside(file, recordings, path=path)
    assert abs(off_deg(beside.alignment.zeros.driven, RIG.zero_2)) < NEEDED
    assert max(one.rms for one in beside.aligned) < 1.2 * RIG.noise * UM
