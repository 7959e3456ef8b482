"""Recordings in every format: the same numbers come out, and bad files are refused with a cure."""

from __future__ import annotations

import importlib
import importlib.util
import math
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearpoly.errors import InputFileError, MissingExtraError
from gearpoly.recording import reader
from gearpoly.recording.read import find_reader, read_recording, readers
from gearpoly.recording.recording import Recording
from tests import recording_files as files
from tests.at_hand import SHARED, SHIPPED, here
from tests.made_readings import ARRAYS, EVERY, FORMATS, KEYS, N, columns, needs, refusal, write


@pytest.mark.parametrize("name", EVERY)
def test_the_same_recording_comes_out_of_every_format(tmp_path: Path, name: str) -> None:
    got = read_recording(write(tmp_path, name))
    want = columns()
    scale = {"time_s": 1.0, "torque_samples_nm": 1.0}
    for array, column in zip(ARRAYS, want, strict=True):
        expected = want[column] * scale.get(array, math.pi / 180.0)
        found = getattr(got, array)
        assert found.dtype == np.float64
        assert not found.flags.writeable
        if name == "uff text":  # E20.11: twelve digits, rounded
            np.testing.assert_allclose(found, expected, rtol=6e-12, atol=0.0)
        else:
            np.testing.assert_array_equal(found, expected)  # bit by bit, drop-outs included
    assert (got.torque_nm, got.speed_rpm, got.flank) == (25.5, 30.0, "coast")
    assert (got.driving_direction, got.driven_direction) == (1, -1)
    # The product with pi/180 is rounded once, here and there.
    assert got.driving_zero_rad == pytest.approx(math.radians(159.2), rel=4e-16)
    assert got.driven_zero_rad == pytest.approx(math.radians(-132.4), rel=4e-16)
    assert got.source == tmp_path / FORMATS[name][0]


@pytest.mark.parametrize("name", EVERY)
def test_transmission_error_needs_one_angle_only(tmp_path: Path, name: str) -> None:
    held = {"driven_angle_deg": np.arange(1.0, 8.0), "te_um": np.linspace(-3.0, 3.0, 7)}
    got = read_recording(write(tmp_path, name, held, {}))
    assert got.te_mm is not None
    # One rounding by 1e-3, and twelve digits in text.
    np.testing.assert_allclose(got.te_mm, 1e-3 * held["te_um"], rtol=6e-12, atol=0.0)
    assert got.time_s is got.driving_angle_rad is None
    assert (got.torque_nm, got.flank) == (None, "drive")


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize(
    ("change", "found"),
    [
        ({"driven_angle_deg": None}, "no column driven_angle_deg"),
        ({"driven_angle_deg": None, "driven_angle": "driven_angle_deg"}, '"driven_angle"'),
        ({"te_arcsec": "time_s", "te_urad": "time_s"}, "te_urad and te_arcsec"),
        ({"driving_count": "time_s"}, "driving_lines"),
        ({"driving_angle_deg": None, "driving_b": "time_s"}, "driving_b"),
    ],
)
def test_columns_that_do_not_suffice(tmp_path: Path, name: str, change: dict[str, str | None], found: str) -> None:
    given_columns = columns()
    held = {key: value for key, value in given_columns.items() if change.get(key, "") is not None}
    held |= {key: given_columns[source] for key, source in change.items() if source is not None}
    error = refusal(write(tmp_path, name, held))
    assert found in str(error)


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize(
    ("key", "value", "wish"),
    [
        ("torque_nm", "25 N.m", "a torque in N.m"),
        ("torque_nm", -1.0, "0 or more"),
        ("flank", "left", '"drive" or "coast"'),
        ("driving_zero", 3.0, '"driving_zero_deg"'),
    ],
)
def test_headers_that_lie(tmp_path: Path, name: str, key: str, value: object, wish: str) -> None:
    error = refusal(write(tmp_path, name, columns(), {key: value}))
    assert wish in error.wish
    assert key in error.found


