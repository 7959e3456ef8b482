"""Nothing is told larger than all that recordings differ by, and no grade of teeth that were never recorded."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.files.models import PairFile
from gearpoly.recording.recording import Recording
from gearpoly.units import UM
from tests.pair_files import made, unloaded_te
from tests.physics_cases import rough

TEETH = 13, 22


def graded() -> PairFile:
    one, two = ({"teeth": z, "module_mm": 2.0, "face_width_mm": 20.0, "grade": 6} for z in TEETH)
    return PairFile.model_validate({"model": {"tooth_deflection": False}, "driving": one, "driven": two})


def recording(theta_2: np.ndarray[tuple[int, ...], np.dtype[np.float64]], *, seed: int = 3) -> Recording:
    """A pair of teeth of 3 um rms, with 0.3 um of noise."""
    pair = made(rough(TEETH, bends=False, points=200)).pair
    te = unloaded_te(made(rough(TEETH, bends=False, points=200)), theta_2)
    te = te + np.random.default_rng(seed).normal(0.0, 0.3 * UM, te.size)
    return Recording(
        source=Path("a.csv"), driving_angle_rad=(theta_2 - te / pair.r_b2) / pair.ratio, driven_angle_rad=theta_2,
        driving_zero_rad=0.0, driven_zero_rad=0.0,
    )  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("turns", [1.3, 2.1])
def test_no_wave_of_a_short_recording_is_larger_than_all_that_it_holds(turns: float) -> None:
    """Orders of both shafts lie within a line of each other in so few turns, and a fit may let them cancel."""
    theta_2 = np.linspace(0.0, turns * 2.0 * np.pi * TEETH[0] / TEETH[1], 3000)
    beside = compare(graded(), [recording(theta_2)], path=Path("pair.toml"))
    whole = float(np.ptp(beside.aligned[0].residual)) / UM
    for entry in beside.located.where:
        assert (entry.amplitude_um or 0.0) <= whole


@pytest.mark.slow
def test_a_gear_that_stopped_at_every_other_tooth_has_no_grade() -> None:
    """Eleven readings per turn of 22 teeth: what lies between is made up by the fit."""
    theta_2 = np.arange(0.0, 26.0 * 2.0 * np.pi, 2.0 * np.pi / 11.0)
    told = diagnose(graded(), [recording(theta_2)], path=Path("pair.toml"), within=5.0)
    assert "at 50 in 100 of its teeth" in told.built[1].ungraded
    assert told.built[1].exceeded == ()
    assert not any("driven gear" in one and "above the" in one for one in told.remarks)
