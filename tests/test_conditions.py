"""What a claim is worth on a torque or a flank that its fit never saw."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose import nuisance
from gearpoly.diagnose.conditions import conditions, elsewhere, foretold, swells, with_and_without, without_dear
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.exchange import without_idle
from gearpoly.diagnose.fit import Fit, joined, settled
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.diagnose.residuals import DISCREPANCY_SIGMAS_TOLD, discrepancy_part
from gearpoly.diagnose.sparse import full
from gearpoly.diagnose.system import System
from gearpoly.diagnose.weigh import paid_by
from gearpoly.keys.edit import on_gear
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.recording.recording import Recording
from gearpoly.units import NM, UM, FloatArray
from tests.physics_cases import CONDITIONS, Condition, recorded, rough, scope_of


def systems(sizes: list[float], known: list[float]) -> tuple[System, System]:
    """Recordings of one sample each that tell sizes of an effect with the information ``known``, without the effect
    and with it; nothing else is open but a parameter that no sample tells, held to 0."""
    target = [np.array([np.sqrt(i) * a]) for a, i in zip(sizes, known, strict=True)]
    plain = System(white=[full(np.zeros((1, 1)))] * len(sizes), target=target, precision=np.eye(1), prior=np.zeros(1))
    return plain, plain.with_columns([np.array([[np.sqrt(i)]]) for i in known])


def test_two_conditions_foretell_each_other_by_the_product_of_what_they_tell() -> None:
    """2 I a b of two that know as much; to 1e-6, for every parameter is held by 1e-9 of what is known of it."""
    for a, b in ((3.0, 2.0), (3.0, -2.0), (3.0, 0.0)):
        assert foretold(*systems([a, b], [50.0, 50.0]), [[0], [1]]) == pytest.approx(100.0 * a * b, abs=1e-4)


def test_what_shows_under_one_condition_only_counts_as_it_does_there() -> None:
    """The other neither confirms nor contradicts it: I a^2."""
    assert foretold(*systems([3.0, 0.0], [50.0, 0.0]), [[0], [1]]) == pytest.approx(450.0, abs=1e-4)


def test_what_contradicts_an_inspection_counts_under_every_condition() -> None:
    """A tooth that stands 6 um off where it was inspected to 0.5 um, alike under two conditions that know it far
    better: either explains the other without a claim, but not the sheet, by (6 / 0.5)^2 = 144."""
    white, known = [np.full((1, 1), 100.0)] * 2, np.full((1, 1), 0.5**-2)
    wide = [full(one) for one in white]
    plain = System(white=wide, target=[np.array([600.0])] * 2, precision=known, prior=np.zeros(1))
    assert foretold(plain, plain.with_columns([one.copy() for one in white]), [[0], [1]]) == pytest.approx(
        144.0, rel=0.01
    )


def test_recordings_of_one_condition_are_held_out_together() -> None:
    """Two recordings of one condition that contradict each other leave its mean, which another confirms."""
    plain, wider = systems([4.0, 0.0, 2.0], [25.0, 25.0, 50.0])
    together = foretold(plain, wider, [[0, 1], [2]])
    assert together == pytest.approx(foretold(*systems([2.0, 2.0], [50.0, 50.0]), [[0], [1]]), abs=1e-4)


def test_conditions_are_flanks_under_torques() -> None:
    file = rough()
    twice = (*CONDITIONS, Condition(flank="coast", torque_nm=20.0, speed_rpm=300.0))
    assert conditions(scope_of(file, twice)) == [[0], [1, 4], [2], [3]]


CROWNING = 5.0
"""um at 20 N m: some 30 standard deviations of it in 0.3 um of noise."""


def bulging(without_load: float, folder: Path) -> Fit:
    """The search in recordings at 20 N m, with ``CROWNING`` on the driving gear, and unloaded with another, begun with
    that crowning claimed."""
    true, rng = rough(), np.random.default_rng(11)
    made: list[Recording] = []
    for crowning, torque in ((CROWNING, 20.0), (without_load, 0.0)):
        assert true.driving.inspection is not None
        sheet = true.driving.inspection.model_copy(update={"profile_crowning_um": crowning})
        made += recorded(on_gear(true, 0, inspection=sheet), (Condition(torque_nm=torque),), rng, per_mesh=10)
    path = folder / "pair.toml"
    model = prepare(true, compare(true, made, path=path), path=path)
    nothing: list[FloatArray] = [np.zeros((one.samples.size, 0)) for one in model.observed]
    search = from_declared(model, nothing, lambda _: None)
    assert search.model.scope.torques == (20.0 * NM, 0.0)
    return settled(
        joined(search, [Claim(physics=catalogue()["profile_crowning"], place=Place(gear=0), values=(CROWNING,))])
    )


@pytest.mark.slow
def test_a_crowning_that_the_other_torque_contradicts_is_taken_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No gear bulges under load and is hollow without, were a law of compliance exact. The gain of the whole is far
    above chance all the same, and held-out cycles, which have both torques, let it stand."""
    monkeypatch.setattr(nuisance, "DISCREPANCY", 1e-9)
    search = bulging(-0.2 * CROWNING, tmp_path)
    plain, wider = with_and_without(search.model, search.scenes, search.linear, 0)
    assert plain.misfit - wider.misfit > 50.0
    assert paid_by(search, search.model.claims[0], plain, wider)
    worth = elsewhere(search, 0)
    assert worth is not None
    assert worth < 0.0
    assert not without_dear(search).model.claims


