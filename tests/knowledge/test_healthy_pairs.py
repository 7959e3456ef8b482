"""A pair of which nothing is missing gets no name, whatever noise, laws of compliance and readings do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.files.models import PairFile
from gearpoly.recording.recording import Recording
from gearpoly.units import DEG, UM
from tests.knowledge.rigs import UNLOADED, bending, hidden, inspected, record
from tests.knowledge.verdicts import verdict
from tests.physics_cases import Condition


def softer(file: PairFile, **keys: object) -> PairFile:
    """The pair with other keys of its model."""
    return file.model_copy(update={"model": file.model.model_copy(update=keys)})


@pytest.mark.slow
def test_noise_alone_raises_no_name() -> None:
    """Thousands of places are looked at, so one in a thousand by chance at each would be several names."""
    known = inspected()
    found = verdict(known, record(known, UNLOADED, cycles=2.0))
    assert not found.missing, found.told


@pytest.mark.slow
def test_compliance_laws_that_disagree_are_no_fault() -> None:
    """Teeth by ISO 6336 beside a beam's: the curves differ by more than noise, and no gear is to blame."""
    known = bending()
    loads = Condition(torque_nm=20.0), Condition(torque_nm=120.0)
    found = verdict(known, record(softer(known, compliance="iso6336"), *loads, cycles=2.0, noise_um=0.15))
    assert not found.missing, found.told


@pytest.mark.slow
def test_soft_teeth_are_a_compliance_and_no_name() -> None:
    """Declared compliances are known to some 15 %. What is softer by as much is told as the compliance's scale, here
    within 5 %: what the law's shape may take of it."""
    known = bending()
    loads = Condition(torque_nm=2.0), Condition(torque_nm=20.0)
    found = verdict(known, record(softer(known, compliance_scale=1.15), *loads, cycles=2.0))
    assert not found.missing, found.told
    assert found.json["as_built"]["compliance_scale"]["value"] == pytest.approx(1.15, abs=0.05)


@pytest.mark.slow
def test_a_wind_up_as_small_as_laws_disagree_on_has_no_name() -> None:
    """0.15 urad per N m is a hundredth of what the teeth give: contacts, shafts and bearings harden by as much."""
    known = bending()
    loads = tuple(Condition(torque_nm=one) for one in (2.0, 20.0, 60.0))
    found = verdict(known, record(hidden(known, "shaft_windup", (0.15,)), *loads, cycles=2.0))
    assert not found.missing, found.told


@pytest.mark.slow
def test_the_noise_of_a_reading_gets_no_name() -> None:
    """At even steps a wave of as many periods a turn as there are samples repeats each reading's own noise: drawn at
    the angle as it was read it would explain all of that."""
    driven = 0.72 * DEG * np.arange(3000)
    te_mm = 0.3 * UM * np.random.default_rng(9).normal(size=driven.size)
    ideal = PairFile.model_validate(
        {"driving": {"teeth": 18, "module_mm": 2.0}, "driven": {"teeth": 25, "module_mm": 2.0}}
    )
    found = verdict(ideal, [Recording(source=Path("even.csv"), driven_angle_rad=driven, te_mm=te_mm)])
    assert not found.missing, found.told
