"""A ratio of travels that is off: which reading is wrong and by how much, or that it is another pair."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.assemble import Assembled
from gearpoly.compare import ratio as ratio_module
from gearpoly.compare.compare import compare
from gearpoly.compare.ratio import other_teeth
from gearpoly.compare.scale import Scale, counts_for, put_right
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.errors import InputFileError
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import dump_pair, read_pair
from gearpoly.physics.parts import EncoderErrors
from gearpoly.recording.recording import Recording
from gearpoly.recording.runs import runs_of
from gearpoly.report.compare_report import json_text
from gearpoly.report.diagnosis_report import json_text as verdict_text
from gearpoly.units import UM
from tests.made_recordings import RIG, inspected, record
from tests.made_runs import motion, recorded

TRUE = EncoderErrors(), EncoderErrors()
TURN = 2.0 * math.pi
LEFT = 0.35 * UM
"""mm. 0.3 um of noise and what its sample leaves."""


@dataclass(frozen=True, kw_only=True)
class Rig:
    """A pair of 12 on 16 teeth, its file, and two hunting cycles of it (8 driving turns)."""

    file: PairFile
    path: Path
    made: Assembled
    recording: Recording


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    rng = np.random.default_rng(3)
    file, path, made = inspected(tmp_path_factory.mktemp("pair"), rng, z_1=12, z_2=16)
    return Rig(file=file, path=path, made=made, recording=record(made, RIG, rng, cycles=4.0))


def scaled(recording: Recording, shaft: str, scale: float) -> Recording:
    """The same by an encoder on one shaft that reads ``scale`` times its turns."""
    angle = recording.driving_angle_rad if shaft == "driving" else recording.driven_angle_rad
    assert angle is not None
    return replace(recording, **{f"{shaft}_angle_rad": angle * scale})


def found(rig: Rig, *recordings: Recording) -> Scale:
    _, scale = put_right(recordings, rig.made.pair, TRUE)
    assert scale is not None
    return scale


@pytest.mark.parametrize("shaft", ["driving", "driven"])
@pytest.mark.parametrize("scale", [1000.0 / 1024.0, 1.024, 1.2, 1.5, 0.5, 4.0])
def test_a_wrong_count_comes_back_whatever_its_size(rig: Rig, shaft: str, scale: float) -> None:
    """By the orders of both gears alone: the other shaft's scale and other pairs make the same travels."""
    one = found(rig, scaled(rig.recording, shaft, scale))
    assert one.shaft == shaft
    # First orders and noise of 0.3 um leave a slope of 1e-7 over 32 turns.
    assert one.value == pytest.approx(scale, rel=1e-5)
    assert abs(one.value - scale) < 5.0 * one.std + 1e-7


@pytest.mark.long
@pytest.mark.parametrize("shaft", ["driving", "driven"])
def test_comparing_goes_on_with_the_scale_taken_out(rig: Rig, shaft: str) -> None:
    comparison = compare(rig.file, [scaled(rig.recording, shaft, 1000.0 / 1024.0)], path=rig.path)
    assert comparison.located.residual_rms < LEFT
    assert comparison.located.where == ()
    assert comparison.alignment.phased
    held = json.loads(json_text(comparison))
    assert held["reading_scale"]["gear"] == shaft
    assert held["reading_scale"]["ratio"] == pytest.approx(1000.0 / 1024.0, rel=1e-5)
    assert held["recordings"][0]["ratio_off"] is None
    (said,) = [remark for remark in held["remarks"] if "orders at which the teeth show" in remark]
    assert f"the {shaft} shaft reads 0.97656" in said
    assert "as 1000 counts per turn taken for 1024 make" in said and "or a coupling slips" in said


@pytest.mark.long
def test_wrapped_readings_with_gaps_are_put_right_too(rig: Rig) -> None:
    """Encoders that begin again each turn of what they count, five turns of them missing."""
    one = scaled(rig.recording, "driving", 1.024)
    assert one.driving_angle_rad is not None and one.driven_angle_rad is not None
    first, second = np.mod(one.driving_angle_rad, TURN), np.mod(one.driven_angle_rad, TURN)
    first[1000:1600] = math.nan
    one = replace(one, driving_angle_rad=first, driven_angle_rad=second)
    assert found(rig, one).value == pytest.approx(1.024, rel=1e-5)
    assert compare(rig.file, [one], path=rig.path).located.residual_rms < LEFT


