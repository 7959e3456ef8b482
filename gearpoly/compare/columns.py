"""The columns that a residual is made of: slow curves, waves, teeth. Each part knows its product with coefficients and
with samples, so that a million samples never meet a full matrix."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from gearpoly.compare.pieces import pieces
from gearpoly.compare.sharing import Carried
from gearpoly.compare.sinusoids import cosine_and_sine
from gearpoly.units import BoolArray, FloatArray, IntArray

Rows = slice | IntArray
"""Some samples."""


class SomeColumns(Protocol):
    """Some columns over the n samples of one recording."""

    @property
    def size(self) -> int:
        """Number of columns m."""

    def apply(self, beta: FloatArray) -> FloatArray:
        """Columns times ``beta`` (m,): (n,)."""

    def adjoint(self, values: FloatArray) -> FloatArray:
        """Columns' products (m,) with ``values`` (n,)."""

    def rows(self, at: Rows) -> FloatArray:
        """The columns at some samples: (k, m)."""

    def changed(self, before: SomeColumns) -> BoolArray:
        """At which samples (n,) the columns are not those of ``before``."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Dense:
    """Columns held as they are, (n, m)."""

    columns: FloatArray

    @property
    def size(self) -> int:
        return int(self.columns.shape[1])

    def apply(self, beta: FloatArray) -> FloatArray:
        return self.columns @ beta

    def adjoint(self, values: FloatArray) -> FloatArray:
        return self.columns.T @ values

    def rows(self, at: Rows) -> FloatArray:
        return np.asarray(self.columns[at])

    def changed(self, before: SomeColumns) -> BoolArray:
        everywhere = np.ones(len(self.columns), dtype=np.bool_)
        if not isinstance(before, Dense) or self.columns.shape != before.columns.shape:
            return everywhere
        if self.columns is before.columns:
            return ~everywhere
        return np.asarray(np.any(self.columns != before.columns, axis=1))


HELD_VALUES = 2**23
"""Values of cosines and sines that are held, 64 MB: the 40 waves at most of a search fit, over its 40960 samples, twice
over. Of more samples they are made piece by piece at each use. A judgement."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Waves:
    """cos and sin of 2 pi f x for each of ``frequency`` (k,) in cycles per unit of ``x`` (n,); ``held`` the columns
    (n, 2k) where there is room for them."""

    x: FloatArray
    frequency: FloatArray
    held: FloatArray | None

    @property
    def size(self) -> int:
        return 2 * self.frequency.size

    def apply(self, beta: FloatArray) -> FloatArray:
        if self.held is not None:
            return np.asarray(self.held @ beta)
        return np.concatenate([self.rows(here) @ beta for here in pieces(self.x.size)])

    def adjoint(self, values: FloatArray) -> FloatArray:
        if self.held is not None:
            return np.asarray(values @ self.held)
        return np.asarray(np.sum([values[here] @ self.rows(here) for here in pieces(self.x.size)], axis=0))

    def rows(self, at: Rows) -> FloatArray:
        return cosine_and_sine(self.x[at], self.frequency) if self.held is None else self.held[at]

    def changed(self, before: SomeColumns) -> BoolArray:
        same = isinstance(before, Waves) and self.x is before.x and np.array_equal(self.frequency, before.frequency)
        return np.full(self.x.size, not same)


def waves(x: FloatArray, frequency: FloatArray, *, before: Waves | None = None) -> Waves:
    """Waves of ``frequency`` (k,) over ``x`` (n,); columns that the waves ``before`` hold too are not made again, since
    a search fits the same waves many times."""
    if 2 * frequency.size * x.size > HELD_VALUES:
        return Waves(x=x, frequency=frequency, held=None)
    if before is None or before.held is None or before.x is not x:
        return Waves(x=x, frequency=frequency, held=cosine_and_sine(x, frequency))
    if np.array_equal(frequency, before.frequency):
        return before
    place = {f: j for j, f in enumerate(before.frequency.tolist())}
    held = np.empty((x.size, 2 * frequency.size))
    fresh = np.array([f not in place for f in frequency.tolist()])
    for j, f in enumerate(frequency.tolist()):
        if not fresh[j]:
            held[:, 2 * j : 2 * j + 2] = before.held[:, 2 * place[f] : 2 * place[f] + 2]
    held[:, np.repeat(fresh, 2)] = cosine_and_sine(x, frequency[fresh])
    return Waves(x=x, frequency=frequency, held=held)


