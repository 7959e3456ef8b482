"""What a torsional resonance adds to the transmission error of a mesh, over angles or over time."""

from __future__ import annotations

import numpy as np

from gearpoly.mesh.pair import GearPair
from gearpoly.mesh.shafts import Shafts, swings_along
from gearpoly.units import FloatArray

SWINGS_PER_MESH = 128
"""Places per pitch at which a curve is known that makes a resonance swing: of 3 um of rough teeth without load, swings
of 13 um then come out to 7 nm, of 2 um at six times the mesh frequency to 15 nm."""


def swings_at(
    shafts: Shafts,
    te: FloatArray,
    pair: GearPair,
    theta_2: FloatArray,
    here: FloatArray,
    *,
    speed: float | None,
    time: FloatArray | None,
    backward: bool = False,
) -> FloatArray:
    """What a resonance adds (N,) at ``theta_2`` (N,) in rad to the curve ``te`` (m,) of a hunting cycle, which is
    ``here`` (N,) there, in its unit: settled at a driving ``speed`` in rad/s (None: it is not turning), or as it
    follows the speed that ``time`` (N,) in s tells, which near a resonance counts by the thousandth. ``backward``: the
    last comes first, by a ``time`` that counts back from the end."""
    if backward:
        mirrored, ahead = np.roll(te[::-1], 1), None if time is None else time[-1] - time[::-1]
        return swings_at(shafts, mirrored, pair, -theta_2[::-1], here[::-1], speed=speed, time=ahead)[::-1]
    if time is not None and time[-1] > time[0]:
        pitch = pair.cycle / pair.meshes_per_cycle
        return swings_along(shafts, te, cycle=pair.cycle, pitch=pitch, theta_2=theta_2, time=time, here=here)
    if speed is None:
        return np.zeros(theta_2.size)
    period = pair.cycle / (speed * pair.ratio)
    even = np.arange(te.size) * (pair.cycle / te.size)
    added, known = (np.interp(theta_2, even, one, period=pair.cycle) for one in (shafts.swings(te, period=period), te))
    return np.asarray(added + shafts.unmoved(here - known, rate=te.size / period))