@pytest.mark.parametrize("name", [one for one in EVERY if "csv" not in one.values and "parquet" not in one.values])
def test_unequal_lengths(tmp_path: Path, name: str) -> None:
    held = columns()
    held["torque_nm"] = held["torque_nm"][:-1]
    assert f"torque_nm: {N - 1}" in refusal(write(tmp_path, name, held)).found


@pytest.mark.parametrize("name", EVERY)
def test_empty_and_infinite(tmp_path: Path, name: str) -> None:
    file = write(tmp_path, name)
    file.write_bytes(b"")
    assert refusal(file).found == "an empty file"
    held = columns()
    held["time_s"][3] = math.inf
    error = refusal(write(tmp_path, name, held))
    assert "inf" in error.found
    assert "time_s" in error.where


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.9, 0.999])
def test_cut_off_files_are_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str], name: str, share: float) -> None:
    file = write(tmp_path, name)
    data = file.read_bytes()
    file.write_bytes(data[: int(share * len(data))])
    if name == "csv":  # a table that ends between two rows is whole, as far as anyone can see
        file.write_bytes(data[: data.index(b",", int(share * len(data)))])
    # LabVIEW was stopped in its last segment, or a logger in a row: what every channel holds is there.
    stopped = {"tdms": share >= 0.9, "csv": share != 0.3}  # 295 of these rows hold 4 turns if they were rad, and say so
    if stopped.get(name):
        cut = read_recording(file)
        assert 0 < cut.size < N
        assert any("cut off" in remark or "breaks off" in remark for remark in cut.remarks)
    else:
        refusal(file)
    assert capfd.readouterr() == ("", "")  # the libraries keep quiet; the error says it all


@pytest.mark.long
@pytest.mark.parametrize("name", [one for one in EVERY if "csv" not in one.values])
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_a_damaged_file_is_read_or_refused(name: str, data: st.DataObject) -> None:
    # HDF5 and Parquet are left to libraries in C; what counts here is that nothing but our errors comes out.
    with tempfile.TemporaryDirectory() as folder:
        file = write(Path(folder), name)
        whole = file.read_bytes()
        start = data.draw(st.integers(0, len(whole)) | st.integers(0, 600))
        stop = data.draw(st.integers(start, min(len(whole), start + 30)))
        file.write_bytes(whole[:start] + data.draw(st.binary(max_size=30)) + whole[stop:])
        try:
            assert read_recording(file).size >= 1
        except InputFileError as error:
            assert error.wish


def test_readers_are_found_by_their_modules() -> None:
    found = readers()
    names = [one.name for one in found]
    modules = list(Path(reader.__file__).parent.glob("*_reader.py"))
    assert len(set(names)) == len(names) >= len(modules)
    assert {"HDF5", "MAT 5", "MAT 7.3", "Parquet", "PHD2 guide log", "TDMS", "UFF58"} < set(names)
    assert names[-1] == "CSV"  # it takes any text, so it is asked last
    endings = [ending for one in found for ending in one.endings]
    assert sorted(ending for ending in set(endings) if endings.count(ending) > 1) == [".log", ".mat", ".txt"]
    assert all(ending.startswith(".") and ending.islower() for ending in endings)
    assert all(bool(one.module) == bool(one.extra) for one in found)


@pytest.mark.parametrize("name", EVERY)
def test_content_decides_where_the_ending_says_nothing(tmp_path: Path, name: str) -> None:
    file = write(tmp_path, name)
    other = file.rename(tmp_path / "rec.dat")
    assert read_recording(other).size == N


@pytest.mark.parametrize("name", EVERY)
def test_an_ending_that_lies_is_refused_by_name(tmp_path: Path, name: str) -> None:
    file = write(tmp_path, name)
    lie = ".tdms" if "tdms" not in name else ".mat"
    error = refusal(file.rename(file.with_suffix(lie)))
    assert lie in error.found
    assert "ending" in error.wish


