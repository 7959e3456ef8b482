"""What a clock that is off does to a curve is what a step of its rate does."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.clock import RATE_STD
from gearpoly.diagnose.late import by_clock
from gearpoly.diagnose.sparse import full
from gearpoly.units import UM


def test_a_rate_that_is_off_shows_as_the_slope_times_the_way_from_the_middle() -> None:
    """Of a cos(n theta), late by r (theta - middle), the change has rms a n r T / sqrt(24) over a span T, for many
    waves; half of it is built into the teeth. A level curve tells nothing of a clock."""
    theta = np.linspace(0.0, 30.0, 20_000)
    size, order = 3.0 * UM, 40
    wave = size * np.cos(order * theta)
    samples = SimpleNamespace(theta_2=theta)
    scenes: Any = [SimpleNamespace(samples=samples, mesh_te=0.5 * wave)]
    noise = SimpleNamespace(whitened=lambda values: values / 0.2, innovation=0.2)

    def linear(built: float) -> Any:
        system = SimpleNamespace(solution=np.array([built, 9.0]))
        columns = np.column_stack((wave, theta))  # the second is no tooth
        return SimpleNamespace(
            layout=SimpleNamespace(built=slice(0, 1)), system=system, columns=[full(columns)], noises=[noise]
        )

    assert by_clock(scenes, linear(0.5)) == pytest.approx(size * order * RATE_STD * 30.0 / np.sqrt(24.0), rel=0.01)
    assert by_clock(scenes, linear(-0.5)) == pytest.approx(0.0, abs=1e-12)
