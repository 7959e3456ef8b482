"""Which recording would decide: look-alikes simulated under conditions that were not recorded."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.diagnose.as_built import make_as_built
from gearpoly.diagnose.linear import Linear, derivatives
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.nuisance import Nuisance, slope_of, softened
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim
from gearpoly.physics.samples import Samples
from gearpoly.physics.scene import Scene, stage
from gearpoly.units import NM, RPM, FloatArray

PER_MESH = 12
"""Samples per mesh of a recording that is only thought of: six mesh orders."""

CYCLES = 2
"""Hunting cycles of it."""

LIGHT = 1.0 * NM
"""Torque that only keeps the flanks together."""

REFITTED = 0.5 * math.pi
"""Rotation in rad by which an encoder is refitted."""


@dataclass(frozen=True, kw_only=True)
class NextRecording:
    """A recording that could be made: ``flank``, ``torque`` in N.mm, ``speed`` in rad/s if it matters, ``refitted`` 0
    or 1: the encoder of that shaft turned on its shaft by a quarter turn, ``reversed``: run backwards."""

    flank: str
    torque: float
    speed: float | None = None
    refitted: int | None = None
    reversed: bool = False

    @property
    def says(self) -> str:
        """What to do, as a sentence."""
        if self.refitted is not None:
            name = ("driving", "driven")[self.refitted]
            return f"Turn the encoder on the {name} shaft by 90 deg on its shaft and record again."
        torque = f"{self.torque / NM:g} N.m"
        if self.reversed:
            return f"Run the pair backwards and record the {self.flank} flank at {torque}."
        speed = "" if self.speed is None else f" and {self.speed / RPM:.0f} rpm"
        return f"Record the {self.flank} flank at {torque}{speed}."

    def to_json(self) -> dict[str, object]:
        """The condition under the keys of a recording."""
        out: dict[str, object] = {"flank": self.flank, "torque_nm": self.torque / NM}
        if self.speed is not None:
            out["speed_rpm"] = self.speed / RPM
        if self.refitted is not None:
            out["refitted_encoder"] = ("driving", "driven")[self.refitted]
        if self.reversed:
            out["reversed"] = True
        return out


@dataclass(frozen=True, kw_only=True)
class Separation:
    """The recording that tells best, the sine ``separability`` of the angle that is then left, and that ``now``."""

    recording: NextRecording
    separability: float
    now: float


def options(model: Model) -> Iterator[NextRecording]:
    """Recordings worth thinking of: nearly no torque and full torque on both flanks, another speed, a refitted encoder,
    reversed rotation."""
    scope = model.scope
    full = max(*scope.torques, scope.file.pair.torque_nm * NM)
    flank = scope.flanks[0]
    other = "coast" if flank == "drive" else "drive"
    made = {(f, round(t, 3)) for f, t in zip(scope.flanks, scope.torques, strict=True)}
    for side in (flank, other):
        for torque in dict.fromkeys((LIGHT, full if full > LIGHT else 10.0 * LIGHT)):
            if (side, round(torque, 3)) not in made:
                yield NextRecording(flank=side, torque=torque)
    speeds = [speed for speed in scope.speeds if speed is not None]
    if speeds:
        yield NextRecording(flank=flank, torque=scope.torques[0], speed=2.0 * max(speeds))
    for shaft in (0, 1):
        if scope.encoders[shaft]:
            yield NextRecording(flank=flank, torque=scope.torques[0], refitted=shaft)
    if full > LIGHT:
        yield NextRecording(flank=flank, torque=full, reversed=True)


def imagined(model: Model, made: NextRecording, *, number: int) -> Scene:
    """A whole recording of the present set-up under other conditions, evenly sampled."""
    first = model.observed[0].samples if model.observed else None
    assembled = model.assembled()
    pair = assembled.pair
    size = CYCLES * pair.meshes_per_cycle * PER_MESH
    theta_2 = np.linspace(0.0, CYCLES * pair.cycle, size, endpoint=False)
    theta_1 = theta_2 / pair.ratio
    speed = made.speed or (first.speed if first is not None else None)
    zero = [0.0, 0.0]
    if first is not None:
        zero = [float(first.reading_1[0] - first.direction_1 * first.theta_1[0])]
        zero.append(float(first.reading_2[0] - first.direction_2 * first.theta_2[0]))
    if made.refitted is not None:
        zero[made.refitted] += REFITTED
    sense = (first.direction_1, first.direction_2) if first is not None else (1, 1)
    samples = Samples(
        number=number,
        flank="coast" if made.flank == "coast" else "drive",
        torque=made.torque,
        speed=speed,
        theta_1=theta_1,
        theta_2=theta_2,
        time=None if speed is None else theta_1 / speed,
        reading_1=zero[0] + sense[0] * theta_1,
        reading_2=zero[1] + sense[1] * theta_2,
        direction_1=sense[0],
        direction_2=sense[1],
        counted=True,
    )
    return stage(assembled, samples)


def effects(
    model: Model, scenes: Sequence[Scene], claim: Claim, *, reverse: Sequence[bool], but: Claim | None = None
) -> list[FloatArray]:
    """What a claim does (n_k,) in mm in every scene; what friction does turns with the rotation."""
    found = model.change([_as_recorded(model, scene, claim) for scene in scenes], claim, claim.values, but=but)
    if claim.physics.name != "friction":
        return found
    return [-change if back else change for change, back in zip(found, reverse, strict=True)]


def _as_recorded(model: Model, scene: Scene, claim: Claim) -> Scene:
    """The scene, but that what every recording showed the next one shows too: where all began cold, it will."""
    every = claim.place.recordings
    if scene.samples.number < model.scope.conditions or len(every) < model.scope.conditions:
        return scene
    return replace(scene, samples=replace(scene.samples, number=every[0]))


Part = tuple[list[FloatArray], list[list[FloatArray]]]
"""Of some recordings, in sigmas: a claim's signal (n_k,), and of each rival what it can make (n_k, a)."""


