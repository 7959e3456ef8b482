"""An encoder mistaken for an eccentric gear: on one flank nothing tells them apart, on both a phase does.

A gear that runs off its axis shows once per turn, and on the coast flank later by twice the pressure angle: the line of
action leans the other way. An encoder off its axis shows the same on both flanks."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from story import BLUE, GREY, ORANGE, conceal, seen, told, truths

SEED = 18
OVER = 40.0


def main(folder: Path) -> dict[str, object]:
    """Make the case, diagnose it from the drive flank and from both, draw the order-1 vectors."""
    from matplotlib.figure import Figure

    case = conceal(folder / "encoder", klass="one_flank", physics="encoder_eccentricity", seed=SEED, over=OVER)
    (true,) = case.truth["truth"]
    drive = case.diagnosed([0])
    both = case.diagnosed()
    gear = true["gear"] - 1
    ratio = both.comparison.gears[1].z / both.comparison.gears[0].z
    vectors = []
    for one in seen(both):
        angle = one.theta_2 * (ratio if gear == 0 else 1.0)
        vectors.append(2.0 * complex(np.mean((one.recorded - one.declared) * np.exp(-1j * angle))))
    alpha = both.comparison.assembled.pair.alpha_w
    # x = c . n on the drive flank and -c . n on the coast flank, n the normals at +-(90 deg - alpha) to the line of
    # centres, c the driving gear's centre, turning on; the driven one's turns back and counts the other way round.
    turned = vectors[0] * np.exp((-2j if gear == 0 else 2j) * alpha)
    figure = Figure(figsize=(10.0, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for one, colour in zip(seen(both), (BLUE, ORANGE), strict=True):
        angle = np.mod(one.theta_2 * (ratio if gear == 0 else 1.0), 2.0 * np.pi)
        bins = np.floor(angle / (2.0 * np.pi) * 72).astype(int) % 72
        rest = one.recorded - one.declared
        mean = np.bincount(bins, weights=rest, minlength=72) / np.maximum(np.bincount(bins, minlength=72), 1)
        left.plot((np.arange(72) + 0.5) * 5.0, mean, color=colour, label=f"{one.flank} flank")
    left.set_xlabel(f"rotation of the {'driving' if gear == 0 else 'driven'} shaft, deg")
    left.set_ylabel("recorded less simulated, mean over turns, um")
    left.set_title("Once per turn, on either flank", fontsize=10)
    left.legend(frameon=False)
    reach = 1.25 * max(abs(v) for v in vectors)
    for value, colour, name in (
        (turned, GREY, "coast, were it the gear"),
        (vectors[0], BLUE, "drive, recorded"),
        (vectors[1], ORANGE, "coast, recorded"),
    ):
        right.annotate("", (value.real, value.imag), (0, 0), arrowprops={"arrowstyle": "->", "color": colour, "lw": 2})
        right.plot([], [], color=colour, label=name)
    right.plot(*np.array([[reach * np.cos(t), reach * np.sin(t)] for t in np.linspace(0, 6.3, 99)]).T, lw=0)
    right.set_aspect("equal")
    right.set_xlabel("in phase with the shaft, um")
    right.set_ylabel("a quarter turn later, um")
    right.set_title("A gear would turn by twice the pressure angle", fontsize=10)
    right.legend(frameon=False, fontsize=8, loc="upper left")
    for plot in (left, right):
        plot.spines[["top", "right"]].set_visible(False)
        plot.axhline(0, color="#dddddd", lw=0.8, zorder=0)
    figure.savefig(folder / "encoder_or_gear.png", dpi=130)
    advice = [one.separation.recording.says for one in drive.findings if one.separation is not None]
    return {
        "drive flank alone": told(drive),
        "advice": advice,
        "both flanks": told(both),
        "truth": truths(case),
        "phase between the flanks, deg": float(np.degrees(np.angle(vectors[1] / vectors[0]))),
        "of a gear it would be, deg": float(np.degrees(2.0 * alpha)),
    }


if __name__ == "__main__":
    place = Path(sys.argv[1] if len(sys.argv) > 1 else "out/stories")
    place.mkdir(parents=True, exist_ok=True)
    for key, value in main(place).items():
        print(f"{key}: {value}")
