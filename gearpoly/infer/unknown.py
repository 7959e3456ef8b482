"""What may be at a place without a cause that anybody knows: a wave of a shaft, a curve over the contact of one tooth,
a curve over every mesh, a slow course, a step, a mean.

An unknown has the freedoms that a place leaves it and no further knowledge. A physics earns its name against these.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.polynomial.legendre import legvander

from gearpoly.physics.base import Claim
from gearpoly.scene import Scene
from gearpoly.units import FloatArray

UNKNOWN_MESH_HARMONICS = 8
"""Harmonics of the mesh that a curve of no cause has: the corners of a contact show up to about there."""

UNKNOWN_TURN_ORDERS_PER_TOOTH = 3
"""Waves per turn and tooth up to which a curve of no cause over a turn goes: what steps within a third of a pitch. A
judgement."""

RECORDINGS_WITH_OWN_CURVE = 4
"""Recordings up to which each may have a curve of its own: more would take columns by the gigabyte."""

UNKNOWN_TOOTH_KNOTS = 12
"""Places along the contact of one tooth between which a curve of no cause runs straight."""

UNKNOWN_CURVE_REACH = (0.12, 0.4)
"""Parts of the contact of a tooth over which such a curve forgets itself: a pit's edge, a lean."""

IMAGES = 4
"""Mesh orders about which images of a flank's wave are looked for."""

IMAGE_POWER_PART = 0.1
"""Part of the strongest image's power from which another counts: weaker ones are below a third of its amplitude. A
judgement, not tuned."""

UNKNOWN_COURSE_TERMS = 6
"""Legendre polynomials of a slow course of no cause."""

UNKNOWN_STEP_MOMENTS = 24
"""Moments of a recording at which it may have jumped."""

UNKNOWN_SLOW_PERIODS = (0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0)
"""Periods in a recording of a slow wave of no cause: what turns slower than both shafts, and what heats by turns. From
three on it is a line of its own. Without them 0.83 periods of another shaft were named a thermal drift (0.985)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Unknown:
    """An explanation without a cause: ``columns`` (n_k, q) per recording, normal about 0 with relative standard
    deviations ``std`` (q,), and the ``weight`` that it has among those of its place. ``wider``: it reaches beyond that
    place, to harmonics and side bands, where something else may be."""

    name: str
    columns: list[FloatArray]
    std: FloatArray
    weight: float
    wider: bool = False

    @property
    def by_order(self) -> list[list[int]]:
        """The columns of each order of waves, in whichever recording: those of one order are as large beforehand."""
        return [np.flatnonzero(self.std == std).tolist() for std in np.unique(self.std)[::-1]]


Grouping = Callable[[Scene], object]


def _group(scenes: Sequence[Scene], by: Grouping) -> list[int]:
    """Number of every scene's group, counted from 0."""
    keys = [by(scene) for scene in scenes]
    return [list(dict.fromkeys(keys)).index(key) for key in keys]


def _apart(parts: Sequence[FloatArray], groups: Sequence[int]) -> list[FloatArray]:
    """Columns (n_k, q g), those of every group for itself."""
    many, out = max(groups) + 1, []
    for part, group in zip(parts, groups, strict=True):
        wide = np.zeros((part.shape[0], part.shape[1] * many))
        wide[:, group * part.shape[1] : (group + 1) * part.shape[1]] = part
        out.append(wide)
    return out


def _same(scene: Scene) -> object:
    return 0


def _flank(scene: Scene) -> object:
    return scene.samples.flank


def _condition(scene: Scene) -> object:
    return scene.samples.flank, round(scene.samples.torque, 3)


def _number(scene: Scene) -> object:
    return scene.samples.number


