"""Claims about waves of one shaft against a curve of no cause over its turn.

What steps or strikes once per turn makes many waves at once, and each looks like one of the teeth: a key with play
makes the orders 1, 3, 5 and so on of a square wave. One by one they are weighed against a wave of no cause each, and
the others stand beside.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearpoly.diagnose.fit import Fit, joined, number_of, without_waves
from gearpoly.diagnose.in_stead import chance_of_unknown
from gearpoly.diagnose.trial import claim_std, ordinary_rms, scaled_of
from gearpoly.diagnose.unnamed import with_waves
from gearpoly.errors import GearpolyError
from gearpoly.infer.evidence import log_mean
from gearpoly.infer.posterior import Sized
from gearpoly.infer.prior import kind_of, order_of, unknown_share
from gearpoly.infer.unknown import Unknown, rms, turn_curves, turn_orders
from gearpoly.physics.base import Claim
from gearpoly.units import FloatArray

OF_THE_CURVE = 0.9
"""Part of the power of a wave without a name that a curve over the turn holds, from which on it is of that curve: one
of another shaft or of no whole order shares little with it. A judgement, not tuned."""


def waves_of(search: Fit, claims: Sequence[Claim], gear: int) -> list[Claim]:
    """Those of the ``claims`` that are waves of a shaft which a curve over its turn could make."""
    most = turn_orders(search.model.scope.gears[gear].z)
    return [
        one
        for one in claims
        if kind_of(one) == "wave" and (one.place.gear or 0) == gear and (order_of(one) or 0) <= most
    ]


@dataclass(frozen=True, kw_only=True, eq=False)
class Turn:
    """Probability of an ``unknown`` cause over the turn of a shaft, its likeliest ``curve``, and the ``waves`` without
    a name that are of it, each by its foreign columns."""

    unknown: float
    curve: Unknown
    waves: list[tuple[int, ...]]


def turn_in_stead(search: Fit, claims: Sequence[Claim], gear: int) -> Turn:
    """How likely a curve of no cause over the turn of a shaft, and none of these ``claims`` about its waves, is what is
    seen, to first order; waves without a name that are of that curve give way to it with the claims."""
    linear, model = search.linear, search.model
    dispersion = max(1.0, linear.system.whiteness)
    size = max(_ordinary(search, one) for one in claims)
    drawn = turn_curves(search.scenes, gear)
    curves = [_curve(search, one, size=size) for one in drawn]
    at = [linear.layout.places(number_of(search, one)) for one in claims]
    of_curve = _waves_of_curve(search, curves[0].columns)
    waves = [_parameters(search, one) for one in of_curve]
    bare = there = linear.system.without([place for one in (*at, *waves) for place in one])
    named = 0.0
    for places, std, scaled in (
        *(
            (places, np.array(claim_std(model, claim)), scaled_of(claim))
            for places, claim in zip(at, claims, strict=True)
        ),
        *((places, np.full(len(places), math.sqrt(2.0 / len(places)) * size), len(places)) for places in waves),
    ):
        one = Sized(columns=[mine.part(places) for mine in linear.system.white], std=std, scaled=scaled)
        named += one.log_evidence(there.scores, dispersion=dispersion)
        there = there.with_columns(one.columns)
    logs = [one.log_evidence(bare.scores, dispersion=dispersion) for one in curves]
    unknown = log_mean(logs, weights=np.array([one.weight for one in drawn]))
    share = max(unknown_share(one, model.scope) for one in claims)
    return Turn(
        unknown=chance_of_unknown(unknown - named, share),
        curve=drawn[int(np.argmax(logs))],
        waves=of_curve,
    )


def with_curve(search: Fit, claims: Sequence[Claim], turn: Turn) -> Fit:
    """With the curve of a ``turn`` in the place of ``claims``, and of the waves that are of it, everything fitted
    again. Where gears cannot run without the claims, they stay in the fit, and have no name either."""
    bare = without_waves(joined(search, [], instead=[number_of(search, one) for one in claims]), turn.waves)
    # What stands in the fit already is no part of the curve: of two that are the same the fit tells neither.
    basis = np.linalg.qr(np.concatenate(bare.foreign))[0]
    new = [k for k, column in enumerate(np.concatenate(turn.curve.columns).T) if not _held(column[:, None], basis)]
    orders = [[new.index(k) for k in order if k in new] for order in turn.curve.by_order]
    try:
        return with_waves(bare, [one[:, new] for one in turn.curve.columns], [one for one in orders if one])
    except GearpolyError:
        return search


def _curve(search: Fit, one: Unknown, *, size: float) -> Sized:
    """A curve of which an ordinary one has the rms ``size`` in mm."""
    white = [noise.whitened(part) for noise, part in zip(search.noises, one.columns, strict=True)]
    return Sized(columns=white, std=one.std * (size / rms(one.columns, one.std)), scaled=one.std.size)


def _waves_of_curve(search: Fit, curve: Sequence[FloatArray]) -> list[tuple[int, ...]]:
    """The waves without a name that a white ``curve`` (n_k, p) holds, each by its foreign columns."""
    basis, white = np.linalg.qr(np.concatenate(curve))[0], search.linear.system.white
    waves = [(one, _parameters(search, one)) for one in search.model.strangers]
    return [one for one, at in waves if _held(np.concatenate([mine.part(at) for mine in white]), basis)]


def _parameters(search: Fit, wave: Sequence[int]) -> list[int]:
    """Parameters of a wave by its foreign columns."""
    return [search.linear.layout.foreign.start + column for column in wave]


def _held(wave: FloatArray, basis: FloatArray) -> bool:
    """Whether an orthonormal ``basis`` (n, p) holds a ``wave`` (n, q)."""
    return float(np.sum((basis.T @ wave) ** 2)) > OF_THE_CURVE * float(np.sum(wave**2))


def _ordinary(search: Fit, claim: Claim) -> float:
    """Rms in mm that an ordinary fault of a claim's kind has."""
    model, k = search.model, number_of(search, claim)
    columns = [one.part(search.linear.layout.claims[k]) for one in search.linear.columns]
    return ordinary_rms(model, claim, columns, model.change(search.scenes, claim, claim.values, but=claim))
