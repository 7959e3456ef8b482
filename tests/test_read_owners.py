"""What owners' columns state in ways of their own: multiples of units, clocks of computers, quantities in parts."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.by_readings import since_1970, wrapped_unit
from gearpoly.recording.map_text import map_text
from gearpoly.recording.meaning import meanings
from gearpoly.recording.quantities import ANGLE, SPEED, TIME, TORQUE, unit_written, units_written
from gearpoly.recording.read import read_recording
from gearpoly.recording.survey import _clock, survey
from gearpoly.recording.table import Channel
from tests.made_texts import DEGREE, chart, run, same, table, written

RUN = run(1200)
TIME_S, DRIVING, DRIVEN = (RUN[name] for name in ("time_s", "driving_angle_deg", "driven_angle_deg"))
ANGLES = ("Input angle [deg]", "Output angle [deg]")
LINE = re.compile(r"(?:columns|keys|text)\.\w+ = (?:\{[^}]*\}|\"[^\"]*\"|[\d.]+)")


@pytest.mark.parametrize("written_as", ["100Nm", "100 N.m", "20 kNm", "3000 rpm"])
def test_what_a_sensor_reaches_is_no_unit(written_as: str) -> None:
    """Of a sensor that is called T12/100Nm the readings are in N.m: as a multiple they came out 100 times too large."""
    assert all(unit_written(written_as, dimension) is None for dimension in (TORQUE, SPEED))


@pytest.mark.parametrize(
    ("written_as", "dimension", "size"),
    [
        ("0.01 deg", ANGLE, 0.01),
        ("0,1°", ANGLE, 0.1),
        ("1/100 deg", ANGLE, 0.01),
        ("1e-3 rad", ANGLE, 0.18 / math.pi),
        ("10 ms", TIME, 0.01),
        ("0.1 Nm", TORQUE, 0.1),
        ("1 Nm", TORQUE, 1.0),
        ("0.1 rpm", SPEED, 0.1),
        ("1/min", SPEED, 1.0),
        ("1/s", SPEED, 60.0),
    ],
)
def test_a_number_before_a_unit_is_a_multiple_of_it(written_as: str, dimension: str, size: float) -> None:
    unit = unit_written(written_as, dimension)
    assert unit is not None
    assert math.isclose(unit.size, size, rel_tol=1e-12)
    again = unit_written(unit.name, dimension)  # a map states it by its name
    assert again is not None
    assert math.isclose(again.size, size, rel_tol=1e-5)


@pytest.mark.parametrize("text", ["0 deg", "2", "1.5.2 deg", "0.1 0.1 deg", "3 4", "1/0 deg"])
def test_what_is_no_multiple_of_a_unit(text: str) -> None:
    assert units_written(text) == ()


def test_angles_in_hundredths_of_a_degree(tmp_path: Path) -> None:
    columns = [TIME_S * 1e2, DRIVING * 100.0, DRIVEN * 100.0]
    names = ("t [10 ms]", "input angle (0.01 deg)", "output angle {0.01 deg}")
    file = written(tmp_path, table(columns, names, separator=",", decimal=".", digits=3))
    found = read_recording(file)
    same(found.time_s, TIME_S, half=0.5e-5)
    same(found.driven_angle_rad, DRIVEN * DEGREE, half=0.5e-5 * DEGREE)
    mapped = read_recording(file, chart=chart(tmp_path, map_text(survey(file)[0])))
    np.testing.assert_allclose(mapped.driven_angle_rad, found.driven_angle_rad, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "turn"), [("rev", 1.0), ("arcmin", 21_600.0), ("arcsec", 1_296_000.0), ("mdeg", 360_000.0),
                       ("urad", 2e6 * math.pi), ("mgon", 400_000.0), ("0.1 deg", 3600.0), ("0.01 deg", 36_000.0)],
)  # fmt: skip
def test_more_units_are_told_by_where_they_begin_again(tmp_path: Path, name: str, turn: float) -> None:
    """An angle in turns that is called degrees would else be one that trembles by a degree."""
    turned = 0.031 * np.arange(800)
    unit = wrapped_unit(np.mod(turned, 1.0) * turn)
    assert unit is not None and unit.name == name
    columns = [TIME_S, DRIVING * turn / 360.0, DRIVEN * turn / 360.0]
    file = written(tmp_path, table(columns, ("Time [s]", *ANGLES), separator=",", decimal=".", digits=7))
    with pytest.raises(InputFileError, match=f"begin again after one turn as in {name}") as caught:
        read_recording(file)
    lines = LINE.findall(caught.value.wish)
    assert len(lines) == 2  # both are told at once
    found = read_recording(file, chart=chart(tmp_path, "\n".join(lines)))
    same(found.driven_angle_rad, DRIVEN * DEGREE, half=0.5e-7 * 360.0 / turn * DEGREE)


@pytest.mark.parametrize(("unit", "per"), [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_clocks_of_computers_count_from_1970(tmp_path: Path, unit: str, per: float) -> None:
    """A double holds 1.8e9 s to 2e-7 s, and 1.8e18 ns to 256 ns."""
    counted = 1_770_000_000.0 * per + np.rint(TIME_S * per)
    lines = ["time,input angle [deg],output angle [deg]"]
    lines += [f"{t:.0f},{a:.5f},{b:.5f}" for t, a, b in zip(counted, DRIVING, DRIVEN, strict=True)]
    if unit == "s":
        lines[1:] = [
            f"{1_770_000_000 + t:.3f},{a:.5f},{b:.5f}" for t, a, b in zip(TIME_S, DRIVING, DRIVEN, strict=True)
        ]
    found = read_recording(written(tmp_path, "\n".join(lines) + "\n"))
    assert found.time_s is not None
    assert found.time_s[0] == 0.0
    np.testing.assert_allclose(found.time_s, TIME_S, rtol=0.0, atol=0.6e-6)
    assert since_1970(np.array([5.0, 6.0])) is None


def test_seconds_beside_nanoseconds_are_one_time(tmp_path: Path) -> None:
    """Messages of robots keep their stamps so; the seconds alone would put 100 readings at one time."""
    seconds, nanos = 1_770_000_000 + np.floor(TIME_S + 0.4), np.rint((TIME_S + 0.4) % 1.0 * 1e9)
    columns = [seconds, nanos, DRIVING, DRIVEN]
    names = ("header.stamp.secs", "header.stamp.nsecs", *ANGLES)
    file = written(tmp_path, table(columns, names, separator=",", decimal=".", digits=(0, 0, 5, 5)))
    found = read_recording(file)
    assert found.time_s is not None
    np.testing.assert_allclose(found.time_s - found.time_s[0], TIME_S, rtol=0.0, atol=2e-9)
    mapped = read_recording(file, chart=chart(tmp_path, map_text(survey(file)[0])))
    np.testing.assert_array_equal(mapped.time_s, found.time_s)


def test_degrees_minutes_and_seconds_in_columns(tmp_path: Path) -> None:
    """Whole degrees alone would be read as a coarse encoder."""
    columns, names = [TIME_S], ["Time [s]"]
    for shaft, degrees in (("Input", DRIVING), ("Output", DRIVEN)):
        tenths = np.rint(degrees * 36_000.0)
        columns += [tenths // 36_000, tenths // 600 % 60, tenths % 600 / 10.0]
        names += [f"{shaft} angle deg", f"{shaft} angle min", f"{shaft} angle sec"]
    file = written(tmp_path, table(columns, names, separator=",", decimal=".", digits=(2, 0, 0, 1, 0, 0, 1)))
    found = read_recording(file)
    same(found.driving_angle_rad, DRIVING * DEGREE, half=0.5 / 36_000.0 * DEGREE)
    same(found.driven_angle_rad, DRIVEN * DEGREE, half=0.5 / 36_000.0 * DEGREE)


def test_a_trace_with_a_time_for_each_channel_and_counts(tmp_path: Path) -> None:
    """Both times are the same, so that one counts; 32 bits go round, and both encoders are asked for at once."""
    counts = [np.rint(np.unwrap(one, period=360.0) / 360.0 * per) for one, per in ((DRIVING, 2**20), (DRIVEN, 2**23))]
    counts = [np.mod(one + begin + 2**31, 2**32) - 2**31 for one, begin in zip(counts, (1.9e9, 2.1e9), strict=True)]
    names, units = ("Time", "Axis1.ActPos", "Time", "Axis2.ActPos"), ("ms", "INC", "ms", "INC")
    columns = [TIME_S * 1e3 - 2000.0, counts[0], TIME_S * 1e3 - 2000.0, counts[1]]
    file = written(tmp_path, table(columns, names, separator="\t", decimal=".", digits=(1, 0, 1, 0), units=units))
    with pytest.raises(InputFileError, match=r'columns "Axis1\.ActPos" and "Axis2\.ActPos": counts') as caught:
        read_recording(file)
    lines = LINE.findall(caught.value.wish)
    assert [line.partition(" ")[0] for line in lines] == [
        f"{kind}.{shaft}_{key}"
        for shaft in ("driving", "driven")
        for kind, key in (("columns", "count"), ("keys", "lines"), ("keys", "counts_per_line"))
    ]
    text = "\n".join(lines).replace('driving_lines = "those on its label"', f"driving_lines = {2**18}")
    with pytest.raises(InputFileError, match=r"keys\.driven_lines: .*as on its label or data sheet"):
        chart(tmp_path, text)
    text = text.replace('driven_lines = "those on its label"', f"driven_lines = {2**21}")
    found = read_recording(file, chart=chart(tmp_path, text))
    for read, wanted, per in ((found.driving_angle_rad, DRIVING, 2**20), (found.driven_angle_rad, DRIVEN, 2**23)):
        assert read is not None
        turned = np.unwrap(wanted, period=360.0)
        np.testing.assert_allclose(read - read[0], (turned - turned[0]) * DEGREE, atol=1.1 * 2.0 * math.pi / per)
    assert found.time_s is not None
    np.testing.assert_allclose(found.time_s, TIME_S - 2.0, atol=1e-9)


@pytest.mark.parametrize("name", ["Âðåìÿ, ñ", "K¹t wejœciowy [°]", "T1 [°]", "Óãîë, ì"])
def test_pieces_of_words_in_a_wrong_encoding_are_no_quantity(name: str) -> None:
    """Cyrillic and Polish letters read as western ones: no n, m or t among them makes a speed, a torque or a time."""
    (found,) = meanings({name: Channel(values=np.arange(20.0))})
    assert found.dimension in ("", ANGLE)


def test_names_in_another_encoding_are_told_and_may_be_copied(tmp_path: Path) -> None:
    names = ("時刻[s]", "入力角度[deg]", "出力角度[deg]")
    text = table([TIME_S, DRIVING, DRIVEN], names, separator=",", decimal=".")
    file = written(tmp_path, text, encoding="shift_jis")
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    lines = LINE.findall(str(caught.value))
    found = read_recording(file, chart=chart(tmp_path, "\n".join(lines)))
    same(found.driven_angle_rad, DRIVEN * DEGREE, half=0.5e-5 * DEGREE)
    assert any("a map may state it, as text.encoding" in one for one in found.remarks)
    known = survey(file, chart(tmp_path, 'text.encoding = "shift_jis"'))[0]
    assert [one.name for one in known.channels] == list(names)


@pytest.mark.parametrize(
    ("name", "near"), [("angle away", False), ("angel in", True), ("Angle In", True), ("q", False)]
)
def test_a_name_is_suggested_where_it_is_near(tmp_path: Path, name: str, near: bool) -> None:
    """angle away is no slip of angle in."""
    file = written(tmp_path, table([TIME_S, DRIVING, DRIVEN], ("t [s]", "angle in", "angle out"), separator=";"))
    with pytest.raises(InputFileError) as caught:
        read_recording(file, chart=chart(tmp_path, f'columns.driven_angle_deg = {{ from = "{name}", unit = "deg" }}'))
    assert ('the nearest is "angle in"' in caught.value.wish) == near
    assert "angle in, angle out" in caught.value.wish  # all are listed either way


@pytest.mark.long
def test_a_survey_says_what_a_comparison_would_refuse(tmp_path: Path) -> None:
    """Whatever the pair: rows from the newest to the oldest, an encoder that counts down, too few turns."""
    rising = [TIME_S, DRIVING, DRIVEN]
    for columns, words in (
        ([one[::-1] for one in rising], "time that falls from row to row"),
        ([TIME_S, DRIVING, np.mod(-DRIVEN, 360.0)], r"driven_direction = -1 \(in a map as keys.NAME\)"),
        ([one[:200] for one in rising], "want at least 1 driving turn"),
    ):
        text = table(columns, ("Time [s]", *ANGLES), separator=",", decimal=".")
        (found,) = survey(written(tmp_path, text))
        assert re.search(words, found.refusal), found.refusal
        assert found.clock is not None and math.isclose(found.clock.rate_hz, 100.0, rel_tol=1e-9)
    (whole,) = survey(written(tmp_path, table(rising, ("Time [s]", *ANGLES), separator=",", decimal=".")))
    assert not whole.refusal


@pytest.mark.parametrize(("rate", "decimals"), [(60.0, 3), (60.0, 2), (30.0, 2), (1024.0, 4), (44.1, 3)])
def test_a_rate_is_that_of_the_samples_though_times_are_rounded(rate: float, decimals: int) -> None:
    """Of 60 samples a second in whole ms two of three steps are 17 ms: the usual step says 58.8. A pause, lost rows and
    rows from the newest to the oldest change nothing; 3000 steps tell the mean to a step's rounding each."""
    time = np.delete(np.arange(3000) / rate, [77, 400, 401])
    time[1500:] += 10.0
    each = 10.0**-decimals * rate / 3000 * rate  # of the rate, by which one rounding of all steps together moves it
    for rounded in (np.round(time, decimals), np.round(time, decimals)[::-1]):
        clock = _clock(rounded)
        assert clock.rate_hz == pytest.approx(rate, abs=2.0 * each)


