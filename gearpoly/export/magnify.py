"""Deviations made large enough to be seen: the same shapes, K times as far along the normal.

Only flank deviations are exaggerated: pitch, thickness, profile, relief. Rack, tip circle, missing tips, bore and the
place of the axes (eccentricity too) stay true.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearpoly.errors import GearpolyError
from gearpoly.gear.deviations import Deviations, Scatter, Shape, Span
from gearpoly.units import FloatArray, read_only

LARGEST_MAGNIFICATION = 1e6
"""Magnification beyond which 1 nm would be a tooth of module 0.5; a larger one is a slip of the keyboard."""

TANGENT_STEP = 1e-6
"""Share of the tip's roll length over which the tangent there is taken: curvature spoils 1e-6 of it, rounding less."""

RESOLUTION = 1e-3
"""Share of K to which the onset of crossing teeth is searched; the message rounds to three digits."""


@dataclass(frozen=True)
class Scaled:
    """``K`` times another shape, straight on beyond the tip and level inside the base circle.

    A flank moved in by K d has to go on past its own tip to reach the tip circle; a relief's parabola would run away
    with it there, a tangent does not.
    """

    shape: Shape
    K: float

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        inside = np.clip(l, 0.0, span.l_a)
        step = TANGENT_STEP * span.l_a
        ends = self.shape(np.broadcast_to([[span.l_a - step, span.l_a]], (l.shape[0], 2)), span)
        slope = (ends[:, -1:] - ends[:, :1]) / step
        return self.K * (self.shape(inside, span) + slope * np.maximum(0.0, l - span.l_a))


def magnified(deviations: Deviations, K: float) -> Deviations:
    """``deviations`` with every normal deviation times ``K`` (dimensionless; 1 changes nothing, 0 leaves the ideal
    gear)."""
    if K == 1.0:
        return deviations
    return Deviations(
        drive=tuple(_scaled(shape, K) for shape in deviations.drive),
        coast=tuple(_scaled(shape, K) for shape in deviations.coast),
        chips=deviations.chips,
    )


def _scaled(shape: Shape, K: float) -> Shape:
    # Point-wise scatter is drawn in its own way, so it has to stay what it is.
    if isinstance(shape, Scatter):
        return Scatter(shape.l, tuple(read_only(K * values) for values in shape.deviation))
    return Scaled(shape, K)


def onset(attempt: Callable[[float], object], *, bad: float) -> float:
    """The magnification from which on ``attempt(K)`` fails with a ``GearpolyError``, known to fail at ``bad``.

    Halving between 0 (the ideal gear) and ``bad``, to ``RESOLUTION``; 0 where even the ideal gear fails.
    """

    def fails(K: float) -> bool:
        try:
            attempt(K)
        except GearpolyError:
            return True
        return False

    if fails(0.0):
        return 0.0
    low, high = 0.0, bad
    while high - low > RESOLUTION * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if fails(middle) else (middle, high)
    return low
