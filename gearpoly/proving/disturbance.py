"""What is added to a reading and no gear does: lines, hum, jumps, pulses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np

from gearpoly.proving.gears import MM_PER_UM, FloatArray
from gearpoly.proving.rig import Extra

Parts = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Disturbance(Extra):
    """Something that no gear does: a line at an order that is none of the gears', a jump, hum, a pulse, a modulated
    wave.

    kind: one of `DISTURBANCE_SHAPES`; gear: whose shaft counts the order; amplitude in um along the line of action; hz;
    at: part of the recording at which a jump is."""

    kind: str
    amplitude: float
    gear: int = 1
    order: float = 0.0
    phase: float = 0.0
    hz: float = 0.0
    at: float = 0.5

    def x(self, time: FloatArray, theta_1: FloatArray, theta_2: FloatArray, span: tuple[float, float]) -> FloatArray:
        """Its share of the transmission error in mm; span: start and end of the recording in s."""
        angle = self.order * (theta_1 if self.gear == 1 else theta_2) + self.phase
        return np.asarray(
            MM_PER_UM * self.amplitude * DISTURBANCE_SHAPES[self.kind](self, angle, time, span), dtype=np.float64
        )


def _line(one: Disturbance, angle: FloatArray, time: FloatArray, span: Parts) -> FloatArray:
    return np.cos(angle)


def _hum(one: Disturbance, angle: FloatArray, time: FloatArray, span: Parts) -> FloatArray:
    return np.cos(2 * pi * one.hz * time + one.phase)


def _jump(one: Disturbance, angle: FloatArray, time: FloatArray, span: Parts) -> FloatArray:
    return np.where(time > span[0] + one.at * (span[1] - span[0]), 1.0, 0.0)


def _pulse(one: Disturbance, angle: FloatArray, time: FloatArray, span: Parts) -> FloatArray:
    """A short bump once in a time that no shaft keeps."""
    return np.asarray(np.exp(-0.5 * ((np.mod(angle, 2 * pi) - pi) / 0.25) ** 2))


def _asymmetric(one: Disturbance, angle: FloatArray, time: FloatArray, span: Parts) -> FloatArray:
    """Steep on one side, swelling and fading."""
    return np.asarray((1 + 0.6 * np.cos(0.137 * angle)) * (np.cos(angle) + 0.45 * np.cos(2 * angle + 0.9)) / 1.3)


DISTURBANCE_SHAPES: dict[str, Callable[[Disturbance, FloatArray, FloatArray, Parts], FloatArray]] = {
    "line": _line, "hum": _hum, "jump": _jump, "pulse": _pulse, "asymmetric": _asymmetric,
}  # fmt: skip
