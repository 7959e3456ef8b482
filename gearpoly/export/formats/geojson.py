"""GeoJSON polygons, in mm: for tools that read geometry as GeoJSON, though no place on Earth is meant."""

from __future__ import annotations

import json
from pathlib import Path

from gearpoly.export.drawing import Drawing

ENDINGS = (".geojson",)
CURVES = ("lines",)


def write(drawing: Drawing, target: Path, curves: str) -> float:
    """``drawing`` as a FeatureCollection (RFC 7946): outlines counter-clockwise, bores clockwise.

    The foreign member ``gearpoly`` holds the statement; coordinates are plain mm, to 0.01 nm.
    """
    features = []
    for gear in drawing.gears:
        rings = [gear.ring, gear.bore[::-1]]
        coordinates = [[[round(x, 8), round(y, 8)] for x, y in [*ring.tolist(), ring[0].tolist()]] for ring in rings]
        nominal = gear.mounted.gear
        properties = {
            "gear": gear.name,
            "teeth": nominal.z,
            "module_mm": nominal.m,
            "axis_mm": gear.axis.tolist(),
            "angle_rad": gear.angle,
            "magnify": drawing.request.magnify,
        }
        features.append(
            {
                "type": "Feature",
                "id": gear.name,
                "properties": properties,
                "geometry": {"type": "Polygon", "coordinates": coordinates},
            }
        )
    statement = drawing.statement(curves=curves)
    document = {"type": "FeatureCollection", "gearpoly": statement, "features": features}
    target.write_text(json.dumps(document, allow_nan=False, ensure_ascii=False), encoding="utf-8")
    return drawing.chord_error