@pytest.mark.slow
def test_what_a_load_shows_against_the_unloaded_flank_is_no_crowning(tmp_path: Path) -> None:
    """No gear bulges under load and is hollow without: the unloaded recording tells how the flank is, within 0.1 um,
    and what the loaded one has beyond every law of compliance is told as a curve without a cause."""
    search = bulging(-0.2 * CROWNING, tmp_path)
    assert search.model.claims[0].values[0] == pytest.approx(-0.2 * CROWNING, abs=0.1)
    assert discrepancy_part(search) > DISCREPANCY_SIGMAS_TOLD


@pytest.mark.slow
def test_a_crowning_that_every_torque_shows_stays(tmp_path: Path) -> None:
    search = bulging(CROWNING, tmp_path)
    worth = elsewhere(search, 0)
    assert worth is not None
    assert worth > 50.0
    assert without_dear(search) is search
    assert [claim.physics.name for claim in search.model.claims] == ["profile_crowning"]


@pytest.mark.slow
def test_a_wave_too_small_beside_another_for_a_name_stays_in_the_fit(tmp_path: Path) -> None:
    """0.12 um of driving order 33, made by another part of the drive, beside a pitch wave of 40 um: it was dropped for
    its size, and the fit left with it gone was worse than before the pitch wave, which was refused then."""
    true = rough((19, 24), bends=False)
    assert true.driven.inspection is not None
    wave = 40.0 * np.cos(2.0 * np.pi * np.arange(24) / 24 - 1.0)
    sheet = true.driven.inspection
    moved = sheet.model_copy(update={"pitch_um": tuple((np.array(sheet.pitch_um) + wave).tolist())})
    (one,) = recorded(on_gear(true, 1, inspection=moved), (Condition(torque_nm=0.0),), np.random.default_rng(6),
                      cycles=2.0, per_mesh=10)  # fmt: skip
    assert one.driven_angle_rad is not None and one.driving_angle_rad is not None
    other = 0.12 * UM / scope_of(true).gears[1].r_b * np.cos(33 * one.driving_angle_rad)
    path = tmp_path / "pair.toml"
    shaken = [replace(one, driven_angle_rad=one.driven_angle_rad + other)]
    model = prepare(true, compare(true, shaken, path=path), path=path)
    search = from_declared(model, [np.zeros((one.samples.size, 0)) for one in model.observed], lambda _: None)
    pitch = Claim(physics=catalogue()["cumulative_pitch"], place=Place(gear=1, order=1, flank="drive"),
                  values=(21.6, 33.7))  # fmt: skip
    line = Claim(physics=catalogue()["encoder_interpolation"], place=Place(gear=0, order=33), values=(1.0, 0.0))
    search = settled(joined(search, [pitch, line]))
    before = search.linear.system.misfit
    search = without_idle(search)
    assert [claim.physics.name for claim in search.model.claims] == ["cumulative_pitch"]
    assert [one.claim.place.order for one in search.model.unnamed] == [33]
    assert search.linear.system.misfit < before + 10.0  # without the wave it rises by 300


