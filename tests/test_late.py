"""What a clock that is off does to a curve is what a step of its rate does, and the fit goes back to the true angle."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.clock import RATE_STD
from gearpoly.compare.compare import compare
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.late import by_clock
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.sparse import full
from gearpoly.units import UM
from tests.made_recordings import RIG, inspected, record


def test_a_rate_that_is_off_shows_as_the_slope_times_the_way_from_the_middle() -> None:
    """Of a cos(n theta), late by r (theta - middle), the change has rms a n r T / sqrt(24) over a span T, for many
    waves; half of it is built into the teeth. A level curve tells nothing of a clock."""
    theta = np.linspace(0.0, 30.0, 20_000)
    size, order = 3.0 * UM, 40
    wave = size * np.cos(order * theta)
    samples = SimpleNamespace(theta_2=theta, middle=15.0)
    scenes: Any = [SimpleNamespace(samples=samples, mesh_te=0.5 * wave)]
    noise = SimpleNamespace(whitened=lambda values: values / 0.2, innovation=0.2)

    def linear(built: float) -> Any:
        system = SimpleNamespace(solution=np.array([built, 9.0]))
        columns = np.column_stack((wave, theta))  # the second is no tooth
        return SimpleNamespace(
            layout=SimpleNamespace(built=slice(0, 1)), system=system, columns=[full(columns)], noises=[noise]
        )

    whole = size * order * RATE_STD * 30.0 / np.sqrt(24.0)
    assert by_clock(scenes, linear(0.5), [1.0]) == pytest.approx(whole, rel=0.01)
    assert by_clock(scenes, linear(0.5), [0.2]) == pytest.approx(0.2 * whole, rel=0.01)
    assert by_clock(scenes, linear(-0.5), [1.0]) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.long
def test_a_fit_moves_the_angles_to_the_rate_at_which_inspected_teeth_mesh(tmp_path: Path) -> None:
    """A clock 2 in 1000 fast over half a hunting cycle puts either end off by 0.22 of a pitch, farther than one
    straight line about the stated angle holds. 0.3 um of noise on pitch steps of 6 um tell the rate to a hundredth of
    that."""
    rng = np.random.default_rng(11)
    file, path, made = inspected(tmp_path, rng, scatter=6.0)
    fast = 2e-3
    true = record(made, RIG, rng, cycles=0.5, per_mesh=8, only="driven", stated=(None, RIG.zero_2))
    assert true.driven_angle_rad is not None
    middle = float(np.mean(true.driven_angle_rad))
    stated = middle + (1.0 + fast) * (true.driven_angle_rad - middle)
    recording = replace(true, driven_angle_rad=stated, from_time=("driven",))
    comparison = compare(file, [recording], path=path)
    model = prepare(file, comparison, path=path)
    fit = Fit.begun(model, [np.zeros((one.samples.size, 0)) for one in model.observed], lambda _: None)
    assert fit.model.rates == pytest.approx([-fast / (1.0 + fast)], abs=2e-5)
    turned = fit.scenes[0].samples
    assert np.ptp(turned.theta_2) == pytest.approx(np.ptp(true.driven_angle_rad), rel=2e-5)
    assert np.ptp(turned.theta_1) == pytest.approx(np.ptp(true.driven_angle_rad) / made.pair.ratio, rel=1e-4)
    assert fit.linear.system.whiteness == pytest.approx(1.0, abs=0.2)
