"""Forth and back in one file: runs with their flanks, and the lost motion between them."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.assemble import Assembled
from gearpoly.compare.compare import compare
from gearpoly.compare.lost_motion import lost_motions
from gearpoly.diagnose.prepare import means_compare
from gearpoly.errors import InputFileError
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import dump_pair, read_pair
from gearpoly.mesh.transmission import both_flanks
from gearpoly.recording.clean import clean
from gearpoly.recording.clean_set import clean_set
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.recording.reversals import backward_limit, reversals
from gearpoly.recording.runs import lost_motions as between_runs
from gearpoly.recording.runs import runs_of, usable
from gearpoly.units import ARCMIN, DEG, UM, FloatArray
from tests.at_hand import SHIPPED
from tests.made_command import Command
from tests.made_recordings import inspected
from tests.made_runs import TURN, motion, recorded
from tests.recording_files import write_csv

RATIO = 12.0 / 16.0


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A small pair: 12 on 16 teeth of module 2, its file and the truth."""

    file: PairFile
    path: Path
    made: Assembled


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Pair:
    folder = tmp_path_factory.mktemp("pair")
    file, path, made = inspected(folder, np.random.default_rng(1), z_1=12, z_2=16)
    return Pair(file=file, path=path, made=made)


def rng() -> np.random.Generator:
    return np.random.default_rng(7)


@pytest.mark.long
def test_each_run_is_a_recording_with_its_sense_and_its_flank(pair: Pair) -> None:
    one = recorded(pair.made, motion((6.0, -6.0, 4.0, -4.0)), rng())
    runs = runs_of(one)
    assert [run.source.name for run in runs] == [f"test.csv#{k}" for k in (1, 2, 3, 4)]
    assert [run.backward for run in runs] == [False, True, False, True]
    assert [run.flank for run in runs] == ["drive", "coast", "drive", "coast"]
    for run, turns in zip(runs, (6.0, 6.0, 4.0, 4.0), strict=True):
        assert run.run is not None
        # Half a degree at either end is where the lost motion is taken up.
        assert run.run.turns == pytest.approx(turns / RATIO, abs=0.06)
        first, last = run.run.rows
        assert run.size == last - first + 1
        assert run.time_s is not None and one.time_s is not None
        assert np.array_equal(run.time_s, one.time_s[first - 1 : last])


def test_what_turns_one_way_is_left_alone(pair: Pair) -> None:
    one = recorded(pair.made, motion((5.0, 3.0)), rng())
    assert runs_of(one) == (one,)


def test_a_load_that_hangs_on_one_flank_carries_on_it_both_ways(pair: Pair) -> None:
    runs = runs_of(recorded(pair.made, motion((6.0, -6.0)), rng(), hangs=True))
    assert [run.flank for run in runs] == ["drive", "drive"]
    assert any("one flank carries both ways" in said for said in runs[0].remarks)


def test_a_driven_gear_that_drives_carries_forward_on_its_coast_flanks(pair: Pair) -> None:
    """Flanks follow from which way the lost motion lies: here time runs the other way round."""
    one = recorded(pair.made, motion((6.0, -6.0)), rng(), wrapped=False)
    assert one.driving_angle_rad is not None and one.driven_angle_rad is not None
    film = replace(one, driving_angle_rad=one.driving_angle_rad[::-1], driven_angle_rad=one.driven_angle_rad[::-1])
    assert [(run.backward, run.flank) for run in runs_of(film)] == [(False, "coast"), (True, "drive")]


def test_a_torque_that_changes_its_sign_tells_the_flank(pair: Pair) -> None:
    turned = motion((6.0, -6.0))
    one = recorded(pair.made, turned, rng(), hangs=True)
    signed = replace(one, torque_samples_nm=5.0 * turned.way)
    runs = runs_of(signed)
    assert [run.flank for run in runs] == ["drive", "coast"]
    for run in runs:
        assert run.torque_samples_nm is not None and float(np.median(run.torque_samples_nm)) == 5.0
    with pytest.raises(InputFileError, match="column torque_nm"):
        runs_of(replace(one, torque_samples_nm=np.full(one.size, -5.0)))


