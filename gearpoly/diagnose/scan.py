"""Every physics at every place, weighed against all that is believed already."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain

import numpy as np
from scipy.optimize import minimize

from gearpoly.compare.noise import Noise
from gearpoly.compare.spectrum import FrequencyGrid
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.system import gain_of
from gearpoly.errors import GearpolyError
from gearpoly.infer.chance import log_tail
from gearpoly.infer.load_wave import LOAD_WAVE
from gearpoly.physics.base import Claim, Physics, Scope
from gearpoly.physics.place import Place, Values
from gearpoly.scene import Scene
from gearpoly.threads import each
from gearpoly.units import FloatArray

BATCH = 128
"""Columns that are weighed at once: some ten MB each, and matrix products of a good size."""

HIGHEST_ORDER = 8192
"""Orders of either shaft that are looked at in one transform."""

FAINT_WAVE = 10.0
"""Gain of a wave below which its order is not looked at more closely: chance makes one in 150 as large, and none of
thousands is significant below twice as much."""

LIKELY_ORDERS_PER_SHAFT = 40
"""Orders per shaft that are looked at closely: the strongest lines, of which one is taken at a time."""

LEAST_INFORMATION_PART = 1e-6
"""Part of a column's information that must be left beside everything else, or it is told from nothing."""

KNOWN_BEFOREHAND = 1e-9
"""The same of a whole gear that stands off, which its limits tell and no recording: of teeth that limits hold to 3 um,
30 000 samples in 0.3 um of noise leave 4e-7 of what they tell of both gears together."""

EVALUATIONS = 18
"""Shapes per coordinate that are tried when a candidate is polished."""


@dataclass(frozen=True, kw_only=True)
class Looked:
    """How many places every physics was looked for at, by its name, those of claims among them: ``waves`` of all
    orders, single ``teeth``, and ``whole`` gears or pairs, every shape that was tried there counted (where on its flank
    a tooth is pitted, at which frequency a pair resounds); ``own`` counts none but the places."""

    waves: Mapping[str, int] = field(default_factory=dict)
    teeth: Mapping[str, int] = field(default_factory=dict)
    whole: Mapping[str, int] = field(default_factory=dict)
    own: Mapping[str, int] = field(default_factory=dict)

    def tests(self, claim: Claim) -> int:
        """Places by which the chance of a claim counts: waves, teeth and whole gears have a third of the family's each,
        or thousands of orders would outvote the teeth; and every physics of teeth or of gears an equal part of that, or
        spalls of all lengths would outvote the cracks. Waves are of one order whatever makes them, and share theirs."""
        if claim.physics.wavelike:
            return 3 * max(1, sum(self.waves.values()))
        kind = self.whole if claim.place.tooth is None else self.teeth
        return 3 * max(1, len(kind)) * kind.get(claim.physics.name, 1)

    def worth(self, one: Candidate) -> float:
        """Gain in misfit less what a candidate's freedoms and choice of a place are worth: what may be at fifty places
        fits noise at one of them better than what has two. Slow changes lie within one another: a wrong count is a
        drift whose bow and S are nothing, so freedoms cost as much as they might have told (Schwarz 1978)."""
        cost = max(2.0, math.log(max(one.gain, 1.0))) if one.claim.physics.slow else 2.0
        places = self.own.get(one.claim.physics.name, 1)
        return one.gain - cost * one.freedoms - 2.0 * math.log(places / min(1.0, one.claim.physics.common))


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A claim that might be made: its ``gain`` in misfit, amplitudes' signal over its doubt, for ``freedoms``."""

    claim: Claim
    gain: float
    freedoms: int

    def log_chance(self, *, tests: int) -> float:
        """Log of the chance that noise alone would gain as much anywhere among ``tests`` places; half of it where one
        sign of what noise looks like means nothing: no tooth is the stiffer for a crack."""
        physics = self.claim.physics
        signs = 1 if physics.amplitudes == 1 and physics.coordinates[0].low >= 0.0 else 2
        return math.log(tests * signs / 2) + log_tail(max(self.gain, 0.0), self.freedoms)


