"""The fit of everything that is believed: simulated, linearised there, solved, and again until nothing moves."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from gearpoly.compare.clock import RATE_STD
from gearpoly.compare.noise import Noise
from gearpoly.compare.slow import slow_curves
from gearpoly.diagnose.both_flanks import told
from gearpoly.diagnose.foreign import faded
from gearpoly.diagnose.late import by_clock
from gearpoly.diagnose.left_open import nuisance_of
from gearpoly.diagnose.linear import Linear, linearise, within
from gearpoly.diagnose.model import Model, noises
from gearpoly.diagnose.nuisance import LawModes, Nuisance, law_changes, law_modes
from gearpoly.diagnose.scan import Looked
from gearpoly.diagnose.smoothing import smoothings
from gearpoly.diagnose.way import Way
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim
from gearpoly.scene import Scene
from gearpoly.units import UM, FloatArray

SETTLED_CHANGE_MM = 0.004 * UM
"""mm rms. Changes below this need no further simulation."""

STEADY_NOISE_PART = 0.1
"""Part of the noise level by which the simulation must have moved for the noise to be estimated anew."""

STEP_MOST_SHIFT_PITCHES = 0.01
"""Pitches by which a step moves the zeros at most: the curve's slope is the same no farther."""

STEP_MOST_END_PITCHES = 0.05
"""Pitches by which a step of a clock's rate moves the ends of a recording at most. Of 8 samples per mesh over 225
meshes 0.22 of a pitch was mended in 8 steps; with 0.01 not in 16, and steps of any length ended at the same rate."""

PASSES = 16
"""Most rounds of simulating and fitting again after a change."""

HOPE = 4.0
"""Promises of one step that the steps to come may keep together. Beginnings elsewhere that ended better needed at most
2.4 (printed pairs); of those that did not, the long ones creep with far less."""

