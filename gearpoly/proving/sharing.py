"""How the pairs of teeth in reach share a load: springs that touch at different turns of the driving gear."""

from __future__ import annotations

from math import sqrt

from numba import njit

from gearpoly.proving.gears import FloatArray


@njit(cache=True)
def share(
    n: int, gaps: FloatArray, lever1: FloatArray, lever2: FloatArray, c: FloatArray, lead: float, moment: float,
    force: FloatArray, weight: FloatArray,
) -> tuple[float, float]:  # fmt: skip
    """Turn (rad) of the driving gear that lets n pairs carry a moment (N.mm) on the driven one, and the turn at which
    the first of them alone would carry it all; fills force and weight.

    gaps (mm) are open when positive; c (mm/N) compliance of each pair; lead (mm): gap across the face width, a strip
    that grows with the load carries until the whole width touches.
    """
    if moment <= 0.0:
        turn, first = 1e9, 0
        for i in range(n):
            force[i] = weight[i] = 0.0
            if gaps[i] / lever1[i] < turn:
                turn, first = gaps[i] / lever1[i], i
        weight[first] = 1.0
        return turn, turn
    turn, first = 1e9, 0
    for i in range(n):
        f = moment / lever2[i]
        alone = f * c[i]
        if lead > 0.0:
            alone = sqrt(2 * f * lead * c[i]) if alone < lead / 2 else alone + lead / 2
        if (gaps[i] + alone) / lever1[i] < turn:
            turn, first = (gaps[i] + alone) / lever1[i], i
    all_on_one = turn
    for _ in range(60):
        total, slope = -moment, 0.0
        for i in range(n):
            delta = turn * lever1[i] - gaps[i]
            force[i] = weight[i] = 0.0
            if delta > 0.0:
                if lead > 0.0 and delta < lead:
                    force[i], rate = delta * delta / (2 * lead * c[i]), delta / (lead * c[i])
                else:
                    force[i], rate = (delta - lead / 2) / c[i], 1 / c[i]
                weight[i] = rate * lever1[i] * lever2[i]
                total += force[i] * lever2[i]
                slope += weight[i]
        if slope <= 0.0:
            break
        step = total / slope
        turn -= step
        if abs(step) < 1e-13:
            break
    whole = 0.0
    for i in range(n):
        whole += weight[i]
    if whole <= 0.0:  # so far apart on the way to the position that what bends is lost in the gap
        force[first], weight[first] = moment / lever2[first], 1.0
        return turn, all_on_one
    for i in range(n):
        weight[i] /= whole
    return turn, all_on_one
