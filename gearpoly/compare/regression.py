"""Least squares in coloured noise with what is known beforehand: one fit over all recordings of a set.

Every column is whitened with its recording's noise; parameters may be common to several recordings and may have a
Gaussian prior about zero. The normal matrix depends on the sampling only, so in long records it is taken from blocks
spread over the record, while the gradient always comes from every sample.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from gearpoly.compare.columns import SomeColumns
from gearpoly.compare.noise import Noise
from gearpoly.compare.pieces import pieces
from gearpoly.compare.spectrum import ComplexArray, FrequencyGrid
from gearpoly.threads import each
from gearpoly.units import BoolArray, FloatArray, IntArray

ROWS_PER_STRETCH = 8192
"""Rows of a stretch from which normal matrices are taken."""

ROWS_PER_DENSE_BLOCK = 1024
"""Rows of a dense block: a MB for some hundred columns."""

DENSE_SAMPLES = 65536
"""Samples from which the normal matrix is taken. More would change it by less than 1/2 % (their sampling is random);
the steps below make up for it."""

WHITENING_PART_OF_ROWS = 0.5
"""Part of the rows below which whitening those that changed costs less than whitening all."""

MOST_MEMORY = 64
"""Samples at the beginning of a recording that a noise model may ask for before it whitens."""

REFINING_STEPS = 4
"""Newton steps at most where the matrix is approximate; each removes 99 % of what is left."""


@dataclass
class Stack:
    """One recording in the fit: ``values`` (n,) in mm, its ``noise``, and ``parts`` with the places (m,) of their
    columns among all parameters. ``white`` (rows, m), the whitened columns, and ``square`` (m, m), their products, are
    left by ``normal``."""

    values: FloatArray
    noise: Noise
    parts: list[tuple[SomeColumns, IntArray]] = field(default_factory=list)
    white: FloatArray = field(default_factory=lambda: np.empty((0, 0)), repr=False)
    square: FloatArray = field(default_factory=lambda: np.empty((0, 0)), repr=False)

    def apply(self, beta: FloatArray) -> FloatArray:
        """Modelled values (n,)."""
        out = np.zeros(self.values.size)
        for part, places in self.parts:
            if np.any(beta[places]):
                out += part.apply(beta[places])
        return out

    def gradient(self, left: FloatArray, parameters: int) -> FloatArray:
        """Scores (parameters,) of what is left, (n,) in mm."""
        score = self.noise.score(self.noise.whitened(left))
        out = np.zeros(parameters)
        for part, places in self.parts:
            np.add.at(out, places, part.adjoint(score))
        return out

    def normal(self, parameters: int, *, before: Stack | None = None) -> FloatArray:
        """Normal matrix of the whitened columns. ``before``: the same with columns that differ at some samples only,
        which gives up what it has whitened."""
        places = np.concatenate([where for _, where in self.parts])
        rows = None if before is None else self._changed(before)
        if before is None or rows is None:
            self._whiten(places.size)
            self.square = self.white.T @ self.white * (self.values.size / self.white.shape[0])
        else:
            self._whiten_again(before, rows)
        full = np.zeros((parameters, parameters))
        np.add.at(full, (places[:, None], places[None, :]), self.square)
        return full

    def _whiten(self, size: int) -> None:
        """Whiten all columns, ``size`` of them."""
        n, memory = self.values.size, self.noise.ar.size
        seen = stretches(n)
        self.white = np.empty((sum(high - start for start, high in seen), size))
        block = np.empty((ROWS_PER_DENSE_BLOCK + memory, size))
        at = 0
        for start, high in seen:
            for here in pieces(high - start, size=ROWS_PER_DENSE_BLOCK):
                first, end = start + here.start, start + here.stop
                low = max(0, first - memory)
                column = 0
                for part, where in self.parts:
                    block[: end - low, column : column + where.size] = part.rows(slice(low, end))
                    column += where.size
                # Rows without a past come out as 0: at the very beginning they stay, elsewhere they are rows before.
                self.white[at : at + end - first] = self.noise.whitened(block[: end - low])[first - low :]
                at += end - first

    def _changed(self, before: Stack) -> IntArray | None:
        """Rows whose whitened columns differ from those ``before``; ``None`` where that is of no help."""
        if self.noise is not before.noise or len(before.white) != self.values.size:
            return None
        if [where.tolist() for _, where in self.parts] != [where.tolist() for _, where in before.parts]:
            return None
        pairs = zip(self.parts, before.parts, strict=True)
        changed = np.any([part.changed(other) for (part, _), (other, _) in pairs], axis=0)
        rows = _spread(changed, self.noise.ar.size)
        rows[: self.noise.ar.size] = False
        return np.flatnonzero(rows) if np.count_nonzero(rows) < WHITENING_PART_OF_ROWS * rows.size else None

    def _whiten_again(self, before: Stack, rows: IntArray) -> None:
        """Whiten the columns at ``rows``, and take the others from ``before``."""
        needed = np.zeros(self.values.size, dtype=np.bool_)
        needed[rows] = True
        needed = _spread(needed[::-1], self.noise.ar.size)[::-1]
        at = np.cumsum(needed) - 1
        raw = np.concatenate([part.rows(np.flatnonzero(needed)) for part, _ in self.parts], axis=1)
        new = raw[at[rows]]
        for k, a in enumerate(self.noise.ar, start=1):
            new -= a * raw[at[rows - k]]
        new /= self.noise.innovation
        old = before.white[rows]
        self.square = before.square + new.T @ new - old.T @ old
        self.white, before.white = before.white, self.white
        self.white[rows] = new

    def against(self, waves: WaveSums, gain: ComplexArray) -> tuple[IntArray, FloatArray, FloatArray]:
        """Products of the whitened columns, as ``normal`` left them, with whitened ``waves``, and the waves' own.

        A wave comes through the whitening as itself times ``gain`` (k,). Both products come from the samples of the
        normal matrix: teeth imitate the first orders of their shaft to a thousandth, and what is left has to be right.
        Returns the parameters (m,) of the columns, (m, k, 2), cosine and sine, and (k, 2, 2).
        """
        places = np.concatenate([where for _, where in self.parts])
        cross = waves.of(self.white).T * (gain * waves.scale)
        rows, square = waves.own(self.noise.ar.size)
        # cos^2 = (1 + cos 2x)/2 and so on: the squared wave holds all three products.
        size, square = np.abs(gain) ** 2 * rows, square * gain**2
        own = np.empty((gain.size, 2, 2))
        own[:, 0, 0] = 0.5 * (size + square.real) * waves.scale
        own[:, 1, 1] = 0.5 * (size - square.real) * waves.scale
        own[:, 0, 1] = own[:, 1, 0] = 0.5 * square.imag * waves.scale
        return places, np.stack([cross.real, cross.imag], axis=2), own


def _spread(rows: BoolArray, memory: int) -> BoolArray:
    """``rows`` (n,) and up to ``memory`` that follow each."""
    out = rows.copy()
    for k in range(1, memory + 1):
        out[k:] |= rows[:-k]
    return out


def stretches(n: int) -> list[tuple[int, int]]:
    """Blocks [start, end) of ``n`` samples from which normal matrices are taken: all, or some spread over them."""
    starts = np.arange(0, n, ROWS_PER_STRETCH)
    if n > DENSE_SAMPLES:
        starts = starts[np.linspace(0, starts.size - 2, DENSE_SAMPLES // ROWS_PER_STRETCH).astype(int)]
    return [(start, min(n, start + ROWS_PER_STRETCH)) for start in starts.tolist()]


class WaveSums:
    """Sums of columns times exp(2 pi i f x) for waves of known frequency over the stretches of a recording; the waves'
    products with one another are the same for every fit.

    ``x`` (n,); frequencies ``place`` (k,) times ``step``; ``scale`` of the whole recording over the stretches.
    """

    def __init__(self, x: FloatArray, *, step: float, place: IntArray) -> None:
        seen = np.concatenate([x[low:high] for low, high in stretches(x.size)])
        self._rows = seen.size
        self.scale = x.size / seen.size
        self._place, self._step = place, step
        self._first = seen[:MOST_MEMORY]
        top = int(place.max(initial=0)) + 1
        self._grid = FrequencyGrid(seen, step=step, count=top)
        # Twice the frequency: exp(-2 pi i 2 f x) is the conjugate of the wave's square.
        self._square = np.conj(FrequencyGrid(seen, step=2.0 * step, count=top).transform(np.ones(seen.size))[place])

    def of(self, columns: FloatArray) -> ComplexArray:
        """Sums (k, m) of ``columns`` (rows, m) times exp(2 pi i f x)."""
        return np.conj(self._grid.transforms(columns, at=self._place))

    def own(self, memory: int) -> tuple[int, ComplexArray]:
        """Rows, and sums (k,) of exp(2 pi i 2 f x) over them, without the first ``memory`` of the recording."""
        first = np.exp((4j * np.pi * self._step) * np.outer(self._place, self._first[:memory]))
        return self._rows - memory, self._square - np.sum(first, axis=1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Solution:
    """``beta`` (m,) and its ``covariance`` (m, m); ``left`` what the model leaves of each recording, in mm;
    ``misfit`` twice the negative log of likelihood times prior, but for a constant."""

    beta: FloatArray
    covariance: FloatArray
    left: list[FloatArray]
    misfit: float


def solve(stacks: list[Stack], *, precision: FloatArray, before: list[Stack] | None = None) -> Solution:
    """The most likely parameters under prior ``precision`` (m,) in 1/mm^2 about zero (0: nothing known).

    ``before``: the stacks of a fit just made, whose columns may be much the same; they are used up. Directions that
    neither data nor prior fix stay at zero, by a precision a billionth of the largest information.
    """
    m = precision.size
    befores: list[Stack | None] = [None] * len(stacks) if before is None else list(before)
    own = each(lambda pair: pair[0].normal(m, before=pair[1]), zip(stacks, befores, strict=True))
    normal = sum(own, np.diag(precision).astype(np.float64))
    # A column that no sample meets (a tooth's shape beyond its contact) stays at zero, as wide as a tooth.
    empty = np.diag(normal) == 0.0
    normal[empty, empty] = 1.0
    scale = np.sqrt(np.diag(normal))
    scaled = normal / np.outer(scale, scale)
    # Two gears share their mean pitch, and a wave may repeat a tooth's shape: without a floor the factor would fail.
    scaled[np.diag_indices(m)] += 1e-9
    factor = cho_factor(scaled)
    beta = np.zeros(m)
    left = [stack.values for stack in stacks]
    exact = all(stack.values.size <= DENSE_SAMPLES for stack in stacks)
    for _ in range(2 if exact else REFINING_STEPS):
        pulls = each(lambda pair: pair[0].gradient(pair[1], m), zip(stacks, left, strict=True))
        gradient = sum(pulls, -precision * beta)
        step = cho_solve(factor, gradient / scale) / scale
        beta = beta + step
        left = [stack.values - stack.apply(beta) for stack in stacks]
        if np.max(np.abs(step * scale)) < 1e-3:
            break
    covariance = cho_solve(factor, np.eye(m)) / np.outer(scale, scale)
    misfit = float(precision @ beta**2)
    for stack, rest in zip(stacks, left, strict=True):
        misfit += float(np.sum(stack.noise.whitened(rest) ** 2))
    return Solution(beta=beta, covariance=covariance, left=left, misfit=misfit)
