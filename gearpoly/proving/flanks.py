"""Deviations of flanks as functions of the roll length, tooth by tooth.

Every shape is the contract's formula. The functions are evaluated where they are needed, none is sampled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, floor, pi, sin

import numpy as np
from numba import njit

from gearpoly.proving.gears import MM_PER_UM, FloatArray, IdealPair

FLANK_TABLE_COLUMNS = 21
_P, _SLOPE, _CROWN, _START, _SPAN, _RELIEF, _R0, _RSPAN, _POWER, _WEAR, _REF, _WSPAN = range(12)
_UND, _WAVE, _PHASE, _PIT, _PIT_A, _PIT_B, _EDGE, _ROUGH, _TIP = range(12, 21)


@dataclass(frozen=True, kw_only=True)
class ToothDeviations:
    """What the teeth of one gear deviate by, in um; arrays have one value per tooth.

    p: index deviation of the drive flank (normal, positive = more material); slope, crowning; E_s: tooth thickness
    deviation along the reference circle. relief, relief_mm (radial), power: tip relief. wear: the contract's w.
    waves: (order, amplitude, phase of the drive flank, phase of the coast flank), continuous over the turn. pits:
    (tooth, depth, from radius, to radius) on the drive flank, radii in mm. own: factor on the compliance of each
    tooth."""

    p: FloatArray
    slope: FloatArray
    crowning: FloatArray
    E_s: FloatArray
    own: FloatArray
    relief: float = 0.0
    relief_mm: float = 0.5
    power: float = 1.0
    wear: float = 0.0
    waves: tuple[tuple[int, float, float, float], ...] = ()
    pits: tuple[tuple[int, float, float, float], ...] = ()

    @staticmethod
    def ideal(z: int, E_s: float = 0.0) -> ToothDeviations:
        """Teeth without deviations, all thinned by the same E_s in um."""
        zero = np.zeros(z)
        return ToothDeviations(p=zero, slope=zero, crowning=zero, E_s=np.full(z, E_s), own=np.ones(z))

    def index_plus(self, tooth: int, size: float) -> ToothDeviations:
        """The same teeth with one of them moved by size in um."""
        p = self.p.copy()
        p[tooth] += size
        return replace(self, p=p)

    def softer(self, tooth: int, factor: float) -> ToothDeviations:
        """The same teeth with one of them more compliant by a factor."""
        own = self.own.copy()
        own[tooth] *= factor
        return replace(self, own=own)


def table(
    pair: IdealPair, index: int, teeth: ToothDeviations, flank: str, ends: FloatArray | None = None
) -> FloatArray:
    """Parameters of one flank of every tooth for `deviation`, shape (z, `FLANK_TABLE_COLUMNS`), in mm.

    ends: roll length (mm) at which each tooth ends; None: at the tip circle. On the coast flank the index deviation is
    -p + E_s cos(alpha); a wave runs on without a jump from tooth to tooth.
    """
    gear, z = pair.gear(index), pair.gear(index).z
    out = np.zeros((z, FLANK_TABLE_COLUMNS))
    drive = flank == "drive"
    out[:, _P] = MM_PER_UM * (teeth.p if drive else -teeth.p + teeth.E_s * cos(gear.alpha))
    out[:, _SLOPE], out[:, _CROWN] = MM_PER_UM * teeth.slope, MM_PER_UM * teeth.crowning
    start, tip = pair.l_start(index), gear.l_tip
    out[:, _START], out[:, _SPAN] = start, 1 / (tip - start)
    relief_start = gear.roll(gear.r_a - teeth.relief_mm)
    out[:, _RELIEF], out[:, _R0], out[:, _RSPAN] = MM_PER_UM * teeth.relief, relief_start, 1 / (tip - relief_start)
    out[:, _POWER] = teeth.power
    out[:, _WEAR], out[:, _REF], out[:, _WSPAN] = MM_PER_UM * teeth.wear, gear.l_ref, 1 / (tip - gear.l_ref)
    if len(teeth.waves) > 1:
        raise ValueError("one undulation per gear")
    for order, amplitude, phase_drive, phase_coast in teeth.waves:
        # The contact climbs the driving drive flank and descends the driven one as the gears turn; coast: the other
        # way.
        climbs = 1.0 if (index == 1) == drive else -1.0
        out[:, _UND], out[:, _WAVE] = MM_PER_UM * amplitude, climbs * order / gear.r_b
        turned = order * gear.tau * np.arange(z) + (phase_drive if drive else phase_coast)
        out[:, _PHASE] = turned - out[:, _WAVE] * pair.l_work(index)
    for tooth, depth, low, high in teeth.pits if drive else ():
        a, b = gear.roll(low), gear.roll(high)
        out[tooth, _PIT], out[tooth, _PIT_A], out[tooth, _PIT_B] = MM_PER_UM * depth, a, b
        out[tooth, _EDGE] = 0.12 * (b - a)
        out[tooth, _ROUGH] += MM_PER_UM * depth
    # The tip circle is turned, not cut with the flank: the corner is where l + d(l) ends there, by a fixed point.
    _corners(out, np.full(z, tip) if ends is None else ends)
    return out


@njit(cache=True, inline="always")
def deviation(row: FloatArray, l: float) -> tuple[float, float]:
    """Deviation in mm and its slope over the roll length at roll length l in mm, for one row of `table`."""
    u = (l - row[_START]) * row[_SPAN]
    w = 2 * u - 1
    d = row[_P] + row[_SLOPE] * (u - 0.5) - row[_CROWN] * w * w
    s = row[_SPAN] * (row[_SLOPE] - 4 * row[_CROWN] * w)
    if row[_RELIEF] != 0.0 and l > row[_R0]:
        t = (l - row[_R0]) * row[_RSPAN]
        d -= row[_RELIEF] * t ** row[_POWER]
        s -= row[_RELIEF] * row[_POWER] * t ** (row[_POWER] - 1) * row[_RSPAN]
    if row[_WEAR] != 0.0:
        k = row[_WEAR] * row[_WSPAN]
        d -= k * abs(l - row[_REF])
        s -= k if l > row[_REF] else -k
    if row[_UND] != 0.0:
        angle = row[_WAVE] * l + row[_PHASE]
        angle -= 2 * pi * floor(angle / (2 * pi))
        d += row[_UND] * cos(angle)
        s -= row[_UND] * row[_WAVE] * sin(angle)
    if row[_PIT] != 0.0 and row[_PIT_A] < l < row[_PIT_B]:
        edge, near = row[_EDGE], min(l - row[_PIT_A], row[_PIT_B] - l)
        if near >= edge:
            d -= row[_PIT]
        else:  # the wall of the pit: half a cosine
            rising = pi if l - row[_PIT_A] < row[_PIT_B] - l else -pi
            d -= row[_PIT] * 0.5 * (1 - cos(pi * near / edge))
            s -= row[_PIT] * 0.5 * rising / edge * sin(pi * near / edge)
    return d, s


@njit(cache=True)
def _corners(rows: FloatArray, ends: FloatArray) -> None:
    """Fill in where each flank ends: l + d(l) is the roll length (mm) of the tip there."""
    for k in range(ends.size):
        rows[k, _TIP] = ends[k]
        for _ in range(8):
            rows[k, _TIP] = ends[k] - deviation(rows[k], rows[k, _TIP])[0]