def probes(physics: Physics, place: Place) -> list[Values]:
    """The values at which the effect of each amplitude is looked at, one by one."""
    out = []
    for k in range(physics.amplitudes):
        size = place.probe[k] if place.probe else physics.coordinates[k].step
        amplitudes = tuple(size if j == k else 0.0 for j in range(physics.amplitudes))
        out.append((*amplitudes, *place.shape))
    return out


def _columns(model: Model, scenes: list[Scene], claim: Claim) -> list[FloatArray]:
    """Effect (n_k, a) in mm per unit of each amplitude of a claim's physics; nothing where gears cannot run with it,
    as teeth that lock on friction."""
    place = replace(claim.place, shape=claim.values[claim.physics.amplitudes :] or claim.place.shape)
    try:
        changes = [
            [change / values[k] for change in model.change(scenes, claim, values)]
            for k, values in enumerate(probes(claim.physics, place))
        ]
    except GearpolyError:
        return [np.zeros((scene.samples.size, claim.physics.amplitudes)) for scene in scenes]
    return [np.column_stack(parts) for parts in zip(*changes, strict=True)]


def _allowed(scope: Scope, claim: Claim, amplitude: FloatArray) -> bool:
    """Whether amplitudes lie where the claim's physics can have them; to first order half as much again."""
    bounds = [one.bounds(scope, claim.place) for one in claim.physics.coordinates]
    return all(1.5 * low <= a <= 1.5 * high for (low, high), a in zip(bounds, amplitude.tolist(), strict=False))


def every_place(model: Model) -> Iterator[tuple[Physics, Place]]:
    """Every physics at every place that the recordings' samples can show."""
    return (
        (physics, place)
        for physics in model.method.physics
        for place in physics.places(model.scope)
        if model.scope.shows(place, once=physics.once_per_turn, by_teeth=physics.by_teeth)
    )


def all_places(model: Model) -> Iterator[tuple[Physics, Place]]:
    """Every physics at every place, but for claims that were made."""
    taken = {claim.key for claim in model.claims}
    for physics, place in every_place(model):
        if Claim(physics=physics, place=place, values=()).key not in taken:
            yield physics, place


def scan(
    model: Model, scenes: list[Scene], linear: Linear, *, only: Iterable[tuple[Physics, Place]] | None = None
) -> tuple[list[Candidate], Looked]:
    """All candidates with their gains, best first, and how many places were looked at."""
    everywhere = chain(every_place(model), ((LOAD_WAVE, place) for place in LOAD_WAVE.places(model.scope)))
    asked = list(everywhere if only is None else only)
    rough = _likely_orders(asked, scenes, linear) if only is None else None
    kinds: dict[str, Counter[str]] = {"waves": Counter(), "teeth": Counter(), "whole": Counter()}
    keys: set[tuple[object, ...]] = set()
    taken = {claim.key for claim in model.claims}
    groups: list[list[Claim]] = [[]]
    for physics, place in asked:
        key = Claim(physics=physics, place=place, values=()).key
        kinds["waves" if physics.wavelike else "whole" if place.tooth is None else "teeth"][physics.name] += 1
        keys.add(key)
        if key in taken:
            continue
        # What is slower than half a wave per tooth teeth may have taken, and nothing of it is left to be seen.
        fast = 2 * (place.order or 0) > model.scope.gears[place.gear or 0].z
        if rough is not None and physics.wavelike and fast and place.order not in rough[place.gear or 0]:
            continue
        claim = Claim(physics=physics, place=place, values=(*(0.0,) * physics.amplitudes, *place.shape))
        # A tooth's columns are 0 but where it is in contact: batches of one tooth are weighed there alone.
        if groups[-1]:
            last = groups[-1][-1].place
            one_tooth = last.tooth is not None or place.tooth is not None
            apart = one_tooth and (last.gear, last.tooth) != (place.gear, place.tooth)
            if apart or len(groups[-1]) >= BATCH // 2:
                groups.append([])
        groups[-1].append(claim)
    held = [group for group in groups if group]
    weighed = each(lambda group: _weigh(model, scenes, linear, group, roughly=True), held)
    found = sorted((one for group in weighed for one in group), key=lambda one: -one.gain)
    return found, Looked(**kinds, own=Counter(str(key[0]) for key in keys))