@pytest.mark.parametrize("noise_deg", [0.02, 0.1, 0.5])
def test_noise_is_no_reversal(noise_deg: float) -> None:
    """A shaft that creeps on under noise comes back by up to ten standard deviations, and never turns round."""
    draw = np.random.default_rng(3)
    slow = np.linspace(0.0, 40.0 * DEG, 20_000) + noise_deg * DEG * draw.standard_normal(20_000)
    assert reversals(slow) == []
    # And a real reversal of 20 deg beneath it is one.
    back = np.concatenate((slow, slow[-1] + np.linspace(0.0, -20.0 * DEG, 10_000)))
    back[20_000:] += noise_deg * DEG * draw.standard_normal(10_000)
    (found,) = reversals(back)
    assert abs(found - 20_000) < 100 + 20_000 * 10.0 * noise_deg / 40.0


def test_a_coarse_encoder_that_trembles_between_two_counts_turns_nowhere() -> None:
    """Counts of 1 deg: twice what is taken for jitter."""
    angle = np.linspace(0.0, 30.0 * DEG, 5000) + 0.2 * DEG * np.random.default_rng(1).standard_normal(5000)
    coarse = np.round(angle / DEG) * DEG
    assert backward_limit(coarse) > 1.0 * DEG
    assert reversals(coarse) == []


@pytest.mark.long
def test_noise_of_the_angle_does_not_cut_a_recording(pair: Pair) -> None:
    """0.15 deg rms on the driving encoder at 1.6 deg from sample to sample, and in every stop."""
    one = recorded(pair.made, motion((6.0, -6.0), stop=2.0), rng(), wrapped=False)
    assert one.driving_angle_rad is not None
    noisy = one.driving_angle_rad + 0.15 * DEG * np.random.default_rng(2).standard_normal(one.size)
    assert [run.backward for run in runs_of(replace(one, driving_angle_rad=noisy))] == [False, True]


def test_the_lost_motion_between_runs_is_the_backlash(pair: Pair) -> None:
    """Without any pair file, from the driving shaft alone: j_bn / r_b1, to the noise of the means."""
    runs = runs_of(recorded(pair.made, motion((6.0, -6.0)), rng()))
    ((forth, back, one),) = between_runs(runs)
    mesh = pair.made.pair
    known = both_flanks(mesh, np.linspace(0.0, mesh.cycle, 400, endpoint=False), fast=True).j_bn / mesh.r_b1
    assert (forth, back) == (0, 1)
    # 0.2 um of noise in some 380 cells of three samples, and whole cells at ends of a broken number of turns.
    assert one.mean == pytest.approx(float(np.mean(known)), abs=0.1 * UM / mesh.r_b1)
    assert float(np.min(known)) - 0.5 * UM / mesh.r_b1 < np.min(one.by) < np.max(one.by)
    assert np.max(one.by) < float(np.max(known)) + 0.5 * UM / mesh.r_b1
    assert f"{one.mean / ARCMIN:.3g} arcmin of the driving shaft" in one.says


@pytest.mark.long
def test_compare_tells_the_lost_motion_beside_the_simulated(pair: Pair) -> None:
    """The curve over the driven turn to a part of a um, where the simulation is the truth."""
    one = recorded(pair.made, motion((6.0, -6.0)), rng())
    (lost,) = lost_motions(compare(pair.file, runs_of(one), path=pair.path))
    exact = both_flanks(pair.made.pair, lost.place).j_bn
    assert lost.recordings == ((0,), (1,))
    # Noise leaves 0.01 um of the mean, straight lines between cells the rest.
    assert abs(float(np.mean(lost.measured - exact))) < 0.1 * UM
    # Twelve samples a pitch round hand-overs; both curves are rounded alike.
    assert float(np.max(np.abs(lost.measured - exact))) < 3.0 * UM
    assert float(np.max(np.abs(lost.measured - lost.simulated))) < 1.0 * UM
    tooth, measured, simulated = lost.by_tooth()
    assert np.array_equal(tooth, np.arange(16))
    by_tooth = np.array([np.mean(exact[np.rint(lost.place * 16 / TURN).astype(int) % 16 == k]) for k in tooth])
    assert float(np.max(np.abs(measured - by_tooth))) < 0.3 * UM
    assert float(np.max(np.abs(simulated - by_tooth))) < 0.3 * UM
    # Rotations of either shaft: j / r_b1 and j / r_b2.
    assert lost.arcmin(lost.r_b1 * ARCMIN) == pytest.approx(1.0)
    assert lost.driven_arcmin(1.0) == pytest.approx(RATIO * lost.arcmin(1.0))


