"""Recordings of other teeth, told by the orders of the shaft that was not read."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.other_pair import OtherPair, other_pair
from gearpoly.compare.ratio import OrderPower
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.keys.also_turns import Part
from gearpoly.recording.recording import Recording
from gearpoly.report.diagnosis_report import json_text
from gearpoly.units import FloatArray
from tests.made_recordings import RIG, inspected, record

TURN = 2.0 * math.pi
TURNS, SAMPLES = 40.0, 12_000


def lines(turns_of: dict[float, int], *, seed: int = 2, noise: float = 1.0) -> OrderPower:
    """Waves of half the noise at the first so many multiples of each order of the shaft that was read."""
    rng = np.random.default_rng(seed)
    turns = np.cumsum(rng.uniform(0.5, 1.5, SAMPLES)) * (TURNS / SAMPLES)
    te = rng.normal(0.0, noise, SAMPLES)
    for first, many in turns_of.items():
        for k in range(1, many + 1):
            te += 0.5 * np.cos(TURN * (k * first * turns + rng.uniform()))
    return OrderPower(turns, te)


def found(turns_of: dict[float, int], *, read: int = 1, parts: tuple[Part, ...] = ()) -> OtherPair | None:
    return other_pair([lines(turns_of)], read=read, z=(18, 25), parts=parts)


@pytest.mark.long
@pytest.mark.parametrize(
    ("read", "teeth"),
    [(1, (23, 32)), (1, (13, 18)), (1, (21, 29)), (1, (17, 22)), (0, (13, 18)), (0, (21, 29)), (0, (17, 22))],
)
def test_the_other_shafts_orders_tell_the_teeth(read: int, teeth: tuple[int, int]) -> None:
    """Ratios 0.2 to 7 % off that of 18 on 25 teeth, the driven shaft read, and the driving one."""
    turns = teeth[1] / teeth[0] if read else teeth[0] / teeth[1]
    one = found({1.0: 6, turns: 14 if read else 30}, read=read)
    assert one is not None and one.teeth == teeth
    assert one.turns == pytest.approx(turns, rel=1e-12)
    assert f"as of {teeth[0]} on {teeth[1]} teeth" in one.says
    assert f"of the {('driven', 'driving')[read]} shaft" in one.says


@pytest.mark.long
def test_the_declared_pair_is_no_other_one() -> None:
    assert found({1.0: 6, 25.0 / 18.0: 14}) is None
    assert found({1.0: 20}) is None
    assert found({}) is None


@pytest.mark.long
def test_what_turns_beside_the_pair_is_no_other_pair() -> None:
    """A wheel of the next stage with more lines than the pair, one that is stated, and a belt that turns half as often
    as the driving shaft, which has all lines of that."""
    own = 25.0 / 18.0
    assert found({1.0: 4, own: 3, 37.0 / 22.0: 14}) is None
    assert found({1.0: 4, 0.675676: 14}, parts=(Part(name="next wheel", turns=0.675676),)) is None
    assert found({1.0: 4, 0.5 * own: 14}) is None


def test_a_shaft_that_turns_a_whole_number_of_times_has_no_orders_of_its_own() -> None:
    """20 on 40 teeth: what the driving shaft has comes at whole orders of the driven one, so nothing says that it is
    not there, however much a wheel of another stage shows."""
    busy = [lines({1.0: 6, 2.0: 14, 37.0 / 22.0: 14})]
    assert other_pair(busy, read=1, z=(20, 40)) is None
    assert other_pair(busy, read=1, z=(30, 30)) is None


@pytest.mark.long
@pytest.mark.parametrize("seeds", [range(1), pytest.param(range(1, 10), marks=pytest.mark.slow)])
def test_noise_is_no_other_pair(seeds: range) -> None:
    """Of 10 recordings none: a thousand to one against each of 24 000 ratios. Of 100 there was none either."""
    for seed in seeds:
        assert other_pair([lines({1.0: 5}, seed=seed)], read=1, z=(18, 25)) is None


def as_computed(recording: Recording, ratio: float, shaft: str) -> Recording:
    """The same as a rig writes it that reads one shaft and computes the transmission error itself."""
    driving, driven = recording.driving_angle_rad, recording.driven_angle_rad
    assert driving is not None and driven is not None
    te = np.unwrap(driven) - ratio * np.unwrap(driving)
    gone: dict[str, FloatArray | None] = {f"{'driving' if shaft == 'driven' else 'driven'}_angle_rad": None}
    return replace(recording, te_rad=te - np.mean(te), driving_zero_rad=None, driven_zero_rad=None, **gone)  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.parametrize("shaft", ["driving", "driven"])
def test_nothing_is_named_of_another_pairs_recording(shaft: str, tmp_path: Path) -> None:
    """Simulated gears of 17 on 23 teeth beside a file of 12 on 16: no physics, no grade, and one remark that says what
    shows; their own file has no such remark."""
    rng = np.random.default_rng(3)
    (tmp_path / "own").mkdir(), (tmp_path / "other").mkdir()
    file, path, _ = inspected(tmp_path / "own", rng, z_1=12, z_2=16)
    theirs, there, other = inspected(tmp_path / "other", rng, z_1=17, z_2=23)
    given = as_computed(record(other, RIG, rng, cycles=1.0), 17.0 / 23.0, shaft)
    verdict = json.loads(json_text(diagnose(file, [given], path=path)))
    assert verdict["missing"] == []
    assert verdict["status"] == "unexplained"
    (said,) = [one for one in verdict["remarks"] if "correct teeth in the pair file" in one]
    assert "as of 17 on 23 teeth or a multiple" in said
    assert all("another pair" in verdict["as_built"][gear]["ungraded"] for gear in ("driving", "driven"))
    assert compare(theirs, [given], path=there).another is None
