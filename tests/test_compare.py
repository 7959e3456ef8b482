"""The compare command from end to end: what it finds on the bench, what it writes, what it says and what it refuses."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import compare, lay_beside
from gearpoly.files.pairfile import read_pair
from gearpoly.recording.read import read_recording
from gearpoly.units import DEG, NM, UM
from tests.at_hand import BENCH, SHARED, SHIPPED
from tests.made_command import Command
from tests.made_recordings import Rig, inspected, record

TELESCOPE = SHARED / "telescope"
needs_bench = pytest.mark.skipif(not BENCH.is_dir(), reason="the bench recordings are not here")
needs_telescope = pytest.mark.skipif(not TELESCOPE.is_dir(), reason="the telescope recordings are not here")

NEEDED = 0.02
"""deg. What alignment has to reach."""


def truth(case: str) -> dict[str, Any]:
    return json.loads((BENCH / f"{case}.truth.json").read_text(encoding="utf-8"))


def bench(case: str) -> tuple[Path, list[Path]]:
    return BENCH / case / "pair.toml", sorted((BENCH / case).glob("rec_*.csv"))


def without_zeros(recording: Path, folder: Path) -> Path:
    """A copy that states no zeros."""
    target = folder / recording.name
    lines = recording.read_text(encoding="utf-8").splitlines(keepends=True)
    target.write_text("".join(line for line in lines if "_zero_deg" not in line), encoding="utf-8")
    return target


def apart(one: float, other: float) -> float:
    """Angle in deg between two readings."""
    return abs((one - other + 180.0) % 360.0 - 180.0)


# The bench.


@pytest.mark.long
@needs_bench
def test_the_healthy_control_is_told_healthy(gearpoly_command: Command, tmp_path: Path) -> None:
    pair, recordings = bench("control_inspected")
    target, picture = tmp_path / "out.json", tmp_path / "out.png"
    ran = gearpoly_command("compare", pair, *recordings, "--json", target, "--plot", picture)
    assert ran.code == 0
    assert [line.partition(": ")[0] for line in ran.err.splitlines()] == [f"wrote {target}", f"wrote {picture}"]
    found = json.loads(target.read_text(encoding="utf-8"))
    # 0.39 by a calculation that shares no code with this one; a sign or a number wrong leaves 1 um or more.
    assert found["residual_rms_um"] == pytest.approx(0.39, abs=0.015)
    assert found["noise_um"] == pytest.approx(truth("control_inspected")["noise_um"], rel=0.05)
    assert found["where"] == []
    # Noise and what repeats are all that is left.
    assert np.hypot(found["noise_um"], found["repeatable_rms_um"]) == pytest.approx(found["residual_rms_um"], rel=0.02)
    alignment = found["alignment"]
    assert alignment["numbering"] == "curves"
    assert alignment["std_deg"] < NEEDED
    # Stated zeros carry 0.05 deg of error: three times that, and the stated error.
    assert apart(alignment["driving_zero_deg"], 183.776) < 0.15 + alignment["std_deg"]
    assert apart(alignment["driven_zero_deg"], 67.371) < 0.15 + alignment["std_deg"]
    for words in ("found from the curves", "noise 0.29", "repeats every hunting cycle", "nothing beyond noise"):
        assert words in ran.out
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.long
@needs_bench
@pytest.mark.parametrize(
    "case",
    [
        "two_at_once",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("control_inspected", "spall_under_pitch")),
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("encoder_ecc", "friction")),
        pytest.param("relief_cancels_deflection", marks=pytest.mark.slow),
    ],
)
def test_numberings_come_from_the_curves_alone(case: str, tmp_path: Path) -> None:
    """The same zeros with and without a hint, also where physics that the file does not know of are larger."""
    pair, recordings = bench(case)
    hinted = lay_beside(read_pair(pair), [read_recording(r) for r in recordings], path=pair)
    bare = [read_recording(without_zeros(r, tmp_path)) for r in recordings]
    found = lay_beside(read_pair(pair), bare, path=pair)
    assert found.alignment.numbering == "curves"
    assert not found.alignment.rivals
    for one, other in (
        (found.alignment.zeros.driving, hinted.alignment.zeros.driving),
        (found.alignment.zeros.driven, hinted.alignment.zeros.driven),
    ):
        assert one is not None and other is not None
        # The same minimum, begun elsewhere.
        assert apart(one / DEG, other / DEG) < 0.001
    if case != "relief_cancels_deflection":  # asked for below
        assert found.alignment.std / DEG < 0.03


@pytest.mark.slow
@needs_bench
@pytest.mark.xfail(
    reason="0.064 deg is stated, and the zero is within 0.004 deg; but reliefs that nobody declared move the hand-over "
    "by which curves are placed, by 2.2 deg in another pair, so less would not be honest before they are found"
)
def test_undeclared_reliefs_leave_the_zero_known() -> None:
    pair, recordings = bench("relief_cancels_deflection")
    found = lay_beside(read_pair(pair), [read_recording(r) for r in recordings], path=pair)
    assert found.alignment.std / DEG < 0.03


@pytest.mark.long
@needs_bench
@pytest.mark.parametrize("case", ["spall_under_pitch", "two_at_once"])
def test_zeros_agree_with_where_the_truth_has_its_tooth(case: str) -> None:
    pair, recordings = bench(case)
    found = lay_beside(read_pair(pair), [read_recording(r) for r in recordings], path=pair).alignment.zeros.driven
    spall = next(entry for entry in truth(case)["truth"] if entry["physics"] == "tooth_spall")
    assert found is not None
    assert apart(found / DEG, spall["encoder_deg"] - spall["tooth"] * 360.0 / spall["teeth"]) < NEEDED


@pytest.mark.long
@pytest.mark.parametrize("stated", [None, 20.0])
def test_a_torque_that_nobody_stated_is_told(stated: float | None, tmp_path: Path) -> None:
    """The pair file's own is taken for it: half of three torques would otherwise look like softer teeth."""
    rng = np.random.default_rng(3)
    file, path, made = inspected(tmp_path, rng, z_1=11, z_2=13, bends=True)
    file = file.model_copy(update={"pair": file.pair.model_copy(update={"torque_nm": 20.0})})
    one = record(made, Rig(zero_1=0.4, zero_2=1.2), rng, cycles=2.0, per_mesh=8, torque_nm=20.0)
    beside = lay_beside(file, [replace(one, torque_nm=stated)], path=path)
    assert beside.aligned[0].torque == 20.0 * NM
    assert any("no torque is stated, the 20 N.m" in remark for remark in beside.remarks) is (stated is None)


