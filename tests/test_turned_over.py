"""A load that turns over while the shafts turn on: both flanks in one recording, and the backlash between them."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.turned_over import CHANGE_LEFT_OUT_MESHES, parted
from gearpoly.compare.turns import backlash
from gearpoly.files.models import PairFile
from gearpoly.recording.clean import Cleaned, clean
from gearpoly.recording.recording import Recording
from gearpoly.units import RPM, UM, BoolArray, FloatArray
from tests.pair_files import made, unloaded_te
from tests.physics_cases import rough

TEETH, TURN, NOISE = (13, 31), 2.0 * math.pi, 0.4 * UM
FILE = rough(TEETH, bends=False, points=200)
HALVES = 0.3
"""Driven angle in rad at which the load turns over, and half a turn on."""


def angles(turns: float = 3.3) -> FloatArray:
    """Driven rotation (n,), 20 samples to the mesh."""
    return np.arange(0.05, turns * TURN, TURN / TEETH[1] / 20)


def coast_in(theta_2: FloatArray) -> BoolArray:
    return np.asarray(np.sin(theta_2 - HALVES) < 0.0)


def recording(theta_2: FloatArray, te: FloatArray, *, file: PairFile = FILE, backward: bool = False) -> Recording:
    """Readings of both shafts, wrapped, the driving one counting down."""
    pair = made(file).pair
    noisy = te + np.random.default_rng(3).normal(0.0, NOISE, te.size)
    theta_1 = (theta_2 - noisy / pair.r_b2) / pair.ratio
    time = theta_2 / (pair.ratio * 60.0 * RPM)
    order = slice(None, None, -1) if backward else slice(None)
    return Recording(
        source=Path("joint.csv"), time_s=(time[-1] - time)[order] if backward else time,
        driving_angle_rad=np.mod(1.1 - theta_1, TURN)[order], driven_angle_rad=np.mod(theta_2 + 2.3, TURN)[order],
        driving_zero_rad=1.1, driven_zero_rad=2.3, driving_direction=-1, backward=backward,
    )  # fmt: skip


def turned_over(theta_2: FloatArray, *, file: PairFile = FILE) -> FloatArray:
    """Transmission error (n,) in mm where the load turns over every half turn of the driven shaft."""
    drive, coast = (unloaded_te(made(file), theta_2, flank=flank) for flank in ("drive", "coast"))
    return np.where(coast_in(theta_2), coast, drive)


def parts_of(one: Recording, *, file: PairFile = FILE) -> list[Cleaned]:
    pair = made(file).pair
    return parted([clean(one, ratio=pair.ratio, r_b2=pair.r_b2)], file, pair)


@pytest.mark.parametrize("backward", [False, True])
def test_either_flank_is_a_recording_of_its_own(backward: bool) -> None:
    """Whichever way the shafts turn, the error is higher on the coast flanks. No sample is on the wrong one, and none
    is lost but those beside the seven changes, half a mesh on either side."""
    theta_2 = angles()
    parts = parts_of(recording(theta_2, turned_over(theta_2), backward=backward))
    assert [one.recording.flank for one in parts] == ["drive", "coast"]
    for one in parts:
        assert np.all(np.diff(one.theta_2) > 0.0)
        assert one.recording.size == one.size
        assert np.all(coast_in(one.theta_2) == (one.recording.flank == "coast"))
    lost = theta_2.size - sum(one.size for one in parts)
    assert lost <= 7 * 20 * (2.0 * CHANGE_LEFT_OUT_MESHES + 0.3)


@pytest.mark.long
def test_the_backlash_is_told_and_what_is_left_is_noise() -> None:
    """The truth is the file's own pair, with 60 um of play on each gear: each flank is left with its noise about one
    zero (chords of so few points lag by 0.05 um), and the steps are the simulated backlash but for teeth of 3 um rms at
    the changes."""
    theta_2 = angles()
    beside = compare(FILE, [recording(theta_2, turned_over(theta_2))], path=Path("pair.toml"))
    assert [one.flank for one in beside.aligned] == ["drive", "coast"]
    for one in beside.aligned:
        assert float(np.std(one.residual)) == pytest.approx(NOISE, rel=0.05)
        assert float(np.mean(one.residual)) == pytest.approx(0.0, abs=0.1 * UM)
    (said,) = [one for one in beside.remarks if "turns over" in one]
    assert "turns over 7 times" in said
    told = float(said.split("steps up and down by ")[1].split(" ")[0])
    assert told == pytest.approx(float(np.mean(backlash(made(FILE).pair).j_bn)) / UM, abs=4.0)


def test_a_torque_that_changes_its_sign_brakes_on_the_coast_flank() -> None:
    theta_2 = angles()
    torque = np.where(coast_in(theta_2), -3.0, 4.0)
    drive, coast = parts_of(replace(recording(theta_2, turned_over(theta_2)), torque_samples_nm=torque))
    assert drive.torque_nm is not None and coast.torque_nm is not None
    assert np.all(drive.torque_nm == 4.0)
    assert np.all(coast.torque_nm == 3.0)
    assert coast.recording.torque_samples_nm is not None
    assert np.all(coast.recording.torque_samples_nm == 3.0)


def off_axis(theta_2: FloatArray) -> FloatArray:
    return 0.04 * np.sin(theta_2) + 0.03 * np.sin(theta_2 * TEETH[1] / TEETH[0])


def proud(theta_2: FloatArray) -> FloatArray:
    """Two teeth in every turn that stand out by 80 um, for a mesh and a half each."""
    u = np.mod(theta_2 * TEETH[1] / TURN, TEETH[1])
    return 0.08 * ((np.abs(u - 6.0) < 0.75) | (np.abs(u - 21.0) < 0.75))


def knocked(theta_2: FloatArray) -> FloatArray:
    """A reader that is knocked, and put back."""
    return 0.08 * ((theta_2 > 5.0) & (theta_2 < 12.0))


def slipping(theta_2: FloatArray) -> FloatArray:
    """A coupling that slips one way only."""
    return 0.08 * np.floor(theta_2 / 3.0)


def uneven(theta_2: FloatArray) -> FloatArray:
    """Steps up and down by no one size."""
    return np.interp(np.floor(theta_2 / 3.0), np.arange(7), [0.0, 0.08, 0.05, 0.12, 0.02, 0.14, 0.0])


def half_indexed(theta_2: FloatArray) -> FloatArray:
    """A gear cut in two settings 30 um apart: within what is asked of the teeth first."""
    return 0.03 * (np.sin(theta_2) > 0.0)


@pytest.mark.parametrize("others", [off_axis, proud, knocked, slipping, uneven, half_indexed])
def test_what_else_steps_is_no_change_of_flank(others: object) -> None:
    theta_2 = angles()
    te = unloaded_te(made(FILE), theta_2) + others(theta_2)  # type: ignore[operator]
    (one,) = parts_of(recording(theta_2, te))
    assert one.size == theta_2.size


def test_changes_that_stand_on_gears_off_their_axes_are_found() -> None:
    """40 um of eccentricity beside 110 um of backlash."""
    theta_2 = angles()
    parts = parts_of(recording(theta_2, turned_over(theta_2) + off_axis(theta_2)))
    assert [one.recording.flank for one in parts] == ["drive", "coast"]


def test_a_reading_that_jitters_backward_at_the_beginning_is_no_trouble() -> None:
    """A coarse reading comes back by a step, behind the first sample."""
    theta_2 = angles()
    pair = made(FILE).pair
    one = clean(recording(theta_2, turned_over(theta_2)), ratio=pair.ratio, r_b2=pair.r_b2)
    back = one.theta_2.copy()
    back[1] = back[0] - 1e-3
    plain, parts = (parted([each], FILE, pair) for each in (one, replace(one, theta_2=back)))
    assert [each.size for each in parts] == pytest.approx([each.size for each in plain], abs=3)
