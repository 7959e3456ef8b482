"""What manufacturing did to the flanks: normal deviations of every tooth, both sides, as sums of simple shapes.

A flank deviation is measured along the normal of the nominal involute, in mm, positive where there is more material.
Shapes are functions of the roll length l, so that a metrologist's trace, a relief and a worn flank are the same kind
of thing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from gearpoly.errors import GeometryError, told_at_most
from gearpoly.gear.gear import Gear
from gearpoly.units import FloatArray, read_only


@dataclass(frozen=True, kw_only=True)
class Span:
    """The roll lengths between which a flank works, mm: active start ``l_start`` and tip ``l_a``; u runs between them
    from 0 to 1."""

    l_start: float
    l_a: float

    def u(self, l: FloatArray) -> FloatArray:
        """Place on the active profile, 0 at its start and 1 at the tip, for roll lengths ``l`` of any shape."""
        return (l - self.l_start) / (self.l_a - self.l_start)


class Shape(Protocol):
    """A normal deviation of all flanks of one side of a gear."""

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        """Deviation in mm at roll lengths ``l`` (z, n) in mm; the result broadcasts to (z, n)."""
        ...


@dataclass(frozen=True)
class Index:
    """The whole flank stands off its place by ``p`` (z,) mm: index deviation, or the thickness on a coast flank."""

    p: FloatArray

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        return self.p[:, None]


@dataclass(frozen=True)
class Slope:
    """Material rises by ``s`` (z,) mm from active start to tip: s (u - 1/2), the profile slope deviation f_Halpha."""

    s: FloatArray

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        return self.s[:, None] * (span.u(l) - 0.5)


@dataclass(frozen=True)
class Crowning:
    """Material is missing by ``c`` (z,) mm at both ends relative to the middle: -c (2 u - 1)^2."""

    c: FloatArray

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        return -self.c[:, None] * (2.0 * span.u(l) - 1.0) ** 2


@dataclass(frozen=True)
class FormDeviation:
    """A smooth form deviation: sum over k of a[:, k] cos((k + 2) pi u), ``a`` (z, K) in mm.

    The half waves start at two and none has a mean. Odd ones have a slope (of -0.27 a at three half waves, by least
    squares), which whoever draws them takes off the slope.
    """

    a: FloatArray

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        u = np.clip(np.broadcast_to(span.u(l), (len(self.a), l.shape[-1])), 0.0, 1.0)
        out = np.zeros(u.shape)
        # cos (k + 1)x = 2 cos x cos kx - cos (k - 1)x: a cosine is ten products, and a diagnosis draws ten thousand.
        one = np.cos(np.pi * u)
        before, wave = np.ones(u.shape), one
        for k in range(self.a.shape[1]):
            before, wave = wave, 2.0 * one * wave - before
            out += self.a[:, k, None] * wave
        return out


@dataclass(frozen=True)
class Relief:
    """Tip relief: ``amount`` mm off at the tip, from roll length ``l_relief`` mm up, -C t^power (1 linear, 2
    parabolic)."""

    amount: float
    l_relief: float
    power: int

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        t = np.maximum(0.0, (l - self.l_relief) / (span.l_a - self.l_relief))
        return -self.amount * t**self.power


@dataclass(frozen=True)
class Wear:
    """Wear takes off what slides: ``w`` mm at the tip, none at the roll length ``l_pitch``, -w |l - l_pitch| / (l_a -
    l_pitch)."""

    w: float
    l_pitch: float

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        return -self.w * np.abs(l - self.l_pitch) / (span.l_a - self.l_pitch)


@dataclass(frozen=True)
class Wave:
    """Undulation of ``order`` waves per turn: a cos(order phi + phase), ``a`` in mm, along the generating motion.

    ``phi`` is the rotation at which a point of the flank comes into contact, k tau + sense (l - l_pitch)/r_b in rad:
    ``sense`` is 1 where contact runs up the flank (driving gear, drive flank) and -1 where it runs down.
    """

    a: float
    order: int
    phase: float
    tau: float
    r_b: float
    l_pitch: float
    sense: float

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        k = np.arange(round(2.0 * math.pi / self.tau))[:, None]
        phi = k * self.tau + self.sense * (l - self.l_pitch) / self.r_b
        return self.a * np.cos(self.order * phi + self.phase)


@dataclass(frozen=True)
class Pit:
    """A spall: ``depth`` mm off one ``tooth`` of ``z`` between the radii ``r_from`` and ``r_to`` in mm, where half the
    depth is gone; its walls rise as tanh over ``wall`` mm, but no less than over the depth: steeper ones would fold the
    flank over itself. An infinite ``r_to`` is none: the pit reaches over the tip. ``r_b`` is the gear's base radius."""

    depth: float
    tooth: int
    z: int
    r_b: float
    r_from: float
    r_to: float
    wall: float

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        out = np.zeros((self.z, l.shape[-1]))
        out[self.tooth] = self.along(l[self.tooth if l.shape[0] > 1 else 0])
        return out

    def along(self, l: FloatArray) -> FloatArray:
        """Deviation in mm of the tooth itself at roll lengths ``l`` of any shape."""
        r, wall = np.hypot(l, self.r_b), max(self.wall, abs(self.depth))
        return -0.5 * self.depth * (np.tanh((r - self.r_from) / wall) - np.tanh((r - self.r_to) / wall))


