"""A gear that runs off its axis makes a wave once per turn, twice as high as it is off."""

from __future__ import annotations

import numpy as np

import gearpoly

OFF_UM = 10.0
GEAR = {"module_mm": 2.0, "points_per_flank": 400}
eccentric = {"teeth": 18, **GEAR, "eccentricity": {"amplitude_um": OFF_UM, "angle_deg": 40.0}}
pair = gearpoly.Pair.of({"pair": {"centre_distance_mm": 43.05}, "driving": eccentric, "driven": {"teeth": 25, **GEAR}})
run = pair.simulate(turns=18, points_per_mesh=20, fast=True)  # 18 turns of the driven gear are 25 of the driving one

wave = np.exp(-1j * np.radians(run.driving_angle_deg))
amplitude = 2.0 * abs(np.mean((run.te_um - run.te_um.mean()) * wave))
print(f"first order {amplitude:.3f} um, peak to peak {run.te_pp_um:.3f} um")
assert abs(amplitude - OFF_UM) < 0.01 * OFF_UM  # the axis moves the pressure angle too, by a thousandth or so
assert abs(run.te_pp_um - 2.0 * OFF_UM) < 0.02 * OFF_UM
run.plot("eccentric_gear.png")
