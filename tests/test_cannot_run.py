"""Causes with which gears cannot run are weighed as nothing, and end no diagnosis."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.linear import derivatives
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.trial import drawn_of
from gearpoly.errors import OutOfRangeError
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.scene import Scene
from gearpoly.units import FloatArray
from tests.pair_files import pair_file
from tests.physics_cases import Condition, recorded

WIND_UP = Claim(physics=catalogue()["shaft_windup"], place=Place(), values=(1.0,))


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Model:
    file = pair_file((17, 23), driving={"grade": 6}, driven={"grade": 6}, points=200)
    (one,) = recorded(file, (Condition(torque_nm=20.0),), np.random.default_rng(4), cycles=1.0, per_mesh=12)
    path = tmp_path_factory.mktemp("pair") / "pair.toml"
    return prepare(file, compare(file, [one], path=path), path=path)


def bending_too_far(monkeypatch: pytest.MonkeyPatch, most: float) -> None:
    """Gears run up to a size of ``most`` alone."""
    change = Model.change

    def limited(
        self: Model, scenes: list[Scene], claim: Claim, values: tuple[float, ...], **more: Any
    ) -> list[FloatArray]:
        if values[0] > most:
            raise OutOfRangeError("teeth bend by more than 5 % of the module")
        return change(self, scenes, claim, values, **more)

    monkeypatch.setattr(Model, "change", limited)


@pytest.mark.long
def test_the_last_size_that_gears_run_with_has_its_derivative(model: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is in proportion to its size has one derivative, forwards and backwards, to rounding."""
    scenes = model.scenes()
    (plain,) = derivatives(model, scenes, WIND_UP)
    bending_too_far(monkeypatch, most=1.0)
    (backwards,) = derivatives(model, scenes, WIND_UP)
    assert np.max(np.abs(plain)) > 0.0
    assert backwards == pytest.approx(plain, rel=1e-6, abs=1e-12 * float(np.max(np.abs(plain))))


@pytest.mark.long
def test_a_cause_that_cannot_be_is_no_cause(model: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    scenes = model.scenes()
    assert drawn_of(model, scenes, WIND_UP) is not None
    assert model.changed(scenes, WIND_UP) is not None
    bending_too_far(monkeypatch, most=0.5)
    assert drawn_of(model, scenes, WIND_UP) is None
    assert model.changed(scenes, WIND_UP) is None
