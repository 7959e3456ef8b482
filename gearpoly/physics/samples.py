"""Where and under what one recording was made."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearpoly.mesh.condition import Condition
from gearpoly.mesh.pair import Flank
from gearpoly.units import FloatArray, IntArray

MAY_TOUCH = 2.6
"""Pitches from its pitch point within which a tooth may touch: a contact ratio is below 2 on either side in all, the
coast flank's pitch point is half a pitch off, and an eccentric gear reads up to a tenth off."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Samples:
    """Where and under what a recording was made, (n,) each: ``theta_1``, ``theta_2`` in rad from the contract's zero,
    ``time`` in s, ``reading_1``, ``reading_2`` of the encoders in rad; the condition: ``flank``, ``torque`` in N.mm,
    ``speed`` of the driving shaft in rad/s; ``number`` of the recording; ``counted``: its mean compares with those of
    the others; ``backward``: the pair ran backwards, so the samples come in the order of angles, last first, and
    ``time`` counts back from the end; ``load`` how far the torque is off along the recording, as a part of ``torque``
    (None: steady); ``middle`` the driven rotation in rad about which the angles turn where a clock's rate is off."""

    number: int
    flank: Flank
    torque: float
    speed: float | None
    theta_1: FloatArray
    theta_2: FloatArray
    time: FloatArray | None
    reading_1: FloatArray
    reading_2: FloatArray
    direction_1: int
    direction_2: int
    counted: bool
    backward: bool = False
    load: FloatArray | None = None
    middle: float = 0.0

    @cached_property
    def condition(self) -> Condition:
        """What the recording was made under."""
        varies = 0.0 if self.load is None else float(np.max(np.abs(self.load)))
        return Condition(flank=self.flank, torque=self.torque, speed=self.speed, backward=self.backward, varies=varies)

    @property
    def size(self) -> int:
        """Number of samples."""
        return self.theta_2.size

    def first(self, n: int) -> Samples:
        """The first ``n`` samples."""
        return self.at(np.arange(n))

    def at(self, where: IntArray) -> Samples:
        """The samples of these numbers (k,)."""
        names = ("theta_1", "theta_2", "reading_1", "reading_2")
        mine = {name: getattr(self, name)[where] for name in names}
        time, load = (None if one is None else one[where] for one in (self.time, self.load))
        return replace(self, time=time, load=load, **mine)

    def meshing(self, gear: int, tooth: int, *, z: int) -> IntArray:
        """Numbers (k,) of the samples in which ``tooth`` of ``z`` may touch: less than ``MAY_TOUCH`` pitches from its
        pitch point, on either flank."""
        turned = (self.theta_1 if gear == 0 else self.theta_2) * (z / (2.0 * math.pi))
        off = np.mod(turned - tooth + 0.5 * z, z) - 0.5 * z
        return np.flatnonzero(np.abs(off) < MAY_TOUCH)

    @property
    def loaded(self) -> FloatArray | float:
        """Torque over ``torque`` (n,), or 1 where it is steady."""
        return 1.0 if self.load is None else 1.0 + self.load

    @property
    def coast(self) -> bool:
        """Whether the coast flank carries."""
        return self.flank == "coast"

    @property
    def sense(self) -> float:
        """Sign by which material moves the transmission error: +1 on the drive flank, -1 on the coast flank."""
        return -1.0 if self.coast else 1.0

    @cached_property
    def along(self) -> FloatArray:
        """Place (n,) in the recording, -1 at its beginning and 1 at its end, by time where it is known."""
        x = self.theta_2 if self.time is None else self.time
        along = 2.0 * (x - x.min()) / max(float(np.ptp(x)), 1e-300) - 1.0
        return np.asarray(-along if self.backward else along)
