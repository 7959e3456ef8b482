"""What a grade or an inspection leaves open is no fault; what it cannot hold is one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearpoly.keys.edit import on_gear
from tests.knowledge.rigs import COAST, UNLOADED, bending, graded, hidden, inspected, listed, record, sheet
from tests.knowledge.verdicts import Cause, verdict
from tests.physics_cases import Condition

pytestmark = pytest.mark.slow


def test_a_form_within_the_grade_is_no_fault() -> None:
    """All driving teeth crowned by 1.5 um, under load: grade 6 allows forms of some 9 um, and inspects none of it."""
    true, known = graded((12, 16), bends=True)
    true = sheet(true, 0, profile_crowning_um=1.5)
    found = verdict(known, record(true, Condition(torque_nm=20.0), Condition(torque_nm=60.0), cycles=2.0))
    assert not found.missing, found.told


def test_pitches_within_the_grade_are_no_fault() -> None:
    """A chain of single pitches wanders: its low orders are the largest, and the gear is as it was built."""
    true, known = graded()
    found = verdict(known, record(true, UNLOADED))
    assert not found.missing, found.told


def test_a_relief_is_ground_on_purpose_however_small() -> None:
    """3 um on gears whose grade allows forms three times as large: no tooth of a grade is relieved by chance at its tip
    alone."""
    true, known = graded((12, 16), bends=True)
    true = hidden(true, "tip_relief", (3.0, 0.6), gear=0, form="linear")
    found = verdict(known, record(true, Condition(torque_nm=20.0), Condition(torque_nm=60.0), cycles=2.0))
    relief = Cause(physics="tip_relief", gear="driving")
    assert found.misnamed(relief) == [], found.told
    assert found.size(relief, "amount_um") == pytest.approx(3.0, rel=0.2)  # its stated error is 6 %


def test_a_tooth_beyond_the_grade_is_told() -> None:
    """15 um behind, where grade 6 allows 8 um from tooth to tooth, once per turn: it is named, or located at that tooth
    as what it likeliest is."""
    true, known = graded()
    pitch = listed(true, 0, "pitch_um")
    pitch[3] -= 15.0
    found = verdict(known, record(sheet(true, 0, pitch_um=tuple(pitch.tolist())), UNLOADED))
    tooth = Cause(physics="tooth_pitch", gear="driving", tooth=3)
    assert found.misnamed(tooth) == [], found.told
    places = [(one.get("gear"), one.get("tooth")) for one in found.json["unexplained"]]
    assert found.named(tooth) is not None or places == [("driving", 3)], found.told


def test_coast_flanks_that_nobody_measured_scatter() -> None:
    """Sheets state the drive flank; the coast flank follows of it and of the thickness but for 2 um, tooth by tooth.
    That is no tooth's fault."""
    known = inspected()
    follows = -listed(known, 0, "pitch_um") - 60.0 * math.cos(math.radians(20.0))
    coast = follows + np.random.default_rng(3).normal(0.0, 2.0, follows.size)
    true = sheet(known, 0, pitch_coast_um=tuple(coast.tolist()))
    found = verdict(known, record(true, UNLOADED, COAST))
    assert not found.missing, found.told


@pytest.mark.parametrize("back", [False, True])
def test_a_sheet_that_is_counted_otherwise_accuses_no_tooth(back: bool) -> None:
    """Counted from another tooth, or the other way round: every tooth is off by a step of its own, none is wrong."""
    true = inspected()
    order = [(3 - k if back else k - 1) % 8 for k in range(8)]
    keys = {key: tuple(listed(true, 0, key)[order].tolist()) for key in ("pitch_um", "profile_slope_um")}
    found = verdict(sheet(true, 0, **keys), record(true, UNLOADED))
    assert not found.missing, found.told
    assert not any(one.get("gear") == "driven" for one in found.json["unexplained"]), found.told


def test_two_teeth_out_of_their_place_are_two_teeth() -> None:
    """No other count of the sheet looks like that."""
    known = inspected()
    pitch = listed(known, 0, "pitch_um")
    pitch[2] += 6.0
    pitch[6] -= 5.0
    found = verdict(known, record(sheet(known, 0, pitch_um=tuple(pitch.tolist())), UNLOADED))
    two = [Cause(physics="tooth_pitch", gear="driving", tooth=tooth) for tooth in (2, 6)]
    assert found.misnamed(*two) == [], found.told
    # A tooth's place and lean take from each other what 33 passes leave open: 0.3 um, and three of these.
    for cause, size in zip(two, (6.0, -5.0), strict=True):
        assert found.size(cause, "deviation_um") == pytest.approx(size, abs=0.9)


def test_gears_of_another_pair_get_no_names() -> None:
    """Every tooth differs from its sheet, so each of some faults explains a little; none of them is what is wrong."""
    true, _ = graded(seed=11, pitch_um=3.0, slope_um=1.0)
    found = verdict(inspected(), record(true, UNLOADED, cycles=1.0))
    assert not found.missing, found.told
    assert found.json["unexplained"]


def test_a_gear_that_is_declared_eccentric_may_be_so_otherwise() -> None:
    """What is missing of an eccentricity is one: declared by 6 um where it runs 10 um off its axis."""
    known = hidden(bending((8, 11)), "eccentricity", (6.0, 0.0), gear=0)
    true = hidden(bending((8, 11)), "eccentricity", (10.0, 0.0), gear=0)
    found = verdict(known, record(true, UNLOADED, COAST))
    off = Cause(physics="eccentricity", gear="driving")
    assert found.misnamed(off) == [], found.told
    assert found.size(off, "amplitude_um") == pytest.approx(4.0, abs=0.3)  # both flanks tell it to 0.06 um


@pytest.mark.parametrize("off_um", [0.0, 105.0])
def test_coarse_gears_of_no_stated_grade_have_no_fault(off_um: float) -> None:
    """Pitches and slopes of printed gears, of which nothing is stated: what their teeth may have is no fault of one.
    A tooth that stands 105 um ahead, nine times as far as the others scatter, is; at 90 um it is 0.94 sure, by
    Student's density of so few teeth, and has no name."""
    true, known = graded((12, 17), pitch_um=12.0, slope_um=6.0, seed=3)
    for gear in (0, 1):
        known = on_gear(known, gear, grade=None, limits=None)
    if off_um:
        true = hidden(true, "tooth_pitch", (off_um,), gear=1, tooth=5)
    found = verdict(known, record(true, UNLOADED, cycles=3.0, noise_um=1.0))
    assert [(one["physics"], one["gear"]) for one in found.missing] == ([("tooth_pitch", "driven")] if off_um else [])