@needs_bench
@pytest.mark.slow
def test_graded_gears_are_placed_within_a_pitch_and_said_to_be_no_more() -> None:
    pair, recordings = bench("crack_under_load_graded")
    beside = lay_beside(read_pair(pair), [read_recording(r) for r in recordings], path=pair)
    assert beside.alignment.phased
    assert beside.alignment.numbering == "open"
    crack = truth("crack_under_load_graded")["truth"][0]
    pitch = 360.0 / crack["teeth"]
    driven = beside.alignment.zeros.driven
    assert driven is not None
    off = (driven / DEG - crack["encoder_deg"] + 0.5 * pitch) % pitch - 0.5 * pitch
    assert abs(off) < NEEDED
    assert any("nobody inspected" in remark for remark in beside.remarks)


@needs_bench
@pytest.mark.slow
def test_mean_te_falls_with_torque_on_one_common_zero() -> None:
    """8.16 and 8.71 um from torque to torque, as the rig's makers found on the true zero."""
    pair, recordings = bench("friction")
    beside = lay_beside(read_pair(pair), [read_recording(r) for r in recordings], path=pair)
    means = [float(np.mean(one.recorded)) / UM for one in beside.aligned]
    assert np.diff(means) == pytest.approx([-8.16, -8.71], abs=0.02)  # printed digits, and noise of a mean


