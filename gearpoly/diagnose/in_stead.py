"""Claims about one tooth against a curve of its flank, and several about all teeth against a curve of every mesh, each
fitted to its end.

Where teeth lose touch over a deviation, no column tells what else would do the same; and of two reliefs each looks
needed beside the other, where both together make one wave that another part of the drive has made.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import expit, log_ndtr, logit

from gearpoly.diagnose.fit import Fit, joined, number_of, settled
from gearpoly.diagnose.least import runs_alike
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.trial import claim_std
from gearpoly.diagnose.unnamed import leaving
from gearpoly.errors import GearpolyError
from gearpoly.infer.evidence import log_mean
from gearpoly.infer.free_form import FREE_FORM, curve_covariance, free_forms
from gearpoly.infer.prior import ONE_TOOTH, SCALE_WEIGHTS, SCALES, unknown_share
from gearpoly.infer.unknown import mesh_curves, mesh_std
from gearpoly.physics.base import Claim
from gearpoly.units import UM, BoolArray, FloatArray

LEAST_TOLD_SIGMAS = 30.0
"""Standard deviations, beforehand, to which a place of a curve has to be told at least, or the recordings say nothing
of it: a tenth of a mm on teeth that are drawn to um. Of two curves it was 10 000 where teeth had lost touch, and 2.6 at
most elsewhere."""

LEANS = 100.0
"""um, one standard deviation, by which such a tooth may stand and lean at most: more than any that still meshes."""

HALVINGS_TO_LEAST = 4
"""Halvings of the way to the least of a value that nothing tells: to a sixteenth of it."""


def unknown_in_stead(search: Fit, gear: int, tooth: int) -> float:
    """Probability that a curve of no cause, or a tooth that stands and leans as nothing said, and none of the claims
    about it, is what a tooth has: all of them taken away, each fitted in their stead through the exact simulation, and
    the states compared by Laplace about their fits. 0 where gears cannot run so."""
    mine = [one for one in search.model.claims if _is_at(one, gear, tooth)]
    dispersion = max(1.0, search.linear.system.whiteness)
    named = _mean([_as_drawn(search, mine, dispersion), _of_other_form(search, mine, dispersion)])
    ways = [_of_curve(search, mine, dispersion)]
    if any(one.shapes_tooth for one in mine):  # what stands off its place as a whole is told so, leaning or not
        ways.append(_of_lean(search, mine, dispersion))
    unknown = _mean(ways)
    return chance_of_unknown(unknown - named, ONE_TOOTH)


def _mean(logs: Sequence[float]) -> float:
    """Log evidence of ways that are as likely as each other."""
    return log_mean(logs, weights=np.full(len(logs), 1.0 / len(logs)))


def _as_drawn(search: Fit, claims: Sequence[Claim], dispersion: float) -> float:
    """Log evidence of ``claims`` about a tooth that are of no other form than is drawn."""
    linear = search.linear
    drawn = replace(linear, system=linear.system.fixed_at_zero(_forms(search, claims)))
    return _log_evidence(search, drawn, claims, dispersion)


def _of_other_form(search: Fit, claims: Sequence[Claim], dispersion: float) -> float:
    """Log evidence of ``claims`` about a tooth whose form may be another in part: what it takes of the misfit pays for
    how finely the data tell it. Without that 12 um that a tooth leant were a pit at 99 in 100, its form 15 of misfit
    ahead."""
    system = search.linear.system
    log = _log_evidence(search, search.linear, claims, dispersion)
    at = _forms(search, claims)
    if not at:
        return log
    leave = [place for one in claims for place in search.linear.layout.places(number_of(search, one))]
    bare = system.without(leave)
    block = np.ix_(*2 * [[place - sum(one < place for one in leave) for place in at]])
    known = bare.precision[block]
    told = known + (np.linalg.inv(bare.covariance[block]) - known) / dispersion
    return log - 0.5 * float(np.linalg.slogdet(told)[1] - np.linalg.slogdet(known)[1])


def _forms(search: Fit, claims: Sequence[Claim]) -> list[int]:
    """Parameters of the freedom of form of ``claims``."""
    return [place for one in claims for place in search.linear.layout.form_places(search.model, number_of(search, one))]


def _of_curve(search: Fit, claims: Sequence[Claim], dispersion: float) -> float:
    """Log evidence of a curve of the flanks in the place of all ``claims`` about a tooth."""
    place = claims[0].place
    try:
        there = curve_of_tooth(search, claims)
    except GearpolyError:
        return -math.inf
    curves = [
        one for one in there.model.claims
        if one.physics is FREE_FORM and _is_at(one, place.gear or 0, place.tooth or 0)
    ]  # fmt: skip
    return _log_evidence(there, there.linear.under(search.noises), curves, dispersion)


def _of_lean(search: Fit, claims: Sequence[Claim], dispersion: float) -> float:
    """Log evidence of a tooth that stands and leans otherwise than its sheet or its grade says, on each flank, in the
    place of all ``claims`` about it. Of 12 um that one flank leant a pit was made, its wall 0.8 mm wide, up to the
    tip."""
    place, built = claims[0].place, search.model.as_built
    flanks = [flank for flank in built.flanks if place.flank in (None, flank)]
    at = np.concatenate([built.at_tooth(flank, place.gear or 0, place.tooth or 0) for flank in flanks])
    bare = search.believing(as_built=built.opened(at, LEANS))
    try:
        there = settled(joined(bare, [], instead=[number_of(search, one) for one in claims]))
    except GearpolyError:
        return -math.inf
    linear = there.linear.under(search.noises)
    places = linear.layout.built.start + at
    told = dispersion * linear.system.covariance[np.ix_(places, places)]
    ordinary = FREE_FORM.ordinary[0] ** 2 * np.eye(at.size)
    values = linear.system.solution[places]
    # What these teeth were known to before is in the evidence of the names as well.
    before = 0.5 * (np.linalg.slogdet(built.known(at) + told)[1] - np.linalg.slogdet(told)[1])
    return -0.5 * linear.system.misfit / dispersion + _of_values(values, told, ordinary, at.size) + float(before)


def mesh_in_stead(search: Fit, claims: Sequence[Claim]) -> float:
    """Probability that a curve of no cause at every mesh, one for each condition, and none of these ``claims`` about
    all teeth, is what is seen. 0 where gears cannot run without them."""
    dispersion = max(1.0, search.linear.system.whiteness)
    named = _log_evidence(search, search.linear, claims, dispersion)
    share = unknown_share(claims[0], search.model.scope)
    try:
        there = curve_of_mesh(search, claims)
    except GearpolyError:
        return 0.0
    linear = there.linear.under(search.noises)
    first, many = linear.layout.foreign.start, there.foreign[0].shape[1] - search.foreign[0].shape[1]
    at = slice(first, first + many)
    told = dispersion * linear.system.covariance[at, at]
    each = np.tile(mesh_std(), many // mesh_std().size) * max(one.physics.ordinary[0] for one in claims) * UM
    values = linear.system.solution[at]
    unknown = -0.5 * linear.system.misfit / dispersion + _of_values(values, told, np.diag(each**2), many)
    return chance_of_unknown(unknown - named, share)


def chance_of_unknown(log_bayes_factor: float, share: float) -> float:
    """Probability of an unknown cause that is so much likelier than the names, of which beforehand it is this share."""
    return float(expit(log_bayes_factor + logit(share)))


def curve_of_mesh(search: Fit, claims: Sequence[Claim]) -> Fit:
    """With a curve of no cause at every mesh in the place of all ``claims``, everything fitted again; its columns are
    the first that no pair makes. Raises ``GearpolyError`` where gears cannot run so."""
    curve = mesh_curves(search.scenes)[-1].columns
    return settled(leaving(joined(search, [], instead=[number_of(search, one) for one in claims]), curve))


def curve_of_tooth(search: Fit, claims: Sequence[Claim]) -> Fit:
    """With a curve of its flanks in the place of all ``claims`` about one tooth, everything fitted again. Raises
    ``GearpolyError`` where gears cannot run so."""
    curves = free_forms(claims[0], search.scenes)
    return settled(joined(search, curves, instead=[number_of(search, one) for one in claims]))


def _is_at(claim: Claim, gear: int, tooth: int) -> bool:
    return (claim.place.gear, claim.place.tooth) == (gear, tooth)


def _log_evidence(search: Fit, linear: Linear, claims: Sequence[Claim], dispersion: float) -> float:
    """Log evidence of a fit with these claims, but for a constant: what is left, how far the values of the claims are
    from what was believed of them, and how finely the data tell them."""
    total = -0.5 * linear.system.misfit / dispersion
    for claim in claims:
        k = number_of(search, claim)
        at = linear.layout.claims[k]
        a = claim.physics.amplitudes
        # Where gears could not go all the way, the misfit is that of the straight line's end: so are its values.
        values = np.array(linear.system.solution[at])
        values[a:] = 0.0
        told, prior = dispersion * linear.system.covariance[at, at], _prior(search, claim)
        apart = np.diag(told) > LEAST_TOLD_SIGMAS**2 * np.diag(prior)
        if claim.physics is FREE_FORM and apart.any():
            values[apart] = _least_apart(search, claim, apart)[apart]
            total += _of_values(values, told, prior, a, apart=apart)
        else:
            total += _of_values(values, told, prior, a)
    return total


def _least_apart(search: Fit, claim: Claim, apart: BoolArray) -> FloatArray:
    """Values (q,) of a curve that stand nearest to what the others make likely where the recordings tell nothing of
    them, ``apart`` (q,), and teeth run as they do with those of the ``claim``: once teeth have lost touch there, a fit
    leaves a value wherever the last step took it."""
    values, k = np.array(claim.values), number_of(search, claim)
    likely = values.copy()
    rest, prior = ~apart, _prior(search, claim)
    likely[apart] = values[rest] @ np.linalg.solve(prior[np.ix_(rest, rest)], prior[np.ix_(rest, apart)])

    def alike(tried: FloatArray) -> bool:
        claims = list(search.model.claims)
        claims[k] = replace(claim, values=tuple(tried.tolist()))
        return runs_alike(search, claims)

    edges = np.flatnonzero(np.diff(np.concatenate(([0], apart.astype(int), [0]))))
    for first, end in edges.reshape(-1, 2).tolist():
        here = slice(first, end)
        near, far = likely[here], values[here].copy()
        values[here] = near
        if alike(values):
            continue
        low, high = 0.0, 1.0  # parts of the way to where the fit left them
        for _ in range(HALVINGS_TO_LEAST):
            values[here] = near + 0.5 * (low + high) * (far - near)
            low, high = (low, 0.5 * (low + high)) if alike(values) else (0.5 * (low + high), high)
        values[here] = near + high * (far - near)
    return values


def _prior(search: Fit, claim: Claim) -> FloatArray:
    """Covariance (q, q) of the values of a claim of ordinary size."""
    if claim.physics is FREE_FORM:
        return curve_covariance()
    return np.diag(np.array(claim_std(search.model, claim)) ** 2)


def _of_values(
    values: FloatArray, told: FloatArray, prior: FloatArray, amplitudes: int, *, apart: BoolArray | None = None
) -> float:
    """Log of the mean of the likelihood over the prior of values (q,), over its largest; told to a covariance (q, q):
    N(values; 0, prior + told) / N(0; 0, told), averaged over the scales of the amplitudes. Those that stand ``apart``
    (q,) are told to be beyond their values only: by the part of the prior that lies there, the others being what they
    are."""
    logs, seen = [], np.ones(values.size, dtype=np.bool_) if apart is None else ~apart
    mine, told = values[seen], told[np.ix_(seen, seen)]
    for scale in SCALES:
        by = np.ones(values.size)
        by[:amplitudes] = scale
        known = by[:, None] * prior * by
        whole = known[np.ix_(seen, seen)] + told
        spread = np.linalg.slogdet(whole)[1] - np.linalg.slogdet(told)[1]
        log = -0.5 * float(mine @ np.linalg.solve(whole, mine)) - 0.5 * float(spread)
        if apart is not None:
            cross = np.linalg.solve(known[np.ix_(seen, seen)], known[np.ix_(seen, apart)])
            off = values[apart] - mine @ cross
            left = known[np.ix_(apart, apart)] - known[np.ix_(apart, seen)] @ cross
            # Where they are what the others make likely, nothing is asked of them.
            log += float(log_ndtr(-math.sqrt(float(off @ np.linalg.solve(left, off))))) if np.any(off) else 0.0
        logs.append(log)
    return log_mean(logs, weights=SCALE_WEIGHTS)
