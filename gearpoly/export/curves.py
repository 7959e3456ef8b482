"""Flanks as arcs or splines instead of edges, with what they miss measured on the finer drawing."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

from gearpoly.export.drawing import Drawing, Placed
from gearpoly.export.outline import CHORD_DIVISIONS, Outline, OutlinePart
from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Spline:
    """A clamped cubic B-spline: ``knots`` (n + 4,), ``control`` points (n, 2) in mm, ``end_slopes`` (2, 2) in mm per
    point."""

    knots: FloatArray
    control: FloatArray
    end_slopes: FloatArray


def spline(points: FloatArray) -> Spline:
    """The cubic spline through ``points`` (n, 2) in mm, over their number: they are spaced so that chords err alike, so
    this parameter is smooth (not-a-knot ends)."""
    curve = make_interp_spline(np.arange(points.shape[0], dtype=np.float64), points, k=3)
    return Spline(
        knots=np.asarray(curve.t, dtype=np.float64),
        control=np.asarray(curve.c, dtype=np.float64),
        end_slopes=np.asarray(curve(np.array([0.0, points.shape[0] - 1.0]), 1), dtype=np.float64),
    )


def bulges(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Every other vertex (k, 2) of ``points`` (n, 2), and the bulge (k,) of the arc from it to the next through the
    one between.

    A bulge is the tangent of a quarter of the arc's angle, positive counter-clockwise. Where the number of edges is
    odd the last stays straight. The last point of ``points`` is left to the next part.
    """
    edges = points.shape[0] - 1
    arcs = edges // 2
    a, b, c = points[0 : 2 * arcs : 2], points[1 : 2 * arcs : 2], points[2 : 2 * arcs + 1 : 2]
    chord, rise = c - a, b - a
    length = np.hypot(chord[:, 0], chord[:, 1])
    along = (rise[:, 0] * chord[:, 0] + rise[:, 1] * chord[:, 1]) / length
    off = (chord[:, 0] * rise[:, 1] - chord[:, 1] * rise[:, 0]) / length
    # The circle through all three, by its sagitta from the chord: bulge = 2 sagitta / chord. ``off`` is the rise at
    # ``along``, not in the middle; the intersecting-chords theorem gives the centre, and with it the sagitta.
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (along * (length - along) - off**2) / (2.0 * off)
        radius = np.hypot(0.5 * length, depth)
        sagitta = np.sign(off) * (radius - np.sign(off) * depth)
    # A point left of the chord lies on a clockwise arc, whose bulge is negative.
    bulge = np.where(off == 0.0, 0.0, -2.0 * sagitta / length)
    if edges % 2:
        return np.concatenate((a, points[-2:-1])), np.concatenate((bulge, [0.0]))
    return a, bulge


def arc_angles(part: OutlinePart, gear: Placed) -> tuple[float, float, float]:
    """Radius in mm and both directions in rad of a tip or land, an arc counter-clockwise about the gear's centre."""
    first, last = part.points[0] - gear.centre, part.points[-1] - gear.centre
    return (
        float(np.hypot(*first)),
        math.atan2(float(first[1]), float(first[0])),
        math.atan2(float(last[1]), float(last[0])),
    )


def curve_error(drawing: Drawing, curves: str) -> float:
    """The most in mm that the drawn ``curves`` stand off the true outlines, measured on the finer drawing of the
    involutes.

    Fillets are taken to keep the chord error of their own polygon, which arcs and splines through the same points only
    better.
    """
    if curves == "lines":
        return drawing.chord_error
    return max(_outline_error(gear.outline, curves) for gear in drawing.gears)


def _outline_error(outline: Outline, curves: str) -> float:
    worst = outline.fillet_error
    for coarse, dense in (
        (outline.flanks.drive, outline.fine.drive),
        (outline.flanks.coast, outline.fine.coast),
    ):
        ends = coarse[:, outline.flanks.root.n - 1 :]
        between = dense[:, outline.fine.root.n - 1 :]
        for points, true in zip(ends, between, strict=True):
            error = _spline_error(points, true) if curves == "splines" else _arc_error(points, true)
            worst = max(worst, error)
    return worst


def _spline_error(points: FloatArray, true: FloatArray) -> float:
    curve = make_interp_spline(np.arange(points.shape[0], dtype=np.float64), points, k=3)
    at = np.arange(true.shape[0]) / CHORD_DIVISIONS
    off, along = curve(at) - true, curve(at, 1)
    # Only what stands off across the curve counts; along it the parameter may slip.
    return float(np.max(np.abs(off[:, 0] * along[:, 1] - off[:, 1] * along[:, 0]) / np.hypot(along[:, 0], along[:, 1])))


def _arc_error(points: FloatArray, true: FloatArray) -> float:
    worst = 0.0
    edges = points.shape[0] - 1
    for start in range(0, edges - 1, 2):
        a, b, c = points[start], points[start + 1], points[start + 2]
        # The centre is where both perpendicular bisectors meet.
        sides = 2.0 * np.array([b - a, c - a])
        centre = a + np.linalg.solve(sides, np.array([(b - a) @ (b - a), (c - a) @ (c - a)]))
        rows = true[start * CHORD_DIVISIONS : (start + 2) * CHORD_DIVISIONS + 1] - centre
        worst = max(worst, float(np.max(np.abs(np.hypot(rows[:, 0], rows[:, 1]) - np.hypot(*(a - centre))))))
    if edges % 2:
        chord = points[-1] - points[-2]
        rows = true[-CHORD_DIVISIONS - 1 :] - points[-2]
        worst = max(
            worst, float(np.max(np.abs(chord[0] * rows[:, 1] - chord[1] * rows[:, 0]))) / float(np.hypot(*chord))
        )
    return worst
