"""What else an effect could be: how near everything worth comparing comes to it in the recordings of a case.

Separability is the distance between the effect's signal and the nearest that its rival can make, in the metric of the
limit, whatever size, place and sign the rival can have, over the effect's size in that metric: of small signals the
sine of the angle between them. An effect of n standard deviations is told from its rival at n times that. Derived here:
minimum of a weighted distance by Gauss and Newton's method."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

from gearpoly.proving.effects import Effect, apply
from gearpoly.proving.gears import FloatArray
from gearpoly.proving.limit import DetectionLimit
from gearpoly.proving.physics import PHYSICS_BY_NAME
from gearpoly.proving.physics.base import Kind, RivalSetting
from gearpoly.proving.rig import BenchError, Rig

MOST_STEPS_TO_RIVAL = 5
"""Steps at most; three are enough where signals bend little."""
LAST_STEP_PART = 0.98
"""A step that leaves more than this part of the distance is the last."""


PARTS_OF_DEVIATION = (0.0, 0.15, 0.3, 0.5, 0.7, 0.85)
"""Parts of a deviation that are tried as the one that shows as much."""

UNLIKE_SIGNAL_PART, UNLIKE_SIGMAS = 0.85, 15.0
"""A rival that at first leaves more than this part of the signal, and this many standard deviations, is looked at no
closer: nothing hangs on how far it is."""


@dataclass(frozen=True, kw_only=True)
class RivalOfEffect:
    """One rival: its ``separability`` from the effect and what the two differ by at their nearest, ``apart`` in um
    rms."""

    physics: str
    gear: int
    separability: float
    apart: float

    def told(self) -> dict[str, Any]:
        """The rival as truths tell of it."""
        out: dict[str, Any] = {"physics": self.physics}
        if self.gear:
            out["gear"] = self.gear
        return out | {"separability": round(self.separability, 4), "apart_um": round(self.apart, 5)}


def whitened(rig: Rig, limit: DetectionLimit, effect: Effect) -> FloatArray:
    """Whitened signal of one effect put into a rig.

    Of what teeth as built have as well, that part is taken to first order with which least remains: a fit of the teeth
    follows it, pairs that lead others and all, and a tooth that has left the mesh shows no more than one that just
    does. What the rest adds is taken as it is.
    """
    taken = _as_built(rig, limit, effect)
    if taken is None:
        return limit.difference(apply(rig, effect))
    whole, best = limit.difference(apply(rig, effect)), taken
    for part in PARTS_OF_DEVIATION:
        try:
            rest = whole - limit.difference(apply(rig, effect.scaled(part * abs(effect.size))))
        except BenchError:  # pragma: no cover - a smaller deviation runs where a larger one does
            continue
        signal = part * taken + rest
        if limit.size_of(signal) < limit.size_of(best):
            best = signal
    return best


def _as_built(rig: Rig, limit: DetectionLimit, effect: Effect) -> FloatArray | None:
    """Whitened signal to first order of what teeth as built may have as well; None of any other effect."""
    what = PHYSICS_BY_NAME[effect.physics].as_built
    if not what:
        return None
    before, after = rig.teeth(effect.gear), apply(rig, effect).teeth(effect.gear)
    if what == "index":
        return limit.index_signal(effect.gear, after.p - before.p)
    if what == "slope":
        return limit.slope_signal(effect.gear, after.slope - before.slope)
    return limit.form_signal(effect.gear, effect.size)


def rivals(rig: Rig, limit: DetectionLimit, effect: Effect) -> list[RivalOfEffect]:
    """Every rival of an effect put into a rig, the nearest first; ``limit`` is built about the rig without it.

    How far a rival is left is asked where a fit rests that has found the effect: with the pairs leading that lead then.
    """
    hidden = apply(rig, effect)
    about = limit.around(hidden)
    over = limit.size_of(whitened(rig, limit, effect))
    out = []
    for name in PHYSICS_BY_NAME[effect.physics].rivals:
        kind = _kind(effect, rig, limit, name)
        if kind is None:
            continue
        # Far from the effect other pairs lead, and first order leads astray: the way there begins at the rig without.
        first, _ = _nearest(rig, limit, hidden, kind)
        at, rest = _nearest(rig, about, hidden, kind, begin=first)
        meant = kind.make(at)
        apart = float((about.seen(apply(rig, meant)) - about.plain).std())
        left = about.size_of(rest) / over if over > 0.0 else 1.0
        out.append(RivalOfEffect(physics=meant.physics, gear=meant.gear, separability=min(left, 1.0), apart=apart))
    return sorted(out, key=lambda one: one.separability)


def _nearest(
    rig: Rig, limit: DetectionLimit, hidden: Rig, kind: Kind, *, begin: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """The numbers with which a rival, put into a ``rig``, comes nearest to what is ``hidden`` in it, and what it leaves
    of that whitened signal; ``begin``: numbers to begin with if nothing else comes as near at once."""
    bare = limit.difference(rig)
    s = limit.difference(hidden) - bare

    def signal(v: FloatArray) -> FloatArray:
        return limit.difference(apply(rig, kind.make(v))) - bare

    def slopes(v: FloatArray, here: FloatArray, few: int) -> FloatArray:
        steps = np.where(v + kind.step > kind.high, -kind.step, kind.step)
        return np.stack([(signal(v + steps[j] * np.eye(v.size)[j]) - here) / steps[j] for j in range(few)], axis=1)

    def size(rest: FloatArray) -> float:
        return limit.size_of(rest)

    def left_by(v: FloatArray) -> tuple[FloatArray, float]:
        try:
            left = s - signal(v)
        except BenchError:  # gears that cannot run like this are no likeness
            return s, inf
        return left, size(left)

    n = kind.amplitudes
    at, rest = np.array([0.0] * n + list(kind.starts[0])), s
    whole = least = size(s)
    for shape in kind.starts:
        v = np.array([0.0] * n + list(shape))
        columns = slopes(v, np.zeros_like(s), n)
        trials = [limit.fit(s, columns, low=kind.low[:n], high=kind.high[:n])]
        if n == 1:  # small and large signals may differ much: also the sizes that would be as loud as the effect
            loud = whole / max(size(columns[:, 0]), 1e-9)
            trials += [np.clip([side * loud], kind.low[:1], kind.high[:1]) for side in (1.0, -1.0)]
        for v[:n] in trials:
            left, much = left_by(v)
            if much < least:
                at, rest, least = v.copy(), left, much
    if begin is not None:
        left, much = left_by(begin)
        if much < least:
            at, rest, least = begin, left, much
    if least > UNLIKE_SIGMAS and least > UNLIKE_SIGNAL_PART * whole:
        return at, rest
    for _ in range(MOST_STEPS_TO_RIVAL):
        J = slopes(at, s - rest, at.size)
        step = limit.fit(rest, J, low=kind.low - at, high=kind.high - at)
        before = least
        for part in (1.0, 0.5, 0.2):  # signals bend: a whole step may go too far
            left, much = left_by(at + part * step)
            if much < before:
                at, rest, least = at + part * step, left, much
                break
        if least > LAST_STEP_PART * before:
            break
    return at, rest


def _kind(effect: Effect, rig: Rig, limit: DetectionLimit, name: str) -> Kind | None:
    """What a rival can be beside an effect; None where it cannot be at all."""
    physics = PHYSICS_BY_NAME[name.rstrip("'")]
    mine = effect.gear or 1
    gear = 0 if not physics.gear else 3 - mine if name.endswith("'") else mine
    torque = max(one.condition.torque for one in limit.look)
    beside = RivalSetting(effect=effect, rig=rig, torque=torque, gear=gear, other=name.endswith("'"))
    return physics.kind(physics, beside) if physics.possible(beside) else None
