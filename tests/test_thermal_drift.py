"""Drift of one recording, or of all alike where each began cold."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.diagnose.diagnose import diagnose
from gearpoly.files.models import Measurement
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.report.diagnosis_report import verdict_json
from gearpoly.scene import Scene
from gearpoly.units import UM
from tests.physics_cases import Condition, claim_of, recorded, rough, scope_of
from tests.test_physics import base

DRIFT = catalogue()["thermal_drift"]
VALUES = (2.0, -1.0, 0.4)


@pytest.mark.long
def test_drifts_are_looked_for_in_each_recording_and_in_all_that_do_not_wander() -> None:
    scope = replace(scope_of(base()[0]), torques=(0.0, 0.0, 0.0), wanders=())
    places = [place.recordings for place in DRIFT.places(scope)]
    assert places == [(0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)]
    places = [place.recordings for place in DRIFT.places(replace(scope, wanders=(False, True, False)))]
    assert places == [(0,), (2,), (0, 2)]
    assert [p.recordings for p in DRIFT.places(replace(scope, torques=(0.0,)))] == [(0,)]


def test_a_drift_of_all_is_the_sum_of_one_in_each() -> None:
    """In every scene, and in the file, where it comes on top of what was stated."""
    scenes: list[Scene] = base()[2]
    numbers = tuple(range(len(scenes)))
    assert DRIFT.effect is not None
    for scene in scenes:
        alone = [DRIFT.effect(scene, Place(recordings=(k,)), VALUES) for k in numbers]
        together = DRIFT.effect(scene, Place(recordings=numbers), VALUES)
        assert np.ptp(together) > 0.0
        np.testing.assert_allclose(together, np.sum(alone, axis=0))
    stated = base()[0].model_copy(
        update={"measurement": Measurement.model_construct(thermal_drift_um=((1.5,), (), (0.5, 0.0, 0.1)))}
    )
    written = Claim(physics=DRIFT, place=Place(recordings=(0, 2)), values=VALUES).written(stated)
    assert written.measurement is not None
    assert written.measurement.thermal_drift_um == ((3.5, -1.0, 0.4), (), (2.5, -1.0, 0.5))


def test_of_many_recordings_one_drifts_or_all() -> None:
    scope = replace(scope_of(base()[0]), torques=(0.0,) * 6, wanders=())
    assert [place.recordings for place in DRIFT.places(scope)] == [*((k,) for k in range(6)), tuple(range(6))]


def test_it_says_which_recordings_drift() -> None:
    one = claim_of("thermal_drift")
    some = replace(one, place=Place(recordings=(0, 2, 3)))
    assert "recording 0 " in one.says
    assert "recordings 0, 2 and 3, alike," in some.says


@pytest.mark.slow
def test_recordings_that_drift_each_by_itself_are_one_finding() -> None:
    """Of three recordings two drift, differently: one entry, whose errors hold both sizes, and whose loss is both's."""
    known = rough()
    drifts = ((3.0, 0.6, 0.0), (), (-1.2, 0.3, 0.2))
    true = known.model_copy(update={"measurement": Measurement.model_construct(thermal_drift_um=drifts)})
    made = (Condition(torque_nm=20.0), Condition(torque_nm=0.0), Condition(torque_nm=10.0))
    diagnosis = diagnose(known, recorded(true, made, np.random.default_rng(6)), path=Path("pair.toml"))
    (found,) = diagnosis.findings
    assert found.claim.physics is DRIFT
    assert found.recordings == (0, 2)
    assert len(found.claims) == 2
    assert "recording 0 " in found.says and "recording 2 " in found.says
    along = np.linspace(-1.0, 1.0, 201)
    for k in (0, 2):
        size = float(np.ptp(np.polynomial.legendre.legval(along, (0.0, *drifts[k]))))
        value, std = found.parameters[f"recording_{k}_amplitude_um"]
        assert abs(value - size) < 4.0 * std < 0.3 * size
    assert found.parameters["amplitude_um"] == found.parameters["recording_0_amplitude_um"]
    entry = verdict_json(diagnosis)["missing"][0]
    assert entry["recordings"] == [0, 2]
    assert set(entry["parameters"]) == set(found.parameters)
    # Without either, both recordings' drift is left, and more where half of it taught the other half.
    left = np.hypot(*(np.std(np.polynomial.legendre.legval(along, (0.0, *drifts[k]))) for k in (0, 2)))
    assert found.without.unseen > np.hypot(left / np.sqrt(3.0), 0.3) * UM
    assert found.with_.unseen == pytest.approx(0.3 * UM, rel=0.05)
    held = diagnosis.fitted.measurement
    assert held is not None and [bool(one) for one in held.thermal_drift_um] == [True, False, True]
