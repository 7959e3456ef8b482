"""How far the teeth of a gear deviate beside what its grade says, and what a claim about them then counts: many gears
are finer than the grade that they keep, and of some nobody states one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.special import gammaincc

from gearpoly.diagnose.as_built import GearPrior, make_as_built
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model
from gearpoly.keys.edit import gear_section
from gearpoly.physics.base import Claim

COARSEST = 16.0
"""Limits of the coarsest teeth that are thought of, over those of grade 5: those of grade 13, which nothing but a
printed gear has. It only has to be wide; four times as much, and some fits end in a worse minimum."""

USUAL = 2.0
"""The same of teeth that are usual, those of grade 7. Begun as softly as the coarsest would ask for, fits of ten
printed pairs left up to 7 times as much as with the exact touch alone; by these limits they left 0.46 to 1.07 of it."""

WORTH_COUNTING = 8.0
"""Gain in misfit from which on it is asked what it counts beside finer teeth: one place in 200 gains as much by chance
(chi-square of one freedom), one of a hundred in every third recording. What gains less has no name, however fine."""

INDEX_DEVIATION_PHYSICS = frozenset({"tooth_pitch", "cumulative_pitch"})
"""Physics that are index deviations and nothing else: teeth of another scale may have them."""

TINY = 1e-280
"""Part of the weight of scales beyond which figures of doubles end."""


def is_unstated(model: Model, gear: int) -> bool:
    """Whether neither grade, limits nor inspection of a gear are stated."""
    section = gear_section(model.declared, gear)
    return section.grade is None and section.limits is None and section.inspection is None


def of_pitches(model: Model, claim: Claim) -> bool:
    """Whether a claim is about index deviations of a gear that nobody inspected, and of nothing else."""
    return claim.physics.name in INDEX_DEVIATION_PHYSICS and model.as_built.gears[claim.place.gear or 0].graded


def beside_finer(linear: Linear, model: Model, claim: Claim, gain: float) -> float:
    """What a ``gain`` in misfit of a ``claim`` is where teeth may be finer than the grade that is stated, as large as
    they come out: the ratio of likelihoods, each at its best scale. ``linear`` has the claim's columns."""
    if is_unstated(model, claim.place.gear or 0):
        return gain
    spread, freedom = spread_of(linear, model, claim.place.gear or 0, beside=claim)

    def least(squares: float) -> float:
        return squares if squares >= freedom else freedom * math.log(squares / freedom) + freedom

    return least(spread + gain) - least(spread)


def counted(linear: Linear, model: Model, claim: Claim, gain: float, *, beside_any: float = 0.0) -> float:
    """What a ``gain`` in misfit of a ``claim`` about the teeth of a graded gear counts, of which ``beside_any`` is what
    it gains beside teeth of any scale: less where nobody stated their grade, more where they are finer than it.
    ``linear`` has the claim's columns."""
    gear = claim.place.gear
    assert gear is not None
    scaled = min(gain, max(0.0, gain - beside_any))
    spread, freedom = spread_of(linear, model, gear, beside=claim)
    stated = not is_unstated(model, gear)
    if not stated:
        # Were nothing there, the claimed teeth would be of that scale too.
        freedom += freedoms_of(claim)
    return gain - scaled + beyond_scale(scaled, spread=spread, freedom=freedom, stated=stated)


def beyond_scale(gain: float, *, spread: float, freedom: float, stated: bool = False) -> float:
    """What is left of a ``gain`` in misfit against teeth whose scale nobody knows, or of which one was ``stated`` that
    they keep: these teeth have so much ``spread`` in so many degrees of ``freedom`` beside what gained it, as
    ``spread_of`` has both.

    The scale is integrated out under the prior that is flat in its logarithm: the misfit of S in n freedoms then weighs
    n log S in the stead of S, and the gain n log(1 + gain / S), as in Student's density (Box and Tiao 1973, 2.4). Where
    the limits were taken too narrow, the teeth have more spread than freedoms and the gain counts for less; where too
    wide, for more. A gear that keeps its grade may be as much finer as it likes, and no coarser: the integral then ends
    at the grade, and far beyond it the gain counts for hardly more than it is (the incomplete gamma function; derived
    here).
    """
    plain = freedom * math.log1p(gain / spread)
    if not stated:
        return plain
    within = [float(gammaincc(0.5 * freedom, 0.5 * one)) for one in (spread, spread + gain)]
    # Far beyond the limit all the weight is at it, where the gain counts as it is.
    if min(within) < TINY:
        return gain
    return max(gain, plain + 2.0 * (math.log(within[0]) - math.log(within[1])))


def spread_of(linear: Linear, model: Model, gear: int, *, beside: Claim | None = None) -> tuple[float, float]:
    """Sum of squares of the index deviations of a gear over what their prior takes them to be, as it is expected after
    the fit, and its degrees of freedom: the teeth of every flank less the coordinates of the claims about them, and of
    one ``beside`` them that ``linear`` has the columns of."""
    teeth, start = model.as_built, linear.layout.built.start
    z = teeth.gears[gear].z
    at = np.concatenate([start + teeth.start(flank, gear) + np.arange(z) for flank in teeth.flanks])
    known = linear.system.precision[np.ix_(at, at)]
    pitch, covariance = linear.system.solution[at], linear.system.covariance[np.ix_(at, at)]
    spread = float(pitch @ known @ pitch) + float(np.sum(known * covariance))
    claims = list(model.claims)
    if beside is not None and all(one.key != beside.key for one in claims):
        claims.append(beside)
    mine = [one for one in claims if one.place.gear == gear and not one.physics.mean_tooth]
    return max(spread, 1.0), max(1.0, float(at.size - sum(map(freedoms_of, mine))))


def freedoms_of(claim: Claim) -> int:
    """Index deviations that a claim about a gear's teeth takes out of what tells their scale."""
    return 1 if claim.place.tooth is not None else len(claim.values)


def gain_beside_any(linear: Linear, model: Model, gear: int, claim: Claim) -> float:
    """What a ``claim`` gains in misfit beside teeth of its gear that may deviate as those of the coarsest do."""
    k = next(k for k, one in enumerate(model.claims) if one.key == claim.key)
    gears = [wider(one, COARSEST) if j == gear else one for j, one in enumerate(model.as_built.gears)]
    precision = linear.system.precision.copy()
    at = linear.layout.built
    precision[at, at] = make_as_built((gears[0], gears[1]), model.as_built.flanks).precision
    coarse = replace(linear.system, precision=precision)
    bare = coarse.without(linear.layout.places(k) + linear.layout.form_places(model, k))
    return bare.misfit - bare.with_columns(linear.white_of(k)).misfit


def wider(one: GearPrior, by: float) -> GearPrior:
    """A gear of so many times the limits."""
    return replace(
        one,
        pitch=by**2 * one.pitch,
        slope=by * one.slope,
        mean_slope=by * one.mean_slope,
        crowning=by * one.crowning,
        thickness=by * one.thickness,
        single=by * one.single,
        form=tuple(by * wave for wave in one.form),
        wave=by * one.wave,
    )
