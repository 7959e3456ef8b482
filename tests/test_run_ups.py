"""A run-up through a resonance: compared with what follows it, and named where it was left out."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gearpoly.assemble import assemble
from gearpoly.compare.compare import compare
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.prepare import prepare
from gearpoly.files.models import PairFile
from gearpoly.mesh.condition import Condition
from gearpoly.recording.recording import Recording
from gearpoly.units import UM, FloatArray
from tests.made_recordings import te_of
from tests.physics_cases import rough

HZ, DAMPING, NOISE_UM = 400.0, 0.06, 0.1
SPEEDS = (120.0, 420.0)
"""rad/s of the driving shaft, 230 to 800 Hz of 12 teeth."""


@pytest.fixture(scope="module")
def run_up() -> tuple[PairFile, PairFile, Recording]:
    """What is known of a pair that swings, all of it, and its run-up without load."""
    known = rough((12, 16))
    swinging = {"resonance": _resonance(known), "speed_rpm": 2500.0}
    true = known.model_copy(update={"pair": known.pair.model_copy(update=swinging)})
    rng = np.random.default_rng(3)
    time = np.arange(12_000) * 1e-4 + rng.uniform(0.0, 2e-5, 12_000)
    theta_1 = SPEEDS[0] * time + 0.5 * (SPEEDS[1] - SPEEDS[0]) / time[-1] * time**2
    return known, true, recorded_at(true, theta_1, time, rng)


def slow(true: PairFile) -> Recording:
    """The same pair at 10 rad/s, where only the edges at which teeth hand over swing."""
    time = np.arange(8_000) * 8e-4
    return recorded_at(true, 10.0 * time, time, np.random.default_rng(4))


def recorded_at(true: PairFile, theta_1: FloatArray, time: FloatArray, rng: np.random.Generator) -> Recording:
    made = assemble(true, path=Path("true.toml"), seed=0)
    theta_2 = made.pair.ratio * theta_1
    speed = float(np.ptp(theta_1) / np.ptp(time))
    te = te_of(made, theta_2, flank="drive", torque_nm=0.0)
    te = te + made.under(Condition(flank="drive", torque=0.0, speed=speed)).further_te(theta_2, te, time=time)
    te = te + rng.normal(0.0, NOISE_UM * UM, time.size) / made.pair.r_b2
    return Recording(
        source=Path(f"{speed:.0f}.csv"), time_s=time, driving_angle_rad=(theta_2 - te) / made.pair.ratio,
        driven_angle_rad=theta_2, torque_nm=0.0, driving_zero_rad=0.0, driven_zero_rad=0.0,
    )  # fmt: skip


@pytest.mark.slow
def test_what_is_held_out_of_a_run_up_lies_between_what_is_seen(run_up: tuple[PairFile, PairFile, Recording]) -> None:
    """It meets each speed once, so half of it says nothing of a resonance in the other half: every other turn does."""
    known, _, recording = run_up
    path = Path("pair.toml")
    (observed,) = prepare(known, compare(known, [recording], path=path), path=path).observed
    assert observed.samples.time is not None
    speed = np.gradient(observed.samples.theta_1, observed.samples.time)
    turns = np.ptp(observed.samples.theta_1) / (2.0 * math.pi)
    assert np.count_nonzero(np.diff(observed.fit.astype(int))) == pytest.approx(turns, abs=2.0)
    for part in (observed.fit, ~observed.fit):
        quarters = np.quantile(speed[part], (0.25, 0.5, 0.75)) / np.quantile(speed, (0.25, 0.5, 0.75))
        # From a turn of the slow quarter to the next the speed grows by a twentieth.
        assert quarters == pytest.approx(1.0, abs=0.05)


def _resonance(file: PairFile) -> object:
    kind = type(file.pair).model_fields["resonance"].annotation
    made = next(one for one in getattr(kind, "__args__", (kind,)) if one is not type(None))
    return made(frequency_hz=HZ, damping_ratio=DAMPING)


@pytest.mark.slow
def test_a_declared_resonance_leaves_noise_of_a_run_up(run_up: tuple[PairFile, PairFile, Recording]) -> None:
    """At one mean speed it would leave what the pair swings by, many times the noise."""
    known, true, recording = run_up
    aligned = [compare(one, [recording], path="pair.toml").aligned[0] for one in (true, known)]
    with_, without = (one.rms / UM for one in aligned)
    assert aligned[0].theta_2.size == recording.size
    assert with_ < 1.1 * NOISE_UM
    assert without > 5.0 * NOISE_UM


@pytest.mark.slow
def test_a_run_up_beside_a_slow_recording_names_the_resonance(run_up: tuple[PairFile, PairFile, Recording]) -> None:
    """The slow one lays both on the mesh, of whose curve a swing makes another."""
    known, true, recording = run_up
    found = diagnose(known, [slow(true), recording], path="pair.toml")
    (one,) = found.findings
    assert one.claim.physics.name == "mesh_resonance"
    for name, wanted in (("frequency_hz", HZ), ("damping_ratio", DAMPING)):
        value, std = one.parameters[name]
        assert abs(value - wanted) < 3.0 * std
    assert math.isclose(found.after.unseen / UM, NOISE_UM, rel_tol=0.1)
