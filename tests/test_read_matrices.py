"""Columns that lie in one variable of a file: matrices with names beside them, compound datasets, a group a channel."""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from tests.made_readings import needs
from tests.made_texts import DEGREE, FloatArray, chart, run

RUN = run()
TIME_S, DRIVING, DRIVEN, TORQUE = RUN.values()
BOTH = np.column_stack(list(RUN.values()))
NAMES, UNITS = ("Time", "Angle In", "Angle Out", "Torque Out"), ("s", "deg", "deg", "Nm")
WITH_UNITS = tuple(f"{name} [{unit}]" for name, unit in zip(NAMES, UNITS, strict=True))
OWN = tuple(RUN)
MAP_LINE = re.compile(r"(?:columns|keys)\.\w+ = (?:\{[^}]*\}|\S+)")


def holds(read: Recording, *, torque: bool = True, time: bool = True) -> None:
    """Each column has its own numbers, bit by bit but for the unit."""
    wanted: dict[str, FloatArray] = {"driving_angle_rad": DRIVING * DEGREE, "driven_angle_rad": DRIVEN * DEGREE}
    if torque:
        wanted["torque_samples_nm"] = TORQUE
    if time:
        wanted["time_s"] = TIME_S
    for name, values in wanted.items():
        np.testing.assert_allclose(getattr(read, name), values, rtol=1e-14, atol=1e-14, err_msg=name)


def cured(file: Path, folder: Path) -> Recording:
    """The file read with the lines of a map that its refusal names."""
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    lines = MAP_LINE.findall(caught.value.wish)
    assert lines, caught.value.wish
    return read_recording(file, chart=chart(folder, "\n".join(lines)))


def hdf5(file: Path, fill: Callable[[Any], None]) -> Path:
    h5py = importlib.import_module("h5py")
    matlab = file.suffix == ".mat"
    with h5py.File(file, "w", userblock_size=512 if matlab else 0) as root:
        fill(root)
    if matlab:
        with file.open("r+b") as stream:
            stream.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")
    return file


def put(root: Any, path: str, values: Any, **attributes: Any) -> None:
    root[path] = values
    root[path].attrs.update(attributes)


def compound(names: tuple[str, ...]) -> Any:
    rows = np.zeros(TIME_S.size, dtype=[*((name, "f8") for name in names), ("note", "S5"), ("ok", "?")])
    for name, column in zip(names, RUN.values(), strict=True):
        rows[name] = column
    return rows


def sibling(root: Any) -> None:
    put(root, "run/data", BOTH.T)
    put(root, "run/channel_names", np.array(NAMES, dtype="S"))
    put(root, "run/channel_units", np.array(UNITS, dtype="S"))


def of_group(root: Any) -> None:
    put(root, "run/data", BOTH)
    root["run"].attrs["header"] = ",".join(WITH_UNITS)


def of_pandas(root: Any) -> None:
    """A frame of pandas in its fixed format: columns of one type lie in one block."""
    put(root, "df/axis0", np.array(WITH_UNITS, dtype="S"))
    put(root, "df/axis1", np.arange(TIME_S.size))
    put(root, "df/block0_items", np.array(WITH_UNITS, dtype="S"))
    put(root, "df/block0_values", BOTH)


LAYOUTS: dict[str, Callable[[Any], None]] = {
    "own names": lambda root: put(root, "data", BOTH, columns=list(OWN)),
    "names and units in attributes": lambda root: put(root, "data", BOTH, column_names=NAMES, units=UNITS),
    "names in a dataset, channels in rows": sibling,
    "names in one text of the group": of_group,
    "pandas": of_pandas,
    "compound": lambda root: put(root, "rig/rec", compound(WITH_UNITS)),
    "compound, own names": lambda root: put(root, "rec", compound(OWN)),
    "compound, units in a list": lambda root: put(root, "rec", compound(NAMES), units=[*UNITS, "", ""]),
}


@needs("h5py")
@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_matrix_or_a_compound_dataset_with_names(tmp_path: Path, layout: str) -> None:
    holds(read_recording(hdf5(tmp_path / "rec.h5", LAYOUTS[layout])))


@needs("h5py")
def test_keys_beside_a_matrix_and_packing_of_each_column(tmp_path: Path) -> None:
    def fill(root: Any) -> None:
        put(root, "run/data", np.rint(BOTH / [0.01, 0.1, 0.1, 0.1]).astype("i4"))
        root["run/data"].attrs.update(names=list(OWN), scale_factor=[0.01, 0.1, 0.1, 0.1])
        root["run"].attrs["speed_rpm"] = 30.0
        root.attrs["flank"] = "coast"

    read = read_recording(hdf5(tmp_path / "rec.h5", fill))
    assert read.speed_rpm == 30.0 and read.flank == "coast"
    assert read.driven_angle_rad is not None and read.time_s is not None
    np.testing.assert_allclose(read.driven_angle_rad, DRIVEN * DEGREE, atol=0.051 * DEGREE)
    np.testing.assert_allclose(read.time_s, TIME_S, atol=1e-9)


