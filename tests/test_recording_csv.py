"""Recordings as CSV: what is read, what is refused, and what the refusal says."""

from __future__ import annotations

import csv
import math
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearpoly.errors import InputFileError
from gearpoly.recording.csv_reader import RECORDING_LIMIT_BYTES, read_csv
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from tests.at_hand import SHARED, SHIPPED

GOOD = """\
# torque_nm = 25.0
# speed_rpm = 30.0
# flank = "coast"
# driving_zero_deg = 159.2
# driven_zero_deg = -132.4
# driving_direction = -1
# made on the old rig
time_s,driving_angle_deg,driven_angle_deg
0.0,350.0,10.0
0.1,355.0,13.6
0.2,0.0,17.2
"""


def write(folder: Path, text: str | bytes) -> Path:
    file = folder / "rec.csv"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return file


def refusal(folder: Path, text: str | bytes) -> InputFileError:
    file = write(folder, text)
    with pytest.raises(InputFileError) as caught:
        read_csv(file)
    error = caught.value
    assert error.file == str(file)
    assert str(error).startswith(str(file))
    assert "\n" not in str(error)
    return error


def assert_radians(actual: npt.NDArray[np.float64] | None, degrees: list[float]) -> None:
    # Two roundings, of the factor pi/180 and of the product: 4e-16 relative at most.
    assert actual is not None
    np.testing.assert_allclose(actual, np.radians(degrees), rtol=4e-16, atol=0.0)


def test_columns_and_keys_arrive_in_radians_as_read(tmp_path: Path) -> None:
    recording = read_csv(write(tmp_path, GOOD))
    assert recording.size == 3
    assert recording.source == tmp_path / "rec.csv"
    assert recording.time_s is not None
    assert recording.time_s.tolist() == [0.0, 0.1, 0.2]
    # Neither the wrap nor the direction is undone here.
    assert_radians(recording.driving_angle_rad, [350.0, 355.0, 0.0])
    assert_radians(recording.driven_angle_rad, [10.0, 13.6, 17.2])
    assert recording.te_rad is recording.te_mm is None
    assert recording.torque_samples_nm is recording.speed_samples_rpm is None
    assert (recording.torque_nm, recording.speed_rpm) == (25.0, 30.0)
    assert recording.flank == "coast"
    assert recording.driving_zero_rad == pytest.approx(math.radians(159.2), rel=4e-16)
    assert recording.driven_zero_rad == pytest.approx(math.radians(-132.4), rel=4e-16)
    assert (recording.driving_direction, recording.driven_direction) == (-1, 1)


def test_defaults_without_comment_lines(tmp_path: Path) -> None:
    text = "driven_angle_deg,driving_angle_deg\n1.0,2.0\n"
    recording = read_csv(write(tmp_path, text))
    assert_radians(recording.driving_angle_rad, [2.0])
    assert recording.flank == "drive"
    assert recording.time_s is None
    assert recording.torque_nm is recording.speed_rpm is None
    assert recording.driving_zero_rad is recording.driven_zero_rad is None
    assert (recording.driving_direction, recording.driven_direction) == (1, 1)


@pytest.mark.parametrize(
    ("column", "field", "per_unit"),
    [
        ("te_um", "te_mm", 1e-3),
        ("te_urad", "te_rad", 1e-6),
        ("te_arcsec", "te_rad", math.pi / 648_000.0),
    ],
)
@pytest.mark.parametrize("angle", ["driving_angle_deg", "driven_angle_deg"])
def test_transmission_error_needs_one_angle(
    tmp_path: Path, column: str, field: str, per_unit: float, angle: str
) -> None:
    recording = read_csv(write(tmp_path, f"{column},{angle}\n-12.5,90.0\n"))
    # Up to three roundings stand between the two ways to the factor.
    assert getattr(recording, field)[0] == pytest.approx(-12.5 * per_unit, rel=7e-16)
    other = "te_rad" if field == "te_mm" else "te_mm"
    assert getattr(recording, other) is None


def test_torque_and_speed_per_sample(tmp_path: Path) -> None:
    text = "# torque_nm = 25\ndriving_angle_deg,driven_angle_deg,torque_nm,speed_rpm\n1,2,24.5,30\n3,4,25.5,31\n"
    recording = read_csv(write(tmp_path, text))
    assert recording.torque_samples_nm is not None
    assert recording.speed_samples_rpm is not None
    assert recording.torque_samples_nm.tolist() == [24.5, 25.5]
    assert recording.speed_samples_rpm.tolist() == [30.0, 31.0]
    assert recording.torque_nm == 25.0


