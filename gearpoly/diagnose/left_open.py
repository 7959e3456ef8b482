"""What a state leaves open of the recordings without being physics."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.diagnose.model import Model
from gearpoly.diagnose.nuisance import LawModes, Nuisance, make_nuisance
from gearpoly.scene import Scene

HAND_OVER = 0.1
"""Pitches, one sigma, by which a zero may be wrong where a physics of all teeth was left out: curves are placed by
where pairs hand over, and a relief moves that from the end of double contact to its middle."""


def nuisance_of(model: Model, scenes: list[Scene], laws: LawModes | None) -> Nuisance:
    """What is open of ``scenes`` without being physics, the zeros doubted as the claims make it necessary."""
    scaled = model.declared.model.tooth_deflection
    meshes_otherwise = any(one.physics.mean_tooth for one in model.claims)
    shift_std = max(model.shift_std, HAND_OVER * model.scope.gears[1].tau if meshes_otherwise else 0.0)
    parts = None if laws is None else laws.parts
    return make_nuisance(
        scenes, shift_std=shift_std, laws=parts, scaled=scaled,
        timed=any(model.scope.from_time), apart=_apart(model, scenes),
    )  # fmt: skip


def _apart(model: Model, scenes: list[Scene]) -> float:
    """How far in mm the means of recordings may be apart, one sigma, since some of them wandered and others did not:
    what wanders goes on between recordings too."""
    some = [one for one in model.claims if 0 < len(one.place.recordings) < len(scenes)]
    return math.hypot(*(float(np.ptp(c)) for one in some for c in model.change(scenes, one, one.values, but=one)))