@pytest.mark.parametrize("teeth", [(13, 17), (17, 23), (18, 26), (11, 15)])
def test_another_pairs_orders_are_no_wrong_count(rig: Rig, teeth: tuple[int, int], tmp_path: Path) -> None:
    """Ratios 2 % off (13/17), 1.4 % below (17/23), 8 % and 2 % off: its teeth show at whole orders of both readings."""
    rng = np.random.default_rng(8)
    _, _, other = inspected(tmp_path, rng, z_1=teeth[0], z_2=teeth[1])
    given = record(other, RIG, rng, cycles=1.0)
    with pytest.raises(InputFileError, match="want a recording of this pair: the orders at which teeth show") as caught:
        put_right([given], rig.made.pair, TRUE)
    least = (teeth[0] // math.gcd(*teeth), teeth[1] // math.gcd(*teeth))
    assert f"{least[0]} on {least[1]} teeth" in caught.value.wish
    with pytest.raises(InputFileError, match="want a recording of this pair"):
        compare(rig.file, [given], path=rig.path)


def bare(scale: float, seed: int) -> Recording:
    """Travels of 12 on 16 teeth and white noise: gears of which nothing shows."""
    rng = np.random.default_rng(seed)
    theta_1 = np.cumsum(rng.uniform(0.5, 1.5, 12_000)) * (TURN * 30.0 / 12_000)
    te = rng.normal(0.0, 1e-5, theta_1.size)
    return Recording(source=Path("bare.csv"), driving_angle_rad=theta_1 * scale, driven_angle_rad=0.75 * theta_1 + te)


@pytest.mark.long
def test_where_no_teeth_show_nothing_is_named(rig: Rig) -> None:
    """Noise alone decides for nobody: below 3 % the recording is left as it is, above it is not this pair, with what
    would explain it."""
    for seed in range(20):
        one = bare(1.02, seed)
        (kept,), scale = put_right([one], rig.made.pair, TRUE)
        assert scale is None and kept is one
    with pytest.raises(InputFileError) as caught:
        put_right([bare(1.25, 1)], rig.made.pair, TRUE)
    assert "a ratio of 0.6" in caught.value.found and "-20.000% off" in caught.value.found
    assert "the driving shaft reads 1.25 times its turns" in caught.value.wish
    assert "the driven shaft reads 0.8 times its turns" in caught.value.wish
    # Of 12 on 16 teeth 12 on 20 is the nearest such pair; 6 on 10 was named before it.
    assert "the teeth are 12/20 or 9/15 or 15/25" in caught.value.wish


def test_teeth_that_were_skipped_are_no_scale(rig: Rig) -> None:
    """One pitch at one moment, or at four, makes the travels miss the ratio too: no encoder is blamed, and no pair."""
    assert rig.recording.driven_angle_rad is not None
    for moments in ([0.3], [0.5], [0.7], [0.1, 0.4, 0.6, 0.9]):
        driven = rig.recording.driven_angle_rad.copy()
        for part in moments:
            driven[int(part * driven.size) :] += TURN / 16.0
        one = replace(rig.recording, driven_angle_rad=driven)
        (kept,), scale = put_right([one], rig.made.pair, TRUE)
        assert scale is None and kept is one


@pytest.mark.parametrize("step_deg", [0.1, 1e-6])
def test_lines_of_rounding_tell_nothing(rig: Rig, step_deg: float) -> None:
    """Even samples of 1.1 deg: their rounding makes waves at whole orders of either shaft."""
    driving = 1.1 * np.arange(8000.0) + 0.013
    first, second = (np.radians(np.round(a / step_deg) * step_deg) for a in (driving, 0.75 * 1.02 * driving))
    one = Recording(source=Path("even.csv"), driving_angle_rad=first, driven_angle_rad=second)
    assert put_right([one], rig.made.pair, TRUE)[1] is None


def test_travels_that_fit_are_not_asked(rig: Rig) -> None:
    (kept,), scale = put_right([rig.recording], rig.made.pair, TRUE)
    assert scale is None and kept is rig.recording


def test_without_the_orders_of_shafts_nothing_is_decided(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted fault: lines are looked for where noise is."""
    monkeypatch.setattr(ratio_module.OrderPower, "evidence", lambda *_: 0.0)
    assert put_right([scaled(rig.recording, "driving", 1.02)], rig.made.pair, TRUE)[1] is None


@pytest.mark.slow
def test_recordings_of_a_set_share_one_count_and_no_zero(rig: Rig) -> None:
    """A turn of such a reading is none of the shaft, so means of recordings that begin apart do not compare; those of
    runs of one file do."""
    rng = np.random.default_rng(5)
    two = [scaled(record(rig.made, RIG, rng, cycles=4.0), "driven", 1.024) for _ in range(2)]
    comparison = compare(rig.file, two, path=rig.path)
    assert comparison.scale is not None and comparison.scale.by_recording == ()
    assert comparison.located.residual_rms < LEFT
    assert comparison.located.where == ()
    runs = runs_of(scaled(recorded(rig.made, motion((9.0, -9.0)), rng, wrapped=False), "driving", 1.024))
    comparison = compare(rig.file, runs, path=rig.path)
    assert [one.cleaned.recording.computed for one in comparison.aligned] == [False, False]
    assert comparison.located.where == ()


@pytest.mark.long
def test_a_coupling_that_slips_reads_each_time_otherwise(rig: Rig) -> None:
    rng = np.random.default_rng(6)
    slips = [scaled(record(rig.made, RIG, rng, cycles=4.0), "driving", s) for s in (1.010, 1.013)]
    one = found(rig, *slips)
    assert one.by_recording == pytest.approx((1.010, 1.013), rel=1e-5)
    assert "slips, by another part in each recording" in one.says
    assert compare(rig.file, slips, path=rig.path).located.residual_rms < LEFT


@pytest.mark.long
def test_the_diagnosis_names_it_and_writes_it_into_the_fitted_file(rig: Rig, tmp_path: Path) -> None:
    wrong = scaled(rig.recording, "driven", 1000.0 / 1024.0)
    diagnosis = diagnose(rig.file, [wrong], path=rig.path)
    verdict = json.loads(verdict_text(diagnosis))
    assert verdict["status"] == "explained"
    (one,) = verdict["missing"]
    assert (one["physics"], one["gear"]) == ("encoder_scale", "driven")
    assert one["parameters"]["ratio"]["value"] == pytest.approx(1000.0 / 1024.0, rel=1e-5)
    assert one["probability"] > 0.99
    assert one["heldout_rms_um"]["without"] > 1000.0 > 0.35 > one["heldout_rms_um"]["with"]
    fitted = tmp_path / "fitted.toml"
    fitted.write_text(dump_pair(diagnosis.fitted), encoding="utf-8")
    again = compare(read_pair(fitted), [wrong, replace(wrong, source=Path("b.csv"), torque_nm=1.0)], path=fitted)
    assert again.scale is None
    assert again.located.residual_rms < LEFT


@pytest.mark.parametrize(
    ("scale", "counts"),
    [(1.024, (1024, 1000)), (1000.0 / 1024.0, (1000, 1024)), (2.5, (2500, 1000)), (1.0123, None)],
)
def test_counts_that_are_sold_explain_a_scale(scale: float, counts: tuple[int, int] | None) -> None:
    assert counts_for(scale, 1e-7) == counts


def test_other_teeth_of_a_ratio() -> None:
    assert other_teeth(0.703125, 1e-6)[:2] == [(45, 64), (90, 128)]
    assert (18, 25) in other_teeth(0.72, 1e-6)
    assert other_teeth(math.pi / 3.0, 1e-8) == []


def test_swapped_columns_are_told_as_such(rig: Rig) -> None:
    """The travels have 16/12 for 12/16; no pair of teeth is suggested for what a line of the header mends."""
    one = rig.recording
    swapped = replace(
        one,
        driving_angle_rad=one.driven_angle_rad,
        driven_angle_rad=one.driving_angle_rad,
        driving_direction=one.driven_direction,
        driven_direction=one.driving_direction,
        driving_zero_rad=None,
        driven_zero_rad=None,
    )
    with pytest.raises(InputFileError) as caught:
        compare(rig.file, [swapped], path=rig.path)
    assert "which is its inverse" in str(caught.value)
    assert "exchange driving_angle_deg and driven_angle_deg" in str(caught.value)
