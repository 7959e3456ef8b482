"""How a physics tells its values: by the contract's parameters with their standard errors, and in words."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from gearpoly.physics.place import Place
from gearpoly.units import FloatArray

Reported = dict[str, tuple[float, float]]
"""Parameter name: value and standard error."""


def polar(x: float, y: float, covariance: FloatArray) -> tuple[tuple[float, float], tuple[float, float]]:
    """Length and direction in deg (0 to 360) of a vector with its covariance (2, 2), each with its standard error."""
    length = math.hypot(x, y)
    along = np.array([x, y]) / max(length, 1e-300)
    across = np.array([-along[1], along[0]])
    std = math.sqrt(max(float(along @ covariance @ along), 0.0))
    turn = math.sqrt(max(float(across @ covariance @ across), 0.0)) / max(length, 1e-300)
    return (length, std), (math.degrees(math.atan2(y, x)) % 360.0, min(math.degrees(turn), 180.0))


def plain(*names: str) -> Callable[[Place, FloatArray, FloatArray], Reported]:
    """A report of the coordinates as they are, under ``names``."""

    def report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
        return {name: (float(values[k]), math.sqrt(max(float(covariance[k, k]), 0.0))) for k, name in enumerate(names)}

    return report


def vector(amplitude: str) -> Callable[[Place, FloatArray, FloatArray], Reported]:
    """A report of x and y as ``amplitude`` (its name with the unit) and ``angle_deg``."""

    def report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
        length, angle = polar(float(values[0]), float(values[1]), covariance)
        return {amplitude: length, "angle_deg": angle}

    return report


def phased(amplitude: str) -> Callable[[Place, FloatArray, FloatArray], Reported]:
    """A report of cosine and sine parts as ``order``, ``amplitude`` (its name with the unit) and ``angle_deg``, the
    phase of amplitude cos(. + angle)."""

    def report(place: Place, values: FloatArray, covariance: FloatArray) -> Reported:
        mirrored = covariance * np.array([[1, -1], [-1, 1]])
        length, angle = polar(float(values[0]), -float(values[1]), mirrored)
        return {"order": (float(place.order or 1), 0.0), amplitude: length, "angle_deg": angle}

    return report


def wave(x: float, y: float) -> tuple[float, float]:
    """Amplitude and phase in deg of x cos + y sin = A cos(. + phase)."""
    return math.hypot(x, y), math.degrees(math.atan2(-y, x))


def own_of(place: Place) -> str:
    """ "driving gear" or "driven gear"."""
    return f"{place.gear_name} gear"


def tooth_of(place: Place) -> str:
    """ "Tooth 7 of the driven gear", or "A tooth ..." where the numbering is open."""
    number = "A tooth" if place.tooth is None else f"Tooth {place.tooth}"
    return f"{number} of the {own_of(place)}"
