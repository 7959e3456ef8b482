"""Guide logs of telescopes: what a star shows of the gears before a worm, read from PHD2's own files."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.clock import found, turned
from gearpoly.errors import InputFileError
from gearpoly.keys.sections import WormSection
from gearpoly.physics.place import Place
from gearpoly.recording.map_file import read_map
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.units import ARCSEC, DEG, FloatArray
from tests.made_command import Command
from tests.made_guide_log import DECLINATION, EQ6, HEADER, PERIOD, RATE, SCALE, axis_error, made_log
from tests.made_texts import table, written
from tests.physics_cases import Condition, rough, scope_of

LOGS = Path(__file__).parents[2] / "shared" / "recordings" / "guide_logs"


@pytest.mark.parametrize("per_ms", [False, True])
def test_pulses_and_re_aimings_are_undone(tmp_path: Path, per_ms: bool) -> None:
    """What comes out is the error that went in: pulses, a dither, declination and both units of rate undone."""
    log = tmp_path / "log.txt"
    text, time, error = made_log(per_ms=per_ms)
    log.write_text(text, encoding="utf-8")
    read = read_recording(log, worm=EQ6)
    assert read.time_s is not None
    assert read.te_rad is not None
    np.testing.assert_allclose(read.time_s, time, atol=1e-3)  # written to ms
    held = np.isfinite(read.te_rad)
    assert np.flatnonzero(~held).tolist() == [90]
    # The lock position is written to 0.001 px, offsets to 0.0001 px.
    np.testing.assert_allclose(read.te_rad[held], 180 * error[held] * ARCSEC, atol=180 * 0.01 * ARCSEC)
    assert read.driven_angle_rad is not None
    np.testing.assert_allclose(read.driven_angle_rad, 2.0 * math.pi * read.time_s / PERIOD, rtol=1e-12)
    assert any("re-aimed 1 time (1 dither)" in one for one in read.remarks)


def test_pulses_are_what_the_worm_may_have_turned(tmp_path: Path) -> None:
    """A pulse of 1000 ms to the west at 2.4 px/s turns the axis by 2.4 px, and the worm 180 times as far."""
    rows = "\n".join(f'{k},{2 * k}.0,"Mount",0,0,0.1,0,0,0,{1000 if k == 5 else 0},W,0' for k in range(1, 101))
    log = tmp_path / "log.txt"
    log.write_text(HEADER + rows, encoding="utf-8")
    read = read_recording(log, worm=EQ6)
    assert read.driven_correction_rad is not None
    step = RATE * SCALE / math.cos(math.radians(DECLINATION)) / 3600.0 * 180.0 * DEG
    np.testing.assert_allclose(read.driven_correction_rad[:5], 0.0)
    np.testing.assert_allclose(read.driven_correction_rad[5:], step, rtol=1e-12)


def test_the_map_that_read_writes_of_a_log_is_taken(tmp_path: Path, gearpoly_command: Command) -> None:
    """With the map as without it: the error that went in, and what the pulses sent (the axis halves what it sees)."""
    log, lines = tmp_path / "log.txt", tmp_path / "map.toml"
    text, time, error = made_log()
    log.write_text(text, encoding="utf-8")
    gearpoly_command("read", log, "--write", lines)
    read, plain = read_recording(log, worm=EQ6, chart=read_map(lines)), read_recording(log, worm=EQ6)
    assert read.time_s is not None and read.te_rad is not None and read.driven_correction_rad is not None
    np.testing.assert_allclose(read.time_s, time, atol=1e-3)  # written to ms
    held = np.isfinite(read.te_rad)
    np.testing.assert_allclose(read.te_rad[held], 180 * error[held] * ARCSEC, atol=180 * 0.01 * ARCSEC)
    np.testing.assert_array_equal(read.driven_correction_rad, plain.driven_correction_rad)


def test_pulses_in_a_table_of_names_are_the_worm_s(tmp_path: Path) -> None:
    """A table that names the pulses says what a log says: 1 arcsec of the axis is 180 at the worm. Without an error of
    an axis there is no worm, and the column is none of the recording's."""
    time = np.arange(300.0)
    columns = [time, axis_error(time), 0.25 * np.floor(time / 10.0)]
    file = written(tmp_path, table(columns, ("time_s", "axis_error_arcsec", "axis_correction_arcsec"), decimal="."))
    read = read_recording(file, worm=EQ6)
    assert read.te_rad is not None and read.driven_correction_rad is not None
    np.testing.assert_allclose(read.te_rad, 180.0 * columns[1] * ARCSEC, atol=180.0 * 1e-5 * ARCSEC)
    np.testing.assert_allclose(read.driven_correction_rad, 180.0 * columns[2] * ARCSEC, rtol=1e-9)
    names = ("time_s", "driving_angle_deg", "driven_angle_deg", "axis_correction_arcsec")
    file = written(tmp_path, table([time, 50.0 * time, 36.0 * time, columns[2]], names, decimal="."))
    assert read_recording(file).driven_correction_rad is None


