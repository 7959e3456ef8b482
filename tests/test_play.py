"""Lost motion that nothing explains, entries told once, and the probability of those that were not weighed."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from gearpoly.compare.entries import Entry
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.leftovers import each_once, each_with_probability
from gearpoly.diagnose.play import play, with_play
from gearpoly.files.models import PairFile
from gearpoly.infer.chance import probability_by_chance
from gearpoly.units import UM, FloatArray
from tests.physics_cases import Condition, recorded

Z, MODULE = (18, 25), 2.0
PLAY_UM = 55.0


def inspected() -> PairFile:
    rng = np.random.default_rng(9)
    gears: dict[str, object] = {"pair": {"torque_nm": 1.0}, "model": {"tooth_deflection": True}}
    for name, z in zip(("driving", "driven"), Z, strict=True):
        sheet = {"pitch_um": rng.normal(0.0, 1.0, z).round(2).tolist(), "profile_slope_um": [0.0] * z}
        sheet |= {"tooth_thickness_um": -50.0, "uncertainty_um": 0.3}
        gears[name] = {"teeth": z, "module_mm": MODULE, "face_width_mm": 20.0, "inspection": sheet}
    return PairFile.model_validate(gears)


@pytest.mark.slow
@pytest.mark.parametrize("play_um", [PLAY_UM, 0.0])
def test_play_in_a_coupling_is_told_and_is_no_thickness(tmp_path: Path, play_um: float) -> None:
    """The driving shaft has to turn back by so much more before the coast flanks touch."""
    loads = (Condition(torque_nm=1.0), Condition(torque_nm=1.0, flank="coast"))
    drive, coast = recorded(inspected(), loads, np.random.default_rng(4), cycles=1.2)
    assert coast.driving_angle_rad is not None
    r_b1 = 0.5 * MODULE * Z[0] * math.cos(math.radians(20.0))
    coast = replace(coast, driving_angle_rad=coast.driving_angle_rad + play_um * UM / r_b1)
    found = diagnose(inspected(), [drive, coast], path=tmp_path / "pair.toml")
    assert not found.findings
    if play_um == 0.0:
        assert not found.unexplained
        return
    (one,) = (entry for entry in found.unexplained if entry.kind == "condition")
    # The mean of two means of 3000 samples of 0.3 um, and both gears' inspections.
    assert one.rms_um == pytest.approx(play_um, abs=0.5)
    assert "lost motion +55" in one.label
    assert one.recordings == (1,)
    assert any("play in a coupling" in remark for remark in found.remarks)


@pytest.mark.parametrize(("says", "left_um", "told"), [
    ({"limits": {"E_sns_um": -50.0, "E_sni_um": -70.0}, "grade": 5}, 11.3, False),  # two gears within +-10 um each
    ({"limits": {"E_sns_um": -50.0, "E_sni_um": -70.0}, "grade": 5}, 40.0, True),
    ({"inspection": {"tooth_thickness_um": -60.0, "uncertainty_um": 0.5}}, 11.3, True),
    ({"grade": 5}, 40.0, False),
    ({}, 40.0, False),
])  # fmt: skip
def test_lost_motion_within_what_is_stated_of_the_thickness_is_none(
    says: dict[str, Any], left_um: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever the declared gears were taken to be: these have a thickness always."""
    gear = {"module_mm": 4.0, "face_width_mm": 20.0, **says}
    stated = PairFile.model_validate({"driving": {"teeth": 17, **gear}, "driven": {"teeth": 22, **gear}})
    flat = np.zeros(4)
    lost = SimpleNamespace(
        std=0.05 * UM, beyond=-left_um * UM, simulated=flat, backlash=flat, recordings=((0,), (1,)), arcmin=lambda x: x
    )
    monkeypatch.setattr("gearpoly.diagnose.play.lost_motions", lambda comparison: [lost])
    gears = [SimpleNamespace(alpha=math.radians(20.0))] * 2
    search: Any = SimpleNamespace(scenes=[], model=SimpleNamespace(scope=SimpleNamespace(gears=gears)))
    entries, words = play(search, cast(Any, None), [], file=stated)
    assert len(entries) == len(words) == int(told)


def wave(order: float, size: float, **more: Any) -> Entry:
    plain = Entry(kind="shaft_order", gear="driving", order=order, amplitude_um=size, recordings=(0,), p_value=1e-6)
    return replace(plain, **more)