def _repeated(
    name: str,
    scenes: Sequence[Scene],
    parts: Sequence[FloatArray],
    std: FloatArray,
    ways: Sequence[tuple[str, Grouping]],
) -> list[Unknown]:
    """The same curve in all recordings, or another by flank, by condition, or in each, where that is not the same."""
    out: list[Unknown] = []
    seen: list[list[int]] = []
    for words, by in ways:
        groups = _group(scenes, by)
        if groups in seen:
            continue
        seen.append(groups)
        many = max(groups) + 1
        out.append(Unknown(name=f"{name}{words}", columns=_apart(parts, groups), std=np.tile(std, many), weight=1.0))
    return [replace(one, weight=weight) for one, weight in zip(out, plainest_first(len(out)), strict=True)]


def plainest_first(many: int) -> list[float]:
    """Weights of so many forms of one unknown cause, the plainest first: it has half, the others share the rest. Were
    all alike, a cause would be the less likely the more forms of it were thought of."""
    return [1.0] if many == 1 else [0.5, *[0.5 / (many - 1)] * (many - 1)]


def waves(scenes: Sequence[Scene], gear: int, orders: Sequence[float]) -> list[Unknown]:
    """Waves of these ``orders`` per turn of a shaft together, drawn at each of its ``angles``: nobody knows which is
    the true one."""
    ways = (("", _same), (" by flank", _flank), (" by recording", _number))
    drawn, drawn_at = [], list(zip(*(angles_of(scene, gear) for scene in scenes), strict=True))
    for angles in drawn_at:
        parts = [np.column_stack([f(order * x) for order in orders for f in (np.cos, np.sin)]) for x in angles]
        drawn += _repeated("wave", scenes, parts, np.repeat(orders[0] / np.asarray(orders), 2), ways)
    return [replace(one, weight=one.weight / len(drawn_at)) for one in drawn]


def harmonics_of(order: int) -> list[int]:
    """An order with its next harmonics: what comes so often per turn, as the teeth of another gear do, is seldom a pure
    wave."""
    return [order * k for k in (1, 2, 3)]


def with_side_bands(order: int) -> list[int]:
    """The same harmonics with the orders beside each: teeth of another gear that runs off its axis come stronger and
    weaker once per turn."""
    return [order, *(k * order + s for k in (1, 2, 3) for s in (-1, 0, 1) if k * order + s not in (0, order))]


def angles_of(scene: Scene, gear: int) -> tuple[FloatArray, FloatArray]:
    """Angles (n,) in rad of a shaft: as its reading was estimated, and as the mate's teeth turn it. They are not the
    same where one shaft's angle is nothing but time, or is made of the other's and of the error itself."""
    samples, ratio = scene.samples, scene.gear(0).z / scene.gear(1).z
    if gear == 0:
        return samples.reading_1, samples.theta_2 / ratio
    return samples.reading_2, samples.theta_1 * ratio


def flank_waves(scenes: Sequence[Scene], gear: int, order: int, effect: Sequence[FloatArray]) -> list[Unknown]:
    """Waves where a wave of the flanks shows: at its own order, and at its images about the mesh orders, each of them
    alone and those that its ``effect`` (n_k,) in mm has together. One pair carries after the other, and a wave that
    does not fit a whole number of times between them looks like slower ones."""
    z = scenes[0].gear(gear).z
    images = sorted({abs(order + j * z) for j in range(-IMAGES, IMAGES + 1)} - {0})
    power = np.zeros(len(images))
    for scene, one in zip(scenes, effect, strict=True):
        angle = angles_of(scene, gear)[1]
        for k, image in enumerate(images):
            power[k] += abs(complex(np.exp(-1j * image * angle) @ one)) ** 2 / max(1, one.size)
    most = float(np.max(power, initial=0.0))
    seen = [
        image for image, p in zip(images, power.tolist(), strict=True) if image == order or p > IMAGE_POWER_PART * most
    ]
    groups: list[list[int]] = [[order], *([image] for image in seen if image != order)]
    groups += [seen] if len(seen) > 1 else []
    groups += [harmonics_of(order), with_side_bands(order)]
    return _each(scenes, gear, order, groups)


