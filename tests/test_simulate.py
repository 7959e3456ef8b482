"""The simulate command from end to end: what it writes, and the contract's conventions."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gearpoly.files.pairfile import dump_pair, read_pair
from gearpoly.units import FloatArray
from tests.at_hand import BENCH, shipped_and_beside
from tests.made_command import PAIR, Command, Ran, recording

ROOT = Path(__file__).parents[1]
PAIRS = ROOT / "data" / "pairs"

HEADER = ["driven_angle_deg", "driving_angle_deg", "te_urad", "te_um", "backlash_um", "contact_pairs"]

R_B2 = 25.0 * math.cos(math.radians(20.0))


def table(text: str) -> dict[str, FloatArray]:
    rows = list(csv.reader(io.StringIO(text)))
    assert rows[0] == HEADER
    values = np.array(rows[1:], dtype=float)
    return {name: values[:, k] for k, name in enumerate(HEADER)}


# What it writes.


@pytest.mark.long
def test_csv_has_the_columns_of_the_contract(gearpoly_command: Command, pair_file: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.csv"
    ran = gearpoly_command("simulate", pair_file, "--csv", target, "--turns", "1", "--points-per-mesh", "10")
    assert ran.code == 0
    assert ran.err.splitlines() == [f"wrote {target}: TE, backlash and touching pairs over the driven angle"]
    found = table(target.read_text(encoding="utf-8"))
    driven, driving = found["driven_angle_deg"], found["driving_angle_deg"]
    np.testing.assert_allclose(driven, np.arange(250) * 1.44, atol=1e-9)  # as printed
    # The columns say one thing three ways; the printed digits are 1e-6 urad, 1e-6 um and 1e-12 deg.
    te = np.radians(driven - 18 / 25 * driving)
    np.testing.assert_allclose(found["te_urad"], te * 1e6, atol=2e-5)  # 1e-9 deg of the driven angle is 1.7e-5 urad
    np.testing.assert_allclose(found["te_um"], found["te_urad"] * R_B2 * 1e-3, atol=2e-6)
    assert np.all(found["backlash_um"] > 0.0)
    assert set(found["contact_pairs"]) <= {1.0, 2.0}
    # The summary that an engineer reads.
    for word in ("TEpp", "um", "urad", "arcmin", "mean", "least", "contact ratio", "theoretical"):
        assert word in ran.out


def test_json_goes_to_standard_output_alone(gearpoly_command: Command, pair_file: Path) -> None:
    ran = gearpoly_command("simulate", pair_file, "--json", "-", "--turns", "0.2", "--points-per-mesh", "10")
    assert ran.code == 0
    document = json.loads(ran.out)  # nothing but JSON
    columns, contacts = document["columns"], document["contacts"]
    assert list(columns)[: len(HEADER)] == HEADER
    count = document["summary"]["positions"]
    assert count == len(columns["te_um"]) == 50
    assert len({len(values) for values in contacts.values()}) == 1
    touching = np.array(contacts["touches"])
    position = np.array(contacts["position"])
    np.testing.assert_array_equal(np.bincount(position[touching], minlength=count), columns["contact_pairs"])
    # Contact positions: on both gears' flanks, and the radii are those of the points.
    point = np.array(contacts["point_mm"])
    np.testing.assert_allclose(np.hypot(point[:, 0], point[:, 1]), contacts["driving_radius_mm"], rtol=1e-12)
    np.testing.assert_allclose(np.hypot(point[:, 0] - 43.05, point[:, 1]), contacts["driven_radius_mm"], rtol=1e-12)
    assert np.all(np.array(contacts["driving_radius_mm"]) <= 20.0 + 1e-9)
    assert np.all(np.array(contacts["gap_um"]) >= 0.0)
    assert document["defaults"]["driving.pressure_angle_deg"] == 20.0  # contract: simulate prints its defaults
    summary = document["summary"]
    assert summary["te_pp_um"] == pytest.approx(np.ptp(columns["te_um"]), rel=1e-9)
    assert summary["backlash_mean_um"] == pytest.approx(np.mean(columns["backlash_um"]), rel=1e-9)
    assert summary["backlash_least_um"] == pytest.approx(np.min(columns["backlash_um"]), rel=1e-9)
    # 1' = 290.888 urad, on the driven shaft.
    assert summary["te_pp_arcmin"] * 290.888208 == pytest.approx(summary["te_pp_urad"], rel=1e-8)


def test_defaults_are_counted_and_listed_where_asked_for(gearpoly_command: Command, pair_file: Path) -> None:
    short = ("simulate", pair_file, "--turns", "0.1", "--points-per-mesh", "2")
    plain, listed = gearpoly_command(*short).out, gearpoly_command(*short, "--defaults").out
    assert "driving.pressure_angle_deg" not in plain
    assert re.search(r"^[1-9]\d* values are defaults; --defaults lists them$", plain, re.MULTILINE)
    assert "driving.pressure_angle_deg = 20" in listed


def test_the_default_is_a_whole_hunting_cycle(gearpoly_command: Command, tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    file.write_text(
        PAIR.replace("teeth = 18", "teeth = 10").replace("teeth = 25", "teeth = 15").replace("43.05", "25.1")
    )
    ran = gearpoly_command("simulate", file, "--csv", "-", "--points-per-mesh", "4")
    assert ran.code == 0
    driven = table(ran.out)["driven_angle_deg"]
    assert driven.size == 30 * 4  # lcm(10, 15) meshes
    assert driven[-1] == pytest.approx(2 * 360.0 - 6.0)


@pytest.mark.long
def test_both_flanks_tell_of_the_same_backlash(gearpoly_command: Command, pair_file: Path) -> None:
    runs = [
        table(gearpoly_command("simulate", pair_file, "--csv", "-", "--turns", "0.5", "--flank", flank).out)
        for flank in ("drive", "coast")
    ]
    np.testing.assert_array_equal(runs[0]["backlash_um"], runs[1]["backlash_um"])
    # TE_coast - TE_drive = j_bn / r_b2; three printed digits of 1e-6 um.
    np.testing.assert_allclose(runs[1]["te_um"] - runs[0]["te_um"], runs[0]["backlash_um"], atol=2e-6)


def test_the_seed_decides_what_the_grade_leaves_open(gearpoly_command: Command, pair_file: Path) -> None:
    texts = [
        gearpoly_command("simulate", pair_file, "--csv", "-", "--turns", "0.1", "--seed", seed).out
        for seed in ("1", "1", "2")
    ]
    assert texts[0] == texts[1]
    assert texts[0] != texts[2]


@pytest.mark.long
@pytest.mark.parametrize("ending", [".png", *(pytest.param(one, marks=pytest.mark.slow) for one in (".svg", ".pdf"))])
def test_a_picture(gearpoly_command: Command, pair_file: Path, tmp_path: Path, ending: str) -> None:
    target = tmp_path / f"run{ending}"
    ran = gearpoly_command("simulate", pair_file, "--plot", target, "--turns", "0.1", "--points-per-mesh", "8")
    assert ran.code == 0
    start = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}[ending]
    assert target.read_bytes().startswith(start)


def test_the_ideal_pair_transmits_perfectly(gearpoly_command: Command) -> None:
    ran = gearpoly_command("simulate", PAIRS / "ideal_18_25.toml", "--json", "-", "--turns", "0.2")
    assert ran.code == 0
    summary = json.loads(ran.out)["summary"]
    assert summary["te_pp_um"] < 0.15e-3
    assert abs(summary["backlash_mean_um"]) < 0.3e-3  # late by the chords of both flanks
    assert summary["contact_ratio"] == pytest.approx(1.570708, abs=1e-4)
    assert summary["contact_ratio_theoretical"] == pytest.approx(1.570708, abs=5e-7)


@pytest.mark.long
@pytest.mark.parametrize("name", ["paper_18_25", "ottewill_18_18"])
def test_shipped_pairs_run(gearpoly_command: Command, name: str) -> None:
    ran = gearpoly_command(
        "simulate", PAIRS / f"{name}.toml", "--json", "-", "--turns", "0.2", "--points-per-mesh", "5"
    )
    assert ran.code == 0
    document = json.loads(ran.out)
    assert document["gears"] == {"driving": "drawn", "driven": "drawn"}
    assert document["summary"]["backlash_least_um"] > 0.0


# At a recording: its samples, its condition, and through them every convention of the contract.


@pytest.mark.long
def test_at_a_recording_of_our_own_gives_it_back(gearpoly_command: Command, pair_file: Path, tmp_path: Path) -> None:
    """Readings wrapped, zeros shifted, one encoder counting down, several turns into the hunting cycle."""
    plain = table(gearpoly_command("simulate", pair_file, "--csv", "-", "--points-per-mesh", "3").out)
    part = slice(400, 700)
    driving = (200.0 + plain["driving_angle_deg"][part] + 180.0) % 360.0 - 180.0
    driven = (77.0 - plain["driven_angle_deg"][part]) % 360.0
    rows = "\n".join(f"{a:.9f},{b:.9f}" for a, b in zip(driving, driven, strict=True))
    file = recording(
        tmp_path,
        "# driving_zero_deg = 200.0\n# driven_zero_deg = 77.0\n# driven_direction = -1\n"
        f"driving_angle_deg,driven_angle_deg\n{rows}\n",
    )
    ran = gearpoly_command("simulate", pair_file, "--at", file, "--csv", "-")
    assert ran.code == 0
    found = table(ran.out)
    # Readings of 1e-9 deg on both shafts; TE changes by 100 um per pitch at the very most.
    np.testing.assert_allclose(found["te_um"], plain["te_um"][part], atol=1e-5)
    np.testing.assert_allclose(found["backlash_um"], plain["backlash_um"][part], atol=1e-5)
    shift = found["driven_angle_deg"] - plain["driven_angle_deg"][part]
    # The turn of the hunting cycle, which wrapped readings of both shafts decide together; 18 driven turns.
    np.testing.assert_allclose(shift - 6480.0 * np.round(shift / 6480.0), 0.0, atol=2e-9)


def test_drop_outs_are_left_out_and_said(gearpoly_command: Command, pair_file: Path, tmp_path: Path) -> None:
    file = recording(
        tmp_path,
        "# driving_zero_deg = 0.0\n# driven_zero_deg = 0.0\n"
        "driving_angle_deg,driven_angle_deg\n0.0,0.0\n10.0,\n20.0,14.4\n",
    )
    ran = gearpoly_command("simulate", pair_file, "--at", file, "--json", "-")
    assert ran.code == 0
    document = json.loads(ran.out)
    assert document["summary"]["positions"] == 2
    assert any("1 drop-out" in remark for remark in document["remarks"])


def test_the_flank_of_the_recording_counts(gearpoly_command: Command, pair_file: Path, tmp_path: Path) -> None:
    head = '# driving_zero_deg = 0.0\n# driven_zero_deg = 0.0\n# flank = "coast"\n'
    file = recording(tmp_path, head + "driving_angle_deg,driven_angle_deg\n0,0\n10,7.2\n")
    own, drive = (
        json.loads(gearpoly_command("simulate", pair_file, "--at", file, "--json", "-", *more).out)
        for more in ((), ("--flank", "drive"))
    )
    assert (own["flank"], drive["flank"]) == ("coast", "drive")
    assert min(own["columns"]["te_um"]) > max(drive["columns"]["te_um"])


def thinned(source: Path, folder: Path, every: int) -> tuple[Path, dict[str, float], FloatArray]:
    """A recording thinned to each ``every``-th sample: its file, stated zeros and readings (n, 2) in deg.

    Samples lie 1 deg of the driving shaft apart, so ``every`` must share no factor with the 20 deg of a tooth, or all
    that is left falls on the same places of the mesh.
    """
    lines = source.read_text(encoding="utf-8").splitlines()
    head = [line for line in lines if line.startswith("#")]
    names, rows = lines[len(head)], lines[len(head) + 1 :: every]
    zeros = {}
    for line in head:
        key, _, value = line.strip("# ").partition(" = ")
        if key.endswith("zero_deg"):
            zeros[key] = float(value)
    columns = names.split(",")
    data = np.array([row.split(",") for row in rows], dtype=float)
    angles = data[:, [columns.index("driving_angle_deg"), columns.index("driven_angle_deg")]]
    return recording(folder, "\n".join([*head, names, *rows]) + "\n"), zeros, angles


def residual_um(ran: Ran, zeros: dict[str, float], angles: FloatArray) -> FloatArray:
    """Recorded less simulated TE in um; the recorded one from the readings themselves, known but for whole pitches."""
    theta = np.degrees(np.unwrap(np.radians(angles), axis=0))
    te = theta[:, 1] - zeros["driven_zero_deg"] - 18 / 25 * (theta[:, 0] - zeros["driving_zero_deg"])
    rest = np.radians(te) * R_B2 * 1e3 - table(ran.out)["te_um"]
    pitch = 2.0 * math.pi / 25 * R_B2 * 1e3
    return rest - pitch * np.round(np.median(rest) / pitch)


@pytest.mark.parametrize("folder", shipped_and_beside("healthy", "control_inspected"), ids=str)
def test_a_healthy_pair_leaves_its_noise(gearpoly_command: Command, tmp_path: Path, folder: Path) -> None:
    file, zeros, angles = thinned(folder / "rec_0.csv", tmp_path, 11)
    ran = gearpoly_command("simulate", folder / "pair.toml", "--at", file, "--csv", "-")
    assert ran.code == 0
    rest = residual_um(ran, zeros, angles)
    # 0.3 um of noise and 0.2 um of gauge noise leave 0.39 um of one and 0.42 um of the other at the best zeros; the
    # stated ones, 0.03 deg off, leave 0.01 more, and so few samples 0.01 of chance.
    assert np.std(rest) == pytest.approx(0.415, abs=0.03)
    # Zeros known to 0.05 deg: 20 um each, and their ratio.
    assert abs(np.mean(rest)) < 60.0


# Left by wrong conventions, um: signs reversed, numbers reversed, off by one, driven slopes reversed.
# The bench's are those of its own page; ours were found with the kernel of `gearpoly.proving`, which shares no code.
WRONG = {"control_inspected": (9.7, 9.0, 2.0, 1.2), "healthy": (12.88, 10.53, 2.48, 0.613)}


@pytest.mark.long
@pytest.mark.parametrize("folder", shipped_and_beside("healthy", "control_inspected"), ids=str)
def test_a_healthy_pair_refuses_other_conventions(gearpoly_command: Command, tmp_path: Path, folder: Path) -> None:
    file, zeros, angles = thinned(folder / "rec_0.csv", tmp_path, 15)
    pair = read_pair(folder / "pair.toml")

    def left(change: Callable[[str, list[float]], list[float]]) -> float:
        gears = {}
        for name in ("driving", "driven"):
            gear = getattr(pair, name)
            sheet = gear.inspection
            new = {
                key: tuple(change(f"{name}.{key}", list(getattr(sheet, key))))
                for key in ("pitch_um", "profile_slope_um")
            }
            gears[name] = gear.model_copy(update={"inspection": sheet.model_copy(update=new)})
        other = tmp_path / "other.toml"
        other.write_text(dump_pair(pair.model_copy(update=gears)), encoding="utf-8")
        return float(
            np.std(residual_um(gearpoly_command("simulate", other, "--at", file, "--csv", "-"), zeros, angles))
        )

    signs, numbers, off, slopes = WRONG[folder.name]
    # Some hundred samples and rounding of the figures: 10 %.
    assert left(lambda key, v: v) < 0.45
    assert left(lambda key, v: [-x for x in v]) == pytest.approx(signs, rel=0.1)
    assert left(lambda key, v: v[:1] + v[:0:-1]) == pytest.approx(numbers, rel=0.1)
    # Off by one on one of the gears.
    assert left(lambda key, v: v[1:] + v[:1] if key.startswith("driving") else v) == pytest.approx(off, rel=0.1)
    assert left(lambda key, v: [-x for x in v] if key == "driven.profile_slope_um" else v) == pytest.approx(
        slopes, rel=0.1
    )


needs_bench = pytest.mark.skipif(not BENCH.is_dir(), reason="the bench recordings of another rig are not here")


@pytest.mark.long
@needs_bench
def test_true_eccentricity_explains_its_case(gearpoly_command: Command, tmp_path: Path) -> None:
    name = "ecc_under_pitch"
    file, zeros, angles = thinned(BENCH / name / "rec_0.csv", tmp_path, 17)
    pair = BENCH / name / "pair.toml"
    truth = json.loads((BENCH / f"{name}.truth.json").read_text(encoding="utf-8"))["truth"][0]
    corrected = tmp_path / "corrected.toml"
    text = pair.read_text(encoding="utf-8")
    gear = "driving" if truth["gear"] == 1 else "driven"
    assert f"[{gear}.eccentricity]" not in text
    corrected.write_text(
        f"{text}\n[{gear}.eccentricity]\namplitude_um = {truth['amplitude_um']}\nangle_deg = {truth['angle_deg']}\n"
    )
    before, after = (
        float(np.std(residual_um(gearpoly_command("simulate", p, "--at", file, "--csv", "-"), zeros, angles)))
        for p in (pair, corrected)
    )
    # 0.44 um at the best zeros; the stated ones cost 0.01, 1000 samples leave 0.02 of chance.
    assert before == pytest.approx(3.75, abs=0.08)
    assert after == pytest.approx(0.44, abs=0.03)


@needs_bench
def test_coast_flank_meets_the_next_tooth(gearpoly_command: Command, tmp_path: Path) -> None:
    name = "encoder_ecc"
    file, zeros, angles = thinned(BENCH / name / "rec_1.csv", tmp_path, 17)
    ran = gearpoly_command("simulate", BENCH / name / "pair.toml", "--at", file, "--csv", "-")
    assert ran.code == 0
    rest = residual_um(ran, zeros, angles)
    turn = np.radians(angles[:, 0])
    wave = np.column_stack((np.ones_like(turn), np.cos(turn), np.sin(turn)))
    fit = np.linalg.lstsq(wave, rest, rcond=None)[0]
    truth = json.loads((BENCH / f"{name}.truth.json").read_text(encoding="utf-8"))["truth"][0]
    # The hidden encoder error, once a turn of the driving shaft; with it gone 0.39 um are left.
    amplitude = float(np.hypot(fit[1], fit[2])) / (18.0 * math.cos(math.radians(20.0))) * 1e3
    assert amplitude == pytest.approx(truth["amplitude_urad"], rel=0.02)
    assert np.std(rest - wave @ fit) == pytest.approx(0.39, abs=0.03)


# What it refuses: exit 2, one message, nothing written.