BETTER_STATE_GAIN = 10.0
"""Fall in misfit by which another state must be better: more than three standard deviations."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """The ``model`` and everything linear about it; ``step`` tells the user what is done. A ``trial`` does without
    doubt about compliance laws.

    ``largest`` is the largest effect of a claim in mm rms, ``of_teeth`` what laws may leave of claims about single
    teeth, ``deflections`` the mean deflections in mm of every recording. Of the search: ``looked`` says at how many
    places, ``formed`` the gain of the best form of all teeth that a grade leaves open; ``disowned`` counts claims that
    were taken back since they did not end. ``rises``: a linear system, and by how much the misfit (sigmas squared)
    rises from it without a claim, by its key, where all was fitted again without; so no such fit is made twice.

    Every move is a function that returns another fit.
    """

    model: Model
    foreign: list[FloatArray]
    step: Callable[[str], None]
    scenes: list[Scene]
    noises: list[Noise]
    nuisance: Nuisance
    linear: Linear
    laws: LawModes | None
    trial: bool = False
    largest: float = 0.0
    deflections: tuple[float, ...] = ()
    of_teeth: float = 0.0
    looked: Looked = field(default_factory=Looked)
    formed: float = 0.0
    disowned: int = 0
    rises: tuple[Linear, dict[tuple[object, ...], float]] | None = None

    @classmethod
    def begun(
        cls, model: Model, foreign: list[FloatArray], step: Callable[[str], None], *, trial: int | None = None,
        limits_over_usual: float = 1.0,
    ) -> Fit:  # fmt: skip
        """Simulate the declared pair at all samples and fit what is open of it; ``trial``: so many rounds only, and
        without laws, which differ alike wherever the teeth are. Unloaded teeth about which nothing is fitted yet touch
        softly in the first rounds, by their limits over the ``limits_over_usual``.

        Raises ``GeometryError`` and ``OutOfRangeError`` where the pair cannot run under the recordings' conditions.
        """
        soft = () if np.any(model.built) else smoothings(model, limits_over_usual=limits_over_usual)
        passes, widths = PASSES if trial is None else trial, soft
        model = replace(model, smoothing=widths[0] if widths else 0.0)
        scenes = model.scenes()
        laws = law_modes(scenes, law_changes(scenes)) if trial is None else None
        nuisance = nuisance_of(model, scenes, laws)
        first = noises(model, _without_jumps(model, model.residuals(scenes), foreign))
        fit = cls(
            model=model,
            foreign=foreign,
            step=step,
            scenes=scenes,
            noises=first,
            nuisance=nuisance,
            linear=linearise(model, scenes, first, nuisance=nuisance, foreign=foreign),
            laws=laws,
            trial=trial is not None,
        )
        return settled(softly(fit, widths, fresh=True), max(passes - len(widths), 1), fresh=not widths)

    def believing(self, **changes: Any) -> Fit:
        """The same with ``changes`` of what is believed, nothing simulated or fitted anew."""
        return replace(self, model=replace(self.model, **changes))

    @property
    def over(self) -> bool:
        """Whether no more is to be looked for, and what stands is to be told."""
        return self.model.budget.over

    def linearised(self) -> Fit:
        """The same with the linear system of the present state and noise."""
        linear = linearise(self.model, self.scenes, self.noises, nuisance=self.nuisance, foreign=self.foreign)
        return replace(self, linear=linear)

    def present(self) -> FloatArray:
        """The model's state among the parameters (m,); not a number where a parameter is never in the simulation."""
        layout, model = self.linear.layout, self.model
        out = np.full(self.linear.system.size, np.nan)
        out[layout.built] = model.built
        at = layout.nuisance.start
        out[at + self.nuisance.shift] = model.shift
        rates = self.nuisance.rates
        out[at + rates.start : at + rates.stop] = self.nuisance.sigmas(model.rates)
        if self.nuisance.scale is not None:
            # Relative to the present one.
            out[at + self.nuisance.scale] = 0.0
        for claim, part in zip(model.claims, layout.claims, strict=True):
            # Amplitudes count from nothing, shapes from where they are.
            a = claim.physics.amplitudes
            out[part] = (*claim.values[:a], *(0.0,) * (len(claim.values) - a))
        return out

    @cached_property
    def late(self) -> float:
        """What a clock that is off may do in mm rms, where angles were made of time."""
        rates, at = self.nuisance.rates, self.linear.layout.nuisance.start
        doubts = np.sqrt(np.diag(self.linear.system.covariance)[at + rates.start : at + rates.stop])
        return by_clock(self.scenes, self.linear, doubts.tolist())

    @property
    def shift_std(self) -> float:
        """Standard error of the driven zero in rad."""
        at = self.linear.layout.nuisance.start + self.nuisance.shift
        return math.sqrt(float(self.linear.system.covariance[at, at]))

    @property
    def deflection(self) -> float:
        """The largest mean deflection in mm of any recording."""
        return max(self.deflections, default=0.0)


def softly(fit: Fit, widths: Sequence[float], *, fresh: bool = False) -> Fit:
    """Moved once with a smooth maximum of each of these ``widths`` in mm; not simulated with the first touch yet."""
    for width in widths:
        fit = settled(fit.believing(smoothing=width), 1, fresh=fresh and width == widths[0])
    return fit.believing(smoothing=0.0) if widths else fit


def settled(fit: Fit, passes: int = PASSES, *, below: float = math.inf, fresh: bool = False) -> Fit:
    """Simulate, fit, and simulate again until nothing moves, ``passes`` times at most, and once where time is over;
    given up where it will not end with a misfit ``below`` this, by the noise that it began with. ``fresh``: the present
    state is simulated and linearised already. Raises ``GearpolyError`` where gears cannot run as they are believed."""
    begun_by = fit.noises
    way, moved, good = Way(), math.inf, fit
    for turn in range(passes):
        if turn and fit.over:
            break
        if turn or not fresh:
            try:
                scenes = fit.model.scenes()
            except GearpolyError:
                # A step to gears that cannot run went too far; those that it began from could.
                if turn == 0:
                    raise
                fit = good
                if not way.again():
                    break
                fit, moved = _gone_on(fit, way.step)
                continue
            fit = _linearised_about(fit, scenes, begins=turn == 0)
        if way.overshot(fit.linear.system, fit.present()):
            fit = good
            if not way.again():
                break
            fit, moved = _gone_on(fit, way.step)
            continue
        if moved > STEADY_NOISE_PART * min(noise.level for noise in fit.noises):
            heard = noises(fit.model, fit.linear.left())
            fit = replace(fit, noises=heard, linear=fit.linear.under(heard))
        way.go(fit.linear.system, fit.present())
        # By the noise of before only where it decides: whitening anew is a third of a step.
        hoped = HOPE * way.fall
        if way.misfit - hoped > below and fit.linear.under(begun_by).system.misfit - hoped > below:
            return fit
        good = fit
        fit, moved = _gone_on(fit, way.step)
        if moved < SETTLED_CHANGE_MM or way.rests:
            break
    return measured(fit)


