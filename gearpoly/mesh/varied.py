"""What teeth give under a torque that is off its mean: a parabola through three loads.

Deflection is no part of the torque: more pairs come to carry, and contacts harden (Hertz).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearpoly.mesh.deflection import PairCompliance
from gearpoly.mesh.loaded import Sharing, loaded
from gearpoly.mesh.transmission import FlankContacts
from gearpoly.units import FloatArray

GENTLE, LIGHTEST = 0.05, 0.95
"""Part of the mean by which a torque may be off it for teeth to give by their stiffness alone (at 0.02 a straight line
errs by 0.04 of what changes), and the most by which less load is simulated: without load there is no stiffness."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Giving:
    """How the transmission error changes with the torque: ``up`` (N,) per part of the mean torque that is added, seen
    from ``most`` (no dimension) more, and ``down`` (N,), seen from ``least`` less; in the unit of the error."""

    up: FloatArray
    down: FloatArray
    most: float
    least: float

    def by(self, off: FloatArray) -> FloatArray:
        """What is added (N,) where the torque is off its mean by the part ``off`` (N,) of it."""
        level = self.up * self.least + self.down * self.most
        return np.asarray(off * (level + off * (self.up - self.down)) / (self.most + self.least))

    def times(self, factor: float) -> Giving:
        """The same in another unit."""
        return replace(self, up=factor * self.up, down=factor * self.down)

    def interpolated(self, at: FloatArray, places: FloatArray) -> Giving:
        """The same at ``at`` (M,), along straight lines between ``places`` (N,), rising."""
        up, down = (np.interp(at, places, one) for one in (self.up, self.down))
        return replace(self, up=up, down=down)


def giving(
    rows: FlankContacts, by: PairCompliance, te: FloatArray, *, torque: float, most: float, sharing: Sharing
) -> Giving:
    """How teeth that touch as in ``rows`` give about the mean ``torque`` (N.mm), under which the transmission error is
    ``te`` (N,) in rad, for a torque that is off it by the part ``most`` of it."""
    most = max(most, GENTLE)
    least = min(most, LIGHTEST)
    more, less = (loaded(rows, by, torque=part * torque, sharing=sharing).te for part in (1.0 + most, 1.0 - least))
    return Giving(up=(more - te) / most, down=(te - less) / least, most=most, least=least)
