"""The scales on which candidates are weighed: steps beside slow changes, and what teeth as built cannot be."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.diagnose.scan import Looked
from gearpoly.diagnose.system import Sums, System
from gearpoly.diagnose.weigh import Weigh
from gearpoly.physics import catalogue
from gearpoly.physics.base import Place
from gearpoly.units import FloatArray

N = 4000


@dataclass
class White:
    """A recording in white noise of unit level, all known but its mean."""

    system: System

    def sums(self, k: int, columns: FloatArray) -> Sums:
        left, white = self.system.left[k], self.system.white[k]
        return Sums(score=columns.T @ left, own=columns.T @ columns, cross=white.T @ columns)


def scales(recorded: FloatArray) -> Any:
    system = System(white=[np.ones((N, 1))], target=[recorded], precision=np.zeros((1, 1)), prior=np.zeros(1))
    weigh = Weigh.__new__(Weigh)
    weigh.linear = White(system)  # type: ignore[assignment]
    weigh.model = SimpleNamespace(observed=[SimpleNamespace(samples=SimpleNamespace(size=N))])  # type: ignore[assignment]
    return weigh


def gain_of_slope(recorded: FloatArray) -> float:
    """What a straight line explains beside the mean."""
    along = np.linspace(-1.0, 1.0, N)
    return float((along @ (recorded - recorded.mean())) ** 2 / (along @ along))


@pytest.mark.parametrize("at", [0.2, 0.36, 0.5])
def test_a_step_explains_more_than_a_line_where_there_is_one(at: float) -> None:
    """A line takes 3 p (1 - p) of a step at part p, at most three quarters; 48 moments miss its place by a hundredth of
    the recording at most, which costs 1 % / (p (1 - p)) of its gain."""
    rng = np.random.default_rng(1)
    recorded = 0.5 * (np.arange(N) > at * N) + rng.normal(0.0, 1.0, N)
    assert scales(recorded).stepped() > gain_of_slope(recorded)
    clean = 0.5 * (np.arange(N) > at * N)
    whole = float(np.sum((clean - clean.mean()) ** 2))
    assert (1.0 - 0.011 / (at * (1.0 - at))) * whole < scales(clean).stepped() <= whole * (1.0 + 1e-9)


def test_a_line_explains_more_than_any_step_where_there_is_one() -> None:
    rng = np.random.default_rng(2)
    recorded = np.linspace(-0.5, 0.5, N) + rng.normal(0.0, 1.0, N)
    assert scales(recorded).stepped() < gain_of_slope(recorded)


def test_waves_teeth_and_whole_gears_share_the_family() -> None:
    """Thousands of orders do not outvote the teeth, nor these a few gears: each has a third."""
    looked = Looked(waves=16000, teeth=1000, whole=60)
    known = catalogue()
    assert looked.tests(known["undulation"], Place(gear=0, order=61)) == 48000
    assert looked.tests(known["tooth_pitch"], Place(gear=0, tooth=3)) == 3000
    assert looked.tests(known["cumulative_pitch"], Place(gear=0, order=2)) == 180
    shares = sum(count / looked.tests(physics, place) for count, physics, place in (
        (16000, known["undulation"], Place(order=1)), (1000, known["tooth_pitch"], Place(tooth=1)),
        (60, known["eccentricity"], Place(gear=1)),
    ))  # fmt: skip
    assert shares == pytest.approx(1.0)


@pytest.mark.parametrize(("size", "pays"), [(0.3, True), (0.0, False)])
def test_a_slow_change_pays_between_the_blocks_that_were_seen(
    size: float, pays: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A bow of eight standard errors whose first half says nothing of the second: from it a line and a bow would be
    drawn on to anywhere. Without any the columns fit noise, and the unseen blocks show it."""
    along = np.linspace(-1.0, 1.0, N)
    columns = np.stack([along, 1.5 * along**2 - 0.5, 2.5 * along**3 - 1.5 * along], axis=1)
    weigh = scales(size * columns[:, 1] + np.random.default_rng(4).normal(0.0, 1.0, N))
    monkeypatch.setattr("gearpoly.diagnose.weigh.columns_of", lambda *given: [columns])
    weigh.scenes = []
    weigh.model.observed[0].fit, weigh.model.observed[0].jumps = np.arange(N) < N // 2, ()
    candidate = SimpleNamespace(claim=SimpleNamespace(physics=catalogue()["thermal_drift"]))
    assert weigh.pays(candidate) is pays
