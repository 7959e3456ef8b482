"""One recording, its formats, and what a refusal looks like, for the tests of the readers."""

from __future__ import annotations

import importlib
import importlib.util
import math
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording
from tests import recording_files as files

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
