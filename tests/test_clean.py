"""Cleaning: what is meant is put right and counted, what is real stays, what is wrong is refused."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from gearpoly.errors import InputFileError
from gearpoly.recording.clean import Cleaned, clean
from gearpoly.recording.read import read_recording
from gearpoly.recording.recording import Recording
from gearpoly.recording.reversals import BACKWARD_LIMIT
from gearpoly.recording.spikes import single_spikes
from gearpoly.recording.steady import RAMP_SHARE
from gearpoly.recording.travel import nearest_teeth, slope
from tests.at_hand import BENCH, SHARED, SHIPPED, here

FloatArray = npt.NDArray[np.float64]

TURN = 2.0 * math.pi
RATIO = 18.0 / 25.0
NOISE = 1e-5
"""rad; 0.25 um at a base radius of 23.5 mm."""


def steady(turns: float = 12.0, per_turn: int = 360, seed: int = 0) -> tuple[FloatArray, FloatArray]:
    """Times and a driving rotation, unevenly sampled, at 1 turn a second with a wobble of 3 %."""
    rng = np.random.default_rng(seed)
    t = (np.arange(int(turns * per_turn)) + rng.uniform(-0.3, 0.3, int(turns * per_turn))) / per_turn
    return t, TURN * (t + 0.03 / (TURN * 0.7) * np.sin(TURN * 0.7 * t))


def error_of(theta_1: FloatArray, seed: int = 0) -> FloatArray:
    """A transmission error with eccentricities, mesh and noise."""
    rng = np.random.default_rng(seed + 100)
    wave = 2e-4 * np.cos(theta_1 + 0.4) + 1e-4 * np.sin(RATIO * theta_1) + 4e-5 * np.cos(18.0 * theta_1)
    return wave + NOISE * rng.standard_normal(theta_1.size)


def recording(theta_1: FloatArray, te: FloatArray, t: FloatArray | None = None, **more: Any) -> Recording:
    held: dict[str, Any] = {
        "driving_angle_rad": theta_1 + 1.0,
        "driven_angle_rad": RATIO * theta_1 + te - 2.0,
        "time_s": t,
    }
    return Recording(source=Path("rig.csv"), **(held | more))


def wrapped(x: FloatArray, low: float = 0.0) -> FloatArray:
    return np.mod(x - low, TURN) + low


def count(cleaned: Cleaned, what: str) -> int:
    return sum(deed.count for deed in cleaned.done if deed.what == what)


def same_te(cleaned: Cleaned, te: FloatArray) -> None:
    """The error comes back but for a constant (the zeros are unknown) and the rounding of whole turns."""
    off = cleaned.te - te[cleaned.keep]
    assert np.ptp(off) < 1e-12 * max(1.0, float(np.max(np.abs(cleaned.theta_1))))


def refusal(rec: Recording, ratio: float = RATIO) -> InputFileError:
    with pytest.raises(InputFileError) as caught:
        clean(rec, ratio=ratio)
    assert caught.value.wish.startswith("want ")
    assert caught.value.file == "rig.csv"
    return caught.value


def test_a_good_recording_is_left_alone() -> None:
    t, theta = steady()
    te = error_of(theta)
    got = clean(recording(theta, te, t, torque_samples_nm=25.0 + 0.0 * t), ratio=RATIO)
    assert got.done == ()
    assert got.size == theta.size
    np.testing.assert_array_equal(got.keep, np.arange(theta.size))
    np.testing.assert_array_equal(got.theta_1, theta + 1.0)  # readings, since no zero is stated
    np.testing.assert_array_equal(got.theta_2, RATIO * theta + te - 2.0)
    np.testing.assert_array_equal(got.te, got.theta_2 - RATIO * got.theta_1)
    np.testing.assert_array_equal(got.time_s, t)
    assert got.torque_nm is not None
    assert got.speed_rpm is None
    assert not got.ratio_is_off
    for array in (got.theta_1, got.theta_2, got.te, got.keep):
        assert not array.flags.writeable


@pytest.mark.parametrize("low", [0.0, -math.pi, 3.0])
@pytest.mark.parametrize("directions", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_wraps_directions_and_zeros(low: float, directions: tuple[int, int]) -> None:
    t, theta = steady()
    te = error_of(theta)
    zeros = (2.5, -0.7)
    readings = [d * x + z for d, x, z in zip(directions, (theta, RATIO * theta + te), zeros, strict=True)]
    rec = recording(
        theta, te, t,
        driving_angle_rad=wrapped(readings[0], low), driven_angle_rad=wrapped(readings[1], low),
        driving_direction=directions[0], driven_direction=directions[1],
        driving_zero_rad=zeros[0], driven_zero_rad=zeros[1],
    )  # fmt: skip
    got = clean(rec, ratio=RATIO)
    same_te(got, te)
    for angle, truth in ((got.theta_1, theta), (got.theta_2, RATIO * theta + te)):
        turns = (angle - truth) / TURN
        # The stated zero is taken off, so only whole turns are left, and rounding.
        np.testing.assert_allclose(turns, np.rint(turns[0]), rtol=0.0, atol=1e-12)
    assert count(got, "driving wraps") in (11, 12)  # 12 turns
    assert count(got, "driven wraps") in (8, 9)
    assert count(got, "driving direction") == (theta.size if directions[0] < 0 else 0)


def test_a_direction_that_is_not_stated_is_refused() -> None:
    t, theta = steady()
    for shaft in ("driving", "driven"):
        for wrap in (False, True):
            down = -theta if shaft == "driving" else -RATIO * theta
            error = refusal(
                recording(theta, error_of(theta), t, **{f"{shaft}_angle_rad": wrapped(down) if wrap else down})
            )
            assert error.where == f"column {shaft}_angle_deg"
            assert f"{shaft}_direction = -1" in error.wish


def test_a_pair_that_ran_backwards_is_told_from_one_encoder_that_counts_down() -> None:
    """Both angles fall: both encoders count down, which two keys say, or the pair really ran backwards."""
    t, theta_1 = steady()
    te = error_of(theta_1)
    with pytest.raises(InputFileError) as caught:
        clean(recording(theta_1[::-1].copy(), te[::-1].copy(), t), ratio=RATIO)
    assert "both fall" in caught.value.found
    assert "driving_direction = -1 and driven_direction = -1" in caught.value.wish
    assert "reversed = true if the pair ran backwards" in caught.value.wish
    with pytest.raises(InputFileError) as caught:
        clean(recording(theta_1, te, t, driving_angle_rad=-theta_1), ratio=RATIO)
    assert "driven_direction" not in caught.value.wish
    assert "backwards" not in caught.value.wish


@pytest.mark.parametrize("wrap", [True, False])
@pytest.mark.parametrize("timed", [True, False])
def test_drop_outs_are_left_out_and_bridged(wrap: bool, timed: bool) -> None:
    t, theta = steady(40.0)
    te = error_of(theta)
    rng = np.random.default_rng(3)
    gone = rng.random(theta.size) < 0.05
    gone[1000:1400] = True  # more than a turn
    gone[5000:8200] = True  # nine turns
    first, second = theta + 1.0, RATIO * theta + te
    if wrap:
        first, second = wrapped(first), wrapped(second)
    first[gone] = math.nan
    second[rng.random(theta.size) < 0.02] = math.nan
    rec = recording(theta, te, t if timed else None, driving_angle_rad=first, driven_angle_rad=second)
    got = clean(rec, ratio=RATIO)
    left = np.isfinite(first) & np.isfinite(second)
    np.testing.assert_array_equal(got.keep, np.flatnonzero(left))
    assert count(got, "drop-outs") == int(np.sum(~left))
    same_te(got, te)
    turns = (got.theta_1 - theta[got.keep] - 1.0) / TURN
    np.testing.assert_allclose(turns, 0.0, rtol=0.0, atol=1e-12)


def test_a_gap_that_the_speed_cannot_bridge_is_settled_by_both_shafts() -> None:
    # The rig slows down by 5 % over the gap: 38 turns instead of 40, which only the tooth ratio can tell.
    t, theta = steady(80.0, per_turn=120)
    gap = slice(2000, 6800)
    slow = theta.copy()
    slow[gap.stop :] -= TURN * 2.0
    te = error_of(slow)
    first, second = wrapped(slow), wrapped(RATIO * slow + te)
    first[gap] = math.nan
    got = clean(recording(slow, te, t, driving_angle_rad=first, driven_angle_rad=second), ratio=RATIO)
    same_te(got, te)
    np.testing.assert_allclose(got.theta_1 - slow[got.keep], 0.0, rtol=0.0, atol=1e-9)
    assert count(got, "gaps settled") == 1


def test_single_spikes_are_left_out() -> None:
    t, theta = steady()
    te = error_of(theta)
    rng = np.random.default_rng(5)
    at = np.sort(rng.choice(np.arange(10, theta.size - 10, 7), 40, replace=False))
    size = rng.choice([-1.0, 1.0], 40) * 10.0 ** rng.uniform(-3.0, 1.0, 40)
    for shaft in ("driving", "driven"):
        base = theta + 1.0 if shaft == "driving" else RATIO * theta + te
        reading = base.copy()
        reading[at] += size
        got = clean(recording(theta, te, t, **{f"{shaft}_angle_rad": wrapped(reading)}), ratio=RATIO)
        assert count(got, "spikes") == 40
        np.testing.assert_array_equal(got.keep, np.delete(np.arange(theta.size), at))
        same_te(got, te + (2.0 if shaft == "driving" else 0.0))


def test_the_last_digit_of_coarse_readings_is_no_spike() -> None:
    """Of a sound pair at 3 : 1 in steps of an arcmin, 240 a second at 30 rpm, most samples stand like their neighbours,
    and a hundred were a digit off and left out. A wrong sample is found all the same."""
    t = np.arange(14_400) / 240.0
    theta = math.pi * t
    te = 4e-4 * np.sin(theta) + 2e-4 * np.sin(theta / 3.0) + 3e-5 * np.sin(16.0 * theta)
    te += math.radians(0.002) * np.random.default_rng(2).normal(size=t.size)

    def in_arcmin(angle: FloatArray) -> FloatArray:
        return np.radians(np.round(np.rint(np.degrees(angle) * 60.0) / 60.0, 6))

    driving, driven = in_arcmin(theta + 1.0), in_arcmin(theta / 3.0 + te)
    got = clean(recording(theta, te, t, driving_angle_rad=driving, driven_angle_rad=driven), ratio=1.0 / 3.0)
    assert count(got, "spikes") == 0
    driven[1234] += math.radians(20.0 / 60.0)
    got = clean(recording(theta, te, t, driving_angle_rad=driving, driven_angle_rad=driven), ratio=1.0 / 3.0)
    assert count(got, "spikes") == 1


def test_readings_of_zero_are_spikes_too() -> None:
    t, theta = steady()
    te = error_of(theta)
    reading = wrapped(theta + 1.0)
    reading[[700, 1900, 3333]] = 0.0
    got = clean(recording(theta, te, t, driving_angle_rad=reading), ratio=RATIO)
    np.testing.assert_array_equal(np.setdiff1d(np.arange(theta.size), got.keep), [700, 1900, 3333])
    same_te(got, te)


def test_a_wild_reading_beside_a_recorded_error() -> None:
    t, theta = steady()
    te = error_of(theta)
    driven = RATIO * theta + te
    driven[1234] += 1.0
    rec = Recording(source=Path("rig.csv"), driven_angle_rad=driven, te_rad=te, time_s=t)
    got = clean(rec, ratio=RATIO)
    np.testing.assert_array_equal(np.setdiff1d(np.arange(theta.size), got.keep), [1234])
    np.testing.assert_array_equal(got.te, te[got.keep])


@pytest.mark.parametrize("per_turn", [90, 360, 2000])
@pytest.mark.parametrize("shaft", ["driving", "driven"])
@pytest.mark.parametrize("width_deg", [0.7, 3.0, 8.0])
def test_spalls_and_steps_stay(per_turn: int, shaft: str, width_deg: float) -> None:
    # A pit 40 times the noise deep, once a turn of its shaft, from a fraction of a sample to many samples wide.
    t, theta = steady(25.0, per_turn)
    te = error_of(theta)
    place = np.mod(theta if shaft == "driving" else RATIO * theta, TURN)
    te = te - 40.0 * NOISE * ((place > 2.0) & (place < 2.0 + math.radians(width_deg)))
    te = te + 40.0 * NOISE * np.floor(18.0 * theta / TURN % 2.0)  # a step at every other tooth
    got = clean(recording(theta, te, t), ratio=RATIO)
    assert got.done == ()
    assert got.size == theta.size


def test_noise_of_many_kinds_is_not_spiky() -> None:
    rng = np.random.default_rng(11)
    n = 20_000
    white = rng.standard_normal(n)
    coloured = np.convolve(rng.standard_normal(n + 200), 0.97 ** np.arange(200), mode="valid")[:n]
    for noise in (white, coloured, np.round(white), np.round(0.1 * white), np.cumsum(white), rng.laplace(size=n)):
        assert single_spikes(noise).sum() == 0
    assert single_spikes(np.zeros(50)).sum() == 0
    assert single_spikes(np.arange(5.0)).sum() == 0
    peak = np.abs(np.arange(-50.0, 50.0))  # the point of a roof is no spike
    assert single_spikes(peak).sum() == 0
    assert single_spikes(np.where(np.arange(100) < 50, 0.0, 1.0)).sum() == 0  # nor is a step


def ramped(seconds: float, up: float, down: float, still: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Time, rotation and speed (turns a second) of a run from standstill to standstill."""
    t = np.arange(0.0, seconds, 1.0 / 500.0)
    speed = np.clip(np.minimum((t - still) / up, (seconds - still - t) / down), 0.0, 1.0)
    return t, TURN * np.cumsum(speed) / 500.0, speed


