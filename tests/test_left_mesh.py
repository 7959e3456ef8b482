"""A tooth that stands so far back that its neighbours carry over it: it is named, with the least size it can have."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.claimed import GROWN
from gearpoly.diagnose.diagnose import AT_LEAST, diagnose
from gearpoly.diagnose.fit import joined
from gearpoly.diagnose.imagine import NextRecording, imagined
from gearpoly.diagnose.least import brought_to_least, runs_alike
from gearpoly.diagnose.linear import derivatives, out_of_mesh
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.diagnose.scan import every_place, polished, scan
from gearpoly.diagnose.verdict import Diagnosis
from gearpoly.files.models import PairFile
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.recording.recording import Recording
from gearpoly.scene import stage
from tests.pair_files import made
from tests.physics_cases import Condition, recorded, samples_at

Z, TOOTH = (30, 45), 7


def pair(lag_um: float, *, spall_um: float = 0.0, bends: bool = False) -> PairFile:
    """Small inspected gears; one driving tooth stands back, or is pitted in the middle of its flank."""
    rng = np.random.default_rng(9)
    gears: dict[str, Any] = {"model": {"tooth_deflection": bends}}
    for name, z in zip(("driving", "driven"), Z, strict=True):
        pitch = rng.normal(0.0, 1.0, z).round(2)
        pitch[TOOTH] += lag_um if name == "driving" else 0.0
        sheet = {"pitch_um": pitch.tolist(), "profile_slope_um": [0.0] * z, "uncertainty_um": 0.2}
        gears[name] = {"teeth": z, "module_mm": 0.5, "face_width_mm": 5.0, "points_per_flank": 400, "inspection": sheet}
    if spall_um:
        pit = {"tooth": TOOTH, "depth_um": spall_um, "from_mm": 7.4, "to_mm": 7.5, "wall_mm": 0.03}
        gears["driving"]["spall"] = [pit]
    return PairFile.model_validate(gears)


@pytest.fixture(scope="module")
def lagging() -> dict[float, Recording]:
    """The same recording of a tooth that stands back by 2, 24 and 48 um."""
    out = {}
    for lag in (-2.0, -24.0, -48.0):
        (out[lag],) = recorded(pair(lag), (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=4.0)
    return out


def found(recording: Recording, folder: Path) -> Diagnosis:
    return diagnose(pair(0.0), [recording], path=folder / "pair.toml")


@pytest.mark.long
def test_farther_back_nothing_changes(lagging: dict[float, Recording]) -> None:
    """A premise: the transmission error of 24 um is that of 48 um, of the same noise."""
    near, far = (lagging[lag].driving_angle_rad for lag in (-24.0, -48.0))
    assert near is not None
    assert far is not None
    assert np.max(np.abs(near - far)) < 1e-9


@pytest.mark.slow
def test_a_tooth_out_of_the_mesh_is_named_with_its_least_size(lagging: dict[float, Recording], tmp_path: Path) -> None:
    """Its size no longer changes anything, so to first order nothing is lost without it; only the whole tells."""
    diagnosis = found(lagging[-24.0], tmp_path)
    (one,) = diagnosis.findings
    assert (one.claim.physics.name, one.claim.place.gear, one.tooth) == ("tooth_pitch", 0, TOOTH)
    size, std = one.parameters["deviation_um"]
    assert -24.0 <= size < -2.0
    assert std >= AT_LEAST * abs(size)
    assert any("the least it can have" in remark for remark in diagnosis.remarks)
    assert diagnosis.after.unseen == pytest.approx(diagnosis.noise, rel=0.02)


@pytest.mark.slow
def test_a_tooth_that_touches_keeps_its_size_and_error(lagging: dict[float, Recording], tmp_path: Path) -> None:
    diagnosis = found(lagging[-2.0], tmp_path)
    (one,) = diagnosis.findings
    size, std = one.parameters["deviation_um"]
    assert abs(size + 2.0) < 2.0 * std
    # An inspection to 0.2 um on this tooth and on all others.
    assert std < 0.4
    assert not any("the least it can have" in remark for remark in diagnosis.remarks)


@pytest.mark.slow
def test_a_loaded_tooth_out_of_the_mesh_is_no_crack(tmp_path: Path) -> None:
    """Bent by 1 and 2 um, pairs close over a tooth that stands 20 um back, as over one that gives ten times as much: to
    first order a tooth out of the mesh has no place, only a softness."""
    loads = tuple(Condition(torque_nm=torque) for torque in (0.8, 2.0))
    recordings = recorded(pair(-20.0, bends=True), loads, np.random.default_rng(4), cycles=2.0)
    diagnosis = diagnose(pair(0.0, bends=True), recordings, path=tmp_path / "pair.toml")
    (one,) = diagnosis.findings
    assert (one.claim.physics.name, one.claim.place.gear, one.tooth) == ("tooth_pitch", 0, TOOTH)
    size, std = one.parameters["deviation_um"]
    assert abs(size + 20.0) < 2.0 * std
    assert size < -4.0
    assert diagnosis.after.unseen == pytest.approx(diagnosis.noise, rel=0.02)
    # A control that strikes it from the catalogue must not get it by the back door.
    struck = Method(without=frozenset({"tooth_pitch"}))
    without = diagnose(pair(0.0, bends=True), recordings, path=tmp_path / "pair.toml", method=struck)
    assert "tooth_pitch" not in {other.claim.physics.name for other in without.findings}


@pytest.mark.slow
def test_a_pit_so_deep_that_the_teeth_lose_touch_is_named_where_it_is(tmp_path: Path) -> None:
    """Its walls, where teeth still touch, tell the edges to a wall's width or two; the bottom is at least as deep. A
    bowl of 3 um whose farther edge stands 0.04 mm off leaves as little as noise is, so no more can be asked."""
    (one,) = recorded(pair(0.0, spall_um=20.0), (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=4.0)
    diagnosis = found(one, tmp_path)
    (pit,) = diagnosis.findings
    assert (pit.claim.physics.name, pit.claim.place.gear, pit.tooth) == ("tooth_spall", 0, TOOTH)
    depth, std = pit.parameters["depth_um"]
    assert abs(depth - 20.0) < 2.0 * std
    for name, edge in (("from_mm", 7.4), ("to_mm", 7.5)):
        told, error = pit.parameters[name]
        assert abs(told - edge) < min(2.0 * error, 0.06)


@pytest.mark.long
def test_a_size_of_which_only_the_least_is_known_is_brought_to_it(
    lagging: dict[float, Recording], tmp_path: Path
) -> None:
    """From wherever the fit ended: 2.5 times as far back the teeth run alike, and a third of the least they do not."""
    path = tmp_path / "pair.toml"
    model = prepare(pair(0.0), compare(pair(0.0), [lagging[-24.0]], path=path), path=path)
    search = from_declared(model, [np.zeros((one.samples.size, 0)) for one in model.observed], lambda _: None)
    claim = Claim(physics=catalogue()["tooth_pitch"], place=Place(gear=0, tooth=TOOTH), values=(-24.0,))
    search, least = joined(search, [claim]), []
    for far in (-24.0, -60.0):
        here = search.believing(claims=(replace(claim, values=(far,)),))
        there = brought_to_least(replace(here, scenes=here.model.scenes()).linearised())
        (found,) = there.model.claims
        least.append(found.values[0])
        assert out_of_mesh(there.model, there.scenes, found)
        assert not runs_alike(there, [replace(found, values=(found.values[0] / 3.0,))])
    assert least[1] == pytest.approx(least[0], rel=0.5)
    assert -24.0 <= least[0] < -2.0


@pytest.mark.long
def test_a_pit_may_be_asked_to_grow_no_more_than_it_has_to(tmp_path: Path) -> None:
    """To first order a bowl of 28 um gains 0.2 % more than one of 4 um, and which of them a fit leads to the true pit
    from depends on all else; so both can be asked for."""
    (one,) = recorded(pair(0.0, spall_um=20.0), (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=4.0)
    path = tmp_path / "pair.toml"
    model = prepare(pair(0.0), compare(pair(0.0), [one], path=path), path=path)
    fit = from_declared(model, [np.zeros((model.observed[0].samples.size, 0))], lambda _: None)
    model = fit.model
    places = ((p, place) for p, place in every_place(model) if p.name == "tooth_spall" and place.tooth == TOOTH)
    coarse = scan(model, fit.scenes, fit.linear, only=places)[0][0]
    free, held = (
        polished(model, fit.scenes, fit.linear, coarse, roughly=True, grown=grown) for grown in (math.inf, GROWN)
    )
    size, most = coarse.claim.values[0], GROWN * coarse.claim.values[0]
    assert size < held.claim.values[0] <= most < free.claim.values[0]
    # As it is first looked for, it gains 580 of their 1075.
    assert coarse.gain < 0.7 * held.gain
    assert held.gain > 0.99 * free.gain


def test_edges_of_a_pit_that_a_fit_has_moved_past_each_other_are_told_in_order() -> None:
    """The same pit, from whichever edge it is told."""
    physics = catalogue()["tooth_spall"]
    covariance = np.diag([1.0, 4.0, 9.0, 16.0])
    place = Place(gear=0, tooth=TOOTH)
    crossed = physics.report(place, np.array([3.0, 7.5, 7.4, 0.03]), covariance)
    assert crossed == {"depth_um": (3.0, 1.0), "from_mm": (7.4, 3.0), "to_mm": (7.5, 2.0), "wall_mm": (0.03, 4.0)}
    assembled = made(pair(0.0))
    assert physics.effect is not None
    theta = np.linspace(0.0, assembled.pair.cycle, 3000)
    scene = stage(assembled, samples_at(assembled, theta, Condition(torque_nm=0.0), 0))
    one, other = (physics.effect(scene, place, (3.0, *edges, 0.03)) for edges in ((7.4, 7.5), (7.5, 7.4)))
    assert np.max(np.abs(one)) > 1e-4
    assert np.array_equal(one, other)


@pytest.mark.long
def test_an_imagined_recording_has_its_own_samples_beside_a_tooth_out_of_the_mesh(tmp_path: Path) -> None:
    """What a claimed tooth changes is asked of the scenes given, which need not be the recordings'."""
    diagnosed = pair(0.0)
    (one,) = recorded(pair(-24.0), (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=2.0)
    model = prepare(diagnosed, compare(diagnosed, [one], path=tmp_path / "pair.toml"), path=tmp_path / "pair.toml")
    claim = Claim(physics=catalogue()["tooth_pitch"], place=Place(gear=0, tooth=TOOTH, flank="drive"), values=(-24.0,))
    model = replace(model, claims=(claim,))
    scene = imagined(model, NextRecording(flank="drive", torque=1000.0), number=1)
    assert scene.samples.size != model.observed[0].samples.size
    (column,) = derivatives(model, [scene], claim)
    assert column.shape == (scene.samples.size, 1)
    assert np.any(column)
