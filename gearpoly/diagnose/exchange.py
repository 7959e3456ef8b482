"""Exchange of claims, now that all the rest is known: for others, for other forms, for twins, for none."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from gearpoly.diagnose.fit import BETTER
from gearpoly.diagnose.kept import Kept
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.scan import Candidate, all_places, polished, scan, together
from gearpoly.diagnose.unearned import Unearned
from gearpoly.diagnose.unnamed import leave
from gearpoly.diagnose.weigh import FAMILY, Weigh
from gearpoly.errors import GearpolyError
from gearpoly.infer.prior import kind_of, order_of
from gearpoly.infer.unknown import at_place
from gearpoly.physics.base import Claim
from gearpoly.physics.tooth_pitch import PHYSICS as PITCH
from gearpoly.units import UM, FloatArray

ALIKE = 0.1
"""Part of its mean by which a value of twins may differ for both to be alike."""

SWAPS = 4
"""Most exchanges after a claim."""

LIGHT, FAR = 0.5, 4.0
"""Part of what other teeth of its gear carry, in the mean, below which a tooth may have left the mesh; and how far back
it is set for a trial, as a multiple of what its claim does and pairs are bent: well out of it."""

LEFT_OF_TOOTH, ASIDE = 0.5, 16.0
"""Misfit beyond noise over that of noise, where a claimed tooth is in mesh, from which its shape is doubted; and the
steps of a coordinate by which it is begun elsewhere: twice what a shape was polished by."""

LIKELY = 0.7
"""Part of a claim's gain that its substitute must reach by its coarse shapes to be polished, and that another first
step must have reached to be gone back to."""


@dataclass(kw_only=True, eq=False)
class Exchange(Weigh):
    """The fit whose claims may give way to others."""

    def gained(self, kept: Kept) -> float:
        """By how much less the present state costs than a ``kept`` one, in misfit and in freedoms, both by the noise of
        that and by what is known of teeth now: misfits under different priors do not compare."""
        noises, teeth = kept[1]["noises"], self.model.as_built
        before: Linear = kept[1]["linear"]
        if kept[0]["as_built"] is not teeth:
            before = before.under(noises, teeth)
        saved = before.system.misfit - self.linear.under(noises).system.misfit
        return saved + 2.0 * (freedoms(kept[0]["claims"]) - freedoms(self.model.claims))

    def promised(self, claim: Claim) -> float:
        """By how much more the present state misfits than a straight line from it promises, where a ``claim`` shapes a
        single tooth: much if no step led on, and what no step made true is not explained. Else nothing."""
        if not claim.shapes_tooth:
            return 0.0
        return self.linear.system.misfit_at(self.present()) - self.linear.system.misfit

    def swap(self) -> None:
        """Exchange claims for others that explain more, now that all the rest is known."""
        for _ in range(0 if self.over else SWAPS):
            better = max(
                (one for k in range(len(self.model.claims)) for one in self._better(k)),
                key=lambda one: one[1],
                default=None,
            )
            if better is None:
                return
            k, _, claims = better
            begun = self.kept()
            try:
                self.join(claims, instead=[k])
                self.settle()
            except GearpolyError:  # first order promised what gears that run cannot do
                self.restore(begun)
                return
            self.drop_idle()

    def _better(self, k: int) -> list[tuple[int, float, list[Claim]]]:
        """What would explain more in the place of claim ``k``, with how much more: another physics, or one of both
        gears, of which it may be the likeness."""
        claim = self.model.claims[k]
        if claim.physics.wavelike:
            return []
        leave = self.linear.layout.places(k) + self.linear.layout.form_places(self.model, k)
        bare = self.linear.without(leave)
        gain = bare.system.misfit - bare.system.with_columns(self.linear.white_of(k)).misfit
        others = self.model.but(claim)
        places = [
            (physics, place)
            for physics, place in all_places(others)
            if (not physics.wavelike and (place.gear, place.tooth) == (claim.place.gear, claim.place.tooth))
            or (place.tooth is None and claim.place.tooth is None and not physics.wavelike)
        ]
        found, _ = scan(others, self.scenes, bare, only=places)
        out = []
        known = claim.physics
        shaped = [one for one in self.model.method.physics if one.mean_tooth and one.shaped and one is not known]
        for physics in shaped if known.mean_tooth else ():
            both, claims = together(others, self.scenes, bare, physics)
            if claims and both - 2.0 * freedoms(claims) > gain - 2.0 * len(claim.values) + BETTER:
                out.append((k, both - gain, claims))
        for one in [c for c in found if c.claim.key != claim.key and c.gain > LIKELY * gain][:2]:
            done = polished(others, self.scenes, bare, one)
            if done.gain - 2.0 * done.freedoms > gain - 2.0 * len(claim.values) + BETTER:
                out.append((k, done.gain - gain, [done.claim]))
        return out

    def reshape(self) -> None:
        """Exchange claims for the same in another form, where that fits better: else other physics draw the rest."""
        for k, claim in enumerate(self.model.claims if not self.over else ()):
            # What takes less of a flank and has no other form need only be as good.
            by = BETTER if claim.place.form else 0.0
            any(self._exchanged(k, one, by=by) for one in claim.otherwise(self.model.scope))
            for _ in range(SWAPS):
                if not sum(self._exchanged(k, one, by=BETTER) for one in self._aside(self.model.claims[k])):
                    break

    def _aside(self, claim: Claim) -> list[Claim]:
        """A shaped claim about a single tooth with each coordinate of its shape moved, where it leaves more than noise
        of that tooth: an edge may have come to rest beside the true one. None where nothing is left."""
        gear, tooth, a = claim.place.gear or 0, claim.place.tooth, claim.physics.amplitudes
        if tooth is None or len(claim.values) == a:
            return []
        lefts = [
            left[scene.samples.meshing(gear, tooth, z=scene.gear(gear).z)]
            for scene, left in zip(self.scenes, self.linear.system.left, strict=True)
        ]
        if float(np.mean(np.concatenate(lefts) ** 2)) < 1.0 + LEFT_OF_TOOTH:
            return []
        out = []
        for k, one in enumerate(claim.physics.coordinates[a:], start=a):
            for step in (-ASIDE * one.step, ASIDE * one.step):
                low, high = one.bounds(self.model.scope, claim.place)
                moved = min(max(claim.values[k] + step, low), high)
                out.append(replace(claim, values=(*claim.values[:k], moved, *claim.values[k + 1 :])))
        return out

    def set_back(self) -> None:
        """Exchange a claim about a tooth that hardly carries for one that it stands back, where that fits better. Once
        it has left the mesh no column tells so: to first order a tooth that gives way is all that is left of it."""
        for k, claim in enumerate(self.model.claims):
            # A pit over all of a flank does as much, with more to choose.
            if any(self._exchanged(k, made, by=0.0) for made in self._standing_back(claim)):
                return

    def _exchanged(self, k: int, made: Claim, *, by: float) -> bool:
        """Whether ``made`` has taken the place of claim ``k``: where that fits better by more than ``by`` in misfit."""
        begun = self.kept()
        try:
            self.join([made], instead=[k])
            self.settle()
            better = self.gained(begun) > by
        except GearpolyError:
            better = False
        if not better:
            self.restore(begun)
        return better

    def _standing_back(self, claim: Claim) -> list[Claim]:
        """Claims that the tooth of ``claim`` stands well out of the mesh, on any flank; none where it carries as others
        do."""
        gear, tooth = claim.place.gear, claim.place.tooth
        if gear is None or tooth is None or claim.physics is PITCH or PITCH not in self.model.method.physics:
            return []
        if all(scene.carried(gear, tooth) > LIGHT for scene in self.scenes):
            return []
        without = self.model.but(claim).scenes()
        most = max(float(np.max(np.abs(here.te - gone.te))) for here, gone in zip(self.scenes, without, strict=True))
        values = (-FAR * max(most, self.deflection) / UM,)
        taken = {one.key for one in self.model.claims}
        places = [p for p in PITCH.places(self.model.scope) if (p.gear, p.tooth) == (gear, tooth)]
        made = [Claim(physics=PITCH, place=place, values=values) for place in places]
        return [one for one in made if one.key not in taken]

    def even(self) -> None:
        """Begin once more with both gears alike, by the declared compliance law, where a shaped physics is claimed of
        both: what one takes of the other bends the valley between them into several, each with a law of its own, and
        makers relieve both gears alike."""
        for k, one in enumerate(self.model.claims):
            twins = [j for j, other in enumerate(self.model.claims) if _are_twins(one, other)]
            if not twins:
                continue
            both = np.array([one.values, self.model.claims[twins[0]].values])
            values = tuple(np.mean(both, axis=0).tolist())
            if np.all(np.ptp(both, axis=0) < ALIKE * np.abs(values)):
                return
            self.tried(partial(self._alike, (k, twins[0]), values), better=BETTER)
            return

    def _alike(self, ones: Sequence[int], values: tuple[float, ...]) -> None:
        """Fit on from the same ``values`` of the claims of these numbers, by the declared compliance law."""
        for j in ones:
            self.model.claims[j] = replace(self.model.claims[j], values=values)
        self.take_declared_law()
        self.settle()
        self.choose_law()

    def drop_idle(self) -> None:
        """Take back claims that no longer gain more than chance would, weakest first.

        What no column tells but as the set-up with it is simulated bends with its size: of a gap that has closed the
        next micrometre is like softer teeth, the whole of it is not; and so does a pit over which teeth lose touch, of
        which the next micrometre is hardly seen. Such a claim goes only if all fits well without.
        """
        needed: set[tuple[object, ...]] = set()
        while True:
            claims = [(k, claim) for k, claim in enumerate(self.model.claims) if claim.key not in needed]
            gains = {k: self.gain_without(k) for k, _ in claims}
            ones = {k: Candidate(claim=one, gain=gains[k], freedoms=len(one.values)) for k, one in claims}
            weakest = min(
                (k for k, one in ones.items() if not self.significant(one)), key=gains.__getitem__, default=None
            )
            if weakest is None:
                return
            gone, begun = self.model.claims[weakest], self.kept()
            promised = self.promised(gone)
            waves = self._wave_without_name(ones[weakest])
            try:
                del self.model.claims[weakest]
                if waves is not None:
                    leave(self, waves)
                self.settle()
            except GearpolyError:  # gears that cannot run without it need it
                self.restore(begun)
                needed.add(gone.key)
                continue
            lost = 2.0 * len(gone.values) - self.gained(begun) - promised
            if gone.simulated and self.significant(replace(ones[weakest], gain=lost)):
                self.restore(begun)
                needed.add(gone.key)

    def _wave_without_name(self, one: Candidate) -> list[FloatArray] | None:
        """Columns (n_k, q) of the order of a claim that goes; None where it is about no order, or chance gains so."""
        order = order_of(one.claim)
        if order is None or kind_of(one.claim) != "wave" or one.log_chance(tests=1) >= math.log(FAMILY):
            return None
        effect = self.model.change(self.scenes, one.claim, one.claim.values, but=one.claim)
        rms = self.model.rms_of(self.scenes, one.claim)
        self.model.unnamed = (*self.model.unnamed, Unearned(claim=one.claim, rms=rms, posterior=None, seen=True))
        return at_place(one.claim, self.scenes, order=order, effect=effect)


def freedoms(claims: Sequence[Claim]) -> int:
    """Coordinates of all ``claims``."""
    return sum(len(claim.values) for claim in claims)


def _are_twins(one: Claim, other: Claim) -> bool:
    """Whether two claims are the same shaped physics of the mean tooth in the same form, one of each gear."""
    alike = one.physics.shaped and one.physics.mean_tooth and other.physics is one.physics
    return alike and one.place.form == other.place.form and one.place.gear == 0 and other.place.gear == 1