def test_the_longest_section_is_read_and_the_others_told(tmp_path: Path) -> None:
    short, _, _ = made_log(frames=100)
    long, time, _ = made_log(frames=300)
    log = tmp_path / "log.txt"
    calibration = "Calibration Begins at 2026-03-10 20:00:00\nDirection,Step,dx,dy,x,y,Dist\nWest,0,0,0,1,2,0\n"
    log.write_text("PHD2 version 2.6, Log version 2.5\n\n" + calibration + short + long[:-50], encoding="utf-8")
    read = read_recording(log, worm=EQ6)
    assert read.size == time.size - 1  # the last row was cut off
    assert "2 guiding sections and 1 calibration; section 2 was read" in read.remarks[0]
    assert "log.txt#1 (3 min)" in read.remarks[1]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (("Guiding Begins", "Calibration Begins"), "without guiding"),
        (("Pixel scale = 3.2", "Pixel scale = 0"), "no Pixel scale"),
        (("xRate = 2.4", "xRate = ?"), "no xRate"),
        (("Dec = 12.0 deg", "Dec = 88.0 deg"), "declination of 88"),
        (('"Mount"', '"AO"'), "AO"),
        (("RARawDistance", "RARaw"), "no column RARawDistance"),
        ((',"Mount",', ',"Mount",x'), "dx = x"),
        (("xRate = 2.4", "xRate = -2.4"), "xRate = -2.4"),
        ((",W,0", ",,0"), "RADirection = nothing"),
        ((",W,0", ",Ouest,0"), "RADirection = Ouest"),
        ((",E,0", ",-,0"), "with W or E"),
    ],
)
def test_what_cannot_be_read_is_one_message(tmp_path: Path, change: tuple[str, str], says: str) -> None:
    log = tmp_path / "log.txt"
    log.write_text("PHD2 version 2.6\n" + made_log()[0].replace(*change), encoding="utf-8")
    with pytest.raises(InputFileError, match=says):
        read_recording(log, worm=EQ6)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace(",W,", ",West,").replace(",E,", ",east,"),
        lambda text: text.replace("xRate = 2.4", "xRate = +2.4").replace("Dec = 12.0", "Dec = +12.0"),
        lambda text: text.replace("xRate = 2.4", "xRate = 2.4e-03"),
        lambda text: text.replace("xRate = 2.4", "xRate = 0,24E+1"),
    ],
)
def test_numbers_and_directions_in_other_writings(tmp_path: Path, change: Callable[[str], str]) -> None:
    """A pulse whose direction or rate was not understood would be read as motion of the axis."""
    text, _, error = made_log()
    log = tmp_path / "log.txt"
    log.write_text(change(text), encoding="utf-8")
    te = read_recording(log, worm=EQ6).te_rad
    assert te is not None
    held = np.isfinite(te)
    np.testing.assert_allclose(te[held], 180 * error[held] * ARCSEC, atol=180 * 0.01 * ARCSEC)