def compared(angle: FloatArray) -> Any:
    """Two recordings of gears of 10 and 20 teeth, as far as entries are told once."""
    aligned = [SimpleNamespace(theta_1=angle, theta_2=angle, time_s=None)] * 2
    return SimpleNamespace(aligned=aligned, gears=(SimpleNamespace(z=10), SimpleNamespace(z=20)))


@pytest.mark.parametrize(("size", "mean", "tooth", "told"), [
    (2.0, 0.0, 0.0, False), (1.3, 0.0, 0.0, True), (2.0, 1.0, 0.0, True), (1.3, 0.0, 4.0, False),
])  # fmt: skip
def test_a_condition_is_told_once(size: float, mean: float, tooth: float, told: bool) -> None:
    """A wave of 2 um is 1.41 um rms; of 1.3 um it is 0.92, and a tooth of 4 um on one of 10 is 1.26 beside it. What
    differs in its mean by 1 um as well is no wave."""
    turning = 2.0 / math.sqrt(2.0)
    condition = Entry(
        kind="condition", rms_um=math.hypot(turning, mean), turning_um=turning, recordings=(1,), p_value=0.0
    )
    pulse = wave(1.0, 0.5, recordings=(0, 1), amplitude_um_by_recording=(0.5, size))
    pit = Entry(kind="tooth", gear="driving", tooth=3, rms_um=tooth, recordings=(0, 1), p_value=0.0)
    entries = [condition, pulse, pit]
    found = each_once(entries, compared(np.linspace(0.0, 80.0 * math.pi, 100)))
    assert found == tuple(entries if told else entries[1:])


def test_a_wave_is_told_once_and_two_waves_twice() -> None:
    """Over 40 turns of either shaft, in which 0.3 independent lines are 0.0075 of an order."""
    angle = np.linspace(0.0, 80.0 * math.pi, 100)
    beside = compared(angle)
    belt = wave(0.41667, 4.0, probability=1.0)
    again = wave(0.41671, 4.008)
    ones = (belt, wave(0.43, 1.0), wave(1.0, 2.0), wave(120.0, 1.0), wave(120.05, 1.0))
    assert each_once([belt, again, *ones[1:]], beside) == ones
    # Of another recording, another shaft, or with a moment it is another one.
    others = [wave(0.41667, 1.0, recordings=(1,)), wave(0.41667, 1.0, gear="driven"), wave(0.41667, 1.0, time_s=3.0)]
    assert each_once([belt, *others], beside) == (belt, *others)
    whole = wave(0.41667, 4.0, recordings=(0, 1))
    assert each_once([whole, belt], beside) == (whole,)


def test_every_entry_has_a_probability() -> None:
    weighed, sure, doubtful = wave(1.0, 2.0, probability=0.7), wave(2.0, 2.0, p_value=0.0), wave(3.0, 2.0, p_value=0.01)
    told = each_with_probability([weighed, sure, doubtful])
    # Sellke, Bayarri and Berger (2001), table 1: a p value of 0.01 leaves the null hypothesis at least 0.111.
    assert [one.probability for one in told] == [0.7, 1.0, pytest.approx(1.0 - 0.111, abs=5e-4)]


@pytest.mark.parametrize(
    ("p", "least"), [(0.2, 0.465), (0.1, 0.385), (0.05, 0.289), (0.01, 0.111), (0.005, 0.067), (0.001, 0.0184)]
)
def test_a_p_value_is_calibrated_as_published(p: float, least: float) -> None:
    assert 1.0 - probability_by_chance(p) == pytest.approx(least, abs=2e-3)  # printed to three figures


def test_a_chance_of_one_half_tells_nothing() -> None:
    assert probability_by_chance(0.5) == 0.5
    assert probability_by_chance(math.exp(-1.0)) == 0.5


def test_play_takes_the_place_of_what_stands_for_the_same_means() -> None:
    play = Entry(kind="condition", rms_um=55.0, recordings=(1,), p_value=0.0, label="lost motion")
    bare = Entry(kind="condition", rms_um=38.9, recordings=(1,), p_value=1.0, probability=0.9)
    told = Entry(kind="condition", rms_um=3.0, recordings=(1,), p_value=0.0, label="mean -3 um")
    assert with_play([bare], [play]) == (replace(bare, rms_um=55.0, label="lost motion"),)
    assert with_play([told], [play]) == (play, told)
    assert with_play([told], []) == (told,)
