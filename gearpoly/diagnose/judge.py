"""How probable a claim is beside all that could stand in its place: its look-alikes, and what has no cause."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.diagnose.conditions import with_and_without
from gearpoly.diagnose.contest import Key, Refitted
from gearpoly.diagnose.linear import Linear, derivatives
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.scan import Candidate, polished, scan
from gearpoly.diagnose.system import System
from gearpoly.infer.posterior import Explanation, Posterior, Sized, weighed
from gearpoly.infer.prior import FORM, order_of, same_place, unknown_share
from gearpoly.infer.unknown import mesh_harmonics, mesh_std, rms, tooth_hats, unknowns
from gearpoly.physics.base import Claim, Physics, Place
from gearpoly.physics.scene import Scene
from gearpoly.units import FloatArray

POSSIBLE = 0.5
"""Part of a claim's gain that a rival must reach by its coarse shapes to be looked at closely."""

TWIN = 0.25
"""The same for a damage of the mate's tooth, whose coarse shapes are laid elsewhere than those of the claim: where two
teeth always meet, either has it."""

LOOKED_AT = 12
"""Rivals that are looked at closely."""

KNOTS = 12
"""Places along a tooth's contact between which its form may differ from what a physics draws."""


@dataclass(frozen=True, kw_only=True)
class Judged:
    """A claim with its ``gain`` in misfit and the probabilities at its place."""

    gain: float
    posterior: Posterior


@dataclass(frozen=True, kw_only=True, eq=False)
class _Trial:
    """What explanations of one place are weighed with: the state ``others`` without the claim there, ``scenes`` of the
    state with it, the ``linear`` fit, and the ``plain`` system without the claim."""

    others: Model
    scenes: list[Scene]
    linear: Linear
    plain: System
    heat: float

    def white(self, columns: Sequence[FloatArray]) -> list[FloatArray]:
        """Columns (n_k, q) in mm made white."""
        return [noise.whitened(one) for noise, one in zip(self.linear.noises, columns, strict=True)]

    def log_evidence(self, sized: Sized) -> float:
        """Log evidence of columns over that of nothing."""
        return sized.log_evidence(self.plain.scores, heat=self.heat)

    def sized(self, claim: Claim, columns: Sequence[FloatArray], effect: Sequence[FloatArray]) -> Sized:
        """A claim by its derivatives (n_k, q) in mm, the size's first, with the doubt about its form: a part of its
        ``effect`` (n_k,)."""
        physics, scope = claim.physics, self.others.scope
        a = physics.amplitudes
        std = [*amplitude_std(physics), *(_shape_std(claim, k, scope) for k in range(a, columns[0].shape[1]))]
        bounds = (-math.inf, math.inf)
        if a == 1 and not physics.fixed_amplitudes:
            bounds = physics.coordinates[0].bounds(scope, claim.place)
        parts = list(columns)
        form, loose = self._form(claim, effect)
        if loose.size:
            parts = [np.concatenate((mine, more), axis=1) for mine, more in zip(parts, form, strict=True)]
            std += loose.tolist()
        scaled = 0 if physics.fixed_amplitudes else a
        return Sized(columns=self.white(parts), std=np.array(std), scaled=scaled, bounds=bounds)

    def _form(self, claim: Claim, effect: Sequence[FloatArray]) -> tuple[list[FloatArray], FloatArray]:
        """Columns (n_k, q) in mm of the form that a claim leaves open, and standard deviations (q,): of a tooth along
        its contact, of all teeth along the mesh."""
        place, physics = claim.place, claim.physics
        most = FORM * max(float(np.max(np.abs(one))) for one in effect)
        if place.tooth is not None:
            hats = [tooth_hats(scene, place.gear or 0, place.tooth, knots=KNOTS) for scene in self.scenes]
            return hats, np.full(KNOTS, most)
        if not physics.mean_tooth:
            return [], np.zeros(0)
        mean = math.sqrt(sum(float(np.sum((e - np.mean(e)) ** 2)) for e in effect) / sum(e.size for e in effect))
        curves = [mesh_harmonics(scene) for scene in self.scenes]
        std = mesh_std()
        return curves, std * FORM * mean / rms(curves, std)


def amplitude_std(physics: Physics) -> list[float]:
    """Standard deviation of each amplitude, in its unit, of an ordinary fault."""
    size = math.sqrt(sum(one**2 for one in physics.ordinary) / physics.amplitudes)
    return [size] * physics.amplitudes


def _shape_std(claim: Claim, k: int, scope: object) -> float:
    """Standard deviation of a coordinate of shape: of one that is even between its bounds."""
    low, high = claim.physics.coordinates[k].bounds(scope, claim.place)  # type: ignore[arg-type]
    return (high - low) / math.sqrt(12.0)


