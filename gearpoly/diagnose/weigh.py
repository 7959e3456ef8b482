"""Whether a candidate is more than chance, more than what the simulation leaves of others, and worth a claim."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from gearpoly.compare.lines import SNAP
from gearpoly.compare.noise import mean_innovation
from gearpoly.diagnose.fidelity import (
    BESIDE_ANOTHER,
    BESIDE_MESH,
    FAINT,
    MEAN_TOOTH_BY_LAWS,
    OF_DEVIATIONS,
    OTHERS_BY_LAWS,
    participation,
)
from gearpoly.diagnose.heldout import SLOW_PARTS, blocks, unseen_misfit
from gearpoly.diagnose.late import by_clock
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.scan import KNOWN, Candidate, Looked, columns_of, together
from gearpoly.diagnose.softness import Softness
from gearpoly.diagnose.system import System
from gearpoly.diagnose.teeth_scale import WORTH_COUNTING, beside_finer, of_pitches
from gearpoly.physics.base import Claim
from gearpoly.units import FloatArray

FAMILY = 0.01
"""Chance that a healthy set of recordings raises any claim: of 5 % the other part is left to what is only located,
which is no name."""

ECHO = 0.004
"""Part of the largest claim's effect below which another is taken for what the first leaves of itself."""

PARTLY, MOSTLY = 0.03, 0.1
"""Parts of the misfit beyond noise that a claim must explain: any, and a further one of the mean tooth."""

SETS_IN = 0.25
"""Part of the form that a grade leaves open by which tips may fall off that nobody relieved: a reference of the tool
that is not straight does that. Of printed gears as grade 8 to 11 has them, 3.1 um were named a relief, 0.16 of it. Of
another 1.3 to 1.5 um still are, 0.3 to 0.35 of it: where 0.3 um of 1 um counts as the gear's own, so do pits."""

ALONG = 0.1
"""Part of what is seen of an effect below which it hardly changes along recordings."""

HALF = 0.5
"""The same from which on a form that a grade leaves open is what most of the misfit is."""

IN_STEP = 4.0
"""Size of a wave over what a reading's noise can make of it to first order: what is left of a wave beside the mean is
less than the wave, and several harmonics of the sampling make more together."""

SIMILAR = 0.5
"""Part of a wave's size from which on another may be of its kind."""

COINCIDENCE = 0.1
"""Waves of unknown make that may be expected to lie at an order of a shaft by chance, beyond which none is named."""

STEPS, CLOSER = 48, 2
"""Moments of a recording at which a step is tried, at first in all of it, and how often so: the second time between the
neighbours of the best."""

SUDDEN = 4.0
"""Gain by which what is slow must be better than the best step to be told from one: of steps at 5 to 8 standard
deviations whose moment nobody knows, three slow terms gained more than that in 1 of 100."""

POLISH = 1.6
"""Gain of a polished shape over the nearest that was tried, at most to be hoped for."""


