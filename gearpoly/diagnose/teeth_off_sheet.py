"""Index deviations of a gear as recordings show them beside those of its inspection sheet: whether they contradict it,
whether they are recognised, and in which order.

Half of the steps from tooth to tooth decide, so that few wrong teeth, or an eccentricity, say nothing against a sheet.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from gearpoly.units import FloatArray, IntArray

DOUBTED_SHEET_SCATTER = 2.0
"""Scatter of the steps from tooth to tooth about the sheet, over what its uncertainty and the fit leave open, from
which on the sheet is doubted: by chance half of the steps are so far off in 1 of 40 gears of 8 teeth and 1 of 360 of
18, and these keep their sheet where it tells anything of their teeth."""

WRONG_TEETH = 4
"""Steps that may be wrong of however few teeth: those of two teeth out of their place."""

OWN = 0.5
"""The same scatter over that of the teeth without any sheet, below which the sheet tells of them: of sheets of other
gears 6 in 100 of 8 teeth, 3 of 12 and none of 18 or more come so near; beside two wild teeth 94 of 100 right ones of 12
teeth do, and all of 18."""

WILD = 2.5
"""Times their median from which on steps are cut where orders of a sheet are compared, so that a few wrong teeth do not
decide: of gears with two teeth out of place by five times the others 50 in 100 (25 teeth) then know their sheet, 11 in
100 without; of none is the chance."""

STEPS_NEAR_OTHER_ORDER_PART, OTHER_ORDER_DISTANCE_RATIO = 0.75, 0.35
"""Part of the steps that must lie as near the sheet in another order, over how near they lie to it as it is, or to
none, below which that is the right order: of 400 sheets of other gears, each in every order and of either sign, the
nearest came to 0.38 with 18 teeth, 0.49 with 25, and below 0.35 in 1 of 150 with 12."""

STEPS_SHOWN_PART = 0.5
"""Part of its steps that those of the teeth must hold for a sheet to be recognised: halfway between none and all. Two
sheets of other gears fitted best as they were by chance, with 0.43 and 0.48, and 15 wrong names were made of them."""


@dataclass(frozen=True, kw_only=True)
class ReadAs:
    """How a sheet is read: the number on it of tooth 0, ``first``, whether it counts ``back``, its ``sign``, and
    whether its values are ``single`` pitches, whose running sum the index deviations are."""

    first: int = 0
    back: bool = False
    sign: float = 1.0
    single: bool = False


AS_IT_IS = ReadAs()


@dataclass(frozen=True, kw_only=True, eq=False)
class TeethOffSheet:
    """Index deviations of a gear in um: ``off`` (z,) about its ``sheet`` (z,), with their ``covariance`` (z, z), the
    sheet's ``uncertainty``; ``summed`` (z,), those that its values would mean as single pitches, None where they are
    none; ``steps`` (z, z) makes steps from tooth to tooth of them."""

    gear: int
    off: FloatArray
    covariance: FloatArray
    sheet: FloatArray
    uncertainty: float
    steps: FloatArray
    summed: FloatArray | None = None

    def read(self, way: ReadAs) -> FloatArray:
        """The index deviations (z,) that the sheet means if it is read in a ``way``."""
        values = self.summed if way.single and self.summed is not None else self.sheet
        return np.asarray(way.sign * values[order_of(values.size, way.first, back=way.back)])

    def _others(self) -> list[ReadAs]:
        """Every way to read the sheet but as it is."""
        single = [] if self.summed is None else [ReadAs(single=True), ReadAs(single=True, sign=-1.0)]
        return [*other_orders(self.off.size), *single]

    @property
    def whole(self) -> FloatArray:
        """The same (z,) without any sheet."""
        return np.asarray(self.sheet + self.off)

    def within(self, values: FloatArray, part: float) -> float:
        """What a part of the steps of some deviations (z,) keep within, um."""
        return float(np.quantile(np.abs(self.steps @ values), part))

    @property
    def contradicted(self) -> bool:
        """Whether half of the steps, or all but four, are off by more than the sheet's uncertainty and the fit leave
        open, and are not recognised; and by a good part of what they are without any sheet, or another order fits.
        A gear may have one wave over its teeth that the sheet lacks, and its second, and all its steps are then off:
        where nothing else is, the sheet is right.
        """
        doubt = float(np.median(np.diag(self.steps @ self.covariance @ self.steps.T)))
        z = self.off.size
        half = min(0.5, (z - WRONG_TEETH - 1.0) / (z - 1.0))
        off = self.within(self.off, half)
        least = DOUBTED_SHEET_SCATTER * float(ndtri(0.5 * (1.0 + half))) * math.sqrt(2.0 * self.uncertainty**2 + doubt)
        if off < least or self.recognised:
            return False
        if off < OWN * self.within(self.whole, half):
            return self.elsewhere is not None
        return self.within(_without_wave(self.off), half) > least

    @property
    def elsewhere(self) -> ReadAs | None:
        """The way in which the sheet fits clearly better than as it is, and than none; None where there is none."""
        near = [(self.within(self.whole - self.read(way), STEPS_NEAR_OTHER_ORDER_PART), way) for way in self._others()]
        least, best = min(near, key=lambda one: one[0])
        plain = min(self.within(one, STEPS_NEAR_OTHER_ORDER_PART) for one in (self.off, self.whole))
        return best if least < OTHER_ORDER_DISTANCE_RATIO * plain else None

    @property
    def recognised(self) -> bool:
        """Whether the steps are more like those of the sheet as it is than in any other order, of either sign: of
        sheets of other gears 1 of 4 z is by chance. Shafts may have waves of their own beside it, however large: beside
        orders 2, 3, 4 and 6 with a fifth more than the teeth's own steps 57, 75 and 96 of 100 gears of 18, 25 and 40
        teeth know their sheet; beside an uncertainty of 2 um, with steps of 4 um, 80, 94 and 100. Of what is on it they
        also have to show half: a right sheet shows whole, another's not at all, each give or take 1 / sqrt(z)."""
        return self.recognised_after(0) > 0.0

    def recognised_after(self, pitches: int) -> float:
        """How alike the steps are to those of the sheet where all teeth stand so many ``pitches`` further on, as a part
        of the sheet's own; 0 where they are no more so than in another order, or too little."""
        z, steps = self.off.size, _cut(self.steps @ self.whole)
        here = ReadAs(first=-pitches % z)
        alike, own = {}, 1.0
        for way in (AS_IT_IS, *self._others()):
            sheet = _cut(self.steps @ self.read(way))
            alike[way] = _alike(steps, sheet)
            own = float(np.linalg.norm(sheet)) if way == here else own
        least = max(STEPS_SHOWN_PART * own, *(one for way, one in alike.items() if way != here))
        return alike[here] / own if alike[here] > least else 0.0


