"""What tips within their tolerance do where pairs of teeth take over from each other: a centre distance does it too."""

from __future__ import annotations

import numpy as np

from gearpoly.diagnose.model import Model
from gearpoly.diagnose.teeth_scale import is_unstated
from gearpoly.diagnose.unearned import Unearned
from gearpoly.units import UM


def as_tips(model: Model, one: Unearned) -> bool:
    """Whether a place is a centre distance that tips within their tolerance would show as well: on one flank, of gears
    of which neither grade nor inspection is stated. A sound printed pair had been told of axes 11 um too near."""
    if one.claim.physics.name != "centre_distance" or len(model.as_built.flanks) > 1:
        return False
    gears = [gear for gear in (0, 1) if is_unstated(model, gear)]
    within = sum(0.5 * it11(2.0 * model.scope.gears[gear].r_a) for gear in gears)
    return abs(one.claim.values[0]) * UM < within


def it11(diameter: float) -> float:
    """The standard tolerance of grade 11 of a ``diameter`` in mm, in mm: 100 i with i = 0.45 D^(1/3) + 0.001 D in um
    (ISO 286-1, tolerance factor i of grades 5 to 18). Tip diameters are turned to h11 as a rule."""
    return 100.0 * (0.45 * float(np.cbrt(diameter)) + 0.001 * diameter) * UM
