"""STL: triangles in single precision, the least that every printer reads. It knows no units; these are mm."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from gearpoly import __version__
from gearpoly.export.drawing import Drawing, rounded_up
from gearpoly.units import UM

ENDINGS = (".stl",)
SAYS = "solids as triangles, in mm"
CURVES = ("lines",)

_ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """``drawing`` as binary STL, both gears in one file; K and chord error stand in its header of 80 bytes.

    The stated chord error includes rounding to single precision.
    """
    from gearpoly.export.solid import solids

    meshes = solids(drawing, single=True)
    error = drawing.chord_error + rounding(drawing)
    header = (
        f"gearpoly {__version__} unit=mm magnify={drawing.request.magnify:g} chord_error_um={rounded_up(error / UM):g}"
    )
    # A binary STL must not begin with "solid", and this does not.
    rows = np.zeros(sum(mesh.faces.shape[0] for mesh in meshes), dtype=_ROW)
    start = 0
    for mesh in meshes:
        corners = mesh.vertices[mesh.faces]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        part = rows[start : start + mesh.faces.shape[0]]
        part["normal"] = normal / np.where(length > 0.0, length, 1.0)
        part["corners"] = corners
        start += mesh.faces.shape[0]
    with target.open("wb") as stream:
        stream.write(header.encode("ascii")[:80].ljust(80, b" "))
        stream.write(np.uint32(rows.size).tobytes())
        stream.write(rows.tobytes())
    return error


def rounding(drawing: Drawing) -> float:
    """The most in mm by which single precision moves a vertex: half a unit in the last place, along both axes."""
    largest = max(float(np.max(np.abs(gear.ring))) for gear in drawing.gears)
    return float(np.spacing(np.float32(largest))) / math.sqrt(2.0)
