"""Jumps so large that they pass for noise: where a recording steps as it does nowhere else, and stays there.

Whoever estimates noise while three slips of 25 to 60 um stand in a recording finds noise that wanders by as much, and
in that noise no step stands out: its few innovations are cut as outliers. These are put in before any noise is known.
"""

from __future__ import annotations

import math

import numpy as np

from gearpoly.units import FloatArray, IntArray

SHORTEST_SIDE_SAMPLES = 8
"""Samples of the shortest stretches before and after a place whose means are compared; longer ones double, up to a
fourth of what a jump has to stay."""

SUDDEN_SIGMAS = 8.0
"""Robust standard deviations of such differences beyond which one is sudden: in 126 recordings of noise of three
colours beside teeth within their limits the largest was 5.6, in 44 of a bench without jumps 3.9. Three slips of 25 to
60 um reached 28 to 107. It only says where to look."""

STAYS_BY = 0.5
"""Part of it by which the means over a turn before and after differ as well."""

MOST_SUDDEN = 8
"""Sudden places beyond which they are how this recording is: teeth that hand over so at every mesh."""

WIDEST_JUMP, BETTER_JUMP_PART = 64, 0.9
"""Samples that a jump may take, and the part of the squares left by the best so far below which another is better."""

FEWEST_CYCLES_FOR_PLACES = 3
"""Hunting cycles from which on what a place does in most of them is taken off: teeth step in each."""


def sudden(u: FloatArray, residual: FloatArray, *, turn: float, period: float) -> dict[int, float]:
    """Samples (of ``u`` (n,) in meshes) at which the ``residual`` (n,) in mm steps and stays for a ``turn`` in meshes,
    the largest step first, each with what the means over a turn before and after differ by, in mm; none where there are
    too many. ``period`` of the hunting cycle in meshes."""
    n = residual.size
    inside = np.flatnonzero((u >= u[0] + turn) & (u <= u[-1] - turn))
    if inside.size < 4 * SHORTEST_SIDE_SAMPLES:
        return {}
    sums = np.concatenate(([0.0], np.cumsum(residual - residual[0])))
    longest = 0.25 * turn * n / float(u[-1] - u[0])
    best, size = np.zeros(inside.size), np.zeros(inside.size)
    for k in range(max(1, int(math.log2(max(longest / SHORTEST_SIDE_SAMPLES, 1.0))) + 1)):
        side = SHORTEST_SIDE_SAMPLES * 2**k
        at = np.clip(inside, side, n - side)
        step = _unusual(u[inside], (sums[at + side] - 2.0 * sums[at] + sums[at - side]) / side, period=period)
        usual = 1.4826 * float(np.median(np.abs(step)))
        over = np.abs(step) / max(usual, 1e-300)
        size = np.where(over > best, step, size)
        best = np.maximum(best, over)
    low, high = (np.searchsorted(u, u[inside] + side * turn) for side in (-1.0, 1.0))
    held = _mean(sums, inside, high) - _mean(sums, low, inside)
    stays = held * np.sign(size) > STAYS_BY * np.abs(size)
    free = np.where(stays & (best > SUDDEN_SIGMAS), best, 0.0)
    found: dict[int, float] = {}
    while np.any(free):
        here = int(np.argmax(free))
        found[int(inside[here])] = float(held[here])
        if len(found) > MOST_SUDDEN:
            return {}
        free[np.abs(u[inside] - u[inside[here]]) < turn] = 0.0
    return found


def took(residual: FloatArray, at: int) -> tuple[int, int]:
    """The middle sample of a jump near ``at`` of ``residual`` (n,), and how many samples it took: a press fit slips for
    a while, and what a sharp step leaves of that is large."""
    low, high = max(0, at - 4 * WIDEST_JUMP), min(residual.size, at + 4 * WIDEST_JUMP)
    x = np.arange(low, high, dtype=np.float64)
    slow = np.stack([np.ones_like(x), (x - at) / WIDEST_JUMP, ((x - at) / WIDEST_JUMP) ** 2], axis=1)

    def left(middle: int, width: int) -> float:
        """Squares that such a jump beside a slow course leaves."""
        ramp = np.clip((x - middle + 0.5 * (width + 1)) / width, 0.0, 1.0)
        columns = np.concatenate([slow, ramp[:, None]], axis=1)
        _, square, rank, _ = np.linalg.lstsq(columns, residual[low:high], rcond=None)
        # Beyond the ends of the record a jump is a level.
        return float(square[0]) if rank == columns.shape[1] and square.size else math.inf

    best, least, width = (at, 1), math.inf, 1
    while width <= WIDEST_JUMP:
        for middle in range(at - WIDEST_JUMP, at + WIDEST_JUMP + 1, max(1, width // 4)):
            # A wider one has to explain more than chance.
            if (square := left(middle, width)) < BETTER_JUMP_PART * least:
                best, least = (middle, width), square
        width *= 2
    if best[1] == 1:
        return best
    near = [
        (best[0] + late, round(best[1] * wider))
        for wider in (0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4)
        for late in range(-best[1] // 4, best[1] // 4 + 1)
    ]
    return min(near, key=lambda one: left(*one))


def _mean(sums: FloatArray, low: IntArray, high: IntArray) -> FloatArray:
    """Means (k,) from samples ``low`` to ``high``, of running ``sums``."""
    return np.asarray((sums[high] - sums[low]) / np.maximum(high - low, 1))


def _unusual(u: FloatArray, step: FloatArray, *, period: float) -> FloatArray:
    """``step`` (k,) at ``u`` (k,) less the middle one of all hunting cycles at the same teeth."""
    cycles = int((u[-1] - u[0]) / period)
    if cycles < FEWEST_CYCLES_FOR_PLACES:
        return step
    phase = np.linspace(0.0, period, int(u.size / cycles), endpoint=False)
    each = np.stack([np.interp(u[0] + k * period + phase, u, step) for k in range(cycles)])
    return np.asarray(step - np.interp(np.mod(u - u[0], period), phase, np.median(each, axis=0), period=period))
