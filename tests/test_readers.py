"""Recordings in every format: the same numbers come out, and bad files are refused with a cure."""

from __future__ import annotations

import importlib
import importlib.util
import math
import struct
import sys
import tempfile
import warnings
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

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

SHARED = Path(__file__).parents[2] / "shared" / "recordings"

N = 1001  # odd, so that no block of 2, 4 or 6 numbers in a line comes out even

KEYS: dict[str, object] = {
    "torque_nm": 25.5,
    "speed_rpm": 30.0,
    "flank": "coast",
    "driving_zero_deg": 159.2,
    "driven_zero_deg": -132.4,
    "driving_direction": 1,
    "driven_direction": -1,
}

ARRAYS = ("time_s", "driving_angle_rad", "driven_angle_rad", "torque_samples_nm")


def columns() -> dict[str, npt.NDArray[np.float64]]:
    rng = np.random.default_rng(4)
    driving = np.cumsum(rng.uniform(0.5, 1.5, N))
    driven = 0.72 * driving
    driven[17] = math.nan
    return {
        "time_s": 1e-3 * np.cumsum(rng.uniform(0.5, 1.5, N)),
        "driving_angle_deg": driving % 360.0,
        "driven_angle_deg": driven,
        "torque_nm": rng.normal(25.0, 1.0, N),
    }


def needs(module: str) -> pytest.MarkDecorator:
    return pytest.mark.skipif(importlib.util.find_spec(module) is None, reason=f"{module} is not installed")


def packed_hdf5(file: Path, c: files.Columns, k: files.Keys) -> None:
    files.write_hdf5(file, c, k, group="run_1", compression="gzip", shuffle=True)


FORMATS: dict[str, tuple[str, str, files.Writer]] = {
    "csv": ("rec.csv", "numpy", files.write_csv),
    "parquet": ("rec.parquet", "pyarrow", files.write_parquet),
    "hdf5 root": ("rec.h5", "h5py", files.write_hdf5),
    "hdf5 group": ("rec.hdf5", "h5py", packed_hdf5),
    "mat5": ("rec.mat", "scipy", lambda f, c, k: files.write_mat5(f, c, k, packed=False)),
    "mat5 packed": ("rec.mat", "scipy", files.write_mat5),
    "mat5 struct": ("rec.mat", "scipy", lambda f, c, k: files.write_mat5(f, c, k, struct="rec", packed=False)),
    "mat5 packed struct": ("rec.mat", "scipy", lambda f, c, k: files.write_mat5(f, c, k, struct="rec")),
    "mat73": ("rec.mat", "h5py", files.write_mat73),
    "mat73 struct": ("rec.mat", "h5py", lambda f, c, k: files.write_mat73(f, c, k, struct="rec", compression="gzip")),
    "tdms": ("rec.tdms", "nptdms", files.write_tdms),
    "uff binary": ("rec.uff", "numpy", files.write_uff),
    "uff text": ("rec.unv", "numpy", lambda f, c, k: files.write_uff(f, c, k, binary=False)),
}

EVERY = [pytest.param(name, marks=needs(module)) for name, (_, module, _) in FORMATS.items()]


def write(folder: Path, name: str, c: files.Columns | None = None, k: files.Keys | None = None) -> Path:
    file_name, _, writer = FORMATS[name]
    file = folder / file_name
    writer(file, columns() if c is None else c, KEYS if k is None else k)
    return file


def refusal(file: Path) -> InputFileError:
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    error = caught.value
    assert error.file == str(file)
    assert str(error).startswith(str(file))
    assert "\n" not in str(error)
    assert error.wish.startswith(("want ", "the nearest known"))
    return error


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
        ({"te_um": "time_s", "te_urad": "time_s"}, "te_um and te_urad"),
        ({"driving_count": "time_s"}, "driving_angle_deg and driving_count"),
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
    refusal(file)
    assert capfd.readouterr() == ("", "")  # the libraries keep quiet; the error says it all


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
    assert [one.name for one in found] == ["HDF5", "MAT 5", "MAT 7.3", "Parquet", "TDMS", "UFF58", "CSV"]
    endings = [ending for one in found for ending in one.endings]
    assert sorted(ending for ending in set(endings) if endings.count(ending) > 1) == [".mat"]
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