@pytest.mark.parametrize("still", [0.0, 3.0, 15.0])
def test_start_and_stop_ramps_are_cut(still: float) -> None:
    t, theta, speed = ramped(10.0 + 2.0 * still + 6.0, 2.0, 4.0, still)
    te = error_of(theta)
    got = clean(recording(theta, te, t), ratio=RATIO)
    fast = np.flatnonzero(speed >= RAMP_SHARE)
    # The speed is taken over a window of 5 deg, 7 samples at full speed; at either end it may cut that much else.
    assert abs(int(got.keep[0]) - int(fast[0])) <= 10
    assert abs(int(got.keep[-1]) - int(fast[-1])) <= 10
    assert count(got, "start ramp") == int(got.keep[0])
    assert count(got, "stop ramp") == theta.size - 1 - int(got.keep[-1])
    np.testing.assert_array_equal(np.diff(got.keep), 1)
    same_te(got, te)


def test_a_run_up_and_a_coast_down_are_kept_whole() -> None:
    """From a third to full speed, or from standstill and back: slow ends that hold a good part of the way are what was
    to be recorded. Only standing still is cut."""
    t = np.arange(5000) / 500.0
    theta = TURN * (t + 0.1 * t**2) / 2.0
    assert clean(recording(theta, error_of(theta), t), ratio=RATIO).keep.size == t.size
    assert clean(recording(theta[::-1][0] - theta[::-1], error_of(theta), t), ratio=RATIO).keep.size == t.size
    t, theta, speed = ramped(14.0, 5.0, 5.0, 2.0)
    got = clean(recording(theta, error_of(theta), t), ratio=RATIO)
    moving = np.flatnonzero(speed > 0.0)
    assert 0 <= int(got.keep[0]) - int(moving[0]) < 100
    assert 0 <= int(moving[-1]) - int(got.keep[-1]) < 100


