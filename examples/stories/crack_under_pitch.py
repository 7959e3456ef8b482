"""A cracked tooth beneath larger pitch errors: load changes the crack and leaves the pitch as it is.

One revolution of the driven gear shows pitch errors of many micrometres at any torque. What one tooth gives more than
the others under load is less than that, and nothing unloaded."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from story import BLUE, GREY, ORANGE, conceal, mean_over, seen, told, truths

SEED = 37


def main(folder: Path) -> dict[str, object]:
    """Make the case, diagnose it unloaded and at three torques, draw it per tooth."""
    from matplotlib.figure import Figure

    case = conceal(folder / "crack", klass="masked", physics="crack_under_pitch", seed=SEED)
    (true,) = case.truth["truth"]
    light = case.diagnosed([0])
    whole = case.diagnosed()
    gear = true["gear"] - 1
    z = whole.comparison.gears[gear].z
    ratio = whole.comparison.gears[1].z / whole.comparison.gears[0].z
    per_tooth = []
    for one in seen(whole):
        angle = one.theta_2 * (ratio if gear == 0 else 1.0)
        # Half a pitch early, so that the bin of a tooth is the mesh about its own pitch point.
        _, mean = mean_over(angle + np.pi / z, one.recorded - one.declared, period=2.0 * np.pi, bins=z)
        per_tooth.append(mean - np.mean(mean))
    found = [one.tooth for one in whole.findings if one.claim.physics.name == "tooth_crack"]
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    n = np.arange(z)
    pitch = np.array(case.truth["as_built"]["driving" if gear == 0 else "driven"]["pitch_um"])
    left.bar(n, pitch, color=GREY, label="index deviations of the gear as cut")
    left.plot(n, per_tooth[2] - per_tooth[0], "o-", color=ORANGE, label="what load adds, mean per tooth")
    left.set_ylabel("um")
    left.set_title("The crack is smaller than the pitch errors", fontsize=10)
    for one, mean, colour in zip(seen(whole), per_tooth, (GREY, BLUE, ORANGE), strict=True):
        right.plot(n, mean - per_tooth[0], "o-", color=colour, label=f"{one.torque_nm:.1f} N.m")
    for tooth in found:
        right.axvline(float(tooth or 0), color="k", ls=":", lw=1, label=f"named: tooth {tooth}")
    right.set_title("Recorded less simulated, less the same unloaded", fontsize=10)
    for plot in (left, right):
        plot.set_xlabel(f"tooth of the {'driving' if gear == 0 else 'driven'} gear")
        plot.spines[["top", "right"]].set_visible(False)
        plot.legend(frameon=False, fontsize=8)
    figure.savefig(folder / "crack_under_pitch.png", dpi=130)
    return {
        "light torque alone": told(light),
        "three torques": told(whole),
        "truth": truths(case),
        "cracked tooth": true["tooth"],
        "tooth named": found,
    }


if __name__ == "__main__":
    place = Path(sys.argv[1] if len(sys.argv) > 1 else "out/stories")
    place.mkdir(parents=True, exist_ok=True)
    for key, value in main(place).items():
        print(f"{key}: {value}")
