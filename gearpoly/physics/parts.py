"""What turns two drawn gears into a pair that runs and is read: axes, teeth that give, shafts, encoders."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gearpoly.mesh.deflection import Elasticity
from gearpoly.mesh.shafts import Shafts
from gearpoly.units import FloatArray

Eccentricity = tuple[float, float]
"""Amplitude in mm and angle in rad of a gear's centre, as ``Mounted`` has it."""


@dataclass(frozen=True, kw_only=True)
class EncoderErrors:
    """Errors of one encoder: ``waves`` of (order per turn, amplitude in rad, phase in rad), error = amplitude
    cos(order reading + phase); ``scale`` is reading over truth."""

    waves: tuple[tuple[int, float, float], ...] = ()
    scale: float = 1.0

    @property
    def none(self) -> bool:
        """Whether the encoder reads true."""
        return not self.waves and self.scale == 1.0

    def at(self, reading: FloatArray) -> FloatArray:
        """Error (n,) in rad at encoder ``reading`` (n,) in rad, the scale apart."""
        out = np.zeros(reading.shape)
        for order, amplitude, phase in self.waves:
            out += amplitude * np.cos(order * reading + phase)
        return out


@dataclass(frozen=True, kw_only=True)
class Parts:
    """What a pair file makes of a pair beside its gears, of the driving and the driven one where there are two.

    ``eccentricity`` of both gears, ``elasticity`` of their teeth, the ``shafts`` between mesh and encoders, what
    ``encoders`` read wrong, and by how much shafts and bearings let the axes apart: ``support`` in mm per N.mm of
    driven torque. A physics takes them, and gives them back with what its own keys change.
    """

    elasticity: Elasticity
    eccentricity: tuple[Eccentricity, Eccentricity] = ((0.0, 0.0), (0.0, 0.0))
    shafts: Shafts = field(default_factory=Shafts)
    encoders: tuple[EncoderErrors, EncoderErrors] = (EncoderErrors(), EncoderErrors())
    support: float = 0.0
