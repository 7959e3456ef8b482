"""A transmission error that runs away by pitches: its slow course is taken out, and only that."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.runaway import without_course
from gearpoly.errors import InputFileError
from gearpoly.files.models import PairFile
from gearpoly.mesh.pair import GearPair
from gearpoly.recording.from_time import is_from_time
from gearpoly.recording.recording import Recording
from gearpoly.units import UM, FloatArray
from tests.made_recordings import inspected

TURN = 2.0 * math.pi
TURNS = 12.0
"""Driven turns; 16 driving ones."""


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A pair of 12 on 16 teeth and its file."""

    file: PairFile
    path: Path
    pair: GearPair


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Drive:
    file, path, made = inspected(tmp_path_factory.mktemp("pair"), np.random.default_rng(3), z_1=12, z_2=16)
    return Drive(file=file, path=path, pair=made.pair)


def course(pitches: float, *, pair: GearPair) -> FloatArray:
    """A ramp with a bow and an S, of so many pitches from end to end, in rad of the driven gear; mean 0."""
    x = np.linspace(-1.0, 1.0, 4000)
    curve = np.polynomial.legendre.legval(x, [0.0, 0.5, 0.1, -0.05])
    return np.asarray(pitches * pair.driven.gear.tau * curve / np.ptp(curve))


def recording(te: FloatArray, *, wrapped: bool = False, timed: bool = True) -> Recording:
    """A driven angle that is time, and the transmission error beside it."""
    angle = np.linspace(0.3, 0.3 + TURNS * TURN, te.size)
    return Recording(
        source=Path("rec.csv"), time_s=np.linspace(0.0, 600.0, te.size), te_rad=te,
        driven_angle_rad=np.mod(angle, TURN) if wrapped else angle, from_time=("driven",) if timed else (),
    )  # fmt: skip


def line(order: float, *, amplitude: float, pair: GearPair) -> FloatArray:
    """A wave of the driving shaft, which turns as teeth in mesh make it: by the ratio, whatever the course."""
    theta_1 = np.linspace(0.0, TURNS * TURN, 4000) / pair.ratio
    return np.asarray(amplitude / pair.r_b2 * np.cos(order * theta_1))


@pytest.mark.parametrize("wrapped", [False, True])
@pytest.mark.parametrize("unit", ["te_rad", "te_mm"])
def test_what_is_slow_is_taken_and_what_repeats_stays(drive: Drive, wrapped: bool, unit: str) -> None:
    pair = drive.pair
    repeats = line(1.0, amplitude=40.0 * UM, pair=pair) + line(9.0, amplitude=5.0 * UM, pair=pair) + 3.0 * UM
    one = recording(repeats + course(6.0, pair=pair), wrapped=wrapped)
    if unit == "te_mm":
        assert one.te_rad is not None
        one = replace(one, te_rad=None, te_mm=one.te_rad * pair.r_b2)
    out = without_course(one, pair)
    te = out.te_in_rad(pair.r_b2)
    assert te is not None
    # Order 9, which is not fitted beside, leaves a ramp of its amplitude over pi times its waves (144).
    assert np.max(np.abs(te - repeats)) * pair.r_b2 < 5.0 * UM / 144.0
    (said,) = out.remarks
    assert "6 pitches" in said and "more than teeth in mesh can" in said


def test_across_a_gap_of_several_turns_a_wrapped_angle_goes_on(drive: Drive) -> None:
    """Of 12 driven turns 2.7 are missing; the course goes on meanwhile, and its turns with it."""
    repeats = line(1.0, amplitude=40.0 * UM, pair=drive.pair)
    te = repeats + course(6.0, pair=drive.pair)
    te[1000:1900] = math.nan
    out = without_course(recording(te, wrapped=True), drive.pair).te_in_rad(drive.pair.r_b2)
    assert out is not None
    assert float(np.nanmax(np.abs(out - repeats))) * drive.pair.r_b2 < 1.0 * UM


@pytest.mark.parametrize("timed", [False, True])
def test_a_word_for_no_reading_is_no_course(drive: Drive, timed: bool) -> None:
    """Single samples of 10 m, one of them near the end, are as a ramp of all others of 10 mm."""
    repeats = line(1.0, amplitude=40.0 * UM, pair=drive.pair)
    repeats[[50, 2000, 3990]] = 9999.999 / drive.pair.r_b2
    one = recording(repeats, timed=timed)
    assert without_course(one, drive.pair) is one
    one = recording(repeats + course(16.0, pair=drive.pair), timed=timed)
    out = without_course(one, drive.pair).te_in_rad(drive.pair.r_b2)
    assert out is not None
    assert float(np.max(np.abs(out - repeats))) * drive.pair.r_b2 < 1.0 * UM


def test_a_course_within_a_quarter_of_a_pitch_stays(drive: Drive) -> None:
    for one in (recording(course(0.24, pair=drive.pair)), recording(line(1.0, amplitude=1.0, pair=drive.pair))):
        assert without_course(one, drive.pair) is one


def test_beside_an_encoder_a_ramp_may_be_its_scale(drive: Drive) -> None:
    pair = drive.pair
    travel = TURNS * pair.driven.gear.z
    below, above = (recording(course(part * travel, pair=pair), timed=False) for part in (0.029, 0.031))
    assert without_course(below, pair) is below
    assert "runs away" in without_course(above, pair).remarks[0]


def test_both_angles_are_left_to_their_lines(drive: Drive) -> None:
    one = recording(course(6.0, pair=drive.pair))
    both = replace(one, driving_angle_rad=np.linspace(0.0, TURNS * TURN, 4000) / drive.pair.ratio)
    assert without_course(both, drive.pair) is both


def test_a_column_that_is_no_transmission_error_is_refused_with_a_cure(drive: Drive) -> None:
    one = recording(np.linspace(0.0, TURNS * TURN, 4000))
    with pytest.raises(InputFileError, match="100% of what the shafts turn") as caught:
        without_course(one, drive.pair)
    assert "te_um" in caught.value.wish and "te_arcsec" in caught.value.wish


@pytest.mark.long
def test_a_line_of_the_driving_shaft_is_found_at_its_order(drive: Drive) -> None:
    """With the course in its angle the driving shaft would be four pitches off at the end, and order 31 ten turns of
    its phase: nothing would stand there."""
    rng = np.random.default_rng(1)
    pair = drive.pair
    te = (
        line(31.0, amplitude=4.0 * UM, pair=pair) + course(4.0, pair=pair) + rng.normal(0.0, 1.0 * UM / pair.r_b2, 4000)
    )
    located = compare(drive.file, [recording(te)], path=drive.path).located
    lines = {(e.gear, e.order): e.amplitude_um for e in located.entries if e.order is not None}
    assert lines[("driving", 31)] == pytest.approx(4.0, abs=0.2)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_wrapped_angle_with_missing_rows_is_still_time(way: float) -> None:
    """The rows of 2.7 turns are missing. An angle that wobbles by a hundredth of a degree is an encoder's."""
    t = np.linspace(0.0, 600.0, 4000)
    t = np.delete(t, np.s_[1000:1900])
    angle = way * 7.2 * t + 17.0
    assert is_from_time(t, np.mod(angle, 360.0))
    assert is_from_time(t, angle)
    assert not is_from_time(t, np.mod(angle + 0.01 * np.sin(t), 360.0))