def would_separate(
    model: Model, scenes: list[Scene], linear: Linear, k: int, rivals: Sequence[Claim], *, nuisance: Nuisance
) -> Separation | None:
    """The recording that would best tell claim ``k`` from all its ``rivals``, beside everything else that is open.

    Separability is the sine of the angle between the claim's signal and what its rivals span, each with its amplitudes
    free, over the present recordings and the new one together; as-built teeth, the compliance's scale, zeros and the
    other claims are fitted beside. How laws of compliance differ under the new condition is left out. None where none
    would help, of those that the pair can run.
    """
    leave = linear.layout.places(k) + linear.layout.form_places(model, k)
    keep = np.setdiff1d(np.arange(linear.system.size), np.asarray(leave))
    whites = [a[:, keep] for a in linear.system.white]
    precision = linear.system.precision[np.ix_(keep, keep)]
    claim = model.claims[k]
    others = model.but(claim)
    spans = [_span(one) for one in rivals]

    def signals(here: Sequence[Scene], white: Callable[[int, FloatArray], FloatArray], back: bool) -> Part:
        reverse = [back] * len(here)
        mine = effects(others, here, claim, reverse=reverse)
        theirs = [[effects(others, here, one, reverse=reverse) for one in span] for span in spans]
        return (
            [white(n, one) for n, one in enumerate(mine)],
            [[white(n, np.column_stack([one[n] for one in span])) for n in range(len(here))] for span in theirs],
        )

    told = signals(scenes, lambda n, c: linear.noises[n].whitened(c), False)
    normal = precision + sum((a.T @ a for a in whites), np.zeros_like(precision))
    now = least_sine(normal, [(whites, *told)])
    best: Separation | None = None
    level = float(np.mean([noise.level for noise in linear.noises]))
    for made in options(model):
        try:
            scene = imagined(model, made, number=len(scenes))
            more = signals([scene], lambda n, c: c / level, made.reversed)
            new, wider = _open_columns(model, scene, linear, keep, level, nuisance=nuisance, but=claim)
        except GearpolyError:
            continue  # the pair cannot run like that
        grown = np.zeros((wider.shape[0], wider.shape[0]))
        grown[: keep.size, : keep.size] = precision
        grown += wider
        padded = [np.pad(a, ((0, 0), (0, grown.shape[0] - keep.size))) for a in whites]
        total = grown + sum((a.T @ a for a in padded), np.zeros_like(grown)) + new.T @ new
        sine = least_sine(total, [(padded, *told), ([new], *more)])
        if best is None or sine > best.separability + 0.01:
            best = Separation(recording=made, separability=sine, now=now)
    if best is None or best.separability < now + 0.02:
        return None
    return best