def test_noise_below_zero_torque_is_fine_but_backward_torque_is_not(tmp_path: Path) -> None:
    head = "driving_angle_deg,driven_angle_deg,torque_nm\n"
    assert read_csv(write(tmp_path, head + "1,2,0.1\n3,4,-0.05\n5,6,0.02\n")).size == 3
    with pytest.raises(InputFileError) as error:
        read_recording(write(tmp_path, head + "1,2,-25\n3,4,-25\n5,6,-24\n"))
    assert error.value.where == "column torque_nm"
    assert "-25" in error.value.found
    assert "flank" in error.value.wish


def test_arrays_are_float64_and_read_only(tmp_path: Path) -> None:
    recording = read_csv(write(tmp_path, GOOD))
    for array in (recording.time_s, recording.driving_angle_rad, recording.driven_angle_rad):
        assert array is not None
        assert array.dtype == np.float64
        assert not array.flags.writeable


@pytest.mark.parametrize(
    "text",
    [
        GOOD.replace("\n", "\r\n"),
        GOOD.replace("\n", "\r"),
        "\ufeff" + GOOD,
        GOOD + "\n\r\n   \n",
        GOOD.rstrip("\n"),
        "\n" + GOOD.replace("# ", "#"),
        GOOD.replace(",", " , "),
        GOOD.replace("time_s,driving_angle_deg", '"time_s","driving_angle_deg"'),
        GOOD.replace("350.0", '"350.0"').replace("0.1,", ' "0.1" ,'),
        GOOD.replace("= 25.0", "= 25.0  # at the brake"),
        GOOD.replace("# made on the old rig", "# room = 21.5"),
        GOOD.replace("350.0", "3.5e2"),
    ],
)
def test_harmless_differences_of_writing_change_nothing(tmp_path: Path, text: str) -> None:
    want = read_csv(write(tmp_path, GOOD))
    got = read_csv(write(tmp_path, text))
    for name in ("time_s", "driving_angle_rad", "driven_angle_rad"):
        np.testing.assert_array_equal(getattr(got, name), getattr(want, name))
    assert (got.torque_nm, got.flank) == (want.torque_nm, want.flank)


@pytest.mark.parametrize("cell", ["", "nan", "NaN", " ", '""'])
def test_drop_outs_are_kept_as_nan(tmp_path: Path, cell: str) -> None:
    recording = read_csv(write(tmp_path, GOOD.replace("355.0", cell)))
    assert_radians(recording.driving_angle_rad, [350.0, math.nan, 0.0])
    assert_radians(recording.driven_angle_rad, [10.0, 13.6, 17.2])


HEADER = "time_s,driving_angle_deg,driven_angle_deg"


