"""An inspection whose teeth are counted otherwise than they come into mesh is no missing physics."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from gearpoly.assemble import with_sheets_stated
from gearpoly.compare.compare import compare
from gearpoly.diagnose.begin import before_claims, begin
from gearpoly.diagnose.budget import Budget, Watch
from gearpoly.diagnose.diagnose import Diagnosis, diagnose
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.sheets import Reread, _read, placed_by_sheets, reread, sign_may_be_wrong
from gearpoly.diagnose.teeth_off_sheet import ReadAs, TeethOffSheet, order_of
from gearpoly.diagnose.unstated import between
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import read_pair
from gearpoly.gear.metrology import index_deviations
from gearpoly.keys.edit import on_gear
from gearpoly.recording.recording import Recording
from gearpoly.units import UM, FloatArray
from tests.pair_files import pair_file
from tests.physics_cases import Condition, recorded, rough

Z = 12, 16


def numbered(file: PairFile, order: list[int]) -> PairFile:
    """The file with the driving gear's sheet in another order of teeth."""
    sheet = file.driving.inspection
    assert sheet is not None
    listed = {name: getattr(sheet, name) for name in ("pitch_um", "profile_slope_um")}
    update = {name: tuple(values[k] for k in order) for name, values in listed.items()}
    return on_gear(file, 0, inspection=sheet.model_copy(update=update))


