"""A simulated run as files: CSV of its curves, JSON of everything."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from gearpoly import __version__
from gearpoly.simulate import Simulation
from gearpoly.units import DEG, UM

CSV_HEADER = "driven_angle_deg,driving_angle_deg,te_urad,te_um,backlash_um,contact_pairs"


def csv_text(simulation: Simulation) -> str:
    """The run as CSV: angles to 1e-9 deg, TE and backlash to 1e-6 um, which is finer than the chords allow."""
    lines = [CSV_HEADER]
    lines += [
        f"{row[0]:.9f},{row[1]:.12f},{row[2]:.6f},{row[3]:.6f},{row[4]:.6f},{int(row[5])}"
        for row in simulation.table().tolist()
    ]
    return "\n".join(lines) + "\n"


def json_text(
    simulation: Simulation, *, name: str, defaults: Sequence[tuple[str, object]], remarks: Sequence[str]
) -> str:
    """The run as JSON."""
    return json.dumps(run_json(simulation, name=name, defaults=defaults, remarks=remarks), allow_nan=False)


def run_json(
    simulation: Simulation, *, name: str, defaults: Sequence[tuple[str, object]], remarks: Sequence[str]
) -> dict[str, Any]:
    """Everything of the run: summary, columns, and every near contact with tooth numbers, place, normal and what
    touches."""
    found, pair, load = simulation.contacts, simulation.pair, simulation.load
    table = simulation.table()
    radius_2 = np.hypot(found.point[:, 0] - pair.a, found.point[:, 1])
    return {
        "gearpoly": __version__,
        "pair": name,
        "flank": simulation.flank,
        "seed": simulation.seed,
        "gears": dict(zip(("driving", "driven"), simulation.assembled.origin, strict=True)),
        "centre_distance_mm": pair.a,
        "tight_centre_distance_mm": pair.a_w,
        "working_pressure_angle_deg": pair.alpha_w / DEG,
        "base_radius_mm": [pair.r_b1, pair.r_b2],
        "defaults": dict(defaults),
        "remarks": list(remarks),
        "summary": simulation.summary(),
        "columns": {key: table[:, k].tolist() for k, key in enumerate(CSV_HEADER.split(","))}
        | ({} if load is None else {"mesh_stiffness_n_per_um": (load.stiffness * UM).tolist()}),
        "contacts": {
            "position": found.position.tolist(),
            "driving_tooth": found.driving.tolist(),
            "driven_tooth": found.driven.tolist(),
            "touches": simulation.touches.tolist(),
            "gap_um": (found.gap / UM).tolist(),
            "point_mm": found.point.tolist(),
            "normal": found.normal.tolist(),
            "driving_radius_mm": np.hypot(found.point[:, 0], found.point[:, 1]).tolist(),
            "driven_radius_mm": radius_2.tolist(),
            **({} if load is None else {"force_n": load.force.tolist(), "share": load.share.tolist()}),
            "feature": [("flank", "driving_tip_corner", "driven_tip_corner")[k] for k in found.feature.tolist()],
        },
    }
