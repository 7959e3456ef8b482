"""Columns that state one thing twice: taken where they agree to their rounding, refused by row where they do not."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.agreement import rounding
from gearpoly.recording.clean import clean
from gearpoly.recording.read import read_recording
from tests import recording_files as files
from tests.made_command import PAIR, Command
from tests.recording_files import FloatArray

RATIO, R_B2, TURN = 18.0 / 25.0, 23.49, 2.0 * math.pi
LINES, RATE = 100, 2000.0
SHAFTS = ("driving", "driven")
COUNTS: dict[str, object] = {f"{s}_{key}": n for s in SHAFTS for key, n in (("lines", LINES), ("counts_per_line", 4))}


def run(turns: float = 3.0) -> dict[str, FloatArray]:
    """A steady run at one turn a second with 20 um of eccentricity: everything that can be stated of it."""
    n = int(turns * RATE)
    t = (np.arange(n) + np.random.default_rng(2).uniform(-0.3, 0.3, n) + 1.0) / RATE  # even samples look rounded
    theta_1 = TURN * t
    te = 20e-3 / R_B2 * np.sin(theta_1)
    theta_2 = RATIO * theta_1 + te
    held = {
        "time_s": t,
        "driving_angle_deg": np.degrees(theta_1) % 360.0,
        "driven_angle_deg": np.degrees(theta_2) + 12.0,
        "te_um": 1e3 * R_B2 * te,
        "te_urad": 1e6 * te,
        "te_arcsec": np.degrees(te) * 3600.0,
    }
    for shaft, theta in (("driving", theta_1), ("driven", theta_2)):
        held[f"{shaft}_a"] = (np.mod(LINES * theta, TURN) < math.pi).astype(float)
        held[f"{shaft}_b"] = (np.mod(LINES * theta - 0.5 * math.pi, TURN) < math.pi).astype(float)
        held[f"{shaft}_index"] = (np.mod(theta, TURN) < TURN / LINES).astype(float)
        held[f"{shaft}_count"] = np.floor(4 * LINES * theta / TURN)
    return held


WRITTEN = {"exact": lambda x: x, "decimals": lambda x: np.round(x, 4), "single": lambda x: np.float64(np.float32(x))}


@pytest.mark.parametrize("written", WRITTEN)
@pytest.mark.parametrize("te", [("te_um",), ("te_urad",), ("te_arcsec",), ("te_um", "te_urad", "te_arcsec")])
def test_angles_of_both_shafts_and_their_transmission_error(tmp_path: Path, written: str, te: tuple[str, ...]) -> None:
    made = {name: WRITTEN[written](values) for name, values in run().items()}
    held = {name: made[name] for name in ("time_s", "driving_angle_deg", "driven_angle_deg", *te)}
    file = tmp_path / "rig.csv"
    files.write_csv(file, held, {})
    assert clean(read_recording(file), ratio=RATIO, r_b2=R_B2).size == made["time_s"].size
    # Ten times what rounding makes: 1e-4 deg of both shafts are 1.5 urad, 4 bytes at 1000 deg are 1 urad.
    held[te[0]] = held[te[0]].copy()
    held[te[0]][777] += {"te_um": 0.3, "te_urad": 20.0, "te_arcsec": 4.0}[te[0]]
    files.write_csv(file, held, {})
    with pytest.raises(InputFileError) as caught:
        clean(read_recording(file), ratio=RATIO, r_b2=R_B2)
    assert caught.value.where == "row 778"
    assert te[0] in caught.value.found
    assert "leave one of them out" in caught.value.wish


def test_a_transmission_error_in_um_of_another_base_radius(tmp_path: Path) -> None:
    made = run()
    file = tmp_path / "rig.csv"
    files.write_csv(file, {name: made[name] for name in ("driven_angle_deg", "te_um", "te_urad")}, {})
    assert clean(read_recording(file), ratio=RATIO, r_b2=R_B2).size
    with pytest.raises(InputFileError, match=r"te_um and te_urad times the driven base radius 24 mm differ by 0\.43"):
        clean(read_recording(file), ratio=RATIO, r_b2=24.0)  # 20 um (24/23.49 - 1)


WAYS = [("angle_deg",), ("a",), ("a", "b"), ("a", "b", "index"), ("count",), ("count", "index"), ("index",)]
DOUBLED = [
    (one, other)
    for one, other in itertools.combinations(WAYS, 2)
    if not set(one) & set(other) and ("angle_deg" in one or "index" not in other[:1])
]


@pytest.mark.parametrize("shaft", SHAFTS)
@pytest.mark.parametrize(("one", "other"), DOUBLED)
def test_an_angle_beside_channels_of_the_same_shaft(
    tmp_path: Path, shaft: str, one: tuple[str, ...], other: tuple[str, ...]
) -> None:
    """Every pair of ways to one angle is taken where it agrees, and refused with its row where it does not."""
    made = run()
    mate = "driven" if shaft == "driving" else "driving"
    names = ["time_s", f"{mate}_angle_deg", *(f"{shaft}_{part}" for part in (*one, *other))]
    file = tmp_path / "rig.mat"
    files.write_mat5(file, {name: made[name] for name in names}, COUNTS)
    recording = read_recording(file)
    angle = recording.driving_angle_rad if shaft == "driving" else recording.driven_angle_rad
    time = recording.time_s
    assert angle is not None and time is not None
    truth = np.interp(time, made["time_s"], np.radians(np.unwrap(made[f"{shaft}_angle_deg"], period=360.0)))
    off = np.unwrap(angle) - truth
    assert np.ptp(off) < TURN / (4 * LINES) + TURN / RATE  # a count, and the way of one sample
    if other == ("index",):
        return  # it says where a turn begins, and nothing of the angle between
    bad = {name: made[name].copy() for name in names}
    spoilt = one[0] if one[0] == "angle_deg" or "count" not in other else "count"
    spoilt = f"{shaft}_{spoilt}"
    bad[spoilt][1500:] = bad[spoilt][1400:-100]  # a hundred samples lost: 18 deg, or 13
    files.write_mat5(file, bad, COUNTS)
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    assert caught.value.where.startswith("row ")
    assert spoilt in caught.value.found


def test_an_interpolated_shaft_leaves_no_rounding_to_agree_to(tmp_path: Path) -> None:
    made = run()
    held = {name: made[name] for name in ("time_s", "driving_a", "driving_b", "driven_angle_deg", "te_um")}
    file = tmp_path / "rig.mat"
    files.write_mat5(file, held, COUNTS)
    with pytest.raises(InputFileError, match="want two of them; leave one out"):
        read_recording(file)


def test_a_wrapped_angle_is_interpolated_across_its_wrap(tmp_path: Path) -> None:
    """The edges of the other shaft fall between samples of 359.9 and 0.1 deg, whose middle is not 180."""
    made = run()
    held = {name: made[name] for name in ("time_s", "driving_angle_deg", "driven_a", "driven_b")}
    file = tmp_path / "rig.mat"
    files.write_mat5(file, held, COUNTS)
    got = read_recording(file)
    assert got.driving_angle_rad is not None and got.time_s is not None
    off = np.mod(got.driving_angle_rad - TURN * got.time_s + math.pi, TURN) - math.pi
    np.testing.assert_allclose(off, 0.0, atol=1e-9)  # a straight line between samples is the truth here


@pytest.mark.long
def test_what_simulate_writes_is_read_back(tmp_path: Path, gearpoly_command: Command) -> None:
    """Its own CSV: both angles, the error twice, and two columns that only a simulation has."""
    pair, table, compared = tmp_path / "pair.toml", tmp_path / "run.csv", tmp_path / "where.json"
    pair.write_text(PAIR, encoding="utf-8")
    assert gearpoly_command("simulate", pair, "--csv", table, "--turns", "2", "--points-per-mesh", "10").code == 0
    recording = read_recording(table)
    assert any("backlash_um passed over" in remark for remark in recording.remarks)
    assert any("contact_pairs passed over" in remark for remark in recording.remarks)
    ran = gearpoly_command("compare", pair, table, "--json", compared)
    assert ran.code == 0, ran.err
    assert "backlash_um passed over" in compared.read_text(encoding="utf-8")


def test_the_last_place_is_seen_from_the_digits() -> None:
    rng = np.random.default_rng(1)
    x = rng.uniform(-360.0, 360.0, 3000)
    assert rounding(np.round(x, 3)).max() == pytest.approx(0.5e-3, rel=1e-12)
    six = np.array([float(f"{v:.6g}") for v in x])
    assert (np.abs(six - x) <= rounding(six) * (1.0 + 1e-6)).all()
    assert rounding(six).max() == pytest.approx(0.5e-3, rel=1e-12)
    single = np.float64(np.float32(x))
    assert (np.abs(single - x) <= rounding(single)).all()
    step = 360.0 / 4096.0
    assert rounding(np.floor(x / step) * step).max() == pytest.approx(0.5 * step, rel=1e-9)
    assert rounding(x).max() < 1e-12
    assert rounding(np.array([math.nan, 0.0])).tolist()[1] == 0.0
    assert rounding(np.full(3, math.nan)).size == 3
