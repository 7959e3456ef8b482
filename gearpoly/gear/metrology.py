"""What an inspector would find on a gear from its deviations: single and cumulative pitch, base tangent length,
profile.

These know nothing of how the numbers came about, so they can verify a drawn gear and judge an estimated one.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from gearpoly.gear.gear import Gear
from gearpoly.units import FloatArray, IntArray

Which = Literal["driving", "driven"]


def single_pitch(index: FloatArray, *, alpha: float) -> FloatArray:
    """Single pitch deviations f_p (z,) in mm of one side, arcs on the reference circle, tooth n to
    n + 1 and the last to 0.

    ``index`` (z,) normal index deviations in mm; an arc is its normal part / cos(alpha)
    (ISO 1328-1:2013, clause 3).
    """
    f_p: FloatArray = (np.roll(index, -1) - index) / math.cos(alpha)
    return f_p


def cumulative_pitch(index: FloatArray, *, alpha: float) -> float:
    """Total cumulative pitch deviation F_p in mm, the range of all index deviations as arcs (ISO
    1328-1:2013, clause 3)."""
    return float(np.ptp(index)) / math.cos(alpha)


def spans(gear: Gear, which: Which) -> tuple[IntArray, IntArray]:
    """Drive flank and coast flank (tooth numbers, each (z,)) between which the base tangent over k
    teeth is measured.

    The drive side is the counter-clockwise one on both gears, but the driving gear's teeth are
    numbered clockwise.
    """
    first = np.arange(gear.z)
    last = (first + gear.k_span - 1) % gear.z
    return (first, last) if which == "driving" else (last, first)


def base_tangent_deviations(gear: Gear, *, index: FloatArray, index_coast: FloatArray, which: Which) -> FloatArray:
    """Deviations (z,) in mm of the base tangent length W_k at every place round the gear.

    Both flanks are met along their normals, so their normal deviations ``index`` and
    ``index_coast`` (z,) in mm add up (derived here).
    """
    drive, coast = spans(gear, which)
    return index[drive] + index_coast[coast]


def profile_deviations(u: FloatArray, d: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Slope, form and total profile deviation (...) in mm of traces ``d`` (..., n) at places ``u``
    (n,) of the profile.

    Least-squares mean line over the active profile: its rise from 0 to 1, the range about it, and
    the range of all (ISO 1328-1:2013, clause 4).
    """
    # Trapezoids: points at any spacing, and none of the ends' double weight.
    share = np.concatenate(([0.0], np.diff(u))) + np.concatenate((np.diff(u), [0.0]))
    centred = u - np.sum(share * u) / np.sum(share)
    slope = d @ (share * centred) / np.sum(share * centred**2)
    rest = d - slope[..., None] * centred
    return slope, np.ptp(rest, axis=-1), np.ptp(d, axis=-1)
