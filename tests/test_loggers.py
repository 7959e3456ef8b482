"""What loggers of benches write: time stamps, cut-off segments, structs within structs, objects, counters, repeats."""

from __future__ import annotations

import importlib
import json
import math
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.units import DEG, FloatArray
from tests import recording_files as files
from tests.made_command import Command
from tests.made_readings import needs, refusal
from tests.test_readers_mat5 import element, mat5, matrix

TURN = 2.0 * math.pi
N = 400
COLUMNS: dict[str, FloatArray] = {
    "time_s": 0.25 * np.arange(N),
    "driving_angle_deg": 3.0 * np.arange(N),
    "driven_angle_deg": 2.0 * np.arange(N),
}


# TDMS


def write_tdms(file: Path, *segments: Mapping[str, Any]) -> None:
    nptdms = importlib.import_module("nptdms")
    with nptdms.TdmsWriter(file) as writer:
        for held in segments:
            writer.write_segment([nptdms.ChannelObject("rig", name, values) for name, values in held.items()])


def stamps(count: int = N) -> Any:
    return np.datetime64("2026-03-01T23:59:59", "us") + np.arange(count) * np.timedelta64(250_000, "us")


@needs("nptdms")
@pytest.mark.parametrize("name", ["time_s", "Zeit"])
def test_a_channel_of_time_stamps_is_the_time(tmp_path: Path, name: str) -> None:
    """Stamps every 250 ms across midnight are seconds since the first; the only channel of stamps may be called
    anything."""
    file = tmp_path / "rec.tdms"
    write_tdms(file, {name: stamps(), **{key: COLUMNS[key] for key in ("driving_angle_deg", "driven_angle_deg")}})
    read = read_recording(file)
    np.testing.assert_allclose(read.time_s, COLUMNS["time_s"], rtol=0.0, atol=1e-9)
    assert any("time stamps in Zeit" in one for one in read.remarks) == (name == "Zeit")


@needs("nptdms")
def test_a_last_segment_that_was_cut_off_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    """Three segments of 400 samples; without its last 1000 bytes the third lacks 125 values of its last channel.
    LabVIEW leaves -1 for the length of a segment that it had no time to finish."""
    file = tmp_path / "rec.tdms"
    write_tdms(file, *({name: values + k * N for name, values in COLUMNS.items()} for k in range(3)))
    whole = bytearray(file.read_bytes())
    last = whole.rindex(b"TDSm")
    for unfinished in (False, True):
        cut = whole[:-1000]
        if unfinished:
            cut[last + 12 : last + 20] = b"\xff" * 8
        file.write_bytes(cut)
        read = read_recording(file)
        assert read.size == 3 * N - 125
        assert read.driving_angle_rad is not None
        np.testing.assert_allclose(read.driving_angle_rad[-1] / DEG, 3.0 * (N - 126) + 2 * N)
        assert any(f"read as far as it goes, {3 * N - 125} samples" in one for one in read.remarks)


@needs("pyarrow")
def test_time_stamps_of_parquet(tmp_path: Path) -> None:
    """With a zone and a gap: seconds since the first, nan where there is none."""
    pa, parquet = (importlib.import_module(name) for name in ("pyarrow", "pyarrow.parquet"))
    file = tmp_path / "rec.parquet"
    times = pa.array(stamps()).cast(pa.timestamp("ns", tz="Europe/Berlin"))
    times = pa.concat_arrays([times.slice(0, 7), pa.array([None], times.type), times.slice(8)])
    columns = {name: pa.array(COLUMNS[name]) for name in ("driving_angle_deg", "driven_angle_deg")}
    parquet.write_table(pa.table({"time_s": times, **columns}), file)
    read = read_recording(file)
    assert read.time_s is not None
    assert np.flatnonzero(np.isnan(read.time_s)).tolist() == [7]
    np.testing.assert_allclose(np.delete(read.time_s, 7), np.delete(COLUMNS["time_s"], 7), rtol=0.0, atol=1e-9)


