"""Equilibrium of all pairs of teeth in reach: the transmission error position by position, by Newton's method.

A position starts where the one before it ended. So a position whose start and whose teeth are those of a solution that
is known has the same answer, to the last digit; and a pair that stays open through all further trials need not be
looked at in them."""

from __future__ import annotations

from math import acos, atan2, ceil, cos, floor, log, pi, sin, sqrt

import numpy as np
from numba import njit

from gearpoly.proving.contact import closest
from gearpoly.proving.flanks import _TIP
from gearpoly.proving.gears import BoolArray, FloatArray, IntArray
from gearpoly.proving.sharing import share

SLOTS = 5
"""Pairs of teeth that are kept per position."""
CORNER_BEYOND_BASE_PITCHES = 0.45
"""How far outside the path of contact a corner may touch, in base pitches; at the limit the gap exceeds 50 um for
module 0.5."""
CLOSED = 1e-7
"""mm: a position is found when the last correction is smaller, 0.1 nm; a kink of the profile cannot do better than
0.04 nm."""
GOOD_ENOUGH_LATE_MM = 1e-6
"""mm: good enough after LATE trials, 1 nm. Where the contact jumps between two waves of one flank there is no closer
answer."""
LATE = 12
JUMP_CORRECTION_MM = 1e-4
"""mm: a last correction above 0.1 um is a failure, not such a jump."""
ROLLING = 0.02
"""mm of roll length from the pitch point over which sliding friction comes up; a jump there would have no
equilibrium."""
OPEN = 1e-3
"""mm: a pair that is further from carrying than 1 um is not looked at again; no search for a contact errs by more."""
NEARING = 0.2
"""Part of a correction by which an open pair may come nearer to carrying than the pair that carries does: normals of
flanks that touch at a corner pass the axis at another distance than the base radius, by a tenth at most."""
SAG_GROWTH_PART = 0.5
"""Part of the sag of a pair that carries all, by which that may still grow: the contact is softer under less force, by
a tenth at most where a third is carried."""


NOWHERE = 1e8
"""mm: from here on a gap is none, as no point of the mate faces the tooth; it may in the next trial."""
OPEN_PAIR_GAP_MM = 1e7
"""mm: the gap of an open pair that is not looked at."""


@njit(cache=True)
def _held(first: int, last: int, shift: int, moved1: BoolArray, moved2: BoolArray) -> bool:
    """Whether no tooth of meshes first to last has moved."""
    for mesh in range(first, last + 1):
        if moved1[mesh % moved1.size] or moved2[(mesh + shift) % moved2.size]:
            return False
    return True


@njit(cache=True)
def _loosen(n: int, gaps: FloatArray, lever1: FloatArray, turn: float, alone: float, slack: FloatArray) -> None:
    """How far (rad) each pair stays from carrying in all trials to come, after a correction by ``turn``; ``alone``: the
    turn at which the first pair carries all."""
    least = alone
    for k in range(n):
        least = min(least, gaps[k] / lever1[k])
    for k in range(n):
        if gaps[k] > NOWHERE:
            slack[k] = 0.0
            continue
        if gaps[k] != OPEN_PAIR_GAP_MM:
            slack[k] = gaps[k] / lever1[k] - alone - SAG_GROWTH_PART * (alone - least)
        slack[k] -= NEARING * abs(turn)


