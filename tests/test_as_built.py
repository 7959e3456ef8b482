"""What a grade leaves open of every tooth, against gears drawn within it."""

from __future__ import annotations

import numpy as np
import pytest

from gearpoly.assemble import stated_limits
from gearpoly.diagnose.as_built import (
    GRADE_LIMIT_SIGMAS,
    IDEAL_TEETH_STD_UM,
    GearPrior,
    chain,
    make_as_built,
    on_its_own,
)
from gearpoly.diagnose.prepare import MEAN_SLOPE_PART, graded_prior
from gearpoly.files.models import GearSection
from gearpoly.gear.chain import closed_chain
from gearpoly.gear.nominal import nominal_gear
from gearpoly.units import UM


@pytest.mark.parametrize(
    ("z", "single", "cumulative"),
    [(17, 6.5, 19.0), *(pytest.param(*one, marks=pytest.mark.slow) for one in ((25, 6.0, 17.0), (45, 5.0, 15.0)))],
)
def test_waves_of_a_graded_gear_are_those_of_gears_drawn_within_its_limits(
    z: int, single: float, cumulative: float
) -> None:
    """Power of every order, over 200 gears: their own scatter of its root is 3.5 %, the formula's 8 %."""
    rng = np.random.default_rng(z)
    drawn = np.array([closed_chain(z, f=single, F=cumulative, rng=rng) for _ in range(200)])
    measured = np.mean(np.abs(np.fft.rfft(drawn, axis=1)[:, 1:]) ** 2, axis=0) / z
    stated = np.fft.rfft(chain(z, single=single, cumulative=cumulative)[0]).real[1:]
    assert np.sqrt(measured) == pytest.approx(np.sqrt(stated), rel=0.15)


def test_loose_cumulative_limit_leaves_a_free_chain() -> None:
    """Single pitches then have the variance of a uniform one, less what closing the chain takes: 1 in z."""
    z, single = 24, 6.0
    covariance = chain(z, single=single, cumulative=100.0 * single)
    step = 2.0 * (covariance[0, 0] - covariance[0, 1])
    assert step == pytest.approx(single**2 / 3.0 * (1.0 - 1.0 / z), rel=2e-3)


