"""Angles of both shafts read at different moments: the transmission error follows the speed."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from gearpoly.compare.compare import compare
from gearpoly.compare.read_late import _swings, on_one_clock, read_late
from gearpoly.recording.clean import Cleaned, clean
from gearpoly.recording.recording import Recording
from gearpoly.units import UM, FloatArray
from tests.pair_files import made, unloaded_te
from tests.physics_cases import rough

TEETH, TURN, NOISE, SECONDS, RATE = (13, 31), 2.0 * math.pi, 0.4 * UM, 30.0, 200.0
FILE = rough(TEETH, bends=False, points=200)
PAIR = made(FILE).pair


def driven_turned(t: FloatArray) -> FloatArray:
    """Driven rotation (n,) in rad at times (n,): 20 rpm, 20 % up and down in 2.3 s, and 5 % in 0.71 s."""
    w = 20.0 * TURN / 60.0
    return np.asarray(
        w * (t - 0.2 * 2.3 / TURN * np.cos(TURN * t / 2.3) - 0.05 * 0.71 / TURN * np.cos(TURN * t / 0.71))
    )


def recording(*, late: float, rate: float = 0.0, backward: bool = False, drag: FloatArray | None = None) -> Recording:
    """Both angles, the driven one read ``late`` s after the driving one in the middle, and ``rate`` s per s more."""
    t = np.arange(0.0, SECONDS, 1.0 / RATE)
    sense = -1.0 if backward else 1.0

    def angles(at: FloatArray) -> tuple[FloatArray, FloatArray]:
        theta_2 = sense * driven_turned(at)
        te = unloaded_te(made(FILE), theta_2) / PAIR.r_b2
        return (theta_2 - te) / PAIR.ratio, theta_2

    noise = np.random.default_rng(5).normal(0.0, NOISE / PAIR.r_b2, t.size)
    driving, _ = angles(t)
    _, driven = angles(t + late + rate * (t - 0.5 * SECONDS))
    return Recording(
        source=Path("merged.csv"), time_s=t, driving_angle_rad=driving + 1.1,
        driven_angle_rad=driven + 2.3 + noise + (0.0 if drag is None else drag),
        driving_zero_rad=1.1, driven_zero_rad=2.3, backward=backward,
    )  # fmt: skip


def cleaned(one: Recording) -> Cleaned:
    return clean(one, ratio=PAIR.ratio, r_b2=PAIR.r_b2)


@pytest.mark.long
@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize("late", [3e-3, -1.5e-3])
def test_the_delay_is_told_with_its_sign_and_taken_off(late: float, backward: bool) -> None:
    """To four standard errors. Noise is left, of 90 um that 3 ms make between slow and fast."""
    one = cleaned(recording(late=late, backward=backward))
    found = read_late(one, PAIR)
    assert found is not None
    assert found.by == pytest.approx(late, abs=4.0 * found.std)
    assert found.rate == 0.0
    (whole,) = on_one_clock([one], PAIR)
    theta_2 = np.mod(whole.theta_2, TURN * TEETH[0])
    left = whole.te * PAIR.r_b2 - unloaded_te(made(FILE), theta_2)
    assert float(np.std(left)) < 1.6 * NOISE
    assert ("after" if late > 0.0 else "before") in whole.recording.remarks[0]


def test_clocks_of_different_rates_are_told_apart() -> None:
    """100 s in a million are 3 ms after half a minute."""
    found = read_late(cleaned(recording(late=2e-3, rate=1e-4)), PAIR)
    assert found is not None
    assert found.by == pytest.approx(2e-3, abs=4.0 * found.std)
    assert found.rate == pytest.approx(1e-4, rel=0.05)


@pytest.mark.long
def test_compare_is_left_with_the_noise_and_a_word() -> None:
    beside = compare(FILE, [recording(late=3e-3)], path=Path("pair.toml"))
    assert float(np.std(beside.aligned[0].residual)) < 1.6 * NOISE
    (said,) = [one for one in beside.remarks if "follows the speed" in one]
    told = float(said.split("driven angle were read ")[1].split(" ")[0])
    assert told == pytest.approx(3.0, rel=0.005)
    assert "ms after the driving angle" in said


def test_what_is_read_at_one_moment_is_left_as_it_is() -> None:
    one = cleaned(recording(late=0.0))
    assert read_late(one, PAIR) is None
    assert on_one_clock([one], PAIR) == [one]


@pytest.mark.long
def test_a_drift_that_wanders_as_the_speed_does_not_is_no_delay() -> None:
    """60 courses of 100 um as slow as the speed's own swings, beside no delay."""
    rng = np.random.default_rng(3)
    n = int(SECONDS * RATE)
    for _ in range(60):
        course = gaussian_filter1d(rng.normal(size=n), rng.uniform(0.3, 2.0) * RATE)
        drag = course / np.ptp(course) * 0.1 / PAIR.r_b2
        assert read_late(cleaned(recording(late=0.0, drag=drag)), PAIR) is None


def test_at_an_even_speed_nothing_is_looked_for() -> None:
    t = np.arange(0.0, SECONDS, 1.0 / RATE)
    theta_2 = TURN / 3.0 * t
    one = Recording(
        source=Path("even.csv"), time_s=t, driving_angle_rad=theta_2 / PAIR.ratio,
        driven_angle_rad=theta_2 + 3e-3 * TURN / 3.0,
    )  # fmt: skip
    assert read_late(cleaned(one), PAIR) is None


@pytest.mark.parametrize("times", [0, 8, 12])
def test_a_run_that_starts_and_stops_swings_no_more_than_twice(times: int) -> None:
    """However much its even part trembles, by 0.5 % here: of a run of 6 turns, slower in its first and last mesh, a
    delay of 0.06 ms was made, and clocks that ran 9 s in a million apart. A sine swings twice in each of its turns."""
    t = np.linspace(0.0, 1.0, 107)
    tremble = 0.005 * np.random.default_rng(6).normal(size=t.size)
    ends = np.where((t < 0.01) | (t > 0.99), -0.2, 0.0)
    swing = 0.2 * np.sin(TURN * times / 2.0 * t + 0.3) if times else ends
    assert _swings(swing + tremble) == pytest.approx(times, abs=2 if not times else 1)