def test_a_text_file_named_mat(tmp_path: Path) -> None:
    file = tmp_path / "rec.mat"
    files.write_csv(file, columns(), KEYS)
    error = refusal(file)
    assert "text" in error.found
    assert ".csv" in error.wish
    file.write_bytes(b"\0" * 4096)
    assert "no MAT 5 or MAT 7.3 file" in refusal(file).found


def test_unknown_format_and_no_file(tmp_path: Path) -> None:
    file = tmp_path / "rec.bin"
    file.write_bytes(bytes(range(256)) * 20)
    assert "not known" in refusal(file).found
    with pytest.raises(InputFileError, match="no such file"):
        read_recording(tmp_path / "absent.h5")
    with pytest.raises(InputFileError, match="a folder"):
        read_recording(tmp_path)
    huge = tmp_path / "huge.h5"
    with huge.open("wb") as stream:
        stream.truncate(reader.RECORDING_LIMIT_BYTES + 1)  # sparse: takes no room
    with pytest.raises(InputFileError, match="larger than 4 GB"):
        read_recording(huge)


@pytest.mark.parametrize(
    ("name", "module", "extra"),
    [
        pytest.param("parquet", "pyarrow.parquet", "parquet", marks=needs("pyarrow")),
        pytest.param("hdf5 root", "h5py", "hdf5", marks=needs("h5py")),
        pytest.param("mat73", "h5py", "hdf5", marks=needs("h5py")),
        pytest.param("tdms", "nptdms", "tdms", marks=needs("nptdms")),
    ],
)
def test_a_missing_package_names_its_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, module: str, extra: str
) -> None:
    file = write(tmp_path, name)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match=rf"pip install gearpoly\[{extra}\]"):
        read_recording(file)


@needs("pyarrow")
def test_a_pyarrow_that_unpickles_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = write(tmp_path, "parquet")
    monkeypatch.setattr("pyarrow.__version__", "14.0.0")
    with pytest.raises(MissingExtraError, match="pyarrow 15 or later"):
        read_recording(file)


@pytest.mark.long
def test_recordings_survive_every_format(tmp_path: Path) -> None:
    for source in here(SHIPPED / "healthy" / "rec_0.csv", SHARED / "telescope" / "log01_as_eq6.csv"):
        want = read_recording(source)
        held: dict[str, npt.NDArray[np.float64]] = {}
        for field, name, unit in [
            ("time_s", "time_s", 1.0),
            ("driving_angle_rad", "driving_angle_deg", 180.0 / math.pi),
            ("driven_angle_rad", "driven_angle_deg", 180.0 / math.pi),
            ("te_rad", "te_urad", 1e6),
        ]:
            if getattr(want, field) is not None:
                held[name] = getattr(want, field) * unit
        for name, (_, module, _) in FORMATS.items():
            if importlib.util.find_spec(module) is None:
                continue
            got = read_recording(write(tmp_path, name, held, {"speed_rpm": 30.0}))
            for field in ("time_s", "driving_angle_rad", "driven_angle_rad", "te_rad"):
                a, b = getattr(got, field), getattr(want, field)
                assert (a is None) == (b is None)
                if a is not None:
                    # To degrees and back: three roundings; twelve digits in text.
                    np.testing.assert_allclose(a, b, rtol=1e-11 if name == "uff text" else 7e-16, atol=0.0)


def test_find_reader_looks_at_the_head_only(tmp_path: Path) -> None:
    file = tmp_path / "rec.csv"
    files.write_csv(file, columns(), KEYS)
    assert find_reader(file).name == "CSV"
    check: Callable[[bytes], bool] = find_reader(file).recognises
    assert check(b"# a\n1,2\n")
    assert not check(b"\0\1")


def test_recordings_are_frozen_even_where_nothing_was_copied(tmp_path: Path) -> None:
    recording: Recording = read_recording(write(tmp_path, "mat5"))
    for name in ARRAYS:
        array = getattr(recording, name)
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0
        assert not isinstance(array.base, np.ndarray) or not array.base.flags.writeable
