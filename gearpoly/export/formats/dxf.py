"""DXF for CAD, wire erosion and laser cutting: one closed polyline per outline, with arcs, or splines where asked."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.export.curves import arc_angles, bulges, curve_error, spline
from gearpoly.export.drawing import Drawing, Placed, rounded_up
from gearpoly.export.formats import missing
from gearpoly.export.reference import circles, labels, line_of_action, touching
from gearpoly.units import DEG, UM

ENDINGS = (".dxf",)
CURVES = ("lines", "arcs", "splines")

_COLOURS = {"driving": 5, "driven": 30}
"""AutoCAD colour index: blue and orange."""


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """``drawing`` as DXF R2010 in mm; outline, bore, circles and numbers of each gear on layers of their own.

    ``curves``: "lines" and "arcs" give one closed LWPOLYLINE per outline, "splines" a chain of SPLINE and ARC. The
    statement stands in the custom properties GEARPOLY_*. Raises ``MissingExtraError`` without ezdxf.
    """
    try:
        from ezdxf import units
        from ezdxf.filemanagement import new
    except ImportError:
        raise missing("ezdxf", "dxf") from None
    document: Any = new("R2010", setup=["linetypes"])
    document.units = units.MM
    document.header["$MEASUREMENT"] = 1
    error = curve_error(drawing, curves)
    for key, value in drawing.statement(curves=curves, chord_error_um=rounded_up(error / UM)).items():
        document.header.custom_vars.append(f"GEARPOLY_{key.upper()}", str(value))
    space = document.modelspace()
    for gear in drawing.gears:
        _gear(document, space, gear, drawing, curves)
    ends = line_of_action(drawing)
    if ends is not None:
        document.layers.add("MESH", color=7)
        space.add_line(*ends.tolist(), dxfattribs={"layer": "MESH"})
        for point in touching(drawing).tolist():
            space.add_point(point, dxfattribs={"layer": "MESH"})
    document.saveas(target)
    return error


def _gear(document: Any, space: Any, gear: Placed, drawing: Drawing, curves: str) -> None:
    name, colour = gear.name.upper(), _COLOURS[gear.name]
    for layer in ("OUTLINE", "BORE", "CIRCLES", "NUMBERS"):
        line = "CENTER" if layer == "CIRCLES" else "CONTINUOUS"
        document.layers.add(f"{name}_{layer}", color=colour, linetype=line)
    _outline(space, gear, curves, {"layer": f"{name}_OUTLINE"})
    axis, centre = gear.axis.tolist(), gear.centre.tolist()
    space.add_circle(axis, gear.outline.r_bore, dxfattribs={"layer": f"{name}_BORE"})
    for kind, radius in circles(gear, drawing).items():
        space.add_circle(axis if kind == "pitch" else centre, radius, dxfattribs={"layer": f"{name}_CIRCLES"})
    from ezdxf.enums import TextEntityAlignment

    for label in labels(gear):
        text = space.add_text(label.text, height=label.height, dxfattribs={"layer": f"{name}_NUMBERS"})
        text.set_placement(label.place.tolist(), align=TextEntityAlignment.MIDDLE_CENTER)


def _outline(space: Any, gear: Placed, curves: str, attributes: dict[str, Any]) -> None:
    if curves == "lines":
        space.add_lwpolyline(gear.ring.tolist(), close=True, dxfattribs=attributes)
        return
    if curves == "arcs":
        rows: list[tuple[float, float, float]] = []
        for part in gear.parts():
            if part.kind in ("tip", "land"):
                _, start, stop = arc_angles(part, gear)
                turn = math.remainder(stop - start, 2.0 * math.pi)
                vertices, bulge = part.points[:1], np.array([math.tan(0.25 * turn)])
            else:
                vertices, bulge = bulges(part.points)
            rows += [(x, y, b) for (x, y), b in zip(vertices.tolist(), bulge.tolist(), strict=True)]
        space.add_lwpolyline(rows, format="xyb", close=True, dxfattribs=attributes)
        return
    for part in gear.parts():
        if part.kind in ("tip", "land"):
            radius, start, stop = arc_angles(part, gear)
            space.add_arc(gear.centre.tolist(), radius, start / DEG, stop / DEG, dxfattribs=attributes)
        elif part.points.shape[0] < 4:
            space.add_lwpolyline(part.points.tolist(), dxfattribs=attributes)
        else:
            curve = spline(part.points)
            entity = space.add_spline(dxfattribs=attributes | {"degree": 3})
            entity.control_points = [(x, y, 0.0) for x, y in curve.control.tolist()]
            entity.knots = curve.knots.tolist()
