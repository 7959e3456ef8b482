"""The evidence of columns, their posterior, bounds and scales, against quadrature of the same integrals."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import chi2, norm

from gearpoly.infer.chance import log_tail
from gearpoly.infer.evidence import log_bayes_factor, log_mean, log_truncated, normalised, posterior
from gearpoly.infer.posterior import Explanation, Posterior, Sized, weighed
from gearpoly.infer.prior import PRESENT, SCALE_WEIGHTS, SCALES
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place

# Quadrature is exact to 1e-9 relative; what is compared are logarithms of its results.
TO = 1e-6


@pytest.mark.parametrize("freedoms", [1, 3, 40])
def test_the_chance_of_a_sum_of_squares_is_that_of_its_density_beyond(freedoms: int) -> None:
    beyond = quad(lambda x: chi2.pdf(x, freedoms), 50.0, 500.0, epsabs=0.0)[0]
    assert log_tail(50.0, freedoms) == pytest.approx(math.log(beyond), abs=TO)
    assert log_tail(0.0, freedoms) == 0.0
    assert log_tail(5000.0, freedoms) == -math.inf


def test_one_size_is_integrated_as_by_quadrature() -> None:
    """log int N(x; 0, s) exp(score x - I x^2 / 2) dx."""
    score, information, s = 3.0, 2.5, 1.7
    whole = quad(lambda x: norm.pdf(x, scale=s) * math.exp(score * x - 0.5 * information * x**2), -20, 20)[0]
    got = log_bayes_factor(np.array([score]), np.array([[information]]), std=np.array([s]))
    assert got == pytest.approx(math.log(whole), abs=TO)


def test_two_sizes_that_lean_on_each_other_are_integrated_as_by_quadrature() -> None:
    score, information, std = np.array([1.0, -2.0]), np.array([[2.0, 1.1], [1.1, 1.5]]), np.array([0.8, 2.0])

    # Even steps far finer than what is smooth, and whole beyond both ends, are exact to rounding.
    x, y = np.linspace(-8.0, 8.0, 321), np.linspace(-12.0, 12.0, 321)
    b = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    prior = norm.pdf(b[..., 0], scale=std[0]) * norm.pdf(b[..., 1], scale=std[1])
    densities = prior * np.exp(b @ score - 0.5 * np.einsum("...i,ij,...j", b, information, b))
    whole = float(np.sum(densities)) * (x[1] - x[0]) * (y[1] - y[0])
    assert log_bayes_factor(score, information, std=std) == pytest.approx(math.log(whole), abs=TO)


def test_bounds_are_integrated_as_by_quadrature() -> None:
    """A pit has no negative depth: the prior is cut at 0 and normalised again."""
    information, s = np.array([[1.9]]), 2.0
    for score in (-6.0, 0.5, 8.0):
        cut = quad(_half_normal_times, 0, 40, args=(score, 1.9, s))[0]
        mean, covariance = posterior(np.array([score]), information, std=np.array([s]))
        got = log_bayes_factor(np.array([score]), information, std=np.array([s])) + log_truncated(
            float(mean[0]), math.sqrt(covariance[0, 0]), prior=s, bounds=(0.0, math.inf)
        )
        assert got == pytest.approx(math.log(cut), abs=TO)


def _half_normal_times(x: float, score: float, information: float, s: float) -> float:
    return float(2.0 * norm.pdf(x, scale=s) * math.exp(score * x - 0.5 * information * x**2))


def test_bounds_far_from_the_data_keep_their_digits() -> None:
    """Forty standard errors on the wrong side: log of the tail is -800, no minus infinity."""
    assert log_truncated(-40.0, 1.0, prior=1.0, bounds=(0.0, math.inf)) == pytest.approx(
        float(norm.logsf(40.0)) - math.log(0.5), rel=1e-9
    )


def test_posterior_of_one_size_is_that_of_two_readings() -> None:
    """A prior N(0, s) is a reading of 0 with error s."""
    mean, covariance = posterior(np.array([3.0]), np.array([[2.0]]), std=np.array([0.5]))
    assert covariance[0, 0] == pytest.approx(1.0 / (2.0 + 4.0))
    assert mean[0] == pytest.approx(3.0 / 6.0)


def test_a_parameter_that_data_do_not_tell_costs_nothing() -> None:
    """Its posterior is its prior, whatever the prior is."""
    for s in (1e-3, 1.0, 1e3):
        got = log_bayes_factor(np.array([0.0]), np.array([[0.0]]), std=np.array([s]))
        assert got == pytest.approx(0.0, abs=1e-12)


def test_evidence_does_not_depend_on_units() -> None:
    score, information, std = np.array([4.0, 1.0]), np.array([[3.0, 0.4], [0.4, 1.0]]), np.array([1.0, 2.0])
    by = np.array([1e3, 1e-6])
    changed = log_bayes_factor(score / by, information / np.outer(by, by), std=std * by)
    assert changed == pytest.approx(log_bayes_factor(score, information, std=std), rel=1e-9)


def test_occams_factor_of_a_size_that_is_well_known() -> None:
    """0.5 ln(1 + I s^2) is what one freedom costs: 0.5 ln N more for N times the data (Schwarz 1978)."""
    cost = [-log_bayes_factor(np.zeros(1), np.array([[n]]), std=np.ones(1)) for n in (1e4, 1e6)]
    assert cost[1] - cost[0] == pytest.approx(0.5 * math.log(100.0), rel=1e-4)


@pytest.mark.long
def test_scales_are_summed_over() -> None:
    assert float(np.sum(SCALE_WEIGHTS)) == pytest.approx(1.0)
    column = [np.eye(1)]
    sized = Sized(columns=column, std=np.ones(1), scaled=1)
    score, information = np.array([5.0]), np.array([[1.0]])
    by_hand = [
        quad(
            lambda x, s=s: norm.pdf(x, scale=s) * math.exp(5.0 * x - 0.5 * x**2), -60.0, 60.0, limit=400, points=[0.0]
        )[0]
        for s in SCALES
    ]
    whole = math.log(float(np.dot(SCALE_WEIGHTS, by_hand)))
    assert sized.log_evidence(lambda _: (score, information)) == pytest.approx(whole, abs=1e-5)
    assert log_mean([0.0, 0.0], weights=np.array([0.25, 0.75])) == pytest.approx(0.0)


def test_probabilities_at_a_place_add_up_and_follow_bayes() -> None:
    assert np.allclose(normalised([0.0, math.log(3.0)]), [0.25, 0.75])
    nothing = weighed([Explanation(claim=None, log_evidence=0.0, weight=1.0)], unknown_share=1.0, places=1)
    assert nothing.nothing == pytest.approx(1.0 / (1.0 + PRESENT))
    assert nothing.unknown + nothing.nothing == pytest.approx(1.0)
    assert not nothing.named


def test_a_place_among_many_needs_more_evidence() -> None:
    """43 teeth: the log odds of one fall by log 43."""
    at = [
        weighed([Explanation(claim=None, log_evidence=6.0, weight=1.0)], unknown_share=1.0, places=z) for z in (1, 43)
    ]
    odds = [math.log(one.unknown / one.nothing) for one in at]
    assert odds[0] - odds[1] == pytest.approx(math.log(43.0))


def test_rounding_of_what_is_told_from_nothing_counts_for_nothing() -> None:
    """Of columns that all else takes whole a little negative information is left, and a score of rounding."""
    information = np.array([[2.0, 0.0], [0.0, -1e-11]])
    plain = log_bayes_factor(np.array([1.0]), np.array([[2.0]]), std=np.array([1e3]))
    got = log_bayes_factor(np.array([1.0, 1e-6]), information, std=np.array([1e3, 1e9]))
    assert got == pytest.approx(plain, abs=1e-3)
    _, covariance = posterior(np.array([1.0, 0.0]), information, std=np.array([1e3, 1e9]))
    assert covariance[1, 1] == pytest.approx(1e18)


def test_another_probability_of_the_unknown_leaves_the_rest_its_shares() -> None:
    """They add up to 1 whatever it was before, also where rounding had left nothing to all others."""
    sure = Posterior(claims=(), unknown=1.0, nothing=1e-30).with_unknown(0.9)
    assert sure.nothing == pytest.approx(0.1)
    even = Posterior(claims=(), unknown=0.5, nothing=0.5).with_unknown(0.2)
    assert (even.unknown, even.nothing) == (0.2, pytest.approx(0.8))
    assert Posterior(claims=(), unknown=1.0, nothing=0.0).with_unknown(1.0).nothing == 0.0


def test_one_physics_of_one_gear_is_one_cause_of_a_place() -> None:
    """Pits on two neighbours do the same where one tooth hands over to the next: that a pit of this gear did it is as
    probable as either together, even where each alone is not worth a word."""
    spall = catalogue()["tooth_spall"]

    def pit(gear: int, tooth: int, depth: float) -> Claim:
        return Claim(physics=spall, place=Place(gear=gear, tooth=tooth), values=(depth, 11.7, 12.5, 0.06))

    step = Claim(physics=catalogue()["tooth_pitch"], place=Place(gear=0, tooth=3, flank="drive"), values=(2.0,))
    claims = (
        (pit(0, 3, 9.0), 0.2),
        (step, 0.3),
        (pit(0, 4, 1.0), 0.15),
        (pit(1, 3, 5.0), 0.006),
        (pit(1, 4, 5.0), 0.006),
    )
    found = Posterior(claims=claims, unknown=0.3, nothing=0.038)
    assert [(one.physics.name, one.place.gear, one.values[0]) for one, _ in found.causes] == [
        ("tooth_spall", 0, 9.0),
        ("tooth_pitch", 0, 2.0),
        ("tooth_spall", 1, 5.0),
    ]
    assert [chance for _, chance in found.causes] == pytest.approx([0.35, 0.3, 0.012])
    assert sum(chance for _, chance in found.causes) + found.unknown + found.nothing == pytest.approx(1.0)
