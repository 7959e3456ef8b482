"""Angles that run on and on under the wrong unit: what repeats once a turn says in which the numbers are."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from gearpoly.errors import InputFileError
from gearpoly.physics.parts import EncoderErrors
from gearpoly.recording.chain import corrected
from gearpoly.recording.quantities import ANGLE, unit_written
from gearpoly.recording.read import read_recording
from gearpoly.recording.survey import survey
from tests.made_texts import DEGREE, OWN, RATIO, chart, run, same, table, written

N = 4000
SIZES = {"deg": 1.0, "rad": 180.0 / np.pi, "rev": 360.0, "gon": 0.9}
LINE = re.compile(r'(?:columns|keys)\.\w+ = (?:\{[^}]*\}|"[^"]*"|[\d.]+)')


def turned(turns: float, *, mesh: int = 18, lines: float = 1.0, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Both shafts in deg: eccentric gears (times ``lines``), a wave of the mesh and noise."""
    theta = np.linspace(3.0, 3.0 + 360.0 * turns, N)
    x = theta * DEGREE
    te = lines * (20e-6 * np.sin(x + 1.0) + 12e-6 * np.sin(RATIO * x)) + 8e-6 * np.sin(mesh * x)
    te += 2e-6 * np.random.default_rng(seed).standard_normal(N)
    return theta, RATIO * theta + te / DEGREE


def file_of(
    tmp_path: Path, angles: tuple[np.ndarray, np.ndarray], *, stated: str, true: str, own: bool = False
) -> Path:
    columns = [np.arange(N) / 500.0, *(one / SIZES[true] for one in angles)]
    names = ("t [s]", f"Input angle [{stated}]", f"Output angle [{stated}]")
    names = ("time_s", "driving_angle_deg", "driven_angle_deg") if own else names
    return written(tmp_path, table(columns, names, separator=",", decimal=".", digits=9))


@pytest.mark.long
@pytest.mark.parametrize(("stated", "true"), [(a, b) for a in SIZES for b in SIZES if a != b])
def test_another_unit_than_stated_is_told_by_what_repeats(tmp_path: Path, stated: str, true: str) -> None:
    angles = turned(60.0)
    file = file_of(tmp_path, angles, stated=stated, true=true)
    (found,) = survey(file)
    (doubt,) = [one for one in found.doubts if "comes back after" in one.says]
    assert doubt.says.endswith(f"as of {true}")
    read = read_recording(file, chart=chart(tmp_path, "\n".join(doubt.ask)))
    same(read.driven_angle_rad, angles[1] * DEGREE, half=1e-6)
    assert not any("comes back" in one for one in read.remarks)
    # As of more than half a turn from sample to sample they are nothing at all, and deg and rad are told for sure.
    if SIZES[stated] / SIZES[true] * 360.0 * 60.0 / N > 180.0 or {stated, true} == {"deg", "rad"}:
        with pytest.raises(InputFileError, match=f"as of {true}"):
            read_recording(file)
    else:
        assert any("comes back" in one for one in read_recording(file).remarks)


