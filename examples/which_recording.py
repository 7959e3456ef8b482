"""Before anything is recorded: which recordings tell an eccentric gear from an encoder off its centre."""

from __future__ import annotations

import gearpoly

plan = gearpoly.load(gearpoly.samples() / "pairs" / "ideal_18_25.toml").plan()
print("\n".join(f"{k}. {one}" for k, one in enumerate(plan.says, 1)))

alike = {(one["one"], one["other"]): one for one in plan.to_dict()["look_alikes"]}
gear_or_encoder = alike["eccentricity driving", "encoder_eccentricity driving"]
best = max(sine for sine in gear_or_encoder["after"] if sine is not None)
print(f"gear or encoder: {gear_or_encoder['separability']:.2f} with the first recording, {best:.2f} with all")
assert gear_or_encoder["separability"] < 0.1 < 0.5 < best
