"""Tables and timetables of MATLAB in both kinds of files, as mat-io writes them; no file of MATLAB was at hand."""

from __future__ import annotations

import importlib
import importlib.util
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording
from tests.made_readings import needs
from tests.made_texts import DEGREE, GERMAN, OWN, chart, run, same

pytestmark = needs("matio")
RUN = run(1200)
VERSIONS = ["v7", "v7.3"]
ANGLES = {name: RUN[name] for name in OWN[1:3]}


def frame(columns: dict[str, Any], index: Any = None) -> Any:
    return importlib.import_module("pandas").DataFrame(columns, index=index)


def matio() -> Any:
    """The library, which sets an option of pandas when imported that newer ones call old."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return importlib.import_module("matio")


def written(folder: Path, held: dict[str, Any], version: str) -> Path:
    file = folder / "rec.mat"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # durations are written in s
        matio().save_to_mat(str(file), held, version=version)
    return file


def milliseconds() -> Any:
    return np.round(1000.0 * RUN["time_s"]).astype("m8[ms]")


@pytest.mark.long
@pytest.mark.parametrize("version", VERSIONS)
def test_a_table_under_the_contracts_names(tmp_path: Path, version: str) -> None:
    file = written(tmp_path, {"T": frame(RUN), "torque_nm": 12.0, "note": np.arange(3.0)}, version)
    recording = read_recording(file)
    same(recording.time_s, RUN["time_s"], half=0.0)
    same(recording.driven_angle_rad, RUN["driven_angle_deg"] * DEGREE, half=0.0)
    same(recording.torque_samples_nm, RUN["torque_nm"], half=0.0)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("begin", [None, np.datetime64("2026-03-01T23:59:59", "ms")])
def test_the_row_times_of_a_timetable_are_the_time(tmp_path: Path, version: str, begin: Any) -> None:
    """Durations, and dates across midnight: seconds since the first."""
    times = milliseconds() if begin is None else begin + milliseconds()
    recording = read_recording(written(tmp_path, {"log": frame(ANGLES, times)}, version))
    assert recording.time_s is not None
    np.testing.assert_allclose(recording.time_s, RUN["time_s"], rtol=0.0, atol=1e-9)
    same(recording.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=0.0)


@pytest.mark.parametrize("version", VERSIONS)
def test_a_map_names_the_variables_of_tables_within_structs(tmp_path: Path, version: str) -> None:
    names = ("A", "Winkel 1 (rig)", "C", "D")
    held = frame(dict(zip(names, RUN.values(), strict=True)))
    file = written(tmp_path, {"rig": {"run": held}, "x": np.arange(5.0)}, version)
    with pytest.raises(InputFileError, match=r"of which shaft the angle is|no unit of angle"):
        read_recording(file)
    lines = "".join(
        f'columns.{column} = {{ from = "rig.run.{name}", unit = "{unit}" }}\n'
        for column, name, unit in zip(OWN, names, ("s", "deg", "deg", "N.m"), strict=True)
    )
    recording = read_recording(file, chart=chart(tmp_path, lines))
    same(recording.time_s, RUN["time_s"], half=0.0)
    same(recording.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=0.0)
    same(recording.torque_samples_nm, RUN["torque_nm"], half=0.0)


@pytest.mark.parametrize("version", VERSIONS)
def test_units_of_variables_are_read(tmp_path: Path, version: str) -> None:
    """VariableUnits of a table: mat-io keeps its properties, but writes none of a DataFrame's, so they are put in."""
    names = [name.partition(" [")[0] for name in GERMAN]
    held = frame(dict(zip(names, RUN.values(), strict=True)))
    file = written(tmp_path, {"T": held}, version)
    opaque = matio().load_from_mat(str(file), raw_data=True)["T"]
    units = np.empty((1, 4), dtype=object)
    units[0] = ["s", "deg", "deg", "Nm"]
    opaque.properties["props"][0, 0]["VariableUnits"] = units
    recording = read_recording(written(tmp_path, {"T": opaque}, version))
    same(recording.driving_angle_rad, RUN["driving_angle_deg"] * DEGREE, half=0.0)
    same(recording.torque_samples_nm, RUN["torque_nm"], half=0.0)


@pytest.mark.parametrize("version", VERSIONS)
def test_dates_beside_plain_variables_are_the_time(tmp_path: Path, version: str) -> None:
    begin = np.datetime64("2026-03-01T23:59:59", "ms")
    held = {name: values[:, None] for name, values in ANGLES.items()}
    file = written(tmp_path, {"Zeit": (begin + milliseconds())[:, None], **held}, version)
    recording = read_recording(file)
    assert recording.time_s is not None
    np.testing.assert_allclose(recording.time_s, RUN["time_s"], rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("share", [0.3, 0.7, 0.95])
def test_a_table_that_was_cut_off_is_one_message(tmp_path: Path, version: str, share: float) -> None:
    file = written(tmp_path, {"T": frame(RUN)}, version)
    whole = file.read_bytes()
    file.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(InputFileError, match="want"):
        read_recording(file)


def test_without_mat_io_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = written(tmp_path, {"T": frame(RUN)}, "v7")
    find = importlib.util.find_spec
    import_module = importlib.import_module

    def absent(name: str, *more: Any) -> Any:
        if name.split(".")[0] == "matio":
            raise ImportError("No module named 'matio'")
        return import_module(name, *more)

    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *more: None if name == "matio" else find(name, *more))
    monkeypatch.setattr(importlib, "import_module", absent)
    with pytest.raises(InputFileError, match=r"pip install gearpoly\[matlab\]; or in MATLAB: S = table2struct\(T"):
        read_recording(file)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("dimension", ["Time", "Zeit", "k"])
def test_a_map_names_row_times_by_the_dimension_of_their_timetable(
    tmp_path: Path, version: str, dimension: str
) -> None:
    """They are the time without a map, and went by ``time_s`` alone: their own path was no column of the recording."""
    index = importlib.import_module("pandas").Index(milliseconds(), name=dimension)
    held = {"rig": {"run": frame(ANGLES | {"x": RUN["torque_nm"]}, index)}, "y": np.arange(5.0)}
    file = written(tmp_path, {"log": held}, version)
    for name in (f"log.rig.run.{dimension}", dimension, "time_s"):
        lines = f'columns.time_s = {{ from = "{name}", unit = "ms" }}\n'
        recording = read_recording(file, chart=chart(tmp_path, lines))
        assert recording.time_s is not None
        np.testing.assert_allclose(recording.time_s, 1e-3 * RUN["time_s"], rtol=0.0, atol=1e-12)
    with pytest.raises(InputFileError, match=rf'the nearest is "log\.rig\.run\.{dimension}" \(there are: log\.rig'):
        read_recording(file, chart=chart(tmp_path, f'columns.time_s = {{ from = "log.rig.run.{dimension}s" }}\n'))