def test_a_trembling_reading_is_kept_and_a_reversal_is_not() -> None:
    t, theta = steady(6.0, 4000)
    te = error_of(theta)
    rng = np.random.default_rng(2)
    shaken = theta + 0.1 * BACKWARD_LIMIT * rng.uniform(-1.0, 1.0, theta.size)
    got = clean(recording(shaken, te, t), ratio=RATIO)
    assert got.size == theta.size
    assert count(got, "driving jitter") > 0
    back = theta.copy()
    back[12_000:] -= 2.0 * (np.minimum(back[12_000:], back[12_000] + 0.05) - back[12_000])
    error = refusal(recording(back, te, t))
    assert "runs back" in error.found
    assert error.where.startswith(f"row {12_001}")
    assert f"time_s {t[12_000]:.6g}" in error.where


def test_angles_in_rad_are_told_where_they_would_be_long_enough() -> None:
    """44 turns written in rad and read as degrees are 0.77 turns."""
    t, theta = steady(44.0)
    error = refusal(recording(math.radians(1.0) * theta, math.radians(1.0) * error_of(theta), t))
    assert "0.77 driving turns" in error.found
    assert "were they written in rad, it would be 44 turns" in error.wish


def test_less_than_two_turns_are_taken_with_a_word() -> None:
    t, theta = steady(1.9)
    (said,) = [one.says for one in clean(recording(theta, error_of(theta), t), ratio=RATIO).done if one.what == "short"]
    assert "1.90 driving turns" in said
    t, theta = steady(2.1)
    assert all(one.what != "short" for one in clean(recording(theta, error_of(theta), t), ratio=RATIO).done)