@needs_bench
@pytest.mark.slow
def test_zeros_may_be_missing_in_some_recordings_of_a_set(tmp_path: Path) -> None:
    pair, recordings = bench("encoder_ecc")
    whole = lay_beside(read_pair(pair), [read_recording(r) for r in recordings], path=pair)
    mixed = [read_recording(recordings[0]), read_recording(without_zeros(recordings[1], tmp_path))]
    found = lay_beside(read_pair(pair), mixed, path=pair)
    assert found.alignment.zeros.driven == pytest.approx(whole.alignment.zeros.driven, abs=1e-5)
    np.testing.assert_allclose([one.rms for one in found.aligned], [one.rms for one in whole.aligned], rtol=1e-3)


# Real drives.


def telescope_pair(folder: Path, z_1: int) -> Path:
    path = folder / f"{z_1}_47.toml"
    path.write_text(
        f"[driving]\nteeth = {z_1}\nmodule_mm = 0.5\n[driven]\nteeth = 47\nmodule_mm = 0.5\n", encoding="utf-8"
    )
    return path


@pytest.mark.long
@needs_telescope
@pytest.mark.parametrize(("name", "z_1"), [("log01_as_eq6", 12), ("log01_as_heq5", 9)])
def test_a_telescope_says_what_stands_in_for_repetition(
    gearpoly_command: Command, tmp_path: Path, name: str, z_1: int
) -> None:
    target = tmp_path / "out.json"
    ran = gearpoly_command("compare", telescope_pair(tmp_path, z_1), TELESCOPE / f"{name}.csv", "--json", target)
    assert (ran.code, ran.err.startswith("wrote "), ran.err.count("\n")) == (0, True, 1)
    found = json.loads(target.read_text(encoding="utf-8"))
    one = found["recordings"][0]
    assert one["hunting_cycles"] < 1.0
    assert "repeatable_rms_um" not in found
    assert "nothing repeats" in one["noise_from"]
    assert "nothing repeats" in ran.out
    # Ideal gears draw a flat curve, and only the worm shaft has an encoder.
    assert found["alignment"]["driving_zero_deg"] is None
    assert not found["alignment"]["numbered"]
    assert not found["alignment"]["phased"]
    assert "too flat" in ran.out
    orders = {(e.get("gear"), e["order"]) for e in found["where"] if e["kind"] == "shaft_order"}
    assert ("driving", 1) in orders
    # The mesh line tells which pair is inside: both readings share the driving gear's turn, not the mesh.
    meshes = {e["order"] for e in found["where"] if e["kind"] == "mesh_order"}
    assert meshes == ({1} if z_1 == 12 else set())


@pytest.mark.long
@needs_telescope
def test_another_mount_shows_no_line_of_this_pair(gearpoly_command: Command, tmp_path: Path) -> None:
    ran = gearpoly_command("compare", telescope_pair(tmp_path, 12), TELESCOPE / "log04_as_eq6.csv", "--json", "-")
    assert ran.code == 0
    where = json.loads(ran.out)["where"]
    assert not [e for e in where if e["kind"] == "mesh_order"]
    assert not [e for e in where if e["kind"] == "shaft_order" and e["gear"] == "driving" and e["order"] == 1]


# Made recordings: healthy ones raise nothing, a runout brings nothing along.


def healthy(seed: int, folder: Path, *, z: tuple[int, int], cycles: int, hidden: str = "") -> Comparison:
    """An inspected pair that declares 60 um of eccentricity, recorded in noise of AR(1) 0.6 from unknown zeros."""
    rng = np.random.default_rng(seed)
    stated = f"[driving.eccentricity]\namplitude_um = 60.0\nangle_deg = {rng.uniform(0.0, 360.0)}"
    stated, hidden = ("", hidden) if hidden else (stated, "")
    file, path, made = inspected(folder, rng, z_1=z[0], z_2=z[1], gauge=0.2, stated=stated, hidden=hidden)
    rig = Rig(zero_1=rng.uniform(0.0, 6.28), zero_2=rng.uniform(0.0, 6.28), noise=0.5, correlation=0.6)
    return compare(file, [record(made, rig, rng, cycles=1.001 * cycles, per_mesh=20)], path=path)


