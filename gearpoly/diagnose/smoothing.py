"""How softly unloaded teeth touch where a fit of them begins."""

from __future__ import annotations

from gearpoly.diagnose.model import Model
from gearpoly.units import UM

SMOOTHINGS_OVER_F_P = 0.5, 0.125
"""Widths, over the limit f_p of single pitches, of the smooth maximum over touching pairs with which fits of unloaded
teeth begin. Which of two teeth touches decides between local minima. Nine recordings of grade 6 were begun at sixteen
phases of a pitch each. Two rounds with the exact touch came within 1.5 times of the least misfit from no phase of any;
these two and an exact one did so from one or two phases of seven, and six exact ones, in twice the time, of all."""


def smoothings(model: Model, *, limits_over_usual: float = 1.0) -> tuple[float, ...]:
    """Widths in mm of the smooth maximum with which a fit of unloaded teeth begins; none where they are known, or time
    is over. ``limits_over_usual``: by how much wider their limits were taken than usual teeth have them."""
    most = max(gear.single if gear.graded else 0.0 for gear in model.as_built.gears)
    if model.budget.over or model.scope.under_torque or most <= 0.0:
        return ()
    return tuple(part * most / limits_over_usual * UM for part in SMOOTHINGS_OVER_F_P)
