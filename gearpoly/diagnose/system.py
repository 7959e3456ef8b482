"""The joint fit of all recordings, linear about the present state, in noise made white and with what is known
beforehand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from gearpoly.diagnose.sparse import Sparse
from gearpoly.threads import each
from gearpoly.units import FloatArray, IntArray

Mask = np.ndarray[tuple[int, ...], np.dtype[np.bool_]]

FLOOR = 1e-9
"""Relative precision added to every parameter, so that what neither data nor prior fix stays where it is."""

FIXED = 1e-4
"""Part of what a fit tells a parameter to, to which one is known that is fixed: the misfit is that of a fit without it
to 1e-6, and doubles hold both (a test has it)."""


def scales_of(normal: FloatArray) -> FloatArray:
    """Square roots of the diagonal (m,) of a ``normal`` matrix (m, m), and 1 of a parameter that nothing tells."""
    told = np.diag(normal)
    return np.asarray(np.sqrt(np.where(told > 0.0, told, 1.0)))


@dataclass(frozen=True, kw_only=True, eq=False)
class System:
    """Least squares of ``white`` columns (n_k, m) and ``target`` (n_k,) of every recording k, whitened by its noise,
    under a prior of ``precision`` (m, m) about ``prior`` (m,)."""

    white: list[Sparse]
    target: list[FloatArray]
    precision: FloatArray
    prior: FloatArray

    @property
    def size(self) -> int:
        """Number of parameters."""
        return int(self.precision.shape[0])

    @cached_property
    def normal(self) -> FloatArray:
        """Normal matrix (m, m)."""
        return sum(each(lambda a: a.gram(), self.white), self.precision)

    @cached_property
    def _scaled(self) -> tuple[FloatArray, FloatArray]:
        """Square roots of the normal matrix's diagonal (m,), and the matrix over them, which is never singular."""
        scale = scales_of(self.normal)
        scaled = self.normal / np.outer(scale, scale)
        scaled[np.diag_indices(self.size)] += FLOOR
        return scale, scaled

    @cached_property
    def _factor(self) -> tuple[FloatArray, bool]:
        out: tuple[FloatArray, bool] = cho_factor(self._scaled[1])
        return out

    def solved(self, right: FloatArray) -> FloatArray:
        """Inverse of the normal matrix times ``right`` (m,) or (m, q)."""
        scale, _ = self._scaled
        wide = scale if right.ndim == 1 else scale[:, None]
        out: FloatArray = cho_solve(self._factor, right / wide) / wide
        return out

    @property
    def log_determinant(self) -> float:
        """Natural logarithm of the normal matrix's determinant, of parameters in their units."""
        return 2.0 * float(np.sum(np.log(np.diag(self._factor[0]))) + np.sum(np.log(self._scaled[0])))

    def damped(self, right: FloatArray, more: FloatArray) -> FloatArray:
        """Inverse of the normal matrix times ``right`` (m,), its diagonal enlarged by these parts ``more`` (m,)."""
        scale, scaled = self._scaled
        wider = scaled.copy()
        wider[np.diag_indices(self.size)] += more
        out: FloatArray = cho_solve(cho_factor(wider), right / scale) / scale
        return out

    @cached_property
    def right(self) -> FloatArray:
        """Right-hand side (m,) of the normal equations."""
        out = self.precision @ self.prior
        for a, y in zip(self.white, self.target, strict=True):
            out = out + a.T @ y
        return np.asarray(out)

    @cached_property
    def solution(self) -> FloatArray:
        """The most likely parameters (m,)."""
        return self.solved(self.right)

    @cached_property
    def covariance(self) -> FloatArray:
        """Covariance (m, m) of the parameters."""
        return self.solved(np.eye(self.size))

    @cached_property
    def left(self) -> list[FloatArray]:
        """What the solution leaves of every target, white."""
        return [y - a @ self.solution for a, y in zip(self.white, self.target, strict=True)]

    @cached_property
    def misfit(self) -> float:
        """Twice the negative log of likelihood times prior, but for a constant."""
        return self.strain + sum(float(r @ r) for r in self.left)

    def misfit_at(self, present: FloatArray) -> float:
        """Misfit at a state (m,), whose parameters that are not a number are where they fit best."""
        scale, scaled = self._scaled
        inside = ~np.isnan(present)
        off = ((present - self.solution) * scale)[inside]
        rise = float(off @ scaled[np.ix_(inside, inside)] @ off)
        if not np.all(inside):
            # The Schur complement of the parameters that are free: one factor of their block, and no inverse.
            pull = scaled[np.ix_(~inside, inside)] @ off
            rise -= float(pull @ cho_solve(cho_factor(scaled[np.ix_(~inside, ~inside)]), pull))
        return self.misfit + rise

    @property
    def strain(self) -> float:
        """The part of the misfit by which the solution contradicts what is known beforehand."""
        off = self.solution - self.prior
        return float(off @ self.precision @ off)

    @property
    def samples(self) -> int:
        """Samples of all recordings."""
        return sum(y.size for y in self.target)

    @property
    def beyond(self) -> float:
        """Misfit beyond what noise alone would leave, 0 or more."""
        return max(0.0, self.misfit - self.samples)

    @cached_property
    def whiteness(self) -> float:
        """Mean square of what is left; 1 where noise alone is left."""
        return sum(float(r @ r) for r in self.left) / max(1, sum(r.size for r in self.left))

    def without(self, places: Sequence[int]) -> System:
        """The same without some parameters."""
        keep = np.setdiff1d(np.arange(self.size), np.asarray(places, dtype=np.int64))
        out = System(
            white=[a.only(keep) for a in self.white],
            target=self.target,
            precision=self.precision[np.ix_(keep, keep)],
            prior=self.prior[keep],
        )
        return out._knowing(self.normal[np.ix_(keep, keep)])

    def believing(self, places: slice, known: FloatArray) -> System:
        """The same with the precision ``known`` (k, k) beforehand of some parameters, which nothing ties to others."""
        precision, normal = self.precision.copy(), self.normal.copy()
        precision[places, places] = known
        normal[places, places] += known - self.precision[places, places]
        return System(white=self.white, target=self.target, precision=precision, prior=self.prior)._knowing(normal)

    def fixed_at_zero(self, places: Sequence[int]) -> System:
        """The same with some parameters known to be 0, all others standing where they stood: taken out, those behind
        them would move."""
        at, precision, normal = np.asarray(places, dtype=np.int64), self.precision.copy(), self.normal.copy()
        known = np.diag(normal)[at] / FIXED**2
        precision[at, at] += known
        normal[at, at] += known
        return System(white=self.white, target=self.target, precision=precision, prior=self.prior)._knowing(normal)

    def noisier(self, by: float) -> System:
        """The same with noise ``by`` times as large, in units of the present one: what is known beforehand counts by
        its square more."""
        more = (by**2 - 1.0) * self.precision
        known = self.precision + more
        return System(white=self.white, target=self.target, precision=known, prior=self.prior)._knowing(
            self.normal + more
        )

    def _knowing(self, normal: FloatArray) -> System:
        """The same, its normal matrix given: to multiply columns of all samples again is most of the work."""
        self.__dict__["normal"] = normal
        return self

    def with_columns(self, columns: list[FloatArray]) -> System:
        """The same with further free whitened columns (n_k, q) at the end."""
        q, m = columns[0].shape[1], self.size
        precision = np.zeros((m + q, m + q))
        precision[:m, :m] = self.precision
        out = System(
            white=[a.beside(c) for a, c in zip(self.white, columns, strict=True)],
            target=self.target,
            precision=precision,
            prior=np.concatenate((self.prior, np.zeros(q))),
        )
        if "normal" not in self.__dict__:
            return out
        cross = sum((a.T @ c for a, c in zip(self.white, columns, strict=True)), np.zeros((m, q)))
        own = sum((c.T @ c for c in columns), np.zeros((q, q)))
        return out._knowing(np.block([[self.normal, cross], [cross.T, own]]))

    def at(self, masks: Sequence[Mask]) -> System:
        """The same, seen only at some samples of every recording."""
        return System(
            white=[a.rows(mask) for a, mask in zip(self.white, masks, strict=True)],
            target=[y[mask] for y, mask in zip(self.target, masks, strict=True)],
            precision=self.precision,
            prior=self.prior,
        )

    def of(self, recordings: Sequence[int]) -> System:
        """The same, of some recordings only."""
        return System(
            white=[self.white[k] for k in recordings],
            target=[self.target[k] for k in recordings],
            precision=self.precision,
            prior=self.prior,
        )

    def scores(self, columns: list[FloatArray]) -> tuple[FloatArray, FloatArray]:
        """Score (q,) and information (q, q) of further whitened columns (n_k, q), all else fitted again beside them."""
        parts = zip(columns, self.white, self.left, strict=True)
        return self.beside([Sums(score=c.T @ r, own=c.T @ c, cross=a.T @ c) for c, a, r in parts])

    def beside(self, sums: Sequence[Sums]) -> tuple[FloatArray, FloatArray]:
        """The same from what every recording adds to it."""
        cross = sum((one.cross for one in sums), np.zeros(()))
        own = sum((one.own for one in sums), np.zeros(()))
        return sum((one.score for one in sums), np.zeros(())), own - cross.T @ self.solved(cross)


@dataclass(frozen=True, kw_only=True, eq=False)
class Sums:
    """What one recording says of further columns: their products ``score`` (q,) with what is left, ``own`` (q, q) with
    each other and ``cross`` (m, q) with the present columns, all white."""

    score: FloatArray
    own: FloatArray
    cross: FloatArray


def gain_of(score: FloatArray, information: FloatArray, groups: IntArray) -> tuple[FloatArray, FloatArray]:
    """Gain in misfit of every group of columns (rows of ``groups`` hold column numbers, all of one length), and the
    amplitudes (g, k) that reach it; 0 where the columns are told from nothing."""
    index = groups
    s = score[index]
    block = information[index[:, :, None], index[:, None, :]]
    # Where others took over all that was told, rounding is left, which may be nothing or less: no such block is solved.
    trace = np.trace(block, axis1=1, axis2=2)
    size = np.where(trace > 0.0, trace, 1.0) / index.shape[1]
    block = np.where((trace > 0.0)[:, None, None], block, 0.0)
    safe = block + 1e-9 * size[:, None, None] * np.eye(index.shape[1])
    amplitude = np.linalg.solve(safe, s[:, :, None])[:, :, 0]
    return np.einsum("gk,gk->g", s, amplitude), amplitude
