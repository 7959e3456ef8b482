"""The bench on which explanations of one place are weighed: all that is believed of other places, and the noise."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.diagnose.linear import CLAIMED_TOOTH_KNOTS, Linear, derivatives
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.system import System
from gearpoly.diagnose.teeth_scale import of_pitches
from gearpoly.errors import GearpolyError
from gearpoly.infer.evidence import log_mean
from gearpoly.infer.posterior import Explanation, Sized
from gearpoly.infer.prior import FORM, order_of, twist
from gearpoly.infer.unknown import mesh_harmonics, mesh_std, rms, tooth_hats, unknowns
from gearpoly.physics.base import Claim, Scope
from gearpoly.scene import Scene
from gearpoly.units import FloatArray

POSSIBLE = 0.5
"""Part of a claim's gain that a rival must reach by its coarse shapes to be looked at closely."""

SAME_WAVE_POWER_PART = 0.3
"""Part of a located wave's power, from 0 to 1, that the waves of a place hold, from which on it is there: two waves
half a line apart share two fifths (sinc squared), a whole line apart nothing. A judgement, not tuned."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Unexplained:
    """White columns without a cause, and the ``weight`` that they have among those of their place; ``drawn`` (n_k, q)
    in mm, None where they are in the fit already. ``wider``: they reach beyond the place."""

    sized: Sized
    weight: float
    drawn: list[FloatArray] | None = None
    wider: bool = False


def drawn_of(model: Model, scenes: list[Scene], claim: Claim) -> tuple[list[FloatArray], list[FloatArray]] | None:
    """Derivatives (n_k, q) and effect (n_k,) in mm of a claim beside the state of a ``model``; None where gears cannot
    run with it, as teeth that bend too far."""
    try:
        return derivatives(model, scenes, claim), model.change(scenes, claim, claim.values)
    except GearpolyError:
        return None


@dataclass(frozen=True, kw_only=True, eq=False)
class Trial:
    """What explanations of one place are weighed with: the state ``others`` without the claim there, ``scenes`` of the
    state with it, the ``linear`` fit, and the ``plain`` system without the claim and without
    the parameters ``dropped``, which are waves that were located at its place."""

    others: Model
    scenes: list[Scene]
    linear: Linear
    plain: System
    dispersion: float
    dropped: tuple[int, ...] = ()

    def white(self, columns: Sequence[FloatArray]) -> list[FloatArray]:
        """Columns (n_k, q) in mm made white."""
        return [noise.whitened(one) for noise, one in zip(self.linear.noises, columns, strict=True)]

    def log_evidence(self, sized: Sized) -> float:
        """Log evidence of columns over that of nothing."""
        return sized.log_evidence(self.plain.scores, dispersion=self.dispersion)

    def of(self, claim: Claim) -> float:
        """Log evidence of a claim that is not in the state, to first order about its values; none at all where gears
        cannot run with it."""
        drawn = drawn_of(self.others, self.scenes, claim)
        return -math.inf if drawn is None else self.of_drawn(claim, *drawn)

    def of_drawn(self, claim: Claim, columns: Sequence[FloatArray], effect: Sequence[FloatArray]) -> float:
        """The same of a claim by its derivatives (n_k, q) in mm and what it changes (n_k,)."""
        return self.either_form(self.sized(claim, columns, effect, loose=loose) for loose in (False, True))

    def either_form(self, ways: Iterable[Sized]) -> float:
        """Log evidence of a claim whose form may be as it is drawn, or another in some part: either is as likely."""
        logs = [self.log_evidence(one) for one in ways]
        return log_mean(logs, weights=np.full(len(logs), 1.0 / len(logs)))

    def at(self, claim: Claim, *, size: float, effect: Sequence[FloatArray]) -> tuple[Trial, list[Unexplained]]:
        """This trial at the place of a claim with this ``effect`` (n_k,) in mm, of which an ordinary one has the rms
        ``size`` in mm, and the explanations without a cause there.

        A wave that was located there and that nobody had named is one of them, and stands beside no other. One that was
        located at a harmonic stands beside all: else an unknown cause that is thought to make both would explain it,
        and every named one leave it. Where a torque pulses at that order, what shafts give to it is as large as that.
        """
        size = twist(claim, self.others.scope) or size
        found = []
        for one in unknowns(claim, self.scenes, order=order_of(claim), effect=effect):
            usual = rms(one.columns, one.std)
            if usual > 0.0:
                sized = Sized(columns=self.white(one.columns), std=one.std * (size / usual), scaled=one.std.size)
                found.append(Unexplained(sized=sized, weight=one.weight, drawn=one.columns, wider=one.wider))
        start, taken = self.linear.layout.foreign.start, []
        here = [one for one in found if not one.wider]
        for wave in self.others.strangers:
            columns = [start + column for column in wave]
            mine = [white.part(columns) for white in self.plain.white]
            if max((held_by(mine, one.sized.columns) for one in here), default=0.0) > SAME_WAVE_POWER_PART:
                taken += columns
                std = np.full(len(columns), math.sqrt(2.0 / len(columns)) * size)
                found.append(Unexplained(sized=Sized(columns=mine, std=std, scaled=std.size), weight=1.0))
        whole = sum(one.weight for one in found)
        even = [replace(one, weight=one.weight / whole) for one in found]
        return replace(self, plain=self.plain.without(taken), dropped=(*self.dropped, *taken)), even

    def explanations(self, found: Sequence[Unexplained]) -> list[Explanation]:
        """The explanations without a cause, each weighed."""
        return [Explanation(claim=None, log_evidence=self.log_evidence(one.sized), weight=one.weight) for one in found]

    def sized(self, claim: Claim, columns: Sequence[FloatArray], effect: Sequence[FloatArray], *, loose: bool) -> Sized:
        """A claim by its derivatives (n_k, q) in mm, the size's first; ``loose``: with the doubt about its form, a part
        of its ``effect`` (n_k,)."""
        physics, scope = claim.physics, self.others.scope
        std = claim_std(self.others, claim)
        bounds = (-math.inf, math.inf)
        if scaled_of(claim) == 1:
            bounds = physics.coordinates[0].bounds(scope, claim.place)
        parts = list(columns)
        form, sizes = self._form(claim, effect)
        if loose and sizes.size:
            parts = [np.concatenate((mine, more), axis=1) for mine, more in zip(parts, form, strict=True)]
            std += sizes.tolist()
        return Sized(columns=self.white(parts), std=np.array(std), scaled=scaled_of(claim), bounds=bounds)

    def _form(self, claim: Claim, effect: Sequence[FloatArray]) -> tuple[list[FloatArray], FloatArray]:
        """Columns (n_k, q) in mm of the form that a claim leaves open, and standard deviations (q,): of a tooth along
        its contact, of all teeth along the mesh."""
        place, physics = claim.place, claim.physics
        most = FORM * max(float(np.max(np.abs(one))) for one in effect)
        if place.tooth is not None:
            hats = [tooth_hats(scene, place.gear or 0, place.tooth, knots=CLAIMED_TOOTH_KNOTS) for scene in self.scenes]
            return hats, np.full(CLAIMED_TOOTH_KNOTS, most)
        if not physics.mean_tooth:
            return [], np.zeros(0)
        mean = math.sqrt(sum(float(np.sum((e - np.mean(e)) ** 2)) for e in effect) / sum(e.size for e in effect))
        curves = [mesh_harmonics(scene) for scene in self.scenes]
        std = mesh_std()
        return curves, std * FORM * mean / rms(curves, std)


def amplitude_std(model: Model, claim: Claim) -> list[float]:
    """Standard deviation of each amplitude, in its unit, of an ordinary fault of a claim's kind: of pitches at least
    what the limits of their gear allow a single one, since a fault is what stands out of the teeth of its gear. Of
    printed teeth of 8 um one was off by 63 um: beside the 4 um of a ground gear that is a fault that hardly comes."""
    physics = claim.physics
    size = math.sqrt(sum(one**2 for one in physics.ordinary) / physics.amplitudes)
    if of_pitches(model, claim):
        size = max(size, model.as_built.gears[claim.place.gear or 0].single)
    return [size] * physics.amplitudes


def shape_std(claim: Claim, k: int, scope: Scope) -> float:
    """Standard deviation of a coordinate of shape: of one that is even between its bounds."""
    low, high = claim.physics.coordinates[k].bounds(scope, claim.place)
    return (high - low) / math.sqrt(12.0)


def claim_std(model: Model, claim: Claim) -> list[float]:
    """Standard deviation beforehand of each value of a claim, in its unit."""
    shapes = range(claim.physics.amplitudes, len(claim.values))
    return [*amplitude_std(model, claim), *(shape_std(claim, k, model.scope) for k in shapes)]


def scaled_of(claim: Claim) -> int:
    """How many values of a claim, the first of them, have sizes that nobody knows to a power of two."""
    return 0 if claim.physics.fixed_amplitudes else claim.physics.amplitudes


def ordinary_rms(model: Model, claim: Claim, columns: Sequence[FloatArray], effect: Sequence[FloatArray]) -> float:
    """Rms in mm that an ordinary fault of a claim's kind has at its place, by its derivatives (n_k, q), or by its whole
    ``effect`` (n_k,) if it is there or is not; the mean taken off where only the course is told."""
    physics = claim.physics
    if physics.fixed_amplitudes:
        return rms([one[:, None] for one in effect], np.ones(1))
    own = [one[:, : physics.amplitudes] for one in columns]
    if physics.mean_tooth:
        own = [one - np.mean(one, axis=0) for one in own]
    return rms(own, np.array(amplitude_std(model, claim)))


def held_by(columns: Sequence[FloatArray], others: Sequence[FloatArray]) -> float:
    """Part of the power of white columns (n_k, q) that others (n_k, p) hold."""
    mine, theirs = np.concatenate(list(columns)), np.concatenate(list(others))
    power = float(np.sum(mine**2))
    if power <= 0.0:
        return 0.0
    left = mine - theirs @ np.linalg.lstsq(theirs, mine)[0]
    return 1.0 - float(np.sum(left**2)) / power
