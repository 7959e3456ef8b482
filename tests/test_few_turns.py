"""A worm's error in a log of one turn and a half: told with its size, and no noise."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.entries import Entry
from gearpoly.compare.few_turns import beside_order, first_order
from gearpoly.compare.locate import Located
from gearpoly.compare.sampling import SLOWEST, sampling_of
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


def log(
    turns: float,
    sizes: tuple[float, ...],
    seed: int,
    *,
    ramp: float = 10.0,
    gap: tuple[float, float] = (0.0, 0.0),
    steps: int = STEPS,
) -> Recording:
    """A driven angle that is time, and waves of the driven shaft in noise with a ramp in um per rad; nothing between
    the turns of a ``gap``."""
    rng = np.random.default_rng([seed, round(100.0 * turns)])
    theta = np.arange(0.0, turns * TURN, TURN / steps)
    theta = theta[(theta <= gap[0] * TURN) | (theta >= gap[1] * TURN)]
    te: FloatArray = rng.normal(0.0, NOISE, theta.size) + ramp * theta
    for order, size in enumerate(sizes, start=1):
        te = te + size * np.cos(order * theta + rng.uniform(0.0, TURN))
    return Recording(
        source=Path("log.csv"), time_s=80.0 * theta, driven_angle_rad=theta, te_mm=te * UM, from_time=("driven",)
    )


def located(mount: tuple[PairFile, Path], turns: float, sizes: tuple[float, ...], seed: int) -> Located:
    return compare(mount[0], [log(turns, sizes, seed)], path=mount[1]).located


def order_1(found: Located) -> Entry | None:
    return next((one for one in found.entries if one.gear == "driven" and one.order == 1.0), None)


@pytest.mark.long
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


@pytest.mark.long
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
        assert any(one.drift or "a slow drift" in one.rivals for one in found.entries)


@pytest.mark.long
def test_beside_a_recording_that_tells_it_from_a_drift_it_is_one_order(mount: tuple[PairFile, Path]) -> None:
    """A log of more than three turns tells the worm's error to a hundredth; it is one and the same in a shorter one."""
    both = [log(turns, SIZES, 1, ramp=0.0) for turns in (1.3, 3.2)]
    found = compare(mount[0], both, path=mount[1]).located
    (one,) = [each for each in found.entries if each.gear == "driven" and each.order == 1.0]
    assert one.amplitude_um == pytest.approx(SIZES[0], rel=0.03)
    assert one.rivals == ()


@pytest.mark.long
@pytest.mark.parametrize(("turns", "gap"), [(1.1, (0.0, 0.0)), (1.5, (0.42, 0.69)), (1.5, (0.0, 0.0))])
def test_its_order_2_is_no_difference_of_both_shafts_beside_it(
    mount: tuple[PairFile, Path], turns: float, gap: tuple[float, float]
) -> None:
    """Order 1 of the driving shaft less order 2 of the driven lies 0.083 orders from order 2, which is an eighth of a
    line: told as that, order 1 has 47 um beside a gap, of 80."""
    where = compare(mount[0], [log(turns, SIZES, 1, ramp=0.0, gap=gap)], path=mount[1]).located.where
    sizes = {one.order: one for one in where if one.gear == "driven" and one.order_std is None}
    assert not [one.label for one in where if "of driving order" in one.label]
    for order, size in enumerate(SIZES[:2], start=1):
        one = sizes[order]
        assert one.amplitude_um is not None and one.std_um is not None
        assert abs(one.amplitude_um - size) < 4.0 * one.std_um + 0.05 * size


@pytest.mark.long
def test_without_a_drift_none_is_told(mount: tuple[PairFile, Path]) -> None:
    """Beside a wave of so few turns ramp, bow and S are known several times less well than alone."""
    for seed in range(2):
        for sizes in ((0.0, 80.0), SIZES):
            found = compare(mount[0], [log(1.5, sizes, seed, ramp=0.0)], path=mount[1]).located
            assert all(one.hz != 0.0 for one in found.entries)


@pytest.mark.long
def test_a_wave_that_does_not_stand_out_is_not_listed_for_teeth_either(mount: tuple[PairFile, Path]) -> None:
    """The whole mismatch knows no drift, and would give the wave what is one."""
    still = Recording(
        source=Path("log.csv"), time_s=(t := np.arange(0.0, 720.0, 2.0)), driven_angle_rad=t / 478.69 * TURN,
        te_mm=np.full(t.size, 70.0 * UM), from_time=("driven",),
    )  # fmt: skip
    assert compare(mount[0], [still], path=mount[1]).located.where == ()


def test_the_other_shaft_is_a_rival_where_both_turned_nearly_as_often() -> None:
    for z, turns, rivals in (
        ((12, 16), 1.2, ("order 1 of the driven shaft", "a slow drift")),
        ((12, 47), 1.5, ("a slow drift",)),
    ):
        search = sampling_of(u=np.linspace(0.0, turns * z[1], 600), time=None, z_1=z[0], z_2=z[1])
        assert beside_order(search, "driving" if z[1] == 16 else "driven", 1) == rivals


@pytest.mark.long
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
    one = first_order(sampling_of(u=u, time=None, z_1=z[0], z_2=z[1]))
    if place is None:
        assert one is None
    else:
        assert one is not None and one.frequency == pytest.approx(place[1] / place[0])


@pytest.mark.long
def test_a_fine_log_of_few_turns_is_searched_for_no_jump(mount: tuple[PairFile, Path]) -> None:
    """More samples than are searched whole: a jump would have to stay for a turn of the larger gear on either side."""
    found = compare(mount[0], [log(1.5, SIZES, 1, ramp=0.0, steps=30_000)], path=mount[1]).located
    one = order_1(found)
    assert one is not None
    assert one.amplitude_um == pytest.approx(SIZES[0], rel=0.02)
    assert found.noise_level / UM == pytest.approx(NOISE, rel=0.15)