@pytest.mark.long
def test_teeth_thinner_than_stated_show_as_lost_motion(pair: Pair) -> None:
    """E_s along the reference circle is E_s cos(alpha) along the line of action, and the drive flank stays."""
    sheet = pair.file.driving.inspection
    assert sheet is not None
    stated = sheet.model_copy(update={"tooth_thickness_um": -60.0 + 30.0})
    file = pair.file.model_copy(update={"driving": pair.file.driving.model_copy(update={"inspection": stated})})
    (lost,) = lost_motions(compare(file, runs_of(recorded(pair.made, motion((6.0, -6.0)), rng())), path=pair.path))
    assert lost.beyond == pytest.approx(30.0 * math.cos(20.0 * DEG) * UM, abs=0.1 * UM)
    assert lost.std < 0.1 * UM


@pytest.mark.long
def test_load_adds_the_deflection_of_both_flanks(tmp_path: Path) -> None:
    file, path, made = inspected(tmp_path, np.random.default_rng(4), z_1=12, z_2=16, bends=True)
    one = recorded(made, motion((6.0, -6.0)), rng(), torque_nm=20.0)
    (lost,) = lost_motions(compare(file, runs_of(one), path=path))
    exact = both_flanks(made.pair, lost.place, fast=True).j_bn
    assert abs(lost.beyond) < 0.1 * UM
    np.testing.assert_allclose(np.mean(lost.backlash), np.mean(exact), rtol=0.0, atol=0.1 * UM)
    # Both flanks give by some um under 20 N.m.
    assert float(np.mean(lost.simulated - lost.backlash)) > 2.0 * UM


@pytest.mark.slow
def test_runs_of_a_rig_that_computed_the_error_share_their_zero(pair: Pair) -> None:
    """The rig's zero is its own and its driven angle wraps, but both runs have them in common."""
    mesh = pair.made.pair
    one = recorded(pair.made, motion((6.0, -6.0)), rng(), wrapped=False)
    assert one.driving_angle_rad is not None and one.driven_angle_rad is not None
    te = (one.driven_angle_rad - 2.2) - mesh.ratio * (one.driving_angle_rad - 0.7)
    rig = replace(
        one, driving_angle_rad=None, driven_angle_rad=np.mod(one.driven_angle_rad, TURN),
        te_mm=(te - te[0]) * mesh.r_b2, driving_zero_rad=None, driven_zero_rad=None,
    )  # fmt: skip
    runs = runs_of(rig)
    assert [(run.backward, run.flank) for run in runs] == [(False, "drive"), (True, "coast")]
    assert means_compare(runs) == (True, True)
    (lost,) = lost_motions(compare(pair.file, runs, path=pair.path))
    assert abs(lost.beyond) < 0.1 * UM
    assert float(np.max(np.abs(lost.measured - lost.simulated))) < 1.0 * UM
    # Two files of such a rig have two zeros, and nothing is told between them.
    apart = [replace(run, run=None) for run in runs]
    assert lost_motions(compare(pair.file, apart, path=pair.path)) == ()


@pytest.mark.long
def test_a_gap_of_unknown_turns_cuts_a_run(pair: Pair) -> None:
    """Wrapped encoders of which three turns are missing, in a file that turns back too."""
    one = recorded(pair.made, motion((9.0, -9.0)), rng())
    held = np.r_[0:700, 1300 : one.size]

    def kept(values: FloatArray | None) -> FloatArray | None:
        return None if values is None else values[held]

    runs = runs_of(
        replace(
            one, time_s=kept(one.time_s), driving_angle_rad=kept(one.driving_angle_rad),
            driven_angle_rad=kept(one.driven_angle_rad),
        )
    )  # fmt: skip
    assert [run.backward for run in runs] == [False, False, True]
    assert [run.run.stretch for run in runs if run.run is not None] == [0, 1, 1]
    assert [run.flank for run in runs] == ["drive", "drive", "coast"]
    comparison = compare(pair.file, runs, path=pair.path)
    (lost,) = lost_motions(comparison)
    assert abs(lost.beyond) < 0.1 * UM


