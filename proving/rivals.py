"""What else an effect could be: how near everything worth comparing comes to it in the recordings of a case.

Separability is the distance between the effect's signal and the nearest that its rival can make, in the metric of the
limit, whatever size, place and sign the rival can have, over the effect's size in that metric: of small signals the
sine of the angle between them. An effect of n standard deviations is told from its rival at n times that. Derived here:
minimum of a weighted distance by Gauss and Newton's method."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import atan2, hypot, inf, sqrt
from typing import Any

import numpy as np

from proving.effects import Effect, apply
from proving.gears import DEG, FloatArray
from proving.limit import Limit
from proving.rig import BenchError, Rig
from proving.scenes import CAPS

RIVALS: dict[str, tuple[str, ...]] = {
    "eccentricity": ("cumulative_pitch", "encoder_eccentricity"),
    "cumulative_pitch": ("eccentricity", "encoder_eccentricity", "undulation", "cumulative_pitch'"),
    "encoder_eccentricity": ("eccentricity", "cumulative_pitch"),
    "tooth_pitch": ("tooth_crack", "tooth_spall"),
    "tooth_crack": ("tooth_pitch", "tooth_spall"),
    "tooth_spall": ("tooth_pitch", "tooth_crack"),
    "profile_slope": ("profile_slope'", "wear", "wear'", "tip_relief", "tip_relief'", "friction"),
    "profile_crowning": (
        "profile_crowning'", "wear", "wear'", "tip_relief", "tip_relief'", "tooth_deflection", "misalignment",
    ),
    "tip_relief": (
        "tip_relief'", "profile_slope", "profile_slope'", "profile_crowning", "profile_crowning'", "wear", "wear'",
        "tooth_deflection",
    ),
    "wear": (
        "wear'", "profile_crowning", "profile_crowning'", "profile_slope", "profile_slope'", "tip_relief",
        "tip_relief'", "tooth_deflection",
    ),
    "undulation": ("encoder_interpolation", "cumulative_pitch", "undulation'"),
    "encoder_interpolation": ("undulation", "undulation'", "encoder_interpolation'"),
    "tooth_deflection": (
        "profile_crowning", "profile_crowning'", "tip_relief", "tip_relief'", "wear", "wear'", "shaft_windup",
    ),
    "misalignment": (
        "profile_crowning", "profile_crowning'", "friction", "shaft_windup", "centre_distance", "tooth_thickness",
    ),
    "friction": ("profile_slope", "profile_slope'", "profile_crowning", "profile_crowning'", "misalignment"),
    "centre_distance": ("tooth_thickness", "tooth_thickness'", "shaft_windup", "misalignment"),
    "tooth_thickness": ("tooth_thickness'", "centre_distance", "shaft_windup"),
    "shaft_windup": ("misalignment", "centre_distance", "tooth_thickness", "tooth_thickness'"),
    "mesh_resonance": ("profile_crowning", "tip_relief", "tip_relief'", "profile_slope", "friction", "misalignment"),
    "thermal_drift": ("encoder_scale", "encoder_scale'"),
    "encoder_scale": ("encoder_scale'", "thermal_drift"),
}  # fmt: skip
"""What is worth comparing with what; a dash means the other gear. Whether it is a look-alike is computed, case by
case."""

ONE_SIGN = (
    "tooth_deflection", "misalignment", "friction", "tooth_crack", "tooth_spall", "tip_relief", "wear", "shaft_windup",
)  # fmt: skip
"""Physics that a negative size would turn into nonsense."""

UNITS = {"friction": 0.02, "tooth_crack": 0.1, "encoder_eccentricity": 20.0, "encoder_interpolation": 20.0,
         "encoder_scale": 1e-7, "tooth_deflection": 0.1}  # fmt: skip
"""Small sizes, in each effect's own unit, at which signals are looked at first; 1 where none is given."""

WAVES = ("eccentricity", "cumulative_pitch", "encoder_eccentricity", "undulation", "encoder_interpolation")
"""Physics with an amplitude and a phase."""

WHOLE = ("friction", "misalignment", "shaft_windup", "centre_distance", "thermal_drift", "tooth_deflection")
"""Physics of no single gear."""

ROUNDS = 5
"""Steps at most; three are enough where signals bend little."""
ENOUGH = 0.98
"""A step that leaves more than this part of the distance is the last."""


PARTS = (0.0, 0.15, 0.3, 0.5, 0.7, 0.85)
"""Parts of a deviation that are tried as the one that shows as much."""

UNLIKE, FAR = 0.85, 15.0
"""A rival that at first leaves more than this part of the signal, and this many standard deviations, is looked at no
closer: nothing hangs on how far it is."""


