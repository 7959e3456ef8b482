"""Pair files made in memory, and their transmission error straight from the kernel."""

from __future__ import annotations

from typing import Any

import numpy as np

from gearpoly.assemble import Assembled, assemble
from gearpoly.files.models import PairFile
from gearpoly.mesh.deflection import PairCompliance, pair_compliance
from gearpoly.mesh.loaded import LoadedContacts, load_reach, loaded
from gearpoly.mesh.pair import Flank
from gearpoly.mesh.transmission import NEAR_PAIR_MM, contacts
from gearpoly.units import NM, FloatArray

Table = dict[str, Any]


def pair_file(
    z: tuple[int, int] = (18, 25),
    *,
    pair: Table | None = None,
    model: Table | None = None,
    driving: Table | None = None,
    driven: Table | None = None,
    points: int = 1200,
    inspected: bool = True,
) -> PairFile:
    """A pair of module 2 with further keys; teeth are 60 um thin, so that both flanks are apart, and ``inspected`` to
    0.2 um. With 1200 points chords lag by less than 0.3 nm."""

    def one(teeth: int, more: Table | None) -> Table:
        basis = {"teeth": teeth, "module_mm": 2.0, "face_width_mm": 20.0, "points_per_flank": points}
        if not inspected:
            return basis | (more or {})
        inspection = {"tooth_thickness_um": -60.0, "uncertainty_um": 0.2} | (more or {}).pop("inspection", {})
        return basis | {"inspection": inspection} | (more or {})

    return PairFile.model_validate(
        {
            "pair": pair or {},
            "model": model or {},
            "driving": one(z[0], dict(driving or {})),
            "driven": one(z[1], dict(driven or {})),
        }
    )


def made(file: PairFile) -> Assembled:
    """The pair of a file that names no other file."""
    return assemble(file, path="pair.toml", seed=0)


def one_pitch(assembled: Assembled, count: int = 240, *, meshes: int = 1) -> FloatArray:
    """Driven rotations (count,) in rad over some meshes; the start is off every mark, so that no position falls on the
    end of a path."""
    return (0.0037 + np.arange(count) / count) * meshes * assembled.pair.driven.gear.tau


def under(
    assembled: Assembled, theta_2: FloatArray, torque_nm: float, *, flank: Flank = "drive"
) -> tuple[LoadedContacts, PairCompliance]:
    """The mesh alone under load, and its compliance."""
    assert assembled.elasticity is not None
    by = pair_compliance(assembled.pair, assembled.elasticity, flank=flank)
    near = NEAR_PAIR_MM + load_reach(by, torque_nm * NM)
    found = contacts(assembled.pair, theta_2, flank=flank, near=near, fast=True)
    return loaded(found, by, torque=torque_nm * NM, sharing=assembled.sharing), by


def unloaded_te(assembled: Assembled, theta_2: FloatArray, *, flank: Flank = "drive") -> FloatArray:
    """Unloaded transmission error (n,) in mm along the line of action."""
    return contacts(assembled.pair, theta_2, flank=flank, near=0.0, fast=True).te * assembled.pair.r_b2
