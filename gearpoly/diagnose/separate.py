"""Which recording would decide: look-alikes simulated under conditions that were not recorded."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.diagnose.as_built import make_as_built
from gearpoly.diagnose.imagine import Imagined, NextRecording, effects
from gearpoly.diagnose.linear import Linear, derivatives
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.nuisance import Nuisance, slope_of, softened
from gearpoly.diagnose.sparse import Sparse, full
from gearpoly.diagnose.system import scales_of
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim
from gearpoly.scene import Scene
from gearpoly.units import FloatArray

LEAST_ADDED_SINE = 0.02
"""Sine that a further recording has to add to be worth making."""


@dataclass(frozen=True, kw_only=True)
class Separation:
    """The recording that tells best, the sine ``separability`` of the angle that is then left, and that ``now``;
    ``told`` in standard deviations of the claim, by which it then stands out from its rivals."""

    recording: NextRecording
    separability: float
    now: float
    told: float


Part = tuple[list[FloatArray], list[list[FloatArray]]]
"""Of some recordings, in sigmas: a claim's signal (n_k,), and of each rival what it can make (n_k, a)."""

Seen = tuple[list[Sparse], list[FloatArray], list[list[FloatArray]]]
"""The same with the columns (n_k, m) of all that is open before them."""


def would_separate(
    model: Model,
    scenes: list[Scene],
    linear: Linear,
    k: int,
    rivals: Sequence[Claim],
    *,
    nuisance: Nuisance,
    thought: Imagined,
    least: float = LEAST_ADDED_SINE,
) -> Separation | None:
    """The recording that would best tell claim ``k`` from all its ``rivals``, beside everything else that is open.

    Separability is the sine of the angle between the claim's signal and what its rivals span, each with its amplitudes
    free, over the present recordings and the new one together; as-built teeth, the compliance's scale and the ways in
    which its laws differ, zeros and the other claims are fitted beside. None where none would add ``least``, of those
    that the pair can run.
    """
    leave = linear.layout.places(k) + linear.layout.form_places(model, k)
    keep = np.setdiff1d(np.arange(linear.system.size), np.asarray(leave))
    whites = [a.only(keep) for a in linear.system.white]
    precision = linear.system.precision[np.ix_(keep, keep)]
    claim = model.claims[k]
    others = model.but(claim)
    spans = [_span(one) for one in rivals]

    def signals(made: Sequence[Scene], white: Callable[[int, FloatArray], FloatArray]) -> Part:
        here = model.drawn_without(claim, list(made)) if claim.takes_contact else made
        mine = effects(others, here, claim)
        theirs = [[effects(others, here, one) for one in span] for span in spans]
        return (
            [white(n, one) for n, one in enumerate(mine)],
            [[white(n, np.column_stack([one[n] for one in span])) for n in range(len(here))] for span in theirs],
        )

    told = signals(scenes, lambda n, c: linear.noises[n].whitened(c))
    normal = sum((a.gram() for a in whites), precision)
    now = least_sine(normal, [(whites, *told)])
    best: Separation | None = None
    level = float(np.mean([noise.level for noise in linear.noises]))
    for made, scene in thought.scenes:
        try:
            more = signals([scene], lambda n, c: c / level)
            new, wider = _open_columns(
                model, scene, linear, keep, level, nuisance=nuisance, doubt=thought.doubt(scene), but=claim
            )
        except GearpolyError:
            continue  # the pair cannot run like that
        grown = np.zeros((wider.shape[0], wider.shape[0]))
        grown[: keep.size, : keep.size] = precision
        grown += wider
        padded = [replace(a, shape=(a.shape[0], grown.shape[0])) for a in whites]
        total = sum((a.gram() for a in padded), grown) + new.T @ new
        seen = [(padded, *told), ([full(new)], *more)]
        sine = least_sine(total, seen)
        if best is None or sine > best.separability + 0.01:
            best = Separation(recording=made, separability=sine, now=now, told=simulation_floor(total, seen))
    if best is None or best.separability < now + least:
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
    doubt: tuple[FloatArray, FloatArray], but: Claim,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Columns (n, m') of what is open in a new scene, in sigmas, all claims ``but`` one among it, and the precision
    (m', m') of what it adds: what is in ``doubt`` of laws there only, and the teeth of a flank that was not recorded
    yet."""
    n, layout = scene.samples.size, linear.layout
    whole = np.zeros((n, linear.system.size))
    whole[:, layout.built] = model.as_built.columns(scene).dense()
    # The mean over both encoders' common zero, which is the first of the nuisance.
    whole[:, layout.nuisance.start] = 1.0
    whole[:, layout.nuisance.start + nuisance.shift] = slope_of(scene)
    if nuisance.scale is not None:
        whole[:, layout.nuisance.start + nuisance.scale] = softened(scene)
    shared, own = doubt
    # Laws are the last of the nuisance.
    whole[:, layout.nuisance.stop - shared.shape[1] : layout.nuisance.stop] = shared
    for at, claim in zip(layout.claims, model.claims, strict=True):
        if claim is not but:
            whole[:, at] = derivatives(model, [scene], claim)[0]
    out = np.concatenate((whole[:, keep], own), axis=1)
    size = out.shape[1]
    if scene.samples.flank in model.as_built.flanks:
        precision = np.zeros((size, size))
    else:
        old, flank = model.as_built, scene.samples.flank
        more, both = make_as_built(old.gears, [flank]), make_as_built(old.gears, [*old.flanks, flank])
        # What is known of the recorded flank beforehand is known of the other in part, and counted already.
        per_flank = np.arange(more.size)
        known = [both.start(one, 0) + per_flank for one in (*old.flanks, flank)]
        joint = both.precision[np.ix_(np.concatenate(known), np.concatenate(known))].copy()
        joint[: old.size, : old.size] -= old.precision
        place = np.concatenate((np.arange(old.size) + layout.built.start, size + per_flank))
        precision = np.zeros((size + more.size, size + more.size))
        precision[np.ix_(place, place)] = joint
        out = np.concatenate((out, more.columns(scene).dense()), axis=1)
    precision[range(keep.size, size), range(keep.size, size)] = 1.0
    return out / level, precision


def least_sine(normal: FloatArray, parts: Sequence[Seen]) -> float:
    """The smallest sine over all rivals of the angle between a signal and what a rival can make of it, everything open
    taken off both."""
    return min((sine for _, sine in _angles(normal, parts)), default=1.0)


def simulation_floor(normal: FloatArray, parts: Sequence[Seen]) -> float:
    """The fewest standard deviations by which a signal stands out from what any rival and everything open can make."""
    return min((size * sine for size, sine in _angles(normal, parts)), default=math.inf)


def _angles(normal: FloatArray, parts: Sequence[Seen]) -> Iterator[tuple[float, float]]:
    """Of every rival that shows, the size of the signal in standard deviations, everything open taken off, and the sine
    of its angle to what the rival can make: ``normal`` (m, m) is the information about all that is open, ``parts`` hold
    columns (n_k, m) of it, the signal (n_k,) and the rivals' (n_k, a)."""
    scale = scales_of(normal)
    inverse = np.linalg.inv(normal / np.outer(scale, scale) + 1e-9 * np.eye(scale.size)) / np.outer(scale, scale)
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
        yield math.sqrt(left[0, 0]), math.sqrt(max(0.0, 1.0 - float(taken) / left[0, 0]))
