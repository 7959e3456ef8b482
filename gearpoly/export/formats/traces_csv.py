"""Measured traces of one drawn gear as CSV, as ``inspection.profile_csv`` of a pair file reads them."""

from __future__ import annotations

from pathlib import Path

from gearpoly.export.drawing import Drawing
from gearpoly.export.measured import TRACE_POINTS, measure, only_gear
from gearpoly.files.traces import TRACE_COLUMNS
from gearpoly.units import UM

ENDINGS = (".traces.csv",)
CURVES = ("lines",)


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """Profile traces of the one gear of ``drawing``: both flanks of all teeth, roll length in mm, deviation in um.

    Pitch and thickness are not in it; a comment says so, and a .gde file holds them too.
    """
    gear = only_gear(drawing, target)
    found = measure(gear, points=drawing.request.detail.points or TRACE_POINTS)
    lines = [
        f"# {drawing.words()}",
        f"# {gear.name} gear: profiles from the design profile; pitch and tooth thickness are not in them",
        *(f"# {remark}; state it as [[{gear.name}.chip]]" for remark in found.remarks(first=0)),
        ",".join(TRACE_COLUMNS),
    ]
    for tooth in range(gear.mounted.gear.z):
        for flank in ("drive", "coast"):
            lines += [f"{tooth},{flank},{l!r},{d / UM!r}" for l, d in zip(*found.trace(flank, tooth), strict=True)]
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return drawing.chord_error