@pytest.mark.parametrize(
    ("before", "after", "where", "found", "wish"),
    [
        # Columns.
        ("driven_angle_deg\n", "driven_angle\n", "line 8", '"driven_angle"', '"driven_angle_deg"'),
        ("time_s,", "Time_s,", "line 8", '"Time_s"', 'nearest known column is "time_s"'),
        (
            "time_s,",
            "driven_angle_deg,",
            'columns "driven_angle_deg (column 1)" and "driven_angle_deg (column 3)"',
            "is the name of columns 1 and 3",
            "--map map.toml",
        ),
        ("time_s,", ",", "line 8", "column 1 has no name", "time_s"),
        (",driven_angle_deg\n", ",torque_nm\n", "line 8", "no column driven_angle_deg", "te_um"),
        (
            HEADER,
            "te_um,time_s,torque_nm",
            "line 8",
            "no column driving_angle_deg and no",
            "one of",
        ),
        (HEADER, HEADER.replace(",", ";"), "", "3 columns of numbers without names", 'from = "column 1"'),
        (HEADER, HEADER.replace(",", "\t"), "", "3 columns of numbers without names", 'from = "column 1"'),
        (HEADER + "\n", "", "", "3 columns of numbers without names", "want a line of names above"),
        # Rows.
        ("355.0", "abc", "line 10, column driving_angle_deg", '"abc"', "a finite number"),
        ("355.0", "3_5", "line 10, column driving_angle_deg", '"3_5"', "a finite number"),
        ("355.0", "inf", "line 10, column driving_angle_deg", '"inf"', "nan for a drop-out"),
        ("355.0", "1e999", "line 10, column driving_angle_deg", '"1e999"', "a finite number"),
        ("355.0", "\u0663", "line 10, column driving_angle_deg", '"\u0663"', "a finite number"),
        ("355.0,", "", "line 10", "2 cells", "want 3, as in the header"),
        ("0.1,355.0", "0,1,355,0", "line 10", "5 cells", "decimal points, not commas"),
        # The last line of a logger that was stopped while it wrote.
        ("0.2,0.0,17.2\n", "0.2,0", "line 11", "2 cells", "looks cut off, delete it"),
        # Comment keys.
        ("# torque_nm", "# torque", "line 1", '"torque"', 'nearest known key is "torque_nm"'),
        ("# torque_nm", "# Torque_Nm", "line 1", '"Torque_Nm"', '"torque_nm"'),
        ("# driving_zero_deg", "# driving_zero", "line 4", '"driving_zero"', '"driving_zero_deg"'),
        ("made on the old rig", "flank = 'coast'", "line 7", "flank a second time", "once"),
        ('"coast"', "coast", "line 3", "flank = coast", "text in quotes"),
        ('"coast"', '"left"', "line 3", 'flank = "left"', '"drive" or "coast"'),
        ("= 25.0", "= 25,0", "line 1", "torque_nm = 25,0", "a number with a decimal point"),
        ("= 25.0", "= -25.0", "line 1", "torque_nm = -25.0", "0 or more"),
        ("= 25.0", "= nan", "line 1", "torque_nm = nan", "a torque in N.m"),
        ("= 25.0", "= true", "line 1", "torque_nm = true", "a torque in N.m"),
        ("= 25.0", '= "25"', "line 1", 'torque_nm = "25"', "a torque in N.m"),
        ("= 25.0", "=", "line 1", "torque_nm = ", "a TOML value"),
        ("= 30.0", "= 0", "line 2", "speed_rpm = 0", "above 0"),
        ("= 159.2", "= inf", "line 4", "driving_zero_deg = inf", "finite"),
        ("= -1\n", "= 2\n", "line 6", "driving_direction = 2", "-1 where the encoder counts down"),
    ],
)
def test_bad_file_names_its_line(tmp_path: Path, before: str, after: str, where: str, found: str, wish: str) -> None:
    assert GOOD.count(before) >= 1
    error = refusal(tmp_path, GOOD.replace(before, after, 1))
    assert error.where == where
    assert found in error.found
    assert wish in error.wish


@pytest.mark.long
def test_fault_far_down_is_found_by_its_line(tmp_path: Path) -> None:
    # More rows than one chunk of the fast parser, so that the slow pass must count from the top.
    rows = "".join(f"{i},{i},{i}\n" for i in range(120_000))
    error = refusal(tmp_path, f"# flank = 'drive'\n{HEADER}\n{rows}1,2,x\n{rows}")
    assert error.where == "line 120003, column driven_angle_deg"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (b"", "an empty file"),
        (b"# flank = 'drive'\n\n", "no header row"),
        (HEADER.encode() + b"\n\n", "no rows under the header"),
        (HEADER.encode() + b"\n1,,2\n2,nan,3\n", "not one number"),
        (b"\x89HDF\r\n\x1a\n\0\0\0\0", "not a text file"),
        (b"PAR1\x15\x04\x15\xf0", "text without a table of numbers"),
        (GOOD.encode() + b"0.3,\xff,1\n", "byte 0xff, which is not UTF-8"),
        (b"x" * (2**20 + 1), "no line end from byte 0 to 1048576"),
    ],
)
def test_file_that_is_no_recording(tmp_path: Path, text: bytes, found: str) -> None:
    error = refusal(tmp_path, text)
    assert found in error.found
    assert error.wish.startswith("want ")


@pytest.mark.long
def test_not_utf8_names_the_line(tmp_path: Path) -> None:
    assert refusal(tmp_path, GOOD.encode() + b"0.3,\xff,1\n").where == "line 12"
    assert refusal(tmp_path, GOOD.encode() + b"0.3,1,1\n" * 9000 + b"\xff").where == "line 9012"