@needs("h5py")
@pytest.mark.parametrize("suffix", [".h5", ".mat"])
def test_columns_without_names_are_numbered_and_the_cure_works(tmp_path: Path, suffix: str) -> None:
    holds(cured(hdf5(tmp_path / f"rec{suffix}", lambda root: put(root, "M", BOTH)), tmp_path), torque=False)


@needs("h5py")
def test_rows_of_numbers_in_a_compound_dataset(tmp_path: Path) -> None:
    """A frame of pandas in its table format: names are pickled, which nobody reads; columns are numbered."""

    def fill(root: Any) -> None:
        rows = np.zeros(TIME_S.size, dtype=[("index", "i8"), ("values_block_0", "f8", (4,))])
        rows["index"], rows["values_block_0"] = np.arange(TIME_S.size), BOTH
        put(root, "df/table", rows)

    file = hdf5(tmp_path / "rec.h5", fill)
    with pytest.raises(InputFileError, match=r"values_block_0 \(column 4\)"):
        read_recording(file)
    text = "\n".join(
        f'columns.{own} = {{ from = "df/values_block_0 (column {k})", unit = "{unit}" }}'
        for k, (own, unit) in enumerate(zip(OWN, ("s", "deg", "deg", "N.m"), strict=True), start=1)
    )
    holds(read_recording(file, chart=chart(tmp_path, text)))


@needs("h5py")
def test_two_matrices_are_two_recordings_and_a_map_takes_one_whole(tmp_path: Path) -> None:
    """The map names both angles; time and torque then come from the same matrix."""

    def fill(root: Any) -> None:
        put(root, "b", BOTH + 1.0)
        put(root, "a", BOTH)
        root.attrs["names"] = list(WITH_UNITS)

    file = hdf5(tmp_path / "rec.h5", fill)
    with pytest.raises(InputFileError, match=r'"a/Angle In \[deg\]" and "b/Angle In \[deg\]" may each be'):
        read_recording(file)
    holds(cured(file, tmp_path))


def channel_groups(root: Any, **of_group: Any) -> None:
    for name, values, unit in zip(NAMES[1:], (DRIVING, DRIVEN, TORQUE), UNITS[1:], strict=True):
        put(root, f"Channels/{name}/data", values)
        root[f"Channels/{name}"].attrs.update(unit=unit, **of_group)


@needs("h5py")
@pytest.mark.parametrize(
    "stated",
    [{"dt": 0.01}, {"sample_rate": 100.0}, {"Sampling Rate [kHz]": 0.1}, {"wf_increment": 0.01}, {"dt_ms": 10.0}],
)
def test_a_group_for_each_channel(tmp_path: Path, stated: dict[str, Any]) -> None:
    read = read_recording(hdf5(tmp_path / "rec.h5", lambda root: channel_groups(root, **stated)))
    holds(read)
    assert any("times of channels by the attribute" in one for one in read.remarks)


@needs("h5py")
def test_times_beside_each_channel(tmp_path: Path) -> None:
    """The driven shaft is read at times of its own, between those of the driving one."""

    def fill(root: Any) -> None:
        channel_groups(root)
        for name in NAMES[1:]:
            late = 5.0 if name == "Angle Out" else 0.0
            put(root, f"Channels/{name}/time", TIME_S * 1e3 + late, units="ms")
        root["Channels/Angle Out/data"][...] = np.arange(TIME_S.size) * 1.296 + 0.648
        root["Channels/Angle In/data"][...] = np.arange(TIME_S.size) * 1.8

    read = read_recording(hdf5(tmp_path / "rec.h5", fill))
    assert read.driving_angle_rad is not None and read.driven_angle_rad is not None
    np.testing.assert_allclose(read.driven_angle_rad, 0.72 * read.driving_angle_rad, rtol=1e-9, atol=1e-9)


@needs("h5py")
def test_channels_that_begin_apart_by_their_dates(tmp_path: Path) -> None:
    def fill(root: Any) -> None:
        channel_groups(root, dt=0.01)
        for name in NAMES[1:]:
            late = name == "Angle Out"
            root[f"Channels/{name}"].attrs["start_time"] = f"2026-02-03T10:15:0{int(late)}.000"
        root["Channels/Angle Out/data"][...] = (np.arange(TIME_S.size) + 100.0) * 1.296
        root["Channels/Angle In/data"][...] = np.arange(TIME_S.size) * 1.8

    file = hdf5(tmp_path / "rec.h5", fill)
    read = read_recording(file)
    assert read.driving_angle_rad is not None and read.driven_angle_rad is not None
    assert read.size == TIME_S.size - 100
    np.testing.assert_allclose(read.driven_angle_rad, 0.72 * read.driving_angle_rad, rtol=1e-9)
    with importlib.import_module("h5py").File(file, "r+") as root:
        root["Channels/Angle In"].attrs["start_time"] = "yesterday"
    with pytest.raises(InputFileError, match=r"different starts .*yesterday"):
        read_recording(file)


@needs("h5py")
def test_names_and_rate_in_attributes_of_datasets(tmp_path: Path) -> None:
    def fill(root: Any) -> None:
        for k, values in enumerate((DRIVING, DRIVEN, TORQUE), start=1):
            put(root, f"ch{k}", values, long_name=NAMES[k], Units=UNITS[k])
        root.attrs["fs"] = 100.0

    holds(read_recording(hdf5(tmp_path / "rec.h5", fill)))


