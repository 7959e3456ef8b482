"""What an inspector would find on a gear from its deviations: single and cumulative pitch, base tangent length,
profile.

These know nothing of how the numbers came about, so they can verify a drawn gear and judge an estimated one.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from gearpoly.errors import OutOfRangeError
from gearpoly.gear.gear import Gear, inv
from gearpoly.gear.root import form_point
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


def index_deviations(single: FloatArray, *, alpha: float, which: Which, coast: bool = False) -> FloatArray:
    """Normal index deviations (z,) in mm, mean removed, of single pitch deviations ``single`` (z,) as a sheet has them:
    arcs in mm, tooth n against n - 1 in the order of meshing, positive = pitch too large.

    Too large a pitch sets the later tooth back: that takes material off the driving gear's drive flank and adds it to
    the driven gear's; on coast flanks it is the other way round (derived here).
    """
    sense = (-1.0 if which == "driving" else 1.0) * (-1.0 if coast else 1.0)
    sums = np.cumsum(single)
    index: FloatArray = sense * math.cos(alpha) * (sums - np.mean(sums)) + 0.0
    return index


def thickness_from_span(gear: Gear, W: float, *, k: int) -> float:
    """Tooth thickness deviation E_s in mm, an arc, of a base tangent length ``W`` in mm over ``k`` teeth: W_k less its
    nominal size, over cos(alpha) (ISO 21771:2007, 7.3).

    Raises ``OutOfRangeError`` where so many teeth cannot be spanned on the involutes.
    """
    l = 0.5 * W
    if k >= gear.z or not form_point(gear)[1] <= l <= gear.l_a:
        raise OutOfRangeError(
            f"a span of {W:g} mm over {k} teeth does not touch the involutes of z = {gear.z}; over {gear.k_span} teeth "
            f"the deviation-free gear has {gear.W_k:.4f} mm"
        )
    nominal = (k - 1) * gear.p_b + 2.0 * gear.r_b * gear.psi_b
    return (W - nominal) / math.cos(gear.alpha)


def thickness_from_pins(gear: Gear, M: float, *, D: float) -> float:
    """Tooth thickness deviation E_s in mm, an arc, of a size ``M`` in mm over two pins of diameter ``D`` in mm.

    Pin centres lie at d_K = M - D, with odd z at (M - D)/cos(pi/(2 z)); there inv(alpha_K) = psi_b - pi/z + D/d_b
    (ISO 21771:2007, 7.4). Raises ``OutOfRangeError`` where such pins do not touch the involutes, or not at all.
    """
    d_K = (M - D) / (1.0 if gear.z % 2 == 0 else math.cos(0.5 * math.pi / gear.z))
    d_b = 2.0 * gear.r_b
    l = 0.5 * (math.sqrt(d_K**2 - d_b**2) - D) if d_K > d_b else -1.0
    if not form_point(gear)[1] <= l <= gear.l_a or 0.5 * (d_K + D) <= gear.r_a:
        raise OutOfRangeError(
            f"{M:g} mm over pins of {D:g} mm: such pins do not touch the involutes of z = {gear.z} and stand out over "
            f"their tips; about {1.68 * gear.m:g} mm is a usual diameter"
        )
    alpha_K = math.acos(d_b / d_K)
    psi_b = inv(alpha_K) + math.pi / gear.z - D / d_b
    return 2.0 * gear.r * (psi_b - inv(gear.alpha)) - gear.s
