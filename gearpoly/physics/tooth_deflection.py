"""Teeth that bend where the simulation holds them rigid."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from gearpoly.keys.edit import changed
from gearpoly.keys.sections import PairFile
from gearpoly.physics.base import RUN, Physics, Quantity, Scope
from gearpoly.physics.bounds import always
from gearpoly.physics.place import Place, Values
from gearpoly.physics.words import Reported
from gearpoly.units import FloatArray


def _places(scope: Scope) -> Iterable[Place]:
    widths = [scope.section(gear).face_width_mm for gear in (0, 1)]
    if not scope.file.model.tooth_deflection and scope.under_torque and None not in widths:
        yield Place(probe=(1.0,))


def _write(file: PairFile, place: Place, values: Values) -> PairFile:
    if values[0] <= 0.0:
        return file
    model = changed(file.model, tooth_deflection=True, compliance_scale=float(np.clip(values[0], 0.01, 100.0)))
    copy: PairFile = changed(file, model=model)
    return copy


def _report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
    """In parts of what the simulation's law gives; the diagnosis turns it into um/N at the pitch point."""
    return {"compliance_scale": (float(values[0]), math.sqrt(max(float(covariance[0, 0]), 0.0)))}


PHYSICS = Physics(
    name="tooth_deflection",
    rank=RUN,
    source="docs/explanation/compliance.md: five laws, each with its source",
    stands="model.tooth_deflection, model.compliance_scale, model.compliance, model.contact",
    parameters=("compliance_um_per_n",),
    case=(Place(), (1.2,)),
    coordinates=(
        Quantity(
            name="scale",
            unit="1",
            low=0.0,
            most=always(100.0),
            why="plastics are a hundred times as soft as steel",
            step=0.02,
        ),
    ),
    amplitudes=1,
    ordinary=(1.0,),
    places=_places,
    mean_tooth=True,
    law_doubt=0.05,
    write=_write,
    report=_report,
    says=lambda place, v: "The teeth bend under load.",
    equation="x = (sum k_i e_i - F)/sum k_i over the touching pairs, k_i from the outline of each tooth",
)