def _each(scenes: Sequence[Scene], gear: int, order: int, groups: Sequence[Sequence[float]]) -> list[Unknown]:
    """Waves of each of these groups of orders about an ``order``, the plainest first."""
    weights, wide = plainest_first(len(groups)), (harmonics_of(order), with_side_bands(order))
    return [
        replace(one, weight=weight * one.weight, wider=group in wide)
        for group, weight in zip(groups, weights, strict=True)
        for one in waves(scenes, gear, group)
    ]


def turn_orders(z: int) -> int:
    """Waves per turn of the shaft of a gear of ``z`` teeth up to which a curve over its turn goes."""
    return UNKNOWN_TURN_ORDERS_PER_TOOTH * z


def turn_curves(scenes: Sequence[Scene], gear: int) -> list[Unknown]:
    """A curve that is the same in every turn of a shaft, and may step: its waves fall off as 1/h. In each of few
    recordings, or of each flank, it may be another. What is the same at every mesh is no part of it. Which angle it
    belongs to, that of the reading or of the teeth, makes no difference to what it can do."""
    z = scenes[0].gear(gear).z
    orders = [order for order in range(1, turn_orders(z) + 1) if order % z]
    drawn = [angles_of(scene, gear)[0] for scene in scenes]
    parts = [np.column_stack([f(order * x) for order in orders for f in (np.cos, np.sin)]) for x in drawn]
    few = len(scenes) <= RECORDINGS_WITH_OWN_CURVE
    ways = (("", _same), (" by flank", _flank), *(((" by recording", _number),) if few else ()))
    return _repeated("curve over the turn", scenes, parts, np.repeat(1.0 / np.asarray(orders), 2), ways)


def tooth_curves(scenes: Sequence[Scene], gear: int, tooth: int) -> list[Unknown]:
    """A curve over the contact of one tooth, of a correlation over some part of it that nobody knows."""
    parts = [tooth_hats(scene, gear, tooth, knots=UNKNOWN_TOOTH_KNOTS) for scene in scenes]
    x = np.linspace(0.0, 1.0, UNKNOWN_TOOTH_KNOTS)
    out = []
    for reach in UNKNOWN_CURVE_REACH:
        root = np.linalg.cholesky(np.exp(-np.abs(x[:, None] - x) / reach) + 1e-9 * np.eye(UNKNOWN_TOOTH_KNOTS))
        mixed = [part @ root for part in parts]
        out += _repeated(
            "curve", scenes, mixed, np.ones(UNKNOWN_TOOTH_KNOTS), (("", _same), (" by condition", _condition))
        )
    return [
        Unknown(name=one.name, columns=one.columns, std=one.std, weight=one.weight / len(UNKNOWN_CURVE_REACH))
        for one in out
    ]


def tooth_hats(scene: Scene, gear: int, tooth: int, *, knots: int) -> FloatArray:
    """Hats (n, ``knots``) along the active flank of one tooth, as they show in the transmission error."""
    place = np.clip(scene.spans[gear].u(scene.roll(gear)), 0.0, 1.0) * (knots - 1)
    mine = scene.teeth(gear) == tooth
    hats = np.maximum(0.0, 1.0 - np.abs(place[:, :, None] - np.arange(knots)))
    return scene.swung(scene.samples.sense * np.einsum("pn,pnk->nk", scene.weight * mine, hats))


def mesh_curves(scenes: Sequence[Scene], *, means: bool = False) -> list[Unknown]:
    """A curve that is the same at every mesh; with ``means``, a mean of its own too."""
    parts = [mesh_harmonics(scene, means=means) for scene in scenes]
    return _repeated("mesh curve", scenes, parts, mesh_std(means=means), (("", _flank), (" by condition", _condition)))


def mesh_harmonics(scene: Scene, *, means: bool = False) -> FloatArray:
    """Cosines and sines (n, 2 H) of the first harmonics of the mesh, and first a 1 with ``means``."""
    angle = scene.samples.theta_2 * scene.gear(1).z
    waves = [wave(h * angle) for h in range(1, UNKNOWN_MESH_HARMONICS + 1) for wave in (np.cos, np.sin)]
    return np.column_stack([np.ones_like(angle), *waves] if means else waves)


