"""Waves that no gear pair makes, fitted beside teeth that hide them or might make them up."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.beside import Comparison
from gearpoly.compare.compare import compare
from gearpoly.compare.entries import Entry
from gearpoly.diagnose.beneath import _of_once_per_turn, smooth_waves, waves_beneath
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.diagnose.system import System
from gearpoly.files.models import PairFile
from gearpoly.recording.recording import Recording
from gearpoly.units import UM
from tests.pair_files import pair_file
from tests.physics_cases import Condition, recorded

Z = 17, 23
R_B2 = 23.0 * math.cos(math.radians(20.0))


def graded(pitch_um: list[float] | None = None) -> PairFile:
    """Gears of grade 6, of which nobody else knows the driving one's pitches."""
    no_load = {"tooth_deflection": False}
    if pitch_um is None:
        return pair_file(Z, driving={"grade": 6}, driven={"grade": 6}, model=no_load, points=800, inspected=False)
    return pair_file(Z, driving={"inspection": {"pitch_um": pitch_um}}, model=no_load, points=800)


def with_wave(one: Recording, *, order: float, amplitude_um: float) -> Recording:
    """The recording with a wave of the driving shaft on the driven angle."""
    turn = one.driving_angle_rad
    more = amplitude_um * UM / R_B2 * np.cos(order * turn + 0.7)
    return replace(one, driven_angle_rad=one.driven_angle_rad + more)


def searched(file: PairFile, one: Recording, path: Path) -> tuple[Fit, Comparison]:
    """A search before any claim, without the waves that ``compare`` located."""
    comparison = compare(file, [one], path=path)
    model = prepare(file, comparison, path=path)
    free = [np.zeros((one.samples.size, 0)) for one in model.observed]
    return from_declared(model, free, lambda _: None), comparison


def amplitude(search: Fit) -> float:
    """Of the first wave of no cause, in um."""
    start = search.linear.layout.foreign.start
    return float(np.hypot(*search.linear.system.solution[start : start + 2])) / UM


PITCH = np.random.default_rng(3).uniform(-4.0, 4.0, Z[0]).round(2)


@pytest.fixture(scope="module")
def plain() -> Recording:
    """Three hunting cycles of gears whose pitches are those of grade 6, unloaded, beneath 0.3 um of noise."""
    made = graded(PITCH.tolist())
    (one,) = recorded(made, (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=2.0, per_mesh=12)
    return one


@pytest.mark.slow
@pytest.mark.parametrize(("order", "fitted"), [(1.83, True), (0.03, False)])
def test_a_wave_beneath_the_teeth_is_fitted(order: float, fitted: bool, plain: Recording, tmp_path: Path) -> None:
    """Of 0.4 um, to three standard errors of a wave beneath white noise, 0.3 um sqrt(2 / n). What turns 1.4 times in 46
    turns is a drift, as a warming rig makes it."""
    one = with_wave(plain, order=order, amplitude_um=0.4)
    search, comparison = searched(graded(), one, tmp_path / "pair.toml")
    beneath = waves_beneath(search, comparison)
    assert (beneath is not search) == fitted
    search = beneath
    assert len(search.model.strangers) == fitted
    if fitted:
        std = 0.3 * math.sqrt(2.0 / one.driven_angle_rad.size)
        assert amplitude(search) == pytest.approx(0.4, abs=3.0 * std)
        # It is fitted, so nothing of it is left to be found.
        assert waves_beneath(search, comparison) is search


@pytest.mark.slow
def test_a_smooth_wave_is_none_of_the_teeth(plain: Recording, tmp_path: Path) -> None:
    """14 um twice per turn of a smooth wave are fitted as one, to what drawn pitches have so often themselves; as much
    of the pitches stays with the teeth."""
    smooth = with_wave(plain, order=2.0, amplitude_um=14.0)
    search, comparison = searched(graded(), smooth, tmp_path / "pair.toml")
    search = smooth_waves(search, comparison)
    own = 2.0 / Z[0] * abs(np.fft.fft(PITCH)[2])
    assert amplitude(search) == pytest.approx(14.0, abs=own)
    assert search.model.scope.smooth == {(0, 2)}

    pitch = 14.0 * np.cos(2.0 * 2.0 * np.pi / Z[0] * np.arange(Z[0]))
    made = graded(pitch.round(3).tolist())
    (teeth,) = recorded(made, (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=2.0, per_mesh=12)
    search, comparison = searched(graded(), teeth, tmp_path / "pair.toml")
    assert any(one.order == 2.0 and one.gear == "driving" for one in comparison.located.entries)
    assert smooth_waves(search, comparison) is search
    assert search.model.strangers == ()
    assert search.model.scope.smooth == frozenset()


@pytest.mark.slow
def test_where_a_tooth_is_claimed_a_smooth_wave_is_asked_with_nothing_left_beyond_noise(
    plain: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Noise that was estimated along may hold what teeth cannot do of a smooth wave."""
    monkeypatch.setattr(System, "beyond", 0.0)
    search, comparison = searched(graded(), with_wave(plain, order=2.0, amplitude_um=14.0), tmp_path / "pair.toml")
    assert smooth_waves(search, comparison) is search
    search = smooth_waves(search, comparison, least=0.0)
    assert search.model.scope.smooth == {(0, 2)}


@pytest.mark.slow
def test_an_image_of_what_comes_once_per_turn_is_no_smooth_wave(plain: Recording, tmp_path: Path) -> None:
    """Teeth show order 1 beside the mesh too, at z - 1 and z + 1: a gear or an encoder off its axis tells it, and as a
    wave of no cause it would take their name."""
    once = with_wave(plain, order=1.0, amplitude_um=14.0)
    search, comparison = searched(graded(), once, tmp_path / "pair.toml")
    known = comparison.located.entries[0]
    image = replace(known, kind="shaft_order", gear="driving", order=Z[0] - 1.0, amplitude_um=0.4, companion_of=None)
    first = replace(image, order=1.0, amplitude_um=14.0)
    both = replace(comparison, located=replace(comparison.located, entries=(image, first), where=()))
    assert smooth_waves(search, both) is search
    assert search.model.scope.smooth == frozenset()
    assert search.model.strangers == ()


@pytest.mark.parametrize(
    ("order", "once_um", "image"), [(22.0, 9.0, True), (24.0, 9.0, True), (22.0, 0.3, False), (21.0, 9.0, False)]
)
def test_what_lies_one_order_beside_the_mesh_is_an_image_of_what_comes_once_per_turn(
    order: float, once_um: float, image: bool
) -> None:
    """Of 23 teeth orders 22 and 24, where order 1 is larger; of the other gear's order 1 it is none."""

    def wave(gear: Any, order: float, size: float) -> Entry:
        return Entry(kind="shaft_order", p_value=0.0, recordings=(0,), gear=gear, order=order, amplitude_um=size)

    fit: Any = SimpleNamespace(model=SimpleNamespace(scope=SimpleNamespace(gears=[SimpleNamespace(z=z) for z in Z])))
    one, mate = wave("driven", order, 0.5), wave("driving", 1.0, 30.0)
    located = SimpleNamespace(entries=(one, mate), where=(wave("driven", 1.0, once_um),))
    comparison: Any = SimpleNamespace(located=located)
    assert _of_once_per_turn(one, fit, comparison) == image
