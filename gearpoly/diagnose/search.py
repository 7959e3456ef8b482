"""Forward, backward, and all together again: which physics the evidence makes necessary."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from gearpoly.diagnose.exchange import LIKELY, Exchange
from gearpoly.diagnose.fit import BETTER
from gearpoly.diagnose.kept import Kept, without_columns
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.multi_start import multi_start
from gearpoly.diagnose.relaxed import relax
from gearpoly.diagnose.relieved import relieved
from gearpoly.diagnose.scan import Candidate, polished, scan
from gearpoly.diagnose.unnamed import is_weighed, leave_more, leave_waves, left_unnamed, likeliest, weigh_at
from gearpoly.diagnose.weigh import MOSTLY
from gearpoly.errors import GearpolyError
from gearpoly.infer.prior import order_of
from gearpoly.physics.base import Claim
from gearpoly.threads import each

ROADS, LEFT = 2, 0.2
"""Other steps that are gone back to, where the search ended with more misfit beyond noise than this part of noise's
own."""

MOST = 8
"""Claims after which the search stops: so many mean that the pair file is wrong as a whole."""

DOUBTED = 2.0
"""Mean square of what is left, in noise, from which on the pair file is doubted as a whole: as much repeats as is
noise."""

MANY = 4
"""Claims from which on one end is doubted however well it fits: so many may each take a little of what two are."""

POLISHED = 4
"""Candidates of different kinds that are polished before one is taken."""

GROWN = 10.0
"""Times that polishing a shape may make a size larger before that is doubted where it does not stand."""

MINIMA_APART = 200.0
"""Misfit in sigmas squared by which local minima of unloaded teeth may differ: claims of nothing had gained 41 to 93 in
three pairs of grade 6 that were recorded at 8 to 10 samples per mesh."""

SHORTLIST = 160
"""Candidates from which those are chosen, best first."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Road:
    """A step that might have been taken: the ``claim`` instead of the one that was, from the ``state`` before; it
    gained this ``part`` of what that one did, more than all of it where its place was chosen among more."""

    state: Kept
    claim: Claim
    part: float


