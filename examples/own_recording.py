"""A recording from arrays: your own program measured both angles, and nothing is written to a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import gearpoly

NOISE_UM, CYCLES = 0.4, 3
gear = {"module_mm": 2.0, "points_per_flank": 300, "inspection": {"tooth_thickness_um": -60.0, "uncertainty_um": 0.2}}
rng = np.random.default_rng(1)
driving = gear | {"teeth": 11, "inspection": gear["inspection"] | {"pitch_um": rng.normal(0.0, 4.0, 11).tolist()}}
driven = gear | {"teeth": 13, "inspection": gear["inspection"] | {"pitch_um": rng.normal(0.0, 4.0, 13).tolist()}}
pair = gearpoly.Pair.of({"name": "mine", "driving": driving, "driven": driven})

run = pair.simulate(turns=11.0, points_per_mesh=25, fast=True)  # one hunting cycle
turn = 360.0 * 11.0 * np.arange(CYCLES)[:, None]
driven_deg = (run.driven_angle_deg + turn).ravel()
noise_deg = np.degrees(NOISE_UM * 1e-3 / pair.mesh.r_b1) * rng.standard_normal(driven_deg.size)
driving_deg = (run.driving_angle_deg + turn * 13.0 / 11.0).ravel() + noise_deg

mine = gearpoly.Recording(
    source=Path("mine"), driving_angle_rad=np.radians(driving_deg), driven_angle_rad=np.radians(driven_deg)
)
found = pair.compare(mine)
print(f"left {found.residual_rms_um:.3f} um rms, noise {found.noise_um:.3f} um, {len(found.where)} places")
assert abs(found.noise_um - NOISE_UM) < 0.03 * NOISE_UM
assert not found.where
found.plot("own_recording.png")