@pytest.mark.parametrize("torn", ["signed", "twice"])
def test_a_signed_pulse_is_refused_and_the_cure_works(tmp_path: Path, torn: str) -> None:
    """A duration below zero with a direction may mean either; a line that holds two is none."""
    lines = made_log()[0].splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith("200,"))
    cells = lines[at].split(",")
    lines[at] = ",".join([*cells[:9], f"-{cells[9]}", *cells[10:]]) if torn == "signed" else lines[at][:20] + lines[at]
    log = tmp_path / "log.txt"
    log.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(InputFileError, match=rf"line {at + 1}: .*delete the line if it is torn"):
        read_recording(log, worm=EQ6)
    log.write_text("\n".join([*lines[:at], *lines[at + 1 :]]) + "\n", encoding="utf-8")
    assert read_recording(log, worm=EQ6).size == len([one for one in lines if one[:1].isdigit()]) - 1


def test_a_pair_without_a_worm_says_what_is_wanted(tmp_path: Path, gearpoly_command: Command, pair_file: Path) -> None:
    log = tmp_path / "log.txt"
    log.write_text(made_log()[0], encoding="utf-8")
    ran = gearpoly_command("compare", pair_file, log)
    assert ran.code == 2
    assert "[worm]" in ran.err
    assert "wheel_teeth" in ran.err