@pytest.mark.long
def test_pieces_too_short_are_said(pair: Pair) -> None:
    runs = runs_of(recorded(pair.made, motion((6.0, -0.4, 5.0)), rng()))
    assert [run.backward for run in runs] == [False, True, False]
    long = usable(runs)
    assert [run.source.name for run in long] == ["test.csv#1", "test.csv#3"]
    assert any("too short to use: run 2 of 3 in test.csv" in said for said in long[0].remarks)
    with pytest.raises(InputFileError, match=r"2 runs forth and back, the longest of 0\.9"):
        usable(runs_of(recorded(pair.made, motion((0.7, -0.7)), rng())))


def test_a_run_that_its_ramps_leave_too_short_is_left_out_with_a_word(pair: Pair) -> None:
    slow = runs_of(recorded(pair.made, motion((6.0, -0.78)), rng()))
    (kept,) = clean_set(slow, ratio=RATIO, r_b2=pair.made.pair.r_b2)
    assert kept.recording.flank == "drive"
    assert kept.recording.remarks[-1].startswith("test.csv#2 left out, with 0.")


def test_a_drive_that_only_swings_is_read_to_its_end_in_a_bounded_time() -> None:
    t = np.arange(60_000) / 100.0
    theta = 3.0 * np.sin(TURN * 0.5 * t)
    one = Recording(source=Path("rig.csv"), driving_angle_rad=theta, driven_angle_rad=RATIO * theta, time_s=t)
    runs = runs_of(one)
    assert len(runs) == 200
    assert any("more than 200 reversals" in said for said in runs[0].remarks)
    with pytest.raises(InputFileError, match="200 runs forth and back"):
        usable(runs)


def test_a_torque_that_was_not_read_tells_nothing(pair: Pair) -> None:
    one = recorded(pair.made, motion((6.0, -6.0)), rng())
    torque = np.full(one.size, math.nan)
    torque[:50] = 3.0
    assert [run.flank for run in runs_of(replace(one, torque_samples_nm=torque))] == ["drive", "coast"]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["encoder_off_centre", "eccentric_low_tooth"])
def test_the_lost_motion_of_an_independent_bench_is_the_simulated_one(name: str) -> None:
    """A second calculation, which shares no code: the bench's pairs have the declared thickness, which the inspection
    knows to 0.2 um, and what hides in them averages out over the turn."""
    folder = SHIPPED / name
    file = read_pair(folder / "pair.toml")
    these = [read_recording(one) for one in sorted(folder.glob("rec_*.csv"))]
    (lost,) = lost_motions(compare(file, these, path=folder / "pair.toml"))
    assert abs(lost.beyond) < 0.2 * UM


@pytest.mark.parametrize("creep", [0.0, 0.03])
def test_a_stop_in_the_middle_is_left_out_with_its_ramps(creep: float) -> None:
    """One way on after a stop, or after a creep at 3 % of the speed: one recording, without what was slow."""
    t = np.arange(0.0, 14.0, 1.0 / 400.0)
    speed = np.clip(np.maximum(np.abs(t - 7.0) - 1.0, 0.0) / 0.5, creep, 1.0)
    theta = TURN * np.cumsum(speed) / 400.0 + 1e-6 * np.random.default_rng(1).standard_normal(t.size)
    te = 2e-4 * np.cos(theta)
    got = clean(
        Recording(source=Path("rig.csv"), driving_angle_rad=theta, driven_angle_rad=RATIO * theta + te, time_s=t),
        ratio=RATIO,
    )
    slow = np.flatnonzero(speed < 0.75)
    gone = np.setdiff1d(np.arange(t.size), got.keep)
    # The speed is taken over 5 deg, six samples.
    assert abs(gone[0] - slow[0]) <= 8 and abs(gone[-1] - slow[-1]) <= 8
    assert np.array_equal(np.diff(gone), np.ones(gone.size - 1))
    (said,) = [deed for deed in got.done if deed.what == "stops"]
    assert said.count == gone.size
    assert f"rows {gone[0] + 1} to {gone[-1] + 1}" in said.says


