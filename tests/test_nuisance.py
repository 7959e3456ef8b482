"""What is open of a loaded pair without being physics: how laws differ where eccentric gears turn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.nuisance import (
    DISCREPANCY,
    DISCREPANCY_HARMONICS,
    ONCE_PER_TURN_LAW_PART,
    law_changes,
    make_nuisance,
)
from gearpoly.diagnose.prepare import prepare
from gearpoly.mesh.loaded import SMALL
from gearpoly.physics.eccentricity import Eccentricity
from gearpoly.scene import Scene
from gearpoly.units import UM
from tests.physics_cases import Condition, recorded, rough

OFF = 60.0


def scenes_of(folder: Path, *, off_um: float, torque_nm: float) -> list[Scene]:
    """A drive and a coast recording of a pair whose driving gear is off its axis."""
    file = rough()
    driving = file.driving.model_copy(update={"eccentricity": Eccentricity(amplitude_um=off_um, angle_deg=30.0)})
    file = file.model_copy(update={"driving": driving})
    conditions = (Condition(torque_nm=torque_nm), Condition(torque_nm=torque_nm, flank="coast"))
    recordings = recorded(file, conditions, np.random.default_rng(1), cycles=1.0, per_mesh=8)
    path = folder / "pair.toml"
    return prepare(file, compare(file, recordings, path=path), path=path).scenes()


def columns_beside(scenes: list[Scene]) -> int:
    """Columns beyond those of the same pair without any eccentricity: a mean, a late zero, a scale, two offsets, and
    the curves that no law has."""
    bends = any(scene.bends for scene in scenes)
    return make_nuisance(scenes, shift_std=1e-3, laws=None, scaled=True).discrepancy.start - (5 if bends else 2)


@pytest.mark.long
def test_bending_varies_once_per_turn_by_what_laws_differ(tmp_path: Path) -> None:
    """Cosine and sine of the eccentric shaft on either flank, as large as the eccentricity is in base pitches."""
    scenes = scenes_of(tmp_path, off_um=OFF, torque_nm=20.0)
    made = make_nuisance(scenes, shift_std=1e-3, laws=None, scaled=True)
    assert columns_beside(scenes) == 4
    for k, scene in enumerate(scenes):
        bent = float(np.mean(scene.bending(None) - scene.te))
        size = ONCE_PER_TURN_LAW_PART * OFF * UM / scene.pair.driving.gear.p_b * bent
        turning = made.columns[k][:, : made.discrepancy.start]
        mine, other = turning[:, -4 + 2 * k :][:, :2], turning[:, -2 - 2 * k :][:, :2]
        waves = size * np.column_stack((np.cos(scene.samples.theta_1), np.sin(scene.samples.theta_1)))
        np.testing.assert_allclose(mine, waves, atol=1e-12)
        np.testing.assert_array_equal(other, 0.0)
    np.testing.assert_array_equal(made.std[-4:], 1.0)


@pytest.mark.long
def test_no_law_has_a_part_of_the_deflection_over_the_mesh(tmp_path: Path) -> None:
    """Of either flank a curve of eight harmonics: the squares of all amplitudes beforehand make 3 % of the mean
    deflection in rms, whatever the phase, and nothing of it is in the recordings of the other flank."""
    scenes = scenes_of(tmp_path, off_um=0.0, torque_nm=20.0)
    made = make_nuisance(scenes, shift_std=1e-3, laws=None, scaled=True)
    for k, scene in enumerate(scenes):
        curves = made.columns[k][:, made.discrepancy] * made.std[made.discrepancy]
        bent = abs(float(np.mean(scene.bending(None) - scene.te)))
        # Variance of the sum at each sample, so no average over phases is needed.
        np.testing.assert_allclose(np.sqrt(np.sum(curves**2, axis=1)), DISCREPANCY * bent, rtol=1e-9)
        assert curves.shape[1] == 4 * DISCREPANCY_HARMONICS
        assert np.count_nonzero(np.any(curves != 0.0, axis=0)) == 2 * DISCREPANCY_HARMONICS


@pytest.mark.long
@pytest.mark.parametrize(("off_um", "torque_nm"), [(0.0, 20.0), (OFF, 0.0)])
def test_nothing_varies_without_load_or_eccentricity(off_um: float, torque_nm: float, tmp_path: Path) -> None:
    assert columns_beside(scenes_of(tmp_path, off_um=off_um, torque_nm=torque_nm)) == 0


@pytest.mark.slow
def test_laws_are_compared_where_some_would_bend_the_teeth_too_far(tmp_path: Path) -> None:
    """A twentieth below the bending at which theirs is no longer small, by the declared law: softer ones bend them too
    far as they are. Made to give as much in the mean they need not, and one that differs little stays where it is at a
    light load."""
    torque = 20.0
    light = scenes_of(tmp_path, off_um=0.0, torque_nm=torque)
    usual, scenes = law_changes(light), light
    for _ in range(3):
        bent = max(float(np.max(np.abs(scene.bending(None) - scene.te))) for scene in scenes)
        torque *= 0.95 * SMALL * scenes[0].pair.driving.gear.m / bent
        scenes = scenes_of(tmp_path, off_um=0.0, torque_nm=torque)
    changes = law_changes(scenes)
    assert min(change.ratio for change in changes.values()) < 0.95
    assert len(changes) > len(usual) / 2
    like = "cantilever_published", "palmgren"
    assert changes[like].ratio == pytest.approx(usual[like].ratio, rel=0.01)


@pytest.mark.long
def test_what_wanders_in_some_recordings_opens_the_means_of_all(tmp_path: Path) -> None:
    """A column for each, flat there and nothing elsewhere, as doubtful as the wandering is large; none without."""
    scenes = scenes_of(tmp_path, off_um=0.0, torque_nm=0.0)
    plain = make_nuisance(scenes, shift_std=1e-3, laws=None, scaled=True)
    apart = make_nuisance(scenes, shift_std=1e-3, laws=None, scaled=True, apart=7.0 * UM)
    assert apart.std.size == plain.std.size + len(scenes)
    for k in range(len(scenes)):
        at = 1 + k
        assert apart.std[at] == pytest.approx(7.0 * UM)
        for j, columns in enumerate(apart.columns):
            assert np.all(columns[:, at] == (1.0 if j == k else 0.0))
    assert apart.shift == plain.shift + len(scenes)


@pytest.mark.long
def test_the_rate_of_a_clock_is_open_in_each_recording_where_an_angle_was_made_of_time(tmp_path: Path) -> None:
    """A rate that is off by 0.0015 is a zero that is late by so much of the way from the middle on: nothing there, more
    and more to either end. Nothing in other recordings, and none where encoders were read."""
    scenes = scenes_of(tmp_path, off_um=0.0, torque_nm=0.0)
    plain = make_nuisance(scenes, shift_std=1e-3, laws=None, scaled=True)
    timed = make_nuisance(scenes, shift_std=1e-3, laws=None, scaled=True, timed=True)
    assert plain.rates.start == plain.rates.stop
    assert timed.rates.stop - timed.rates.start == len(scenes) == timed.std.size - plain.std.size
    assert timed.sloping(scenes).columns[0] == pytest.approx(timed.columns[0])
    for k, scene in enumerate(scenes):
        late = scene.samples.theta_2 - np.mean(scene.samples.theta_2)
        zero, mine = (timed.columns[k][:, at] for at in (timed.shift, timed.rates.start + k))
        assert np.any(zero)
        np.testing.assert_allclose(mine, 1.5e-3 * late * zero, rtol=1e-12)
        for j in range(len(scenes)):
            if j != k:
                assert not np.any(timed.columns[j][:, timed.rates.start + k])


@pytest.mark.long
def test_laws_give_alike_on_both_flanks(tmp_path: Path) -> None:
    """The same torque moves the transmission error down on the drive flank and up on the coast flank, so that signed
    means cancel: what makes a law as soft as another is how far teeth give. Flanks mirror each other but for microns of
    pitch, which shift the shares of 20 N.m by a few parts in a hundred."""
    scenes = scenes_of(tmp_path, off_um=0.0, torque_nm=20.0)
    both, drive = law_changes(scenes), law_changes(scenes[:1])
    assert both.keys() == drive.keys()
    for law, change in both.items():
        assert change.ratio == pytest.approx(drive[law].ratio, rel=0.05)
