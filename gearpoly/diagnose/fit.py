"""The fit of everything that is believed: simulated, linearised there, solved, and again until nothing moves."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gearpoly.compare.noise import Noise
from gearpoly.diagnose.linear import Linear, linearise, within
from gearpoly.diagnose.model import Model, noises
from gearpoly.diagnose.nuisance import Nuisance, law_changes, law_modes, make_nuisance
from gearpoly.diagnose.system import System
from gearpoly.physics.scene import Scene
from gearpoly.units import UM, FloatArray

CLEARLY = 30.0
"""Gain in misfit by which another compliance law must fit better than the present one to take its place."""

SETTLED = 0.004 * UM
"""mm rms. Changes below this need no further simulation."""

NEGLIGIBLE = 1.0
"""Fall in misfit below which a fit need not be repeated: a tenth of what any claim must gain."""

HALF_DONE = 0.002
"""The same as a part of the misfit beyond noise: while something large is missing, the rest need not be exact."""

ALONG, FARTHEST = 0.8, 3.0
"""Cosine between two steps from which they go the same way, and then the most by which the second is lengthened:
reliefs against deflection lie in a bent valley, in which plain steps are too short."""

STEADY = 0.1
"""Part of the noise level by which the simulation must have moved for the noise to be estimated anew."""

WIDER, WIDEST = 1.2, 5.0
"""Factors on the doubt about laws: below the first nothing is fitted again, above the second no law is believed."""

PASSES = 10
"""Most rounds of simulating and fitting again after a change."""


@dataclass(kw_only=True, eq=False)
class Fit:
    """The ``model`` and everything linear about it; ``step`` tells the user what is done."""

    model: Model
    foreign: list[FloatArray]
    step: Callable[[str], None]
    scenes: list[Scene]
    noises: list[Noise]
    nuisance: Nuisance
    linear: Linear
    laws: list[FloatArray] | None
    largest: float = 0.0
    deflection: float = 0.0

    def settle(self, passes: int = PASSES) -> None:
        """Simulate, fit, and simulate again until nothing moves."""
        way, moved = _Way(), math.inf
        for turn in range(passes):
            self.scenes = self.model.scenes()
            if turn == 0:
                if self.laws is None:
                    # Teeth may have begun to bend.
                    self.laws = law_modes(self.scenes, law_changes(self.scenes))
                self.nuisance = nuisance_of(self.model, self.scenes, self.laws)
            self.linear = self.linearised()
            if moved > STEADY * min(noise.level for noise in self.noises):
                self.noises = noises(self.model, self.linear.left())
                self.linear = self.linear.under(self.noises)
            fall = way.go(self.linear.system, self.present())
            moved = self.take(self.linear, way.length)
            samples = sum(left.size for left in self.linear.system.left)
            enough = NEGLIGIBLE + HALF_DONE * max(0.0, self.linear.system.misfit - samples)
            if moved < SETTLED or fall < enough:
                break
        self.measure()

    def kept(self) -> tuple[dict[str, object], dict[str, object]]:
        """What ``restore`` needs to come back to this state: nothing is changed in place."""
        names = ("scenes", "noises", "nuisance", "linear", "laws", "largest", "deflection")
        return self.model.kept(), {name: getattr(self, name) for name in names}

    def restore(self, kept: tuple[dict[str, object], dict[str, object]]) -> None:
        """Come back to a state."""
        self.model.restore(kept[0])
        for name, value in kept[1].items():
            setattr(self, name, value)

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

    def take(self, linear: Linear, length: float = 1.0) -> float:
        """Go towards the solution by ``length`` times its distance; return the largest rms change in mm of a simulated
        recording."""
        layout, model = linear.layout, self.model
        old = self.present()
        inside = ~np.isnan(old)
        old[~inside] = 0.0
        x = old + length * (linear.system.solution - old)
        model.built = x[layout.built].copy()
        at = layout.nuisance.start
        model.shift = float(x[at + self.nuisance.shift])
        if self.nuisance.scale is not None:
            model.scale = float(np.clip(model.scale * (1.0 + x[at + self.nuisance.scale]), 0.2, 5.0))
        claims = []
        for claim, part in zip(model.claims, layout.claims, strict=True):
            values = within(claim, np.array(claim.values) + x[part] - old[part])
            x[part] = old[part] + np.array(values) - np.array(claim.values)
            claims.append(replace(claim, values=values))
        model.claims = claims
        step = np.where(inside, x - old, 0.0)
        # What an encoder misreads and a scale are taken by other ways than the simulation, but count alike.
        return max(float(np.std(columns @ step)) for columns in linear.columns)

    def choose_law(self) -> None:
        """Take the compliance law that fits best, if one is clearly better than the present one."""
        changes = law_changes(self.scenes)
        if not changes:
            return
        at = self.linear.layout.nuisance
        modes = list(range(at.stop - (0 if self.laws is None else self.laws[0].shape[1]), at.stop))
        bare = self.linear.without(modes)
        whites = [
            np.column_stack([noise.whitened(change.parts[k]) for change in changes.values()])
            for k, noise in enumerate(self.noises)
        ]
        score, information = bare.system.scores(whites)
        # The change as it is, with all else fitted again beside it.
        gains = 2.0 * score - np.diag(information)
        best = int(np.argmax(gains))
        if gains[best] < CLEARLY:
            return
        self.model.law = list(changes)[best]
        self.model.soften(list(changes.values())[best].ratio)
        self.laws = None
        self.settle()

    def widen(self) -> None:
        """Fit once more with as much doubt about the compliance law as it turned out to be wrong.

        The search holds laws to what is known of them, or a relief would be taken for a law; sizes and their errors
        are to be honest about the law that was met.
        """
        if self.laws is None:
            return
        modes = self.laws[0].shape[1]
        met = self.linear.system.solution[self.linear.layout.nuisance][-modes:]
        wider = min(WIDEST, math.sqrt(float(np.mean(met**2))))
        if wider > WIDER:
            self.laws = [wider * law for law in self.laws]
            self.settle()

    def measure(self) -> None:
        """Measure once what ``least`` compares with: the largest effect of a claim, and the mean deflection."""
        self.largest = 0.0
        for claim in self.model.claims:
            if not claim.physics.measures:
                change = self.model.change(self.scenes, claim, claim.values, but=claim)
                self.largest = max(self.largest, *(float(np.std(c)) for c in change))
        bent = [abs(float(np.mean(scene.under(None) - scene.te))) for scene in self.scenes if scene.bends]
        self.deflection = max(bent, default=0.0)


class _Way:
    """The way that a fit has come: each step as long as the last two let hope."""

    def __init__(self) -> None:
        self._at: FloatArray | None = None
        self._step: FloatArray | None = None
        self.length = 1.0

    def go(self, system: System, present: FloatArray) -> float:
        """Look at the step from the ``present`` state (m,) to the solution; return by how much the misfit is to fall.

        What is not in the simulation starts where the last solution had it.
        """
        inside = ~np.isnan(present)
        start = np.where(inside, present, 0.0 if self._at is None else self._at)
        step = system.solution - start
        fall = math.inf if self._at is None else float(step @ system.normal @ step)
        mine = np.where(inside, step, 0.0)
        self.length = 1.0
        if self._step is not None:
            last, now = (one @ system.normal for one in (self._step, mine))
            before, here = float(last @ self._step), float(now @ mine)
            if float(last @ mine) > ALONG * math.sqrt(before * here) > 0.0:
                # A row of steps, each this part of the one before, comes to rest this much farther on.
                self.length = min(FARTHEST, 1.0 / max(1.0 - math.sqrt(here / before), 1.0 / FARTHEST))
        self._at, self._step = start + self.length * step, mine if self.length == 1.0 else None
        return fall


def nuisance_of(model: Model, scenes: list[Scene], laws: list[FloatArray] | None) -> Nuisance:
    slopes = [one.slope for one in model.observed]
    scaled = model.declared.model.tooth_deflection
    return make_nuisance(scenes, slopes=slopes, shift_std=model.shift_std, laws=laws, scaled=scaled)
