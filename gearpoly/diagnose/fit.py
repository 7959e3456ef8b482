"""The fit of everything that is believed: simulated, linearised there, solved, and again until nothing moves."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from gearpoly.compare.noise import Noise
from gearpoly.compare.slow import slow_curves
from gearpoly.diagnose.both_flanks import told
from gearpoly.diagnose.foreign import faded
from gearpoly.diagnose.kept import Kept
from gearpoly.diagnose.left_open import nuisance_of
from gearpoly.diagnose.linear import Linear, linearise, within
from gearpoly.diagnose.model import Model, noises
from gearpoly.diagnose.nuisance import LawModes, Nuisance, law_changes, law_modes
from gearpoly.diagnose.way import Way
from gearpoly.errors import GearpolyError
from gearpoly.physics.base import Claim
from gearpoly.scene import Scene
from gearpoly.units import UM, FloatArray

CLEARLY = 30.0
"""Gain in misfit by which another compliance law must fit better than the present one to take its place."""

SETTLED = 0.004 * UM
"""mm rms. Changes below this need no further simulation."""

STEADY = 0.1
"""Part of the noise level by which the simulation must have moved for the noise to be estimated anew."""

MOST_SHIFT = 0.01
"""Pitches by which a step moves the zeros at most: the curve's slope is the same no farther."""

PASSES = 16
"""Most rounds of simulating and fitting again after a change."""

HOPE = 4.0
"""Promises of one step that the steps to come may keep together. Beginnings elsewhere that ended better needed at most
2.4 (printed pairs); of those that did not, the long ones creep with far less."""

BETTER = 10.0
"""Fall in misfit by which another state must be better: more than three standard deviations."""