def _span(rival: Claim) -> list[Claim]:
    """Claims that span what a rival can make: one of each of its amplitudes, as large as all of them."""
    a = rival.physics.amplitudes
    if a == 1:
        return [rival]
    size = float(np.linalg.norm(rival.values[:a]))
    return [replace(rival, values=(*(size * np.eye(a)[n]).tolist(), *rival.values[a:])) for n in range(a)]


def _open_columns(
    model: Model, scene: Scene, linear: Linear, keep: np.ndarray, level: float, *, nuisance: Nuisance,
    but: Claim,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Columns (n, m') of what is open in a new scene, in sigmas, all claims ``but`` one among it, and the precision
    (m', m') of what it adds: the teeth of a flank that was not recorded yet."""
    n, layout = scene.samples.size, linear.layout
    whole = np.zeros((n, linear.system.size))
    whole[:, layout.built] = model.as_built.columns(scene)
    # The mean over both encoders' common zero, which is the first of the nuisance.
    whole[:, layout.nuisance.start] = 1.0
    whole[:, layout.nuisance.start + nuisance.shift] = slope_of(scene)
    if nuisance.scale is not None:
        whole[:, layout.nuisance.start + nuisance.scale] = softened(scene)
    for at, claim in zip(layout.claims, model.claims, strict=True):
        if claim is not but:
            whole[:, at] = derivatives(model, [scene], claim)[0]
    out = whole[:, keep]
    if scene.samples.flank in model.as_built.flanks:
        return out / level, np.zeros((keep.size, keep.size))
    old, flank = model.as_built, scene.samples.flank
    more, both = make_as_built(old.gears, [flank]), make_as_built(old.gears, [*old.flanks, flank])
    # What is known of the recorded flank beforehand is known of the other in part, and counted already.
    per_flank = np.arange(more.size)
    known = [both.start(one, 0) + per_flank for one in (*old.flanks, flank)]
    joint = both.precision[np.ix_(np.concatenate(known), np.concatenate(known))].copy()
    joint[: old.size, : old.size] -= old.precision
    place = np.concatenate((np.arange(old.size) + layout.built.start, keep.size + per_flank))
    precision = np.zeros((keep.size + more.size, keep.size + more.size))
    precision[np.ix_(place, place)] = joint
    return np.concatenate((out, more.columns(scene)), axis=1) / level, precision


def least_sine(
    normal: FloatArray, parts: Sequence[tuple[list[FloatArray], list[FloatArray], list[list[FloatArray]]]]
) -> float:
    """The smallest sine over all rivals of the angle between a signal and what a rival can make of it, everything open
    taken off both: ``normal`` (m, m) is the information about all that is open, ``parts`` hold columns (n_k, m) of it,
    the signal (n_k,) and the rivals' (n_k, a)."""
    scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    inverse = np.linalg.inv(normal / np.outer(scale, scale) + 1e-9 * np.eye(scale.size)) / np.outer(scale, scale)
    out = 1.0
    for j in range(len(parts[0][2])):
        own, cross = np.zeros(()), np.zeros(())
        for whites, mine, theirs in parts:
            for k, white in enumerate(whites):
                both = np.column_stack((mine[k], theirs[j][k]))
                own, cross = own + both.T @ both, cross + white.T @ both
        left = own - cross.T @ inverse @ cross
        rival = left[1:, 1:]
        if left[0, 0] <= 0.0 or float(np.trace(rival)) <= 1e-12 * left[0, 0]:
            continue
        taken = left[0, 1:] @ np.linalg.pinv(rival, rcond=1e-9, hermitian=True) @ left[1:, 0]
        out = min(out, math.sqrt(max(0.0, 1.0 - float(taken) / left[0, 0])))
    return out
