"""What touches, and along which normal: read off the smooth faces behind two polylines at a place of contact.

Both contact kernels find a place; neither describes it on its own. Points are complex numbers in mm, as in
``bodies``.
"""

from __future__ import annotations

import enum

import numpy as np

from gearpoly.mesh.bodies import Body, ComplexArray
from gearpoly.units import BoolArray, FloatArray, IntArray


class Feature(enum.IntEnum):
    """What of the two bodies touches."""

    FLANK = 0
    TURNING_CORNER = 1
    FIXED_CORNER = 2


def describe(
    turning: Body,
    fixed: Body,
    *,
    teeth: tuple[IntArray, IntArray],
    places: tuple[FloatArray, FloatArray],
    turning_is_vertex: BoolArray,
    spin: ComplexArray,
) -> tuple[ComplexArray, IntArray, FloatArray]:
    """Normals, features and overruns of contacts between teeth of two bodies, one row (k,) each.

    ``teeth`` and ``places`` (k,) of the turning and of the fixed body: tooth numbers, and vertex number plus share of
    the edge on the face. ``turning_is_vertex`` (k,): polylines touch with a vertex of one on an edge of the other.
    ``spin`` (k,): exp(i angle) from the fixed body's frame to the turning body's.

    Returns unit normals (k,) from the turning into the fixed body, in the turning body's frame; ``Feature`` (k,); and
    the overrun (k,) in rad, 0 on flanks. Derived here.
    """
    mine = _tangent(turning, teeth[0], places[0])
    mate = _tangent(fixed, teeth[1], places[1]) * spin
    normal = np.where(turning_is_vertex, -1j * mate, 1j * mine)
    # At a corner the outline goes on clockwise over the tip; the mate's tangent has turned that way once it left the
    # flank.
    past = np.angle(-mine / mate)
    feature = np.full(past.size, int(Feature.FLANK))
    overrun = np.zeros(past.size)
    for vertex, side, place, body, turned in (
        (turning_is_vertex, Feature.TURNING_CORNER, places[0], turning, past),
        (~turning_is_vertex, Feature.FIXED_CORNER, places[1], fixed, -past),
    ):
        corner = vertex & (place > body.faces.shape[1] - 1.5) & (turned > 0.0)
        feature[corner], overrun[corner] = int(side), turned[corner]
    return normal, feature, overrun


def _tangent(body: Body, tooth: IntArray, place: FloatArray) -> ComplexArray:
    """Unit tangent root to tip of the smooth face behind the polyline at vertex number ``place``, straight between
    vertices."""
    low = np.minimum(place.astype(np.int64), body.faces.shape[1] - 2)
    share = place - low
    slope = (1.0 - share) * body.tangents[tooth, low] + share * body.tangents[tooth, low + 1]
    return np.asarray(slope / np.abs(slope))