@needs("pyarrow")
@pytest.mark.parametrize("kind", ["timestamp", "duration"])
def test_the_only_clock_of_parquet_has_any_name(tmp_path: Path, kind: str) -> None:
    """pandas calls an index that has no name so; its times went unread."""
    pa, parquet = (importlib.import_module(name) for name in ("pyarrow", "pyarrow.parquet"))
    file = tmp_path / "rec.parquet"
    times = pa.array(stamps()) if kind == "timestamp" else pa.array(stamps() - stamps()[0])
    names = {"driving_angle_deg": "input angle [deg]", "driven_angle_deg": "output angle [deg]"}
    columns = {new: pa.array(COLUMNS[name]) for name, new in names.items()}
    parquet.write_table(pa.table({**columns, "__index_level_0__": times}), file)
    read = read_recording(file)
    assert read.time_s is not None
    np.testing.assert_allclose(read.time_s, COLUMNS["time_s"] - COLUMNS["time_s"][0], rtol=0.0, atol=1e-9)
    assert any("the only time stamps" in one for one in read.remarks)


@needs("h5py")
def test_columns_of_a_matrix_are_asked_for(tmp_path: Path) -> None:
    """Both angles in one dataset, of which nothing says which is which."""
    h5py = importlib.import_module("h5py")
    both = np.column_stack([COLUMNS["driving_angle_deg"], COLUMNS["driven_angle_deg"]])
    with h5py.File(tmp_path / "rec.h5", "w") as file:
        file["angles"], file["time_s"] = both, COLUMNS["time_s"]
    error = refusal(tmp_path / "rec.h5")
    assert error.where == 'columns "angles (column 1)" and "angles (column 2)"'
    assert 'columns.driven_angle_deg = { from = "angles (column 2)", unit = "deg" }' in error.wish


# MATLAB


def test_channels_whose_names_stand_beside_their_numbers(tmp_path: Path) -> None:
    """A capture of dSPACE: one time, and each channel a struct with its path in the model."""
    scipy_io = importlib.import_module("scipy.io")
    fields = [("Name", "O"), ("Unit", "O"), ("Data", "O")]
    time, angles = np.zeros(1, dtype=fields), np.zeros(2, dtype=fields)
    time[0] = ("time", "s", COLUMNS["time_s"][None, :])
    for k, (called, column) in enumerate((("Angle In", "driving_angle_deg"), ("Angle Out", "driven_angle_deg"))):
        angles[k] = (f"Model Root/Encoder/{called}", "deg", COLUMNS[column][None, :])
    scipy_io.savemat(tmp_path / "rec.mat", {"exp_001": {"X": time, "Y": angles, "Description": "spindle"}})
    read = read_recording(tmp_path / "rec.mat")
    assert read.driving_angle_rad is not None and read.driven_angle_rad is not None and read.time_s is not None
    np.testing.assert_array_equal(read.time_s, COLUMNS["time_s"])
    np.testing.assert_allclose(read.driving_angle_rad / DEG, COLUMNS["driving_angle_deg"], rtol=1e-14)
    np.testing.assert_allclose(read.driven_angle_rad / DEG, COLUMNS["driven_angle_deg"], rtol=1e-14)


def nested(depth: int) -> dict[str, Any]:
    held: dict[str, Any] = {name: values[:, None] for name, values in COLUMNS.items()} | {"keys": {"torque_nm": 7.0}}
    for name in ("run", "test", "rig")[:depth]:
        held = {name: held}
    return held


@pytest.mark.parametrize("depth", [1, 2, 3])
def test_structs_within_structs_of_mat_5(tmp_path: Path, depth: int) -> None:
    """rig.test.run.time_s, with the keys beside the columns."""
    file = tmp_path / "rec.mat"
    importlib.import_module("scipy.io").savemat(file, nested(depth) | {"operator": "nobody"})
    read = read_recording(file)
    assert read.size == N
    assert read.torque_nm == 7.0


def test_two_recordings_in_one_struct_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "rec.mat"
    importlib.import_module("scipy.io").savemat(file, {"rig": {"a": nested(0), "b": nested(0)}})
    assert '"rig.a.driving_angle_deg" and "rig.b.driving_angle_deg" may each be' in refusal(file).found


