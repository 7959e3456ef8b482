"""What ``compare`` tells beside gears that nobody inspected: teeth touch as they were built, not to first order."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.entries import Entry
from gearpoly.compare.locate import Located
from gearpoly.diagnose.begin import before_claims
from gearpoly.diagnose.budget import Budget
from gearpoly.diagnose.compare_as_built import compare_as_built, held_by_teeth
from gearpoly.diagnose.fit import PASSES, Fit
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.placing import placed
from gearpoly.recording.recording import Recording
from gearpoly.units import UM
from tests.knowledge_compare.made import drawn, pair, recorded

FILE = pair(grade=6)
"""An 11/13 of grade 6, module 2 mm, that nobody inspected: single pitches within 7.5 um, slopes within 6 um."""

NOISE = 0.3
"""um rms."""


def recording_of(seed: int, *, proud: float = 0.0, off_axis: float = 0.0) -> Recording:
    """Two hunting cycles of gears within the grade by pitch and slope: 2.5 um of either, 2 standard deviations below
    their limits; driven tooth 4 ``proud`` and the driving gear ``off_axis``, in um."""
    rng = np.random.default_rng(seed)

    def sheet(z: int) -> dict[str, Any]:
        return {"profile_slope_um": rng.normal(0.0, 2.5, z).round(3).tolist()}

    pitch = [rng.normal(0.0, 2.5, z) for z in (11, 13)]
    pitch[1][4] += proud
    eccentric = {"eccentricity": {"amplitude_um": off_axis, "angle_deg": 40.0}} if off_axis else {}
    true = pair(
        pitch_um=(pitch[0], pitch[1]), driving={"inspection": sheet(11)} | eccentric, driven={"inspection": sheet(13)}
    )
    return recorded(drawn(true), seed=seed, noise=NOISE)


def located(recording: Recording) -> Located:
    """Where a recording differs from the pair of which only the grade is known."""
    return compare_as_built(FILE, [recording], path="pair.toml").located


def standing(found: Located) -> list[Entry]:
    """Places that teeth within their grade could not make."""
    return [one for one in found.where if not one.as_built]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 8])
def test_healthy_unloaded_gears_leave_nothing_to_tell(seed: int) -> None:
    """Which of two teeth touches is no linear matter: to first order a healthy pair seems to have many faults."""
    recording = recording_of(seed)
    first = compare(FILE, [recording], path="pair.toml")
    assert len(first.located.entries) >= 5
    found = located(recording)
    assert standing(found) == []
    # All of the mismatch is teeth within their grade, and noise, whose rms two cycles tell to some 2 %.
    division = found.division
    assert division.noise == pytest.approx(NOISE * UM, rel=0.06)
    assert division.physics < 0.1 * UM
    assert np.hypot(division.as_built, division.noise) == pytest.approx(first.aligned[0].rms, rel=0.02)


@pytest.mark.long
def test_a_tooth_that_no_grade_allows_is_the_one_place() -> None:
    """30 um of pitch where single pitches keep to 7.5 um: teeth as built would have to pay for it."""
    (found,) = standing(located(recording_of(5, proud=30.0)))
    assert (found.kind, found.gear, found.tooth) == ("tooth", "driven", 4)
    assert found.amplitude_um is not None
    assert found.rms_um == found.amplitude_um
    # About the mean of its gear: 30/13 um less, and what its own 2.5 um add; slopes of 2.5 um move where it touches.
    assert found.amplitude_um == pytest.approx(30.0 * 12 / 13, abs=3.0 * 2.5 * math.sqrt(1.25))


@pytest.mark.slow
def test_an_axis_that_is_off_by_more_than_the_grade_allows_is_told() -> None:
    """40 um of eccentricity where the cumulative pitch keeps to 19 um: a first order of the driving shaft, as large."""
    found = standing(located(recording_of(6, off_axis=40.0)))
    assert found
    assert (found[0].kind, found[0].gear, found[0].order) == ("shaft_order", "driving", 1.0)
    assert found[0].amplitude_um == pytest.approx(40.0, abs=5.0)  # teeth of 2.5 um have a first order of a few um


@pytest.mark.slow
@pytest.mark.parametrize("off_axis", [0.0, 40.0])
def test_without_time_to_locate_anew_what_teeth_hold_is_theirs(off_axis: float) -> None:
    """Of a healthy pair no wave or stretch of all teeth is told, and of an axis that is off by twice what the grade
    allows its first order, as with all the time there is."""
    comparison = compare(FILE, [recording_of(3, off_axis=off_axis)], path="pair.toml")
    waves = [one for one in comparison.located.where if one.kind in ("shaft_order", "mesh_order", "mesh_phase")]
    assert len(waves) >= 5
    model, foreign = before_claims(FILE, comparison, path=Path("pair.toml"), method=Method(), budget=Budget())
    model = placed(model, foreign, lambda _: None)
    comparison = comparison.moved(model.offset)
    found = held_by_teeth(Fit.begun(model, foreign, lambda _: None, trial=PASSES), comparison).located
    told = [one for one in standing(found) if one.of_the_pair and one.kind != "tooth"]
    assert [(one.gear, one.order) for one in told][:1] == ([("driving", 1.0)] if off_axis else [])
    assert not off_axis or len(told) < len(waves) / 2
    assert {one.kind for one in found.entries if one in told} <= {"shaft_order"}
