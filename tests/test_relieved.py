"""Bending and the reliefs that makers choose for it, as one step of the search."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relieved import pitch_point_compliance, relieved
from gearpoly.files.models import PairFile
from gearpoly.physics.tip_relief import TipRelief
from gearpoly.units import NM, UM
from tests.physics_cases import Condition, recorded, rough

TORQUE = 20.0


def model_of(file: PairFile, *, torque_nm: float, folder: Path) -> Model:
    recordings = recorded(file, (Condition(torque_nm=torque_nm),), np.random.default_rng(1), per_mesh=8)
    path = folder / "pair.toml"
    return prepare(file, compare(file, recordings, path=path), path=path)


@pytest.fixture(scope="module")
def loaded(tmp_path_factory: pytest.TempPathFactory) -> Model:
    return model_of(rough(bends=False), torque_nm=TORQUE, folder=tmp_path_factory.mktemp("loaded"))


@pytest.mark.long
def test_reliefs_are_as_deep_as_one_pair_bends(loaded: Model) -> None:
    """The force on the line of action is torque over the driven base radius, all on the pair at the pitch point."""
    bending, *reliefs = relieved(loaded)
    assert (bending.physics.name, bending.values) == ("tooth_deflection", (1.0,))
    assert [(one.physics.name, one.place.gear) for one in reliefs] == [("tip_relief", 0), ("tip_relief", 1)]
    force = TORQUE * NM / loaded.scope.gears[1].r_b
    for one in reliefs:
        assert one.values[0] == pytest.approx(force * pitch_point_compliance(loaded))
    # Simulated teeth bend by as much where one pair carries all: within a fifth along that stretch.
    (stiff,) = loaded.scenes()
    (soft,) = model_of(rough(bends=True), torque_nm=TORQUE, folder=loaded.path.parent).scenes()
    single = np.sum(soft.weight > 0.0, axis=0) == 1
    assert np.median((stiff.te - soft.te)[single]) / UM == pytest.approx(reliefs[0].values[0], rel=0.2)


@pytest.mark.long
def test_what_bends_already_is_not_claimed_again(tmp_path: Path) -> None:
    found = relieved(model_of(rough(bends=True), torque_nm=TORQUE, folder=tmp_path))
    assert [one.physics.name for one in found] == ["tip_relief", "tip_relief"]


@pytest.mark.long
def test_nothing_is_relieved_without_load_or_against_the_drawing(loaded: Model, tmp_path: Path) -> None:
    assert relieved(model_of(rough(bends=False), torque_nm=0.0, folder=tmp_path)) == []
    plain = rough(bends=False)
    relief = TipRelief(amount_um=5.0, length_mm=0.6)
    drawn = plain.model_copy(update={"driving": plain.driving.model_copy(update={"tip_relief": relief})})
    assert relieved(model_of(drawn, torque_nm=TORQUE, folder=tmp_path)) == []
    assert relieved(replace(loaded, method=Method(without=frozenset({"tip_relief"})))) == []
    assert relieved(replace(loaded, method=Method(without=frozenset({"tooth_deflection"})))) == []