@needs("h5py")
@pytest.mark.parametrize("suffix", [".h5", ".mat"])
def test_groups_within_groups(tmp_path: Path, suffix: str) -> None:
    file = tmp_path / f"rec{suffix}"
    h5py = importlib.import_module("h5py")
    with h5py.File(file, "w", userblock_size=512 if suffix == ".mat" else 0) as root:
        inner = root.create_group("rig/test/run")
        for name, values in COLUMNS.items():
            inner.create_dataset(name, data=values)
        other = root.create_group("rig/notes")
        other.create_dataset("text", data=np.arange(3.0))
    if suffix == ".mat":
        with file.open("r+b") as stream:
            stream.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")
    read = read_recording(file)
    np.testing.assert_array_equal(read.time_s, COLUMNS["time_s"])


def opaque(name: str, kind: str) -> bytes:
    """A variable of an object as MATLAB writes it: flags, name, "MCOS", class, and a reference into the file's end."""
    body = element(6, struct.pack("<II", 17, 0))
    body += b"".join(element(1, word.encode()) for word in (name, "MCOS", kind))
    return element(14, body + matrix("", np.arange(6, dtype="<u4"), kind=13, stored=6))


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "cure"),
    [
        ("table", "S = table2struct(T, 'ToScalar', true); save('recording.mat', '-struct', 'S')"),
        ("timetable", "S.time_s = seconds(T.Properties.RowTimes - T.Properties.RowTimes(1))"),
        ("MyOwnClass", "save('recording.mat', '-struct', 'S')"),
    ],
)
def test_a_table_of_mat_5_is_told_with_the_line_that_opens_it(tmp_path: Path, kind: str, cure: str) -> None:
    file = tmp_path / "rec.mat"
    for gain in (np.arange(1.0), np.arange(3.0)):
        file.write_bytes(mat5(matrix("gain", gain), opaque("T", kind)))
        error = refusal(file)
        assert f"T, a {kind}, " in error.found
        assert cure in error.wish
    # Beside columns an object is no matter.
    good = [matrix(name, values) for name, values in COLUMNS.items()]
    file.write_bytes(mat5(*good, opaque("T", kind)))
    assert read_recording(file).size == N


@needs("h5py")
def test_a_table_of_mat_73_is_told_too(tmp_path: Path) -> None:
    file = tmp_path / "rec.mat"
    h5py = importlib.import_module("h5py")
    with h5py.File(file, "w", userblock_size=512) as root:
        held = root.create_dataset("log", data=np.arange(6, dtype="u4"))
        held.attrs["MATLAB_class"] = np.bytes_("timetable")
        held.attrs["MATLAB_object_decode"] = np.int32(3)
    with file.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")
    error = refusal(file)
    assert "log, a timetable, " in error.found
    assert "timetable2table(log, 'ConvertRowTimes', false)" in error.wish


# counters


def counted(folder: Path, count: FloatArray, keys: dict[str, object]) -> Recording:
    file = folder / "rec.mat"
    t = np.arange(count.size) / 500.0
    angle = 0.72 * 360.0 * 0.8 * t
    stated = {"driving_lines": 5000, "driving_counts_per_line": 4} | keys
    files.write_mat5(file, {"time_s": t, "driving_count": count, "driven_angle_deg": angle}, stated, packed=False)
    return read_recording(file)


def turned(samples: int = 6000) -> FloatArray:
    """Counts of an encoder with 20 000 of them a turn, at 0.8 turns a second and 500 samples a second."""
    t = np.arange(samples) / 500.0
    return np.floor(20_000 * (0.8 * t + 0.01 * np.sin(3.0 * t)))


def check_turns(read: Recording, count: FloatArray, *, within: float = 1.0) -> None:
    assert read.driving_angle_rad is not None
    off = read.driving_angle_rad / TURN * 20_000 - count
    assert np.ptp(off) <= within + 1e-6


@pytest.mark.parametrize(
    ("modulus", "low"),
    [(36_000, 0), (20_000, 0), (2**16, 0), (2**16, -(2**15)), (2**15, 0), (60_000, -12_345), (1_000_003, -5)],
)
def test_a_counter_goes_round_at_any_number(tmp_path: Path, modulus: int, low: int) -> None:
    """Stated, it is undone whatever it is, below zero too; forth and back."""
    for count in (turned(), -turned()):
        around = np.mod(count - low, modulus) + low
        check_turns(counted(tmp_path, around, {"driving_count_modulus": modulus}), count)