def test_a_slow_part_that_holds_a_good_part_of_the_way_stays() -> None:
    t = np.arange(0.0, 30.0, 1.0 / 200.0)
    speed = np.where(np.abs(t - 15.0) < 8.0, 0.3, 1.0)
    theta = TURN * np.cumsum(speed) / 200.0
    one = Recording(source=Path("rig.csv"), driving_angle_rad=theta, driven_angle_rad=RATIO * theta, time_s=t)
    assert clean(one, ratio=RATIO).keep.size == t.size


@pytest.fixture
def files(pair: Pair, tmp_path: Path) -> tuple[Path, Path]:
    """A pair file and a backlash test on disk."""
    one = recorded(pair.made, motion((4.0, -4.0, 0.5)), rng())
    assert one.time_s is not None and one.driving_angle_rad is not None and one.driven_angle_rad is not None
    columns = {
        "time_s": one.time_s,
        "driving_angle_deg": np.degrees(one.driving_angle_rad),
        "driven_angle_deg": np.degrees(one.driven_angle_rad),
    }
    write_csv(tmp_path / "test.csv", columns, {"torque_nm": 0.0})
    (tmp_path / "pair.toml").write_text(dump_pair(pair.file), encoding="utf-8")
    return tmp_path / "pair.toml", tmp_path / "test.csv"


@pytest.mark.long
def test_every_command_takes_the_runs(files: tuple[Path, Path], gearpoly_command: Command, tmp_path: Path) -> None:
    path, file = files
    ran = gearpoly_command("read", str(file))
    assert ran.code == 0, ran.err
    said = " ".join(ran.out.split())
    assert "run 1 of 3 in test.csv" in said and "turns forward, drive flank, alone as test.csv#1" in said
    assert "turns back, coast flank, alone as test.csv#2" in said and "too short to use" in said
    assert "lost motion from run 1 to run 2: 34 arcmin of the driving shaft" in said
    assert "to be compared as it is" in said
    held = json.loads(gearpoly_command("read", str(file), "--json", "-").out)["recordings"][0]
    assert [run["flank"] for run in held["runs"]] == ["drive", "coast", "drive"]
    assert held["lost_motion"][0]["mean_driving_arcmin"] == pytest.approx(34.0, abs=0.1)

    ran = gearpoly_command("compare", str(path), str(file), "--json", "-", "--plot", str(tmp_path / "lost.png"))
    assert ran.code == 0, ran.err
    verdict = json.loads(ran.out)
    assert [(one["flank"], one.get("reversed")) for one in verdict["recordings"]] == [("drive", None), ("coast", True)]
    (lost,) = verdict["lost_motion"]
    assert lost["measured"]["mean_um"] == pytest.approx(lost["simulated"]["mean_um"], abs=0.1)
    assert lost["measured"]["mean_arcmin"] == pytest.approx(34.0, abs=0.1)
    assert len(lost["over_driven_turn"]["measured_um"]) == 16
    ran = gearpoly_command("compare", str(path), str(file))
    assert "lost motion" in ran.out and "measured minus simulated" in ran.out

    ran = gearpoly_command("simulate", str(path), "--at", str(file), "--fast")
    assert ran.code == 2
    assert "2 runs forth and back" in ran.err and "test.csv#2 (back, coast flank)" in " ".join(ran.err.split())
    ran = gearpoly_command("simulate", str(path), "--at", f"{file}#2", "--fast", "--json", "-")
    assert ran.code == 0, ran.err
    assert json.loads(ran.out)["flank"] == "coast"
    ran = gearpoly_command("simulate", str(path), "--at", f"{file}#7", "--fast")
    assert ran.code == 2 and "run 7 of 3" in ran.err
