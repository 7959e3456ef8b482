"""Perfect gears transmit evenly: no transmission error, no backlash, and the contact ratio of the textbook."""

from __future__ import annotations

import math

import gearpoly

GEAR = {"module_mm": 2.0, "points_per_flank": 2000}
pair = gearpoly.Pair.of({"driving": {"teeth": 18, **GEAR}, "driven": {"teeth": 25, **GEAR}})
run = pair.simulate(turns=1 / 3, points_per_mesh=80)  # six of 18 teeth, which are all alike

# ISO 21771: the path between both tip circles over the base pitch.
first, second = pair.driving.nominal, pair.driven.nominal
path = first.l_a + second.l_a - pair.mesh.a * math.sin(pair.mesh.alpha_w)
contact_ratio = path / (math.pi * 2.0 * math.cos(math.radians(20.0)))

print(
    f"TE {1e3 * run.te_pp_um:.2f} nm peak to peak, contact ratio {run.contact_ratio:.4f}, textbook {contact_ratio:.4f}"
)
assert run.te_pp_um < 2e-4  # um: twice what chords of 2000 points stand off
assert run.contact_ratio is not None
assert abs(run.contact_ratio - contact_ratio) < 1e-3  # 80 positions a pitch
run.plot("ideal_pair.png")