def test_file_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="no such file"):
        read_csv(tmp_path / "absent.csv")
    with pytest.raises(InputFileError, match="a folder"):
        read_csv(tmp_path)
    huge = tmp_path / "huge.csv"
    with huge.open("wb") as stream:
        stream.truncate(RECORDING_LIMIT_BYTES + 1)  # sparse: takes no room
    with pytest.raises(InputFileError, match="larger than 4 GB"):
        read_csv(huge)


cells = st.floats(-1e9, 1e9) | st.just(math.nan)


@pytest.mark.long
@settings(max_examples=60, deadline=None)
@given(
    rows=st.lists(st.tuples(cells, cells, cells), max_size=20),
    order=st.permutations(["time_s", "driving_angle_deg", "te_urad"]),
    empty=st.booleans(),
)
def test_any_table_is_read_back(rows: list[tuple[float, float, float]], order: list[str], empty: bool) -> None:
    table = [(1.0, 2.0, 3.0), *rows]  # one whole row, since a column without a number is refused

    def cell(value: float) -> str:
        return "" if empty and math.isnan(value) else repr(value)

    text = "\n".join([",".join(order), *(",".join(map(cell, row)) for row in table)])
    with tempfile.TemporaryDirectory() as folder:
        recording = read_csv(write(Path(folder), text))
    columns = dict(zip(order, zip(*table, strict=True), strict=True))
    np.testing.assert_array_equal(recording.time_s, columns["time_s"])
    assert_radians(recording.driving_angle_rad, list(columns["driving_angle_deg"]))
    assert recording.te_rad is not None
    # Two roundings, of 1e-6 and of the product.
    np.testing.assert_allclose(recording.te_rad, np.array(columns["te_urad"]) / 1e6, rtol=4e-16, atol=0.0)


@pytest.mark.long
@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_a_damaged_file_is_read_or_refused(data: st.DataObject) -> None:
    start = data.draw(st.integers(0, len(GOOD)))
    stop = data.draw(st.integers(start, min(len(GOOD), start + 30)))
    junk = data.draw(st.binary(max_size=8) | st.text(max_size=8).map(str.encode))
    with tempfile.TemporaryDirectory() as folder:
        file = write(Path(folder), GOOD[:start].encode() + junk + GOOD[stop:].encode())
        try:
            assert read_csv(file).size >= 1
        except InputFileError as error:
            assert error.wish


@pytest.mark.long
def test_recordings_agree_with_a_plain_reading() -> None:
    files = [*SHIPPED.glob("*/*.csv"), *SHARED.glob("*/*.csv"), *SHARED.glob("*/*/*.csv")]
    assert files
    for file in files:
        recording = read_csv(file)
        with file.open(encoding="utf-8", newline="") as stream:
            comments = [line for line in stream if line.startswith("#")]
            stream.seek(0)
            rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
        assert recording.size == len(rows)
        assert recording.flank == ("coast" if '# flank = "coast"\n' in comments else "drive")
        for name, field in {
            "driving_angle_deg": "driving_angle_rad",
            "driven_angle_deg": "driven_angle_rad",
        }.items():
            if name in rows[0]:
                assert_radians(getattr(recording, field), [float(row[name]) for row in rows])
        assert recording.time_s is not None
        np.testing.assert_array_equal(recording.time_s, [float(row["time_s"]) for row in rows])
        if "te_arcsec" in rows[0]:
            assert recording.te_rad is not None
            assert recording.driving_angle_rad is None
            arcsec = np.array([float(row["te_arcsec"]) for row in rows])
            # Three roundings: of the factor, of the product and of the division by 3600.
            np.testing.assert_allclose(recording.te_rad, np.radians(arcsec / 3600.0), rtol=7e-16, atol=0.0)


@pytest.mark.parametrize(
    "arrays",
    [
        {},
        {"driving_angle_rad": [1.0]},
        {"te_rad": [1.0]},
        {"te_rad": [1.0], "te_mm": [1.0]},
        {"driving_angle_rad": [1.0], "driven_angle_rad": [1.0, 2.0]},
        {"driving_angle_rad": [[1.0]], "driven_angle_rad": [[1.0]]},
    ],
)
def test_recording_refuses_arrays_that_do_not_fit(arrays: dict[str, list[float]]) -> None:
    held = {name: np.array(values) for name, values in arrays.items()}
    with pytest.raises(ValueError, match="a recording"):
        Recording(source=Path("rig"), **held)  # type: ignore[arg-type]
