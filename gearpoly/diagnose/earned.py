"""Which claims earn their name against causes that nobody knows; what does not is left as a place."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from gearpoly.diagnose.claimed import claimed
from gearpoly.diagnose.contest import Key, Refitted, contest, has_likenesses, others_turning
from gearpoly.diagnose.exchange import gained_since
from gearpoly.diagnose.fit import Fit, joined, number_of, settled
from gearpoly.diagnose.in_stead import curve_of_mesh, curve_of_tooth, mesh_in_stead, unknown_in_stead
from gearpoly.diagnose.judge import Judged, freer, judge
from gearpoly.diagnose.scan import Candidate
from gearpoly.diagnose.search import rise_without, withdrawn
from gearpoly.diagnose.turn_in_stead import turn_in_stead, waves_of, with_curve
from gearpoly.diagnose.unearned import Unearned
from gearpoly.diagnose.unnamed import UNCLAIMED_PROBABILITY, leaving, with_waves
from gearpoly.diagnose.weigh import by_chance_once_per_turn
from gearpoly.errors import GearpolyError
from gearpoly.infer.free_form import FREE_FORM, free_forms
from gearpoly.infer.posterior import NAMED_PROBABILITY
from gearpoly.infer.prior import kind_of, of_another_part, order_of, same_place, unknown_share
from gearpoly.infer.unknown import at_place
from gearpoly.physics.base import Claim, Scope
from gearpoly.units import FloatArray

LIKELIER = 2.0
"""Ratio of the probability of another claim to that of the one that stands, above which that one has no name. Those of
two equal gears differ by rounding; of the one wrong head that was seen it was 1e10. A judgement."""


def earned(
    search: Fit, refitted: Mapping[Key, Sequence[Refitted]]
) -> tuple[Fit, dict[Key, Judged], tuple[Unearned, ...]]:
    """Judge every claim of the ``search``, by its key, and give up those that are no likelier than an unknown cause,
    the least likely first: a curve of no cause then stands in their place, and the rest is judged anew. With the fit in
    which it does."""
    weighing = _Weighing(search=search, refitted=refitted, gone=list(search.model.unnamed))
    # With its teeth elsewhere a claim is not to be tried here.
    weighing.taken |= {one.claim.key for each in refitted.values() for one in each if one.elsewhere}
    while True:
        if weighing.search.over:
            # What was not weighed to its end has no name.
            told = weighing.beside_turns({**weighing.weighed(), **weighing.alone()})
            return weighing.search, told, (*weighing.gone, *weighing.unweighed(told))
        judged = weighing.judged()
        ways = (
            weighing.exchanged, weighing.doubted_tooth, weighing.doubted_mesh, weighing.doubted_turn, weighing.given_up,
        )  # fmt: skip
        if not any(way(judged) for way in ways):
            return weighing.search, judged, tuple(weighing.gone)


@dataclass(kw_only=True, eq=False)
class _Weighing:
    """How far the names of a ``search`` are weighed: what was ``refitted`` in the stead of each before, and ``fitted``
    since; what is ``gone``; claims that were ``taken`` for each other; ``doubts`` by a curve in the stead of a tooth's
    names; sets of names that were ``asked`` about together, of all teeth or of the waves of a shaft; each claim as
    judged ``plain``ly in the present fit."""

    search: Fit
    refitted: Mapping[Key, Sequence[Refitted]]
    gone: list[Unearned]
    taken: set[Key] = field(default_factory=set)
    doubts: dict[tuple[int, int], float] = field(default_factory=dict)
    asked: list[set[Key]] = field(default_factory=list)
    fitted: dict[Key, tuple[Refitted, ...]] = field(default_factory=dict)
    plain: dict[Key, Judged] = field(default_factory=dict)

    @property
    def named(self) -> list[Claim]:
        """The claims that have a name so far."""
        left = {one.claim.key for one in self.gone}
        return [one for one in self.search.model.claims if one.physics is not FREE_FORM and one.key not in left]

    def weighed(self) -> dict[Key, Judged]:
        """The claims that have a name where time ended after all of them were judged: each as likely as its name needs,
        none likelier in its place, what is like it fitted in its stead, and of a tooth a curve of no cause."""
        if any(claim.key not in self.plain for claim in self.named):
            return {}
        asked = [one for one in self.named if one.place.tooth is None or _tooth(one) in self.doubts]
        asked = [one for one in asked if not has_likenesses(one) or one.key in {*self.refitted, *self.fitted}]
        if sum(one.physics.mean_tooth for one in asked) > 1:  # what one curve would do for both is not known
            asked = [one for one in asked if not one.physics.mean_tooth]
        judged = {one.key: _doubted(one, self.plain[one.key], self.doubts.get(_tooth(one))) for one in asked}
        sure = {key: one for key, one in judged.items() if one.posterior.named}
        return {key: one for key, one in sure.items() if _likelier(self.search, {key: one}, set()) is None}

    def alone(self) -> dict[Key, Judged]:
        """The waves of whole orders that have earned their name where time is over: nothing has to be fitted to its end
        to weigh them, and what is left of other places makes none."""
        found: dict[Key, Judged] = {}
        lower: list[Unearned] = []
        waves = [one for one in self.named if kind_of(one) == "wave" and not one.physics.once_per_turn]
        for claim in sorted(waves, key=lambda one: order_of(one) or 0):
            self._know([*self.gone, *lower], [claim])
            k = number_of(self.search, claim)
            judged = self.plain[claim.key] = self.plain.get(claim.key) or self._judge(k, without=None)
            if judged.posterior.named and not _contradicted(self.search, {claim.key: judged}, claim):
                found[claim.key] = judged
            else:
                lower.append(Unearned(claim=claim, rms=0.0, posterior=judged.posterior))
        return found

    def _know(self, gone: Sequence[Unearned], named: Sequence[Claim]) -> None:
        """Know the set beside the waves that are ``gone``; what was judged of ``named`` claims by other shares of
        unknown causes is judged anew."""
        search, scope = self.search, _beside_unknown(self.search, gone)
        for one in named:
            if unknown_share(one, scope) != unknown_share(one, search.model.scope):
                self.plain.pop(one.key, None)
        if scope != search.model.scope:
            self.search = search.believing(scope=scope)

    def beside_turns(self, told: Mapping[Key, Judged]) -> dict[Key, Judged]:
        """Those of the claims ``told`` that no curve over the turn of a shaft is likelier than."""
        stay = dict(told)
        for gear in (0, 1):
            claims = waves_of(self.search, [one for one in self.named if one.key in told], gear)
            if claims and turn_in_stead(self.search, claims, gear).unknown > 1.0 - NAMED_PROBABILITY:
                stay = {key: one for key, one in stay.items() if all(key != claim.key for claim in claims)}
        return stay

    def unweighed(self, told: Collection[Key]) -> Iterator[Unearned]:
        """The places of all claims but those ``told``: nobody weighed to their end how likely they are."""
        for claim in self.named:
            if claim.key in told:
                continue
            judged, rms = self.plain.get(claim.key), self.search.model.rms_of(self.search.scenes, claim)
            yield Unearned(claim=claim, rms=rms, posterior=None if judged is None else judged.posterior)

    def judged(self) -> dict[Key, Judged]:
        """Every claim that has a name, beside what turns with its shaft by now."""
        self._know(self.gone, self.named)
        search, named = self.search, self.named
        if any(claim.key not in self.plain for claim in named):
            search.step("weighing names against unknown causes")
        for claim in named:
            if order_of(claim) == 1 and claim.key not in self.fitted:
                self.fitted[claim.key] = others_turning(search, claim)
        for k, claim in enumerate(search.model.claims):
            if claim in named and claim.key not in self.plain:
                self.plain[claim.key] = self._judge(k, without=rise_without(search, k))
        return {claim.key: _doubted(claim, self.plain[claim.key], self.doubts.get(_tooth(claim))) for claim in named}

    def exchanged(self, judged: Mapping[Key, Judged]) -> bool:
        """Whether another claim was tried that is likelier in the place of one that stands; no claim twice."""
        search = self.search
        if (better := _likelier(search, judged, self.taken)) is None:
            return False
        stands, claim = better
        self.taken |= {stands.key, claim.key}
        there = _exchanged(search, stands, [claim])
        if there is None:
            return True
        gained = gained_since(there, search)
        if gained < freer(claim, stands, self.plain[stands.key].gain):
            # Fitted to its end it fits none the better, as no straight line said: it may still be likelier beforehand.
            self._remember(stands, Refitted(claim=claim, behind=-gained))
            k = number_of(search, stands)
            anew = self.plain[stands.key] = self._judge(k, without=rise_without(search, k))
            if anew.posterior.of(claim) <= anew.posterior.of(stands):
                return True
        gain = self.plain[stands.key].gain
        self.plain.clear()
        beside = _with_both(there, stands, claim, gain=gain)
        self.search = there if beside is None else beside
        if beside is None:
            # Nor is the one that stood there forgotten: about the other no straight line leads back to it.
            self._remember(claim, Refitted(claim=stands, behind=gained))
        if claim.physics.mean_tooth:
            # Nobody has asked yet what else may stand where this one does now.
            self.search, self.refitted = contest(self.search)
        if beside is None:
            # What was believed beside the one may have no place beside the other.
            self.search = withdrawn(self.search)
        return True

    def _judge(self, k: int, *, without: float | None) -> Judged:
        search, claim = self.search, self.search.model.claims[k]
        return judge(
            search.model, search.scenes, search.linear, k,
            refitted=self._in_the_stead(claim), places=search.looked.own.get(claim.physics.name, 1),
            without=without, gone={one.claim.key for one in self.gone}, deflection=search.deflection,
            by_chance=by_chance_once_per_turn(search, claim),
        )  # fmt: skip

    def _in_the_stead(self, claim: Claim) -> tuple[Refitted, ...]:
        """What was fitted in the stead of a claim, but for what stands beside it now."""
        there = {one.key for one in self.search.model.claims}
        both = (*self.refitted.get(claim.key, ()), *self.fitted.get(claim.key, ()))
        return tuple(one for one in both if one.claim.key not in there)

    def _remember(self, stands: Claim, other: Refitted) -> None:
        self.fitted[stands.key] = (*self.fitted.get(stands.key, ()), other)

    def doubted_tooth(self, judged: Mapping[Key, Judged]) -> bool:
        """Whether a curve of no cause was fitted in the stead of a tooth's names, which give way where it may be."""
        search, named = self.search, self.named
        asked = (_tooth(one) for one in named if one.place.tooth is not None)
        tooth = next((one for one in asked if one not in self.doubts), None)
        if tooth is None:
            return False
        search.step("fitting a curve of no cause in the stead of a tooth's names")
        self.doubts[tooth] = unknown_in_stead(search, *tooth)
        if self.doubts[tooth] > 1.0 - NAMED_PROBABILITY:
            mine = [claim for claim in named if _tooth(claim) == tooth]
            self._leave(*((claim, _doubted(claim, judged[claim.key], self.doubts[tooth])) for claim in mine))
            self.search = curve_of_tooth(search, mine)
        return True

    def doubted_mesh(self, judged: Mapping[Key, Judged]) -> bool:
        """Whether several names of all teeth gave way to a curve of no cause at every mesh."""
        search = self.search
        of_all = [claim for claim in self.named if claim.physics.mean_tooth and claim.place.gear is not None]
        keys: set[Key] = {one.key for one in of_all}
        if len(of_all) < 2 or keys in self.asked:
            return False
        search.step("fitting a curve of no cause at every mesh in the stead of all its names")
        self.asked.append(keys)
        doubt = mesh_in_stead(search, of_all)
        if doubt <= 1.0 - NAMED_PROBABILITY:
            return False
        self._leave(*((claim, _doubted(claim, judged[claim.key], doubt)) for claim in of_all))
        self.search = curve_of_mesh(search, of_all)
        return True

    def doubted_turn(self, judged: Mapping[Key, Judged]) -> bool:
        """Whether the names of a shaft's waves gave way to a curve of no cause over its turn."""
        for gear in (0, 1):
            claims = waves_of(self.search, self.named, gear)
            keys: set[Key] = {one.key for one in claims}
            if not claims or keys in self.asked:
                continue
            self.search.step("weighing a curve of no cause over the turn of a shaft")
            self.asked.append(keys)
            turn = turn_in_stead(self.search, claims, gear)
            if turn.unknown > 1.0 - NAMED_PROBABILITY:
                self._leave(*((claim, _doubted(claim, judged[claim.key], turn.unknown)) for claim in claims))
                self.search = with_curve(self.search, claims, turn)
                return True
        return False

    def given_up(self, judged: Mapping[Key, Judged]) -> bool:
        """Whether the least likely claim that has not earned its name was given up."""
        search = self.search
        least = max(
            (one for one in self.named if not judged[one.key].posterior.named or _contradicted(search, judged, one)),
            key=lambda claim: judged[claim.key].posterior.unknown + judged[claim.key].posterior.nothing,
            default=None,
        )
        if least is None:
            return False
        posterior = judged[least.key].posterior
        effect = search.model.change(search.scenes, least, least.values, but=least)
        self._leave((least, judged[least.key]))
        nothing = least.physics.mean_tooth and posterior.nothing > posterior.unknown
        without = _exchanged(search, least, []) if nothing else None
        if without is None:
            self.search = _unnamed(search, least, effect)
        else:
            # Nothing stands in its place, so what the others are is asked anew.
            (self.search, self.refitted), self.fitted = contest(without), {}
        return True

    def _leave(self, *these: tuple[Claim, Judged]) -> None:
        """Let go of these names; the rest is judged anew."""
        model, scenes = self.search.model, self.search.scenes
        self.gone += [
            Unearned(claim=claim, rms=model.rms_of(scenes, claim), posterior=judged.posterior)
            for claim, judged in these
        ]
        self.plain.clear()


