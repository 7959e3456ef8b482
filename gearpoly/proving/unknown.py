"""The rival without a cause: a free wave of a shaft, a free curve of one tooth or of every mesh, a slow course, a step
from condition to condition, a tone in time.

It can always come as near as it likes, so what tells a physics from it is how little the physics needs for that.
Derived here, Laplace about a linear Gaussian model: with a whitened signal s left after the nuisances and columns C
whose amplitudes have prior standard deviation 1, the log evidence over nothing is
1/2 b' (I + G)^-1 b - 1/2 log|I + G| with b = C' s, G = C' C. The physics pays the same price for each of its numbers
as for a column of the effect's own size; the unknown's columns together have the rms of the effect, both as seen after
the nuisances, so that only shape and freedoms tell them apart."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from math import log, pi, sqrt
from typing import Any

import numpy as np
from scipy.interpolate import BSpline

from gearpoly.proving.chain import RecordedCondition, te
from gearpoly.proving.effects import Effect
from gearpoly.proving.gears import FloatArray
from gearpoly.proving.limit import DetectionLimit, Sight
from gearpoly.proving.physics import PHYSICS_BY_NAME
from gearpoly.proving.physics.base import RivalSetting
from gearpoly.proving.rig import Rig, mesh
from gearpoly.proving.rivals import whitened

FREE_TOOTH_KNOTS = 7
"""Knots of a cubic spline over the contact of one tooth: a pit of a third of the flank is followed, its edges not."""
FREE_MESH_HARMONICS = 4
"""Mesh harmonics of a free mesh curve, of amplitudes that fall as one over the harmonic: so do those of a curve with a
jump, and no flank is rougher."""
FREE_COURSE_POWERS = 3
"""Powers of the time of a free slow course."""


@dataclass(frozen=True, kw_only=True)
class PlaceOfUnknown:
    """A kind of place: the ``columns`` (n, k) that are free there in one recording, and the ``forms`` that they may
    take."""

    columns: Callable[[Rig, Sight, Effect], FloatArray]
    forms: tuple[str, ...]


def _angle(rig: Rig, one: Sight, gear: int) -> FloatArray:
    """Angle in rad of the shaft of gear 1 or 2, transmission error included: lines of an encoder are a thousand to a
    turn, of which 10 um are a part."""
    theta_2 = one.path.angle(one.time)
    if gear == 2:
        return theta_2
    x = te(rig, one.condition, one.path, at=one.time)
    return np.asarray((rig.pair.driven.r_b * theta_2 - x) / rig.pair.driving.r_b)


def _harmonics(angle: FloatArray, count: int = 1) -> FloatArray:
    turns = angle[:, None] * np.arange(1, count + 1)
    return np.hstack([np.cos(turns), np.sin(turns)]) / np.tile(np.arange(1, count + 1), 2)


def _wave(rig: Rig, one: Sight, effect: Effect) -> FloatArray:
    return _harmonics(effect.more.get("order", 1) * _angle(rig, one, effect.gear or 2))


def _tone(rig: Rig, one: Sight, effect: Effect) -> FloatArray:
    hz = effect.more.get("mesh_hz", 0.0) / sqrt(max(abs(effect.size), 1e-9))
    return _harmonics(2 * pi * hz * one.time)


def _tooth(rig: Rig, one: Sight, effect: Effect, *, flank: bool = False) -> FloatArray:
    """Splines over the roll length at which that tooth touches, or would if it carried; ``flank``: by the part of it
    that reaches the motion, as a deviation of its flank does."""
    theta_2, gear = one.path.angle(one.time), effect.gear
    got = mesh(rig, theta_2, torque=one.condition.torque, flank=one.condition.flank, span=one.path.angles)
    tooth, roll = (got.tooth_1, got.roll_1) if gear == 1 else (got.tooth_2, got.roll_2)
    start = rig.pair.l_start(gear)
    u = (roll - start) / (rig.pair.gear(gear).l_tip - start)
    knots = np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, FREE_TOOTH_KNOTS), np.ones(3)])
    out = np.zeros((one.time.size, FREE_TOOTH_KNOTS + 2))
    rows, slots = np.nonzero((tooth == effect.more["tooth"]) & (roll > 0.0) & (u >= 0.0) & (u <= 1.0))
    if not rows.size:
        return out  # no reading of this recording meets the tooth
    out[rows] = BSpline.design_matrix(u[rows, slots], knots, 3).toarray()
    if flank:
        out[rows] *= got.weights[rows, slots, None]
    return out


def _flank(rig: Rig, one: Sight, effect: Effect) -> FloatArray:
    return _tooth(rig, one, effect, flank=True)


def _mesh(rig: Rig, one: Sight, effect: Effect) -> FloatArray:
    return _harmonics(_angle(rig, one, 2) * rig.pair.driven.z, FREE_MESH_HARMONICS)


def _course(rig: Rig, one: Sight, effect: Effect) -> FloatArray:
    gone = (one.time - one.path.span[0]) / (one.path.span[1] - one.path.span[0])
    return np.asarray(gone[:, None] ** np.arange(FREE_COURSE_POWERS + 1))


def _step(rig: Rig, one: Sight, effect: Effect) -> FloatArray:
    return np.ones((one.time.size, 1))


RECORDINGS_ALIKE_BY_FORM: dict[str, Callable[[RecordedCondition], Hashable]] = {
    "all": lambda one: 0,
    "flank": lambda one: one.flank,
    "load": lambda one: (one.flank, one.torque),
    "condition": lambda one: (one.flank, one.torque, one.speed),
}
"""Forms: recordings in which the unknown is one and the same. Who knows no cause cannot say which it is, so each that
the place allows is tried and the likeliest counts; never is a physics named because it foretells what any wheel on the
shaft does as well."""

PLACES_OF_UNKNOWN = {
    # What else turns with a shaft turns so under any load; what sits on its flanks is of one flank, and may bend.
    "wave": PlaceOfUnknown(columns=_wave, forms=("all", "flank", "load")),
    "tooth": PlaceOfUnknown(columns=_tooth, forms=("flank", "condition")),
    "tooth_flank": PlaceOfUnknown(columns=_flank, forms=("flank", "condition")),
    "mesh": PlaceOfUnknown(columns=_mesh, forms=("flank", "condition")),
    "course": PlaceOfUnknown(columns=_course, forms=("all", "condition")),
    # An offset common to all recordings is the mean, and a phase in time means nothing from one to another.
    "step": PlaceOfUnknown(columns=_step, forms=("condition",)),
    "tone": PlaceOfUnknown(columns=_tone, forms=("condition",)),
}


def free_columns(rig: Rig, limit: DetectionLimit, effect: Effect, place: str, form: str) -> FloatArray:
    """Whitened columns (n, k) over all recordings of what has no cause at a place; none that is nil. So there are none
    at all (k = 0) where what sits there moves no sample: a flank that its neighbours keep off the mate whenever the
    encoders are read, or a tooth that a part of a turn leaves out."""
    keys = [RECORDINGS_ALIKE_BY_FORM[form](one.condition) for one in limit.look]
    groups = list(dict.fromkeys(keys))
    out = []
    for key, one in zip(keys, limit.look, strict=True):
        free = PLACES_OF_UNKNOWN[place].columns(rig, one, effect)
        k = free.shape[1]
        own = np.zeros((free.shape[0], k * len(groups)))
        own[:, groups.index(key) * k : (groups.index(key) + 1) * k] = free
        out.append(limit.whiten(one, limit.chain, own))
    columns = np.concatenate(out)
    norm = np.sqrt(np.einsum("ij,ij->j", columns, columns))
    return columns[:, norm > 1e-9 * norm.max()]


def log_evidence(s: FloatArray, perp: FloatArray, columns: FloatArray, taken: FloatArray) -> float:
    """Log evidence over nothing of columns (n, k) with amplitudes of 1 for a whitened signal s; ``perp`` and ``taken``:
    signal and columns less what the nuisances take."""
    b, gram = columns.T @ perp, columns.T @ taken
    whole = np.eye(b.size) + 0.5 * (gram + gram.T)
    return float(0.5 * b @ np.linalg.solve(whole, b) - 0.5 * np.linalg.slogdet(whole)[1])


@dataclass(frozen=True, kw_only=True)
class LikeliestUnknown:
    """The likeliest unknown: at which ``place``, in which ``form``; its ``log_evidence``; and what is ``left`` of the
    effect by the nearest that any unknown can make, over the effect's size: the distance of rivals."""

    place: str
    form: str
    log_evidence: float
    left: float