def test_the_rate_of_a_loop_without_a_clock_is_that_of_its_usual_step() -> None:
    """Every step of 10 ms and now and then one of 24 ms: their mean, 10.7 ms, is no step of the loop."""
    steps = np.where(np.random.default_rng(4).uniform(size=4000) < 0.05, 0.024, 0.010)
    assert _clock(np.concatenate([[0.0], np.cumsum(steps)])).rate_hz == pytest.approx(100.0)


HEAD = """LabVIEW Measurement
X_Columns\t{kind}
Date\t2026/02/03
***End_of_Header***

Channels\t2
Samples{gap}\t1200{gap}\t1200
Y_Unit_Label\tdeg{gap}\tdeg
X_Dimension\tTime{gap}\tTime
X0\t5.0E-1{gap}\t5.0E-1
Delta_X\t0.010000{gap}\t0.010000
***End_of_Header***
"""


@pytest.mark.parametrize("kind", ["Multi", "One", "No"])
def test_times_and_units_of_labview(tmp_path: Path, kind: str) -> None:
    """Abscissas stand beside each channel, beside the first, or nowhere: then they follow from start and step."""
    time = [f"{0.5 + t:.6f}" for t in TIME_S]
    angles = [[f"{one:.5f}" for one in column] for column in (DRIVING, DRIVEN)]
    blank = [""] * 1200
    if kind == "Multi":
        names, columns = "X_Value\tAngle in\tX_Value\tAngle out\tComment", [time, angles[0], time, angles[1]]
    else:
        names, columns = "X_Value\tAngle in\tAngle out\tComment", [time if kind == "One" else blank, *angles]
    rows = "\n".join("\t".join(row) for row in zip(*columns, strict=True))
    text = HEAD.format(kind=kind, gap="\t" if kind == "Multi" else "") + names + "\n" + rows + "\n"
    found = read_recording(written(tmp_path, text, name="run.lvm"))
    assert found.time_s is not None
    np.testing.assert_allclose(found.time_s, 0.5 + TIME_S, rtol=0.0, atol=1e-9)
    same(found.driven_angle_rad, DRIVEN * DEGREE, half=0.5e-5 * DEGREE)
