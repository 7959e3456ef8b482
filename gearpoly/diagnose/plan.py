"""Before anything is measured: which look-alikes this pair has, and which recordings would tell them apart."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from gearpoly.compare.stand_in import known_file
from gearpoly.diagnose.as_built import AsBuilt, make_as_built
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.nuisance import SCALE_STD, law_changes, law_modes, softened
from gearpoly.diagnose.prepare import gear_priors, reaches
from gearpoly.diagnose.separate import LIGHT, NextRecording, effects, imagined
from gearpoly.errors import GearpolyError
from gearpoly.files.models import PairFile
from gearpoly.gear.gear import Gear
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim, Place, Scope, Values
from gearpoly.physics.scene import Scene
from gearpoly.units import NM, RPM, UM, FloatArray

NOISE = 0.5 * UM
"""mm per sample that is assumed: an ordinary rig."""

TOLD = 0.5
"""Sine from which two physics count as told apart: an effect of ten standard deviations still stands out by five."""

SIZES: dict[str, Values] = {
    "eccentricity": (5.0, 0.0),
    "encoder_eccentricity": (100.0, 0.0),
    "cumulative_pitch": (5.0, 0.0),
    "tooth_pitch": (4.0,),
    "tooth_spall": (5.0,),
    "tooth_crack": (0.3,),
    "profile_slope": (3.0,),
    "profile_crowning": (3.0,),
    "tip_relief": (5.0,),
    "wear": (3.0,),
    "friction": (0.05,),
    "misalignment": (10.0,),
    "centre_distance": (20.0,),
    "tooth_thickness": (5.0,),
    "shaft_windup": (1.0,),
}
"""Amplitudes, in the units of the pair file, of the effects that are laid side by side: ordinary faults of ordinary
gears. Waves and drifts that are like nothing else are left out."""


@dataclass(frozen=True, kw_only=True)
class LookAlike:
    """Two physics that one recording cannot tell apart: sine of their angle in the first recording alone, and in each
    campaign of the plan."""

    one: str
    other: str
    first: float
    after: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Plan:
    """``first`` the recording that anybody would make, ``further`` those worth making after it, most telling first, and
    the look-alikes with what each step leaves of them."""

    name: str
    first: NextRecording
    further: tuple[NextRecording, ...]
    look_alikes: tuple[LookAlike, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Grams:
    """Products of one recording's whitened columns: of what is open (m, m), with the effects (m, q), of these
    (q, q)."""

    open: FloatArray
    cross: FloatArray
    own: FloatArray


def plan(file: PairFile, *, path: Path | str, step: Callable[[str], None] = lambda _: None) -> Plan:
    """Which recordings would tell the look-alikes of a pair apart.

    Raises ``GeometryError`` or ``OutOfRangeError`` where the pair cannot run at all.
    """
    model, chosen = _model(file, Path(path))
    step("thinking of recordings")
    full = max(file.pair.torque_nm * NM, 10.0 * LIGHT)
    first, *others = _recordings(file, full)
    scenes: list[Scene] = [imagined(model, first, number=0)]
    kept = [first]
    for made in others:
        try:
            scenes.append(imagined(model, made, number=len(kept)))
            kept.append(made)
        except GearpolyError:
            continue
    step("simulating them")
    claims = chosen(scenes)
    grams = _grams(model, scenes, kept, claims)
    precision = grams.pop()
    step("laying look-alikes side by side")
    groups = [f"{c.physics.name}{'' if c.place.gear is None else ' ' + (c.place.gear_name or '')}" for c in claims]
    pairs = [
        (i, j, sine)
        for i, j in combinations(range(len(claims)), 2)
        if (sine := _sine([grams[0]], precision.open, claims, i, j)) is not None and sine < TOLD
    ]
    campaign, left = [0], {(i, j): sine for i, j, sine in pairs}
    order: list[int] = []
    history: dict[tuple[int, int], list[float]] = {key: [] for key in left}
    while len(campaign) < len(kept) and any(sine < TOLD for sine in left.values()):
        best: tuple[float, int, dict[tuple[int, int], float]] | None = None
        for k in range(1, len(kept)):
            if k in campaign:
                continue
            held = [grams[j] for j in [*campaign, k]]
            now = {(i, j): _sine(held, precision.open, claims, i, j) or 0.0 for i, j in left}
            score = sum(min(sine, TOLD) for sine in now.values())
            if best is None or score > best[0] + 0.01:
                best = (score, k, now)
        if best is None or best[0] < sum(min(sine, TOLD) for sine in left.values()) + 0.05:
            break
        _, k, left = best
        campaign.append(k)
        order.append(k)
        for key, sine in left.items():
            history[key].append(sine)
    return Plan(
        name=file.name,
        first=first,
        further=tuple(kept[k] for k in order),
        look_alikes=tuple(
            LookAlike(one=groups[i], other=groups[j], first=sine, after=tuple(history[i, j])) for i, j, sine in pairs
        ),
    )


def _recordings(file: PairFile, full: float) -> list[NextRecording]:
    out = [NextRecording(flank=flank, torque=torque) for flank in ("drive", "coast") for torque in (full, LIGHT)]
    out += [NextRecording(flank="drive", torque=full, refitted=shaft) for shaft in (0, 1)]
    out.append(NextRecording(flank="drive", torque=full, reversed=True))
    if file.pair.speed_rpm is not None:
        out.append(NextRecording(flank="drive", torque=full, speed=2.0 * file.pair.speed_rpm * RPM))
    return out


def _model(file: PairFile, path: Path) -> tuple[Model, Callable[[list[Scene]], list[Claim]]]:
    declared = known_file(file)
    gears, priors = gear_priors(file)
    as_built: AsBuilt = make_as_built(priors, ["drive", "coast"])
    full = max(file.pair.torque_nm * NM, 10.0 * LIGHT)
    speed = None if file.pair.speed_rpm is None else file.pair.speed_rpm * RPM
    model = Model(
        declared=declared,
        path=path,
        scope=Scope(
            file=declared,
            gears=gears,
            flanks=("drive", "coast", "drive", "coast"),
            torques=(full, full, LIGHT, LIGHT),
            speeds=(speed,) * 4,
            encoders=(True, True),
            timed=True,
            counted=True,
            span=10.0,
            inspected=(not priors[0].graded, not priors[1].graded),
            reach=((0.0, 1.0), (0.0, 1.0)),
        ),
        as_built=as_built,
        observed=[],
        shift_std=1e-4,
        built=np.zeros(as_built.size),
    )

    def chosen(scenes: list[Scene]) -> list[Claim]:
        model.scope = _scope_with_reach(model.scope, scenes[0])
        return list(_claims(model.scope, gears))

    return model, chosen


def _scope_with_reach(scope: Scope, scene: Scene) -> Scope:
    return Scope(**{**scope.__dict__, "reach": reaches(scene.pair)})


def _claims(scope: Scope, gears: tuple[Gear, Gear]) -> list[Claim]:
    """One ordinary fault of every kind on each gear, teeth and shapes somewhere in their middle."""
    out = []
    for name, size in SIZES.items():
        physics = catalogue()[name]
        seen: dict[int | None, list[Place]] = {}
        for place in physics.places(scope):
            if place.flank in (None, "drive") and place.order in (None, 1):
                seen.setdefault(place.gear, []).append(place)
        for gear, places in seen.items():
            tooth = None if gear is None else gears[gear].z // 3
            fitting = [p for p in places if p.tooth in (None, tooth)]
            fitting = [p for p in fitting if p.flank is None] or fitting
            place = fitting[len(fitting) // 2]
            out.append(Claim(physics=physics, place=place, values=(*size, *place.shape)))
    return out


def _grams(model: Model, scenes: list[Scene], made: list[NextRecording], claims: list[Claim]) -> list[_Grams]:
    """Products of every recording, and last the precision of what is open."""
    laws = law_modes(scenes, law_changes(scenes))
    back = [one.reversed for one in made]
    signals: list[list[FloatArray]] = [[] for _ in scenes]
    for claim in claims:
        for k in range(claim.physics.amplitudes):
            values = (*(v if j == k else 0.0 for j, v in enumerate(_turned(claim))), *claim.place.shape)
            one = Claim(physics=claim.physics, place=claim.place, values=values)
            for mine, change in zip(signals, effects(model, scenes, one, reverse=back), strict=True):
                mine.append(change)
    out = []
    for k, scene in enumerate(scenes):
        parts = [model.as_built.columns(scene), np.ones((scene.samples.size, 1)), softened(scene)[:, None]]
        if laws is not None:
            parts.append(laws[k])
        opened = np.concatenate(parts, axis=1) / NOISE
        effect = np.column_stack(signals[k]) / NOISE
        out.append(_Grams(open=opened.T @ opened, cross=opened.T @ effect, own=effect.T @ effect))
    m = out[0].open.shape[0]
    precision = np.zeros((m, m))
    built = model.as_built.size
    precision[:built, :built] = model.as_built.precision
    rest = [1e-6, SCALE_STD**-2.0, *(1.0,) * (m - built - 2)]
    precision[range(built, m), range(built, m)] = rest
    out.append(_Grams(open=precision, cross=np.zeros((m, 0)), own=np.zeros((0, 0))))
    return out


def _turned(claim: Claim) -> Values:
    """The amplitudes that stand for one claim's columns: each in turn at the claim's size."""
    size = max(abs(v) for v in claim.values[: claim.physics.amplitudes])
    return (size,) * claim.physics.amplitudes


def _sine(grams: list[_Grams], precision: FloatArray, claims: list[Claim], i: int, j: int) -> float | None:
    """Sine of the angle between what claim i does and all that claim j could do; None where either shows nowhere."""
    starts = np.cumsum([0] + [c.physics.amplitudes for c in claims])
    mine, theirs = np.arange(starts[i], starts[i] + 1), np.arange(starts[j], starts[j + 1])
    both = np.concatenate((mine, theirs))
    normal = precision + sum((g.open for g in grams), np.zeros_like(precision))
    cross = sum((g.cross[:, both] for g in grams), np.zeros((normal.shape[0], both.size)))
    own = sum((g.own[np.ix_(both, both)] for g in grams), np.zeros((both.size, both.size)))
    scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    solved = np.linalg.solve(normal / np.outer(scale, scale) + 1e-9 * np.eye(scale.size), cross / scale[:, None])
    left = own - (cross / scale[:, None]).T @ solved
    self_, rival, shared = left[0, 0], left[1:, 1:], left[1:, 0]
    # What shows by less than one standard deviation is told from nothing, look-alike or not.
    if self_ < 1.0 or np.min(np.diag(rival)) < 1.0:
        return None
    taken = float(shared @ np.linalg.solve(rival + 1e-9 * np.trace(rival) * np.eye(theirs.size), shared))
    return math.sqrt(max(0.0, 1.0 - taken / float(self_)))