def nearest(rig: Rig, limit: DetectionLimit, effect: Effect) -> LikeliestUnknown:
    """The unknown that comes nearest to an effect put into a rig; ``limit`` is built about the rig without it.

    A place at which nothing moves a sample has no unknown that could be likelier, or come nearer, than another. If no
    place has one, the unknown is that nothing is there: log evidence 0, and all of the effect is left."""
    s = whitened(rig, limit, effect)
    perp = limit.perp(s)
    q = float(s @ perp)
    one = PHYSICS_BY_NAME[effect.physics]
    tried, left = [], 1.0 if q > 0.0 else 0.0
    for place in (one.place, *one.nearby):
        for form in PLACES_OF_UNKNOWN[place].forms:
            free = free_columns(rig, limit, effect, place, form)
            if not free.shape[1]:
                continue
            taken = np.stack([limit.perp(column) for column in free.T], axis=1)
            seen = float(np.einsum("ij,ij->", free, taken))
            scale = sqrt(max(q, 0.0) / seen) if seen > 0.0 else 0.0
            tried.append((log_evidence(s, perp, scale * free, scale * taken), place, form))
            left = min(left, _left(free, taken, perp, q))
    best, place, form = max(tried, default=(0.0, one.place, PLACES_OF_UNKNOWN[one.place].forms[0]))
    return LikeliestUnknown(place=place, form=form, log_evidence=best, left=left)