@dataclass(kw_only=True, eq=False)
class Weigh(Softness):
    """The fit with the scales on which candidates are weighed; ``looked`` says at how many places."""

    looked: Looked = field(default_factory=Looked)
    late: tuple[Linear, float] | None = None
    """The system that a clock's doubt was asked of last, and that doubt in mm."""

    formed: float = 0.0
    """Gain of the best form of all teeth that a grade leaves open."""

    def hopeful(self, one: Candidate) -> bool:
        """Whether a candidate may be significant once its shape is polished."""
        return self.significant(replace(one, gain=POLISH * one.gain) if one.claim.physics.shaped else one)

    def significant(self, one: Candidate) -> bool:
        """Whether chance would hardly gain as much anywhere in the search, noise as it is left."""
        return self.beyond_chance(one) and not self.sudden(one)

    def beyond_chance(self, one: Candidate) -> bool:
        """The same of a candidate that may stand for something sudden."""
        return self.clear(one) and not self.by_coincidence(one)

    def clear(self, one: Candidate) -> bool:
        """The same of a wave that may be any of many."""
        physics, place = one.claim.physics, one.claim.place
        if not physics.sensible(self.model.scope, place, one.claim.values):
            return False
        if self.graded(one):
            return False
        honest = replace(one, gain=self.counted(one) / max(1.0, self.linear.system.whiteness))
        if honest.log_chance(tests=self.looked.tests(one.claim)) >= math.log(FAMILY):
            return False
        floors = self.law_floor(one), self.reading_floor(one), self.least(one), self.clock_floor(one)
        return self.size(one) > max(floors)

    def counted(self, one: Candidate) -> float:
        """The gain of a candidate, beside teeth that may be finer than their grade."""
        if one.gain < WORTH_COUNTING or not of_pitches(self.model, one.claim):
            return one.gain
        columns, system = self.beside(one)
        linear = replace(self.linear, system=system.with_columns(columns))
        return beside_finer(linear, self.model, one.claim, one.gain)

    def sudden(self, one: Candidate) -> bool:
        """Whether what a slow candidate explains may as well have happened at once."""
        return one.claim.physics.slow and one.gain < self.stepped(one.claim.place.recordings) + SUDDEN

    def matters(self, one: Candidate) -> bool:
        """Whether a candidate explains enough of what is left beyond noise. Where much is left that it does not touch,
        the simulation is wrong in some way of its own (a law of compliance, corners), and small parts of that look like
        anything; most of all like a further physics of the mean tooth. Makers relieve both gears, so a relief explains
        what both do together."""
        physics, gain = one.claim.physics, one.gain
        further = physics.mean_tooth and any(c.physics.mean_tooth for c in self.model.claims)
        if further and physics.shaped:
            gain = max(gain, together(self.model, self.scenes, self.linear, physics)[0])
        beyond = self.linear.system.beyond
        # A form of all teeth that their grade leaves open is not claimed; nor are its likenesses, tooth by tooth.
        as_one = one.claim.place.tooth is not None and self.formed > HALF * beyond
        return gain > (MOSTLY if further or as_one else PARTLY) * beyond

    def size(self, one: Candidate) -> float:
        """Rms in mm of what a candidate adds and nothing else explains."""
        return mean_innovation(self.noises) * math.sqrt(max(one.gain, 0.0) / self.linear.system.samples)

    def graded(self, one: Candidate) -> bool:
        """Whether what all teeth of a gear have is no more than its grade leaves open: a slope, a bulge, and a part of
        that where it only sets in on the way up the flank."""
        gear, physics = one.claim.place.gear, one.claim.physics
        if gear is None or not physics.mean_tooth:
            return False
        part = SETS_IN if physics.shaped else 1.0
        return abs(one.claim.values[0]) < part * self.model.scope.form[gear]

    def by_coincidence(self, one: Candidate) -> bool:
        """Whether a wave may as well be one of those that no gear pair makes, where the recordings hold many of them
        that are as large: in so many turns each is at an order of either shaft by chance now and then."""
        if one.claim.place.order is None:
            return False
        turns = [
            max(float(np.ptp(angle)) for angle in angles) / (2.0 * math.pi)
            for angles in zip(*((s.samples.theta_1, s.samples.theta_2) for s in self.scenes), strict=True)
        ]
        chance = 2.0 * SNAP * sum(1.0 / turn for turn in turns)
        if len(self.model.strangers) * chance <= COINCIDENCE:
            return False
        effect = self.model.changed(self.scenes, one.claim) or [np.zeros(1)]  # no gears run with so much of it
        return self.as_large(max(float(np.std(part)) for part in effect)) * chance > COINCIDENCE

    def as_large(self, rms: float) -> int:
        """How many waves of unknown make are still fitted that have at least half of an ``rms`` in mm: large claims
        that nobody has made yet leave small ones at all places."""
        fitted = self.linear.system.solution[self.linear.layout.foreign] / math.sqrt(2.0)
        sizes = [max(math.hypot(fitted[at], fitted[at + 1]) for at in one[::2]) for one in self.model.strangers]
        return sum(size > SIMILAR * rms for size in sizes)

    def stepped(self, recordings: Sequence[int] = ()) -> float:
        """Gain of the best steps in ``recordings`` (none: in all), one in each. What happens at once looks like
        something slow, and is not. Every step but the first costs its freedom and the choice of its moment."""
        these = [k for k, _ in enumerate(self.model.observed) if not recordings or k in recordings]
        best, *others = sorted((self._best_step([k]) for k in these), reverse=True)
        apart = best + sum(max(0.0, gain - 2.0 * (1.0 + math.log(STEPS))) for gain in others)
        # Recordings that drift alike may jump alike.
        return max(apart, self._best_step(these))

    def _best_step(self, recordings: Sequence[int]) -> float:
        """Gain of the best step of ``recordings`` that all jump alike and at the same part of each, its moment found
        coarsely and then between the neighbours: one that is tried beside the true moment loses part of its gain."""
        most, low, high = 0.0, 0.0, 1.0
        for _ in range(CLOSER):
            moments = np.linspace(low, high, STEPS + 2)[1:-1]
            gains = self._steps(recordings, moments)
            at, apart = int(np.argmax(gains)), float(moments[1] - moments[0])
            most, low, high = max(most, float(gains[at])), moments[at] - apart, moments[at] + apart
        return most

    def _steps(self, recordings: Sequence[int], moments: FloatArray) -> FloatArray:
        """Gain (q,) of a step at each of ``moments`` (q,), parts of a recording, in all of ``recordings`` alike; 0
        where it is told from nothing."""
        sums = []
        for k in recordings:
            n = self.model.observed[k].samples.size
            sums.append(self.linear.sums(k, (np.arange(n)[:, None] >= n * moments).astype(np.float64)))
        score, information = self.linear.system.beside(sums)
        known = np.diag(information)
        told = known > KNOWN * np.max(known, initial=0.0)
        return np.where(told, score**2 / np.where(told, known, 1.0), 0.0)

    def law_floor(self, one: Candidate) -> float:
        """Rms in mm below which an effect may be what no compliance law gets right, as far as that reaches it."""
        physics, place = one.claim.physics, one.claim.place
        part, more = 0.0, 0.0
        if physics.mean_tooth:
            part, more = MEAN_TOOTH_BY_LAWS, self.of_teeth
            if any(made.physics.mean_tooth and made.key != one.claim.key for made in self.model.claims):
                part = BESIDE_ANOTHER
        if physics.whole_gear:
            # Where the rig took the means off, it is told by how eccentric teeth bend along their turns, or by nothing.
            part = OTHERS_BY_LAWS
        if physics.wavelike and place.order is not None:
            z = self.model.scope.gears[place.gear or 0].z
            if place.order > z // 2 and abs((place.order + z // 2) % z - z // 2) <= BESIDE_MESH:
                part = OTHERS_BY_LAWS * self.magnified(place.order, place.gear_name)
        # What is left of a tooth that follows the law is no more than that of all.
        floor = max(part * self.deflection, min(more, BESIDE_ANOTHER * self.deflection))
        if place.tooth is not None and self.deflection > 0.0:
            floor = max(floor, OTHERS_BY_LAWS * self.bent_where(one) + OF_DEVIATIONS * self.built_where(one))
        return floor * self.reached(one) if self.size(one) <= floor else floor

    def magnified(self, order: float, gear: str | None, recordings: Sequence[int] = ()) -> float:
        """By how much a resonance makes more of a wave of ``order`` per turn of a ``gear`` (None: per mesh), and so of
        what laws differ by in it, at most in any of ``recordings`` (none: in all); 1 where none does."""
        z_1, z_2 = (one.z for one in self.model.scope.gears)
        per_driving = order * {"driving": 1.0, "driven": z_1 / z_2}.get(gear or "", float(z_1))
        scenes = [self.scenes[k] for k in recordings] or self.scenes
        hertz = np.array([per_driving * (scene.samples.speed or 0.0) / (2.0 * math.pi) for scene in scenes])
        return max(1.0, float(np.max(np.abs(scenes[0].assembled.shafts.gain(hertz)))))

    def reached(self, one: Candidate) -> float:
        """Part of what may be left in the recordings that can pass for an effect: less than all of it where teeth as
        built could have the effect too, were they not held by their grade or inspection.

        Of what is known of the effect, K = D + P, only D lies in what is recorded, P in how unlikely such teeth are; to
        a leftover of the norm e belongs a gain of D e^2 / K at most.
        """
        columns, system = self.beside(one)
        effect = [white @ np.array(one.claim.values[: one.claim.physics.amplitudes]) for white in columns]
        right = sum((a.T @ e for a, e in zip(system.white, effect, strict=True)), np.zeros(system.size))
        taken = system.solved(right)
        recorded = sum(float(np.sum((e - a @ taken) ** 2)) for a, e in zip(system.white, effect, strict=True))
        known = sum(float(e @ e) for e in effect) - float(right @ taken)
        return math.sqrt(min(1.0, recorded / known)) if known > 0.0 else 1.0

    def reading_floor(self, one: Candidate) -> float:
        """Rms in mm below which a wave may be made of a reading's noise alone: that moves the angles by which the wave
        is drawn and the recorded error alike. Where samples come at the same phase of the wave turn after turn, as at
        the orders of the sampling itself, those products do not average out."""
        order, gear = one.claim.place.order, one.claim.place.gear or 0
        if not one.claim.physics.wavelike or order is None:
            return 0.0
        worst = 0.0
        for scene, noise in zip(self.scenes, self.noises, strict=True):
            samples = scene.samples
            angle = order * (samples.theta_1 if gear == 0 else samples.theta_2)
            in_step = math.hypot(float(np.mean(np.cos(angle))), float(np.mean(np.sin(angle))))
            worst = max(worst, in_step * order * noise.level**2 / scene.gear(gear).r_b)
        return IN_STEP * worst

    def clock_floor(self, one: Candidate) -> float:
        """Rms in mm below which an effect may be what a clock that is off does, where an angle was made of time. Where
        a single tooth stands is told by more than by what it moves at the ends of a recording."""
        if not any(self.model.scope.from_time) or one.claim.place.tooth is not None:
            return 0.0
        if self.late is None or self.late[0] is not self.linear:
            self.late = self.linear, by_clock(self.scenes, self.linear)
        return self.late[1]

    def beside(self, one: Candidate) -> tuple[list[FloatArray], System]:
        """Whitened columns (n_k, a) per unit of each amplitude of a candidate or claim, and all that is believed
        without it."""
        linear = self.linear
        mine = next((k for k, made in enumerate(self.model.claims) if made.key == one.claim.key), None)
        if mine is None:
            return columns_of(self.model, self.scenes, linear, one), linear.system
        columns = [white[:, : one.claim.physics.amplitudes] for white in linear.white_of(mine)]
        return columns, linear.system.without(linear.layout.places(mine))

    def least(self, one: Candidate) -> float:
        """Rms in mm below which an effect may be what the simulation leaves of others, as far as that reaches it."""
        echo = ECHO * self.largest
        least = max(self.faint(one), echo)
        if self.size(one) > least:
            return least
        if self.size(one) > echo and not self.moves(one):
            return echo
        return least * self.reached(one)

    def faint(self, one: Candidate) -> float:
        """Rms in mm over all samples below which an effect may be what chords and contacts leave: of a single tooth,
        as much as they leave where it shows."""
        if one.claim.place.tooth is None or self.size(one) > FAINT:
            return FAINT
        effect = np.concatenate(self.model.change(self.scenes, one.claim, one.claim.values))
        return FAINT * math.sqrt(participation(effect))

    def bent_where(self, one: Candidate) -> float:
        """Rms in mm over all samples of the mean deflection, counted where an effect shows."""
        effects = self.model.change(self.scenes, one.claim, one.claim.values)
        squares = sum(
            bent**2 * participation(effect) * effect.size
            for bent, effect in zip(self.deflections, effects, strict=True)
        )
        return math.sqrt(squares / self.linear.system.samples)

    def built_where(self, one: Candidate) -> float:
        """Rms in mm over all samples of what teeth as built do in loaded recordings, counted where an effect shows."""
        effects = self.model.change(self.scenes, one.claim, one.claim.values)
        at, squares = self.linear.layout.built, 0.0
        for scene, columns, effect in zip(self.scenes, self.linear.columns, effects, strict=True):
            square = float(effect @ effect)
            if scene.bends and square > 0.0:
                built = columns.times(at, self.linear.system.solution[at])
                there = float(np.sum(effect**2 * (built - np.mean(built)) ** 2)) / square
                squares += there * participation(effect) * effect.size
        return math.sqrt(squares / self.linear.system.samples)

    def moves(self, one: Candidate) -> bool:
        """Whether what is seen of an effect may be how it changes along a recording, as what chords and contacts leave
        does, which repeats with the pair. One that only sets recordings apart has to beat the doubt about how far a
        load bends, which is fitted beside it."""
        if one.claim.physics.slow and all(observed.whole for observed in self.model.observed):
            return False
        mine = next((made for made in self.model.claims if made.key == one.claim.key), None)
        effect = self.model.change(self.scenes, one.claim, one.claim.values, but=mine)
        squares = sum(part.size * float(np.var(part)) for part in effect)
        return math.sqrt(squares / self.linear.system.samples) > ALONG * self.size(one)

    def pays(self, one: Candidate) -> bool:
        """Whether the candidate, fitted on one part of the recordings, makes the other part fit better."""
        columns = columns_of(self.model, self.scenes, self.linear, one)
        return self.paid(one.claim, self.linear.system, self.linear.system.with_columns(columns))

    def paid(self, claim: Claim, plain: System, wider: System) -> bool:
        """The same of a ``claim`` that ``wider`` has and ``plain`` has not."""
        slow = claim.physics.slow
        masks = [blocks(one.fit.size, one.jumps, parts=SLOW_PARTS) if slow else one.fit for one in self.model.observed]
        others = [~mask for mask in masks]
        if not all(np.any(mask) for mask in others):
            return True
        gained = 0.0
        for seen, unseen in ((masks, others), (others, masks)):
            gained += unseen_misfit(plain, seen, unseen) - unseen_misfit(wider, seen, unseen)
        return gained > 0.0

    def gain_without(self, k: int) -> float:
        """What claim ``k`` gains, all else fitted again without it; nothing where the fit would have less of it than
        none, as of a pit where it wants a bump, or more than there can be: then it is something else."""
        system, claim = self.linear.system, self.model.claims[k]
        a = claim.physics.amplitudes
        sizes = system.solution[self.linear.layout.places(k)[:a]]
        bounds = [one.bounds(self.model.scope, claim.place) for one in claim.physics.coordinates[:a]]
        fixed = claim.physics.fixed_amplitudes  # held at what they are, which is their largest
        if any(size <= low or (size >= high and not fixed) for size, (low, high) in zip(sizes, bounds, strict=True)):
            return 0.0
        return system.without(self.linear.layout.places(k)).misfit - system.misfit
