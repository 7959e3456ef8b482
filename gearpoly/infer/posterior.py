"""How probable each explanation of one place is: a physics, an unknown cause, or nothing at all."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from gearpoly.infer.evidence import log_bayes_factor, log_mean, log_truncated, normalised, posterior
from gearpoly.infer.prior import PRESENT, SCALE_WEIGHTS, SCALES
from gearpoly.physics.base import Claim
from gearpoly.units import FloatArray

NAMED_PROBABILITY = 0.95
"""Probability that a physics and its look-alikes have to have together for a place to be given their name."""

WORTH_A_WORD_PROBABILITY = 0.01
"""Probability below which an explanation is not worth a word."""

Beside = Callable[[list[FloatArray]], tuple[FloatArray, FloatArray]]
"""Score (q,) and information (q, q) of white columns (n_k, q) beside all that is believed of other places."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sized:
    """White columns (n_k, q) of an explanation, of which the first ``scaled`` have sizes that nobody knows to a power
    of two: their standard deviations are ``std`` times each of the scales; the others have theirs. ``bounds`` of the
    first, where it is the only one that is scaled."""

    columns: list[FloatArray]
    std: FloatArray
    scaled: int
    bounds: tuple[float, float] = (-math.inf, math.inf)

    def log_evidence(self, beside: Beside, *, dispersion: float = 1.0) -> float:
        """Log evidence over that of nothing, averaged over the scales; ``dispersion``, the mean square of what is left
        where that is more than noise, divides all that the data say."""
        score, information = beside(self.columns)
        score, information = score / dispersion, information / dispersion
        logs = []
        for scale in SCALES:
            std = self.std.copy()
            std[: self.scaled] *= scale
            log = log_bayes_factor(score, information, std=std)
            if self.scaled == 1 and any(map(math.isfinite, self.bounds)):
                mean, covariance = posterior(score, information, std=std)
                width = math.sqrt(max(float(covariance[0, 0]), 1e-300))
                log += log_truncated(float(mean[0]), width, prior=float(std[0]), bounds=self.bounds)
            logs.append(log)
        return log_mean(logs, weights=SCALE_WEIGHTS)


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """A ``claim``, or a cause that nobody knows (None), with its log evidence over nothing and the ``weight`` that it
    has beforehand among those of its kind: named causes add up to 1, unknown ones too."""

    claim: Claim | None
    log_evidence: float
    weight: float


@dataclass(frozen=True, kw_only=True)
class Posterior:
    """Probabilities at one place: of each ``claims``, of an ``unknown`` cause and of ``nothing``; they add up to 1."""

    claims: tuple[tuple[Claim, float], ...]
    unknown: float
    nothing: float

    @property
    def named(self) -> bool:
        """Whether the place may be given a name."""
        return self.unknown + self.nothing <= 1.0 - NAMED_PROBABILITY

    @property
    def told(self) -> tuple[tuple[Claim, float], ...]:
        """The claims that are worth a word, the likeliest first."""
        return tuple(one for one in self.claims if one[1] >= WORTH_A_WORD_PROBABILITY)

    @property
    def causes(self) -> tuple[tuple[Claim, float], ...]:
        """The physics that are worth a word, the likeliest first: claims of one physics of one gear, be it about the
        next tooth or one flank alone, add up, and the likeliest stands for all."""
        first: dict[tuple[str, int | None], Claim] = {}
        chances: dict[tuple[str, int | None], float] = {}
        for claim, chance in sorted(self.claims, key=lambda one: -one[1]):
            what = claim.physics.name, claim.place.gear
            first.setdefault(what, claim)
            chances[what] = chances.get(what, 0.0) + chance
        each = sorted(chances, key=lambda what: -chances[what])
        return tuple((first[what], chances[what]) for what in each if chances[what] >= WORTH_A_WORD_PROBABILITY)

    def with_unknown(self, unknown: float) -> Posterior:
        """The same where an unknown cause has this probability, and all else shares the rest as before."""
        known = sum(chance for _, chance in self.claims) + self.nothing
        rest = (1.0 - unknown) / known if known > 0.0 else 0.0
        claims = tuple((claim, rest * chance) for claim, chance in self.claims)
        return Posterior(claims=claims, unknown=unknown, nothing=rest * self.nothing)

    def of(self, claim: Claim) -> float:
        """Probability of a claim; 0 where it was not among the explanations."""
        return sum(chance for one, chance in self.claims if one.key == claim.key)


def weighed(explanations: Sequence[Explanation], *, unknown_share: float, places: int) -> Posterior:
    """The probabilities of ``explanations`` of one place of so many of its kind, of which this share of causes is
    unknown."""
    present = math.log(PRESENT / max(1, places))
    logs = [0.0]
    for one in explanations:
        share = unknown_share if one.claim is None else 1.0 - unknown_share
        logs.append(one.log_evidence + present + math.log(share * one.weight))
    chances = normalised(logs)
    each = sorted(
        ((one.claim, float(p)) for one, p in zip(explanations, chances[1:], strict=True) if one.claim is not None),
        key=lambda pair: -pair[1],
    )
    unknown = sum(float(p) for one, p in zip(explanations, chances[1:], strict=True) if one.claim is None)
    return Posterior(claims=tuple(each), unknown=unknown, nothing=float(chances[0]))
