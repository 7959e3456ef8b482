"""Channels that were read at times of their own: TDMS waveforms and UFF58 abscissas."""

from __future__ import annotations

import importlib
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.recording.clean import clean
from gearpoly.recording.read import read_recording
from gearpoly.units import UM, FloatArray
from tests import recording_files as files
from tests.made_readings import needs, refusal
from tests.made_recordings import inspected, te_of

TURN, RATIO = 2.0 * math.pi, 18.0 / 25.0
START = np.datetime64("2026-03-01T08:00:00.000000")
LATE, STEP = 0.2173, 0.5e-3
"""s: how much later the driven channel begins (434.6 samples), and between two samples."""


def turned(t: FloatArray) -> FloatArray:
    """Driving rotation in rad at half a turn a second, wobbling by a fifth."""
    return np.asarray(TURN * (0.5 * t + 0.1 / (TURN * 0.4) * np.sin(TURN * 0.4 * t)))


def write_tdms(file: Path, channels: dict[str, tuple[FloatArray, dict[str, Any]]]) -> None:
    nptdms = importlib.import_module("nptdms")
    with nptdms.TdmsWriter(file) as writer:
        writer.write_segment([nptdms.ChannelObject("rig", n, v, properties=p) for n, (v, p) in channels.items()])


def waveform(begin: float, step: float = STEP, offset: float = 0.0) -> dict[str, Any]:
    return {
        "wf_start_time": START + np.timedelta64(round(begin * 1e6), "us"),
        "wf_start_offset": offset,
        "wf_increment": step,
    }


@needs("nptdms")
@pytest.mark.parametrize("way", ["wf_start_time", "wf_start_offset", "wf_increment"])
def test_channels_that_begin_apart_are_put_on_one_axis(tmp_path: Path, way: str) -> None:
    """A simulated pair with an eccentricity of 5.0 um, order 1: 3.5 um rms, where rows pair what is 0.2 s apart."""
    _, _, made = inspected(tmp_path, np.random.default_rng(5))
    grid = np.arange(-0.2, 5.0 * TURN, TURN / 25 / 30)
    simulated = te_of(made, grid, flank="drive", torque_nm=0.0)
    r_b2 = made.pair.r_b2

    def te(theta_1: FloatArray) -> FloatArray:
        order_1 = 5.0 * UM / r_b2 * np.sin(theta_1)
        return np.asarray(np.interp(RATIO * theta_1 + order_1, grid, simulated) + order_1)

    slow = 3.0 * STEP if way == "wf_increment" else STEP
    t_1 = STEP * np.arange(24_000)
    t_2 = LATE + slow * np.arange(int(11.0 / slow))
    columns = {
        "driving_angle_deg": np.degrees(turned(t_1)) % 360.0,
        "driven_angle_deg": np.degrees(RATIO * turned(t_2) + te(turned(t_2))) % 360.0,
    }
    begins = {"wf_start_offset": waveform(0.0, slow, LATE)}.get(way, waveform(LATE, slow))
    file = tmp_path / "rig.tdms"
    write_tdms(
        file,
        {
            "driving_angle_deg": (columns["driving_angle_deg"], waveform(0.0)),
            "driven_angle_deg": (columns["driven_angle_deg"], begins),
        },
    )
    recording = read_recording(file)
    assert any("driven_angle_deg begins 0.2173 s after driving_angle_deg" in remark for remark in recording.remarks)
    assert any("interpolated linearly" in remark for remark in recording.remarks)
    cleaned = clean(recording, ratio=RATIO, r_b2=r_b2)
    known = np.interp(RATIO * cleaned.theta_1, grid, simulated)

    def left(found: FloatArray) -> float:
        return float(np.std((found - known) * r_b2 / UM))

    # 5.0/sqrt(2) um; a broken number of turns and what the simulation moves along within 5 um make a hundredth.
    assert left(cleaned.te) == pytest.approx(5.0 / math.sqrt(2.0), abs=0.05)
    if way != "wf_increment":
        rows = min(t_1.size, t_2.size)
        paired = RATIO * turned(t_2[:rows]) + te(turned(t_2[:rows])) - RATIO * turned(t_1[:rows])
        assert np.std(paired * r_b2 / UM) > 500.0  # what pairing by row would have made of it


@needs("nptdms")
def test_waveforms_that_cannot_be_placed_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "rig.tdms"
    x = np.arange(50.0)

    def save(first: dict[str, Any], second: dict[str, Any], **more: FloatArray) -> None:
        channels = {"driving_angle_deg": (x, first), "driven_angle_deg": (x, second)}
        write_tdms(file, channels | {name: (values, {}) for name, values in more.items()})

    save({"wf_start_time": START}, {"wf_start_time": START + np.timedelta64(1, "s")})
    assert "no wf_increment above 0" in refusal(file).found
    save(waveform(0.0), {})
    assert "wf_start_time missing" in refusal(file).found
    save(waveform(0.0), waveform(0.0, -STEP))
    assert "no wf_increment above 0" in refusal(file).found
    save(waveform(0.0), waveform(0.0, math.nan))
    assert refusal(file).found == "wf_increment nan"
    save(waveform(0.0), waveform(1.0))
    assert "do not turn at the same time" in refusal(file).found
    save(waveform(0.0), waveform(LATE), time_s=x)
    assert "driven_angle_deg begins 0.2173 s after" in refusal(file).found
    save(waveform(0.0), waveform(0.0), time_s=x)
    assert any("wf" in remark for remark in read_recording(file).remarks) is False
    save(waveform(0.0), waveform(0.7e-6))  # less than the microsecond to which npTDMS tells time stamps
    np.testing.assert_array_equal(read_recording(file).time_s, STEP * x)


