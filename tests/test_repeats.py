"""Readings that repeat: a staircase beside a shaft that turns on is no ghost order, and nothing divides by nothing."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gearpoly.recording.clean import Cleaned, clean
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray

TURN, RATIO, R_B2, UM = 2.0 * math.pi, 18.0 / 25.0, 23.49, 1e-3
PER_TURN, TURNS = 500, 20
TRUE_UM = 20.0 / math.sqrt(2.0)
"""um rms of an eccentricity of 20 um, which is all that the pair does here."""


def rotations(per_turn: int = PER_TURN, turns: int = TURNS) -> tuple[FloatArray, FloatArray, FloatArray]:
    t = np.arange(per_turn * turns) / per_turn
    theta_1 = TURN * t
    return t, theta_1, RATIO * theta_1 + 20.0 * UM / R_B2 * np.sin(theta_1)


def held(x: FloatArray, every: int, begin: int = 0) -> FloatArray:
    """Each reading kept until the next of every so many samples."""
    i = np.arange(x.size)
    return x[np.maximum(i - (i - begin) % every, 0)]


def counted(x: FloatArray, counts: int) -> FloatArray:
    step = TURN / counts
    return np.floor(x / step) * step


def cleaned(t: FloatArray | None, theta_1: FloatArray, theta_2: FloatArray) -> Cleaned:
    held_by = Recording(source=Path("rig.csv"), time_s=t, driving_angle_rad=theta_1, driven_angle_rad=theta_2)
    return clean(held_by, ratio=RATIO)


def left_um(one: Cleaned) -> float:
    """What the transmission error has beside the eccentricity, um rms."""
    wave = 20.0 * UM / R_B2 * np.sin(one.theta_1)
    return float(np.std(one.te - wave)) * R_B2 / UM


@pytest.mark.parametrize("timed", [True, False])
@pytest.mark.parametrize(
    ("case", "samples"),
    [
        ("driven every 2nd", 5000),
        ("driving every 3rd", 3334),
        ("both every 2nd", 5000),
        ("every 3rd and every 5th", 667),
        ("20 equal", 9981),
        ("each row twice", 10_000),
    ],
)
def test_a_reading_counts_where_it_is_new(case: str, samples: int, timed: bool) -> None:
    t, theta_1, theta_2 = rotations()
    if case == "driven every 2nd":
        theta_2 = held(theta_2, 2)
    elif case == "driving every 3rd":
        theta_1 = held(theta_1, 3)
    elif case == "both every 2nd":
        theta_1, theta_2 = held(theta_1, 2), held(theta_2, 2)
    elif case == "every 3rd and every 5th":
        theta_1, theta_2 = held(theta_1, 3), held(theta_2, 5)
    elif case == "20 equal":
        theta_2[5000:5020] = theta_2[5000]
    else:
        t, theta_1, theta_2 = (np.repeat(x, 2) for x in (t, theta_1, theta_2))
    one = cleaned(t if timed else None, theta_1, theta_2)
    assert one.size == samples
    assert left_um(one) < 1e-6  # rounding; untouched it is 100 um rms and more, one sample in two being 212 um old
    assert any("repeat the one before" in deed.says for deed in one.done)


def test_shafts_that_are_read_in_turns_lag_by_a_constant() -> None:
    t, theta_1, theta_2 = rotations()
    one = cleaned(t, held(theta_1, 2), held(theta_2, 2, begin=1))
    assert one.size >= PER_TURN * TURNS // 2 - 1  # the first, which has nothing before it, is a spike
    # The driven reading is one sample old at each: 0.0045 of the wave's turn is 0.36 deg driven, 0.25 um of 20 um sine.
    assert left_um(one) < 0.5


def test_counts_coarser_than_the_samples_leave_the_way_of_one_sample() -> None:
    """12 bits at 10 000 samples a turn: where a count passes, the reading is known to one sample, not to one count."""
    t, theta_1, theta_2 = rotations(10_000, 6)
    sample_um = TURN / 10_000 * RATIO * R_B2 / UM
    one = cleaned(t, theta_1, counted(theta_2, 4096))
    assert left_um(one) < 1.05 * sample_um / math.sqrt(12.0)  # spread evenly over the sample; a count would be 10.4 um
    both = cleaned(t, counted(theta_1, 4096), counted(theta_2, 4096))
    assert left_um(both) < 1.05 * sample_um / math.sqrt(6.0)  # both shafts


def test_a_clock_that_is_coarser_than_the_samples_is_not_used() -> None:
    t, theta_1, theta_2 = rotations()
    one = cleaned(np.floor(100.0 * t) / 100.0, theta_1, theta_2)  # five samples each hundredth of a second
    assert one.time_s is None
    assert left_um(one) < 1e-6
    assert any("clock" in deed.what for deed in one.done)
    some = np.where(np.arange(t.size) % 10 == 1, np.roll(t, 1), t)  # one in ten
    assert cleaned(some, theta_1, theta_2).time_s is not None


def test_standing_still_at_the_ends_is_no_repeat() -> None:
    _, theta_1, theta_2 = rotations()
    still = [np.concatenate([np.full(700, x[0]), x, np.full(300, x[-1])]) for x in (theta_1, theta_2)]
    one = cleaned(np.arange(still[0].size) / PER_TURN, *still)
    assert [deed.what for deed in one.done] == ["start ramp", "stop ramp"]


@pytest.mark.parametrize("timed", [True, False])
@pytest.mark.parametrize("counts", [None, 4_000_000, 200])
@pytest.mark.parametrize("wrapped", [True, False])
def test_standing_still_in_the_middle_is_a_stop(timed: bool, counts: int | None, wrapped: bool) -> None:
    """A stand as long as 5.2 turns take, in which an encoder repeats its reading exactly, is cut as a stop. Taken for a
    line that froze while the pair turned on, whole turns were added across it."""
    t, *angles = rotations()
    stand, at = 2600, 4321
    t = np.arange(t.size + stand) / PER_TURN
    theta_1, theta_2 = (np.concatenate([x[:at], np.full(stand, x[at - 1]), x[at:]]) for x in angles)
    if counts is not None:
        theta_1 = counted(theta_1, counts)
    if wrapped:
        theta_1, theta_2 = theta_1 % TURN, theta_2 % TURN
    one = cleaned(t if timed else None, theta_1, theta_2)
    assert float(np.ptp(one.theta_1)) / TURN == pytest.approx(TURNS, abs=0.05)
    # Counts of 200 a turn are read when one of three passes: driven readings are then as new.
    assert left_um(one) < (1.0 if counts != 200 else 400.0)
    assert one.size > 0.95 * (angles[0].size if counts != 200 else 200 * TURNS)


def test_a_frozen_line_is_no_stop() -> None:
    """Both readings hold for 200 samples while the pair turns on by 0.4 turns, and go on from there: as before, the
    samples without a new reading are left out, and the angle goes on by what was turned."""
    t, theta_1, theta_2 = rotations()
    for x in (theta_1, theta_2):
        x[4000:4200] = x[3999]
    one = cleaned(t, theta_1 % TURN, theta_2 % TURN)
    assert one.size == t.size - 200
    assert float(np.ptp(one.theta_1)) / TURN == pytest.approx(TURNS, abs=0.01)
    assert left_um(one) < 1e-6
