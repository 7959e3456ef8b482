"""What formats state beside the numbers: units that contradict a column's name are refused, packed values unpacked."""

from __future__ import annotations

import importlib
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import COLUMNS
from gearpoly.recording.stated_units import check_unit
from tests import recording_files as files
from tests.made_readings import needs, refusal

ANGLES = ("driving_angle_deg", "driven_angle_deg")


def write(file: Path, values: Any, attributes: dict[str, Any]) -> None:
    h5py = importlib.import_module("h5py")
    with h5py.File(file, "w") as root:
        root[ANGLES[0]] = np.arange(len(values), dtype="f8")
        root[ANGLES[1]] = values
        root[ANGLES[1]].attrs.update(attributes)


def driven(file: Path) -> Any:
    angle = read_recording(file).driven_angle_rad
    assert angle is not None
    return np.degrees(angle)


@needs("h5py")
@pytest.mark.parametrize("ending", ["h5", "mat"])
def test_packed_numbers_are_unpacked_as_cf_has_it(tmp_path: Path, ending: str) -> None:
    """value = stored scale + offset; what counts as missing is in stored numbers, before that."""
    file = tmp_path / f"rec.{ending}"
    stored = np.array([0, 100, -32768, 250, -1, 7, 3600], dtype="i2")
    write(
        file,
        stored,
        {
            "scale_factor": 0.1,
            "add_offset": 5.0,
            "_FillValue": np.int16(-32768),
            "missing_value": np.array([-1, 7], dtype="i2"),
            "units": "degrees",
        },
    )
    want = [5.0, 15.0, math.nan, 30.0, math.nan, math.nan, 365.0]
    np.testing.assert_allclose(driven(file), want, rtol=4e-16)  # one rounding by pi/180 and back
    write(file, stored, {"valid_range": np.array([0, 300], dtype="i2"), "valid_max": np.int16(100)})
    np.testing.assert_allclose(driven(file), [0, 100, math.nan, math.nan, math.nan, 7, math.nan], rtol=4e-16)
    write(file, stored, {"long_name": "angle", "scale_factor": np.array([2.0])})
    np.testing.assert_allclose(driven(file), 2.0 * stored, rtol=4e-16)


@needs("h5py")
@pytest.mark.parametrize(
    ("attributes", "found"),
    [
        ({"scale_factor": 0.0}, "scale_factor = 0.0"),
        ({"scale_factor": math.nan}, "scale_factor = nan"),
        ({"scale_factor": "0.1"}, "scale_factor = 0.1"),
        ({"scale_factor": [0.1, 0.2]}, "scale_factor"),
        ({"add_offset": math.inf}, "add_offset = inf"),
        ({"valid_range": 3.0}, "valid_range = 3.0"),
        ({"missing_value": np.zeros(2000)}, "missing_value is a long list"),
        ({"scale_factor": 1e308}, "inf"),
        ({"_Unsigned": "true"}, "_Unsigned"),
        ({"units": "rad"}, 'the unit "rad"'),
        ({"Units": "rad", "unit": "counts"}, 'the unit "counts"'),
    ],
)
def test_attributes_that_make_no_sense_are_refused(tmp_path: Path, attributes: dict[str, Any], found: str) -> None:
    file = tmp_path / "rec.h5"
    write(file, np.arange(3.0) * 100.0, attributes)
    error = refusal(file)
    assert found in error.found
    assert ANGLES[1] in error.where


@needs("nptdms")
def test_units_of_tdms_channels(tmp_path: Path) -> None:
    nptdms = importlib.import_module("nptdms")
    file = tmp_path / "rec.tdms"

    def save(unit: str) -> None:
        with nptdms.TdmsWriter(file) as writer:
            first = nptdms.ChannelObject("rig", ANGLES[0], np.arange(5.0), properties={"unit_string": "Degrees"})
            second = nptdms.ChannelObject("rig", ANGLES[1], np.arange(5.0), properties={"unit_string": unit})
            writer.write_segment([first, second])

    save("deg")
    assert read_recording(file).size == 5
    save("Volts")
    assert 'the unit "Volts"' in refusal(file).found


@needs("pyarrow")
def test_units_of_parquet_columns(tmp_path: Path) -> None:
    pa = importlib.import_module("pyarrow")
    parquet = importlib.import_module("pyarrow.parquet")
    file = tmp_path / "rec.parquet"
    for unit, good in (("deg", True), ("rad", False)):
        schema = pa.schema([pa.field(name, pa.float64(), metadata={"unit": unit}) for name in ANGLES])
        parquet.write_table(pa.table([pa.array([1.0, 2.0])] * 2, schema=schema), file)
        if good:
            assert read_recording(file).size == 2
        else:
            assert 'the unit "rad"' in refusal(file).found


def test_units_of_uff58_ordinates(tmp_path: Path) -> None:
    file = tmp_path / "rec.unv"
    files.write_uff(file, {name: np.arange(5.0) for name in ANGLES}, {}, binary=False)
    text = file.read_text(encoding="ascii")
    axis = f"{0:10d}    0    0    0 NONE                 "
    begin = text.index(axis, text.index(axis) + 1)
    for unit, good in (("deg", True), ("m/s^2", False)):
        file.write_text(text[:begin] + axis + unit + text[begin + len(axis) + 4 :], encoding="ascii")
        if good:
            assert read_recording(file).size == 5
        else:
            assert 'the unit "m/s^2"' in refusal(file).found


SPELLINGS = {
    "deg": ("degree", "degrees", "°"),
    "um": ("µm", "μm", "micrometre", "micrometres", "micrometer", "micrometers", "micron", "microns"),
    "urad": ("µrad", "μrad", "microradian", "microradians"),
    "arcsec": ("arcsecs", "arcsecond", "arcseconds", '"', "″"),
    "nm": ("n.m", "n m", "n*m", "n·m", "n⋅m", "newton metre", "newton metres", "newton meter", "newton meters"),
    "rpm": ("1/min", "r/min", "rev/min", "min-1", "min^-1", "u/min"),
    "s": ("sec", "second", "seconds"),
}


def test_every_column_knows_how_its_unit_is_written() -> None:
    for name in COLUMNS:
        ending = name.rpartition("_")[2]
        for spelling in (ending, ending.upper(), *SPELLINGS.get(ending, ()), "", "none", b"N/A"):
            check_unit(Path("x"), name, spelling)
        if ending in SPELLINGS:
            with pytest.raises(InputFileError):
                check_unit(Path("x"), name, "furlong")
    check_unit(Path("x"), "time_s", "seconds since 2026-03-01 08:00:00")
    check_unit(Path("x"), "torque_nm", "N.m")
    with pytest.raises(InputFileError, match=r"want N\.m"):
        check_unit(Path("x"), "torque_nm", "kN.m")
