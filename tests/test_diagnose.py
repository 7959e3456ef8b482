"""The diagnosis on recordings of another generator than the simulator, and what the command does around it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.plan import plan
from gearpoly.files.pairfile import dump_pair, read_pair
from gearpoly.recording.read import read_recording
from gearpoly.report.diagnosis_report import verdict_json
from tests.at_hand import BENCH, SHARED, SHIPPED, diagnosed, recordings, shipped_and_beside, truths
from tests.made_command import Command

TELESCOPE = SHARED / "telescope"
needs_bench = pytest.mark.skipif(not BENCH.is_dir(), reason="the bench recordings are not here")
needs_telescope = pytest.mark.skipif(not TELESCOPE.is_dir(), reason="the telescope recordings are not here")


def verdict(case: str) -> dict[str, Any]:
    return verdict_json(diagnosed(BENCH / case))


def check(case: str) -> None:
    """Every hidden physics named on its gear and tooth, sizes within 5 % or twice the stated error, nothing else."""
    found, hidden = verdict(case), truths(BENCH / case)
    named = [(one["physics"], one.get("gear")) for one in found["missing"]]
    gears = {1: "driving", 2: "driven", None: None}
    assert sorted(named, key=str) == sorted(((t["physics"], gears[t.get("gear")]) for t in hidden), key=str)
    for truth in hidden:
        one = next(
            m for m in found["missing"] if (m["physics"], m.get("gear")) == (truth["physics"], gears[truth.get("gear")])
        )
        if "encoder_deg" in truth:
            # Half a tooth of a gear with 25 teeth is 7.2 deg.
            assert abs((one["encoder_deg"] - truth["encoder_deg"] + 180.0) % 360.0 - 180.0) < 7.2
        for name, value in truth.items():
            if name in one["parameters"] and name != "angle_deg":
                got = one["parameters"][name]
                assert abs(got["value"] - value) <= max(0.05 * abs(value), 2.0 * got["std"]), (name, got, value)
    # What the parameters themselves cost: as-built teeth are a hundredth of the samples.
    assert found["fit"]["heldout_rms_um"]["after"] <= 1.05 * found["noise_um"]
    assert found["unexplained"] == []


@pytest.mark.slow
@needs_bench
@pytest.mark.parametrize(
    "case",
    [
        "crack_under_load_graded",
        "ecc_under_pitch",
        "encoder_ecc",
        "friction",
        "ghost_order",
        "relief_cancels_deflection",
        "spall_under_pitch",
        "two_at_once",
    ],
)
def test_what_is_hidden_is_named_and_nothing_else(case: str) -> None:
    check(case)


@pytest.mark.long
@pytest.mark.parametrize("folder", shipped_and_beside("healthy", "control_inspected"), ids=str)
def test_a_healthy_pair_misses_nothing(folder: Path) -> None:
    found = verdict_json(diagnosed(folder))
    assert found["status"] == "nothing_missing"
    assert found["missing"] == []
    assert found["unexplained"] == []
    # A continuous-involute calculation reaches 0.31 um held out once pitch and slope are refined: of 0.3 um of noise.
    assert found["fit"]["heldout_rms_um"]["after"] < 0.31


@pytest.mark.slow
@needs_bench
def test_an_order_that_no_gear_makes_is_located_and_not_named() -> None:
    found = verdict_json(diagnosed(BENCH / "unknown_order"))
    assert found["status"] == "unexplained"
    assert found["missing"] == []
    (one,) = found["unexplained"]
    assert one["order"] == pytest.approx(4.41, rel=1e-3)
    assert one["amplitude_um"] == pytest.approx(0.609, abs=3.0 * one["std_um"])


@pytest.mark.slow
@pytest.mark.parametrize("folder", shipped_and_beside("encoder_off_centre", "two_at_once"), ids=str)
def test_the_fitted_file_is_a_pair_file_that_leaves_only_noise(folder: Path, tmp_path: Path) -> None:
    found = diagnosed(folder)
    target = tmp_path / "fitted.toml"
    target.write_text(dump_pair(found.fitted))
    again = compare(read_pair(target), [read_recording(path) for path in recordings(folder)], path=target)
    # All cycles were fitted, so what is left is the noise less what 90 parameters took of 18 000 samples.
    assert again.aligned[0].rms < 1.02 * found.noise
    # The tooth's form differs from the formula of a spall by a few per cent of its depth, and may show.
    assert {(entry.kind, entry.gear, entry.tooth) for entry in again.located.entries} <= {("tooth", "driven", 9)}


@pytest.mark.slow
@needs_telescope
def test_a_telescope_s_worm_is_located_with_what_may_turn_once(tmp_path: Path) -> None:
    """34 um once per turn of the driving gear, as compare has it; the motor turns with it, so nobody knows whose it is.
    The mesh and the worm's five orders are places without a cause."""
    pair = tmp_path / "eq6.toml"
    pair.write_text("[driving]\nteeth = 12\nmodule_mm = 0.5\n[driven]\nteeth = 47\nmodule_mm = 0.5\n")
    found = diagnose(read_pair(pair), [read_recording(TELESCOPE / "log01_as_eq6.csv")], path=pair)
    assert not found.findings
    once = next(one for one in found.unexplained if (one.gear, one.order) == ("driving", 1.0))
    assert once.amplitude_um == pytest.approx(34.0, abs=2.0)
    assert [cause.physics for cause in once.could_be] == ["eccentricity"]
    assert {("driven", 5.0), (None, 1.0)} <= {(one.gear, one.order) for one in found.unexplained}


