"""UFF58 and TDMS: pyuff writes, this package reads; what pyuff itself gets wrong is kept here."""

from __future__ import annotations

import importlib
import importlib.util
import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from gearpoly.recording.read import read_recording
from tests import recording_files as files
from tests.made_readings import needs, refusal

ANGLE = np.arange(10.0)


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
    np.testing.assert_array_equal(read_recording(file).time_s, wave["wf_start_offset"] + 0.25 * ANGLE)
    save({}, {})
    assert read_recording(file).time_s is None


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
    first, second = np.cumsum(rng.uniform(1.0, 100.0, (2, count)), axis=1)
    first[:2] = -2.0, -1.0  # the second looks like the mark of a set's end
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
    """pyuff 2.5.8; where one of these turns, docs/explanation/libraries.md can be mended."""
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
    save("", 10**7)
    assert "bytes of text" in refusal(file).found
    save("", 10**8)
    assert "3052 MB to read" in refusal(file).found
    save("", 10**10)
    assert "header" in refusal(file).found or "larger" in refusal(file).found