def test_less_than_a_turn() -> None:
    t, theta = steady(0.9)
    assert "0.89 driving turns" in refusal(recording(theta, error_of(theta), t)).found
    t, theta, _ = ramped(2.2, 1.2, 1.2, 0.2)
    assert "driving turns" in refusal(recording(theta, error_of(theta), t)).found
    assert (
        "were they written in rad, it would be" not in refusal(recording(0.01 * theta, 0.01 * error_of(theta), t)).wish
    )
    few = recording(theta[:5], theta[:5], t[:5])
    assert "5 samples" in refusal(few).found
    gone = recording(theta, np.full(theta.size, math.nan), t)
    assert "0 samples" in refusal(gone).found


def test_time_that_runs_back() -> None:
    t, theta = steady()
    strung = np.concatenate([t[:2000], t[2000:] - 1.0])
    error = refusal(recording(theta, error_of(theta), strung))
    assert error.where.startswith("row 2001 ")
    assert "before the row above" in error.found


@pytest.mark.parametrize(("teeth", "named"), [((18, 26), "9/13"), ((17, 25), "17/25"), ((9, 47), "9/47")])
def test_another_pairs_recording_names_its_ratio(teeth: tuple[int, int], named: str) -> None:
    t, theta = steady()
    other = teeth[0] / teeth[1] * theta + error_of(theta)
    for wrap in (False, True):
        rec = recording(theta, 0.0 * t, t, driven_angle_rad=wrapped(other) if wrap else other)
        error = refusal(rec)
        assert f"nearest tooth ratio is {named}" in error.found
        assert "this pair" in error.wish