def _likely_orders(
    asked: Sequence[tuple[Physics, Place]], scenes: list[Scene], linear: Linear
) -> tuple[set[int], set[int]]:
    """Orders of the driving and of the driven shaft at which a wave would gain most, all else staying as fitted: of
    those at which anything that is ``asked`` about can be. Even samples show an order at 70 higher ones as well, and
    taken by its gain alone, an undulation of order 88 was the 41st of these."""
    out = []
    for gear in (0, 1):
        gains = np.zeros(HIGHEST_ORDER + 1)
        for scene, noise, white in zip(scenes, linear.noises, linear.system.left, strict=True):
            s = scene.samples
            turns = (s.theta_1 if gear == 0 else s.theta_2) / (2.0 * math.pi)
            sums = FrequencyGrid(turns, step=1.0, count=HIGHEST_ORDER + 1).transform(noise.score(white))
            gains += 2.0 * np.abs(sums) ** 2 / (s.size * _enlarged(noise, turns))
        places = {place.order for physics, place in asked if physics.wavelike and (place.gear or 0) == gear}
        there = [k for k in places if k is not None and k <= HIGHEST_ORDER and gains[k] > FAINT_WAVE]
        out.append(set(sorted(there, key=lambda k: (-gains[k], k))[:LIKELY_ORDERS_PER_SHAFT]))
    return out[0], out[1]


def _enlarged(noise: Noise, turns: FloatArray) -> FloatArray:
    """By how much (``HIGHEST_ORDER`` + 1,) whitening enlarges the power of a wave of every order over samples at
    ``turns`` (n,) of its shaft.

    From each sample to those before it, as they are: beyond half the sampling rate an order is the alias of a slower
    one, and samples that do not come evenly leave it no part of that one's spectrum.
    """
    taps = np.append(1.0, -noise.ar) / noise.innovation
    many = noise.ar.size
    out = np.full(HIGHEST_ORDER + 1, float(taps @ taps))
    for late in range(1, many + 1):
        apart = turns[late:] - turns[:-late]
        alike = FrequencyGrid(apart, step=1.0, count=HIGHEST_ORDER + 1).transform(np.ones(apart.size)).real / apart.size
        out += 2.0 * float(taps[late:] @ taps[: many + 1 - late]) * alike
    return out