def _beside_unknown(search: Fit, gone: Sequence[Unearned]) -> Scope:
    """What is known of the set beside waves that are likelier of no cause of the catalogue than of any: another part
    that turns with a shaft may be off its axis as well, and such a wave has harmonics."""
    scope = search.model.scope
    seen = [one.claim for one in gone if one.posterior is not None and one.posterior.unknown > UNCLAIMED_PROBABILITY]
    others = [claim.place.gear or 0 for claim in seen if of_another_part(claim, scope)]
    waves = {(claim.place.gear or 0, order_of(claim) or 0) for claim in seen if kind_of(claim) == "wave"}
    above = tuple(sorted(one for one in waves if one[1] > 1))
    return replace(scope, others_turn=(0 in others, 1 in others), unknown_waves=above)


def _tooth(claim: Claim) -> tuple[int, int]:
    """Gear and tooth that a claim is about, -1 where it is about no single tooth."""
    return (-1, -1) if claim.place.tooth is None else (claim.place.gear or 0, claim.place.tooth)


def _doubted(claim: Claim, judged: Judged, unknown: float | None) -> Judged:
    """The same where a curve of no cause was fitted to its end in the stead of all names of a tooth: it may do what no
    column tells of it. Whichever leaves the ``claim`` less counts. A curve that is fitted to its end may come to rest
    too early: one did beside 20 +- 150 um of a spall as narrow as its walls, which columns had called unknown (0.85);
    of 25 true names columns called none (at most 0.003). Nor can one curve of a flank do under every torque what a
    tooth does that gives more."""
    if unknown is None:
        return judged
    return replace(
        judged, posterior=judged.posterior.with_unknown(max(unknown, judged.in_vain, judged.posterior.unknown))
    )