def _linearised_about(fit: Fit, scenes: list[Scene], *, begins: bool) -> Fit:
    """Linearised about ``scenes`` that are new; where a fit ``begins``, other things may be open than before."""
    laws = fit.laws
    if begins:
        if laws is None and not fit.trial:
            # Teeth may have begun to bend.
            laws = law_modes(scenes, law_changes(scenes))
        nuisance = nuisance_of(fit.model, scenes, laws)
    else:
        # Teeth and reliefs have changed, and the slope of the curve with them.
        nuisance = fit.nuisance.sloping(scenes)
    return replace(fit, scenes=scenes, laws=laws, nuisance=nuisance).linearised()


def joined(fit: Fit, claims: Sequence[Claim], *, instead: Sequence[int] = ()) -> Fit:
    """With ``claims``, in the place of the claims of the numbers ``instead``, and everything that was fitted without
    them giving way to them, to first order.

    Teeth as built take of an unknown physics what they can. Claimed on top of that it would count twice, so far from
    rest that unloaded teeth may touch elsewhere, and the fit end in another valley.
    """
    model, present = fit.model, fit.present()
    layout, leave, others = fit.linear.layout, [], model
    for k in instead:
        leave += layout.places(k) + layout.form_places(model, k)
        others = others.but(model.claims[k])
    keep = np.setdiff1d(np.arange(present.size), np.asarray(leave, dtype=np.int64))
    system = fit.linear.system.without(leave)
    taken = np.zeros(keep.size)
    for claim in claims:
        effect = others.change(fit.scenes, claim, claim.values)
        for a, noise, one in zip(system.white, fit.noises, effect, strict=True):
            taken += a.T @ noise.whitened(one[:, None])[:, 0]
    step = np.zeros(present.size)
    step[keep] = system.solution - system.solved(taken) - present[keep]
    there, _ = _gone_on(fit, np.where(np.isnan(present), 0.0, step))
    rest = [one for k, one in enumerate(there.model.claims) if k not in instead]
    at = min(instead, default=len(rest))
    return there.believing(claims=(*rest[:at], *claims, *rest[at:]))


def better_of(fit: Fit, change: Callable[[Fit], Fit], *, better: float) -> Fit:
    """What a ``change`` makes of a fit where that leaves less misfit by more than ``better``, by the noise of before;
    else the ``fit`` itself, and where gears cannot run so: nobody asked for those."""
    try:
        other = change(fit)
    except GearpolyError:
        return fit
    worse = other.linear.under(fit.noises).system.misfit > fit.linear.system.misfit - better
    return fit if worse else other


def shared(fit: Fit) -> Fit:
    """With both flanks of graded gears sharing what the recordings say they do."""
    made = told(fit.model, fit.scenes, fit.linear)
    if made is fit.model.as_built:
        return fit
    return better_of(fit, lambda one: settled(one.believing(as_built=made)), better=-math.inf)


def forgotten(fit: Fit) -> Fit:
    """Without those waves of unknown make that are now explained: they tell nothing any more, and where two of them are
    nearly one, half of a recording says any size of both."""
    waves = fit.model.strangers
    gone = {waves[k] for k in faded(fit.linear.system, waves, fit.linear.layout.foreign)}
    return without_waves(fit, gone).linearised() if gone else fit