# Sizes are checked before memory is taken: these files are small and state what would fill any memory.


@needs("h5py")
@pytest.mark.parametrize("suffix", [".h5", ".mat"])
def test_hdf5_that_states_a_huge_dataset(tmp_path: Path, suffix: str) -> None:
    h5py = importlib.import_module("h5py")
    file = tmp_path / f"rec{suffix}"
    with h5py.File(file, "w") as root:
        for name in ("driving_angle_deg", "driven_angle_deg"):
            root.create_dataset(name, shape=(10**12,), chunks=(1000,), compression="gzip", dtype="f8")
    assert file.stat().st_size < 10_000
    assert "larger than 4 GB" in refusal(file).found


@needs("h5py")
def test_hdf5_reads_nothing_outside_the_file(tmp_path: Path) -> None:
    h5py = importlib.import_module("h5py")
    inside = np.arange(100.0)
    (tmp_path / "secret.bin").write_bytes(inside.tobytes())
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["driven_angle_deg"] = inside

    def with_link(root: Any) -> None:
        root["driven_angle_deg"] = h5py.ExternalLink(tmp_path / "other.h5", "driven_angle_deg")

    def with_soft_link(root: Any) -> None:
        root["driven_angle_deg"] = h5py.SoftLink("/driving_angle_deg")

    def with_storage(root: Any) -> None:
        where = [(str(tmp_path / "secret.bin"), 0, 800)]
        root.create_dataset("driven_angle_deg", shape=(100,), dtype="f8", external=where)

    def with_virtual(root: Any) -> None:
        layout = h5py.VirtualLayout(shape=(100,), dtype="f8")
        layout[:] = h5py.VirtualSource(tmp_path / "other.h5", "driven_angle_deg", shape=(100,))
        root.create_virtual_dataset("driven_angle_deg", layout)

    for i, (plant, found) in enumerate(
        [
            (with_link, "no column"),
            (with_soft_link, "no column"),
            (with_storage, "another file"),
            (with_virtual, "another"),
        ]
    ):
        file = tmp_path / f"rec{i}.h5"
        with h5py.File(file, "w") as root:
            root["driving_angle_deg"] = inside
            plant(root)
        assert found in refusal(file).found


@needs("h5py")
def test_hdf5_with_two_recordings_text_and_foreign_datasets(tmp_path: Path) -> None:
    h5py = importlib.import_module("h5py")
    file = tmp_path / "rec.h5"
    good = {"driving_angle_deg": np.arange(9.0), "driven_angle_deg": np.arange(9.0)}
    with h5py.File(file, "w") as root:
        for group in ("run_1", "run_2"):
            for name, values in good.items():
                root[f"{group}/{name}"] = values
    assert "/run_1 and /run_2" in refusal(file).found
    with h5py.File(file, "w") as root:
        root["driving_angle_deg"] = good["driving_angle_deg"]
        root["driven_angle_deg"] = [b"a", b"b"]
    assert "values of type" in refusal(file).found
    with h5py.File(file, "w") as root:
        root.update(good)
        root["microphone"] = np.arange(5)
        root.attrs["made_by"] = "the old rig"
    recording = read_recording(file)
    assert any("microphone" in remark for remark in recording.remarks)
    with h5py.File(file, "w") as root:
        root.update(good)
        root["time"] = np.arange(9.0)
    assert 'nearest known column is "time_s"' in refusal(file).wish
    with h5py.File(file, "w") as root:
        root.update({name: values[:, None] * np.ones(2) for name, values in good.items()})
    assert "shape 9 x 2" in refusal(file).found


