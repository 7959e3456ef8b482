"""Where two flanks touch: exact involute coordinates, Newton's method for the tangency.

Every point outside a base circle has two coordinates: the length L of its tangent to the circle and the angle beta of
the point where that tangent leaves it. A flank is the curve L = l + d(l) with l = r_b (B - beta), so the opening
between a point of the mate and the flank, measured along the tangent, is L - l - d(l), without approximation. The
point of contact is the minimum of the opening over the mate's flank: a tangency inside, a corner at either tip. The
coast flank is the drive flank of the pair seen in a mirror."""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

from numba import njit

from gearpoly.proving.flanks import _ROUGH, _UND, _WAVE, deviation
from gearpoly.proving.gears import FloatArray

ROLL_STEP_MM = 2e-4
"""mm of roll length: the opening is flat at its minimum, this leaves an error below 1e-9 mm there."""
KINK_BRACKET_MM = 1e-5
"""mm: width of the bracket at a kink of the profile; a relief of 4 um per mm leaves 0.04 nm."""


STEEP = 2.0
"""Safety on the comparison of a wave's curvature with that of the flanks."""


@njit(cache=True, inline="always")
def _gap(
    l: float, dx: float, dy: float, B1: float, rb1: float, B2: float, rb2: float, row1: FloatArray, row2: FloatArray
) -> tuple[float, float, float, float, float, float, float, float, float, float, float]:
    """Opening (mm) at roll length l of the driving flank, roll length of the driven one, angle of its string, point;
    lengths of both strings, slopes of both deviations, cosine and sine of the driving string's angle."""
    d1, s1 = deviation(row1, l)
    beta = B1 - l / rb1
    c, s = cos(beta), sin(beta)
    L = l + d1
    px, py = rb1 * c - L * s, rb1 * s + L * c
    qx, qy = dx - px, dy - py
    L2 = sqrt(max(qx * qx + qy * qy - rb2 * rb2, 1e-12))
    b2 = atan2(qy, qx) - atan2(L2, rb2)
    l2 = rb2 * (B2 - b2)
    d2, s2 = deviation(row2, l2)
    return L2 - l2 - d2, l2, b2, px, py, L, L2, s1, s2, c, s


@njit(cache=True)
def _open(
    l: float, dx: float, dy: float, B1: float, rb1: float, B2: float, rb2: float, row1: FloatArray, row2: FloatArray
) -> tuple[float, float, float, float, float, float]:
    """Opening (mm) at roll length l of the driving flank, its slope, roll length of the driven one, angle of its
    string, point."""
    g, l2, b2, px, py, L, L2, s1, s2, c, s = _gap(l, dx, dy, B1, rb1, B2, rb2, row1, row2)
    ux, uy = L / rb1 * c - s1 * s, L / rb1 * s + s1 * c  # dP/dl
    c2, t2 = cos(b2), sin(b2)
    slope = -(-t2 * ux + c2 * uy) + s2 * rb2 / L2 * (c2 * ux + t2 * uy)
    return g, slope, l2, b2, px, py


