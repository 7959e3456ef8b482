"""Percentiles, yields and sensitivities with what is not known about them. No distribution is assumed anywhere."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True)
class Interval:
    """An estimate with its confidence interval; an end that the sample cannot place is infinite."""

    value: float
    low: float
    high: float

    @property
    def width(self) -> float:
        """Width of the interval."""
        return self.high - self.low


def percentile(values: FloatArray, p: float, *, confidence: float = 0.95) -> Interval:
    """The ``p``-th percentile (0..100) of the population that ``values`` (n,) were drawn from.

    The interval lies between two order statistics: the number of values below the true percentile is binomial,
    whatever the distribution (Conover, Practical Nonparametric Statistics, 3rd ed., 3.2). The estimate is the median
    unbiased one (Hyndman and Fan 1996, definition 8).
    """
    x = np.sort(np.asarray(values, dtype=np.float64))
    n, q = x.size, p / 100.0
    if n == 0:
        return Interval(value=math.nan, low=-math.inf, high=math.inf)
    from scipy import stats  # slow to import, and workers draw no statistics

    tail = 0.5 * (1.0 - confidence)
    # x[r-1] lies above the percentile with probability P(B <= r-1): the greatest r that keeps it below the tail.
    r = int(stats.binom.ppf(tail, n, q))
    r = r if r > 0 and stats.binom.cdf(r - 1, n, q) <= tail else r - 1
    s = int(stats.binom.ppf(1.0 - tail, n, q)) + 1
    return Interval(
        value=float(np.quantile(x, q, method="median_unbiased")),
        low=float(x[r - 1]) if r >= 1 else -math.inf,
        high=float(x[s - 1]) if s <= n else math.inf,
    )


def mean(values: FloatArray, *, confidence: float = 0.95) -> Interval:
    """The mean with its interval by Student's t."""
    n = values.size
    if n == 0:
        return Interval(value=math.nan, low=-math.inf, high=math.inf)
    centre = float(np.mean(values))
    if n == 1:
        return Interval(value=centre, low=-math.inf, high=math.inf)
    from scipy import stats  # slow to import, and workers draw no statistics

    half = float(stats.t.ppf(0.5 + 0.5 * confidence, n - 1)) * float(np.std(values, ddof=1)) / math.sqrt(n)
    return Interval(value=centre, low=centre - half, high=centre + half)


def share(good: int, n: int, *, confidence: float = 0.95) -> Interval:
    """The share of good ones in the population from ``good`` of ``n``: exact binomial (Clopper and Pearson 1934)."""
    if n == 0:
        return Interval(value=math.nan, low=0.0, high=1.0)
    from scipy import stats  # slow to import, and workers draw no statistics

    tail = 0.5 * (1.0 - confidence)
    low = 0.0 if good == 0 else float(stats.beta.ppf(tail, good, n - good + 1))
    high = 1.0 if good == n else float(stats.beta.ppf(1.0 - tail, good + 1, n - good))
    return Interval(value=good / n, low=low, high=high)


@dataclass(frozen=True, kw_only=True)
class Indices:
    """Sobol indices of one factor: ``first``, the share of the variance that it makes on its own, and ``total``, the
    share that it has a part in."""

    factor: str
    first: Interval
    total: Interval


def factorial_indices(table: FloatArray, factors: list[str], *, resamples: int = 400) -> list[Indices]:
    """Indices from a full table: axis k of ``table`` are the levels of ``factors[k]``, the last one the draws.

    Every level and every draw meets every other, so the variances of conditional means are sums over the table and no
    estimate; the interval comes from drawing the draws again (bootstrap, 95 %). Means over n draws hold 1/n of the
    chance and its interplay, which is taken off (derived here; Sobol 1993 for the indices).
    """
    if table.shape[-1] < 2 or not np.var(table) > 0.0:
        return []
    value = _factorial(table)
    rng = np.random.default_rng(0)  # a report is the same each time it is made
    n = table.shape[-1]
    spread = np.array([_factorial(table[..., rng.integers(n, size=n)]) for _ in range(resamples)])
    low, high = np.nanquantile(spread, (0.025, 0.975), axis=0)
    return [
        Indices(
            factor=name,
            first=Interval(value=value[k, 0], low=low[k, 0], high=high[k, 0]),
            total=Interval(value=value[k, 1], low=low[k, 1], high=high[k, 1]),
        )
        for k, name in enumerate(factors)
    ]


def _factorial(table: FloatArray) -> FloatArray:
    """First and total index (d, 2) of every axis of ``table``."""
    axes = tuple(range(table.ndim))
    n = table.shape[-1]
    whole = float(np.var(table))
    if whole == 0.0:
        return np.full((table.ndim, 2), np.nan)
    centred = table - np.mean(table)
    chance = np.mean(centred, axis=axes[:-1])
    levels = np.mean(centred, axis=-1)
    # Residual interplay of levels and draws: what means over draws still hold of it.
    rest = centred - chance - levels[..., None]
    out = np.empty((table.ndim, 2))
    for k in axes:
        others = tuple(axis for axis in axes if axis != k)
        first = float(np.mean(np.mean(centred, axis=others) ** 2))
        if k != axes[-1]:
            inner = np.mean(rest, axis=tuple(axis for axis in others if axis != axes[-1]))
            first = max(0.0, first - float(np.mean(inner**2)) / max(n - 1, 1))
        total = float(np.mean(np.var(table, axis=k)))
        out[k] = first / whole, total / whole
    return out


def saltelli_indices(blocks: FloatArray, factors: list[str], *, resamples: int = 400) -> list[Indices]:
    """Indices from Sobol points: ``blocks`` (n, d + 2) are the outputs at A, B and A with factor k from B.

    First order after Saltelli et al. 2010, total after Jansen 1999, as scipy.stats.sobol_indices has them; its
    bootstrap gives the intervals (95 %).
    """
    n = blocks.shape[0]
    if n < 2 or not np.var(blocks[:, :2]) > 0.0:
        return []
    from scipy import stats  # slow to import, and workers draw no statistics

    found = stats.sobol_indices(
        func={"f_A": blocks[:, 0][None], "f_B": blocks[:, 1][None], "f_AB": blocks[:, 2:].T[:, None]}, n=n
    )
    rng = np.random.default_rng(0)  # a report is the same each time it is made
    first, total = np.ravel(found.first_order), np.ravel(found.total_order)
    spread = np.empty((resamples, 2, len(factors)))
    for k in range(resamples):
        rows = blocks[rng.integers(n, size=n)]
        again = stats.sobol_indices(
            func={"f_A": rows[:, 0][None], "f_B": rows[:, 1][None], "f_AB": rows[:, 2:].T[:, None]}, n=n
        )
        spread[k] = np.ravel(again.first_order), np.ravel(again.total_order)
    low, high = np.quantile(spread, (0.025, 0.975), axis=0)
    return [
        Indices(
            factor=name,
            first=Interval(value=float(first[k]), low=float(low[0, k]), high=float(high[0, k])),
            total=Interval(value=float(total[k]), low=float(low[1, k]), high=float(high[1, k])),
        )
        for k, name in enumerate(factors)
    ]