def without_waves(fit: Fit, gone: Collection[tuple[int, ...]]) -> Fit:
    """Without these waves of no cause, each by its foreign columns; not linear anew yet."""
    columns = sorted(column for wave in gone for column in wave)
    stay = [wave for wave in fit.model.strangers if wave not in gone]
    strangers = tuple(tuple(c - bisect_left(columns, c) for c in wave) for wave in stay)
    foreign = [np.delete(one, columns, axis=1) for one in fit.foreign]
    return replace(fit.believing(strangers=strangers), foreign=foreign)


def _gone_on(fit: Fit, step: FloatArray) -> tuple[Fit, float]:
    """A ``step`` (m,) further on, and the largest rms change in mm of a simulated recording."""
    layout, model = fit.linear.layout, fit.model
    old = fit.present()
    inside = ~np.isnan(old)
    old[~inside] = 0.0
    x = old + step
    at = layout.nuisance.start
    shift, most = at + fit.nuisance.shift, STEP_MOST_SHIFT_PITCHES * model.scope.gears[1].tau
    x[shift] = old[shift] + np.clip(step[shift], -most, most)
    rates = slice(at + fit.nuisance.rates.start, at + fit.nuisance.rates.stop)
    for k, one in zip(range(rates.start, rates.stop), model.observed, strict=False):
        far = RATE_STD * float(np.max(np.abs(one.samples.theta_2 - one.samples.middle)))
        ends = STEP_MOST_END_PITCHES * model.scope.gears[1].tau / far
        x[k] = old[k] + np.clip(step[k], -ends, ends)
    scale = model.scale
    if fit.nuisance.scale is not None:
        scale = float(np.clip(scale * (1.0 + x[at + fit.nuisance.scale]), 0.2, 5.0))
    claims = []
    for claim, part in zip(model.claims, layout.claims, strict=True):
        values = within(claim, np.array(claim.values) + x[part] - old[part], model.scope)
        x[part] = old[part] + np.array(values) - np.array(claim.values)
        claims.append(replace(claim, values=values))
    # What an encoder misreads and a scale are taken by other ways than the simulation, but count alike.
    gone = np.where(inside, x - old, 0.0)
    moved = max(float(np.std(columns @ gone)) for columns in fit.linear.columns)
    built = x[layout.built].copy()
    moves = {"shift": float(x[shift]), "rates": tuple((RATE_STD * x[rates]).tolist())}
    return fit.believing(built=built, scale=scale, claims=tuple(claims), **moves), moved


def measured(fit: Fit) -> Fit:
    """With what candidates are compared with measured once: the largest effect of a claim, what laws may leave of
    claims about single teeth, and the mean deflections."""
    largest = of_teeth = 0.0
    for claim in fit.model.claims:
        if not claim.physics.measures:
            change = fit.model.change(fit.scenes, claim, claim.values, but=claim)
            size = max(float(np.std(c)) for c in change)
            largest = max(largest, size)
            if not claim.physics.mean_tooth:
                of_teeth = max(of_teeth, claim.physics.law_doubt * size)
    deflections = tuple(
        abs(float(np.mean(scene.bending(None) - scene.te))) if scene.bends else 0.0 for scene in fit.scenes
    )
    return replace(fit, largest=largest, of_teeth=of_teeth, deflections=deflections)


def _without_jumps(model: Model, residuals: list[FloatArray], foreign: list[FloatArray]) -> list[FloatArray]:
    """The ``residuals`` (n_k,) in mm less the ``foreign`` waves and jumps (n_k, q), of recordings that jump, as they
    fit beside a slow course: noise that was estimated with slips of 60 um in it wanders by as much, and hides them."""
    out = []
    for one, rest, columns in zip(model.observed, residuals, foreign, strict=True):
        if one.jumps and columns.shape[1]:
            beside = np.concatenate([columns, slow_curves(one.samples.theta_2)], axis=1)
            heights = np.linalg.lstsq(beside, rest, rcond=None)[0][: columns.shape[1]]
            rest = rest - columns @ heights
        out.append(rest)
    return out


def number_of(search: Fit, claim: Claim) -> int:
    """Number of a claim among those that stand, by its key: its values move with every step of the fit."""
    return next(k for k, one in enumerate(search.model.claims) if one.key == claim.key)