@njit(cache=True)
def _descend(
    lo: float, hi: float, l: float, curve: float, tip2: float,
    dx: float, dy: float, B1: float, rb1: float, B2: float, rb2: float, row1: FloatArray, row2: FloatArray,
) -> tuple[float, float, float, float, float, float, bool]:  # fmt: skip
    """Minimum of the opening between lo and hi, from l on: Newton on its slope, halving where that leaves the bracket.
    Either end is tried before the halving, but once: a flank that bends more than ``curve`` would else be sent from
    end to end for ever.

    The last value says that the driven tip ended the search: the opening still falls there, so the corner touches,
    not the flank."""
    best, at, l2b, bb, pxb, pyb, falls, cut = 1e9, l, 0.0, 0.0, 0.0, 0.0, False, False
    low, high, bound_lo, bound_hi = lo, hi, lo, hi
    tried_lo, tried_hi = False, False
    before, slope_before = 1e9, 0.0
    l = min(max(l, lo), hi)
    for _ in range(60):
        tried_lo, tried_hi = tried_lo or l <= bound_lo, tried_hi or l >= bound_hi
        g, slope, l2, b2, px, py = _open(l, dx, dy, B1, rb1, B2, rb2, row1, row2)
        if l2 > tip2:  # beyond the driven tip, there is no flank: go up the driving tooth
            low, cut = l, True
            if l >= bound_hi:
                break
            l = 0.5 * (low + high)
            if high - low <= KINK_BRACKET_MM:
                break
            continue
        if g < best:
            best, at, l2b, bb, pxb, pyb, falls = g, l, l2, b2, px, py, slope > 0
        if (slope <= 0 and l >= bound_hi) or (slope >= 0 and l <= bound_lo):
            break
        if slope > 0:
            high = l
        else:
            low = l
        if before < 1e8 and abs(l - before) > 1e-12:
            secant = (slope - slope_before) / (l - before)
            if 0.2 * curve < secant < 5 * curve:
                curve = secant
        before, slope_before = l, slope
        new = l - slope / curve
        if new >= high:
            new = bound_hi if high >= bound_hi and not tried_hi else 0.5 * (low + high)
        elif new <= low:
            new = bound_lo if low <= bound_lo and not tried_lo else 0.5 * (low + high)
        if abs(new - l) < ROLL_STEP_MM or high - low < KINK_BRACKET_MM:
            # One last look at the converged point: it costs little and is exact to second order.
            if abs(new - l) > 0.1 * ROLL_STEP_MM:
                g, slope, l2, b2, px, py = _open(new, dx, dy, B1, rb1, B2, rb2, row1, row2)
                if l2 <= tip2 and g < best:
                    best, at, l2b, bb, pxb, pyb, falls = g, new, l2, b2, px, py, slope > 0
            break
        l = new
    # Halving against the tip ends within `KINK_BRACKET_MM` of it, while a tangency that close to the tip is the corner
    # as well.
    return best, at, l2b, bb, pxb, pyb, cut and falls and tip2 - l2b < 5 * ROLL_STEP_MM


@njit(cache=True)
def closest(
    l: float, lo: float, tip1: float, tip2: float, curve: float,
    dx: float, dy: float, B1: float, rb1: float, B2: float, rb2: float, row1: FloatArray, row2: FloatArray,
) -> tuple[float, float, float, float, float, float]:  # fmt: skip
    """Smallest opening of two flanks: (mm, roll lengths, angle of the normal, point on the driving gear from its own
    centre)."""
    rough = row1[_ROUGH] + row2[_ROUGH]
    # A wave makes a second minimum only where it bends more than the flanks do; half is left for what else bends.
    if row1[_UND] * row1[_WAVE] ** 2 * STEEP + row2[_UND] * row2[_WAVE] ** 2 * STEEP > curve:
        rough += 2 * (row1[_UND] + row2[_UND])
    a, b, first = lo, tip1, l
    if rough > 0.0:  # more than one minimum is possible: look at the whole reach first
        reach = sqrt(2 * (rough + 2e-3) / curve)
        a, b = max(lo, l - reach), min(tip1, l + reach)
        if b - a > 1e-6:
            n = 33
            least, k_least = 1e9, 0
            for k in range(n):
                looked = _gap(a + (b - a) * k / (n - 1), dx, dy, B1, rb1, B2, rb2, row1, row2)
                g, l2 = looked[0], looked[1]
                if l2 <= tip2 and g < least:
                    least, k_least = g, k
            first = a + (b - a) * k_least / (n - 1)
            width = (b - a) / (n - 1)
            a, b = max(a, first - width), min(b, first + width)
        else:
            a, b = lo, tip1
    found = _descend(a, b, first, curve, tip2, dx, dy, B1, rb1, B2, rb2, row1, row2)
    if found[6] or found[0] > 1e8:  # the corner of the driven tip against the driving flank
        d2, _s2 = deviation(row2, tip2)
        beta2 = B2 - tip2 / rb2
        L = tip2 + d2
        px = dx - (rb2 * cos(beta2) - L * sin(beta2))
        py = dy - (rb2 * sin(beta2) + L * cos(beta2))
        square = px * px + py * py - rb1 * rb1
        if square > 0:
            L1 = sqrt(square)
            beta = atan2(py, px) - atan2(L1, rb1)
            l1 = rb1 * (B1 - beta)
            d1, _s1 = deviation(row1, l1)
            g = L1 - l1 - d1
            if l1 <= tip1:
                return g, l1, tip2, beta, px, py
    return found[0], found[1], found[2], found[3], found[4], found[5]
