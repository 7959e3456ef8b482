"""Coarse readings: their step is read off themselves and told, waves that rounding makes are no finds, repeats no
crash."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import compare
from gearpoly.compare.entries import IN_TIME, OF_THE_READINGS
from gearpoly.compare.locate import locate
from gearpoly.compare.noise import spacing_of
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.diagnose.compare_as_built import compare_as_built
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.files.pairfile import read_pair
from gearpoly.physics.place import Place
from gearpoly.recording.recording import Recording
from gearpoly.recording.rounding import reading_step
from gearpoly.units import DEG, UM, FloatArray
from tests.test_even_samples import R_B2, RATIO, plain

COUNT = 360.0 / 4096
"""deg: a count of 12 bits."""


def by_hand(n: int = 10_000) -> FloatArray:
    """Angles in deg of a shaft that rests, is turned by hand at 1.2 deg a sample, faster and slower, and rests."""
    along = np.linspace(0.0, 1.0, n)
    speed = 1.2 * np.clip(np.minimum(along, 1.0 - along) * 20.0 - 1.0, 0.0, 1.0) * (1.0 + 0.01 * np.sin(40.0 * along))
    return np.cumsum(speed)


def uneven(n: int = 20_000) -> FloatArray:
    """Angles in deg, 0.4 to 0.6 apart."""
    return np.cumsum(np.random.default_rng(2).uniform(0.4, 0.6, n))


@pytest.mark.parametrize(
    ("angle", "step"),
    [
        (uneven(), None),
        (np.round(uneven(), 1), 0.1),
        (np.round(uneven() / COUNT) * COUNT, COUNT),
        (np.round(np.round(uneven() / COUNT) * COUNT, 6), COUNT),  # as a file with six decimals has it
        (np.round(0.25 * np.arange(20_000.0) + 0.013, 1), 0.1),
        (0.18 * np.arange(20_000.0), None),  # even samples tell no step
        (np.delete(0.18 * np.arange(20_000.0), [5, 77, 900]), None),  # nor do drop-outs among them
        (1.44 * (np.arange(20_000) // 2), 1.44),
        (np.round(by_hand() / COUNT) * COUNT, COUNT),
        (np.round(np.r_[np.zeros(500), uneven(9_000) * 200.0] / COUNT) * COUNT, COUNT),  # a stop before a thousand
        (np.round(3.0 * uneven() / (COUNT / 4)) * COUNT / 4, COUNT / 4),  # some hundred counts from sample to sample
    ],
)
def test_the_step_is_read_off_the_readings(angle: FloatArray, step: float | None) -> None:
    found = reading_step(angle * DEG)
    if step is None:
        assert found is None
    else:
        assert found == pytest.approx(step * DEG, rel=1e-5)  # six decimals over 20 000 differences


def coarse(driving: FloatArray, *, rounded: tuple[bool, bool] = (True, True)) -> Recording:
    """Once per turn 2 um and noise of 0.1 um, read to 0.1 deg."""
    te = 2.0 * np.cos(driving * DEG) + 0.1 * np.random.default_rng(4).normal(size=driving.size)
    angles = driving, RATIO * driving + te * UM / R_B2 / DEG
    first, second = (np.round(a, 1) if coarse_ else a for a, coarse_ in zip(angles, rounded, strict=True))
    return Recording(source=Path("coarse.csv"), driving_angle_rad=first * DEG, driven_angle_rad=second * DEG)


def compared(folder: Path, recording: Recording) -> Comparison:
    path = plain(folder)
    return compare(read_pair(path), [recording], path=path)


@pytest.mark.long
def test_rounding_is_told_of_the_shaft_that_has_it(tmp_path: Path) -> None:
    found = compared(tmp_path, coarse(uneven(10_000), rounded=(False, True)))
    (one,) = found.aligned
    assert one.steps[0] is None
    assert one.steps[1] == pytest.approx(0.1 * DEG, rel=1e-6)
    # A step over the root of 12, along the line of action.
    assert one.rounding == pytest.approx(0.1 * DEG / math.sqrt(12.0) * R_B2, rel=1e-6)
    assert found.located.noise_level == pytest.approx(one.rounding, rel=0.05)
    (remark,) = [r for r in found.remarks if "in steps of" in r]
    assert "the driven angle in steps of 0.1 deg (3600 a turn)" in remark
    assert "driving angle" not in remark
    assert remark.endswith("line of action, as noise")
    assert one.coarse_for_a_while == 0.0  # advances jitter by four tenths of a step


@pytest.mark.long
def test_an_axis_moved_in_even_steps_is_read_as_finely_as_it_says(tmp_path: Path) -> None:
    """2.5 deg from sample to sample, with gaps, to five decimals: rounding by 2.5 deg would make 100 times what the
    recording differs by."""
    even = 2.501738 * np.arange(1_800.0) + 27.49311
    gone = np.concatenate([np.arange(k, k + 1 + k % 5) for k in range(60, 1_750, 84)])
    axis = np.round(np.delete(even, gone), 5)
    # More than one in a hundred steps is another, so that it looks like a count.
    assert reading_step(axis * DEG) == pytest.approx(2.501738 * DEG, rel=1e-5)
    found = compared(tmp_path, coarse(axis, rounded=(False, False)))
    (one,) = found.aligned
    assert one.rms < 2.0 * UM
    assert one.rounding < 0.1 * one.rms
    assert (one.coarse, one.coarse_for_a_while) == (0.0, 0.0)
    assert not any("rounding" in remark for remark in found.remarks)
    assert any((entry.gear, entry.order) == ("driving", 1.0) for entry in found.located.where)


@pytest.mark.slow
def test_waves_that_rounding_makes_in_even_samples_are_no_finds(tmp_path: Path) -> None:
    """1.1 deg and 0.1 deg share no short pattern: 3600 counts come back as waves at many orders of either shaft."""
    found = compared(tmp_path, coarse(1.1 * np.arange(10_000.0) + 0.013))
    stand = [e for e in found.located.where if e.companion_of is None and not e.as_built]
    assert [(e.gear, e.order) for e in stand] == [("driving", 1.0)]
    assert stand[0].amplitude_um == pytest.approx(2.0, abs=0.3)  # what waves of 12 um leave at order 1, by eye
    assert any("of any order of either shaft" in r for r in found.remarks)


@pytest.mark.long
def test_waves_that_rounding_makes_while_a_shaft_turns_evenly_are_no_finds(tmp_path: Path) -> None:
    """Where speed is largest or least it stays the same for a while, and 3600 counts beat with the samples."""
    told = coarse(by_hand())
    found = compared(tmp_path, replace(told, time_s=0.01 * np.arange(told.size)))
    (one,) = found.aligned
    assert one.coarse_for_a_while == pytest.approx(one.rounding * math.sqrt(12.0) / math.pi) and not one.stepped
    foreign = [e for e in found.located.entries if e.kind in IN_TIME or e.order_std is not None]
    assert len(foreign) > 10 and all(e.companion_of == OF_THE_READINGS for e in foreign)
    assert all(e.companion_of is not None or (e.order or 0.0) <= 12.0 for e in found.located.entries)
    assert any("as waves of no shaft while the speed stays the same" in r for r in found.remarks)


@pytest.mark.long
def test_beside_gears_that_nobody_inspected_they_are_none_either(tmp_path: Path) -> None:
    """Where teeth are open they are located anew beside the teeth as built: 36 such waves were told as places there."""
    path = plain(tmp_path)
    path.write_text(path.read_text().replace("teeth = ", "grade = 6\nteeth = "))
    told = coarse(by_hand())
    found = compare_as_built(read_pair(path), [replace(told, time_s=0.01 * np.arange(told.size))], path=path)
    foreign = [e for e in found.located.entries if e.kind in IN_TIME or e.order_std is not None]
    assert len(foreign) > 10 and all(e.companion_of == OF_THE_READINGS for e in foreign)


@pytest.mark.slow
@pytest.mark.parametrize("driving", [1.1 * np.arange(10_000.0) + 0.013, by_hand()], ids=["even", "by hand"])
def test_no_encoder_line_is_named_where_rounding_makes_lines(driving: FloatArray, tmp_path: Path) -> None:
    path = plain(tmp_path)
    told = coarse(driving)
    found = diagnose(read_pair(path), [replace(told, time_s=0.01 * np.arange(told.size))], path=path)
    assert {one.claim.physics.name for one in found.findings} <= {"encoder_eccentricity", "eccentricity"}


@pytest.mark.long
def test_no_order_at_or_above_half_the_samples_per_turn_is_a_candidate(tmp_path: Path) -> None:
    from gearpoly.compare.compare import lay_beside
    from gearpoly.diagnose.prepare import prepare

    path = plain(tmp_path)
    file = read_pair(path)
    scope = prepare(file, lay_beside(file, [coarse(0.36 * np.arange(20_000.0))], path=path), path=path).scope
    for gear, samples in ((0, 1000.0), (1, 1000.0 / RATIO)):
        assert scope.finest[gear] == pytest.approx(0.5 * samples, rel=1e-3)
        assert not scope.shows(Place(gear=gear, order=math.ceil(0.5 * samples) + 1))
        assert scope.shows(Place(gear=gear, order=2))


def residual(u: FloatArray, values: FloatArray) -> AlignedResidual:
    turns = 2.0 * math.pi * u
    return AlignedResidual(theta_1=turns / 18, theta_2=turns / 25, residual=values, z_2=25)


@pytest.mark.parametrize("repeats", [2, 3, 34])
def test_readings_that_repeat_have_a_spacing(repeats: int) -> None:
    u = (np.arange(6400) // repeats) * (0.05 * repeats)
    # Over 64 samples a repeat more or less is a fiftieth of ``repeats`` = 2, and half of 34.
    assert spacing_of(u) == pytest.approx(0.05, rel=repeats / 64)


@pytest.mark.long
@given(
    step=st.floats(1e-3, 0.9),
    spacing=st.floats(5e-3, 0.3),
    jitter=st.floats(0.0, 0.4),
    every=st.integers(1, 12),
    seed=st.integers(0, 1000),
)
@settings(max_examples=12, deadline=None)
def test_coarse_and_repeated_readings_never_crash(
    step: float, spacing: float, jitter: float, every: int, seed: int
) -> None:
    """Whatever repeats, the comparison comes to its end with finite figures."""
    rng = np.random.default_rng(seed)
    place = np.sort((np.arange(700) + jitter * rng.uniform(-1.0, 1.0, 700)) * spacing)
    u = np.round(place[(np.arange(700) // every) * every] / step) * step
    if np.ptp(u) < 36.0:
        u = u + np.linspace(0.0, 36.0, 700) // step * step
    found = locate([residual(u, 1e-4 * rng.normal(size=u.size))], gears=(GearKnown(z=18), GearKnown(z=25)))
    assert math.isfinite(found.noise_level)
    assert all(math.isfinite(e.amplitude_um or 0.0) for e in found.where)
