"""Well-known binary: the polygons in full double precision, and nothing else."""

from __future__ import annotations

from pathlib import Path

import shapely
from shapely.geometry import GeometryCollection

from gearpoly.errors import OutOfRangeError
from gearpoly.export.drawing import Drawing

ENDINGS = (".wkb",)
CURVES = ("lines",)


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """``drawing`` as an ISO WKB geometry collection, one polygon per gear, in mm.

    WKB has no room for a word, so a magnified gear would pass for a real one: ``OutOfRangeError`` where K is not 1.
    """
    if drawing.request.magnify != 1.0:
        raise OutOfRangeError(
            f"--magnify {drawing.request.magnify:g}: a .wkb file cannot state it, so the gear would pass for a real "
            "one; want .geojson"
        )
    collection = GeometryCollection([gear.polygon for gear in drawing.gears])
    target.write_bytes(shapely.to_wkb(collection, flavor="iso", byte_order=1))
    return drawing.chord_error