@pytest.mark.parametrize("off", [3e-5, -2e-4, 0.024])
def test_a_ratio_that_is_off_by_a_constant_is_reported(off: float) -> None:
    # 0.024: an encoder of 1024 lines taken for 1000.
    for seed in range(5):
        t, theta = steady(seed=seed)
        te = error_of(theta, seed) + off * RATIO * theta
        got = clean(recording(theta, te, t), ratio=RATIO)
        assert got.ratio_is_off
        assert [deed.what for deed in got.done] == ["ratio"]
        assert "encoder count or slip" in got.done[0].says
        assert abs(got.ratio_offset - off * RATIO) < 4.0 * got.ratio_offset_std
        same_te(got, te)  # it is told, not taken out


@pytest.mark.long
def test_the_standard_error_of_the_ratio_holds_for_coloured_noise() -> None:
    rng = np.random.default_rng(8)
    z = []
    for _ in range(300):
        _, theta = steady(7.3, 90)
        noise = (
            3e-5 * np.convolve(rng.standard_normal(theta.size + 50), 0.9 ** np.arange(50), mode="valid")[: theta.size]
        )
        te = error_of(theta) + noise
        value, error = slope(theta, RATIO * theta, te)
        z.append(value / error)
    # With 12 stretches the quotient is about t-distributed (11): spread 1.1, and 300 trials tell it to 5 %. Nothing
    # may pass the 5 standard errors of the report (4 in 10^4 each).
    assert 0.9 < float(np.std(z)) < 1.35
    assert np.sum(np.abs(z) > 5.0) <= 2