@dataclass(kw_only=True, eq=False)
class Search(Exchange):
    """The search in progress; ``disowned`` counts claims that were taken back since they did not end. ``rises``: a
    linear system, and by how much the misfit (sigmas squared) rises from it without a claim, by its key, where all was
    fitted again without; so no such fit is made twice."""

    disowned: int = 0
    rises: tuple[Linear, dict[tuple[object, ...], float]] | None = None

    def run(self) -> list[Candidate]:
        """Make claims until none pays; return the candidates of the last look.

        Where much is left then, a step that was contested may have been wrong: wind-up takes all that several torques
        show of bending at first, and the reliefs that would tell them apart come later. So bending and reliefs are
        tried together, also where few claims or many seem to do; the other steps are gone too, and the best end is
        kept. Many are not waited for where those few explain more.
        """
        self.forget()
        start, missing = without_columns(self.kept()), self.linear.system.beyond
        found, roads = self.forward(MANY)
        if len(self.model.claims) >= MANY:
            found = self.otherwise(start, relieved(self.model), found, most=MANY)
        if len(self.model.claims) >= MANY:
            # Those few are tried once more at the end, without a limit: beside them others may be many as well.
            found, more = self.forward()
            roads += more
        if self.strained or self.several_of_all:
            found = self.otherwise(start, relieved(self.model), found)
        for road in sorted(roads, key=lambda one: -one.part)[:ROADS]:
            if self.strained:
                found = self.otherwise(road.state, [road.claim], found)
        if self.laws_anew():
            found, _ = self.forward()
        self.disown(missing)
        self.withdraw()
        self.widen()
        return found

    @property
    def doubted(self) -> bool:
        """Whether as much is left as is noise, so that the pair file is doubted as a whole."""
        return self.linear.system.whiteness > DOUBTED

    @property
    def strained(self) -> bool:
        """Whether the search has ended with much left, or with so many claims that few others may be what they are."""
        much = self.linear.system.beyond >= LEFT * self.linear.system.samples
        return much or len(self.model.claims) >= MANY

    @property
    def several_of_all(self) -> bool:
        """Whether several physics of all teeth are claimed that may be what bending leaves of reliefs together."""
        ones = [one.physics for one in self.model.claims if one.physics.mean_tooth]
        return len(ones) > 1 and sum(one.shaped for one in ones) < 2

    def otherwise(
        self, state: Kept, claims: list[Claim], found: list[Candidate], *, most: int = MOST
    ) -> list[Candidate]:
        """Search once more from a ``state`` on with ``claims``, unless there are none, and keep the end that fits
        better, if it comes before ``most`` claims where few were asked for; the candidates of its last look, ``found``
        or others."""
        if not claims or self.over:
            return found
        end, looked = self.kept(), self.looked
        self.restore(state)
        other = self.forward(most)[0] if self.accept(claims) else None
        ended = most == MOST or len(self.model.claims) < most
        if other is not None and ended and self.gained(end) > BETTER:
            return other
        self.restore(end)
        self.looked = looked
        return found

    def disown(self, missing: float) -> None:
        """Take back claims about single teeth that do not end and leave a good part of the misfit beyond noise that was
        ``missing`` before any, and all others that explain less than is left: whatever it is, it looks like each of
        them here and there, and keeps no name."""
        left = self.linear.system.beyond
        if len(self.model.claims) < MOST or left < MOSTLY * missing:
            return
        ones = enumerate(self.model.claims)
        kept = [one for k, one in ones if one.place.tooth is None and self.gain_without(k) > left]
        gone = len(self.model.claims) - len(kept)

        def taken_back() -> None:
            self.model.claims = kept
            self.settle()

        if self.tried(taken_back, better=-math.inf):
            self.disowned = gone
        self.drop_idle()

    def forward(self, most: int = MOST) -> tuple[list[Candidate], list[Road]]:
        """Make claims until none pays or there are so many; the candidates of the last look, and the steps that might
        have been taken."""
        refused: set[tuple[object, ...]] = set()
        found: list[Candidate] = []
        roads: list[Road] = []
        looked = False
        while len(self.model.claims) < most and len(refused) <= MOST and not self.over:
            if not looked:
                self.step(f"looking for what is missing ({len(self.model.claims)} found)")
                found, self.looked = scan(self.model, self.scenes, self.linear)
                self.formed = max((one.gain for one in found if self.graded(one)), default=0.0)
            ones = self.likely(found, refused)
            best = next((one for one in ones if self.matters(one) and (is_weighed(one.claim) or self.pays(one))), None)
            before = self.kept()
            if best is None:
                if leave_waves(self, found[:SHORTLIST]) and not self._unsettled(before):
                    looked = False
                    continue
                break
            weighed = weigh_at(self, best)
            if weighed is not None and left_unnamed(self, best.claim, weighed):
                leave_more(self, found[:SHORTLIST], besides=best.claim)
                looked = self._unsettled(before)
                refused |= {best.claim.key} if looked else set()
                continue
            first = best.claim.key
            chosen = likeliest(best, weighed)
            if chosen is not None and chosen.claim.key in refused:
                # What was likelier to first order did not stand, so nothing speaks against the candidate itself.
                chosen = best
            looked = True  # where nothing changes, the next best of the same look is tried
            if chosen is None:
                refused.add(first)
                continue
            best = chosen
            self.step(f"fitting {best.claim.physics.name.replace('_', ' ')}")
            if self.taken(best, found, before):
                roads += [
                    Road(state=without_columns(before), claim=one.claim, part=one.gain / best.gain)
                    for one in ones
                    if one.claim.physics is not best.claim.physics and one.gain > LIKELY * best.gain
                ]
                refused -= {best.claim.key, first}
                looked = False
                continue
            refused.add(best.claim.key)
        return found, roads

    def _unsettled(self, before: Kept) -> bool:
        """Whether gears cannot run with the curves that were left without a name; the state is then as ``before``."""
        try:
            self.settle()
        except GearpolyError:
            self.restore(before)
            return True
        return False

    def taken(self, best: Candidate, found: list[Candidate], before: Kept) -> bool:
        """Make the claim of the ``best`` candidate, or, where that does not stand and has grown while its shape was
        polished, of it ``found`` coarsely and grown less: of a pit as narrow as its walls, columns promise what no
        polygon shows."""
        if self._stands(best, before):
            return True
        coarse = next((one for one in found if one.claim.key == best.claim.key), None)
        if coarse is None or abs(best.claim.values[0]) <= GROWN * abs(coarse.claim.values[0]):
            return False
        return self._stands(polished(self.model, self.scenes, self.linear, coarse, roughly=True, grown=GROWN), before)

    def _stands(self, one: Candidate, before: Kept) -> bool:
        """Whether the claim of a candidate was made and has left the fit better than ``before``, which is back if not:
        what was exchanged for it may have gone again, and left all worse. A pit that came to rest where it explains
        less than half of what it promises is of another shape."""
        if self.accept([one.claim]) and self.gained(before) > 2.0 * self.promised(one.claim):
            return True
        self.restore(before)
        return False

    def accept(self, claims: Sequence[Claim]) -> bool:
        """Make claims and fit everything again; whether they stand, and leave gears that can still run."""
        begun = self.kept()
        try:
            self.join(claims)
            self.settle()
            single = all(one.place.tooth is not None for one in claims)
            if single and self.model.claims != claims and self.gained(begun) < 0.0:
                return False  # neither law nor form mends what a single tooth has made worse
            if self.over:
                return False  # nobody knows what it would have been worth
            relax(self)
            self.reshape()
            if any(shows_in_laws(one) for one in claims):
                self.laws_anew()
            self.share()
            if self.over:
                return False
            self.drop_idle()
            kept = {one.key for one in claims} <= {one.key for one in self.model.claims}
            self.swap()
            self.set_back()
            self.even()
            self.forget()
        except GearpolyError:
            return False
        return kept

    def laws_anew(self) -> bool:
        """Ask again how soft teeth are, and by which law they give; whether that is another one now."""
        law = self.model.law
        self.declared_softness()
        self.declared_law()
        self.choose_law()
        return self.model.law != law

    def likely(self, found: list[Candidate], refused: set[tuple[object, ...]]) -> list[Candidate]:
        """The candidates that explain most, of several kinds, shapes polished, if they are more than chance."""
        chosen: list[Candidate] = []
        for one in found[:SHORTLIST]:
            alike = [other.claim.key for other in chosen if other.claim.physics is one.claim.physics]
            if len(alike) > 1 or one.claim.key in alike or one.claim.key in refused or not self.hopeful(one):
                continue
            chosen.append(one)
            if len(chosen) == POLISHED:
                break
        done = each(lambda one: polished(self.model, self.scenes, self.linear, one, roughly=True), chosen)
        done.sort(key=lambda one: -self.looked.worth(one))
        return [one for one in done if self.significant(one)]

    def withdraw(self) -> None:
        """Take back claims without which the rest fits hardly worse, and what was believed beside them only.

        Teeth of a grade had settled for the claim, and where unloaded ones touch had moved with it: to first order
        nothing can stand in its place, and a fit that had come to rest too early is taken for a claim. So it is beside
        a relief, whose length the claim has moved and with it the place where pairs hand over.
        """
        gone = [self._withdrawn(k) for k in reversed(range(len(self.model.claims)))]
        if any(gone):
            self.declared_law()
            self.choose_law()
            self.share()
            self.drop_idle()

    def _withdrawn(self, k: int) -> bool:
        """Whether claim ``k`` was taken back, all fitted again without it."""
        claim, begun = self.model.claims[k], self.kept()
        if self.over or not self._settled_for(claim):
            return False
        self.step(f"fitting without {claim.physics.name.replace('_', ' ')}")
        try:
            self._fit_without(k)
        except GearpolyError:
            self.restore(begun)
            return False
        few = len(claim.values)
        lost = 2.0 * few - self.gained(begun)
        if self.significant(Candidate(claim=claim, gain=lost, freedoms=few)):
            self.restore(begun)
            self.rises = self.linear, {**self._rises_here(), claim.key: lost}
            return False
        return True

    def _rises_here(self) -> dict[tuple[object, ...], float]:
        """What ``rises`` knows of the present linear system."""
        return self.rises[1] if self.rises is not None and self.rises[0] is self.linear else {}

    def rise_without(self, k: int) -> float | None:
        """By how much the misfit rises where all is fitted to its end without claim ``k``, by the present noise; None
        where to first order nothing can have come to rest for it, or gears cannot run so. The state stays."""
        claim, begun = self.model.claims[k], self.kept()
        if self.over or not self._settled_for(claim):
            return None
        if claim.key in (known := self._rises_here()):
            return known[claim.key]
        there = self.linear.system.misfit
        try:
            self._fit_without(k)
            return self.linear.under(begun[1]["noises"]).system.misfit - there
        except GearpolyError:
            return None
        finally:
            self.restore(begun)

    def _fit_without(self, k: int) -> None:
        """Fit everything to its end without claim ``k``."""
        there, noises = self.linear.system.misfit, self.noises
        self.join([], instead=[k])
        self.settle()
        relax(self)
        if self.linear.under(noises).system.misfit < there + MINIMA_APART:
            multi_start(self, enough=there)

    def _settled_for(self, claim: Claim) -> bool:
        """Whether what stands beside a claim may have come to rest in another local minimum for it."""
        graded = any(gear.graded for gear in self.model.as_built.gears)
        if graded and not all(scene.bends for scene in self.scenes):
            return claim.place.tooth is None and order_of(claim) is None and not claim.physics.slow
        if not claim.physics.mean_tooth:
            return False
        beside = [one.physics for one in self.model.claims if one is not claim]
        return (graded and claim.place.gear is not None) or any(one.mean_tooth and one.shaped for one in beside)


def shows_in_laws(claim: Claim) -> bool:
    """Whether another law of compliance may do what a claim does: what is the same at every mesh, or a mean. A single
    tooth or a wave of one is no law."""
    return claim.place.tooth is None and order_of(claim) is None
