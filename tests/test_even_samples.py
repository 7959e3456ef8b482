"""Samples that come evenly: the lowest of a wave's aliases is told, and nobody blames an encoder for it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import savgol_filter

from gearpoly.compare.angles import PARABOLA_SAMPLES, driven_share, smoothed
from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import compare
from gearpoly.compare.even import even_in_time, even_rate
from gearpoly.compare.sampling import sampling_of
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.files.pairfile import read_pair
from gearpoly.recording.recording import Recording
from gearpoly.units import DEG, UM, FloatArray

RATIO = 18 / 25
R_B2 = 25.0 * math.cos(20.0 * DEG)
"""mm: half of 25 teeth of module 2 on the base circle."""


def plain(folder: Path) -> Path:
    """18 on 25 teeth of module 2, of which nothing else is known."""
    path = folder / "plain.toml"
    path.write_text("[driving]\nteeth = 18\nmodule_mm = 2.0\n[driven]\nteeth = 25\nmodule_mm = 2.0\n", encoding="utf-8")
    return path


def turning(hz: float, *, rate: float, seconds: float, seed: int = 1) -> Recording:
    """Driving angle 180 deg/s at even times, a wave of 10 um in time, and noise of 0.1 um."""
    time = np.arange(round(rate * seconds)) / rate
    driving = 180.0 * DEG * time
    te = 10.0 * np.cos(2.0 * math.pi * hz * time + 1.0) + 0.1 * np.random.default_rng(seed).normal(size=time.size)
    return Recording(
        source=Path("even.csv"),
        time_s=time,
        driving_angle_rad=driving,
        driven_angle_rad=RATIO * driving + te * UM / R_B2,
    )


def compared(folder: Path, recording: Recording) -> Comparison:
    path = plain(folder)
    return compare(read_pair(path), [recording], path=path)


@pytest.mark.long
@pytest.mark.parametrize(
    ("hz", "rate", "seconds"),
    [
        (0.26, 180.0, 100.0),
        pytest.param(0.05, 180.0, 100.0, marks=pytest.mark.slow),
        pytest.param(0.26, 1000.0, 100.0, marks=pytest.mark.slow),
        pytest.param(0.05, 1000.0, 100.0, marks=pytest.mark.slow),
    ],
)
def test_a_slow_wave_of_even_samples_is_told_first_with_its_alias(
    tmp_path: Path, hz: float, rate: float, seconds: float
) -> None:
    located = compared(tmp_path, turning(hz, rate=rate, seconds=seconds)).located
    assert len(located.where) == 1  # no tooth, and nothing at or above half the rate
    (wave,) = located.where
    assert wave.hz == pytest.approx(hz, abs=1e-4)  # a hundredth of a line of 100 s
    assert wave.aliases == pytest.approx((rate - hz, rate + hz), abs=1e-3)
    # 0.1 um over the root of half of the samples is 0.001 um at 180 per s; five of these.
    assert wave.amplitude_um == pytest.approx(10.0, abs=5.0 * 0.1 * math.sqrt(2.0 / (rate * seconds)))
    assert located.noise_level / UM == pytest.approx(0.1, rel=0.05)  # as everywhere for noise


@pytest.mark.long
@pytest.mark.parametrize(("hz", "mesh"), [(63.0, ["mesh order 7, which so few samples show alike"]), (62.0, [])])
def test_a_mesh_order_above_half_the_rate_is_told_beside_its_alias(tmp_path: Path, hz: float, mesh: list[str]) -> None:
    """9 meshes a second, 100.3 samples: mesh order 7 is seen at 37.3 Hz, where no pair makes a wave. 62 Hz is none."""
    wave = compared(tmp_path, turning(hz, rate=100.3, seconds=40.0)).located.where[0]
    seen = wave.hz or (wave.order or 0.0) * 0.5
    assert seen == pytest.approx(100.3 - hz, abs=0.01)
    assert [one for one in wave.rivals if "mesh" in one] == mesh


@pytest.mark.slow
@pytest.mark.parametrize("hz", [0.26, 0.05])
def test_no_encoder_is_blamed_for_a_wave_of_even_samples(tmp_path: Path, hz: float) -> None:
    path = plain(tmp_path)
    found = diagnose(read_pair(path), [turning(hz, rate=180.0, seconds=40.0)], path=path)
    assert not found.findings
    assert [entry.hz for entry in found.unexplained] == [pytest.approx(hz, abs=1e-3)]


@pytest.mark.slow
def test_white_noise_as_transmission_error_gets_no_name(tmp_path: Path) -> None:
    """Even steps of 0.72 deg of the driven shaft: the driving angle is what both say, and brings their noise."""
    driven = 0.72 * DEG * np.arange(12_000)
    te = 0.3 * UM * np.random.default_rng(9).normal(size=driven.size)
    path = plain(tmp_path)
    recording = Recording(source=Path("te.csv"), driven_angle_rad=driven, te_mm=te)
    found = diagnose(read_pair(path), [recording], path=path)
    assert not found.findings
    assert not found.unexplained


def test_a_rate_shows_through_drop_outs_and_not_through_jitter() -> None:
    rng = np.random.default_rng(3)
    even = np.arange(5000) / 80.0
    assert even_rate(np.delete(even, [7, 8, 9, 400])) == pytest.approx(80.0, rel=1e-9)
    assert even_rate(even + 0.001 / 80.0 * rng.normal(size=even.size)) == pytest.approx(80.0, rel=1e-6)
    assert even_rate(even + 0.1 / 80.0 * rng.uniform(-1.0, 1.0, even.size)) is None


@pytest.mark.parametrize("jitter", [0.0, 0.1, 0.4])
def test_samples_that_come_early_or_late_have_the_rate_of_their_grid(jitter: float) -> None:
    """2040 Hz, each sample off its place by up to so much of a step, and a gap of 1 s. To 0.1 %: steps above 1.5 of
    the usual one are as ordinary as short ones, and without them it was 2056 Hz."""
    place = np.arange(9000) + np.random.default_rng(7).uniform(-jitter, jitter, 9000)
    time = place / 2040.0 + (np.arange(9000) > 5000)
    sampling = sampling_of(u=170.0 * time, time=time, z_1=17, z_2=22)
    assert sampling.rate == pytest.approx(2040.0, rel=1e-3)


def test_even_samples_are_even_though_their_times_are_rounded() -> None:
    """60 samples a second in whole ms, with a pause of 10 s: the middle step, 17 ms, counts 588 of the 600 samples that
    fit into it. Rounded so, times stray by 0.017 steps, and a wave still has its aliases."""
    time = np.arange(5000) / 60.0
    time[2500:] += 10.0
    assert even_in_time(np.round(time, 3)) == pytest.approx(60.0, rel=1e-5)
    assert even_in_time(time) == pytest.approx(60.0, rel=1e-9)
    # What strays by more than its rounding does not come evenly.
    strayed = time + 0.1 / 60.0 * np.random.default_rng(3).uniform(-1.0, 1.0, time.size)
    assert even_in_time(np.round(strayed, 3)) is None


def readings(noisy: str, *, even: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Both angles and their noise-free transmission error in rad, a noise of 0.1 um on one of them."""
    rng = np.random.default_rng(5)
    driving = 0.5 * DEG * (np.arange(20_000) + (0.0 if even else 0.3) * rng.uniform(-1.0, 1.0, 20_000))
    te = 2.0 * UM / R_B2 * np.cos(driving)
    driven = RATIO * driving + te
    noise = 0.1 * UM / R_B2 * rng.normal(size=driving.size)
    return (driving + noise / RATIO, driven, te) if noisy == "driving" else (driving, driven + noise, te)