@pytest.mark.parametrize(("modulus", "low"), [(20_000, 0), (40_000, -20_000), (2**16, -(2**15)), (2**12, 0)])
def test_what_a_counter_goes_round_at_is_found_where_nobody_says_so(tmp_path: Path, modulus: int, low: int) -> None:
    """Whole turns of 20 000 counts, and powers of two: 4096 go round five times a turn."""
    around = np.mod(turned() - low, modulus) + low
    read = counted(tmp_path, around, {})
    check_turns(read, turned())
    assert any(f"state driving_count_modulus = {modulus} to be sure" in one for one in read.remarks)


@pytest.mark.parametrize("bits", [18, 24, 32])
def test_the_number_that_is_told_is_the_one_to_state(tmp_path: Path, bits: int) -> None:
    """The line of the remark, stated as it is told, gives the counts: of 24 bits 16777216, and no 1.67772e+07."""
    count = turned()
    around = np.mod(count - 5_000.0, 2.0**bits)
    told = next(one for one in counted(tmp_path, around, {}).remarks if "goes round" in one)
    assert f"goes round at {2**bits}, " in told
    assert f"state driving_count_modulus = {2**bits} to be sure" in told
    check_turns(counted(tmp_path, around, {"driving_count_modulus": int(told.split(" = ")[1].split()[0])}), count)


def test_a_counter_that_the_index_sets_back_may_have_lost_counts(tmp_path: Path) -> None:
    """Three counts are lost within the second turn; from the next index on the reading is right again."""
    count = turned()
    lost = count - 3.0 * (np.mod(count, 20_000) > 8_000) * (count // 20_000 == 1)
    read = counted(tmp_path, np.mod(lost, 20_000), {})
    check_turns(read, count, within=3.0)
    assert read.driving_angle_rad is not None
    after = count > 45_000
    off = read.driving_angle_rad[after] / TURN * 20_000 - count[after]
    assert np.ptp(off) <= 1e-6


def test_a_jump_that_no_counter_makes_is_refused_with_a_cure_that_works(tmp_path: Path) -> None:
    around = np.mod(turned(), 36_000)
    with pytest.raises(InputFileError, match=r"driving_count_modulus, about (3600|3599)\d") as raised:
        counted(tmp_path, around, {})
    assert "a jump by" in str(raised.value)
    check_turns(counted(tmp_path, around, {"driving_count_modulus": 36_000}), turned())


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ({"driving_count_modulus": 65_536, "driving_count_bits": 16}, "want one of the two"),
        ({"driving_count_modulus": 1}, "a whole number from 2"),
        ({"driving_count_modulus": 100.5}, "a whole number from 2"),
        ({"driving_count_modulus": 50}, "want at most a quarter of its 50"),
    ],
)
def test_a_modulus_that_cannot_be_is_one_message(tmp_path: Path, keys: dict[str, object], says: str) -> None:
    with pytest.raises(InputFileError, match=says):
        counted(tmp_path, turned(), keys)


# repeats


@pytest.mark.long
def test_readings_published_faster_than_read_make_no_ghost(tmp_path: Path, gearpoly_command: Command) -> None:
    """An ideal pair read 20 times a mesh, each reading published five times: told, and nothing located."""
    rng = np.random.default_rng(4)
    theta_1 = np.cumsum(rng.uniform(0.9, 1.1, 9000)) * (360.0 / 18 / 20)
    theta_2 = theta_1 * 18 / 25 + np.degrees(rng.normal(0.0, 0.3e-3 / 23.5, theta_1.size))
    time = np.arange(5 * theta_1.size) * 1e-3
    table = np.column_stack((time, np.repeat(theta_1, 5), np.repeat(theta_2, 5)))
    recording, pair, out = tmp_path / "rec.csv", tmp_path / "pair.toml", tmp_path / "out.json"
    head = "time_s,driving_angle_deg,driven_angle_deg"
    np.savetxt(recording, table, delimiter=",", header=head, comments="", fmt="%.7f")
    pair.write_text("[driving]\nteeth = 18\nmodule_mm = 2\n[driven]\nteeth = 25\nmodule_mm = 2\n", encoding="utf-8")
    ran = gearpoly_command("compare", pair, recording, "--json", out)
    assert ran.code == 0, ran.err
    told = json.loads(out.read_text(encoding="utf-8"))
    assert told["where"] == []
    assert told["recordings"][0]["samples"] == theta_1.size
    assert "repeat the one before" in ran.out
