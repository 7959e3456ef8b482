"""The lost motion of a comparison: in words, as JSON, and as a picture over the driven turn."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np

from gearpoly.compare.lost_motion import Lost
from gearpoly.report.plots import BLUE, GREY, ORANGE
from gearpoly.units import DEG, UM, FloatArray

PLACES_DRAWN = 4000
"""Places that are drawn; more hide one another."""


def lost_rows(lost: Lost) -> Iterator[tuple[str, str]]:
    """Names and words of the lines that tell it: measured, simulated, and by how much they differ."""
    drive, coast = (" and ".join(map(str, these)) for these in lost.recordings)
    yield "lost motion", f"{_words(lost, lost.measured)}; recordings {coast} (coast) against {drive} (drive)"
    mean = float(np.mean(lost.backlash))
    without = "" if mean == float(np.mean(lost.simulated)) else f"; backlash without load {mean / UM:.2f} um"
    yield "simulated there", f"{_words(lost, lost.simulated)}{without}"
    more = f"{lost.beyond / UM:+.2f} +- {lost.std / UM:.2f} um, {lost.arcmin(lost.beyond):+.3f} arcmin"
    yield "measured minus simulated", more


def _words(lost: Lost, along: FloatArray) -> str:
    """Mean, least and most of a lost motion (n,) in mm along the line of action."""
    mean, least, most = float(np.mean(along)), float(np.min(along)), float(np.max(along))
    return (
        f"{lost.arcmin(mean):.3f} arcmin of the driving shaft ({lost.arcmin(least):.3f} to {lost.arcmin(most):.3f}), "
        f"{mean / UM:.2f} um along the line of action ({least / UM:.2f} to {most / UM:.2f})"
    )


def lost_json(lost: Lost) -> dict[str, Any]:
    """Sizes along the line of action in um and as rotations of both shafts in arcmin, and the course over the driven
    turn, tooth by tooth."""
    tooth, measured, simulated = lost.by_tooth()
    drive, coast = lost.recordings
    return {
        "drive_recordings": list(drive),
        "coast_recordings": list(coast),
        "measured": _sizes(lost, lost.measured),
        "simulated": _sizes(lost, lost.simulated),
        "backlash_simulated": _sizes(lost, lost.backlash),
        "measured_minus_simulated_um": lost.beyond / UM,
        "std_um": lost.std / UM,
        "over_driven_turn": {
            "driven_angle_deg": (tooth * (360.0 / lost.z_2)).tolist(),
            "measured_um": (measured / UM).tolist(),
            "simulated_um": (simulated / UM).tolist(),
        },
    }


def _sizes(lost: Lost, along: FloatArray) -> dict[str, float]:
    out = {}
    for name, size in (("mean", np.mean(along)), ("least", np.min(along)), ("most", np.max(along))):
        out[f"{name}_um"] = float(size) / UM
        out[f"{name}_arcmin"] = lost.arcmin(float(size))
        out[f"{name}_driven_arcmin"] = lost.driven_arcmin(float(size))
    return out


def draw_lost(figure: Any, found: Sequence[Lost]) -> None:
    """Draw every lost motion over the driven turn: all places of the hunting cycle as points, the mean over the pitch
    about each driven tooth as steps."""
    axes = figure.subplots(1, len(found), squeeze=False)[0]
    for axis, lost in zip(axes, found, strict=True):
        angle = np.mod(lost.place, 2.0 * math.pi) / DEG
        some = slice(None, None, max(1, angle.size // PLACES_DRAWN))
        tooth, measured, simulated = lost.by_tooth()
        # The turn closes upon itself.
        at = np.append(tooth, tooth[0] + lost.z_2) * (360.0 / lost.z_2)
        for values, mean, colour, name in (
            (lost.measured, measured, BLUE, "measured"),
            (lost.simulated, simulated, ORANGE, "simulated"),
        ):
            axis.plot(angle[some], values[some] / UM, ".", color=colour, markersize=2.5, alpha=0.4)
            words = f"{name}: {lost.arcmin(float(np.mean(values))):.3f} arcmin of the driving shaft in the mean"
            axis.plot(
                at, np.append(mean, mean[0]) / UM, color=colour, drawstyle="steps-mid", linewidth=1.4, label=words
            )
        axis.set_xlabel("driven angle / deg")
        axis.set_ylabel("lost motion along the\nline of action / um")
        drive, coast = (" and ".join(map(str, these)) for these in lost.recordings)
        axis.set_title(
            f"lost motion, recordings {coast} (coast) against {drive} (drive): points over the hunting cycle, "
            "steps the mean over each driven pitch",
            fontsize=9,
        )
        axis.set_xlim(0.0, 360.0)
        low, high = axis.get_ylim()
        axis.set_ylim(low, high + 0.2 * (high - low))  # room for the legend
        per_um = lost.arcmin(UM)
        second = axis.secondary_yaxis(
            "right", functions=(partial(operator.mul, per_um), partial(operator.mul, 1.0 / per_um))
        )
        second.set_ylabel("arcmin of the driving shaft")
        axis.legend(fontsize=8, loc="upper right")
        axis.grid(color=GREY, alpha=0.25, linewidth=0.5)