def _beside(
    model: Model, scenes: list[Scene], linear: Linear, held: list[Claim]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Score (q,) and information (q, q) per unit of all amplitudes of some claims beside all that is believed, and the
    information (q,) of each alone."""
    one_tooth = held[0].place.tooth is not None
    parts = [_columns(model, scenes, claim) for claim in held]
    sums = []
    for k in range(len(scenes)):
        columns = np.concatenate([mine[k] for mine in parts], axis=1)
        where = np.flatnonzero(np.any(columns != 0.0, axis=1)) if one_tooth else None
        sums.append(linear.sums(k, columns, where=where))
    score, information = linear.system.beside(sums)
    return score, information, sum((np.diag(one.own) for one in sums), np.zeros(score.size))


def _weigh(
    model: Model, scenes: list[Scene], linear: Linear, held: list[Claim], *, roughly: bool = False
) -> list[Candidate]:
    """Claims that are possible as candidates, each beside all that is believed; ``roughly``: what is there or is not
    may be there in part, since at a shape beside the true one it would be too much as a whole."""
    score, information, alone = _beside(model, scenes, linear, held)
    left = np.diag(information)
    out, at = [], 0
    for claim in held:
        q = claim.physics.amplitudes
        index = np.arange(at, at + q)
        at += q
        physics = claim.physics
        known = KNOWN_BEFOREHAND if physics.whole_gear else LEAST_INFORMATION_PART
        if np.any(left[index] <= known * alone[index]) or np.any(alone[index] <= 0.0):
            continue
        gain, amplitude = gain_of(score, information, index[None, :])
        partly = roughly and physics.fixed_amplitudes and bool(np.all(amplitude > 0.0))
        if not (partly or _allowed(model.scope, claim, amplitude[0])):
            continue
        if physics.fixed_amplitudes:
            amplitude = np.ones_like(amplitude)
            if not roughly:
                # Present as it is, not as much of it as fits best.
                gain = np.array([2.0 * score[index].sum() - information[np.ix_(index, index)].sum()])
        values = (*amplitude[0].tolist(), *claim.values[q:])
        out.append(
            Candidate(claim=replace(claim, values=values), gain=float(gain[0]), freedoms=len(physics.coordinates))
        )
    return out


def together(model: Model, scenes: list[Scene], linear: Linear, physics: Physics) -> tuple[float, list[Claim]]:
    """The gain in misfit of a shaped physics claimed of both gears at once, and the two claims, at the shapes of its
    places that gain most; nothing where it cannot be on both."""
    held: list[Claim] = []
    for place in physics.places(model.scope):
        claim = Claim(physics=physics, place=place, values=(*(0.0,) * physics.amplitudes, *place.shape))
        if place.gear is not None and claim.key not in {one.key for one in model.claims}:
            held.append(claim)
    first = [k for k, one in enumerate(held) if one.place.gear == 0]
    second = [k for k, one in enumerate(held) if one.place.gear == 1]
    if not first or not second or physics.amplitudes != 1:
        return 0.0, []
    score, information, _ = _beside(model, scenes, linear, held)
    pairs = np.array([(i, j) for i in first for j in second])
    gain, amplitude = gain_of(score, information, pairs)
    possible = np.array(
        [
            all(_allowed(model.scope, held[k], a) for k, a in zip(pair, one[:, None], strict=True))
            for pair, one in zip(pairs.tolist(), amplitude, strict=True)
        ]
    )
    if not possible.any():
        return 0.0, []
    best = int(np.argmax(np.where(possible, gain, -np.inf)))
    return float(gain[best]), [
        replace(held[k], values=(float(a), *held[k].values[1:]))
        for k, a in zip(pairs[best].tolist(), amplitude[best].tolist(), strict=True)
    ]


def polished(
    model: Model, scenes: list[Scene], linear: Linear, candidate: Candidate, *, roughly: bool = False,
    grown: float = math.inf,
) -> Candidate:  # fmt: skip
    """The candidate at the shape that gains most and makes its size at most ``grown`` times as large; ``roughly``: as
    long as much else may be wrong, such as how far teeth bend, what is there or is not may be there in part."""
    physics, claim = candidate.claim.physics, candidate.claim
    q = physics.amplitudes
    start = np.array(claim.values[q:])
    if not start.size:
        return candidate
    # What was weighed roughly has to prove itself.
    best = replace(candidate, gain=0.0) if physics.fixed_amplitudes and not roughly else candidate
    spread = np.array([8.0 * c.step for c in physics.coordinates[q:]])
    bounds = [one.bounds(model.scope, claim.place) for one in physics.coordinates[q:]]

    def lost(shape: FloatArray) -> float:
        nonlocal best
        if any(not low <= s <= high for (low, high), s in zip(bounds, shape.tolist(), strict=True)):
            return 0.0
        trial = replace(claim, values=(*(0.0,) * q, *shape.tolist()))
        found = _weigh(model, scenes, linear, [trial], roughly=roughly)
        if not found or abs(found[0].claim.values[0]) > grown * abs(claim.values[0]):
            return 0.0
        if found[0].gain > best.gain:
            best = found[0]
        return -found[0].gain

    simplex = np.vstack([start, *(start + np.where(np.arange(start.size) == k, s, 0.0) for k, s in enumerate(spread))])
    minimize(
        lost,
        start,
        method="Nelder-Mead",
        options={"initial_simplex": simplex, "maxfev": EVALUATIONS * start.size, "xatol": 1e-3, "fatol": 0.05},
    )
    return best


def columns_of(model: Model, scenes: list[Scene], linear: Linear, candidate: Candidate) -> list[FloatArray]:
    """Whitened effect (n_k, a) per unit of each amplitude of a candidate at its shape."""
    columns = _columns(model, scenes, candidate.claim)
    return [noise.whitened(c) for noise, c in zip(linear.noises, columns, strict=True)]