@dataclass(frozen=True)
class Traces:
    """Measured or scattered profiles: flank ``k`` has ``deviation[k]`` at ``l[k]`` (mm), straight between, level
    beyond the ends.

    Where a tooth has no trace its arrays are empty and its deviation is 0.
    """

    l: tuple[FloatArray, ...]
    deviation: tuple[FloatArray, ...]

    def __call__(self, l: FloatArray, span: Span) -> FloatArray:
        rows = np.broadcast_to(l, (len(self.l), l.shape[-1]))
        out = np.zeros(rows.shape)
        for k, (x, y) in enumerate(zip(self.l, self.deviation, strict=True)):
            if x.size:
                out[k] = np.interp(rows[k], x, y)
        return out


@dataclass(frozen=True)
class Scatter(Traces):
    """Point-wise scatter, too steep to be a flank of its own: each drawn point is set off by the deviation at its own
    place (its string length L, not the l below it), so that a rough flank never folds over itself."""


@dataclass(frozen=True)
class MissingTip:
    """The tip of one ``tooth`` is missing over the whole face width: both its flanks end ``height`` mm, radially, below
    the tip circle, and an arc about the gear's centre joins them."""

    tooth: int
    height: float


@dataclass(frozen=True, kw_only=True)
class Deviations:
    """Everything that sets the flanks of one gear off their nominal place: sums of shapes, one sum per side, and tips
    that are missing. Of several chips of one tooth the highest counts."""

    drive: tuple[Shape, ...] = ()
    coast: tuple[Shape, ...] = ()
    chips: tuple[MissingTip, ...] = ()

    def __add__(self, other: Deviations) -> Deviations:
        return Deviations(
            drive=self.drive + other.drive, coast=self.coast + other.coast, chips=self.chips + other.chips
        )

    @property
    def missing_tips(self) -> dict[int, float]:
        """Radial heights in mm by the numbers of the teeth that miss any."""
        out: dict[int, float] = {}
        for one in self.chips:
            if one.height > 0.0:
                out[one.tooth] = max(one.height, out.get(one.tooth, 0.0))
        return out


def total(shapes: tuple[Shape, ...], l: FloatArray, *, z: int, span: Span) -> FloatArray:
    """Summed deviation (z, n) in mm of one side at roll lengths ``l`` (z, n) or (1, n) in mm."""
    out = np.zeros((z, l.shape[-1]))
    for shape in shapes:
        out += shape(l, span)
    return out


def pitch_and_thickness(
    gear: Gear, *, index: FloatArray, E_s: FloatArray, index_coast: FloatArray | None = None
) -> Deviations:
    """Where both flanks of each tooth stand: ``index`` (z,) of the drive flank and tooth thickness deviation ``E_s``
    (z,), mm.

    E_s is an arc along the reference circle; the drive flank stays where ``index`` has it and the coast flank's
    normal deviation is -index + E_s cos(alpha), unless ``index_coast`` (z,) states it outright.
    """
    coast = E_s * math.cos(gear.alpha) - index if index_coast is None else index_coast
    return Deviations(drive=(Index(read_only(index)),), coast=(Index(read_only(coast)),))


def tip_relief(gear: Gear, *, amount: float, length: float, shape: str) -> Relief:
    """Tip relief of ``amount`` mm over the radial ``length`` mm down from the tip, "linear" or "parabolic".

    Raises ``GeometryError`` where the relief would start below the base circle.
    """
    r_relief = gear.r_a - length
    if r_relief <= gear.r_b:
        raise GeometryError(
            f"tip relief of length {length:g} mm starts below the base circle; at most "
            f"{told_at_most(gear.r_a - gear.r_b, 3)} mm would do"
        )
    return Relief(amount, gear.roll_length(r_relief), {"linear": 1, "parabolic": 2}[shape])
