"""Bursts: when, how large and at what tone, none in noise of any colour, and two waves are never one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearpoly.compare.bursts import burst_entries
from gearpoly.compare.entries import Entry, says
from gearpoly.compare.locate import locate
from gearpoly.compare.noise import estimate_noise
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.units import FloatArray
from tests.residuals import healthy

UM = 1e-3
TAU = 0.15
"""s in which a knock of these tests dies down to a third."""


def made(seed: int, kind: str = "white", *, cycles: float = 2.0) -> AlignedResidual:
    """A healthy 18/25 pair in noise of 1 um; one hunting cycle lasts 50 s, at 180 samples a second."""
    return healthy(np.random.default_rng(seed), z_1=18, z_2=25, cycles=cycles, kind=kind)


def knocked(data: AlignedResidual, *, at: float, size_um: float, hz: float = 23.0) -> AlignedResidual:
    """With a knock at ``at`` s that rings at ``hz`` and dies down."""
    assert data.time_s is not None
    late = data.time_s - data.time_s[0] - at
    ring = np.where(late > 0.0, np.exp(-np.maximum(late, 0.0) / TAU), 0.0) * np.cos(2.0 * math.pi * hz * late)
    return replace(data, residual=data.residual + UM * size_um * ring)


def bursts(data: AlignedResidual) -> list[Entry]:
    """Bursts of what is left when nothing but the mean is fitted."""
    left: FloatArray = data.residual - np.mean(data.residual)
    u = data.theta_2 * (25 / (2.0 * math.pi))
    return burst_entries(0, data, left, estimate_noise(u, left, z_1=18, z_2=25), period=450.0)


def test_a_knock_is_told_with_its_moment_and_tone() -> None:
    """It lasts TAU; its first TAU holds most of it. The tone to half a line of so short a stretch."""
    data = knocked(made(3), at=41.0, size_um=8.0)
    assert data.time_s is not None
    (one,) = bursts(data)
    assert one.during_s is not None
    begin, end = (t - data.time_s[0] for t in one.during_s)
    assert begin < 41.0 + TAU
    assert 41.0 < end < 41.0 + 6.0 * TAU
    assert one.hz == pytest.approx(23.0, abs=0.5 / (end - begin) + 0.5)
    assert "a burst of" in says(one)
    assert "Hz" in says(one)


@pytest.mark.long
@pytest.mark.parametrize("seeds", [range(3), pytest.param(range(3, 40), marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", ["white", "ar", "wandering"])
def test_noise_has_no_bursts(kind: str, seeds: range) -> None:
    """A millionth of them may."""
    assert sum(len(bursts(made(seed, kind))) for seed in seeds) == 0


def test_noise_that_is_loud_now_and_then_has_none() -> None:
    """Four loud stretches and more are how the noise of this rig is."""
    data = made(5)
    for at in (11.0, 27.0, 44.0, 63.0, 82.0):
        data = knocked(data, at=at, size_um=8.0)
    assert bursts(data) == []
    assert len(bursts(knocked(knocked(made(5), at=20.0, size_um=8.0), at=76.0, size_um=8.0))) == 2


def test_a_recording_without_times_tells_turns() -> None:
    data = knocked(made(3), at=41.0, size_um=8.0)
    turns = (data.theta_1 - data.theta_1[0]) / (2.0 * math.pi)
    (one,) = bursts(replace(data, time_s=None))
    assert one.hz is None
    assert one.during_turns is not None
    # 30 rpm: half a turn a second.
    assert one.during_turns[0] == pytest.approx(20.5, abs=0.5)
    assert one.during_turns[1] < turns[-1]


def test_what_comes_again_with_the_pair_is_no_burst() -> None:
    """A corner that shakes once a hunting cycle, of 50 s, is the gears'."""
    data = made(3)
    assert len(bursts(knocked(data, at=30.0, size_um=8.0))) == 1
    # The speed wobbles by a hundredth of a turn or so, much less than a knock lasts.
    u = data.theta_2 * (25 / (2.0 * math.pi))
    assert data.time_s is not None
    again = float(np.interp(np.interp(30.0 + data.time_s[0], data.time_s, u) + 450.0, u, data.time_s) - data.time_s[0])
    assert bursts(knocked(knocked(data, at=30.0, size_um=8.0), at=again, size_um=8.0)) == []


def test_what_lasts_as_long_as_two_teeth_touch_may_be_theirs() -> None:
    """Two teeth of 18/25 meet once in 450 meshes, of 20 samples each: in less than that their meeting looks like a
    burst, in more it would have come again. What lasts longer than a contact is none of theirs."""

    def shaken(data: AlignedResidual, samples: int) -> list[str]:
        there = np.zeros(data.residual.size)
        there[4000 : 4000 + samples] = 8.0 * UM * (-1.0) ** np.arange(samples)
        return [says(one) for one in bursts(replace(data, residual=data.residual + there))]

    words = "; or the two teeth that meet there, once in this recording"
    assert [one.endswith(words) for one in shaken(made(3, cycles=0.9), 24)] == [True]
    assert [words in one for one in shaken(made(3, cycles=0.9), 100)] == [False]
    assert [words in one for one in shaken(made(3), 24)] == [False]


@pytest.mark.long
def test_compare_locates_a_knock_and_names_no_wave() -> None:
    gears = GearKnown(z=18, uncertainty=0.2 * UM), GearKnown(z=25, uncertainty=0.2 * UM)
    found = locate([knocked(made(8), at=41.0, size_um=8.0)], gears=gears).entries
    assert [one.label for one in found] == ["burst"]


@pytest.mark.slow
def test_a_wave_that_swells_is_one_wave_of_its_size() -> None:
    """Order 0.61 grows from nothing to 4 um: two in the mean. What one steady wave leaves stands beside it, line after
    line on either side and ever smaller, so a few are found; none is larger than what was made."""
    data = made(4)
    growing = np.linspace(0.0, 4.0, data.theta_1.size) * np.cos(0.61 * data.theta_1)
    gears = GearKnown(z=18, uncertainty=0.2 * UM), GearKnown(z=25, uncertainty=0.2 * UM)
    found = locate([replace(data, residual=data.residual + UM * growing)], gears=gears).entries
    assert 1 <= len(found) <= 8
    assert all((one.amplitude_um or 0.0) < 4.0 for one in found)
    assert found[0].amplitude_um == pytest.approx(2.0, abs=0.7)
