"""Teeth that bend and reliefs that cancel it, as makers choose them: a state that no single step leads to."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.assemble import assemble
from gearpoly.diagnose.model import Model
from gearpoly.errors import GearpolyError
from gearpoly.keys.edit import changed
from gearpoly.mesh.deflection import pair_compliance
from gearpoly.physics.base import Claim
from gearpoly.units import UM


def relieved(model: Model) -> list[Claim]:
    """Bending by the declared law and reliefs of both gears, as deep as one pair of teeth then bends under the highest
    torque and as long as reliefs are; nothing where no recording is loaded, a relief is declared or a face width is
    not, the declared law does not know such teeth, or either physics was struck from the catalogue.

    At the torque of such a design neither shows, and each alone makes the other torques worse: a search that claims one
    after the other takes wind-up and crowning instead.
    """
    scope, catalogue = model.scope, {one.name: one for one in model.method.physics}
    if not scope.under_torque or "tip_relief" not in catalogue:
        return []
    if any(scope.section(gear).tip_relief is not None or scope.section(gear).face_width_mm is None for gear in (0, 1)):
        return []
    out: list[Claim] = []
    if not scope.file.model.tooth_deflection:
        if "tooth_deflection" not in catalogue:
            return []
        bending = catalogue["tooth_deflection"]
        out = [Claim(physics=bending, place=place, values=(1.0,)) for place in bending.places(scope)]
    try:
        depth = pitch_point_compliance(model) * max(scope.torques) / scope.gears[1].r_b
    except GearpolyError:  # teeth that the declared law does not know to bend
        return []
    relief = catalogue["tip_relief"]
    for gear in (0, 1):
        longest = max(
            (one for one in relief.places(scope) if one.gear == gear), key=lambda one: one.shape, default=None
        )
        if longest is None:
            return []
        out.append(Claim(physics=relief, place=longest, values=(depth, *longest.shape)))
    return out


def pitch_point_compliance(model: Model) -> float:
    """Compliance in um/N of one pair at the pitch point by the declared law, contact included."""
    file = changed(model.declared, model=changed(model.declared.model, tooth_deflection=True, compliance_scale=1.0))
    assembled = assemble(file, path=model.path, seed=0)
    assert assembled.elasticity is not None
    by = pair_compliance(assembled.pair, assembled.elasticity)
    point = np.array([[assembled.pair.r_b1 / math.cos(assembled.pair.alpha_w), 0.0]])
    zero = np.zeros(1, dtype=np.int64)
    force = np.array([max(max(model.scope.torques), 1.0) / assembled.pair.r_b2])
    return float(by.secant(force, by.teeth(zero, zero, point), point)[0]) / UM
