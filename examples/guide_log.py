"""A telescope's guide log: the worm, and the mesh of the gears before it, in seconds of arc on the sky."""

from __future__ import annotations

import gearpoly

known = {
    "name": "EQ6",
    "driving": {"teeth": 12, "module_mm": 0.5},
    "driven": {"teeth": 47, "module_mm": 0.5},
    "worm": {"wheel_teeth": 180},
}
found = gearpoly.Pair.of(known).compare(gearpoly.samples() / "guide_log" / "guide_log.txt")
print("\n".join(found.says))
# The log was made of 5 arcsec per turn of the worm, and 0.4 arcsec at 47 times the worm.
worm = next(one for one in found.where if one["kind"] == "shaft_order")
mesh = next(one for one in found.where if one["kind"] == "time" and one["hz"] > 0.0)
assert abs(worm["amplitude_arcsec"] - 5.0) < 0.1
assert abs(mesh["amplitude_arcsec"] - 0.4) < 0.1
assert abs(1.0 / mesh["hz"] - 478.69 / 47) < 0.1
found.plot("guide_log.png")
