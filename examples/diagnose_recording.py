"""Name what a simulation left out, and go on with the pair file that holds it."""

from __future__ import annotations

import tempfile
from pathlib import Path

import gearpoly

case = gearpoly.samples() / "recordings" / "encoder_off_centre"
pair = gearpoly.load(case / "pair.toml")
found = pair.diagnose(sorted(case.glob("rec_*.csv")))

for one in found.missing:
    print(f"{one.says} ({one.probability:.2f})")
print(f"unseen data: {found.before_um:.2f} um rms before, {found.after_um:.2f} um after, noise {found.noise_um:.2f} um")
# The bench hid an encoder that reads 400 urad wrong once per turn.
assert [one.claim.physics.name for one in found.missing] == ["encoder_eccentricity"]
value, std = found.missing[0].parameters["amplitude_urad"]
assert abs(value - 400.0) < 3.0 * std
assert found.after_um < 1.05 * found.noise_um
found.plot("diagnose_recording.png")

with tempfile.TemporaryDirectory() as folder:
    fitted = Path(folder) / "fitted.toml"
    found.to_fitted(fitted)
    left = gearpoly.load(fitted).compare(case / "rec_0.csv").residual_rms_um
print(f"the fitted pair leaves {left:.2f} um")
assert left < 1.1 * found.noise_um
