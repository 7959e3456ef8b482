"""Teeth that bend, and what makers grind off them for it: at its design torque the one hides the other."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.files.models import PairFile
from tests.knowledge.rigs import bending, hidden, record, sheet
from tests.knowledge.verdicts import Cause, verdict
from tests.pair_files import pair_file
from tests.physics_cases import Condition

pytestmark = pytest.mark.slow

RELIEFS = (9.0, 1.0), (9.0, 1.0)
"""um over mm from the tip, of both gears: at 90 N m they leave the least ripple."""


def designed(*, true: bool) -> PairFile:
    """A pair of 19 and 24 teeth as it is, or as it is declared: rigid, and without reliefs."""
    rng = np.random.default_rng(11)
    gears = []
    for z, (amount, length) in zip((19, 24), RELIEFS, strict=True):
        pitch = rng.normal(0.0, 2.0, z)
        keys: dict[str, object] = {
            "inspection": {
                "pitch_um": (pitch - pitch.mean()).round(3).tolist(),
                "profile_slope_um": rng.normal(0.0, 0.5, z).round(3).tolist(),
            }
        }
        if true:
            keys["tip_relief"] = {"amount_um": amount, "length_mm": length}
        gears.append(keys)
    return pair_file((19, 24), driving=gears[0], driven=gears[1], model={"tooth_deflection": true}, points=400)


def test_reliefs_that_cancel_bending_at_their_torque_are_told_with_it() -> None:
    """Each alone makes the other torques worse, so claims one by one end with wind-up, crowning and pits."""
    loads = tuple(Condition(torque_nm=one) for one in (2.0, 90.0))
    made = record(designed(true=True), *loads, seed=12, cycles=1.0, per_mesh=12, noise_um=0.5)
    found = verdict(designed(true=False), made)
    bends = Cause(physics="tooth_deflection")
    reliefs = [Cause(physics="tip_relief", gear=gear) for gear in ("driving", "driven")]
    assert found.misnamed(bends, *reliefs) == [], found.told
    assert found.named(bends) is not None, found.told
    # Of the two of one pair each may take some of the other: a fifth, at the stated errors of a tenth.
    for cause in reliefs:
        assert found.size(cause, "amount_um") == pytest.approx(9.0, rel=0.2)


def test_a_relief_is_no_other_law_of_compliance() -> None:
    """A law bends teeth otherwise near their tips, as a relief does; but in proportion to the torque."""
    known = bending()
    true = hidden(known, "tip_relief", (8.0, 0.6), gear=0, form="linear")
    found = verdict(known, record(true, Condition(torque_nm=2.0), Condition(torque_nm=20.0), cycles=2.0))
    relief = Cause(physics="tip_relief", gear="driving")
    assert found.misnamed(relief) == [], found.told
    assert found.size(relief, "amount_um") == pytest.approx(8.0, abs=1.2)  # three stated errors
    assert found.size(relief, "length_mm") == pytest.approx(0.6, abs=0.12)


def test_a_gap_across_the_face_is_no_softness() -> None:
    """25 um close under load: soft at 2 N m, stiff at 60 N m, where teeth are as soft all along."""
    known = bending()
    true = known.model_copy(update={"pair": known.pair.model_copy(update={"misalignment_um": 25.0})})
    loads = tuple(Condition(torque_nm=one) for one in (2.0, 20.0, 60.0))
    found = verdict(known, record(true, *loads, cycles=1.0))
    gap = Cause(physics="misalignment")
    assert found.misnamed(gap) == [], found.told
    assert found.size(gap, "lead_um") == pytest.approx(25.0, abs=4.0)  # three stated errors


def test_a_crowning_that_another_torque_contradicts_has_no_name() -> None:
    """1.5 um under 20 N m and hollow by 0.3 um without load: no gear changes its form with the torque."""
    known = bending()
    made = [
        record(sheet(known, 0, profile_crowning_um=crowning), Condition(torque_nm=torque), seed=11, cycles=1.0)[0]
        for crowning, torque in ((1.5, 20.0), (-0.3, 0.0))
    ]
    found = verdict(known, made)
    crowned = [Cause(physics="profile_crowning", gear=gear) for gear in ("driving", "driven")]
    assert all(found.named(one) is None for one in crowned), found.told