@pytest.mark.slow
def test_thirty_healthy_recordings_raise_nothing(tmp_path: Path) -> None:
    # At a true rate of 5 %, more than 4 of 30 come in 1.6 % of such tests.
    assert sum(bool(healthy(seed, tmp_path, z=(12, 18), cycles=6).located.entries) for seed in range(30)) <= 4


@pytest.mark.slow
@pytest.mark.parametrize(("z", "cycles"), [((12, 18), 10), ((18, 25), 2)])
def test_two_hundred_healthy_recordings_raise_nothing(tmp_path: Path, z: tuple[int, int], cycles: int) -> None:
    """At most 5 % of 200 with any entry, half of them of each pair."""
    found = [healthy(10_000 + seed, tmp_path, z=z, cycles=cycles) for seed in range(100)]
    assert sum(bool(one.located.entries) for one in found) <= 5
    # The noise put in is 0.5 um; the issue asks for 5 %.
    assert np.mean([one.located.noise_level / UM for one in found]) == pytest.approx(0.5, rel=0.05)


def test_a_hidden_runout_is_one_entry(tmp_path: Path) -> None:
    """20 um off its axis: the ends of contact wander too, which is no other fault."""
    hidden = "[driving.eccentricity]\namplitude_um = 20.0\nangle_deg = 100.0"
    entries = healthy(3, tmp_path, z=(18, 25), cycles=1, hidden=hidden).located.entries
    assert [(e.kind, e.gear, e.order) for e in entries] == [("shaft_order", "driving", 1.0)]
    assert entries[0].amplitude_um == pytest.approx(20.0, abs=4.0 * (entries[0].std_um or 0.0))


# What it writes and refuses.


@pytest.mark.long
def test_json_goes_to_standard_output_alone(gearpoly_command: Command) -> None:
    folder = SHIPPED / "healthy"
    ran = gearpoly_command("compare", folder / "pair.toml", folder / "rec_0.csv", "--json", "-")
    assert ran.code == 0
    found = json.loads(ran.out)  # nothing but JSON
    assert {"noise_um", "alignment", "where", "residual_rms_um", "repeatable_rms_um"} <= found.keys()
    assert {"driving_zero_deg", "driven_zero_deg", "std_deg", "rivals"} <= found["alignment"].keys()
    assert len(found["noise_um_by_recording"]) == 1


PAIR = "[driving]\nteeth = 18\nmodule_mm = 2.0\n[driven]\nteeth = 25\nmodule_mm = 2.0\n"


def ramp(turns: float, *, ratio: float = 18 / 25, count: int = 400, keys: str = "", header: str = "") -> str:
    """A recording of two even shafts."""
    angle = np.linspace(0.0, 360.0 * turns, count)
    rows = "\n".join(f"{a:.6f},{ratio * a:.6f}" for a in angle)
    return f"{keys}{header or 'driving_angle_deg,driven_angle_deg'}\n{rows}\n"


