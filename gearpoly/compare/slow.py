"""Slow curves over a recording: drift, which is no noise of the kind that an autoregressive model whitens."""

from __future__ import annotations

import numpy as np

from gearpoly.compare.pieces import pieces
from gearpoly.compare.spectrum import Repeating
from gearpoly.units import FloatArray

SLOW = 4
"""Terms of the slow curve (mean, ramp, bow, S) that is taken off first: drift, which is no noise of this kind."""


FINE_TERMS = 12
"""Polynomials among the slow curves where a cubic is not enough: warming up is no cubic, but five waves in a record it
does not make. They leave a third of a jump that is told from a cubic."""

SETTLES = (1.0 / 20.0, 1.0 / 60.0)
"""Parts of a recording in which what settles at its beginning falls to 1/e, one curve each beside ``FINE_TERMS``. 10 um
that settled in a sixteenth left 0.4 um for 0.3 um of noise beside twelve polynomials."""

ALL_TERMS = FINE_TERMS + len(SETTLES)
"""All slow curves together."""


def slow_curves(x: FloatArray, terms: int = SLOW, *, span: tuple[float, float] | None = None) -> FloatArray:
    """Legendre polynomials (n, terms) over the span of ``x`` (n,), or over ``span`` (low, high) of which ``x`` is a
    part; of more than ``FINE_TERMS`` terms the last ones settle at the beginning."""
    low, high = (float(np.min(x)), float(np.max(x))) if span is None else span
    along = (2.0 * x - low - high) / max(high - low, 1e-300)
    curves = np.polynomial.legendre.legvander(along, min(terms, FINE_TERMS) - 1)
    settles = [np.exp(-0.5 * (along + 1.0) / part) for part in SETTLES[: max(0, terms - FINE_TERMS)]]
    return np.column_stack((curves, *settles)) if settles else np.asarray(curves, dtype=np.float64)


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
