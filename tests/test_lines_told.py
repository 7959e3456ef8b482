"""Lines of an encoder that come more than once per two samples."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.lines_told import lines_told
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.units import FloatArray
from tests.physics_cases import Condition, recorded, rough

PER_TURN = 288


def samples(early_or_late: float, *, wanders: float = 0.0, rpm: float | None = None, unsteady: float = 0.0) -> Any:
    """Twenty turns of the driving shaft whose samples come so many steps early or late, and wander by so many; with
    time at so many ``rpm``, which swing by an ``unsteady`` part three times."""
    n = 20 * PER_TURN
    steps = np.arange(n) + np.random.default_rng(7).uniform(-early_or_late, early_or_late, n)
    steps += wanders * np.sin(2.0 * math.pi * 3.0 * np.arange(n) / n)
    angle: FloatArray = 2.0 * math.pi * steps / PER_TURN
    time = None
    if rpm is not None:
        swing = unsteady / (2.0 * math.pi * 3.0) * np.sin(2.0 * math.pi * 3.0 * angle / angle[-1])
        time = (angle + angle[-1] * swing) / (rpm * 2.0 * math.pi / 60.0)
    return SimpleNamespace(theta_1=angle, theta_2=angle / 1.5, time=time)


@pytest.mark.parametrize(
    ("late", "wanders", "told"), [(0.0, 0.0, False), (0.02, 0.0, False), (0.3, 0.0, True), (0.0, 3.0, True)]
)
def test_uneven_samples_tell_lines_from_slower_orders(late: float, wanders: float, told: bool) -> None:
    """Uniform by 0.3 of a step, order 720 has a mean phasor of |sinc(1.5)| = 0.21, by 0.02 of one 0.98."""
    found = lines_told([samples(late, wanders=wanders)], 0, finest=PER_TURN / 2)
    assert (720 in found) is told
    assert not any(count < PER_TURN / 2 for count in found)
    # Of the other shaft half as many again fit into a sample.
    assert (1024 in lines_told([samples(late, wanders=wanders)], 1, finest=PER_TURN)) is told


def test_one_recording_of_uneven_samples_is_enough() -> None:
    assert 720 in lines_told([samples(0.0), samples(0.3)], 0, finest=PER_TURN / 2)


@pytest.mark.parametrize(("rpm", "unsteady", "told"), [(25.0, 0.0, False), (24.0, 0.0, True), (25.0, 0.02, True)])
def test_at_an_even_speed_hum_may_be_lines(rpm: float, unsteady: float, told: bool) -> None:
    """At 25 rpm 720 lines come 300 times per second, six times the mains; at 24 rpm 288 times, no multiple."""
    assert (720 in lines_told([samples(0.3, rpm=rpm, unsteady=unsteady)], 0, finest=PER_TURN / 2)) is told


@pytest.mark.slow
@pytest.mark.parametrize("gear", [0, 1])
def test_lines_above_half_the_samples_have_their_name(gear: int, tmp_path: Path) -> None:
    """12 teeth of 20 samples and 16 are 240 and 320 a turn, and the lines 720."""
    known = rough((12, 16))
    line = Claim(physics=catalogue()["encoder_interpolation"], place=Place(gear=gear, order=720), values=(30.0, -25.0))
    (one,) = recorded(line.written(known), (Condition(torque_nm=0.0),), np.random.default_rng(2), cycles=3.0)
    found = diagnose(known, [one], path=tmp_path / "pair.toml")
    (finding,) = found.findings
    assert (finding.claim.physics.name, finding.claim.place.gear) == ("encoder_interpolation", gear)
    assert finding.claim.place.order == 720
    # 0.3 um in 2880 samples leave 0.008 um of a wave, 0.6 urad at 13 mm.
    assert np.hypot(*finding.claim.values) == pytest.approx(math.hypot(30.0, 25.0), abs=3.0)
    assert not found.unexplained
