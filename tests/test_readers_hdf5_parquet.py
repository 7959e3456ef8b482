"""HDF5 and Parquet: sizes are checked before memory is taken, foreign content is left alone."""

from __future__ import annotations

import importlib
import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.recording.read import read_recording
from tests import recording_files as files
from tests.made_readings import needs, refusal


@needs("h5py")
@pytest.mark.parametrize("suffix", [".h5", ".mat"])
def test_hdf5_that_states_a_huge_dataset(tmp_path: Path, suffix: str) -> None:
    h5py = importlib.import_module("h5py")
    file = tmp_path / f"rec{suffix}"
    with h5py.File(file, "w") as root:
        for name in ("driving_angle_deg", "driven_angle_deg"):
            root.create_dataset(name, shape=(10**12,), chunks=(1000,), compression="gzip", dtype="f8")
    assert file.stat().st_size < 10_000
    assert "values stated, and none there" in refusal(file).found


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
    assert '"run_1/driven_angle_deg" and "run_2/driven_angle_deg" may each be' in refusal(file).found
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
    monkeypatch.setattr("gearpoly.recording.reader.SMALL_LIMIT_BYTES", 3_000_000)
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
    assert "no column that is surely driven_angle_deg, only comment" in refusal(file).found