COLUMNS = "driving_angle_deg,driven_angle_deg"


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("rec.csv", ramp(3.0, header="driving_angle_deg,other_angle"), "driven_angle_deg"),
        ("rec.csv", ramp(3.0, header="driving_angle_deg,driving_angle_deg"), "the name of columns 1 and 2"),
        ("rec.csv", ramp(0.9), "driving turns"),
        ("rec.csv", ramp(3.0, ratio=0.6), "the nearest tooth ratio is 3/5"),
        ("rec.csv", ramp(3.0, count=40), "usable samples"),
        ("rec.csv", ramp(3.0, keys='# torque_nm = "high"\n'), 'line 1: torque_nm = "high"'),
        ("rec.csv", f"{COLUMNS},torque_nm\n0.0,0.0,high\n", 'line 2, column torque_nm: "high"'),
        ("rec.csv", ramp(3.0, keys="# torque_nm = 20.0\n"), "face_width_mm"),
        ("rec.csv", ramp(-3.0), "state driving_direction = -1"),
        ("rec.csv", "", "empty"),
        ("rec.csv", f"{COLUMNS}\n", "no rows"),
        ("rec.csv", f"{COLUMNS}\n0.0,0.0\n1.0", "line 3: 1 cells; want 2"),
        ("rec.csv", f"{COLUMNS}\n0.0,0.0\n1.0,0.72,4.0\n2.0,1.44\n", "line 3: 3 cells; want 2"),
        ("rec.mat", ramp(3.0), "text, for all its ending .mat"),
    ],
    ids=[
        "column", "doubled", "short", "another pair", "few", "torque text", "torque column", "no face width",
        "backwards", "empty", "header only", "cut off", "unequal", "text named mat",
    ],
)  # fmt: skip
def test_bad_recordings_exit_2_and_leave_nothing_behind(
    gearpoly_command: Command, tmp_path: Path, name: str, text: str, words: str
) -> None:
    pair, recording, target = tmp_path / "pair.toml", tmp_path / name, tmp_path / "out.json"
    pair.write_text(PAIR, encoding="utf-8")
    recording.write_text(text, encoding="utf-8")
    ran = gearpoly_command("compare", pair, recording, "--json", target, "--plot", tmp_path / "out.png")
    assert ran.code == 2
    assert words in ran.err
    assert "Traceback" not in ran.err
    assert sorted(tmp_path.iterdir()) == [pair, recording]


def test_columns_of_unequal_length_exit_2(gearpoly_command: Command, tmp_path: Path) -> None:
    from scipy.io import savemat

    pair, recording = tmp_path / "pair.toml", tmp_path / "rec.mat"
    pair.write_text(PAIR, encoding="utf-8")
    angle = np.linspace(0.0, 1800.0, 600)
    savemat(recording, {"driving_angle_deg": angle, "driven_angle_deg": 0.72 * angle[:-5]})
    ran = gearpoly_command("compare", pair, recording)
    assert ran.code == 2
    assert "unequal length, driving_angle_deg: 600, driven_angle_deg: 595" in ran.err


@pytest.mark.long
def test_a_ratio_off_by_a_constant_is_reported_as_such(gearpoly_command: Command, tmp_path: Path) -> None:
    """A slipping coupling, or counts per turn wrongly set: no crash, and the size of it."""
    pair, recording, target = tmp_path / "pair.toml", tmp_path / "rec.csv", tmp_path / "out.json"
    pair.write_text(PAIR, encoding="utf-8")
    recording.write_text(ramp(30.0, ratio=18 / 25 * 1.002, count=3000), encoding="utf-8")
    ran = gearpoly_command("compare", pair, recording, "--json", target)
    assert (ran.code, ran.err.startswith("wrote "), ran.err.count("\n")) == (0, True, 1)
    assert "encoder count or slip" in ran.out
    found = json.loads(target.read_text(encoding="utf-8"))
    assert found["recordings"][0]["ratio_off"] == pytest.approx(0.002, rel=1e-6)  # six printed decimals of a deg


def test_zeros_that_contradict_each_other_exit_2(gearpoly_command: Command, tmp_path: Path) -> None:
    pair = tmp_path / "pair.toml"
    pair.write_text(PAIR, encoding="utf-8")
    files = []
    for k, zero in enumerate((10.0, 25.0)):
        files.append(tmp_path / f"rec_{k}.csv")
        files[-1].write_text(ramp(4.0, keys=f"# driving_zero_deg = {zero}\n"), encoding="utf-8")
    ran = gearpoly_command("compare", pair, *files)
    assert ran.code == 2
    assert "rec_1.csv: driving_zero_deg: 25.000, 15.000 deg from that of" in ran.err
    assert "half a tooth (10.000 deg)" in ran.err


def test_targets_are_checked_before_any_work(gearpoly_command: Command, tmp_path: Path) -> None:
    pair, recording = tmp_path / "pair.toml", tmp_path / "rec.csv"
    ran = gearpoly_command("compare", pair, recording, "--plot", tmp_path / "out.gif")
    assert ran.code == 2
    assert "out.gif" in ran.err
    ran = gearpoly_command("compare", pair, recording, "--json", tmp_path / "nowhere" / "out.json")
    assert ran.code == 2
    assert "no folder" in ran.err
