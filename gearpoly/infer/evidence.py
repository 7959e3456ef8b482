"""The evidence that columns of a linear model are needed, under proper priors.

The model is y = A x + B b + e in white noise e of variance 1, with what is known of x beforehand in the normal matrix
of A. Everything here is stated by the ``score`` B' r (q,) and the ``information`` (q, q) of B beside A: what is left of
both once x has been fitted again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import log_ndtr, logsumexp

from gearpoly.units import FloatArray

Bounds = tuple[float, float]


TOLD_INFORMATION_PART = 1e-11
"""Part of the largest information below which a combination of sizes is told from nothing: what is left of it once all
else is fitted beside is rounding."""


def log_bayes_factor(score: FloatArray, information: FloatArray, *, std: FloatArray) -> float:
    """Log of the evidence with columns over that without, their sizes normal about 0 with standard deviations ``std``
    (q,), no dimension; exact (MacKay 1992, Neural Computation 4, 415)."""
    known, vectors = _told(information, std)
    along = vectors.T @ (std * score)
    return 0.5 * float(np.sum(along**2 / (1.0 + known))) - 0.5 * float(np.sum(np.log1p(known)))


def posterior(score: FloatArray, information: FloatArray, *, std: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Mean (q,) and covariance (q, q) of the sizes, given the data."""
    known, vectors = _told(information, std)
    # What the data do not tell stays as it was believed.
    narrowed = np.eye(std.size) - (vectors * (known / (1.0 + known))) @ vectors.T
    covariance = std[:, None] * narrowed * std
    return std * (vectors @ ((vectors.T @ (std * score)) / (1.0 + known))), covariance


def _told(information: FloatArray, std: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Information (p,) over that of the prior along the directions (q, p), no dimension, of which the data say
    anything."""
    scaled = std[:, None] * information * std
    known, vectors = np.linalg.eigh(0.5 * (scaled + scaled.T))
    told = known > TOLD_INFORMATION_PART * max(float(known[-1]), 0.0)
    return known[told], vectors[:, told]


def log_truncated(mean: float, std: float, *, prior: float, bounds: Bounds) -> float:
    """What bounds on one size add to its log evidence: the log of the part of its posterior (``mean``, ``std``) within
    them, less that of its prior, normal about 0 with standard deviation ``prior``. Exact for one size; of several, the
    others integrated out."""
    return _log_mass(mean, std, bounds) - _log_mass(0.0, prior, bounds)


def _log_mass(mean: float, std: float, bounds: Bounds) -> float:
    """Log of the part of a normal distribution between two bounds."""
    low, high = ((one - mean) / std for one in bounds)
    if low > 0.0:  # both in the upper tail, where differences of 1 lose their digits
        low, high = -high, -low
    top, bottom = float(log_ndtr(high)), float(log_ndtr(low))
    if bottom == -math.inf:
        return top
    return top + math.log1p(-math.exp(min(bottom - top, -1e-300)))


def log_mean(logs: Sequence[float], *, weights: FloatArray) -> float:
    """Log of the mean of evidences given by their ``logs``, with ``weights`` that add up to 1: a scale or a place that
    nobody knows is summed over."""
    return float(logsumexp(np.asarray(logs), b=weights))


def normalised(logs: Sequence[float]) -> FloatArray:
    """Probabilities (q,) of explanations that exclude each other, from their log evidence plus log prior."""
    values = np.asarray(logs, dtype=np.float64)
    return np.asarray(np.exp(values - logsumexp(values)))
