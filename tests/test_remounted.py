"""Recordings of one flank that differ once per turn were not made on one mounting."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from gearpoly.diagnose.remounted import remounted
from gearpoly.diagnose.system import System
from gearpoly.units import UM, FloatArray

N = 2000
NOISE = 0.3 * UM


def found(*waves: tuple[float, float], flanks: str = "dd", deflection: float = 0.0) -> Any:
    """What is made of recordings whose driving shaft makes waves of these amplitudes in um and phases in deg."""
    rng = np.random.default_rng(6)
    theta_1 = np.linspace(0.0, 40.0, N)
    names = {"d": "drive", "c": "coast"}
    samples = [SimpleNamespace(size=N, theta_1=theta_1, theta_2=0.72 * theta_1, flank=names[f]) for f in flanks]
    target: list[FloatArray] = [
        um * UM * np.cos(theta_1 - np.radians(deg)) + rng.normal(0.0, NOISE, N) for um, deg in waves
    ]
    columns = [np.ones((N, 1)) for _ in target]
    white = SimpleNamespace(whitened=lambda values: values / NOISE)
    system = System(
        white=[one / NOISE for one in columns],
        target=[one / NOISE for one in target],
        precision=np.zeros((1, 1)),
        prior=np.zeros(1),
    )
    left = [one - np.mean(one) for one in target]
    linear = SimpleNamespace(system=system, noises=[white] * len(target), left=lambda: left)
    model = SimpleNamespace(observed=[SimpleNamespace(samples=one) for one in samples])
    return remounted(cast(Any, model), cast(Any, linear), deflection=deflection * UM)


def test_waves_that_differ_are_two_mountings() -> None:
    """12 um and 15 um the other way: 27 um apart. What 0.3 um of noise in 2000 samples leaves of a wave is 0.01 um."""
    one = found((12.0, 0.0), (15.0, 180.0))
    assert (one.first, one.other, one.gear) == (0, 1, 0)
    assert one.wave / UM == pytest.approx(27.0, abs=0.05)
    assert "mounted anew" in one.says


@pytest.mark.parametrize(
    ("waves", "flanks", "deflection"),
    [
        (((60.0, 0.0), (60.6, 0.0)), "dd", 0.0),  # a hundredth by another torque
        (((12.0, 0.0), (12.0, 40.0)), "dc", 0.0),  # an eccentricity is turned by twice the pressure angle
        (((0.0, 0.0), (0.8, 0.0)), "dd", 8.0),  # a torque that pulses by a tenth
        (((0.0, 0.0), (0.02, 0.0)), "dd", 0.0),  # two standard deviations
    ],
)
def test_what_one_mounting_may_do_is_none(waves: Any, flanks: str, deflection: float) -> None:
    assert found(*waves, flanks=flanks, deflection=deflection) is None