@dataclass(frozen=True, kw_only=True)
class Rival:
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


def whitened(rig: Rig, limit: Limit, effect: Effect) -> FloatArray:
    """Whitened signal of one effect put into a rig.

    Of what teeth as built have as well, that part is taken to first order with which least remains: a fit of the teeth
    follows it, pairs that lead others and all, and a tooth that has left the mesh shows no more than one that just
    does. What the rest adds is taken as it is.
    """
    taken = _as_built(rig, limit, effect)
    if taken is None:
        return limit.difference(apply(rig, effect))
    whole, best = limit.difference(apply(rig, effect)), taken
    for part in PARTS:
        try:
            rest = whole - limit.difference(apply(rig, effect.scaled(part * abs(effect.size))))
        except BenchError:  # pragma: no cover - a smaller deviation runs where a larger one does
            continue
        signal = part * taken + rest
        if limit.size_of(signal) < limit.size_of(best):
            best = signal
    return best


def _as_built(rig: Rig, limit: Limit, effect: Effect) -> FloatArray | None:
    """Whitened signal to first order of what teeth as built may have as well; None of any other effect."""
    if effect.physics in ("tooth_pitch", "cumulative_pitch"):
        p = apply(rig, effect).teeth(effect.gear).p - rig.teeth(effect.gear).p
        return limit.index_signal(effect.gear, p)
    if effect.physics == "profile_slope":
        return limit.slope_signal(
            effect.gear, apply(rig, effect).teeth(effect.gear).slope - rig.teeth(effect.gear).slope
        )
    if effect.physics == "profile_crowning":
        return limit.form_signal(effect.gear, effect.size)
    return None


def rivals(rig: Rig, limit: Limit, effect: Effect) -> list[Rival]:
    """Every rival of an effect put into a rig, the nearest first; ``limit`` is built about the rig without it.

    How far a rival is left is asked where a fit rests that has found the effect: with the pairs leading that lead then.
    """
    hidden = apply(rig, effect)
    about = limit.around(hidden)
    over = limit.size_of(whitened(rig, limit, effect))
    out = []
    for name in RIVALS.get(effect.physics, ()):
        kind = _kind(effect, rig, limit, name)
        if kind is None:
            continue
        # Far from the effect other pairs lead, and first order leads astray: the way there begins at the rig without.
        first, _ = _nearest(rig, limit, hidden, kind)
        at, rest = _nearest(rig, about, hidden, kind, begin=first)
        meant = kind.make(at)
        apart = float((about.seen(apply(rig, meant)) - about.plain).std())
        left = about.size_of(rest) / over if over > 0.0 else 1.0
        out.append(Rival(physics=meant.physics, gear=meant.gear, separability=min(left, 1.0), apart=apart))
    return sorted(out, key=lambda one: one.separability)


