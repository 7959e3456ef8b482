"""Lay a recording on the simulation of its pair: what is left, what of it is noise, and where it is."""

from __future__ import annotations

import gearpoly

case = gearpoly.samples() / "recordings" / "eccentric_low_tooth"
found = gearpoly.load(case / "pair.toml").compare(case / "rec_0.csv")

print(f"left {found.residual_rms_um:.2f} um rms, of which noise {found.noise_um:.3f} um")
print("\n".join(found.says))
# The bench hid an axis 9 um off, at 0.3 um of noise. A low tooth and as-built pitches take some of the first order.
first = found.where[0]
assert (first["kind"], first["gear"], first["order"]) == ("shaft_order", "driven", 1)
assert abs(first["amplitude_um"] - 9.0) < 0.5
assert abs(found.noise_um - 0.3) < 0.02
found.plot("compare_recording.png")
