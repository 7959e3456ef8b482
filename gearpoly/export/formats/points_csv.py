"""Points as a table: every vertex of every outline, with the tooth and the part of it that it lies on."""

from __future__ import annotations

import json
from pathlib import Path

from gearpoly.export.drawing import Drawing

ENDINGS = (".csv",)
CURVES = ("lines",)

HEADER = "gear,ring,tooth,part,side,x_mm,y_mm"


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """``drawing`` as CSV: comment lines ``# key = value``, then each ring's points in counter-clockwise order.

    A land's tooth is the one before it, counter-clockwise; bores have no tooth. Coordinates to 0.01 nm.
    """
    lines = [
        f"# {key} = {json.dumps(value, ensure_ascii=False)}" for key, value in drawing.statement(curves=curves).items()
    ]
    lines.append(HEADER)
    for gear in drawing.gears:
        for part in gear.parts():
            side = part.side or ""
            lines += [
                f"{gear.name},outline,{part.tooth},{part.kind},{side},{x:.8f},{y:.8f}"
                for x, y in part.points[:-1].tolist()
            ]
        lines += [f"{gear.name},bore,,bore,,{x:.8f},{y:.8f}" for x, y in gear.bore.tolist()]
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return drawing.chord_error
