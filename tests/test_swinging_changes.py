"""Beside a resonance a change of the teeth swings along: first order in a swinging pair against exact simulation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearpoly.assemble import Assembled
from gearpoly.diagnose.nuisance import slope_of
from gearpoly.files.models import PairFile, PairSection
from gearpoly.mesh.deflection import Elasticity
from gearpoly.physics.samples import Samples
from gearpoly.scene import Scene, stage
from gearpoly.units import FloatArray
from tests.pair_files import made
from tests.physics_cases import Condition, claim_of, rough, samples_at, sized

PER_MESH = 96
"""Samples a pitch, 16 a period of the swing at twice the mesh frequency."""

ALLOWED = 0.03
"""Part of the largest change: straight lines between samples miss (2 pi / 16)^2 / 12 of what swings, contacts that
begin within a change one of some hundred samples more."""


def swinging(**more: object) -> PairFile:
    """A rough pair at 600 rpm, 120 Hz of mesh, whose resonance of 150 Hz magnifies that more than twice."""
    file = rough()
    pair = PairSection.model_validate(
        {"torque_nm": 20.0, "resonance": {"frequency_hz": 150.0, "damping_ratio": 0.08, "damped_in_mesh": 0.4}}
    )
    return file.model_copy(update={"pair": pair, **more})


@pytest.fixture(scope="module")
def at_speed() -> tuple[Assembled, Samples, Scene]:
    """Two hunting cycles, of which the start has died in the second."""
    assembled = made(swinging())
    n = assembled.pair.meshes_per_cycle * PER_MESH
    samples = samples_at(assembled, np.arange(2 * n) * (assembled.pair.cycle / n), Condition(), 0)
    return assembled, samples, stage(assembled, samples)


def settled(change: FloatArray) -> FloatArray:
    return change[change.size // 2 :]


@pytest.mark.long
@pytest.mark.parametrize("name", [pytest.param("tooth_pitch", marks=pytest.mark.slow), "profile_slope"])
def test_a_change_of_teeth_swings_along(at_speed: tuple[Assembled, Samples, Scene], name: str) -> None:
    _, samples, scene = at_speed
    claim = claim_of(name)
    values = sized(claim, 0.01)
    assert claim.physics.effect is not None
    still = claim.physics.effect(scene, claim.place, values)
    exact = settled(stage(made(claim.physics.write(swinging(), claim.place, values)), samples).te - scene.te)
    off = np.abs(settled(scene.swung(still)) - exact)
    largest = float(np.max(np.abs(exact)))
    assert np.quantile(off, 0.95) < ALLOWED * largest
    assert np.quantile(np.abs(settled(still) - exact), 0.95) > 0.2 * largest


@pytest.mark.long
def test_what_load_bends_swings_along(at_speed: tuple[Assembled, Samples, Scene]) -> None:
    """A softer law in the same scene, and the set-up simulated with it: the change is first order in nothing."""
    assembled, samples, scene = at_speed
    softer = replace(assembled.elasticity or Elasticity(), scale=1.1)
    exact = settled(stage(replace(assembled, elasticity=softer), samples).te - scene.te)
    again = scene.with_load_of(replace(assembled, elasticity=softer)) - scene.with_load_of(assembled)
    for found in (scene.bending(softer) - scene.te, again):
        off = np.abs(settled(found) - exact)
        assert np.quantile(off, 0.95) < ALLOWED * float(np.ptp(exact))


@pytest.mark.long
def test_a_late_zero_swings_along(at_speed: tuple[Assembled, Samples, Scene]) -> None:
    assembled, samples, scene = at_speed
    by = 1e-5
    late = stage(assembled, replace(samples, theta_2=samples.theta_2 + by))
    exact = settled(late.te - scene.te) / by
    off = np.abs(settled(slope_of(scene)) - exact)
    # A slope over 1/32 of a pitch rounds the edges at which teeth hand over.
    assert np.quantile(off, 0.9) < 0.15 * float(np.max(np.abs(exact)))


def test_without_a_resonance_nothing_swings() -> None:
    assembled = made(rough())
    scene = stage(assembled, samples_at(assembled, np.linspace(0.0, 0.5, 40), Condition(), 0))
    np.testing.assert_array_equal(scene.swung(scene.te), scene.te)