@njit(cache=True)
def solve(
    theta_2: FloatArray, moments: FloatArray, soft: FloatArray, side: float,
    z: IntArray, geo: FloatArray, ecc: FloatArray,
    rows1: FloatArray, rows2: FloatArray, nodes: FloatArray, own1: FloatArray, own2: FloatArray, contact: FloatArray,
    deflect: bool, mu: float, lead: float,
    known: FloatArray, known_reach: IntArray, moved1: BoolArray, moved2: BoolArray,
    x: FloatArray, reach: IntArray, whole: bool, tooth1: IntArray, tooth2: IntArray, roll1: FloatArray,
    roll2: FloatArray, weights: FloatArray, forces: FloatArray, deflections: FloatArray, counts: IntArray,
) -> int:  # fmt: skip
    """Transmission error x = r_b2 theta_2 - r_b1 theta_1 (mm) at positions theta_2 (rad); returns positions not found.

    moments (N.mm) and soft (factor on the compliance of the teeth): one per position; side +1 drive, -1 coast; geo:
    r_b1, r_b2, a, alpha_w, l_w1, l_w2, tip1, tip2, lowest roll length 1, thickness angles 1, 2; ecc: amplitude and
    angle of both gears; nodes: l_1, c_1, l_2, c_2. known, known_reach: x and reach of the same positions with other
    teeth, moved1 and moved2 where a tooth is another; of size 0 where nothing is known. The rest is filled, one row per
    position: x, reach (first and last mesh looked at) and, if ``whole``, what each pair does."""
    rb1, rb2, a, alpha_w, lw1, lw2, tip1, tip2, low1, off1, off2 = geo
    if side > 0:
        off1 = off2 = 0.0
    tau1, tau2 = 2 * pi / z[0], 2 * pi / z[1]
    pb = rb1 * tau1
    shift = 0 if side > 0 else 1
    gaps, lever1, lever2 = np.zeros(SLOTS), np.zeros(SLOTS), np.zeros(SLOTS)
    c, force, weight, teeth_c = np.zeros(SLOTS), np.zeros(SLOTS), np.zeros(SLOTS), np.zeros(SLOTS)
    slack = np.zeros(SLOTS)
    guess, before, failed, row = 0.0, 0.0, 0, 0
    for i in range(theta_2.size):
        t2, moment = theta_2[i], moments[i]
        loaded = moment if deflect else 0.0
        t1 = (rb2 * t2 - guess) / rb1
        if known.size > 0:
            same = t1 == (rb2 * t2 - before) / rb1
            before = known[i]
            if same and _held(known_reach[i, 0], known_reach[i, 1], shift, moved1, moved2):
                x[i] = guess = known[i]
                reach[i, 0], reach[i, 1] = known_reach[i, 0], known_reach[i, 1]
                continue
        if whole:
            row = i
        cx2 = a + ecc[2] * cos(pi + ecc[3] - t2)
        cy2 = side * ecc[2] * sin(pi + ecc[3] - t2)
        turn = 0.0
        first, n = 0, 0
        slack[:] = 0.0
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
                former, many = first, n
                if side > 0:
                    first = ceil((zero - tip1) / pb - CORNER_BEYOND_BASE_PITCHES)
                    last = floor((zero - path + tip2) / pb + CORNER_BEYOND_BASE_PITCHES)
                else:
                    first = ceil((path - tip2 - zero) / pb - CORNER_BEYOND_BASE_PITCHES)
                    last = floor((tip1 - zero) / pb + CORNER_BEYOND_BASE_PITCHES)
                n = min(last - first + 1, SLOTS)
                force[:] = moment / rb2 / 1.5 + 1e-9
                if trial == 0:
                    reach[i, 0], reach[i, 1] = first, first + n - 1
                elif first != former or n != many:
                    reach[i, 0], reach[i, 1] = min(reach[i, 0], first), max(reach[i, 1], first + n - 1)
                    slack[:] = 0.0
            for k in range(n):
                if slack[k] > OPEN / rb1 and not whole:
                    gaps[k], lever1[k], lever2[k] = OPEN_PAIR_GAP_MM, rb1, rb2
                    continue
                mesh = first + k
                k1, k2 = mesh % z[0], (mesh + shift) % z[1]
                l1 = zero - side * mesh * pb
                B1 = -alpha_w + lw1 / rb1 + side * (t1 - mesh * tau1) + off1
                B2 = -alpha_w + lw2 / rb2 - side * (t2 - (mesh + shift) * tau2) + off2
                end1, end2 = rows1[k1, _TIP], rows2[k2, _TIP]
                ll = min(max(l1, low1), end1)
                l2 = max(path - ll, 0.05)
                curve = (ll / rb1) ** 2 * (1 / ll + 1 / l2)
                g, l1, l2, normal, px, py = closest(
                    ll, low1, end1, end2, curve, dx, dy, B1, rb1, B2, rb2, rows1[k1], rows2[k2]
                )
                nx, ny = -sin(normal), cos(normal)
                px, py = px + cx1, py + cy1
                gaps[k] = g
                lever1[k] = px * ny - py * nx
                arm = (px - a) * ny - py * nx
                recess = min(max(side * (lw2 - l2) / ROLLING, -1.0), 1.0)
                lever2[k] = -arm + recess * mu * l2
                if g > NOWHERE:  # a broken tooth that no point of the mate faces any more: far, by any lever
                    lever1[k], lever2[k] = rb1, rb2
                tooth1[row, k], tooth2[row, k], roll1[row, k], roll2[row, k] = k1, k2, l1, l2
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
            turn, alone = share(n, gaps, lever1, lever2, c, lead, loaded, force, weight)
            if trial >= LATE:
                turn /= trial - LATE + 2
            t1 += side * turn
            _loosen(n, gaps, lever1, turn, alone, slack)
            if abs(turn) * rb1 < (CLOSED if trial < LATE else GOOD_ENOUGH_LATE_MM):
                break
        if abs(turn) * rb1 > JUMP_CORRECTION_MM:
            failed += 1
        x[i] = rb2 * t2 - rb1 * t1
        guess = x[i]
        if whole:
            counts[i] = n
            for k in range(n):
                weights[i, k], forces[i, k] = weight[k], force[k]
                deflections[i, k] = force[k] * c[k] if loaded > 0.0 else 0.0
    return failed