@pytest.mark.parametrize(("noisy", "share"), [("driving", 0.0), ("driven", 1.0)])
def test_the_noise_is_laid_to_the_shaft_that_has_it(noisy: str, share: float) -> None:
    driving, driven, _ = readings(noisy, even=True)
    # Of 20 000 samples the share is known to a hundredth.
    assert driven_share(driving, driven, ratio=RATIO) == pytest.approx(share, abs=0.03)


def test_where_nothing_tells_each_shaft_has_half_of_the_noise() -> None:
    driving, driven, _ = readings("driven", even=False)
    assert driven_share(driving, driven, ratio=RATIO) == 0.5


@pytest.mark.parametrize("size", [PARABOLA_SAMPLES - 1, PARABOLA_SAMPLES, PARABOLA_SAMPLES + 1, 1000])
def test_a_parabola_is_laid_under_every_sample(size: int) -> None:
    """As Savitzky and Golay do, to rounding; what is too short for one stays as it is."""
    te = 1e-4 * np.random.default_rng(2).normal(size=size).cumsum()
    wanted = te if size < PARABOLA_SAMPLES else savgol_filter(te, PARABOLA_SAMPLES, 2)
    np.testing.assert_allclose(smoothed(te), wanted, rtol=0.0, atol=1e-14 * float(np.abs(te).max()))


