"""STEP solids for CAD: flanks and fillets as cubic B-splines, tips, root lands and bores as true arcs."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np

from gearpoly.errors import OutOfRangeError
from gearpoly.export.curves import arc_angles, curve_error, spline
from gearpoly.export.drawing import Drawing, Placed, rounded_up
from gearpoly.export.formats import missing
from gearpoly.export.outline import OutlinePart
from gearpoly.units import UM

ENDINGS = (".step", ".stp")
CURVES = ("splines", "lines")


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """``drawing`` as STEP in mm, one labelled solid per gear; gives the chord error in mm, that of the splines.

    K, chord error and the rest of the statement are the label of the whole. Raises ``MissingExtraError`` without
    build123d, ``OutOfRangeError`` where a face width is missing.
    """
    for gear in drawing.gears:
        if gear.mounted.gear.b is None:
            raise OutOfRangeError(f"a solid needs a width: state {gear.name}.face_width_mm in the pair file")
    try:
        import build123d
    except ImportError:
        raise missing("build123d", "step") from None
    top = max(gear.mounted.gear.b or 0.0 for gear in drawing.gears)
    bodies = []
    for gear in drawing.gears:
        b = float(gear.mounted.gear.b or 0.0)
        low = 0.0 if drawing.request.apart else 0.5 * (top - b)
        outer = build123d.Wire(_edges(gear, curves, low))
        hole = build123d.Wire(
            build123d.Edge.make_circle(
                gear.outline.r_bore, build123d.Plane(origin=(*gear.axis.tolist(), low), z_dir=(0, 0, 1))
            )
        )
        body = build123d.Solid.extrude(build123d.Face(outer, [hole]), build123d.Vector(0.0, 0.0, b))
        body.label = f"{gear.name} gear z={gear.mounted.gear.z} magnify={drawing.request.magnify:g}"
        bodies.append(body)
    error = curve_error(drawing, curves)
    statement = drawing.words(curves=curves, chord_error_um=rounded_up(error / UM))
    whole: Any = build123d.Compound(label=statement, children=bodies)
    build123d.export_step(whole, target, unit=build123d.Unit.MM)
    return error


def _edges(gear: Placed, curves: str, z: float) -> list[Any]:
    edges: list[Any] = []
    for part in gear.parts():
        edges += _lines(part, z) if curves == "lines" else [_curve(part, gear, z)]
    return edges


def _lines(part: OutlinePart, z: float) -> list[Any]:
    import build123d

    corners = [(x, y, z) for x, y in part.points.tolist()]
    return [build123d.Edge.make_line(a, b) for a, b in itertools.pairwise(corners)]


def _curve(part: OutlinePart, gear: Placed, z: float) -> Any:
    import build123d

    corners = [(x, y, z) for x, y in part.points.tolist()]
    if part.kind in ("tip", "land"):
        radius, start, stop = arc_angles(part, gear)
        middle = start + 0.5 * ((stop - start) % (2.0 * np.pi))
        x, y = (gear.centre + radius * np.array([np.cos(middle), np.sin(middle)])).tolist()
        return build123d.Edge.make_three_point_arc(corners[0], (x, y, z), corners[-1])
    if len(corners) < 4:
        return build123d.Edge.make_spline(corners) if len(corners) > 2 else build123d.Edge.make_line(*corners)
    curve = spline(part.points)
    # The spline with the same points, parameters and end slopes is the same spline: its error has been measured.
    return build123d.Edge.make_spline(
        corners,
        tangents=[(*slope, 0.0) for slope in curve.end_slopes.tolist()],
        parameters=[float(k) for k in range(len(corners))],
        scale=False,
    )
