"""Gears as closed triangle meshes: the drawn polygon, bore and all, raised to its face width.

Caps are triangulated on the outline's own vertices (by manifold3d) and walls stand on the same ones, so the mesh is
watertight by construction; trimesh then checks it and its volume.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from gearpoly.errors import GeometryError, OutOfRangeError
from gearpoly.export.drawing import Drawing, Placed
from gearpoly.units import FloatArray, IntArray

if TYPE_CHECKING:
    import trimesh

VOLUME = 1e-6
"""Relative. A mesh's volume may differ from polygon area times face width by rounding to single precision at most,
which is 1e-7 of a coordinate."""


SLIVER = 1e-9
"""mm^2. Triangles this thin may be turned over: single precision moves a vertex by 1e-5 mm at most, across 1e-4 mm."""


def solids(drawing: Drawing, *, single: bool) -> list[trimesh.Trimesh]:
    """The gears of ``drawing`` as solids in mm, middle planes level with each other where they mesh, standing on z = 0.

    ``single`` rounds vertices to single precision first, as STL holds them. Raises ``OutOfRangeError`` where a face
    width is missing, ``GeometryError`` where rounding would open the mesh.
    """
    for gear in drawing.gears:
        if gear.mounted.gear.b is None:
            raise OutOfRangeError(f"a solid needs a width: state {gear.name}.face_width_mm in the pair file")
    widths = [float(gear.mounted.gear.b or 0.0) for gear in drawing.gears]
    top = max(widths)
    return [
        _solid(gear, low=0.0 if drawing.request.apart else 0.5 * (top - b), b=b, single=single)
        for gear, b in zip(drawing.gears, widths, strict=True)
    ]


def _solid(gear: Placed, *, low: float, b: float, single: bool) -> trimesh.Trimesh:
    import trimesh

    rings = [np.asarray(gear.ring), np.asarray(gear.bore[::-1])]
    if single:
        rings = [ring.astype(np.float32).astype(np.float64) for ring in rings]
    flat = np.concatenate(rings)
    n = flat.shape[0]
    if np.unique(flat, axis=0).shape[0] != n:
        raise GeometryError(
            f"{gear.name}: two neighbouring points fall together when rounded, so the solid would not be watertight; "
            "want fewer points (--points) or a larger chord error (--chord-um)"
        )
    cap = _cap(gear, rings)
    walls = []
    start = 0
    for ring in rings:
        here = start + np.arange(ring.shape[0])
        there = np.roll(here, -1)
        walls += [np.column_stack((here, there, there + n)), np.column_stack((here, there + n, here + n))]
        start += ring.shape[0]
    faces = np.concatenate([cap[:, ::-1], cap + n, *walls])
    z = np.array([low, low + b])
    if single:
        z = z.astype(np.float32).astype(np.float64)
    vertices = np.concatenate([np.column_stack((flat, np.full(n, height))) for height in z])
    # Not processed: vertices stay the outline's own, in its order.
    mesh = trimesh.Trimesh(vertices, faces, process=False, units="mm", metadata={"name": gear.name})
    volume = _area(rings) * float(z[1] - z[0])
    if not mesh.is_volume or abs(mesh.volume - volume) > VOLUME * volume:
        raise GeometryError(
            f"{gear.name}: the solid is not watertight at this detail (volume {mesh.volume:.6g} mm^3 for "
            f"{volume:.6g}); want more points (--points) or another chord error (--chord-um)"
        )
    return mesh


def _cap(gear: Placed, rings: list[FloatArray]) -> IntArray:
    """Triangles (k, 3) of outline and bore on their own vertices, counter-clockwise.

    Each tooth is a strip between its two sides with a fan at its tip, and only the body has its ears cut, which takes
    time with the square of the points. Where a chord between two spaces would leave the body (large bores), the whole
    is cut at once.
    """
    from manifold3d import triangulate

    outline, bore = rings
    n = outline.shape[0]
    radius = np.hypot(*(gear.outline.ring - gear.outline.centre).T)
    parts = gear.outline.parts
    starts = np.cumsum([0, *(part.points.shape[0] - 1 for part in parts)])
    pieces, foot = [], np.ones(n, dtype=bool)
    coast = tip = 0
    for k, part in enumerate(parts):
        if part.kind == "fillet" and part.side == "coast":
            coast = int(starts[k])
        elif part.kind == "tip":
            tip = int(starts[k])
            corner = int(starts[k + 1])
        elif part.kind == "fillet":
            low = int(starts[k + 1])
            pieces.append(_strip(np.arange(coast, tip + 1), np.arange(low, corner - 1, -1) % n, radius))
            fan = np.arange(tip + 1, corner)
            pieces.append(np.column_stack((np.full(fan.size, tip), fan, fan + 1)))
            foot[coast + 1 : low] = False
    edge = np.flatnonzero(foot)
    body = [outline[edge], bore]
    if shapely.is_valid(shapely.Polygon(body[0], [bore])):
        vertices = np.concatenate((edge, np.arange(n, n + bore.shape[0])))
        pieces.append(vertices[np.asarray(triangulate(body), dtype=np.int64)])
        cap = np.concatenate(pieces)
        flat = np.concatenate(rings)[cap]
        one, two = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
        # A triangle turned over would mean that a tooth is no strip; a sliver of rounding is none.
        if np.all(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0] > -SLIVER):
            return cap
    return np.asarray(triangulate(rings), dtype=np.int64)


def _strip(coast: IntArray, drive: IntArray, radius: FloatArray) -> IntArray:
    """Triangles (k, 3) between both sides of a tooth, vertex numbers from foot to tip, joined at like ``radius``."""
    order = np.argsort(np.concatenate((radius[coast[1:]], radius[drive[1:]])), kind="stable")
    on_coast = order < coast.size - 1
    i = np.concatenate(([0], np.cumsum(on_coast)[:-1]))
    j = np.arange(order.size) - i
    # One step up the coast side or up the drive side, counter-clockwise either way.
    up_coast = np.column_stack((coast[i], coast[np.minimum(i + 1, coast.size - 1)], drive[j]))
    up_drive = np.column_stack((coast[i], drive[np.minimum(j + 1, drive.size - 1)], drive[j]))
    return np.where(on_coast[:, None], up_coast, up_drive)


def _area(rings: list[FloatArray]) -> float:
    """Signed area in mm^2 of closed rings together, holes clockwise (shoelace rule about each ring's own mean)."""
    total = 0.0
    for ring in rings:
        x, y = (ring - ring.mean(axis=0)).T
        total += 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    return total
