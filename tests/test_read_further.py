"""Further files that owners have: clocks of Windows, controllers' milliseconds, apps of phones, analog angles, channels
of one encoder, and quantities that are no angle of a shaft."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.by_readings import begins_again_about, begins_again_at, swings
from gearpoly.recording.read import read_recording
from gearpoly.recording.survey import survey
from tests.made_texts import DEGREE, chart, run, same, table, written

RUN = run(1200)
TIME_S, DRIVING, DRIVEN, TORQUE = RUN.values()
LINE = re.compile(r"(?:columns|keys)\.\w+ = (?:\{[^}]*\}|\"[^\"]*\"|[\d.]+)")
ANGLES = ("Input angle [deg]", "Output angle [deg]")


def made(tmp_path: Path, names: tuple[str, ...], *columns: np.ndarray, digits: int | tuple[int, ...] = 5) -> Path:
    return written(tmp_path, table(columns, names, separator=",", decimal=".", digits=digits))


def asked(file: Path) -> InputFileError:
    with pytest.raises(InputFileError) as caught:
        read_recording(file)
    return caught.value


@pytest.mark.parametrize("begin", [133_900_000_000_000_000, 639_000_000_000_000_000])
def test_ticks_of_windows_are_a_time(tmp_path: Path, begin: int) -> None:
    """Of its files, from 1601, and of its programs, from the year 1; a double holds them to 64 ticks."""
    rows = [f"{begin + k * 100_000},{a:.5f},{b:.5f}" for k, (a, b) in enumerate(zip(DRIVING, DRIVEN, strict=True))]
    file = written(tmp_path, "\n".join([",".join(("TimeStamp", *ANGLES)), *rows, ""]))
    found = read_recording(file)
    same(found.time_s, TIME_S, half=2e-5)


def test_milliseconds_beside_stamps_in_whole_seconds(tmp_path: Path) -> None:
    begin = 0.37
    rows = []
    for t, a, b in zip(TIME_S + begin, DRIVING, DRIVEN, strict=True):
        second = int(t + 1e-9)
        rows.append(f"03/04/2026,10:15:{second:02d},{round((t - second) * 1e3)},{a:.5f},{b:.5f}")
    file = written(tmp_path, "\n".join([",".join(("Date", "Time", "Millitm", *ANGLES)), *rows, ""]))
    found = read_recording(file)
    same(found.time_s, TIME_S, half=1e-9)


@pytest.mark.parametrize("name", ["seconds_elapsed", "Elapsed [s]", "ts_s", "milliseconds"])
def test_further_words_for_a_time(tmp_path: Path, name: str) -> None:
    scale = 1e3 if name == "milliseconds" else 1.0
    found = read_recording(made(tmp_path, (name, *ANGLES), TIME_S * scale, DRIVING, DRIVEN))
    same(found.time_s, TIME_S, half=1e-6)


@pytest.mark.parametrize("full", [10.0, 5.0])
def test_an_analog_angle_is_offered_with_what_it_begins_again_at(tmp_path: Path, full: float) -> None:
    volts = [one / 360.0 * full for one in (DRIVING, DRIVEN)]
    file = made(tmp_path, ("t [s]", "Input angle [V]", "Output angle [V]"), TIME_S, *volts, digits=7)
    lines = LINE.findall(asked(file).wish)
    read = read_recording(file, chart=chart(tmp_path, "\n".join(lines)))
    assert read.driven_angle_rad is not None
    apart = np.angle(np.exp(1j * (read.driven_angle_rad - DRIVEN * DEGREE)))
    assert np.max(np.abs(apart)) < 1e-6 * 60.0


def test_what_begins_again_nowhere_has_no_such_number() -> None:
    assert begins_again_at(np.arange(2000.0)) is None
    assert begins_again_at(np.sin(np.arange(2000) / 10.0)) is None
    assert begins_again_at(np.random.default_rng(1).standard_normal(2000)) is None


@pytest.mark.parametrize("share", [0.1, 0.3, 0.6, 0.9])
@pytest.mark.parametrize("modulus", [3_600_000, 360_000, 777_777, 2**20, 4_000_037])
@pytest.mark.parametrize("low", [0, 1])
def test_what_counts_begin_again_at_is_not_told_wrong(share: float, modulus: int, low: int) -> None:
    """Wraps come at one place of the shaft, here where its speed changes most or little: 3 599 990 was told for
    3 600 000, since the jumps agreed to two counts. Any number is told in full only if it is right, else with a doubt
    that holds it."""
    time = np.arange(12_000) / 100.0
    turned = 0.5 * time
    turned = turned + 4e-6 * np.sin(18.0 * 2.0 * np.pi * (turned + share))
    counts = np.mod(np.floor(turned * modulus) + low * modulus // 2, modulus) - low * modulus // 2
    about = begins_again_about(counts)
    assert about is not None
    assert abs(about[0] - modulus) <= about[1] <= 2e-5 * modulus
    told = begins_again_at(counts)
    assert told == (None if modulus in (777_777, 4_000_037) else modulus)


def test_doubtful_counts_are_offered_with_the_lines_to_fill_in(tmp_path: Path) -> None:
    """777 777 counts a turn were offered as 777 776: half a degree lost in 1400 turns."""
    time = np.arange(6000) / 100.0
    turned = [0.5 * time + 4e-6 * np.sin(18.0 * np.pi * time + 1.0), 0.36 * time]
    counts = [np.mod(np.floor(one * 777_777), 777_777) for one in turned]
    file = made(tmp_path, ("t [s]", "c1", "c2"), time, *counts, digits=(3, 0, 0))
    wish = asked(file).wish
    assert "wraps" not in wish
    lines = LINE.findall(wish)
    for line in lines:
        if told := re.search(r"begin again at about (\d+) \+- (\d+)", line):
            assert abs(int(told[1]) - 777_777) <= int(told[2]) <= 20
    text = re.sub(r'lines = "those on its label[^"]*"', "lines = 777777", "\n".join(lines)).replace("= 4", "= 1")
    assert text.count("777777") == 2
    read = read_recording(file, chart=chart(tmp_path, text))
    for angle, turns in zip((read.driving_angle_rad, read.driven_angle_rad), turned, strict=True):
        assert angle is not None
        assert np.max(np.abs(angle / (2.0 * np.pi) - (turns - turns[0]))) <= 1.01 / 777_777


def test_volts_of_no_round_number_are_offered_with_their_doubt(tmp_path: Path) -> None:
    """9.8765 V a turn were offered as 9.88 V, a tenth of a degree too much each turn."""
    time = np.arange(6000) / 100.0
    volts = [np.mod(one * 9.8765, 9.8765) for one in (0.5 * time, 0.36 * time + 4e-5 * np.sin(30.0 * time))]
    file = made(tmp_path, ("t [s]", "Input angle [V]", "Output angle [V]"), time, *volts, digits=5)
    wish = asked(file).wish
    told = re.findall(r'scale = "1 / wraps", wraps = "about ([\d.]+) \+- ([\d.]+)"', wish)
    assert len(told) == 2
    assert all(abs(float(middle) - 9.8765) <= float(doubt) for middle, doubt in told)


def test_a_and_b_of_one_encoder_are_told_as_such(tmp_path: Path) -> None:
    t = np.arange(8000) / 2000.0
    levels = [2.5 + 2.5 * np.sign(np.sin(2.0 * np.pi * 100.0 * t + lead)) for lead in (0.3, 0.3 + np.pi / 2.0)]
    wish = asked(made(tmp_path, ("time [s]", "Encoder_A", "Encoder_B"), t, *levels)).wish
    assert "as many edges" in wish
    levels[1] = 2.5 + 2.5 * np.sign(np.sin(2.0 * np.pi * 72.0 * t + 0.3))
    assert "as many edges" not in asked(made(tmp_path, ("time [s]", "CH1", "CH2"), t, *levels)).wish


@pytest.mark.parametrize("name", ["backlash [arcmin]", "Diff [arcsec]", "tilt [mrad]", "Flankenspiel [arcmin]"])
def test_small_angles_are_no_shaft(tmp_path: Path, name: str) -> None:
    small = 5.0 + np.sin(40.0 * TIME_S)
    error = asked(made(tmp_path, ("t [s]", "Input angle [deg]", name), TIME_S, DRIVING, small))
    assert not LINE.findall(error.wish)


def test_what_swings_is_told_from_what_turns() -> None:
    assert swings(np.sin(np.arange(3000) / 10.0)) and swings(np.zeros(3000))
    assert not swings(DRIVING) and not swings(np.unwrap(DRIVING, period=360.0))
    forth_and_back = np.abs(np.arange(-600.0, 600.0))
    assert not swings(forth_and_back)


@pytest.mark.parametrize("name", ["kinematic error [arcsec]", "Transmission error [arcsec]"])
def test_an_angle_and_an_error_are_asked_for_together(tmp_path: Path, name: str) -> None:
    """An angle whose name says no shaft is enough beside a transmission error."""
    file = made(tmp_path, ("Pinion rotation [deg]", name), DRIVING, 20.0 * np.sin(DRIVING * DEGREE))
    read = read_recording(file, chart=chart(tmp_path, "\n".join(LINE.findall(asked(file).wish))))
    assert read.te_rad is not None and read.driving_angle_rad is not None


def test_an_angle_without_a_unit_is_asked_for_with_its_turns(tmp_path: Path) -> None:
    held = [np.unwrap(one, period=360.0) * DEGREE for one in (DRIVING, DRIVEN)]
    (first, _) = survey(made(tmp_path, ("t [s]", "Input angle", "Output angle"), TIME_S, *held))[0].doubts
    assert "6 turns in rad" in first.says
