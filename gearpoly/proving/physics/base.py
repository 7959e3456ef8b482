"""What a physics of the bench states of itself: how it changes the rig, an example of it, what its truth tells, and
what may be mistaken for it. One file of this folder holds one physics and is found without another edit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import atan2, hypot
from typing import Any

import numpy as np

from gearpoly.proving.chain import RecordedCondition
from gearpoly.proving.gears import MM_PER_UM, RAD_PER_DEG, FloatArray, IdealPair
from gearpoly.proving.rig import Rig
from gearpoly.proving.shapes import Shapes


@dataclass(frozen=True, kw_only=True)
class Effect:
    """One physics with its size and what fixes it beside its size.

    size: in the unit of the parameter that its physics calls ``size`` (signed); crack: compliance factor less 1;
    deflection: 1; scale: ratio less 1; resonance: (highest mesh frequency / natural frequency) squared. more: tooth,
    order, angle_deg, phase, lengths, ..."""

    physics: str
    gear: int = 0
    size: float = 1.0
    more: dict[str, Any] = field(default_factory=dict)

    def scaled(self, size: float) -> Effect:
        """The same effect with another size (magnitude; the sign stays)."""
        return replace(self, size=size * (-1.0 if self.size < 0 else 1.0))


@dataclass(frozen=True, kw_only=True)
class Site:
    """Where an example of a physics is to sit: pair, conditions of the recordings, gear 1 or 2, and what was drawn for
    it: sign, tooth, angle and phase. ``shapes``: waves, lengths and pits drawn for that gear; ``rng`` for what else a
    physics needs."""

    pair: IdealPair
    conditions: tuple[RecordedCondition, ...]
    gear: int
    sign: float
    tooth: int
    angle_deg: float
    phase: float
    rng: np.random.Generator
    drawn: Shapes | None = None

    @property
    def shapes(self) -> Shapes:
        """The shapes that were drawn for the gear."""
        assert self.drawn is not None, "only a physics of one gear has shapes"
        return self.drawn

    @property
    def torque(self) -> float:
        """The highest torque in N.m."""
        return max(c.torque for c in self.conditions)

    @property
    def urad_per_um(self) -> float:
        """Angle of the shaft in urad that moves its flanks by 1 um."""
        return MM_PER_UM / self.pair.gear(self.gear).r_b * 1e6


@dataclass(frozen=True, kw_only=True)
class RivalSetting:
    """What a rival is asked beside: the effect that it may be mistaken for, the rig, the highest torque in N.m, and the
    gear that it would sit on (0: none)."""

    effect: Effect
    rig: Rig
    torque: float
    gear: int
    other: bool


@dataclass(frozen=True, kw_only=True)
class Kind:
    """All that one rival can be: ``make`` its effect of some numbers, the first ``amplitudes`` of them null where it is
    absent, the others its shape; each between ``low`` and ``high``, with a small ``step``; ``starts``: shapes to begin
    with."""

    make: Callable[[FloatArray], Effect]
    low: FloatArray
    high: FloatArray
    step: FloatArray
    amplitudes: int
    starts: tuple[tuple[float, ...], ...] = ((),)


@dataclass(frozen=True, kw_only=True)
class ConcealedPhysics:
    """One physics.

    name: the contract's. size: the parameter that says how much of it there is; from_one: it counts from 1. apply: the
    rig with the effect in it. example: one effect that leaves about a micrometre. cap: no larger than a rig could have
    it, in the unit of the size; least: no smaller; unit: a small size, at which its signal is looked at first.

    gear: it sits on one gear or one shaft. shows: the recordings it needs ("load", "flanks", "speeds", "coast", or ""
    for any). plain: it needs both angles, and times. tells: what else of ``Effect.more`` a truth states; told: the
    truth in full where that is not enough. as_built: what teeth within their grade have as well ("index", "slope" or
    "form").

    place: what it is seen as by who knows no cause: a "wave" of a shaft, a curve of one "tooth" or of every "mesh", a
    slow "course", a "step" from condition to condition; nearby: as what else, a "tone" in time, a "tooth_flank" (a
    curve by the part that the tooth carries).

    rivals: what is worth comparing it with; a dash means the other gear. one_sign: a negative size is nonsense.
    possible: whether it can be there at all; kind: all that it can be as the rival of another effect.

    outside: not in the catalogue that a diagnosis is told of. source: where its law is from."""

    name: str
    size: str
    apply: Callable[[Rig, Effect], Rig]
    example: Callable[[Site], Effect]
    cap: float
    source: str
    least: float = 0.0
    from_one: bool = False
    unit: float = 1.0
    gear: bool = True
    shows: str = ""
    plain: bool = False
    tells: tuple[str, ...] = ()
    told: Callable[[Rig, Effect, tuple[RecordedCondition, ...]], dict[str, Any]] | None = None
    place: str = "mesh"
    nearby: tuple[str, ...] = ()
    as_built: str = ""
    rivals: tuple[str, ...] = ()
    one_sign: bool = False
    possible: Callable[[RivalSetting], bool] = lambda beside: True
    kind: Callable[[ConcealedPhysics, RivalSetting], Kind | None] = lambda physics, beside: physics.sizes(beside)
    outside: bool = False

    @property
    def lowest(self) -> float:
        """The least size of a rival."""
        return 0.0 if self.one_sign else -2 * self.cap

    def sizes(self, beside: RivalSetting) -> Kind:
        """A rival that has a size only, on the tooth of the effect if that sits on one."""
        more = beside.effect.more
        keep = {"tooth": more["tooth"]} if "tooth" in more else {}

        def make(v: FloatArray) -> Effect:
            return Effect(physics=self.name, gear=beside.gear, size=float(v[0]), more=keep)

        return numbers(make, 1, high=2 * self.cap, step=self.unit, low=self.lowest)


def numbers(make: Callable[[FloatArray], Effect], n: int, *, low: float, high: float, step: float) -> Kind:
    """All that n numbers between the same bounds can make."""
    return Kind(make=make, low=np.full(n, low), high=np.full(n, high), step=np.full(n, step), amplitudes=n)


def wave(physics: ConcealedPhysics, beside: RivalSetting) -> Kind | None:
    """A rival with an amplitude and a phase, at the order of the effect: on the other gear only where as many teeth
    make that a whole order."""
    order = beside.effect.more.get("order", 1)
    if beside.other:
        pair = beside.rig.pair
        ratio = order * pair.gear(beside.gear).z / pair.gear(3 - beside.gear).z
        if abs(ratio - round(ratio)) > 1e-9:
            return None
        order = round(ratio)

    def make(v: FloatArray) -> Effect:
        phase = atan2(v[1], v[0])
        further = {"order": order, "phase": phase, "angle_deg": phase / RAD_PER_DEG}
        return Effect(physics=physics.name, gear=beside.gear, size=hypot(v[0], v[1]), more=further)

    return numbers(make, 2, low=-2 * physics.cap, high=2 * physics.cap, step=physics.unit)


def once_per_turn(physics: ConcealedPhysics, beside: RivalSetting) -> Kind | None:
    """Such a wave that can turn once per turn only."""
    kind = wave(physics, beside)
    return kind if kind is not None and kind.make(np.ones(2)).more["order"] == 1 else None


def loaded(beside: RivalSetting) -> bool:
    """Whether teeth bend under a torque."""
    return bool(beside.torque and beside.rig.deflect)