def found(known: PairFile, true: PairFile, folder: Path) -> Diagnosis:
    recordings = recorded(true, (Condition(torque_nm=0.0),), np.random.default_rng(2), cycles=3.0)
    return diagnose(known, recordings, path=folder / "pair.toml")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("order", "says"),
    [
        ([(k - 1) % Z[0] for k in range(Z[0])], "calls tooth 1 what is tooth 0"),
        pytest.param(
            [(3 - k) % Z[0] for k in range(Z[0])],
            "counts its teeth the other way round, and calls tooth 3",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_sheet_that_is_counted_otherwise_is_told_and_no_tooth_accused(
    order: list[int], says: str, tmp_path: Path
) -> None:
    """Teeth of 3 um rms, each told to 0.02 um by 48 passes in 0.3 um of noise: no other of 23 counts comes near. What
    is left of the cycle that was held out is its noise, 0.3 um, to the 5 % by which 960 samples have it (2.3 % one
    sigma) and what two cycles leave open of the teeth."""
    true = rough(Z, bends=False)
    diagnosis = found(numbered(true, order), true, tmp_path)
    assert not diagnosis.findings
    assert diagnosis.status == "unexplained"
    assert all(one.gear == "driving" for one in diagnosis.unexplained)
    assert any(says in remark for remark in diagnosis.remarks)
    assert diagnosis.after.unseen == pytest.approx(0.3 * UM, rel=0.05)
    sheet = diagnosis.fitted.driving.inspection
    truth = true.driving.inspection
    assert sheet is not None
    assert truth is not None
    # 0.3 um: what a tooth's mean and slope take from each other; the sheet in its order is off by 4 um.
    off = np.array(sheet.pitch_um) - np.array(truth.pitch_um)
    assert np.std(off) < 0.3


COUNTED = 13, 17
"""Teeth of the pair whose sheets are counted the other way round below."""


def rows(gear: int, *, single: bool, backward: bool) -> dict[str, list[float]]:
    """A sheet of one gear of that pair, teeth of 6 um rms: index deviations or single pitches, and slopes. ``backward``
    it is that of an inspector who counts the same teeth the other way round from the same tooth 0."""
    z = COUNTED[gear]
    rng = np.random.default_rng(31 + gear)
    index, slope = rng.normal(0.0, 6.0, z).round(2), rng.normal(0.0, 1.0, z).round(2)
    index[-1] -= np.sum(index)
    steps = (index - np.roll(index, 1)) / np.cos(np.radians(20.0)) * (1.0 if gear else -1.0)
    # The pitch between two teeth is as much too large whichever way they are counted; it is that of the later one.
    order, pitch_order = (-np.arange(z), 1 - np.arange(z)) if backward else (np.arange(z),) * 2
    pitch = {"single_pitch_um": steps[pitch_order % z]} if single else {"pitch_um": index[order % z]}
    return {key: values.round(4).tolist() for key, values in (pitch | {"profile_slope_um": slope[order % z]}).items()}


def written(folder: Path, *, backward: int | None, single: bool, in_csv: bool) -> PairFile:
    """That pair read from its files, the sheet of one gear ``backward``, in the pair file or ``in_csv``."""
    sheets = [rows(gear, single=single, backward=gear == backward) for gear in (0, 1)]
    text, table = "[model]\ntooth_deflection = false\n", [",".join(("gear", "tooth", *sheets[0]))]
    for name, z, sheet in zip(("driving", "driven"), COUNTED, sheets, strict=True):
        text += f"[{name}]\nteeth = {z}\nmodule_mm = 2.0\npoints_per_flank = 400\n[{name}.inspection]\n"
        keys = ['sheet_csv = "sheet.csv"'] if in_csv else [f"{key} = {values}" for key, values in sheet.items()]
        text += "uncertainty_um = 0.3\n" + "\n".join(keys) + "\n"
        table += [",".join((name, str(k), *map(str, row))) for k, row in enumerate(zip(*sheet.values(), strict=True))]
    (folder / "sheet.csv").write_text("\n".join(table) + "\n", encoding="utf-8")
    (folder / "pair.toml").write_text(text, encoding="utf-8")
    return with_sheets_stated(read_pair(folder / "pair.toml"), path=folder / "pair.toml")


@pytest.mark.parametrize(
    ("gear", "single", "in_csv"),
    [
        (0, False, True),
        (1, False, False),
        (0, True, False),
        (1, True, True),
    ],
)
@pytest.mark.slow
def test_a_sheet_counted_backward_from_tooth_0_is_taken_so(
    gear: int, single: bool, in_csv: bool, tmp_path: Path
) -> None:
    """Both zeros are stated and true, and the unloaded teeth 6 um rms apart: by a wrong sheet others of them touch, so
    one step of a linear fit tells them badly. Taken so, every pitch and slope is the true one, to 0.01 um of printing;
    the mate's sheet stays."""
    true = written(tmp_path, backward=None, single=False, in_csv=False)
    recordings = recorded(true, (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=3.0)
    known = written(tmp_path, backward=gear, single=single, in_csv=in_csv)
    budget, watch = Budget(), Watch(lambda _: None, lambda done, of: None)
    begun = begin(known, recordings, path=tmp_path / "pair.toml", method=Method(), budget=budget, watch=watch)
    (says,) = begun.misread
    name = ("driving", "driven")[gear]
    assert f"the inspection of the {name} gear fits only where it counts its teeth the other way round" in says
    assert "from tooth 0 of the pair on" in says
    assert ("single pitches counted the other way round" in says) is single
    for section, truth in ((begun.file.driving, true.driving), (begun.file.driven, true.driven)):
        assert section.inspection is not None
        assert truth.inspection is not None
        for key in ("pitch_um", "profile_slope_um"):
            off = np.array(getattr(section.inspection, key)) - np.array(getattr(truth.inspection, key))
            assert np.max(np.abs(off - np.mean(off))) < 0.01, (name, key)


@pytest.mark.slow
def test_two_teeth_out_of_their_place_stay_two_teeth(tmp_path: Path) -> None:
    true = rough(Z, bends=False)
    sheet = true.driving.inspection
    assert sheet is not None
    assert isinstance(sheet.pitch_um, tuple)
    off = tuple(one + {2: 6.0, 7: -5.0}.get(k, 0.0) for k, one in enumerate(sheet.pitch_um))
    there = on_gear(true, 0, inspection=sheet.model_copy(update={"pitch_um": off}))
    diagnosis = found(true, there, tmp_path)
    named = {(one.claim.physics.name, one.claim.place.gear, one.tooth) for one in diagnosis.findings}
    assert named == {("tooth_pitch", 0, 2), ("tooth_pitch", 0, 7)}


@pytest.mark.slow
def test_the_sheet_of_another_gear_names_nothing(tmp_path: Path) -> None:
    """Twelve steps of 4 um rms, none of them where the sheet has it: the sheet is left out, and told."""
    true = rough(Z, bends=False)
    sheet = true.driving.inspection
    assert sheet is not None
    others = tuple(np.random.default_rng(77).normal(0.0, 3.0, Z[0]).tolist())
    known = on_gear(true, 0, inspection=sheet.model_copy(update={"pitch_um": others}))
    diagnosis = found(known, true, tmp_path)
    assert not diagnosis.findings
    assert any("of the driving gear does not fit the gear that was recorded" in one for one in diagnosis.remarks)
    assert not any("of the driven gear does not fit" in one for one in diagnosis.remarks)


@pytest.mark.slow
def test_a_transmission_error_of_the_opposite_sign_is_told_and_put_right(tmp_path: Path) -> None:
    true = rough(Z, bends=False)
    recordings = recorded(true, (Condition(torque_nm=0.0),), np.random.default_rng(2), cycles=3.0)
    signed = [opposite_te(one) for one in recordings]
    diagnosis = diagnose(true, signed, path=tmp_path / "pair.toml")
    assert not diagnosis.findings
    assert diagnosis.status == "nothing_missing"
    assert any("only with the opposite sign" in one for one in diagnosis.remarks)
    assert diagnosis.after.unseen == pytest.approx(0.3 * UM, rel=0.05)  # as in the first test


def opposite_te(one: Recording) -> Recording:
    """The recording as a rig writes it that takes the transmission error with the other sign."""
    assert one.driving_angle_rad is not None
    assert one.driven_angle_rad is not None
    theta_1 = one.driving_direction * (one.driving_angle_rad - (one.driving_zero_rad or 0.0))
    te = one.driven_angle_rad - (one.driven_zero_rad or 0.0) - Z[0] / Z[1] * theta_1
    return replace(one, driving_angle_rad=None, driving_zero_rad=None, te_rad=-te)


def test_nothing_is_reread_where_no_sheet_lists_teeth() -> None:
    """Nobody inspected the gears, or all teeth have one value: no order of them matters."""
    for sheet in ({}, {"tooth_thickness_um": -40.0}):
        model = SimpleNamespace(
            declared=pair_file(Z, driving={"inspection": sheet}), budget=SimpleNamespace(over=False)
        )
        assert reread(cast(Any, model), [], lambda _: None) is None


def test_where_time_is_over_no_sheet_is_found_right() -> None:
    model = SimpleNamespace(declared=rough(Z), budget=SimpleNamespace(over=True))
    assert reread(cast(Any, model), [], lambda _: None) is None


@pytest.mark.parametrize(
    ("sheets", "wrong", "computed", "may_be"),
    [
        (2, (0, 1), True, True),
        (2, (0, 1), False, False),  # two encoders were read: the rig computed nothing
        (2, (0,), True, False),  # the mate's sheet fits as it is
        (2, (), True, False),
        (0, (), True, False),  # no sheet says what the sign is
    ],
)
def test_a_sign_is_doubted_where_every_sheet_contradicts_it(
    sheets: int, wrong: tuple[int, ...], computed: bool, may_be: bool
) -> None:
    file = rough(Z) if sheets else pair_file(Z)
    found = [Reread(gear=gear, inspection=None, opposite=False, says="") for gear in wrong]
    assert sign_may_be_wrong(file, [cast(Any, SimpleNamespace(computed=computed))], found) is may_be


def teeth(off: FloatArray, sheet: FloatArray, *, uncertainty: float = 0.5) -> TeethOffSheet:
    return TeethOffSheet(
        gear=0, off=off, covariance=np.zeros((off.size, off.size)), sheet=sheet, uncertainty=uncertainty,
        steps=between(off.size),
    )  # fmt: skip


def test_a_sheet_is_doubted_for_half_of_its_steps_only() -> None:
    """Its own uncertainty, an eccentric gear, or four wrong teeth of 24 say nothing against it; every tooth of another
    gear does, and so does a sheet of 3 um of whose steps nothing is on the gear."""
    rng = np.random.default_rng(3)
    sheet, error = rng.normal(0.0, 3.0, 24), rng.normal(0.0, 0.5, 24)
    once = 30.0 * np.cos(2.0 * np.pi / 24 * np.arange(24))
    four = np.where(np.arange(24) % 6 == 2, 15.0, 0.0)
    assert not teeth(error + once + four, sheet).contradicted
    assert teeth(rng.normal(0.0, 3.0, 24) - sheet, sheet).contradicted
    assert teeth(error - sheet, sheet).contradicted
    # A sheet that is worse than it says, and still tells of the teeth, stays.
    assert not teeth(3.0 * error, sheet).contradicted


@pytest.mark.long
def test_a_sheet_is_recognised_beside_waves_of_the_shaft() -> None:
    """A coupling adds orders 2, 3, 4 and 6 as large as the teeth's own steps: the sheet is still that of the gear. Of
    sheets of other gears 1 of 4 z is recognised by chance: 1 of 96, of 300 seven at most in 99 of 100 trials."""
    rng = np.random.default_rng(11)
    turn = 2.0 * np.pi / 24 * np.arange(24)
    waves = 3.2 * np.cos(2 * turn) + 1.5 * np.cos(3 * turn + 2.0) + 1.7 * np.cos(4 * turn) + 0.7 * np.cos(6 * turn)
    sheet = np.cumsum(rng.normal(0.0, 2.0, 24))
    assert not teeth(waves + rng.normal(0.0, 0.2, 24), sheet, uncertainty=0.2).contradicted
    other = [teeth(rng.normal(0.0, 3.0, 24) - one, one) for one in rng.normal(0.0, 3.0, (300, 24))]
    assert sum(one.recognised for one in other) <= 7
    # Of a sheet that is the gear's all is there, of another's that is alike by chance a part.
    apart = sheet - np.mean(sheet)
    for part, own in ((0.4, False), (0.6, True)):
        assert teeth((part - 1.0) * apart, apart).recognised is own
    # An empty sheet is like nothing.
    assert not teeth(waves, np.zeros(24)).recognised


def test_a_wave_with_its_second_says_nothing_against_a_sheet() -> None:
    """1.7 um of order 4 and 0.6 of order 8 on fine teeth, as lines of an encoder may look that fold so: half of the
    right sheets were thrown out as other gears'. Of those most are still doubted."""
    rng = np.random.default_rng(2)
    turn = 2.0 * np.pi / 18 * np.arange(18)
    kept = caught = 0
    for _ in range(40):
        sheet, other = (np.cumsum(one - np.mean(one)) for one in rng.normal(0.0, 1.0, (2, 18)))
        waves = 1.7 * np.cos(4 * turn + rng.uniform(0.0, 6.0)) + 0.6 * np.cos(8 * turn + rng.uniform(0.0, 6.0))
        kept += not teeth(waves + rng.normal(0.0, 0.15, 18), sheet, uncertainty=0.3).contradicted
        caught += teeth(other - sheet, sheet, uncertainty=0.3).contradicted
    assert kept == 40  # 21 without
    assert caught > 20  # two of three, as of 300


def test_single_pitches_that_are_stated_as_index_deviations_are_recognised() -> None:
    """Their running sum is on the gear, of either sign. As index deviations they are left out, and one list in twenty
    was recognised even so: the pitch waves that it lacks had been named. A right list is never read so."""
    rng = np.random.default_rng(5)
    for sign in (1.0, -1.0):
        for _ in range(20):
            single = rng.normal(0.0, 4.0, 25)
            index = index_deviations(single - np.mean(single), alpha=math.radians(20.0), which="driven")
            measured = rng.normal(0.0, 0.3, 25)
            wrong = replace(teeth(sign * index + measured - single, single, uncertainty=0.3), summed=index)
            assert wrong.contradicted
            assert wrong.elsewhere == ReadAs(single=True, sign=sign)
            assert replace(wrong, summed=None).elsewhere is None
            sums = index_deviations(index, alpha=math.radians(20.0), which="driven")
            assert not replace(teeth(measured, index, uncertainty=0.3), summed=sums).contradicted


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_single_pitches_of_both_flanks_leave_the_teeth_as_thick_as_they_are(sign: float) -> None:
    """A tooth that stands behind on its drive flank stands ahead on its coast flank: of teeth of one thickness both
    lists are the same, and what they mean adds up to E_s cos(alpha), exactly but for rounding."""
    single = np.random.default_rng(4).normal(0.0, 4.0, 16)
    single -= np.mean(single)
    listed = {"pitch_um": single.tolist(), "pitch_coast_um": single.tolist(), "tooth_thickness_um": -60.0}
    file = pair_file(Z, driven={"inspection": listed})
    read = _read(file, replace(teeth(single, single), gear=1), ReadAs(single=True, sign=sign))
    drive = sign * index_deviations(single, alpha=math.radians(20.0), which="driven")
    assert read.pitch_um == pytest.approx(drive, abs=1e-9)
    assert np.add(read.pitch_um, read.pitch_coast_um) == pytest.approx(-60.0 * math.cos(math.radians(20.0)), abs=1e-9)


@pytest.mark.slow
def test_a_list_of_single_pitches_is_told_and_no_wave_named(tmp_path: Path) -> None:
    """12 and 16 teeth with single pitches of 4 um in the list of index deviations of the driving gear."""
    rng = np.random.default_rng(8)
    single = rng.normal(0.0, 4.0, Z[0])
    single -= np.mean(single)
    index = index_deviations(single, alpha=math.radians(20.0), which="driving")
    listed = {"pitch_um": np.round(index, 3).tolist(), "uncertainty_um": 0.3}
    true = pair_file(Z, driving={"inspection": listed}, points=200)
    known = pair_file(Z, driving={"inspection": listed | {"pitch_um": np.round(single, 3).tolist()}}, points=200)
    verdict = found(known, true, tmp_path)
    assert not verdict.findings
    assert any("pitch_um of the driving gear fits only as single pitches f_p" in one for one in verdict.remarks)


def test_what_classes_of_teeth_have_in_common_is_no_step() -> None:
    """Of 26 on 46 teeth even ones meet even ones for ever: how far odd ones stand off tells nothing."""
    odd = 5.0 * (np.arange(26) % 2)
    assert np.max(np.abs(between(26, common=2) @ odd)) < 1e-12
    assert np.max(np.abs(between(26) @ odd)) > 4.0


@pytest.mark.parametrize("back", [False, True])
def test_an_order_is_its_own_inverse_or_goes_back(back: bool) -> None:
    order = order_of(7, 3, back=back)
    assert order[0] == 3
    assert sorted(order) == list(range(7))
    assert (order[1] - order[0]) % 7 == (6 if back else 1)


@pytest.mark.parametrize("pitches", [3, 8, 20])
def test_a_sheet_is_recognised_where_all_teeth_stand_further_on(pitches: int) -> None:
    """Eight teeth in a row stand 10 um off, and have put the teeth at a wrong place: 23 of 25 steps are those of the
    sheet there, and at no other place."""
    rng = np.random.default_rng(pitches)
    sheet, repaired = np.cumsum(rng.normal(0.0, 2.0, 25)), np.where(np.abs(np.arange(25) - 13.5) < 4.0, 10.0, 0.0)
    there = np.roll(sheet + repaired + rng.normal(0.0, 0.4, 25), pitches)
    told = teeth(there - sheet, sheet, uncertainty=0.3)
    assert told.contradicted
    assert [n for n in range(25) if told.recognised_after(n) > 0.0] == [pitches]


@pytest.mark.long
def test_teeth_are_placed_where_their_sheets_are_recognised(tmp_path: Path) -> None:
    """All stand five teeth further on than they are, which is one of the places left open: they are moved back."""
    true = rough(Z, bends=False)
    recordings = recorded(true, (Condition(torque_nm=0.0),), np.random.default_rng(2), cycles=2.0)
    comparison = compare(true, recordings, path=tmp_path / "pair.toml")
    model, waves = before_claims(
        true, comparison, path=tmp_path / "pair.toml", method=Method(), budget=Budget(seconds=math.inf)
    )
    tau = model.scope.gears[1].tau
    off = replace(model.moved(5 * tau), elsewhere=(3 * tau, 5 * tau))
    there = placed_by_sheets(off, waves, lambda _: None)
    assert there is not None
    assert there.offset == pytest.approx(model.offset, abs=1e-12)
    assert placed_by_sheets(replace(off, elsewhere=(3 * tau, 7 * tau)), waves, lambda _: None) is None