@dataclass(kw_only=True, eq=False)
class Fit:
    """The ``model`` and everything linear about it; ``step`` tells the user what is done. A ``trial`` does without
    doubt about compliance laws."""

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

    @classmethod
    def begun(
        cls, model: Model, foreign: list[FloatArray], step: Callable[[str], None], *, trial: int | None = None
    ) -> Self:
        """Simulate the declared pair at all samples and fit what is open of it; ``trial``: so many rounds only, and
        without laws, which differ alike wherever the teeth are.

        Raises ``GeometryError`` and ``OutOfRangeError`` where the pair cannot run under the recordings' conditions.
        """
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
        fit.settle(PASSES if trial is None else trial, fresh=True)
        return fit

    @property
    def over(self) -> bool:
        """Whether no more is to be looked for, and what stands is to be told."""
        return self.model.budget.over

    def settle(self, passes: int = PASSES, *, below: float = math.inf, fresh: bool = False) -> None:
        """Simulate, fit, and simulate again until nothing moves, ``passes`` times at most, and once where time is
        over; given up where it will not end with a misfit ``below`` this, by the noise that it began with. ``fresh``:
        the present state is simulated and linearised already."""
        begun_by = self.noises
        way, moved, good = Way(), math.inf, self.kept()
        for turn in range(passes):
            if turn and self.over:
                break
            if turn or not fresh:
                try:
                    self.scenes = self.model.scenes()
                except GearpolyError:
                    # A step to gears that cannot run went too far; those that it began from could.
                    if turn == 0:
                        raise
                    self.restore(good)
                    if not way.again():
                        break
                    moved = self.take(self.linear, way.step)
                    continue
                self._linearise(begins=turn == 0)
            if way.overshot(self.linear.system, self.present()):
                self.restore(good)
                if not way.again():
                    break
                moved = self.take(self.linear, way.step)
                continue
            if moved > STEADY * min(noise.level for noise in self.noises):
                self.noises = noises(self.model, self.linear.left())
                self.linear = self.linear.under(self.noises)
            way.go(self.linear.system, self.present())
            # By the noise of before only where it decides: whitening anew is a third of a step.
            hoped = HOPE * way.fall
            if way.misfit - hoped > below and self.linear.under(begun_by).system.misfit - hoped > below:
                return
            good = self.kept()
            moved = self.take(self.linear, way.step)
            if moved < SETTLED or way.rests:
                break
        self.measure()

    def _linearise(self, *, begins: bool) -> None:
        """Linearise about scenes that are new; where a fit ``begins``, other things may be open than before."""
        if begins:
            if self.laws is None and not self.trial:
                # Teeth may have begun to bend.
                self.laws = law_modes(self.scenes, law_changes(self.scenes))
            self.nuisance = nuisance_of(self.model, self.scenes, self.laws)
        else:
            # Teeth and reliefs have changed, and the slope of the curve with them.
            self.nuisance = self.nuisance.sloping(self.scenes)
        self.linear = self.linearised()

    def join(self, claims: Sequence[Claim], *, instead: Sequence[int] = ()) -> None:
        """Make ``claims``, in the place of the claims of the numbers ``instead``, and let everything that was fitted
        without them give way to them, to first order.

        Teeth as built take of an unknown physics what they can. Claimed on top of that it would count twice, so far
        from rest that unloaded teeth may touch elsewhere, and the fit end in another valley.
        """
        model, present = self.model, self.present()
        layout, leave, others = self.linear.layout, [], model
        for k in instead:
            leave += layout.places(k) + layout.form_places(model, k)
            others = others.but(model.claims[k])
        keep = np.setdiff1d(np.arange(present.size), np.asarray(leave, dtype=np.int64))
        system = self.linear.system.without(leave)
        taken = np.zeros(keep.size)
        for claim in claims:
            effect = others.change(self.scenes, claim, claim.values)
            for a, noise, one in zip(system.white, self.noises, effect, strict=True):
                taken += a.T @ noise.whitened(one[:, None])[:, 0]
        step = np.zeros(present.size)
        step[keep] = system.solution - system.solved(taken) - present[keep]
        self.take(self.linear, np.where(np.isnan(present), 0.0, step))
        rest = [one for k, one in enumerate(model.claims) if k not in instead]
        at = min(instead, default=len(rest))
        model.claims = [*rest[:at], *claims, *rest[at:]]

    def tried(self, change: Callable[[], None], *, better: float) -> bool:
        """Whether a ``change`` of the state, all fitted again, leaves less misfit by more than ``better``, by the noise
        of before. The state comes back where it does not, and where gears cannot run so: nobody asked for those."""
        before, there = self.kept(), self.linear.system.misfit
        try:
            change()
        except GearpolyError:
            self.restore(before)
            return False
        if self.linear.under(before[1]["noises"]).system.misfit > there - better:
            self.restore(before)
            return False
        return True

    def share(self) -> None:
        """Let both flanks of graded gears share what the recordings say they do."""
        made = told(self.model, self.scenes, self.linear)

        def shared() -> None:
            self.model.as_built = made
            self.settle()

        if made is not self.model.as_built:
            self.tried(shared, better=-math.inf)

    def forget(self) -> None:
        """Let go of waves of unknown make that are now explained: they tell nothing any more, and where two of them are
        nearly one, half of a recording says any size of both."""
        waves = self.model.strangers
        gone = {waves[k] for k in faded(self.linear.system, waves, self.linear.layout.foreign)}
        if not gone:
            return
        columns = sorted(column for wave in gone for column in wave)
        self.foreign = [np.delete(one, columns, axis=1) for one in self.foreign]
        stay = [wave for wave in waves if wave not in gone]
        self.model.strangers = tuple(tuple(c - bisect_left(columns, c) for c in wave) for wave in stay)
        self.linear = self.linearised()

    def kept(self) -> Kept:
        """What ``restore`` needs to come back to this state: nothing is changed in place."""
        names = ("foreign", "scenes", "noises", "nuisance", "linear", "laws", "largest", "deflections", "of_teeth")
        return self.model.kept(), {name: getattr(self, name) for name in names}

    def restore(self, kept: Kept) -> None:
        """Come back to a state; what it was kept without is made anew."""
        self.model.restore(kept[0])
        for name, value in kept[1].items():
            setattr(self, name, value)
        if "linear" not in kept[1]:
            self.scenes = self.model.scenes()
            self.linear = self.linearised()

    def linearised(self) -> Linear:
        """The linear system of the present state and noise."""
        return linearise(self.model, self.scenes, self.noises, nuisance=self.nuisance, foreign=self.foreign)

    def present(self) -> FloatArray:
        """The model's state among the parameters (m,); not a number where a parameter is never in the simulation."""
        layout, model = self.linear.layout, self.model
        out = np.full(self.linear.system.size, np.nan)
        out[layout.built] = model.built
        at = layout.nuisance.start
        out[at + self.nuisance.shift] = model.shift
        if self.nuisance.scale is not None:
            # Relative to the present one.
            out[at + self.nuisance.scale] = 0.0
        for claim, part in zip(model.claims, layout.claims, strict=True):
            # Amplitudes count from nothing, shapes from where they are.
            a = claim.physics.amplitudes
            out[part] = (*claim.values[:a], *(0.0,) * (len(claim.values) - a))
        return out

    def take(self, linear: Linear, step: FloatArray) -> float:
        """Go a ``step`` (m,) on; return the largest rms change in mm of a simulated recording."""
        layout, model = linear.layout, self.model
        old = self.present()
        inside = ~np.isnan(old)
        old[~inside] = 0.0
        x = old + step
        model.built = x[layout.built].copy()
        at = layout.nuisance.start
        shift, most = at + self.nuisance.shift, MOST_SHIFT * model.scope.gears[1].tau
        x[shift] = old[shift] + np.clip(step[shift], -most, most)
        model.shift = float(x[shift])
        if self.nuisance.scale is not None:
            model.scale = float(np.clip(model.scale * (1.0 + x[at + self.nuisance.scale]), 0.2, 5.0))
        claims = []
        for claim, part in zip(model.claims, layout.claims, strict=True):
            values = within(claim, np.array(claim.values) + x[part] - old[part], model.scope)
            x[part] = old[part] + np.array(values) - np.array(claim.values)
            claims.append(replace(claim, values=values))
        model.claims = claims
        # What an encoder misreads and a scale are taken by other ways than the simulation, but count alike.
        gone = np.where(inside, x - old, 0.0)
        return max(float(np.std(columns @ gone)) for columns in linear.columns)

    @property
    def shift_std(self) -> float:
        """Standard error of the driven zero in rad."""
        at = self.linear.layout.nuisance.start + self.nuisance.shift
        return math.sqrt(float(self.linear.system.covariance[at, at]))

    def choose_law(self) -> None:
        """Take the compliance law that fits best, if one is clearly better than the present one."""
        changes = law_changes(self.scenes)
        if not changes:
            return
        at = self.linear.layout.nuisance
        modes = list(range(at.stop - (0 if self.laws is None else len(self.laws.mix)), at.stop))
        bare = self.linear.without(modes)
        # The change as it is, with all else fitted again beside it.
        gains = bare.gains([change.parts for change in changes.values()])
        best = int(np.argmax(gains))
        if gains[best] < CLEARLY:
            return

        def by_that_law() -> None:
            self.model.law = list(changes)[best]
            self.model.soften(list(changes.values())[best].ratio)
            self.laws = None
            self.settle()

        self.tried(by_that_law, better=-math.inf)

    def measure(self) -> None:
        """Measure once what candidates are compared with: the largest effect of a claim, what laws may leave of claims
        about single teeth, and the mean deflections."""
        self.largest = self.of_teeth = 0.0
        for claim in self.model.claims:
            if not claim.physics.measures:
                change = self.model.change(self.scenes, claim, claim.values, but=claim)
                size = max(float(np.std(c)) for c in change)
                self.largest = max(self.largest, size)
                if not claim.physics.mean_tooth:
                    self.of_teeth = max(self.of_teeth, claim.physics.law_doubt * size)
        self.deflections = tuple(
            abs(float(np.mean(scene.bending(None) - scene.te))) if scene.bends else 0.0 for scene in self.scenes
        )

    @property
    def deflection(self) -> float:
        """The largest mean deflection in mm of any recording."""
        return max(self.deflections, default=0.0)


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