def _cut(steps: FloatArray) -> FloatArray:
    """Steps (z,), the wild ones cut."""
    most = WILD * float(np.median(np.abs(steps)))
    return np.asarray(np.clip(steps, -most, most))


def _alike(steps: FloatArray, others: FloatArray) -> float:
    """How alike steps (z,) are to others, as a part of their own size; 0 where those are none."""
    size = float(np.linalg.norm(others))
    return float(steps @ others) / size if size > 0.0 else 0.0


def _without_wave(values: FloatArray) -> FloatArray:
    """Deviations (z,) without the wave over the teeth that makes the largest steps, and its second: whatever makes a
    wave is seldom pure. Of 300 fine gears of 18 teeth with 6 um of order 3 and half as much of its second, 163 had
    their sheet thrown out without that, and none with it; of 300 sheets of other gears 274 and 266 were."""
    z, waves = values.size, np.fft.rfft(values)
    steps = np.abs(waves) * np.sin(np.pi * np.arange(waves.size) / z)
    steps[:2] = 0.0
    order = int(np.argmax(steps))
    for one in (order, 2 * order % z):
        waves[min(one, z - one)] = 0.0
    return np.asarray(np.fft.irfft(waves, z))


def other_orders(z: int) -> Iterator[ReadAs]:
    """Every order of ``z`` teeth but their own, of either sign."""
    for sign in (1.0, -1.0):
        for back in (False, True):
            for first in range(z):
                if first or back or sign < 0.0:
                    yield ReadAs(first=first, back=back, sign=sign)


def order_of(z: int, first: int, *, back: bool) -> IntArray:
    """Numbers (z,) on the sheet of the teeth 0, 1, ... of the pair."""
    return np.asarray((first + (-1 if back else 1) * np.arange(z)) % z)