@dataclass(frozen=True, kw_only=True, eq=False)
class Scattered:
    """Columns of which few are not zero at a sample: entry ``value`` (q, n) stands in column ``index`` (q, n)."""

    columns: int
    index: IntArray
    value: FloatArray

    @property
    def size(self) -> int:
        return self.columns

    def apply(self, beta: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("qn,qn->n", self.value, beta[self.index]))

    def adjoint(self, values: FloatArray) -> FloatArray:
        out = np.zeros(self.columns)
        for index, value in zip(self.index, self.value, strict=True):
            out += np.bincount(index, weights=value * values, minlength=self.columns)
        return out

    def rows(self, at: Rows) -> FloatArray:
        indices, values = self.index[:, at], self.value[:, at]
        rows = np.arange(indices.shape[1])
        out = np.zeros((rows.size, self.columns))
        for index, value in zip(indices, values, strict=True):
            # One entry of a slot per row, so this adds without collisions.
            out[rows, index] += value
        return out

    def changed(self, before: SomeColumns) -> BoolArray:
        if not isinstance(before, Scattered) or self.index.shape != before.index.shape:
            return np.ones(self.index.shape[1], dtype=np.bool_)
        return np.asarray(np.any((self.index != before.index) | (self.value != before.value), axis=0))


def tooth_numbers(carried: Carried, *, gear: int, coast: bool) -> IntArray:
    """Tooth (P, n) of ``gear`` (1 or 2) in each pair; on the coast flank driving n meets driven n + 1."""
    key = f"tooth {gear} {coast}"
    if key not in carried.known:
        late = 1 if gear == 2 and coast else 0
        carried.known[key] = np.mod(carried.mesh + late, carried.z_1 if gear == 1 else carried.z_2)
    return carried.known[key]


def rise(carried: Carried, *, gear: int) -> FloatArray:
    """Profile slope (P, n) per unit of rise at the contact: -1/2 at the active root, +1/2 at the tip of ``gear``.

    The driving tooth meets its mate root first, the driven one tip first.
    """
    key = f"rise {gear}"
    if key not in carried.known:
        low, high = carried.contact
        along = np.clip((carried.phase - low) / (high - low), -0.2, 1.2) - 0.5
        carried.known[key] = along if gear == 1 else -along
    return carried.known[key]


def as_built_part(carried: Carried, weight: FloatArray, *, coast: bool) -> Scattered:
    """Columns of pitch and slope of every tooth of both gears, (2 z_1 + 2 z_2,): driving pitch, driving slope, driven
    pitch, driven slope; each pair counts by ``weight`` (P, n).

    On the coast flank material lets the driven gear fall back, so the sign turns.
    """
    weight = weight * (-1.0 if coast else 1.0)
    slots = [p for p in range(weight.shape[0]) if weight[p].any()]
    weight = weight[slots]
    z_1, z_2 = carried.z_1, carried.z_2
    index, value = [], []
    for gear, first, z in ((1, 0, z_1), (2, 2 * z_1, z_2)):
        tooth = tooth_numbers(carried, gear=gear, coast=coast)[slots]
        index += [tooth + first, tooth + (first + z)]
        value += [weight, weight * rise(carried, gear=gear)[slots]]
    return Scattered(columns=2 * (z_1 + z_2), index=np.concatenate(index), value=np.concatenate(value))


def pair_deviation(carried: Carried, beta: FloatArray, *, coast: bool) -> FloatArray:
    """Deviation (P, n) in mm of each pair, both teeth together, from as-built parameters ``beta`` (2 z_1 + 2 z_2,)."""
    out = np.zeros(carried.phase.shape)
    for gear, first, z in ((1, 0, carried.z_1), (2, 2 * carried.z_1, carried.z_2)):
        tooth = tooth_numbers(carried, gear=gear, coast=coast)
        out += beta[first + tooth] + beta[first + z + tooth] * rise(carried, gear=gear)
    return out


def shape_entries(
    carried: Carried, *, gear: int, tooth: int, knots: FloatArray, coast: bool
) -> tuple[IntArray, FloatArray]:
    """A free shape of one ``tooth`` as hats about ``knots`` (k,), even in u - n: for each pair (P, n) the lower hat,
    and the part of the upper; the part is negative where the pair is none of the tooth's or beyond the knots."""
    mine = tooth_numbers(carried, gear=gear, coast=coast) == tooth
    place = (carried.phase - knots[0]) / float(knots[1] - knots[0])
    low = np.clip(np.floor(place), 0, knots.size - 2).astype(np.int64)
    inside = mine & (place >= 0.0) & (place <= knots.size - 1)
    return low, np.where(inside, place - low, -1.0)


def shape_deviation(entries: tuple[IntArray, FloatArray], beta: FloatArray) -> FloatArray:
    """Deviation (P, n) in mm of the pairs by a tooth's shape with heights ``beta`` (k,)."""
    low, part = entries
    return np.where(part >= 0.0, beta[low] * (1.0 - part) + beta[low + 1] * part, 0.0)


def shape_part(entries: tuple[IntArray, FloatArray], weight: FloatArray, *, knots: int, coast: bool) -> Scattered:
    """Columns (knots,) of a tooth's shape where each pair counts by ``weight`` (P, n)."""
    low, part = entries
    weight = np.where(part >= 0.0, weight, 0.0) * (-1.0 if coast else 1.0)
    return Scattered(
        columns=knots,
        index=np.concatenate([low, low + 1]),
        value=np.concatenate([weight * (1.0 - part), weight * part]),
    )