def _left(free: FloatArray, taken: FloatArray, perp: FloatArray, q: float) -> float:
    """Part of the size that no amplitudes of the columns make, nuisances taken out of both."""
    gram, b = 0.5 * (free.T @ taken + taken.T @ free), free.T @ perp
    made = float(b @ np.linalg.pinv(gram, rcond=1e-9, hermitian=True) @ b)
    return sqrt(min(max(1.0 - made / q, 0.0), 1.0)) if q > 0.0 else 0.0


def freedoms(rig: Rig, limit: DetectionLimit, effect: Effect) -> int:
    """How many numbers an effect has: sizes, and those of its shape."""
    torque = max(one.condition.torque for one in limit.look)
    one = PHYSICS_BY_NAME[effect.physics]
    kind = one.kind(one, RivalSetting(effect=effect, rig=rig, torque=torque, gear=effect.gear, other=False))
    return 1 if kind is None else kind.low.size


def unknown(rig: Rig, limit: DetectionLimit, effect: Effect) -> dict[str, Any]:
    """The unknown at the effect's place as truths tell of a rival.

    A rival that is left at n standard deviations is less likely than the effect by n^2 / 2 in log odds. So the
    separability times the effect's size over the limit is the n that corresponds to the log odds of the physics over
    the unknown; ``log_odds`` has those themselves, before any prior. ``left`` is the separability by distance alone, of
    an unknown whose freedoms cost nothing."""
    found = nearest(rig, limit, effect)
    over = limit.size_of(whitened(rig, limit, effect))
    q, k = over * over, freedoms(rig, limit, effect)
    odds = 0.5 * q * q / (k + q) - 0.5 * k * log(1.0 + q / k) - found.log_evidence
    sigmas = sqrt(2.0 * max(odds, 0.0))
    return {
        "physics": "unknown", "place": found.place, "form": found.form, "log_odds": round(odds, 2),
        "separability": round(min(sigmas / over, 1.0), 4) if over > 0.0 else 0.0, "left": round(found.left, 4),
    }  # fmt: skip
