"""Where two flanks touch: exact involute coordinates, Newton's method for the tangency, equilibrium of all pairs.

Every point outside a base circle has two coordinates: the length L of its tangent to the circle and the angle beta of
the point where that tangent leaves it. A flank is the curve L = l + d(l) with l = r_b (B - beta), so the opening
between a point of the mate and the flank, measured along the tangent, is L - l - d(l), without approximation. The
point of contact is the minimum of the opening over the mate's flank: a tangency inside, a corner at either tip. The
coast flank is the drive flank of the pair seen in a mirror."""

from __future__ import annotations

from math import acos, atan2, ceil, cos, floor, log, pi, sin, sqrt

import numpy as np
from numba import njit

from proving.flanks import _ROUGH, _TIP, _UND, _WAVE, deviation
from proving.gears import FloatArray, IntArray
from proving.sharing import share

SLOTS = 5
"""Pairs of teeth that are kept per position."""
BEYOND = 0.45
"""How far outside the path of contact a corner may touch, in base pitches; at the limit the gap exceeds 50 um for
module 0.5."""
CLOSED = 1e-7
"""mm: a position is found when the last correction is smaller, 0.1 nm; a kink of the profile cannot do better than
0.04 nm."""
LOOSE = 1e-6
"""mm: good enough after LATE trials, 1 nm. Where the contact jumps between two waves of one flank there is no closer
answer."""
LATE = 12
JUMP = 1e-4
"""mm: a last correction above 0.1 um is a failure, not such a jump."""
STEP = 2e-4
"""mm of roll length: the opening is flat at its minimum, this leaves an error below 1e-9 mm there."""
NARROW = 1e-5
"""mm: width of the bracket at a kink of the profile; a relief of 4 um per mm leaves 0.04 nm."""


STEEP = 2.0
"""Safety on the comparison of a wave's curvature with that of the flanks."""
ROLLING = 0.02
"""mm of roll length from the pitch point over which sliding friction comes up; a jump there would have no
equilibrium."""


@njit(cache=True)
def _open(
    l: float, dx: float, dy: float, B1: float, rb1: float, B2: float, rb2: float, row1: FloatArray, row2: FloatArray
) -> tuple[float, float, float, float, float, float]:
    """Opening (mm) at roll length l of the driving flank, its slope, roll length of the driven one, angle of its
    string, point."""
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
    ux, uy = L / rb1 * c - s1 * s, L / rb1 * s + s1 * c  # dP/dl
    c2, t2 = cos(b2), sin(b2)
    slope = -(-t2 * ux + c2 * uy) + s2 * rb2 / L2 * (c2 * ux + t2 * uy)
    return L2 - l2 - d2, slope, l2, b2, px, py


@njit(cache=True)
def _descend(
    lo: float, hi: float, l: float, curve: float, tip2: float,
    dx: float, dy: float, B1: float, rb1: float, B2: float, rb2: float, row1: FloatArray, row2: FloatArray,
) -> tuple[float, float, float, float, float, float, bool]:  # fmt: skip
    """Minimum of the opening between lo and hi, from l on: Newton on its slope, halving where that leaves the bracket.

    The last value says that the driven tip ended the search: the opening still falls there, so the corner touches,
    not the flank."""
    best, at, l2b, bb, pxb, pyb, falls, cut = 1e9, l, 0.0, 0.0, 0.0, 0.0, False, False
    low, high, bound_lo, bound_hi = lo, hi, lo, hi
    before, slope_before = 1e9, 0.0
    l = min(max(l, lo), hi)
    for _ in range(60):
        g, slope, l2, b2, px, py = _open(l, dx, dy, B1, rb1, B2, rb2, row1, row2)
        if l2 > tip2:  # beyond the driven tip, there is no flank: go up the driving tooth
            low, cut = l, True
            if l >= bound_hi:
                break
            l = 0.5 * (low + high)
            if high - low <= NARROW:
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
            new = bound_hi if high >= bound_hi else 0.5 * (low + high)
        elif new <= low:
            new = bound_lo if low <= bound_lo else 0.5 * (low + high)
        if abs(new - l) < STEP or high - low < NARROW:
            # One last look at the converged point: it costs little and is exact to second order.
            if abs(new - l) > 0.1 * STEP:
                g, slope, l2, b2, px, py = _open(new, dx, dy, B1, rb1, B2, rb2, row1, row2)
                if l2 <= tip2 and g < best:
                    best, at, l2b, bb, pxb, pyb, falls = g, new, l2, b2, px, py, slope > 0
            break
        l = new
    # Halving against the tip ends within NARROW of it, while a tangency that close to the tip is the corner as well.
    return best, at, l2b, bb, pxb, pyb, cut and falls and tip2 - l2b < 5 * STEP


