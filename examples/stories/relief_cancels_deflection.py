"""A tip relief that cancels the deflection at the design torque: the recording made there shows nothing wrong.

The pair file knows of neither relief nor bending. Both tips are relieved from the end of single contact on, by so much
that at full torque the mesh ripple is nearly that of the rigid, unmodified teeth of the pair file. Recordings at other
torques show both."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from story import BLUE, GREEN, ORANGE, conceal, mean_over, seen, told, truths

SEED = 23


def main(folder: Path) -> dict[str, object]:
    """Make the case, diagnose it with the design torque alone and with three torques, draw what repeats per mesh."""
    from matplotlib.figure import Figure

    case = conceal(folder / "relief", klass="cancelling", physics="relief_cancels_deflection", seed=SEED)
    alone = case.diagnosed([2])
    whole = case.diagnosed()
    z_2 = whole.comparison.gears[1].z
    pitch = 2.0 * np.pi / z_2
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    axes = figure.subplots(1, 3, sharey=True)
    # What the bench itself says: here curves are laid by a hand-over that the reliefs have moved.
    ripple = case.truth["depth"]["mesh_ripple_um"]
    for plot, one, rms in zip(axes, seen(whole), ripple, strict=True):
        for values, colour, name in (
            (one.recorded, BLUE, "recorded"),
            (one.declared, ORANGE, "declared"),
            (one.fitted, GREEN, "with what was missing"),
        ):
            x, y = mean_over(one.theta_2, values, period=pitch, bins=60)
            dashes = "--" if name != "recorded" else "-"
            plot.plot(x / pitch, y, dashes, color=colour, label=name, lw=1.6 if name != "recorded" else 2.6)
        plot.set_title(f"{one.torque_nm:.1f} N.m: mismatch {rms:.2f} um rms", fontsize=10)
        plot.set_xlabel("driven rotation, pitches")
        plot.spines[["top", "right"]].set_visible(False)
    axes[0].set_ylabel("transmission error, mean per mesh, um")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False)
    figure.savefig(folder / "relief_cancels_deflection.png", dpi=130)
    return {
        "mismatch at every mesh, um rms, by torque": ripple,
        "design torque alone": told(alone),
        "three torques": told(whole),
        "truth": truths(case),
    }


if __name__ == "__main__":
    place = Path(sys.argv[1] if len(sys.argv) > 1 else "out/stories")
    place.mkdir(parents=True, exist_ok=True)
    for key, value in main(place).items():
        print(f"{key}: {value}")
