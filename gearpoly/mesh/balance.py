"""The equilibrium of the pairs that share a load, one position after another, compiled; importing this imports numba.

At one position the driving gear has turned by phi beyond the first touch. Pair i has closed by u_i = lever_1i (phi -
phi_i) along its normal and carries W_i(u_i), nothing before it touches; wanted is phi with sum lever_2i W_i = moment.
Every law of giving, u(W), is concave: flanks that press together only get stiffer. So W_i(u) is convex, its tangent
at any load lies below it, and Newton's phi is never less than the true one, whatever loads it begins from: a pair that
is open there is open for good, which tangent reaches below zero carries nothing, and phi falls onto the answer.

All compiled code of a search stands in one file, as in ``radial_search``.
"""

from __future__ import annotations

import math

import numpy as np

from gearpoly.mesh.radial_search import compiled
from gearpoly.units import BoolArray, FloatArray, IntArray

NEWTON_STEPS = 100
"""Newton's steps allowed. Five to seven are usual; a pair that has only just touched adds a few."""

UNTRUSTED_BELOW = 0.1
"""Part of a load below which Newton's next is not trusted: so far down the tangent is no guide, and the load is taken
to fall with the square of the closing, as a gap across the face width has it."""


@compiled
def _given(load: float, least: float, level: float, power: float, logarithm: float, gap: float) -> tuple[float, float]:
    """How far a pair gives under ``load`` in N, mm, and per unit of further load, mm/N; ``level``
    with the teeth in it, else as of ``balance``.

    Below ``least`` in proportion to the load. Across a gap as ``PairCompliance.secant`` has it.
    """
    W = max(load, least)
    c, slope = level, level
    if power != 0.0:
        bend = power * W**-0.1
        c += bend
        slope += 0.9 * bend
    if logarithm != 0.0:
        log = logarithm * math.log(W)
        c += log
        slope += log + logarithm
    given = W * c
    if gap > 0.0:
        if given < 0.5 * gap:
            slope *= math.sqrt(0.5 * gap / given)
            given = math.sqrt(2.0 * gap * given)
        else:
            given += 0.5 * gap
    if load < least:
        return load * given / W, given / W
    return given, slope


@compiled
def _turn(
    begin: int, end: int, closing: FloatArray, lever_1: FloatArray, lever_2: FloatArray, force: FloatArray,
    given: FloatArray, slope: FloatArray, carries: BoolArray, moment: float,
) -> float:  # fmt: skip
    """Rotation in rad at which the tangents of the rows that carry balance ``moment`` in N.mm; a row that would pull
    carries no more. Infinite where none is left to drive."""
    dropped = True
    turn = 0.0
    while dropped:
        pushed, weight = moment, 0.0
        for i in range(begin, end):
            if carries[i]:
                part = lever_2[i] / slope[i]
                pushed += part * (lever_1[i] * closing[i] + given[i]) - lever_2[i] * force[i]
                weight += part * lever_1[i]
        if weight <= 0.0:  # no pair that is near can drive
            return math.inf
        turn = pushed / weight
        dropped = False
        for i in range(begin, end):
            if carries[i] and force[i] * slope[i] + lever_1[i] * (turn - closing[i]) < given[i]:
                carries[i] = False
                dropped = True
    return turn


@compiled
def balance(
    start: IntArray,
    closing: FloatArray,
    lever_1: FloatArray,
    lever_2: FloatArray,
    teeth: FloatArray,
    level: FloatArray,
    power: float,
    logarithm: float,
    gap: float,
    moment: float,
    whole: float,
    least: float,
    still: float,
) -> tuple[FloatArray, FloatArray, int]:
    """Rotations (N,) in rad beyond the first touch and forces (rows,) in N that balance ``moment`` in N.mm.

    Position n has the rows ``start[n]`` to ``start[n + 1]``. Of a row: ``closing`` in rad, levers in mm, compliance of
    the ``teeth`` in mm/N; its flanks give ``level`` + ``power`` W^-0.1 + ``logarithm`` ln W per unit of load W
    (``compliance.Flattening``). ``gap`` in mm across the face width. All loads begin at ``whole`` N and follow their
    law from ``least`` on. A position is done when no force moves by more than ``still`` N. Returns how many were not,
    those where friction locks the teeth among them.
    """
    positions = start.size - 1
    phi = np.zeros(positions)
    force = np.full(closing.size, whole)
    given, slope = np.empty(closing.size), np.empty(closing.size)
    carries = np.empty(closing.size, np.bool_)
    restless = 0
    for n in range(positions):
        begin, end = start[n], start[n + 1]
        for i in range(begin, end):
            # Friction turns a pair that touches far out of mesh backward: it must stay open, or the teeth lock.
            if lever_2[i] <= 0.0:
                force[i] = 0.0
        settled = False
        for _ in range(NEWTON_STEPS):
            for i in range(begin, end):
                carries[i] = force[i] > 0.0
                if carries[i]:
                    given[i], slope[i] = _given(force[i], least, teeth[i] + level[i], power, logarithm, gap)
            turn = _turn(begin, end, closing, lever_1, lever_2, force, given, slope, carries, moment)
            moved = 0.0
            for i in range(begin, end):
                if force[i] == 0.0:
                    continue
                closed = lever_1[i] * (turn - closing[i])
                load = 0.0
                if closed > 0.0:
                    load = force[i] + (closed - given[i]) / slope[i]
                    if load < UNTRUSTED_BELOW * force[i]:
                        load = force[i] * (closed / given[i]) ** 2
                moved = max(moved, abs(load - force[i]))
                force[i] = load
            phi[n] = turn
            if moved <= still:
                settled = True
                break
        locked = phi[n] == math.inf
        for i in range(begin, end):
            locked = locked or (lever_2[i] <= 0.0 and phi[n] > closing[i])
        if locked or not settled:
            restless += 1
    return phi, force, restless