def texts(root: Any, path: str, held: tuple[str, ...]) -> None:
    """A cell of texts as MATLAB 7.3 keeps it: references to characters elsewhere in the file."""
    h5py = importlib.import_module("h5py")
    store = root.require_group("#refs#")
    references = []
    for text in held:
        one = store.create_dataset(f"n{len(store)}", data=np.array([[ord(c)] for c in text], dtype="u2"))
        one.attrs["MATLAB_class"] = np.bytes_("char")
        references.append(one.ref)
    put(root, path, np.array(references, dtype=h5py.ref_dtype)[:, None], MATLAB_class=np.bytes_("cell"))


@needs("h5py")
def test_a_cell_of_names_in_mat_73(tmp_path: Path) -> None:
    def fill(root: Any) -> None:
        put(root, "rec/X", BOTH.T, MATLAB_class=np.bytes_("double"))
        texts(root, "rec/names", NAMES)
        texts(root, "rec/units", UNITS)
        put(root, "speed_rpm", [[30.0]], MATLAB_class=np.bytes_("double"))

    read = read_recording(hdf5(tmp_path / "rec.mat", fill))
    holds(read)
    assert read.speed_rpm == 30.0


@needs("h5py")
def test_name_and_unit_beside_the_numbers_in_mat_73(tmp_path: Path) -> None:
    def fill(root: Any) -> None:
        for k, values in enumerate(RUN.values()):
            put(root, f"Y{k}/Data", values[None, :], MATLAB_class=np.bytes_("double"))
            for key, text in (("Name", f"Model Root/{NAMES[k]}"), ("Unit", UNITS[k])):
                codes = np.array([[ord(c)] for c in text], dtype="u2")
                put(root, f"Y{k}/{key}", codes, MATLAB_class=np.bytes_("char"))

    holds(read_recording(hdf5(tmp_path / "rec.mat", fill)))


def cell(held: tuple[str, ...]) -> Any:
    return np.array(held, dtype=object)[:, None]


MATRICES: dict[str, dict[str, Any]] = {
    "cells": {"data": BOTH, "names": cell(NAMES), "units": cell(UNITS)},
    "own names": {"data": BOTH, "colheaders": cell(OWN).T},
    "in a struct, channels in rows": {"rec": {"X": BOTH.T, "labels": cell(WITH_UNITS)}},
    "characters": {"data": BOTH, "data_names": np.array(NAMES), "data_units": np.array(UNITS)},
    "importdata": {"A": {"data": BOTH, "textdata": cell(("one", "two")), "colheaders": cell(WITH_UNITS)}},
}


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("layout", MATRICES)
def test_a_matrix_with_names_in_mat_5(tmp_path: Path, layout: str, packed: bool) -> None:
    file = tmp_path / "rec.mat"
    importlib.import_module("scipy.io").savemat(file, MATRICES[layout], do_compression=packed)
    holds(read_recording(file))


def test_keys_beside_a_matrix_in_mat_5(tmp_path: Path) -> None:
    """The torque is a key there, and a column of the matrix too."""
    file = tmp_path / "rec.mat"
    held = {"rec": {"X": BOTH, "names": cell(OWN), "torque_nm": 25.0}, "flank": "coast"}
    importlib.import_module("scipy.io").savemat(file, held)
    read = read_recording(file)
    holds(read)
    assert read.torque_nm == 25.0 and read.flank == "coast"


@pytest.mark.parametrize("held", [{"M": BOTH}, {"a": {"M": BOTH}, "note": "none"}])
def test_columns_without_names_in_mat_5(tmp_path: Path, held: dict[str, Any]) -> None:
    file = tmp_path / "rec.mat"
    importlib.import_module("scipy.io").savemat(file, held)
    holds(cured(file, tmp_path), torque=False)


def test_a_cell_that_lies_about_its_size_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "rec.mat"
    importlib.import_module("scipy.io").savemat(file, {"data": BOTH, "names": cell(NAMES)}, do_compression=False)
    whole = file.read_bytes()
    # The shape 4 x 1 of the cell becomes 4 x 2, of which it holds four.
    at = whole.index(b"names") - 16
    assert whole[at : at + 8] == bytes((4, 0, 0, 0, 1, 0, 0, 0))
    lied = whole[: at + 4] + (2).to_bytes(4, "little") + whole[at + 8 :]
    file.write_bytes(lied)
    with pytest.raises(InputFileError, match="cut-off or damaged"):
        read_recording(file)


def test_a_rate_beside_angles_is_the_time(tmp_path: Path) -> None:
    file = tmp_path / "rec.csv"
    rows = "\n".join(f"{a!r},{b!r}" for a, b in zip(DRIVING.tolist(), DRIVEN.tolist(), strict=True))
    file.write_text(f"# sample_rate_hz = 100.0\ndriving_angle_deg,driven_angle_deg\n{rows}\n", encoding="utf-8")
    holds(read_recording(file), torque=False)