def waves(turns: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Lines at orders 1, 47/12 and 47 of the driven shaft in noise a fifth as large as the weakest."""
    return sum(
        (a * np.cos(2.0 * math.pi * o * turns + 0.3 * o) for a, o in ((5.0, 1.0), (3.0, 47 / 12), (1.0, 47.0))),
        0.2 * rng.standard_normal(turns.size),
    )


@pytest.mark.long
@pytest.mark.parametrize(
    ("share", "rate"), [*(pytest.param(one, 1.0, marks=pytest.mark.slow) for one in (1.0, 0.0)), (0.6, 0.99727)]
)
def test_share_and_rate_are_told_by_the_lines(share: float, rate: float) -> None:
    """Pulses that move the angle by a tenth of a turn over ten: within three of the stated standard deviations."""
    rng = np.random.default_rng(3)
    time = np.sort(rng.uniform(0.0, 10.0 * PERIOD, 2400))
    angle = 2.0 * math.pi * time / PERIOD
    pulses = np.cumsum(rng.standard_normal(time.size))
    pulses *= 0.1 * 2.0 * math.pi / np.ptp(pulses)
    te = waves((rate * angle + share * pulses) / (2.0 * math.pi), rng)
    clock = found(angle, pulses, te, teeth=47, mate=12, timed=True)
    assert abs(clock.share - share) < 3.0 * clock.share_std < 0.75
    assert abs(clock.rate - rate) < 3.0 * clock.rate_std < 5e-3


def test_noise_tells_neither_share_nor_rate() -> None:
    """Red noise without a line moves the angle by less than is believed of it beforehand."""
    rng = np.random.default_rng(4)
    time = np.arange(800) * 2.0
    angle = 2.0 * math.pi * time / PERIOD
    pulses = np.cumsum(rng.standard_normal(800)) * 1e-3
    te = np.cumsum(rng.standard_normal(800))
    clock = found(angle, pulses, te, teeth=47, mate=12, timed=True)
    assert clock.log_odds < 6.0  # of 20 draws the largest was 4.4
    assert clock.share_std > 0.2


def test_an_encoder_s_angle_without_pulses_stays() -> None:
    angle = np.linspace(0.0, 50.0, 500)
    plain = Recording(source=Path("x"), driven_angle_rad=angle, te_rad=np.zeros(500))
    assert turned(plain, z_1=12, z_2=47) == (plain, None)


@pytest.mark.skipif(not LOGS.is_dir(), reason="the real guide logs are not beside this checkout")
@pytest.mark.parametrize(
    ("log", "wheel", "frames", "rms"),
    [("log01.txt", 180, 809, 4.700), ("log03.txt", 225, 666, 2.763)],
)
def test_real_logs_read(log: str, wheel: int, frames: int, rms: float) -> None:
    """Frames, and the error about a straight line in arcsec of the axis, by a calculation apart (least squares)."""
    read = read_recording(LOGS / log, worm=WormSection(wheel_teeth=wheel))
    assert read.size == frames
    assert read.te_rad is not None
    assert read.time_s is not None
    held = np.isfinite(read.te_rad)
    y = read.te_rad[held] / ARCSEC / wheel
    left = y - np.polyval(np.polyfit(read.time_s[held], y, 1), read.time_s[held])
    assert float(np.std(left)) == pytest.approx(rms, rel=0.02)


def test_an_angle_that_is_time_has_no_encoder_whose_lines_could_err(tmp_path: Path) -> None:
    """An angle written to six places at one rate is time; one that wobbles by a thousandth of a degree was read."""
    rng = np.random.default_rng(5)
    time = np.round(0.5 * np.arange(400) + 0.05 * rng.random(400), 3)
    angle = time * (360.0 / PERIOD)
    for wobble, timed in ((0.0, ("driven",)), (1e-3 * rng.standard_normal(400), ())):
        file = tmp_path / "made.csv"
        table = np.column_stack((time, (angle + wobble) % 360.0, rng.standard_normal(400)))
        np.savetxt(file, table, delimiter=",", header="time_s,driven_angle_deg,te_arcsec", comments="", fmt="%.6f")
        assert read_recording(file).from_time == timed


def test_no_wave_of_the_worm_s_shaft_is_named_of_the_gear_on_it() -> None:
    """A worm makes whole orders of its own turn; without one the same places are looked at."""
    alone = scope_of(rough(), (Condition(),))
    with_worm = replace(alone, file=alone.file.model_copy(update={"worm": EQ6}))
    for gear, seen in ((0, True), (1, False)):
        assert with_worm.shows(Place(gear=gear, order=3)) == seen
        assert alone.shows(Place(gear=gear, order=3))
    assert with_worm.shows(Place(gear=1, tooth=4))


@pytest.mark.long
def test_a_wrapped_angle_is_turned_as_the_whole_one() -> None:
    """0 to 360 deg over and over, or on and on: the same share, rate and turns."""
    rng = np.random.default_rng(6)
    time = np.sort(rng.uniform(0.0, 6.0 * PERIOD, 1200))
    angle = 2.0 * math.pi * time / PERIOD
    pulses = 0.02 * np.sin(time / 300.0)
    te = waves((angle + pulses) / (2.0 * math.pi), rng)
    told = []
    for held in (angle, angle % (2.0 * math.pi)):
        made = Recording(
            source=Path("x"), time_s=time, driven_angle_rad=held, te_rad=te, driven_correction_rad=pulses,
            from_time=("driven",),
        )  # fmt: skip
        after, clock = turned(made, z_1=12, z_2=47)
        assert after.driven_angle_rad is not None
        told.append((clock, np.ptp(after.driven_angle_rad)))
    assert told[0][1] == pytest.approx(told[1][1], rel=1e-9)
    assert told[0][0] is not None and told[1][0] is not None
    assert told[0][0].share == told[1][0].share


def test_a_recording_of_less_than_a_turn_has_no_lines_that_tell() -> None:
    angle = np.linspace(0.0, 1.0, 80)
    clock = found(angle, 0.001 * angle, np.cos(7.0 * angle), teeth=47, mate=12, timed=True)
    assert math.isfinite(clock.share) and math.isfinite(clock.rate)
