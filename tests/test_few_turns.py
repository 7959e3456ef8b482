"""A worm's error in a log of one turn and a half: told with its size, and no noise."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.entries import Entry
from gearpoly.compare.few_turns import first_order
from gearpoly.compare.lines import SLOWEST, LineSearch
from gearpoly.compare.locate import Located
from gearpoly.files.models import PairFile
from gearpoly.files.pairfile import read_pair
from gearpoly.recording.recording import Recording
from gearpoly.units import UM, FloatArray

TURN = 2.0 * math.pi
STEPS = 240
"""Samples per driven turn: one every two seconds of a worm's eight minutes."""
NOISE = 6.0
"""um rms, as 0.6 arcsec of seeing are of this pair."""
SIZES = (80.0, 20.0, 7.0)
"""um of orders 1 to 3 of the driven shaft: 8, 2 and 0.7 arcsec."""


@pytest.fixture(scope="module")
def mount(tmp_path_factory: pytest.TempPathFactory) -> tuple[PairFile, Path]:
    path = tmp_path_factory.mktemp("mount") / "pair.toml"
    path.write_text("[driving]\nteeth = 12\nmodule_mm = 0.5\n[driven]\nteeth = 47\nmodule_mm = 0.5\n", encoding="utf-8")
    return read_pair(path), path


def located(mount: tuple[PairFile, Path], turns: float, sizes: tuple[float, ...], seed: int) -> Located:
    """The comparison of a driven angle that is time, and waves of the driven shaft in noise with a ramp."""
    rng = np.random.default_rng([seed, round(100.0 * turns)])
    theta = np.arange(0.0, turns * TURN, TURN / STEPS)
    te: FloatArray = rng.normal(0.0, NOISE, theta.size) + 10.0 * theta
    for order, size in enumerate(sizes, start=1):
        te = te + size * np.cos(order * theta + rng.uniform(0.0, TURN))
    one = Recording(
        source=Path("log.csv"), time_s=80.0 * theta, driven_angle_rad=theta, te_mm=te * UM, from_time=("driven",)
    )
    return compare(mount[0], [one], path=mount[1]).located


def order_1(found: Located) -> Entry | None:
    return next((one for one in found.entries if one.gear == "driven" and one.order == 1.0), None)


@pytest.mark.parametrize(("turns", "within"), [(1.35, 0.2), (1.5, 0.1), (1.7, 0.05)])
def test_the_worm_s_error_is_told_and_is_no_noise(mount: tuple[PairFile, Path], turns: float, within: float) -> None:
    """Beside ramp, bow and S a wave of so few turns is known to a fifth, a tenth and a twentieth; two standard errors
    of three draws. Nothing of it is left for the noise."""
    for seed in range(3):
        found = located(mount, turns, SIZES, seed)
        one = order_1(found)
        assert one is not None and one.amplitude_um is not None
        assert one.amplitude_um == pytest.approx(SIZES[0], rel=within)
        assert "a slow drift" in one.rivals
        # Of 320 samples the rms is known to 4 %; what is fitted takes as much.
        assert found.noise_level / UM == pytest.approx(NOISE, rel=0.15)


@pytest.mark.parametrize("turns", [0.5, 0.8])
def test_of_less_than_a_turn_the_error_is_neither_noise_nor_another_pair_s(
    mount: tuple[PairFile, Path], turns: float
) -> None:
    """Order 1 is a drift then, and order 2 a wave that a drift may be. Fitted beside orders of which it holds too
    little, the slope of half a turn became another pair's ratio, 12 % off."""
    for seed in range(2):
        found = located(mount, turns, SIZES, seed)
        # 120 samples tell a level to 7 %, and ten terms are fitted.
        assert found.noise_level / UM == pytest.approx(NOISE, rel=0.25)
        assert any(one.kind == "time" and one.hz == 0.0 for one in found.entries)


def test_of_white_noise_nothing_is_told(mount: tuple[PairFile, Path]) -> None:
    assert all(order_1(located(mount, turns, (), seed)) is None for turns in (1.1, 1.4, 1.7) for seed in range(2))


@pytest.mark.parametrize(
    ("turns", "z", "place"),
    [
        (0.1, (12, 47), None),
        (0.7, (12, 47), (47, 2)),
        (1.5, (12, 47), (47, 1)),
        (1.1 * SLOWEST, (12, 47), None),
        (1.1, (24, 36), (24, 1)),  # of the driving shaft there are 1.65 turns, which tell more
    ],
)
def test_it_is_asked_of_the_fastest(turns: float, z: tuple[int, int], place: tuple[int, int] | None) -> None:
    u = np.linspace(0.0, turns * z[1], 600)
    one = first_order(LineSearch(u=u, time=None, z_1=z[0], z_2=z[1]))
    if place is None:
        assert one is None
    else:
        assert one is not None and one.frequency == pytest.approx(place[1] / place[0])
