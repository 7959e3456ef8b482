"""All that could be at one place beside what is believed: physics that nobody has claimed there, and unknown causes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.scan import Looked, columns_of, polished, scan
from gearpoly.diagnose.teeth_scale import counted, of_pitches
from gearpoly.diagnose.trial import POSSIBLE, Trial, Unexplained, drawn_of, ordinary_rms
from gearpoly.infer.posterior import Explanation, Posterior, weighed
from gearpoly.infer.prior import same_place, share_of_causes, unknown_share
from gearpoly.physics.base import Claim, Physics
from gearpoly.physics.place import Place
from gearpoly.scene import Scene
from gearpoly.units import FloatArray

STRAIGHT = 0.01
"""Part of the gain in misfit at a place that straight lines do not tell: what stands there is not fitted yet. Of 2.7 um
of a wave 84 times per turn the undulation that made it gained 0.992 of what a wave of no cause did, with 2000 between
them in misfit, and was not fitted."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlaceWeighed:
    """The probabilities at a place where nothing is claimed yet, and the columns (n_k, q) in mm of the likeliest
    unknown cause there; none where that is in the fit already."""

    posterior: Posterior
    unknown: list[FloatArray] | None


def at_place(
    model: Model,
    scenes: list[Scene],
    linear: Linear,
    possible: Sequence[tuple[Physics, Place]],
    *,
    looked: Looked,
    polish: bool = False,
) -> PlaceWeighed | None:
    """Fit the ``possible`` physics of one place to first order, against each other and against unknown causes, beside
    all that is believed; None where none of them could be, or where nothing is left of it. ``polish``: each at the
    shape that gains most, else at the coarse one that does."""
    found, _ = scan(model, scenes, linear, only=possible)
    best: dict[tuple[object, ...], Claim] = {}
    for one in found:
        if one.claim.key not in best:
            near = polish and one.gain > POSSIBLE * found[0].gain
            best[one.claim.key] = polished(model, scenes, linear, one).claim if near else one.claim
    if not best:
        return None
    tried = ((claim, drawn_of(model, scenes, claim)) for claim in best.values())
    shown = [(claim, drawn) for claim, drawn in tried if drawn is not None]
    if not shown:
        return None
    first, (columns, effect) = shown[0]
    weights = share_of_causes(first, (Claim(physics=physics, place=place, values=()) for physics, place in possible))
    dispersion = max(1.0, linear.system.whiteness, STRAIGHT * found[0].gain)
    trial, without_cause = Trial(
        others=model, scenes=scenes, linear=linear, plain=linear.system, dispersion=dispersion
    ).at(first, size=ordinary_rms(model, first, columns, effect), effect=effect)
    more = 0.0
    if of_pitches(model, first):
        # Beside teeth finer than their grade it stands out by more, and so does any other cause there.
        best_of = next(one for one in found if one.claim.key == first.key)
        wider = linear.system.with_columns(columns_of(model, scenes, linear, replace(best_of, claim=first)))
        gain = best_of.gain / trial.dispersion
        more = 0.5 * (counted(replace(linear, system=wider), model, first, gain) - gain)
    explanations = [
        Explanation(
            claim=claim,
            log_evidence=trial.of_drawn(claim, *drawn),
            weight=weights[claim.physics.name, claim.place.gear],
        )
        for claim, drawn in shown
        if same_place(claim, first)
    ]
    unknown = trial.explanations(without_cause)
    every = [replace(one, log_evidence=one.log_evidence + more) for one in (*explanations, *unknown)]
    share = max(unknown_share(claim, model.scope) for claim, _ in shown)
    places = looked.own.get(first.physics.name, 1)
    return PlaceWeighed(
        posterior=weighed(every, unknown_share=share, places=places),
        unknown=_likeliest(unknown, without_cause),
    )


def _likeliest(explanations: Sequence[Explanation], unknown: Sequence[Unexplained]) -> list[FloatArray] | None:
    both = zip(explanations, unknown, strict=True)
    best = max(both, key=lambda pair: pair[0].log_evidence, default=None)
    return None if best is None else best[1].drawn