def test_radians_under_the_own_name_of_degrees(tmp_path: Path) -> None:
    angles = turned(60.0)
    file = file_of(tmp_path, angles, stated="deg", true="rad", own=True)
    with pytest.raises(InputFileError, match=r"comes back after 6.28319") as caught:
        read_recording(file)
    lines = "\n".join(LINE.findall(caught.value.wish))
    read = read_recording(file, chart=chart(tmp_path, lines))
    same(read.driven_angle_rad, angles[1] * DEGREE, half=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(("stated", "true", "turns"), [("deg", "rad", 25.0), ("rad", "deg", 5.0)])
def test_degrees_and_radians_that_run_on_are_refused_under_the_other_name(
    tmp_path: Path, stated: str, true: str, turns: float
) -> None:
    """Twelve turns were taken for 688, at 1719 rpm. Two lines cure it: those that are named, and those with the unit
    that the file states, which are believed."""
    angles = turned(turns)
    file = file_of(tmp_path, angles, stated=stated, true=true)
    with pytest.raises(InputFileError, match=f"stated in {stated}.*as of {true}.*or the same with unit =") as caught:
        read_recording(file)
    lines = "\n".join(LINE.findall(caught.value.wish))
    same(read_recording(file, chart=chart(tmp_path, lines)).driven_angle_rad, angles[1] * DEGREE, half=1e-6)
    kept = read_recording(file, chart=chart(tmp_path, lines.replace(f'"{true}"', f'"{stated}"')))
    same(kept.driven_angle_rad, angles[1] * DEGREE * SIZES[stated] / SIZES[true], half=1e-4)


def test_few_turns_that_look_like_radians_are_told_and_read(tmp_path: Path) -> None:
    """57 teeth in so few are as like it: told, in a remark."""
    file = file_of(tmp_path, turned(12.0), stated="deg", true="rad")
    assert any("comes back after 6.28319" in one for one in read_recording(file).remarks)


@pytest.mark.long
@pytest.mark.parametrize("turns", [1.05, 1.5, 3.0, 7.3, 60.0])
@pytest.mark.parametrize("mesh", [18, 56, 57, 58])
@pytest.mark.parametrize("lines", [1.0, 0.0])
@pytest.mark.parametrize("unit", ["deg", "rad", "rev"])
def test_what_is_as_stated_is_not_doubted(tmp_path: Path, turns: float, mesh: int, lines: float, unit: str) -> None:
    """57 teeth come by once in 6.316 deg, and 2 pi is 6.283; gears without any wave of their shafts say nothing."""
    file = file_of(tmp_path, turned(turns, mesh=mesh, lines=lines), stated=unit, true=unit)
    assert not survey(file)[0].doubts


def test_waves_of_the_stated_turn_speak_against_another_one(tmp_path: Path) -> None:
    """A part of the drive may turn 57.3 times as fast as the shaft, but both errors cannot be of one unit."""
    theta, driven = turned(10.0)
    driven = driven + np.degrees(45e-6) * np.sin(2.0 * np.pi * theta / (2.0 * np.pi))
    assert not survey(file_of(tmp_path, (theta, driven), stated="deg", true="deg"))[0].doubts


def test_noise_alone_says_nothing(tmp_path: Path) -> None:
    rng = np.random.default_rng(8)
    theta = np.linspace(0.0, 400.0, N)
    angles = theta, RATIO * theta + 1e-3 * rng.standard_normal(N)
    assert not survey(file_of(tmp_path, angles, stated="deg", true="deg"))[0].doubts


def test_a_transmission_error_beside_one_angle_tells_it_too(tmp_path: Path) -> None:
    theta, driven = turned(60.0)
    te = (driven - RATIO * theta) * 3600.0
    text = table([theta * DEGREE, te], ("driving_angle_deg", "te_arcsec"), separator=",", decimal=".", digits=8)
    (doubt,) = survey(written(tmp_path, text))[0].doubts
    assert doubt.says.endswith("as of rad")


@pytest.mark.long
@pytest.mark.parametrize(("per", "says"), [(4096, "as of counts, 4096 a turn"), (10_000, "as counts are")])
def test_counts_that_never_begin_again(tmp_path: Path, per: int, says: str) -> None:
    """They are whole; waves larger than a count tell how many are a turn. Of 18 and 25 teeth a wave in 10 000 of the
    one shaft is one in 7200 of the other, and encoders have either."""
    theta = np.linspace(0.0, 360.0 * 50.0, N)
    for size, wanted in ((0.0, "as counts are"), (3e-3, says)):
        te = size / DEGREE * np.sin(theta * DEGREE)
        counts = [np.floor(one / 360.0 * per) for one in (theta, RATIO * theta + te)]
        text = table([np.arange(N) / 500.0, *counts], ("t [s]", "Input angle [deg]", "Output angle [deg]"),
                     separator=",", decimal=".", digits=(4, 0, 0))  # fmt: skip
        file = written(tmp_path, text)
        (doubt,) = survey(file)[0].doubts
        assert doubt.says.endswith(wanted)
        lines = "\n".join(doubt.ask).replace('lines = "those on its label"', f"lines = {per // 4}")
        read = read_recording(file, chart=chart(tmp_path, lines))
        assert read.driving_angle_rad is not None
        assert abs(np.ptp(read.driving_angle_rad) / (2.0 * np.pi) - 50.0) < 2.0 / per


@pytest.mark.parametrize("written", ["1/3600 deg", "1/7 deg", "0.001234567 rad", "1/10 deg", "1e-5 rev"])
def test_a_unit_in_a_map_is_the_one_that_was_read(written: str) -> None:
    """The name that a map states again means the same size to the last digit."""
    unit = unit_written(written, ANGLE)
    assert unit is not None
    assert unit_written(unit.name, ANGLE) == unit
    number, base = written.split()
    size = {"deg": 1.0, "rad": 180.0 / math.pi, "rev": 360.0}[base]
    above, _, below = number.partition("/")
    assert unit.size == pytest.approx(float(above) / float(below or 1.0) * size, rel=1e-15)


def of_two(tmp_path: Path, angles: tuple[np.ndarray, np.ndarray], *, stated: str, true: tuple[str, str]) -> Path:
    columns = [np.arange(N) / 500.0, *(one / SIZES[unit] for one, unit in zip(angles, true, strict=True))]
    names = ("t [s]", f"Input angle [{stated}]", f"Output angle [{stated}]")
    return written(tmp_path, table(columns, names, separator=",", decimal=".", digits=9))


EACH = ("deg", "rad", "rev")
TWO = [(s, (a, b)) for s in EACH for a in EACH for b in EACH if a != b]


def lines_of(true: tuple[str, str], stated: str) -> list[str]:
    """The lines that are right: of the shafts in another unit than stated, and of no other."""
    names = (("driving", "Input"), ("driven", "Output"))
    return [
        f'columns.{shaft}_angle_deg = {{ from = "{name} angle [{stated}]", unit = "{unit}" }}'
        for (shaft, name), unit in zip(names, true, strict=True)
        if unit != stated
    ]


@pytest.mark.long
@pytest.mark.parametrize(("stated", "true"), TWO)
def test_each_shaft_in_its_own_unit_is_told(tmp_path: Path, stated: str, true: tuple[str, str]) -> None:
    """Of the shaft in deg under rev both were told to be in deg, which put the other 360 times off."""
    angles = turned(60.0)
    file = of_two(tmp_path, angles, stated=stated, true=true)
    with pytest.raises(InputFileError) as told:
        corrected(read_recording(file), EncoderErrors(), EncoderErrors(), ratio=RATIO, r_b2=23.5)
    found = LINE.findall(told.value.wish)
    assert found == lines_of(true, stated)
    cured = read_recording(file, chart=chart(tmp_path, "\n".join(found)))
    assert corrected(cured, EncoderErrors(), EncoderErrors(), ratio=RATIO, r_b2=23.5) is cured
    same(cured.driving_angle_rad, angles[0] * DEGREE, half=1e-6)
    same(cured.driven_angle_rad, angles[1] * DEGREE, half=1e-6)
    (survey_of,) = survey(file)
    apart = SIZES[true[0]] / SIZES[true[1]] * RATIO
    if not 0.1 < apart < 10.0:  # then no gear does so, and it is said before a pair is known
        (doubt,) = [one for one in survey_of.doubts if "goes on by" in one.says]
        assert list(doubt.ask) == lines_of(true, stated)


@pytest.mark.parametrize("true", [("deg", "rev"), ("rev", "deg")])
def test_without_waves_the_travel_tells(tmp_path: Path, true: tuple[str, str]) -> None:
    theta = np.linspace(3.0, 3.0 + 360.0 * 60.0, N)
    angles = (theta, RATIO * theta + 1e-5 * np.random.default_rng(2).standard_normal(N))
    file = of_two(tmp_path, angles, stated="rev", true=true)
    (found,) = survey(file)
    (doubt,) = [one for one in found.doubts if "goes on by" in one.says]
    assert list(doubt.ask) == lines_of(true, "rev")
    with pytest.raises(InputFileError) as told:
        corrected(read_recording(file), EncoderErrors(), EncoderErrors(), ratio=RATIO, r_b2=23.5)
    assert LINE.findall(told.value.wish) == lines_of(true, "rev")


@pytest.mark.parametrize(("ratio", "true"), [(43 / 15, ("deg", "rad")), (43 / 137, ("rad", "rev"))])
def test_where_two_ways_are_left_both_are_said(tmp_path: Path, ratio: float, true: tuple[str, str]) -> None:
    """Numbers under rad, of which the driven ones go on by a twentieth: driving degrees of 43 to 15 teeth, or driven
    turns of 43 to 137. The teeth tell."""
    theta = np.linspace(3.0, 3.0 + 360.0 * 60.0, N)
    angles = (theta, ratio * theta + 1e-5 * np.random.default_rng(2).standard_normal(N))
    file = of_two(tmp_path, angles, stated="rad", true=true)
    (found,) = survey(file)
    (doubt,) = [one for one in found.doubts if "goes on by" in one.says]
    ways = LINE.findall(doubt.says)
    assert ways == [*lines_of(("deg", "rad"), "rad"), *lines_of(("rad", "rev"), "rad")]
    assert not doubt.ask
    with pytest.raises(InputFileError) as told:
        corrected(read_recording(file), EncoderErrors(), EncoderErrors(), ratio=ratio, r_b2=23.5)
    assert LINE.findall(told.value.wish) == lines_of(true, "rad")


def test_wraps_that_end_by_chance_at_the_top_are_no_two_units(tmp_path: Path) -> None:
    """Driving readings begin again each turn and end at 359 deg, driven ones run on 40 times as far, and are in deg."""
    theta = np.linspace(0.5, 359.5 + 360.0 * 59.0, N)
    columns = [np.arange(N) / 500.0, np.mod(theta, 360.0), RATIO * theta]
    file = written(tmp_path, table(columns, ("t [s]", "Input angle [deg]", "Output angle [deg]"), separator=",",
                                   decimal=".", digits=9))  # fmt: skip
    (found,) = survey(file)
    assert not any("goes on by" in one.says for one in found.doubts)
    read = read_recording(file)
    assert corrected(read, EncoderErrors(), EncoderErrors(), ratio=RATIO, r_b2=23.5) is read


@pytest.mark.parametrize("name", ["driving_angle_rad", "driving_angle [rad]", "driving_angle (rad)"])
@pytest.mark.parametrize("time", ["time_s", "time [s]"])
def test_a_name_with_another_unit_is_no_slip(tmp_path: Path, name: str, time: str) -> None:
    """Beside ``time_s`` it was told that ``driving_angle_deg`` is nearest, and degrees would have been read of it."""
    other = name.replace("driving", "driven")
    turns = run(700)
    columns = [turns["time_s"], *(np.radians(turns[one]) for one in OWN[1:3])]
    text = table(columns, (time, name, other), separator=",", decimal=".", digits=8)
    recording = read_recording(written(tmp_path, text))
    same(recording.driving_angle_rad, columns[1], half=0.5e-8)
    same(recording.driven_angle_rad, columns[2], half=0.5e-8)
    wrong = table([turns[one] for one in OWN[:3]], (time, name, other), separator=",", decimal=".")
    with pytest.raises(InputFileError, match="the unit rad, and its readings begin again after one turn as in deg"):
        read_recording(written(tmp_path, wrong))
    slip = text.replace(other, "driven_angel_deg")
    if time == "time_s":
        with pytest.raises(InputFileError, match="the nearest known column is"):
            read_recording(written(tmp_path, slip))


def test_a_ring_gear_s_pair_is_not_asked_whether_its_shafts_have_two_units(tmp_path: Path) -> None:
    """19 teeth on 301: driven degrees go on by 0.063 of the driving ones, as revolutions of few teeth would. Before a
    pair is known it is asked; beside the pair its teeth tell, and a recording that agrees with them has no remark."""
    theta = np.linspace(3.0, 3.0 + 360.0 * 35.0, N)
    angles = (theta, 19 / 301 * theta + 1e-5 * np.random.default_rng(2).standard_normal(N))
    file = of_two(tmp_path, angles, stated="deg", true=("deg", "deg"))
    (found,) = survey(file)
    assert any("goes on by" in one.says for one in found.doubts)
    read = read_recording(file)
    assert corrected(read, EncoderErrors(), EncoderErrors(), ratio=19 / 301, r_b2=848.0) is read
    assert not any("goes on by" in one for one in read.remarks)