@pytest.mark.slow
@pytest.mark.parametrize("grows", [False, True])
def test_what_swells_is_no_eccentricity(grows: bool, tmp_path: Path) -> None:
    """4 um of the driven gear from end to end, or from nothing to 8 um: a belt that slackens may do so, a gear does
    not. Both are found as large."""
    true, rng = rough((12, 16), bends=False), np.random.default_rng(6)
    (one,) = recorded(true, (Condition(torque_nm=0.0),), rng, cycles=4.0)
    assert one.driven_angle_rad is not None
    assert one.driving_angle_rad is not None
    along = np.linspace(0.0, 2.0, one.driven_angle_rad.size) if grows else 1.0
    r_b = scope_of(true).gears[1].r_b
    off = 4.0 * UM / r_b * along * np.cos(one.driven_angle_rad)
    shaken = replace(one, driven_angle_rad=one.driven_angle_rad + off)
    path = tmp_path / "pair.toml"
    diagnosis = diagnose(true, [shaken], path=path)
    if grows:
        assert not diagnosis.findings
        assert any(entry.gear == "driven" and entry.order == 1.0 for entry in diagnosis.unexplained)
    else:
        assert {finding.claim.place.gear for finding in diagnosis.findings} == {1}
        assert len(diagnosis.findings) == 1


@pytest.mark.parametrize("shown", ["steady", "swells"])
@pytest.mark.parametrize("drive", [0.0, 8.0])
@pytest.mark.parametrize("off", [2.0, 7.3])
def test_a_wave_of_the_drive_beside_an_order_does_not_make_a_tooth_swell(shown: str, drive: float, off: float) -> None:
    """One tooth of 36 over 4.4 turns, with a wave of the drive ``off`` so many cycles from an order of its shaft and
    none: it swells where it does from a half to one and a half, and only there."""
    rng = np.random.default_rng(7)
    turns = np.linspace(0.0, 4.4, 2200)
    along = np.linspace(-1.0, 1.0, turns.size)
    tooth = 10.0 * ((turns - 0.3) % 1.0 < 1.0 / 36.0)
    angle = 2.0 * np.pi * (1.0 + off / 4.4) * turns
    columns = np.column_stack((np.cos(angle), np.sin(angle), tooth))
    target = tooth * (1.0 + along if shown == "swells" else 1.0) + drive * np.cos(angle + 0.4)
    target = target + rng.standard_normal(turns.size)
    system = System(white=[full(columns)], target=[target], precision=1e-9 * np.eye(3), prior=np.zeros(3))
    layout = SimpleNamespace(claims=[slice(2, 3)], foreign=slice(0, 2), places=lambda k: [2])
    noise = SimpleNamespace(whitened=lambda a: a)
    linear: Any = SimpleNamespace(system=system, layout=layout, noises=[noise], columns=[full(columns)])
    seen = SimpleNamespace(along=along, theta_1=2.0 * np.pi * 1.5 * turns, theta_2=2.0 * np.pi * turns)
    claim = Claim(physics=catalogue()["tooth_pitch"], place=Place(gear=1, tooth=3, flank="drive"), values=(1.0,))
    model: Any = SimpleNamespace(
        claims=[claim],
        strangers=((0, 1),),
        observed=[SimpleNamespace(samples=seen)],
        scope=SimpleNamespace(run_ups=()),
    )
    assert swells(linear, model, 0) == (shown == "swells")