def test_nearest_teeth() -> None:
    assert str(nearest_teeth(18.0 / 26.0 + 1e-5, 1e-4)) == "9/13"
    assert str(nearest_teeth(0.72, 1e-9)) == "18/25"
    assert nearest_teeth(math.pi, 1e-12).denominator <= 400


def test_recorded_errors_along_the_line_of_action_need_the_base_radius() -> None:
    t, theta = steady()
    te = error_of(theta)
    held: dict[str, Any] = {"source": Path("rig.csv"), "te_mm": te * 23.5, "time_s": t}
    with pytest.raises(ValueError, match="r_b2"):
        clean(Recording(**held, driving_angle_rad=theta), ratio=RATIO)
    got = clean(Recording(**held, driving_angle_rad=wrapped(theta)), ratio=RATIO, r_b2=23.5)
    # Times 23.5 and back: two roundings.
    np.testing.assert_allclose(got.te, te, rtol=5e-16, atol=0.0)
    np.testing.assert_array_equal(got.theta_2, got.te + RATIO * got.theta_1)
    got = clean(Recording(**held, driven_angle_rad=wrapped(RATIO * theta)), ratio=RATIO, r_b2=23.5)
    np.testing.assert_allclose(got.theta_1, (got.theta_2 - got.te) / RATIO, rtol=4e-16)


@pytest.mark.long
def test_bench_recordings_come_through_whole() -> None:
    found = [file for folder in here(SHIPPED, BENCH) for file in sorted(folder.glob("*/rec_*.csv"))]
    assert found
    for file in found:
        pair = tomllib.loads((file.parent / "pair.toml").read_text(encoding="utf-8"))
        ratio = pair["driving"]["teeth"] / pair["driven"]["teeth"]
        rec = read_recording(file)
        got = clean(rec, ratio=ratio)
        assert {deed.what for deed in got.done} <= {"driving wraps", "driven wraps"}
        assert got.size == rec.size
        turns = 50.0 if pair["driven"]["teeth"] == 25 else 24.0  # two hunting cycles of 25, eight of 3
        assert got.theta_1[-1] - got.theta_1[0] == pytest.approx(turns * TURN, abs=0.2)  # as far as samples are apart


@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared recordings are not here")
@pytest.mark.parametrize(
    ("name", "ratio"), [("log01_as_eq6", 12 / 47), ("log01_as_heq5", 9 / 47), ("log04_as_eq6", 12 / 47)]
)
def test_telescope_recordings_keep_every_sample(name: str, ratio: float) -> None:
    rec = read_recording(SHARED / "telescope" / f"{name}.csv")
    got = clean(rec, ratio=ratio)
    assert got.size == rec.size
    assert rec.te_rad is not None
    np.testing.assert_array_equal(got.te, rec.te_rad)
    assert {deed.what for deed in got.done} <= {"ratio"}  # the polar axis drifts
