"""How softly unloaded teeth touch where a fit of them begins."""

from __future__ import annotations

import numpy as np

from gearpoly.diagnose.model import Model
from gearpoly.units import UM

SMOOTHINGS_OVER_F_P = 0.5, 0.125
"""Widths, over the limit f_p of single pitches, of the smooth maximum over touching pairs with which fits of unloaded
teeth begin. Which of two teeth touches decides between local minima. Of eight recordings, begun within a sixteenth of a
pitch of the right phase, TODO"""


def smoothings(model: Model) -> tuple[float, ...]:
    """Widths in mm of the smooth maximum with which a fit of unloaded teeth begins; none where they are known or fitted
    already, or time is over."""
    most = max(gear.single if gear.graded else 0.0 for gear in model.as_built.gears)
    if model.budget.over or max(model.scope.torques) > 0.0 or most <= 0.0 or np.any(model.built):
        return ()
    return tuple(part * most * UM for part in SMOOTHINGS_OVER_F_P)
