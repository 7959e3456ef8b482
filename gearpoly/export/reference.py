"""Reference lines of a drawing: circles, line of action, contact points, tooth numbers. Shared by the 2-D formats."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearpoly.export.drawing import Drawing, Placed
from gearpoly.units import FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Label:
    """A tooth's number at ``place`` (2,) in mm, ``height`` mm tall."""

    text: str
    place: FloatArray
    height: float


def circles(gear: Placed, drawing: Drawing) -> dict[str, float]:
    """Radii in mm by name: tip, reference, base and root circle; the working pitch circle where the gears mesh."""
    nominal = gear.mounted.gear
    out = {"tip": nominal.r_a, "reference": nominal.r, "base": nominal.r_b, "root": nominal.r_f}
    if drawing.contacts is not None and drawing.pair.alpha_w > 0.0:
        out["pitch"] = nominal.r_b / math.cos(drawing.pair.alpha_w)
    return out


def labels(gear: Placed) -> list[Label]:
    """The tooth numbers, each halfway between root and reference circle."""
    nominal = gear.mounted.gear
    radius = 0.5 * (nominal.r_f + nominal.r)
    direction = gear.tooth_directions()
    places = gear.centre + radius * np.stack((np.cos(direction), np.sin(direction)), axis=-1)
    height = 0.5 * nominal.m
    return [Label(text=str(k), place=places[k], height=height) for k in range(nominal.z)]


def line_of_action(drawing: Drawing) -> FloatArray | None:
    """Both ends (2, 2) in mm of the line of action, where it touches the base circles; None where gears do not mesh.

    The force on the driven gear points from the first to the second (derived here: the common tangent of both base
    circles through the pitch point, leaning to the side that the touching flanks face).
    """
    pair = drawing.pair
    if drawing.contacts is None or pair.alpha_w <= 0.0:
        return None
    c, s = math.cos(pair.alpha_w), math.sin(pair.alpha_w)
    side = 1.0 if drawing.request.flank == "drive" else -1.0
    return np.array([[pair.r_b1 * c, -side * pair.r_b1 * s], [pair.a - pair.r_b2 * c, side * pair.r_b2 * s]])


def touching(drawing: Drawing) -> FloatArray:
    """Points (k, 2) in mm at which the drawn gears touch; empty where they do not mesh."""
    found = drawing.contacts
    return np.empty((0, 2)) if found is None else found.point[found.touching]