@needs("pyarrow")
def test_parquet_that_unpacks_to_too_much(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "rec.parquet"
    same = np.zeros(200_000)  # run lengths and a dictionary make a few bytes of it
    files.write_parquet(file, {"driving_angle_deg": same, "driven_angle_deg": same}, {})
    assert file.stat().st_size < 3000
    for module in ("reader", "parquet_reader"):
        monkeypatch.setattr(f"gearpoly.recording.{module}.RECORDING_LIMIT_BYTES", 3_000_000)
    assert "400000 numbers" in refusal(file).found


@needs("pyarrow")
def test_parquet_types_and_nulls(tmp_path: Path) -> None:
    pa = importlib.import_module("pyarrow")
    parquet = importlib.import_module("pyarrow.parquet")
    file = tmp_path / "rec.parquet"
    whole = pa.array([1, 2, None, 4], type=pa.int32())
    parquet.write_table(
        pa.table({"driving_angle_deg": whole, "driven_angle_deg": pa.array([1.0, 2.0, 3.0, None])}), file
    )
    recording = read_recording(file)
    assert recording.driving_angle_rad is not None
    np.testing.assert_array_equal(np.isnan(recording.driving_angle_rad), [False, False, True, False])
    parquet.write_table(pa.table({"driving_angle_deg": whole, "driven_angle_deg": pa.array(list("abcd"))}), file)
    assert "values of type string" in refusal(file).found
    parquet.write_table(pa.table({"driving_angle_deg": whole, "comment": whole}), file)
    assert 'unknown column "comment"' in refusal(file).found


# MAT 5 is walked by this package; SciPy wrote the files above, and here the walk meets what SciPy never writes.


def mat5(*elements: bytes, order: str = "<") -> bytes:
    mark = b"\x00\x01IM" if order == "<" else b"\x01\x00MI"
    return b"MATLAB 5.0 MAT-file".ljust(124) + mark + b"".join(elements)


def element(kind: int, data: bytes, *, order: str = "<", size: int | None = None) -> bytes:
    return struct.pack(order + "II", kind, len(data) if size is None else size) + data + b"\0" * (-len(data) % 8)


def packed(data: bytes) -> bytes:
    squeezed = zlib.compress(data)
    return struct.pack("<II", 15, len(squeezed)) + squeezed  # the only element that is not filled up


def matrix(
    name: str, values: npt.NDArray[Any], *, order: str = "<", kind: int = 6, stored: int = 9, count: int | None = None
) -> bytes:
    shape = struct.pack(order + "ii", values.size if count is None else count, 1)
    body = element(6, struct.pack(order + "II", kind, 0), order=order) + element(5, shape, order=order)
    body += element(1, name.encode(), order=order) + element(stored, values.tobytes(), order=order)
    return element(14, body, order=order)


ANGLE = np.arange(10.0)


def test_mat5_of_the_other_byte_order_and_short_storage(tmp_path: Path) -> None:
    file = tmp_path / "rec.mat"
    big = matrix("driving_angle_deg", ANGLE.astype(">f8"), order=">")
    small = matrix("driven_angle_deg", ANGLE.astype("u1"), order=">", stored=2)  # as MATLAB stores whole doubles
    file.write_bytes(mat5(big, small, order=">"))
    recording = read_recording(file)
    assert recording.driven_angle_rad is not None
    np.testing.assert_array_equal(recording.driven_angle_rad, ANGLE * (math.pi / 180.0))
    np.testing.assert_array_equal(recording.driving_angle_rad, recording.driven_angle_rad)


def test_mat5_sizes_that_lie(tmp_path: Path) -> None:
    file = tmp_path / "rec.mat"
    good = matrix("driving_angle_deg", ANGLE)
    for planted, found in [
        (matrix("driven_angle_deg", ANGLE, count=11), "80 bytes for 11 numbers"),
        (matrix("driven_angle_deg", ANGLE, count=2**31 - 1), "larger than 4 GB"),
        (matrix("driven_angle_deg", ANGLE, count=-1), "the shape"),
        (matrix("driven_angle_deg", ANGLE)[:-8], "it ends at byte"),
        (element(14, b""), "no column driven_angle_deg"),
        (packed(struct.pack("<II", 14, 2**32 - 1)), "of 0 bytes instead of 4294967295"),
        (packed(struct.pack("<II", 14, 1000) + b"\0" * 8), "of 8 bytes instead of 1000"),
        (packed(struct.pack("<II", 14, 1000) + b"\0" * 8)[:-2], "it ends at byte"),
        (element(99, b"12345678"), "type 99"),
        (matrix("driven_angle_deg", ANGLE, kind=1), "a cell"),
        (matrix("driven_angle_deg", ANGLE, kind=3), "a object"),
        (matrix("driven_angle_deg", ANGLE, kind=16), "a function"),
        (matrix("driven_angle_deg", ANGLE, kind=17), "no column driven_angle_deg"),
    ]:
        file.write_bytes(mat5(good, planted))
        assert found in refusal(file).found


def test_mat5_bomb_is_not_unpacked(tmp_path: Path) -> None:
    # 80 MB of zeros behind a tag that states 200 bytes: no more than the stated bytes may be unpacked.
    tracemalloc = importlib.import_module("tracemalloc")
    file = tmp_path / "rec.mat"
    inner = matrix("driven_angle_deg", ANGLE)[8:]
    bomb = zlib.compress(struct.pack("<II", 14, len(inner)) + inner + b"\0" * 80_000_000, 1)
    packed = struct.pack("<II", 15, len(bomb)) + bomb
    file.write_bytes(mat5(matrix("driving_angle_deg", ANGLE), packed))
    tracemalloc.start()
    assert read_recording(file).size == 10
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5_000_000  # the packed bytes (0.35 MB) and small change; the bomb would be 80 MB


def test_mat5_keys_beside_columns_and_whole_workspaces(tmp_path: Path) -> None:
    savemat = importlib.import_module("scipy.io").savemat
    file = tmp_path / "rec.mat"
    workspace: dict[str, Any] = {
        "driving_angle_deg": ANGLE,
        "driven_angle_deg": ANGLE,
        "torque_nm": 12.5,
        "flank": "coast",
        "notes": "from the old rig",
        "setup": {"operator": "A", "gain": 3.0},
        "cells": np.array([1, "two"], dtype=object),
    }
    for packed in (False, True):
        savemat(file, workspace, do_compression=packed)
        recording = read_recording(file)
        assert (recording.torque_nm, recording.flank) == (12.5, "coast")
        assert any("notes" in remark for remark in recording.remarks)
    savemat(file, {"a": {"driving_angle_deg": ANGLE}, "b": {"driven_angle_deg": ANGLE}})
    assert "a and b" in refusal(file).found
    savemat(file, {"driving_angle_deg": ANGLE, "driven_angle_deg": ANGLE + 1j})
    assert "complex" in refusal(file).found
    savemat(file, {"driving_angle_deg": ANGLE, "driven_angle_deg": "text of some length"})
    assert "a text" in refusal(file).found
    savemat(file, {"driving_angle_deg": ANGLE, "driven_angle_deg": ANGLE, "torque_nm": "25 N.m"})
    assert 'torque_nm = "25 N.m"' in refusal(file).found


@needs("nptdms")
def test_tdms_time_from_the_waveform(tmp_path: Path) -> None:
    nptdms = importlib.import_module("nptdms")
    file = tmp_path / "rec.tdms"
    wave = {"wf_start_offset": 2.0, "wf_increment": 0.25}

    def save(first: dict[str, float], second: dict[str, float]) -> None:
        with nptdms.TdmsWriter(file) as writer:
            writer.write_segment(
                [
                    nptdms.ChannelObject("rig", "driving_angle_deg", ANGLE, properties=first),
                    nptdms.ChannelObject("rig", "driven_angle_deg", ANGLE, properties=second),
                ]
            )

    save(wave, wave)
    recording = read_recording(file)
    np.testing.assert_array_equal(recording.time_s, 2.0 + 0.25 * ANGLE)
    assert any("4 samples per second" in remark for remark in recording.remarks)
    save(wave, {"wf_start_offset": 2.0, "wf_increment": 0.5})
    assert "differ from channel to channel" in refusal(file).found
    save({}, {})
    assert read_recording(file).time_s is None


# UFF58: pyuff writes, this package reads. What pyuff itself gets wrong is kept here, so that a mended version shows.


def pyuff_set(name: str, x: npt.NDArray[np.float64], y: npt.NDArray[np.float64], **more: Any) -> dict[str, Any]:
    kinds = {f"{axis}_spec_data_type": 0 for axis in ("ordinate", "orddenom", "z_axis")}
    nodes = {"rsp_node": 1, "rsp_dir": 1, "ref_node": 0, "ref_dir": 0, "func_type": 1, "abscissa_spec_data_type": 17}
    return {"type": 58, "id1": name, "x": x.copy(), "data": y.copy(), **kinds, **nodes, **more}


def pyuff_write(file: Path, sets: list[dict[str, Any]], *, mode: str = "add", **options: Any) -> None:
    if mode == "add":
        file.unlink(missing_ok=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)  # it leaves binary files open
        importlib.import_module("pyuff").UFF(str(file)).write_sets(sets, mode=mode, **options)


@needs("pyuff")
@pytest.mark.parametrize("count", [2, 3, 4, 5, 7, 1000])
@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("even", [0, 1])
def test_what_pyuff_writes_is_read(tmp_path: Path, count: int, binary: int, even: int) -> None:
    file = tmp_path / "rec.uff"
    rng = np.random.default_rng(count)
    x = 0.25 * np.arange(count) if even else np.cumsum(rng.uniform(0.5, 1.5, count))
    first, second = rng.normal(0.0, 100.0, (2, count))
    first[1] = -1.0  # looks like the mark of a set's end
    form = {"binary": binary, "abscissa_spacing": even}
    pyuff_write(
        file,
        [
            pyuff_set("driving_angle_deg", x, first, id2="torque_nm = 12.5; flank = coast", **form),
            pyuff_set("driven_angle_deg", x, second, id4="speed_rpm = 30.0", **form),
        ],
    )
    got = read_recording(file)
    assert got.driving_angle_rad is not None
    assert got.driven_angle_rad is not None
    assert (got.torque_nm, got.flank, got.speed_rpm) == (12.5, "coast", 30.0)
    # Binary is exact; text has twelve digits for ordinates and six for abscissas.
    digits = 0.0 if binary else 6e-12
    np.testing.assert_allclose(got.driving_angle_rad, first * (math.pi / 180.0), rtol=digits, atol=0.0)
    np.testing.assert_allclose(got.driven_angle_rad, second * (math.pi / 180.0), rtol=digits, atol=0.0)
    assert got.time_s is not None
    np.testing.assert_allclose(got.time_s, x, rtol=0.0 if binary or even else 6e-6, atol=0.0)
    # And pyuff reads the same values from the same file.
    theirs = importlib.import_module("pyuff").UFF(str(file)).read_sets()
    np.testing.assert_array_equal(theirs[0]["data"] * (math.pi / 180.0), got.driving_angle_rad)


@needs("pyuff")
def test_single_precision_text_from_pyuff(tmp_path: Path) -> None:
    file = tmp_path / "rec.uff"
    x = np.arange(11.0)
    single = {"ord_data_type": 2, "binary": 0, "abscissa_spacing": 1}
    sets = [pyuff_set(name, x, 10.0 * x, **single) for name in ("driving_angle_deg", "driven_angle_deg")]
    pyuff_write(file, sets, force_double=False)
    recording = read_recording(file)
    assert recording.driving_angle_rad is not None
    np.testing.assert_allclose(recording.driving_angle_rad, np.radians(10.0 * x), rtol=6e-6, atol=0.0)  # six digits


@needs("pyuff")
def test_where_pyuff_fails_its_own_round_trip(tmp_path: Path) -> None:
    """pyuff 2.5.8; where one of these turns, docs/recordings.md can be mended."""
    pyuff = importlib.import_module("pyuff")
    file = tmp_path / "rec.uff"
    x = np.arange(100.0)
    names = ("driving_angle_deg", "driven_angle_deg")
    # Single precision in binary: the header says four bytes a value, eight are written.
    single = {"ord_data_type": 2, "binary": 1, "abscissa_spacing": 1}
    pyuff_write(file, [pyuff_set(name, x, x, **single) for name in names], force_double=False)
    assert pyuff.UFF(str(file)).read_sets()[0]["data"].size == 200
    assert "no end after the 100 values" in refusal(file).found
    # A data set that is cut off is dropped without a word.
    pyuff_write(file, [pyuff_set(name, x, x, binary=1, abscissa_spacing=1) for name in names])
    file.write_bytes(file.read_bytes()[:-100])
    assert pyuff.UFF(str(file)).get_n_sets() == 1
    assert "cut-off" in refusal(file).found
    # Drop-outs become zeros when it writes.
    y = x.copy()
    y[3] = math.nan
    pyuff_write(file, [pyuff_set("driving_angle_deg", x, y, binary=1, abscissa_spacing=1)])
    assert pyuff.UFF(str(file)).read_sets()["data"][3] == 0.0
    # Bytes of numbers that look like the mark of an end break the file into more sets.
    y = np.frombuffer(b"    -1\n\n" * 100, dtype="<f8").copy()
    pyuff_write(file, [pyuff_set(name, x, y, binary=1, abscissa_spacing=1) for name in names])
    assert pyuff.UFF(str(file)).get_n_sets() > 2
    got = read_recording(file)
    assert got.driving_angle_rad is not None
    np.testing.assert_array_equal(got.driving_angle_rad, y * (math.pi / 180.0))
    # Writing binary over an old file leaves only the last line.
    once = pyuff_set("driving_angle_deg", x, x, binary=1, abscissa_spacing=1)
    pyuff_write(file, [once], mode="overwrite")
    assert file.stat().st_size < 10


def test_uff_values_that_touch_filled_lines_and_foreign_sets(tmp_path: Path) -> None:
    file = tmp_path / "rec.unv"

    def save(body: str, count: int) -> None:
        parts = [b"    -1\n   151\nsome rig\n    -1\n"]
        for name in ("driving_angle_deg", "driven_angle_deg"):
            head = files.uff_header(name, count, {}, binary=False, even=True)
            parts += [head, body.encode(), b"    -1\n"]
        file.write_bytes(b"".join(parts))

    save(
        "".join(f"{v:20.12E}" for v in (-1.0, 2.0, -3.0, 4.0))
        + "\n"
        + "".join(f"{v:20.12E}" for v in (5.0, 0.0))
        + "\n",
        5,
    )
    recording = read_recording(file)
    assert recording.driven_angle_rad is not None
    # Twelve digits hold whole numbers exactly; the last zero only fills the line.
    np.testing.assert_array_equal(recording.driven_angle_rad, np.array([-1.0, 2.0, -3.0, 4.0, 5.0]) * (math.pi / 180.0))
    save("-1.2345678901234E+001" + "-1.234567890123E+001\n", 2)
    assert "cut-off file" in refusal(file).found or "columns" in refusal(file).wish
    save("-1.23456789012E+0001-1.23456789012E+0002\n", 2)  # twenty columns each, without a blank
    recording = read_recording(file)
    assert recording.driven_angle_rad is not None
    np.testing.assert_array_equal(
        recording.driven_angle_rad, np.array([-12.3456789012, -123.456789012]) * (math.pi / 180)
    )
    save("   1.0   x   3.0\n", 3)
    assert "numbers" in refusal(file).wish
    save("", 10**8)
    assert "bytes of text" in refusal(file).found
    save("", 10**10)
    assert "header" in refusal(file).found or "larger" in refusal(file).found


@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared recordings are not here")
def test_shared_recordings_survive_every_format(tmp_path: Path) -> None:
    for source in ("bench/control_inspected/rec_0.csv", "telescope/log01_as_eq6.csv"):
        want = read_recording(SHARED / source)
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
