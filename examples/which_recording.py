"""Before anything is recorded: which recordings tell an eccentric gear from an encoder off its centre."""

from __future__ import annotations

from matplotlib.figure import Figure

import gearpoly

plan = gearpoly.load(gearpoly.samples() / "pairs" / "ideal_18_25.toml").plan()
print("\n".join(f"{k}. {one}" for k, one in enumerate(plan.says, 1)))

alike = {(one["one"], one["other"]): one for one in plan.to_dict()["look_alikes"]}
gear_or_encoder = alike["eccentricity driving", "encoder_eccentricity driving"]
best = max(sine for sine in gear_or_encoder["after"] if sine is not None)
print(f"gear or encoder: {gear_or_encoder['separability']:.2f} with the first recording, {best:.2f} with all")
assert gear_or_encoder["separability"] < 0.1 < 0.5 < best

figure = Figure(figsize=(7.0, 6.0), layout="constrained")
axis = figure.subplots()
sines = [gear_or_encoder["separability"], *gear_or_encoder["after"]]
axis.plot(range(1, len(sines) + 1), [float("nan") if sine is None else sine for sine in sines], "o-")
axis.set_ylim(0.0, 1.05)
axis.set_xticks(range(1, len(sines) + 1), [str(k) for k in range(1, len(sines) + 1)])
axis.set_xlabel("recordings made, in the order of the plan")
axis.set_ylabel("eccentric gear or encoder: sine between them")
figure.savefig("which_recording.png")
