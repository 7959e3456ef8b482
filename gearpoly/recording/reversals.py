"""Where a shaft turns round, told from readings that tremble.

Derived here. A shaft turns round where it comes back from its farthest reading by more than jitter. Noise of single
samples makes neighbouring steps go against each other; a motion that is sampled often enough does not. So the size of
such steps says how far readings come back without a reversal, whatever the sampling.
"""

from __future__ import annotations

import numpy as np

from gearpoly.units import DEG, FloatArray

BACKWARD_LIMIT = 0.5 * DEG
"""Backward motion in rad that counts as jitter of the reading; more is a real reversal, which changes the flank."""

TREMBLES = 0.02
"""Part of the samples whose two steps have to go against each other for noise to be what turns them."""

NOISE_BACK = 4.0
"""Times the usual size of such pairs of steps by which noise alone may come back. That size is 3.2 standard deviations
of white noise, and the range of 10^6 samples is 10: reversals of noise then come once in more than 10^6 samples."""

REVERSALS_LIMIT = 200
"""Reversals that are looked for; each takes a pass over the rest."""


def runs_on(angle: FloatArray) -> bool:
    """Whether readings (n,) never come back."""
    return bool(np.all(angle[1:] >= angle[:-1]) or np.all(angle[1:] <= angle[:-1]))


def turned_back(angle: FloatArray) -> float:
    """How far in rad a shaft with continuous readings (n,) in rad comes back at most from the farthest one before, in
    the sense in which that is less: 0 where it never does."""
    if runs_on(angle):
        return 0.0
    ahead = float(np.max(np.maximum.accumulate(angle) - angle))
    behind = float(np.max(angle - np.minimum.accumulate(angle)))
    return min(ahead, behind)


def backward_limit(angle: FloatArray) -> float:
    """How far in rad the readings (n,) in rad of a shaft may come back without a reversal: ``BACKWARD_LIMIT``, or what
    their noise and the steps of a coarse encoder make."""
    steps = np.diff(angle)
    against = np.sign(steps[1:]) * np.sign(steps[:-1]) < 0.0
    if np.count_nonzero(against) < TREMBLES * max(angle.size, 1):
        return BACKWARD_LIMIT
    pairs = np.abs(steps[1:] - steps[:-1])[against]
    return max(BACKWARD_LIMIT, NOISE_BACK * float(np.median(pairs)))


def reversals(angle: FloatArray, limit: float | None = None) -> list[int]:
    """Samples at which a shaft with continuous readings (n,) in rad turns round for more than ``limit`` in rad (None:
    its own ``backward_limit``): the farthest readings, at most ``REVERSALS_LIMIT`` of them."""
    if not angle.size or turned_back(angle) <= (BACKWARD_LIMIT if limit is None else limit):
        return []  # the commonest case, without a look at noise
    limit = backward_limit(angle) if limit is None else limit
    out: list[int] = []
    far = np.flatnonzero(np.abs(angle - angle[0]) > limit)
    if not far.size:
        return out
    begin, way = 0, float(np.sign(angle[far[0]] - angle[0]))
    while len(out) < REVERSALS_LIMIT:
        run = way * angle[begin:]
        back = np.flatnonzero(np.maximum.accumulate(run) - run > limit)
        if not back.size:
            return out
        at = begin + int(np.argmax(run[: back[0] + 1]))
        out.append(at)
        begin, way = at, -way
    return out