def mesh_std(*, means: bool = False) -> FloatArray:
    """Relative standard deviations of the harmonics: a curve with corners falls off as 1/h."""
    harmonics = np.repeat(1.0 / np.arange(1, UNKNOWN_MESH_HARMONICS + 1), 2)
    return np.concatenate(([1.0], harmonics)) if means else harmonics


def slow_courses(scenes: Sequence[Scene], recordings: Sequence[int]) -> list[Unknown]:
    """A slow course of every recording by itself: straight, bent, a slow wave, or a step at some moment in it."""
    along = [scene.samples.along for scene in scenes]
    within = [float(not recordings or k in recordings) for k, _ in enumerate(scenes)]
    ways = (("", _same), (" by recording", _number))

    def drawn(
        name: str, columns: Callable[[FloatArray], FloatArray], std: FloatArray, *, many: int = 2
    ) -> list[Unknown]:
        parts = [here * columns(x) for x, here in zip(along, within, strict=True)]
        return _repeated(name, scenes, parts, std, ways[:many])

    moments = np.linspace(-1.0, 1.0, UNKNOWN_STEP_MOMENTS + 2)[1:-1]
    forms = [
        [drawn("ramp", lambda x: x[:, None], np.ones(1))],
        [drawn("slow course", _bent, 1.0 / np.arange(1, UNKNOWN_COURSE_TERMS + 1))],
        [drawn("slow wave", partial(_slow_wave, periods=one), np.ones(2)) for one in UNKNOWN_SLOW_PERIODS],
        [drawn("step", partial(_step, at=at), np.ones(1), many=1) for at in moments],
    ]
    return [replace(one, weight=one.weight / (len(forms) * len(form))) for form in forms for way in form for one in way]


def _bent(along: FloatArray) -> FloatArray:
    """Legendre polynomials (n, ``UNKNOWN_COURSE_TERMS``) from the first on."""
    return np.asarray(legvander(along, UNKNOWN_COURSE_TERMS)[:, 1:], dtype=np.float64)


def _slow_wave(along: FloatArray, *, periods: float) -> FloatArray:
    """Cosine and sine (n, 2) of so many periods in a recording, from -1 to 1 ``along`` (n,) it."""
    return np.column_stack([wave(np.pi * periods * along) for wave in (np.cos, np.sin)])


def _step(along: FloatArray, *, at: float) -> FloatArray:
    """A step (n, 1) by 1 at a place between -1 and 1."""
    return np.asarray(along[:, None] >= at, dtype=np.float64)


def unknowns(
    claim: Claim, scenes: Sequence[Scene], *, order: int | None, effect: Sequence[FloatArray]
) -> list[Unknown]:
    """The explanations without a cause at the place of a ``claim`` that has this ``effect`` (n_k,) in mm; ``order`` of
    the wave that it is, if any."""
    place, physics = claim.place, claim.physics
    if physics.slow:
        return slow_courses(scenes, place.recordings)
    if place.tooth is not None:
        return tooth_curves(scenes, place.gear or 0, place.tooth)
    if order is not None:
        gear = place.gear or 0
        turning = physics.measures or place.order is None
        if not turning:
            return flank_waves(scenes, gear, order, effect)
        return _each(scenes, gear, order, ([order], harmonics_of(order), with_side_bands(order)))
    return mesh_curves(scenes, means=physics.whole_gear or not physics.mean_tooth)


def rms(columns: Sequence[FloatArray], std: FloatArray) -> float:
    """Root of the mean square in mm that columns with such sizes are expected to have over all samples."""
    power = sum(float(np.sum((part * std) ** 2)) for part in columns)
    return math.sqrt(power / max(1, sum(part.shape[0] for part in columns)))


def at_place(claim: Claim, scenes: Sequence[Scene], *, order: int | None, effect: Sequence[FloatArray]) -> Unknown:
    """The richest of them, for a fit that leaves a place without a cause."""
    found = [one for one in unknowns(claim, scenes, order=order, effect=effect) if one.columns[0].shape[1] > 1]
    return max(found, key=lambda one: one.columns[0].shape[1])