def uff_text(file: Path, sets: dict[str, tuple[str, str, list[tuple[str, float]]]], *, kind: int = 17) -> None:
    """Data sets as text: start and step of the abscissas (both "" where they are stored), and the values."""
    parts = []
    for name, (start, step, values) in sets.items():
        even = bool(step)
        head = files.uff_header(name, len(values), {}, binary=False, even=even).decode().splitlines()
        head[8] = f"{4:10d}{len(values):10d}{int(even):10d}{start or '0.0':>13}{step or '0.0':>13}{0:13.5e}"
        head[9] = f"{kind:10d}" + head[9][10:]
        body = [f"{v:20.11e}" if even else f"{x:>13}{v:20.11e}" for x, v in values]
        parts.append("\n".join([*head, *body, "    -1", ""]))
    file.write_text("".join(parts), encoding="ascii")


def test_uff58_sets_of_their_own_abscissas(tmp_path: Path) -> None:
    """Driving at 0, 1, 2, ... s and driven at 0.5, 1.5, ... s of one steady run: 30 and 21.6 deg a second."""
    file = tmp_path / "rig.unv"
    first = [(f"{i:.4f}", 30.0 * i) for i in range(40)]
    second = [(f"{i + 0.5:.4f}", 21.6 * (i + 0.5)) for i in range(39)]
    for even in (True, False):
        stated = (("0.0", "1.0"), ("0.5", "1.0")) if even else (("", ""), ("", ""))
        uff_text(file, {"driving_angle_deg": (*stated[0], first), "driven_angle_deg": (*stated[1], second)})
        got = read_recording(file)
        assert got.driving_angle_rad is not None and got.driven_angle_rad is not None
        np.testing.assert_allclose(got.driven_angle_rad, RATIO * got.driving_angle_rad, rtol=1e-11)  # twelve digits
        np.testing.assert_array_equal(got.time_s, 0.5 + np.arange(39))
    uff_text(file, {"driving_angle_deg": ("", "", first), "driven_angle_deg": ("", "", second)}, kind=0)
    assert "abscissas that differ from column to column" in refusal(file).found
    uff_text(file, {"driving_angle_deg": ("", "", first), "driven_angle_deg": ("", "", second[::-1])})
    assert "not after the one before" in refusal(file).found


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e999"])
def test_uff58_abscissas_that_are_no_numbers(tmp_path: Path, value: str) -> None:
    file = tmp_path / "rig.unv"
    good = [(f"{i:.4f}", 30.0 * i) for i in range(9)]
    bad = [(value if i == 4 else x, v) for i, (x, v) in enumerate(good)]
    uff_text(file, {"driving_angle_deg": ("", "", good), "driven_angle_deg": ("", "", bad)})
    error = refusal(file)
    assert "value 5" in error.found and "driven_angle_deg" in error.where
    for start, step in ((value, "1.0"), ("0.0", value)):
        uff_text(file, {"driving_angle_deg": (start, step, good), "driven_angle_deg": ("0.0", "1.0", good)})
        assert "abscissas from" in refusal(file).found
    uff_text(file, {"driving_angle_deg": ("0.0", "1e308", good), "driven_angle_deg": ("0.0", "1e308", good)})
    assert "abscissa inf of value 3" in refusal(file).found
    for word in ("x", "1.2.3"):
        bad = [(word if i == 4 else x, v) for i, (x, v) in enumerate(good)]
        uff_text(file, {"driving_angle_deg": ("", "", good), "driven_angle_deg": ("", "", bad)})
        assert word in refusal(file).found


@pytest.mark.long
def test_a_table_of_two_devices_that_read_by_turns(tmp_path: Path) -> None:
    """As programs merge them by time, at rates of their own. Angles are those of the times at which the slower was
    read; of a second that one of them missed nothing is made."""
    t_1, t_2 = STEP * np.arange(20_000), LATE / 1000.0 + 3.0 * STEP * np.arange(6_600)
    driving = np.degrees(turned(t_1))
    driving[(t_1 > 4.0) & (t_1 < 5.0)] = math.nan
    both = sorted(
        [(t, f"{t:.7f},{np.mod(a, 360.0):.7f},") for t, a in zip(t_1, driving, strict=True) if np.isfinite(a)]
        + [(t, f"{t:.7f},,{a:.7f}") for t, a in zip(t_2, np.degrees(RATIO * turned(t_2)), strict=True)]
    )
    file = tmp_path / "merged.csv"
    head = "time_s,driving_angle_deg,driven_angle_deg"
    file.write_text("\n".join([head, *(row for _, row in both)]) + "\n", encoding="utf-8")
    recording = read_recording(file)
    assert any("read by turns" in one for one in recording.remarks)
    assert recording.time_s is not None and recording.driving_angle_rad is not None
    np.testing.assert_allclose(recording.time_s[:1000], t_2[:1000], rtol=0.0, atol=1e-7)
    missed = (recording.time_s > 4.0) & (recording.time_s < 5.0)
    assert np.isnan(recording.driving_angle_rad[missed]).all() and not np.isnan(recording.driving_angle_rad).all()
    cleaned = clean(recording, ratio=RATIO)
    # Between samples 0.5 ms apart a speed that sways by 0.6 rad/s at 0.4 Hz bends by 0.5e-7 rad; angles have 1e-7 deg.
    assert np.abs(cleaned.te - np.mean(cleaned.te)).max() < 1e-7