@pytest.mark.slow
@needs_telescope
def test_waves_of_another_mount_get_no_name(tmp_path: Path) -> None:
    """Beside sixteen waves that this pair cannot make, by 0.02 each one is at an order of one of its shafts. The teeth
    are told to be others, and what was located before any fit is told."""
    pair = tmp_path / "eq6.toml"
    pair.write_text("[driving]\nteeth = 12\nmodule_mm = 0.5\n[driven]\nteeth = 47\nmodule_mm = 0.5\n")
    found = diagnose(read_pair(pair), [read_recording(TELESCOPE / "log04_as_eq6.csv")], path=pair)
    assert not found.findings
    assert {5.0, 20.0} <= {entry.order for entry in found.unexplained}


@pytest.mark.slow
def test_a_plan_knows_the_look_alikes_of_a_pair(tmp_path: Path) -> None:
    pair = tmp_path / "pair.toml"
    pair.write_text(
        "[pair]\ntorque_nm = 20.0\n"
        "[driving]\nteeth = 12\nmodule_mm = 2.0\nface_width_mm = 20.0\n[driving.inspection]\nuncertainty_um = 0.3\n"
        "[driven]\nteeth = 16\nmodule_mm = 2.0\nface_width_mm = 20.0\n[driven.inspection]\nuncertainty_um = 0.3\n"
    )
    made = plan(read_pair(pair), path=pair)
    alike = {(one.one, one.other): one for one in made.look_alikes}
    assert any(one.flank == "coast" for one in made.further)
    for name in ("driving", "driven"):
        gear_or_encoder = alike[f"eccentricity {name}", f"encoder_eccentricity {name}"]
        assert gear_or_encoder.first < 0.2
        # What both have in common on both flanks teeth may be; what is left of a gear's on the coast flank is its own.
        assert max(gear_or_encoder.after) > 0.9
    slopes = alike["profile_slope driving", "profile_slope driven"]
    assert (slopes.after or (slopes.first,))[-1] < 0.5


def test_recordings_that_contradict_each_other_are_refused(tmp_path: Path, gearpoly_command: Command) -> None:
    folder = SHIPPED / "encoder_off_centre"
    lines = (folder / "rec_1.csv").read_text().splitlines(keepends=True)
    moved = [line for line in lines if not line.startswith("# driven_zero_deg")]
    zero = float(next(line for line in lines if line.startswith("# driven_zero_deg")).split("=")[1])
    other = tmp_path / "rec_1.csv"
    other.write_text(f"# driven_zero_deg = {zero + 30.0}\n" + "".join(moved))
    html = tmp_path / "page.html"
    ran = gearpoly_command("diagnose", folder / "pair.toml", folder / "rec_0.csv", other, "--html", html)
    assert ran.code == 2
    assert "driven_zero_deg" in ran.err
    assert "Traceback" not in ran.err
    assert not html.exists()


def test_a_recording_that_is_none_is_refused(tmp_path: Path, gearpoly_command: Command) -> None:
    pair, recording = tmp_path / "pair.toml", tmp_path / "rec.csv"
    pair.write_text("[driving]\nteeth = 12\nmodule_mm = 2.0\n[driven]\nteeth = 16\nmodule_mm = 2.0\n")
    recording.write_text("driving_angle_deg,driven_angle_deg\n1,2\n")
    fitted = tmp_path / "fitted.toml"
    ran = gearpoly_command("diagnose", pair, recording, "--fitted", fitted)
    assert ran.code == 2
    assert "rec.csv" in ran.err
    assert not fitted.exists()


@pytest.mark.slow
def test_the_same_recordings_give_the_same_verdict() -> None:
    folder = SHIPPED / "healthy"
    first, second = (json.dumps(verdict_json(make(folder))) for make in (diagnosed, diagnosed.__wrapped__))
    assert first == second