def _likelier(search: Fit, judged: Mapping[Key, Judged], taken: set[Key]) -> tuple[Claim, Claim] | None:
    """A claim that stands, and one that is likelier in its place; no claim twice."""
    beside = {other.key for other in search.model.claims}
    for stands in search.model.claims:
        if stands.key not in judged:
            continue
        posterior = judged[stands.key].posterior
        claim, chance = posterior.claims[0]
        if claim.key not in beside | taken and stands.key not in taken and chance > posterior.of(stands):
            return stands, claim
    return None


def _contradicted(search: Fit, judged: Mapping[Key, Judged], claim: Claim) -> bool:
    """Whether another claim is clearly likelier than the one that stands, though it stood there already and this one
    was likelier then: neither has the name."""
    better, posterior = _likelier(search, {claim.key: judged[claim.key]}, set()), judged[claim.key].posterior
    return better is not None and posterior.of(better[1]) > LIKELIER * posterior.of(claim)


def _exchanged(search: Fit, stands: Claim, claims: Sequence[Claim]) -> Fit | None:
    """With ``claims`` in the place of the one that ``stands``; None where gears cannot run so."""
    try:
        return settled(joined(search, claims, instead=[number_of(search, stands)]))
    except GearpolyError:
        return None


def _with_both(search: Fit, stood: Claim, claim: Claim, *, gain: float) -> Fit | None:
    """With what ``stood`` in the place of a ``claim`` beside it too, if it is worth its name there: of another place,
    it may be there as well. For a wave of another wheel, once per turn, a tooth 32 um proud of the mate had lost its
    name."""
    if same_place(stood, claim):
        return None
    search.step(f"fitting {stood.physics.name.replace('_', ' ')} beside it")
    return claimed(search, Candidate(claim=stood, gain=gain, freedoms=len(stood.values)), [])


def _unnamed(search: Fit, claim: Claim, effect: Sequence[FloatArray]) -> Fit:
    """With a curve of no cause in the place of a ``claim``, which has this ``effect`` (n_k,) in mm, everything fitted
    again. Where gears cannot run without it, it stays in the fit, and has no name either."""
    forms = free_forms(claim, search.scenes)
    there = _exchanged(search, claim, forms) if forms else None
    if there is not None:
        return there
    curve = at_place(claim, search.scenes, order=order_of(claim), effect=effect)
    try:
        bare = joined(search, [], instead=[number_of(search, claim)])
        if order_of(claim) is not None:
            return with_waves(bare, curve.columns, curve.by_order)
        return settled(leaving(bare, curve.columns, slow=claim.physics.slow))
    except GearpolyError:
        return search