@njit(cache=True)
def _closest(
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
                g, _s, l2, _b, _x, _y = _open(a + (b - a) * k / (n - 1), dx, dy, B1, rb1, B2, rb2, row1, row2)
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


@njit(cache=True)
def solve(
    theta_2: FloatArray, moments: FloatArray, soft: FloatArray, side: float,
    z: IntArray, geo: FloatArray, ecc: FloatArray,
    rows1: FloatArray, rows2: FloatArray, nodes: FloatArray, own1: FloatArray, own2: FloatArray, contact: FloatArray,
    deflect: bool, mu: float, lead: float,
    x: FloatArray, tooth1: IntArray, tooth2: IntArray, roll1: FloatArray, roll2: FloatArray,
    weights: FloatArray, forces: FloatArray, deflections: FloatArray, counts: IntArray,
) -> int:  # fmt: skip
    """Transmission error x = r_b2 theta_2 - r_b1 theta_1 (mm) at positions theta_2 (rad); returns positions not found.

    moments (N.mm) and soft (factor on the compliance of the teeth): one per position; side +1 drive, -1 coast; geo:
    r_b1, r_b2, a, alpha_w, l_w1, l_w2, tip1, tip2, lowest roll length 1, thickness angles 1, 2; ecc: amplitude and
    angle of both gears; nodes: l_1, c_1, l_2, c_2. The rest is filled, one row per position."""
    rb1, rb2, a, alpha_w, lw1, lw2, tip1, tip2, low1, off1, off2 = geo
    if side > 0:
        off1 = off2 = 0.0
    tau1, tau2 = 2 * pi / z[0], 2 * pi / z[1]
    pb = rb1 * tau1
    shift = 0 if side > 0 else 1
    gaps, lever1, lever2 = np.zeros(SLOTS), np.zeros(SLOTS), np.zeros(SLOTS)
    c, force, weight, teeth_c = np.zeros(SLOTS), np.zeros(SLOTS), np.zeros(SLOTS), np.zeros(SLOTS)
    guess, failed = 0.0, 0
    for i in range(theta_2.size):
        t2, moment = theta_2[i], moments[i]
        loaded = moment if deflect else 0.0
        t1 = (rb2 * t2 - guess) / rb1
        cx2 = a + ecc[2] * cos(pi + ecc[3] - t2)
        cy2 = side * ecc[2] * sin(pi + ecc[3] - t2)
        turn = 0.0
        first, n = 0, 0
        for trial in range(LATE + 25):
            cx1, cy1 = ecc[0] * cos(t1 - ecc[1]), side * ecc[0] * sin(t1 - ecc[1])
            dx, dy = cx2 - cx1, cy2 - cy1
            far = sqrt(dx * dx + dy * dy)
            alpha = acos((rb1 + rb2) / far)
            string = atan2(dy, dx) - alpha
            path = far * sin(alpha)
            zero = rb1 * (-alpha_w + lw1 / rb1 + side * t1 + off1 - string)
            # Teeth in reach: the driving roll length of mesh n on the line of action is zero - side n p_b.
            # They are chosen while the position still moves much, and then kept, or the choice could flip for ever.
            if trial < 3:
                if side > 0:
                    first = ceil((zero - tip1) / pb - BEYOND)
                    last = floor((zero - path + tip2) / pb + BEYOND)
                else:
                    first = ceil((path - tip2 - zero) / pb - BEYOND)
                    last = floor((tip1 - zero) / pb + BEYOND)
                n = min(last - first + 1, SLOTS)
                force[:] = moment / rb2 / 1.5 + 1e-9
            for k in range(n):
                mesh = first + k
                k1, k2 = mesh % z[0], (mesh + shift) % z[1]
                l1 = zero - side * mesh * pb
                B1 = -alpha_w + lw1 / rb1 + side * (t1 - mesh * tau1) + off1
                B2 = -alpha_w + lw2 / rb2 - side * (t2 - (mesh + shift) * tau2) + off2
                end1, end2 = rows1[k1, _TIP], rows2[k2, _TIP]
                ll = min(max(l1, low1), end1)
                l2 = max(path - ll, 0.05)
                curve = (ll / rb1) ** 2 * (1 / ll + 1 / l2)
                g, l1, l2, normal, px, py = _closest(
                    ll, low1, end1, end2, curve, dx, dy, B1, rb1, B2, rb2, rows1[k1], rows2[k2]
                )
                nx, ny = -sin(normal), cos(normal)
                px, py = px + cx1, py + cy1
                gaps[k] = g
                lever1[k] = px * ny - py * nx
                arm = (px - a) * ny - py * nx
                recess = min(max(side * (lw2 - l2) / ROLLING, -1.0), 1.0)
                lever2[k] = -arm + recess * mu * l2
                if g > 1e8:  # a broken tooth that no point of the mate faces any more: far, by any lever
                    lever1[k], lever2[k] = rb1, rb2
                tooth1[i, k], tooth2[i, k], roll1[i, k], roll2[i, k] = k1, k2, l1, l2
                if loaded > 0.0:
                    p1 = (l1 - nodes[0, 0]) / (nodes[0, -1] - nodes[0, 0]) * (nodes.shape[1] - 1)
                    p2 = (l2 - nodes[2, 0]) / (nodes[2, -1] - nodes[2, 0]) * (nodes.shape[1] - 1)
                    j1 = min(max(int(p1), 0), nodes.shape[1] - 2)
                    j2 = min(max(int(p2), 0), nodes.shape[1] - 2)
                    c1 = nodes[1, j1] + (p1 - j1) * (nodes[1, j1 + 1] - nodes[1, j1])
                    c2 = nodes[3, j2] + (p2 - j2) * (nodes[3, j2 + 1] - nodes[3, j2])
                    teeth_c[k] = soft[i] * (own1[k1] * c1 + own2[k2] * c2)
                    f = max(force[k], 1e-3 * moment / rb2)
                    rho = l1 * l2 / (l1 + l2)
                    c[k] = teeth_c[k] + contact[0] * f ** -contact[1] + contact[2] * log(contact[3] / (f * rho))
            turn = share(n, gaps, lever1, lever2, c, lead, loaded, force, weight)
            if trial >= LATE:
                turn /= trial - LATE + 2
            t1 += side * turn
            if abs(turn) * rb1 < (CLOSED if trial < LATE else LOOSE):
                break
        if abs(turn) * rb1 > JUMP:
            failed += 1
        x[i] = rb2 * t2 - rb1 * t1
        guess = x[i]
        counts[i] = n
        for k in range(n):
            weights[i, k], forces[i, k] = weight[k], force[k]
            deflections[i, k] = force[k] * c[k] if loaded > 0.0 else 0.0
    return failed
