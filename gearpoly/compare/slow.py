"""Slow curves over a recording: drift, which is no noise of the kind that an autoregressive model whitens."""

from __future__ import annotations

import numpy as np

from gearpoly.compare.pieces import pieces
from gearpoly.compare.spectrum import Repeating
from gearpoly.units import FloatArray

SLOW_CURVE_TERMS = 4
"""Terms of the slow curve (mean, ramp, bow, S) that is taken off first: drift, which is no noise of this kind."""


FINE_TERMS = 12
"""Polynomials among the slow curves where a cubic is not enough: warming up is no cubic, but five waves in a record it
does not make. They leave a third of a jump that is told from a cubic."""

SETTLES = (1.0 / 7.0, 1.0 / 20.0, 1.0 / 60.0)
"""Parts of a recording in which what settles at its beginning falls to 1/e, one curve each beside a cubic: what falls
within a fortieth to a tenth lies between two of them, and so does what creeps with the logarithm of time."""

ALL_TERMS = SLOW_CURVE_TERMS + len(SETTLES)
"""A cubic and what settles."""


def slow_curves(x: FloatArray, terms: int = SLOW_CURVE_TERMS, *, span: tuple[float, float] | None = None) -> FloatArray:
    """Legendre polynomials (n, terms) over the span of ``x`` (n,), or over ``span`` (low, high) of which ``x`` is a
    part."""
    low, high = (float(np.min(x)), float(np.max(x))) if span is None else span
    along = (2.0 * x - low - high) / max(high - low, 1e-300)
    return np.asarray(np.polynomial.legendre.legvander(along, terms - 1), dtype=np.float64)


def course_curves(x: FloatArray, terms: int) -> FloatArray:
    """The curves (n, terms) of a slow course over ``x`` (n,), up to ``SLOW_CURVE_TERMS`` or ``ALL_TERMS``: polynomials,
    and what settles at the beginning."""
    along = (x - np.min(x)) / max(float(np.ptp(x)), 1e-300)
    settles = [np.exp(-along / part)[:, None] for part in SETTLES[: max(0, terms - SLOW_CURVE_TERMS)]]
    return np.concatenate((slow_curves(x, min(terms, SLOW_CURVE_TERMS)), *settles), axis=1)


class Slow:
    """Slow curves over samples at ``u`` (n,), fitted beside what repeats and not before it: of a strong order 1 they
    would take a part, and leave it as what does not repeat. What is level repeats."""

    def __init__(self, u: FloatArray, *, repeating: Repeating | None) -> None:
        self._u, self._repeating = u, repeating
        self._span = float(np.min(u)), float(np.max(u))
        first = 0 if repeating is None else 1
        self._first = first
        alone = slow_curves(u)[:, first:]
        if repeating is not None:
            # Curves and what of them repeats, as sums and amplitudes of the harmonics, which are few.
            self._sums = np.stack([repeating.grid.transform(curve) for curve in alone.T])
            self._amplitudes = np.stack([repeating.fitted(sums) for sums in self._sums])
            for curve, amplitudes in zip(alone.T, self._amplitudes, strict=True):
                curve -= repeating.grid.wave(amplitudes)
        self._square = alone.T @ alone

    def _curves(self, here: slice) -> FloatArray:
        return slow_curves(self._u[here], span=self._span)[:, self._first :]

    def parted(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What of ``values`` (n,) is neither slow nor repeats, and what repeats."""
        product = np.sum([self._curves(here).T @ values[here] for here in pieces(values.size)], axis=0)
        if self._repeating is None:
            rest, repeating = values.copy(), np.zeros(1)
        else:
            sums = self._repeating.grid.transform(values)
            product = product - (self._amplitudes @ np.conj(sums)).real
        beta = np.linalg.lstsq(self._square, product, rcond=None)[0]
        if self._repeating is not None:
            repeating = self._repeating.grid.wave(self._repeating.fitted(sums - beta @ self._sums))
            rest = values - repeating
        for here in pieces(values.size):
            rest[here] -= self._curves(here) @ beta
        return rest, repeating
