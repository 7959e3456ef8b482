"""Least squares in coloured noise with what is known beforehand: one fit over all recordings of a set.

Every column is whitened with its recording's noise; parameters may be common to several recordings and may have a
Gaussian prior about zero. The normal matrix depends on the sampling only, so in long records it is taken from blocks
spread over the record, while the gradient always comes from every sample.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from gearpoly.compare.columns import Part
from gearpoly.compare.noise import Noise
from gearpoly.compare.spectrum import ComplexArray
from gearpoly.units import FloatArray, IntArray

BLOCK = 8192
"""Rows of a dense block: some MB for some hundred columns."""

DENSE_SAMPLES = 65536
"""Samples from which the normal matrix is taken. More would change it by less than 1/2 % (their sampling is random);
the steps below make up for it."""

WAVE_SAMPLES = 32768
"""The same for products with waves, of which there are hundreds."""

STEPS = 4
"""Newton steps at most where the matrix is approximate; each removes 99 % of what is left."""


@dataclass
class Stack:
    """One recording in the fit: ``values`` (n,) in mm, its ``noise``, and ``parts`` with the places (m,) of their
    columns among all parameters."""

    values: FloatArray
    noise: Noise
    parts: list[tuple[Part, IntArray]] = field(default_factory=list)

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

    def normal(self, parameters: int) -> FloatArray:
        """Normal matrix of the whitened columns."""
        n = self.values.size
        memory = self.noise.ar.size
        starts = np.arange(0, n, BLOCK)
        if n > DENSE_SAMPLES:
            starts = starts[np.linspace(0, starts.size - 2, DENSE_SAMPLES // BLOCK).astype(int)]
        places = np.concatenate([where for _, where in self.parts])
        out = np.zeros((places.size, places.size))
        rows = 0
        for start in starts:
            low, high = max(0, int(start) - memory), min(n, int(start) + BLOCK)
            block = np.concatenate([part.block(low, high) for part, _ in self.parts], axis=1)
            white = self.noise.whitened(block)[memory:]
            out += white.T @ white
            rows += white.shape[0]
        out *= (n - memory) / max(rows, 1)
        full = np.zeros((parameters, parameters))
        np.add.at(full, (places[:, None], places[None, :]), out)
        return full

    def against(
        self, waves: Callable[[int, int], ComplexArray], gain: ComplexArray, parameters: int
    ) -> tuple[FloatArray, FloatArray]:
        """Products of the whitened columns with whitened ``waves``, and the waves' own.

        ``waves`` gives rows low ... high - 1 of exp(2 pi i f x), (rows, k); a wave comes through the whitening as
        itself times ``gain`` (k,). Returns (parameters, k, 2), cosine and sine, and (k, 2, 2).
        """
        n, memory = self.values.size, self.noise.ar.size
        starts = np.arange(0, n, BLOCK)
        if n > WAVE_SAMPLES:
            starts = starts[np.linspace(0, starts.size - 2, WAVE_SAMPLES // BLOCK).astype(int)]
        places = np.concatenate([where for _, where in self.parts])
        cross = np.zeros((places.size, gain.size), dtype=np.complex128)
        square = np.zeros(gain.size, dtype=np.complex128)
        rows = 0
        for start in starts:
            low, high = max(0, int(start) - memory), min(n, int(start) + BLOCK)
            white = self.noise.whitened(np.concatenate([p.block(low, high) for p, _ in self.parts], axis=1))[memory:]
            wave = waves(low + memory, high)
            cross.real += white.T @ wave.real
            cross.imag += white.T @ wave.imag
            square += np.einsum("ij,ij->j", wave, wave)
            rows += wave.shape[0]
        scale = (n - memory) / max(rows, 1)
        cross *= gain * scale
        square *= gain**2
        # cos^2 = (1 + cos 2x)/2 and so on: the squared wave holds all three products.
        size = np.abs(gain) ** 2 * rows
        own = np.empty((gain.size, 2, 2))
        own[:, 0, 0] = 0.5 * (size + square.real) * scale
        own[:, 1, 1] = 0.5 * (size - square.real) * scale
        own[:, 0, 1] = own[:, 1, 0] = 0.5 * square.imag * scale
        full = np.zeros((parameters, gain.size, 2))
        np.add.at(full, places, np.stack([cross.real, cross.imag], axis=2))
        return full, own


@dataclass(frozen=True, kw_only=True, eq=False)
class Solution:
    """``beta`` (m,) and its ``covariance`` (m, m); ``left`` what the model leaves of each recording, in mm;
    ``misfit`` twice the negative log of likelihood times prior, but for a constant."""

    beta: FloatArray
    covariance: FloatArray
    left: list[FloatArray]
    misfit: float


def solve(stacks: list[Stack], *, precision: FloatArray) -> Solution:
    """The most likely parameters under prior ``precision`` (m,) in 1/mm^2 about zero (0: nothing known).

    Directions that neither data nor prior fix stay at zero, by a precision a billionth of the largest information.
    """
    m = precision.size
    normal = np.diag(precision).astype(np.float64)
    for stack in stacks:
        normal += stack.normal(m)
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
    for _ in range(2 if exact else STEPS):
        gradient = -precision * beta
        for stack, rest in zip(stacks, left, strict=True):
            gradient = gradient + stack.gradient(rest, m)
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