def judge(
    model: Model, scenes: list[Scene], linear: Linear, k: int, *, refitted: Sequence[Refitted] = (), places: int = 1
) -> Judged:
    """Weigh claim ``k`` against everything that could stand in its place, all else fitted again; ``places``: how many
    of its kind were looked at."""
    claim = model.claims[k]
    plain, wider = with_and_without(model, scenes, linear, k)
    bare = linear.without(linear.layout.places(k) + linear.layout.form_places(model, k))
    gain = bare.system.misfit - bare.system.with_columns(linear.white_of(k)).misfit
    trial = _Trial(
        others=model.but(claim), scenes=scenes, linear=linear, plain=plain, heat=max(1.0, linear.system.whiteness)
    )
    effect = model.change(scenes, claim, claim.values, but=claim)
    mine = trial.log_evidence(_standing(trial, claim, linear, k, wider, effect))
    found: dict[Key, tuple[Claim, float]] = {claim.key: (claim, mine)}
    for refit in refitted:
        # Fitted to its end it may do better than to first order about another.
        found[refit.claim.key] = (refit.claim, mine - 0.5 * max(0.0, refit.behind) / trial.heat)
    for one in _look_alikes(trial, bare, claim, gain, found):
        columns = derivatives(trial.others, scenes, one.claim)
        there = trial.others.change(scenes, one.claim, one.claim.values)
        log = trial.log_evidence(trial.sized(one.claim, columns, there))
        best = found.get(one.claim.key)
        if best is None or log > best[1]:
            found[one.claim.key] = (one.claim, log)
    places_of = (Claim(physics=physics, place=place, values=()) for physics, place in _possible(model, claim))
    possible = {(one.physics.name, one.place.gear) for one in (claim, *places_of) if same_place(one, claim)}
    explanations = [Explanation(claim=one, log_evidence=log, weight=1.0 / len(possible)) for one, log in found.values()]
    size = _ordinary_rms(trial, claim, effect, linear.columns, linear.layout.claims[k])
    for unknown in unknowns(claim, scenes, order=order_of(claim)):
        usual = rms(unknown.columns, unknown.std)
        if usual <= 0.0:
            continue
        sized = Sized(columns=trial.white(unknown.columns), std=unknown.std * (size / usual), scaled=unknown.std.size)
        explanations.append(Explanation(claim=None, log_evidence=trial.log_evidence(sized), weight=unknown.weight))
    share = unknown_share(claim, model.scope)
    return Judged(gain=gain, posterior=weighed(explanations, unknown_share=share, places=places))


def _standing(
    trial: _Trial, claim: Claim, linear: Linear, k: int, wider: System, effect: Sequence[FloatArray]
) -> Sized:
    """The claim that stands, by all that it does where that is simulated."""
    columns = [one[:, linear.layout.claims[k]] for one in linear.columns]
    sized = trial.sized(claim, columns, effect)
    if not claim.simulated:
        return sized
    unit = abs(claim.values[0]) or 1.0
    whole = [a[:, -1:] for a in wider.white]
    std = sized.std.copy()
    std[0] /= unit
    low, high = (one / claim.values[0] if claim.values[0] else one for one in sized.bounds)
    return replace(
        sized,
        columns=[np.concatenate((one, mine[:, 1:]), axis=1) for one, mine in zip(whole, sized.columns, strict=True)],
        std=std,
        bounds=(min(low, high), max(low, high)),
    )


def _ordinary_rms(
    trial: _Trial, claim: Claim, effect: Sequence[FloatArray], columns: Sequence[FloatArray], mine: slice
) -> float:
    """Rms in mm that an ordinary fault of a claim's kind has at its place, mean taken off where only the course is
    told."""
    physics = claim.physics
    if physics.fixed_amplitudes:
        return rms([one[:, None] for one in effect], np.ones(1))
    own = [one[:, mine][:, : physics.amplitudes] for one in columns]
    if physics.mean_tooth:
        own = [one - np.mean(one, axis=0) for one in own]
    return rms(own, np.array(amplitude_std(physics)))


def _look_alikes(
    trial: _Trial, bare: Linear, claim: Claim, gain: float, found: Mapping[Key, tuple[Claim, float]]
) -> Iterator[Candidate]:
    """Claims that may stand in another's place as far as their coarse shapes tell, at the shapes that gain most."""
    others, scenes = trial.others, trial.scenes
    candidates, _ = scan(others, scenes, bare, only=_possible(others, claim))

    def possible(one: Candidate) -> bool:
        twin = one.claim.physics is claim.physics and claim.physics.shaped and one.claim.place.gear != claim.place.gear
        return one.gain > (TWIN if twin and claim.place.tooth is not None else POSSIBLE) * gain

    seen = {claim.key}
    for one in [c for c in candidates if possible(c)][: 4 * LOOKED_AT]:
        if one.claim.key in seen or len(seen) > LOOKED_AT:
            continue
        seen.add(one.claim.key)
        yield polished(others, scenes, bare, one)


def _possible(model: Model, claim: Claim) -> Iterator[tuple[Physics, Place]]:
    """Places at which something like the claim could be: another tooth is never mistaken for a wave, nor order 61 for
    order 12."""
    taken = {one.key for one in model.claims if one is not claim}
    for physics in model.method.physics:
        for place in filter(
            model.scope.shows, (*physics.places(model.scope), *physics.instead(model.scope, claim.place))
        ):
            key = Claim(physics=physics, place=place, values=()).key
            if key in taken or key == claim.key:
                continue
            if physics.wavelike and not _same_wave(model, place, claim.place):
                continue
            tooth, mine = place.tooth is not None, claim.place.tooth is not None
            if tooth and not mine:
                continue
            yield physics, place


def _same_wave(model: Model, one: Place, other: Place) -> bool:
    """Whether waves on either shaft have the same frequency, or on one shaft the same order."""
    z = [gear.z for gear in model.scope.gears]
    if one.order is None or other.order is None or one.gear is None or other.gear is None:
        return False
    return one.order * z[other.gear] == other.order * z[one.gear]
