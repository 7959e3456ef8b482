"""What goes on slowly, what happens at once, and what a wrong count does."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.files.models import Measurement
from tests.knowledge.rigs import UNLOADED, added, bending, hidden, inspected, record
from tests.knowledge.verdicts import Cause, verdict
from tests.physics_cases import Condition

pytestmark = pytest.mark.slow

DRIFT = Cause(physics="thermal_drift")
SLOW = ("time", "step", "drift")
"""Kinds of entries that place what is slow or sudden."""


def test_a_step_that_looks_like_a_drift_has_no_name() -> None:
    """1 um at two fifths of the recording: three slow terms take most of a step, and no physics jumps."""
    known = inspected()
    (one,) = record(known, UNLOADED)
    found = verdict(known, [added(one, known, 1.0 * (np.arange(one.size) >= 0.4 * one.size))])
    assert not found.missing, found.told
    assert any(abs(abs(step["amplitude_um"]) - 1.0) < 0.1 for step in found.located(SLOW)), found.told


def test_a_step_as_faint_as_its_noise_has_no_name_either() -> None:
    """0.1 um is six standard errors in these samples: as a whole it is surely there, its moment is not."""
    known = inspected()
    (one,) = record(known, UNLOADED, seed=5)
    found = verdict(known, [added(one, known, 0.1 * (np.arange(one.size) >= 0.3 * one.size))])
    assert not found.missing, found.told


def test_a_drift_is_named() -> None:
    """A bow and a tilt of some microns from beginning to end, as what warms up makes."""
    known = inspected()
    found = verdict(known, record(hidden(known, "thermal_drift", (2.0, -1.0, 0.4), in_recordings=(0,)), UNLOADED))
    assert found.misnamed(DRIFT) == [], found.told
    if found.missing:
        assert found.size(DRIFT, "amplitude_um") == pytest.approx(4.8, abs=0.2)  # its stated error is 0.03 um
    else:
        assert found.located(SLOW), found.told


def test_a_straight_ramp_may_be_a_wrong_count() -> None:
    """200 ppm too many counts a turn is a straight line, and so is a drift that happens to be straight: the first needs
    nothing to be so, and is not left out."""
    known = inspected()
    found = verdict(known, record(hidden(known, "encoder_scale", (200.0,), gear=0), UNLOADED))
    count = Cause(physics="encoder_scale")
    assert found.misnamed(count) == [], found.told
    assert found.named(count) is not None or found.located(SLOW), found.told


def test_recordings_that_drift_each_by_itself_are_one_finding() -> None:
    """Two of three, differently: a rig drifts, each time by itself."""
    known = inspected()
    drifts = ((3.0, 0.6, 0.0), (), (-1.2, 0.3, 0.2))
    true = known.model_copy(update={"measurement": Measurement.model_construct(thermal_drift_um=drifts)})
    found = verdict(known, record(true, UNLOADED, UNLOADED, UNLOADED, cycles=2.0))
    assert found.misnamed(DRIFT) == [], found.told
    assert len(found.missing) <= 1, found.told
    assert found.missing or found.located(SLOW), found.told


def test_a_wandering_recording_does_not_set_its_mean_apart_from_the_others() -> None:
    """It warms by 6 um while it is loaded. What wanders goes on between recordings too, so how far their means are
    apart tells of no wind-up and no other centre distance."""
    known = bending()
    true = hidden(known, "thermal_drift", (3.0, -1.0, 0.4), in_recordings=(1,))
    made = record(true, Condition(torque_nm=2.0), Condition(torque_nm=20.0), cycles=2.0)
    warmer = added(made[1], known, np.full(made[1].size, 2.0))
    found = verdict(known, [made[0], warmer])
    assert found.misnamed(DRIFT) == [], found.told
