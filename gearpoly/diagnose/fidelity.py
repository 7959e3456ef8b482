"""How far the simulation itself can be trusted."""

from __future__ import annotations

import numpy as np

from gearpoly.units import UM, FloatArray

FAINT_EFFECT_MM = 0.012 * UM
"""mm rms. Effects below this are within what chords, contacts and interpolation leave of the simulation itself."""

OF_CORNERS = 0.01
"""Part of an effect once per turn that depends on where teeth hand over, which nobody knows of tips that are rounded:
of 5 um of an unloaded pair whose teeth are 3 um apart, 0.009 of the effect were not one wave, all of it at corners."""

BY_LAWS = {"mesh_order": 0.01, "condition": 0.025, "mesh_phase": 0.03}
"""Parts of the mean deflection below which what is left at every mesh is no news, since no law of compliance is truer:
waves and means, and short stretches about the corners. Eccentric gears spread it over their turns."""

MEAN_TOOTH_BY_LAWS, BESIDE_ANOTHER = 0.0015, 0.004
"""The same for a physics of the mean tooth, beyond the modes in which laws differ, which are fitted beside it: in 83
healthy loaded pairs of a bench with three other laws it was 0.0007 at most, in two sets of three torques of another
bench, whose law is tilted along the tooth too, 0.0009 and 0.0011. The second is for one beside another, of which
something is left: 0.0011 of a friction in the one such pair of another simulator, so a margin of more than three is
kept. Of a crack's effect its doubt about the law may be left, up to as much: a friction of 0.0015 was made of that."""

OTHERS_BY_LAWS = 0.006
"""Part of the mean deflection below which what is left of single teeth, where it shows, and of other waves is no news:
how they share follows the law. Pits and cracks of 0.004 to 0.006 of it were made of what laws had left."""

OF_DEVIATIONS = 0.03
"""Part of what teeth as built do under load, where an effect of a single tooth shows, below which that is no news: how
a pair that stands out of the others takes load over follows the law, by as much of it as for all of them about the
corners. A pit of 5.7 um was made of that on a sound 17/17 of another simulator, where the same teeth always meet."""

CORNER = 0.2
"""Pitches below which a stretch of a single tooth may be about its corners, where it takes over or lets go."""

BESIDE_MESH = 2
"""Shaft orders beside a mesh order at which eccentric gears put what a law leaves of it."""


def participation(effect: FloatArray) -> float:
    """Part of the samples that count, were an ``effect`` (n,) as large in all of them: 1 over its kurtosis."""
    fourth = float(np.sum(effect**4))
    return float(np.sum(effect**2)) ** 2 / (fourth * effect.size) if fourth > 0.0 else 1.0