@pytest.mark.parametrize("z", [24, 25])
def test_a_closed_chain_is_alike_at_every_tooth(z: int) -> None:
    """Its waves are eigenvectors, a cosine's power that of a sine, and all teeth as one have their own doubt only."""
    covariance = chain(z, single=8.0, cumulative=30.0)
    np.testing.assert_allclose(covariance, np.roll(covariance, (1, 1), (0, 1)), rtol=0.0, atol=1e-9)
    for order in range(1, z // 2 + 1):
        for wave in (np.cos(2.0 * np.pi * order / z * np.arange(z)), np.sin(2.0 * np.pi * order / z * np.arange(z))):
            power = np.fft.rfft(covariance[0]).real[order]
            np.testing.assert_allclose(covariance @ wave, power * wave, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(covariance.sum(axis=0), IDEAL_TEETH_STD_UM**2, rtol=0.0, atol=1e-9)


def test_a_ring_gear_s_chain_fits_into_memory() -> None:
    """Of 2000 teeth all waves at once would take 32 GB."""
    assert chain(2000, single=20.0, cumulative=150.0).shape == (2000, 2000)


def test_the_mean_slope_of_gears_that_pass_is_a_quarter_of_the_limit() -> None:
    """Means and teeth that scatter alike, half the variance each, two standard deviations of a tooth at the limit: of
    20 000 drawn gears of 12 teeth 70 % pass, whose means scatter by a quarter of the limit; of 45 teeth by a sixth."""
    rng = np.random.default_rng(0)
    each = 1.0 / GRADE_LIMIT_SIGMAS / np.sqrt(2.0)
    found = []
    for z in (12, 45):
        slopes = each * (rng.normal(size=(20_000, 1)) + rng.normal(size=(20_000, z)))
        found.append(np.std(slopes[np.abs(slopes).max(axis=1) <= 1.0].mean(axis=1)))
    assert found[0] == pytest.approx(MEAN_SLOPE_PART, abs=0.01)
    assert found[1] == pytest.approx(0.17, abs=0.01)
    section = GearSection.model_validate({"teeth": 18, "module_mm": 2.0, "face_width_mm": 20.0, "grade": 6})
    gear = nominal_gear(section)
    limit = stated_limits(section, gear, a=36.0).f_HalphaT / UM
    prior = graded_prior(section, (gear, gear), 0)
    assert prior.mean_slope == pytest.approx(MEAN_SLOPE_PART * limit)
    assert prior.slope == pytest.approx(each * limit)


def test_teeth_as_one_are_left_to_the_mean() -> None:
    covariance = chain(25, single=6.0, cumulative=17.0)
    assert float(np.sum(covariance)) / 25.0 == pytest.approx(IDEAL_TEETH_STD_UM**2, rel=1e-6)


def test_gear_of_no_deviation_is_ideal() -> None:
    assert np.sqrt(np.diag(chain(18, single=0.0, cumulative=0.0))) == pytest.approx(IDEAL_TEETH_STD_UM, rel=0.5)


def prior(*, shared: float, own: float) -> GearPrior:
    return GearPrior(
        z=5, pitch=on_its_own(5, 0.5), slope=0.4, mean_slope=0.0, crowning=0.1, thickness=0.3,
        shared=(shared, shared), own=(own, own), graded=False,
    )  # fmt: skip


def test_a_reading_error_of_the_drive_flank_stands_on_the_coast_flank_too() -> None:
    """A tooth read ahead has more material on its drive flank and less on its coast flank; a slope is the same on both.
    What nobody measured may differ by as much again."""
    made = make_as_built((prior(shared=1.0, own=1.0),) * 2, ["coast", "drive"])
    covariance = np.linalg.inv(made.precision)
    drive, coast = made.start("drive", 1), made.start("coast", 1)
    assert covariance[drive, drive] == pytest.approx(0.25)
    assert covariance[drive, coast] == pytest.approx(-0.25)
    # All coast flanks stand off by what the thickness does.
    assert covariance[coast, coast] == pytest.approx(2 * 0.25 + 0.09)
    assert covariance[coast, coast + 1] == pytest.approx(0.09)
    assert covariance[drive + 5, coast + 5] == pytest.approx(0.16)
    assert covariance[drive + 10, coast + 10] == pytest.approx(0.01)
    other = made.start("drive", 0)
    assert covariance[drive, other] == pytest.approx(0.0, abs=1e-12)


def test_measured_flanks_err_each_by_itself() -> None:
    made = make_as_built((prior(shared=0.0, own=0.0),) * 2, ["drive", "coast"])
    covariance = np.linalg.inv(made.precision)
    assert covariance[made.start("drive", 0), made.start("coast", 0)] == pytest.approx(0.0, abs=1e-12)
    alone = make_as_built((prior(shared=0.0, own=0.0),) * 2, ["drive"])
    assert alone.size == 2 * 11
    assert np.linalg.inv(alone.precision)[0, 0] == pytest.approx(0.25)


def test_a_tooth_that_leans_as_none_of_its_fellows_does_is_set_upright() -> None:
    """Teeth that lean alike are left as they are, by how much ever; so is the other gear."""
    made = make_as_built((prior(shared=0.0, own=0.0),) * 2, ["drive"])
    values = np.zeros(made.size)
    for gear in (0, 1):
        made.slope(values, "drive", gear)[:] = [2.1, 1.9, 9.0, 2.0, 2.2]
        made.pitch(values, "drive", gear)[:] = [1.0, -1.0, 5.0, 0.0, 0.5]
    out = made.upright(values, [0])
    np.testing.assert_allclose(made.slope(out, "drive", 0), [2.1, 1.9, 2.1, 2.0, 2.2])
    np.testing.assert_array_equal(made.pitch(out, "drive", 0), made.pitch(values, "drive", 0))
    np.testing.assert_array_equal(made.slope(out, "drive", 1), made.slope(values, "drive", 1))
    np.testing.assert_array_equal(made.upright(out, [0]), out)


def test_an_opened_tooth_is_as_doubtful_as_stated_and_its_fellows_as_they_were() -> None:
    """Covariances add: of pitch and slope of one tooth alone, whatever it has in common with others."""
    made = make_as_built((prior(shared=1.0, own=1.0),) * 2, ["coast", "drive"])
    at = made.at_tooth("coast", 1, 2)
    np.testing.assert_array_equal(made.pitch(np.arange(made.size), "coast", 1)[2], at[0])
    np.testing.assert_array_equal(made.slope(np.arange(made.size), "coast", 1)[2], at[1])
    before = np.linalg.inv(made.precision)
    np.testing.assert_allclose(made.known(at), before[np.ix_(at, at)], rtol=1e-9)
    more = np.zeros_like(before)
    more[at, at] = 30.0**2
    np.testing.assert_allclose(np.linalg.inv(made.opened(at, 30.0).precision), before + more, rtol=1e-6, atol=1e-6)
