"""Teeth and whole gears as Shapely polygons, each tooth with its own deviations."""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely.geometry import Polygon

from gearpoly.errors import GeometryError
from gearpoly.gear.flank import Flanks
from gearpoly.gear.root import FILLET_CHORD_ERROR
from gearpoly.units import FloatArray


def rotate(points: FloatArray, angle: FloatArray | float) -> FloatArray:
    """``points`` (..., n, 2) turned counter-clockwise by ``angle`` (...) in rad about the origin."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    x, y = points[..., 0], points[..., 1]
    return np.stack((c * x - s * y, s * x + c * y), axis=-1)


def arc(r: float, start: float, stop: float, *, chord_error: float = FILLET_CHORD_ERROR) -> FloatArray:
    """Points (k, 2) strictly between ``start`` and ``stop`` (rad) on the circle ``r`` (mm), within ``chord_error`` mm
    of it."""
    steps = max(1, math.ceil(abs(stop - start) / math.sqrt(8.0 * chord_error / r)))
    angle = np.linspace(start, stop, steps + 1)[1:-1]
    return np.stack((r * np.cos(angle), r * np.sin(angle)), axis=-1)


def tooth_outline(flanks: Flanks, tooth: int) -> FloatArray:
    """Outline (k, 2) of one tooth in its own frame in mm, counter-clockwise from mid space to mid space over the
    tip."""
    own = flanks.tooth(tooth)
    tip = arc(float(own.r[-1]), -float(own.coast[-1]), float(own.drive[-1]))
    return np.concatenate((flanks.coast[tooth], tip, flanks.drive[tooth][::-1]))


def tooth_polygons(flanks: Flanks, centre_lines: FloatArray) -> list[Polygon]:
    """Every tooth as its own polygon, turned so that its centre line stands at ``centre_lines`` (z,) in rad.

    Each runs from mid space to mid space and is closed by a chord inside the root circle. Raises ``GeometryError``
    for a tooth whose outline crosses itself.
    """
    polygons = [Polygon(rotate(tooth_outline(flanks, k), float(angle))) for k, angle in enumerate(centre_lines)]
    for k, valid in enumerate(shapely.is_valid(polygons)):
        if not valid:
            raise GeometryError(
                f"tooth {k} crosses itself ({shapely.is_valid_reason(polygons[k])}); check its deviations' size and "
                "unit (um)"
            )
    return polygons


def gear_polygon(flanks: Flanks, centre_lines: FloatArray) -> Polygon:
    """The whole gear with its bore as one polygon, teeth at ``centre_lines`` (z,) in rad. Raises ``GeometryError`` if
    not valid."""
    gear = flanks.gear
    order = np.argsort(np.mod(centre_lines, 2.0 * np.pi))
    # Neighbours share the vertex in the middle of their space; keep it once.
    ring = np.concatenate([rotate(tooth_outline(flanks, k)[:-1], float(centre_lines[k])) for k in order])
    d_bore = gear.r_f if gear.d_bore is None else gear.d_bore
    hole = arc(0.5 * d_bore, 0.0, 2.0 * np.pi)
    polygon = Polygon(ring, [np.concatenate(([[0.5 * d_bore, 0.0]], hole))])
    if not polygon.is_valid:
        raise GeometryError(f"the gear's outline crosses itself: {shapely.is_valid_reason(polygon)}")
    return polygon