def _nearest(
    rig: Rig, limit: Limit, hidden: Rig, kind: Kind, *, begin: FloatArray | None = None
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
    for shape in kind.starts:
        v = np.array([0.0] * n + list(shape))
        columns = slopes(v, np.zeros_like(s), n)
        trials = [limit.fit(s, columns, low=kind.low[:n], high=kind.high[:n])]
        if n == 1:  # small and large signals may differ much: also the sizes that would be as loud as the effect
            loud = size(s) / max(size(columns[:, 0]), 1e-9)
            trials += [np.clip([side * loud], kind.low[:1], kind.high[:1]) for side in (1.0, -1.0)]
        for v[:n] in trials:
            left, much = left_by(v)
            if much < size(rest):
                at, rest = v.copy(), left
    if begin is not None:
        left, much = left_by(begin)
        if much < size(rest):
            at, rest = begin, left
    if size(rest) > FAR and size(rest) > UNLIKE * size(s):
        return at, rest
    for _ in range(ROUNDS):
        J = slopes(at, s - rest, at.size)
        step = limit.fit(rest, J, low=kind.low - at, high=kind.high - at)
        before = size(rest)
        for part in (1.0, 0.5, 0.2):  # signals bend: a whole step may go too far
            left, much = left_by(at + part * step)
            if much < before:
                at, rest = at + part * step, left
                break
        if size(rest) > ENOUGH * before:
            break
    return at, rest


def _kind(effect: Effect, rig: Rig, limit: Limit, name: str) -> Kind | None:
    """What a rival can be beside an effect; None where it cannot be at all."""
    other = name.endswith("'")
    name = name.rstrip("'")
    mine = effect.gear or 1
    gear = 0 if name in WHOLE else 3 - mine if other else mine
    more, pair = effect.more, rig.pair
    torque = max(one.condition.torque for one in limit.look)
    if name in ("tooth_crack", "friction", "misalignment") and not (torque and rig.deflect):
        return None
    if name in ("tooth_deflection", "shaft_windup") and not torque:
        return None
    if name == "tooth_deflection" and rig.deflect:
        return None
    cap, unit = 2 * CAPS.get(name, 1.0), UNITS.get(name, 1.0)
    if name in WAVES:
        order = more.get("order", 1)
        if other:
            ratio = order * pair.gear(gear).z / pair.gear(mine).z
            if abs(ratio - round(ratio)) > 1e-9:
                return None
            order = round(ratio)
        if name in ("eccentricity", "encoder_eccentricity") and order != 1:
            return None
        if name == "cumulative_pitch" and order > pair.gear(gear).z // 2:
            return None

        def wave(v: FloatArray) -> Effect:
            phase = atan2(v[1], v[0])
            further = {"order": order, "phase": phase, "angle_deg": phase / DEG}
            return Effect(physics=name, gear=gear, size=hypot(v[0], v[1]), more=further)

        return _sizes(wave, 2, cap, unit)
    if name == "tooth_spall":
        return _spall(rig, gear, more["tooth"], cap)
    if name == "tip_relief":
        return _relief(rig, gear, cap)
    if name == "thermal_drift":

        def drift(v: FloatArray) -> Effect:
            return Effect(physics=name, size=float(v[0]), more={"bend": float(v[1])})

        return Kind(
            make=drift, low=np.array([-cap, 0.01]), high=np.array([cap, 8.0]), step=np.array([1.0, 0.1]), amplitudes=1,
            starts=((0.1,), (3.0,)),
        )  # fmt: skip
    keep = {"tooth": more["tooth"]} if "tooth" in more else {}

    def plain(v: FloatArray) -> Effect:
        return Effect(physics=name, gear=gear, size=float(v[0]), more=keep)

    return _sizes(plain, 1, cap, unit, low=0.0 if name in ONE_SIGN else -cap)


def _sizes(make: Callable[[FloatArray], Effect], n: int, cap: float, unit: float, low: float | None = None) -> Kind:
    lowest = -cap if low is None else low
    return Kind(make=make, low=np.full(n, lowest), high=np.full(n, cap), step=np.full(n, unit), amplitudes=n)


def _spall(rig: Rig, gear: int, tooth: int, cap: float) -> Kind:
    """A pit wherever it may be: depth, middle and half width, the latter two in parts of the active flank."""
    g, start = rig.pair.gear(gear), rig.pair.l_start(gear)
    span = g.l_tip - start

    def pit(v: FloatArray) -> Effect:
        ends = [start + span * float(np.clip(v[1] + side * v[2], 0.0, 1.0)) for side in (-1, 1)]
        low, high = (sqrt(g.r_b**2 + l * l) for l in ends)
        return Effect(
            physics="tooth_spall", gear=gear, size=float(v[0]), more={"tooth": tooth, "from_mm": low, "to_mm": high}
        )

    return Kind(
        make=pit, low=np.array([0.0, 0.05, 0.04]), high=np.array([cap, 0.95, 0.5]), step=np.array([1.0, 0.02, 0.02]),
        amplitudes=1, starts=((0.5, 0.5), (0.3, 0.2), (0.5, 0.2), (0.7, 0.2)),
    )  # fmt: skip


def _relief(rig: Rig, gear: int, cap: float) -> Kind:
    """A relief of any length; where one is declared, more or less of it at its own length."""
    g, teeth = rig.pair.gear(gear), rig.teeth(gear)

    def relief(v: FloatArray) -> Effect:
        length = float(v[1]) if v.size > 1 else teeth.relief_mm
        more = {"length_mm": length, "power": teeth.power}
        return Effect(physics="tip_relief", gear=gear, size=teeth.relief + float(v[0]), more=more)

    if teeth.relief:
        return Kind(
            make=relief, low=np.array([-teeth.relief]), high=np.array([cap]), step=np.ones(1), amplitudes=1
        )  # fmt: skip
    deepest = g.r_a - sqrt(g.r_b**2 + rig.pair.l_start(gear) ** 2)
    return Kind(
        make=relief, low=np.array([0.0, 0.1 * g.m]), high=np.array([cap, 0.95 * deepest]),
        step=np.array([1.0, 0.02 * g.m]), amplitudes=1, starts=((0.25 * g.m,), (0.6 * g.m,), (0.9 * deepest,)),
    )  # fmt: skip
