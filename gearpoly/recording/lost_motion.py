"""The lost motion between two runs of one recording, forth and back over the same angles.

Derived here. At one place of the driven shaft the driving shaft stands apart by the lost motion between a run that
carries on the drive flanks and one on the coast flanks; a transmission error that the rig computed is higher by as much
on the coast flanks. Neither needs to know the pair.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.recording.recording import Recording
from gearpoly.units import ARCMIN, UM, FloatArray

CELLS_PER_TURN = 64
"""Places per turn at which both runs are compared; about one a tooth, so that the mesh's own waves average."""

ENDS = 2
"""Places left out at either end, where a shaft that turns round takes up the lost motion."""

LEAST_LOST_MOTION_RAD = 0.3 * ARCMIN
"""rad. Less is no change of flanks: where the load hangs on one flank friction makes the pair come back 0.05 arcmin
apart (0.18 um; 12 on 16 teeth of module 2, 80 N.m, a coefficient of 0.05), 0.11 at twice that. Backlash of a module 1
is ten times as much."""

LEAST_ALONG = 1.5 * UM
"""mm. The same along the line of action, at a base radius of 17 mm."""

SIGMAS = 5.0
"""Standard errors of the mean over all places by which a lost motion is seen."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LostMotion:
    """How far a run back stands from a run forth: ``by`` (n,) at readings ``place`` (n,) in rad of the driven shaft, or
    of the one that was read. In rad of the driving shaft, in rad on the driven side where only a transmission error
    tells (``side``), in mm where that is along the line of action (``along``). Positive where the run back carries on
    the coast flanks."""

    place: FloatArray
    by: FloatArray
    side: str
    along: bool

    @property
    def mean(self) -> float:
        """Mean over all places."""
        return float(np.mean(self.by))

    @property
    def seen(self) -> bool:
        """Whether the flank changed, beyond friction and noise."""
        error = float(np.std(self.by)) / math.sqrt(self.by.size)
        return abs(self.mean) > max(LEAST_ALONG if self.along else LEAST_LOST_MOTION_RAD, SIGMAS * error)

    @property
    def says(self) -> str:
        """The lost motion in words."""
        unit, what = (UM, "um along the line of action") if self.along else (ARCMIN, f"arcmin of the {self.side} shaft")
        mean, least, most = (x / unit for x in (self.mean, float(np.min(self.by)), float(np.max(self.by))))
        return f"{mean:.3g} {what} (from {least:.3g} to {most:.3g})"


def between(forth: Recording, back: Recording) -> LostMotion | None:
    """The lost motion between two runs whose angles count together; None where they share no angles."""
    curves = [_curve(one) for one in (forth, back)]
    (x, y), (x_back, y_back) = curves
    if not x.size or not x_back.size:  # no sample of a run holds both
        return None
    low, high = max(x[0], x_back[0]), min(x[-1], x_back[-1])
    width = 2.0 * math.pi / CELLS_PER_TURN
    here = (x > low + ENDS * width) & (x < high - ENDS * width)
    if np.count_nonzero(here) < ENDS:
        return None
    by = np.interp(x[here], x_back, y_back) - y[here]
    side = "driven" if forth.computed else "driving"
    return LostMotion(place=x[here], by=by, side=side, along=forth.te_mm is not None)


def _curve(one: Recording) -> tuple[FloatArray, FloatArray]:
    """What a run holds at rising places (n,) in rad: minus the driving angle over the driven one, or the transmission
    error over the angle beside it; means of cells, at the mean place in each."""
    driving, driven = one.driving_angle_rad, one.driven_angle_rad
    if one.computed:
        angle, way = (driving, one.driving_direction) if driven is None else (driven, one.driven_direction)
        y = one.te_rad if one.te_mm is None else one.te_mm
    else:
        angle, way = driven, one.driven_direction
        y = None if driving is None else -one.driving_direction * driving
    assert angle is not None  # a Recording has two of the three
    assert y is not None
    good = np.isfinite(angle) & np.isfinite(y)
    x, values = way * angle[good], y[good]
    _, cell = np.unique(np.floor(x * (CELLS_PER_TURN / (2.0 * math.pi))), return_inverse=True)
    held = np.bincount(cell)
    return np.bincount(cell, weights=x) / held, np.bincount(cell, weights=values) / held