def test_columns_at_the_estimated_angle_do_not_follow_a_reading_s_own_noise() -> None:
    """cos(1000 reading) over 1000 even samples a turn is sin(1000 te): at the angle as estimated it is not."""
    driving, driven, _ = readings("driven", even=True)
    driving, driven = driving / 0.5 * 0.36, driven / 0.5 * 0.36
    noise = driven - RATIO * driving
    noise -= smoothed(noise)
    order = 1000.0 / RATIO

    def followed(angle: FloatArray) -> float:
        """The part of a sample's own noise that the wave follows."""
        return abs(float(np.sin(order * angle) @ noise)) / order / float(noise @ noise)

    assert followed(driven) > 0.9  # all of it, to first order
    # The middle of 17 samples under a parabola keeps 13 % of its own noise, of which smoothing took a part before.
    assert followed(driven - noise) < 0.15


@pytest.mark.long
def test_few_samples_of_a_tooth_tell_none_where_the_mesh_does_not_show(tmp_path: Path) -> None:
    """A fifth of a pitch of one tooth 12 um low in 1 um of noise, 1.1 samples per mesh: 9 samples in 40 turns may not
    tell a tooth, though they stand out by far; 22 in 100 turns may."""
    for turns, told in ((40.0, False), (100.0, True)):
        rng = np.random.default_rng(2)
        count = round(18.0 * turns * 1.1)
        u = (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / 1.1
        low = -12.0 * ((np.floor(u) % 18.0 == 5.0) & (u % 1.0 < 0.2)) + rng.normal(size=count)
        driving = 2.0 * math.pi * u / 18.0
        one = Recording(
            source=Path("few.csv"),
            time_s=u / 9.0,
            driving_angle_rad=driving,
            driven_angle_rad=RATIO * driving + low * UM / R_B2,
        )
        where = compared(tmp_path, one).located.entries
        assert any(entry.kind == "tooth" and entry.phase is not None for entry in where) == told


@pytest.mark.parametrize(("hz", "timely"), [(60.0, True), (58.0, False)])
def test_what_even_samples_show_as_hum_is_told_in_time(tmp_path: Path, hz: float, timely: bool) -> None:
    """60 Hz in 70.6 samples per second is seen at 10.6 Hz, 21.2 times per turn of the driving gear; 58 Hz at 12.6 Hz,
    25.2 times: as likely something that turns."""
    wave = compared(tmp_path, turning(hz, rate=70.6, seconds=40.0)).located.where[0]
    assert (wave.kind == "time") == timely
    if timely:
        assert wave.hz == pytest.approx(70.6 - hz, abs=1e-3)
        assert wave.aliases[0] == pytest.approx(hz, abs=1e-3)
    else:
        assert wave.order == pytest.approx((70.6 - hz) * 2.0, abs=0.01) or wave.gear == "driven"
