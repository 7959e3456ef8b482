"""Claims and causes as they are told: parameters with their standard errors, numbers of teeth, places with causes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.arguments import GEARS
from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Cause, Curve, Entry
from gearpoly.diagnose.causes import causes
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.relieved import pitch_point_compliance
from gearpoly.diagnose.residuals import sharp
from gearpoly.diagnose.search import doubted
from gearpoly.diagnose.unnamed import UNCLAIMED_PROBABILITY
from gearpoly.infer.free_form import FREE_FORM
from gearpoly.infer.posterior import Posterior
from gearpoly.infer.prior import FILE_RIGHT, UNEARNED
from gearpoly.physics.base import Claim
from gearpoly.physics.words import Reported
from gearpoly.units import FloatArray

SHAPE_DOUBT_STEPS = 4.0
"""Steps of a shape coordinate by which a fitted edge or length is doubted beside its noise: flanks are not made of
formulas, and another shape would put its edge elsewhere."""

ONE_TORQUE = 2.0
"""Factor on what laws are doubted by where bending that nobody declared was found under one load, which tells no law; a
length is then doubted too. Of 28 reliefs of 14 pairs at the torque of their design seven were off by more than twice
the plain error, four lengths as well, by up to 0.08 of themselves."""


def explained(search: Fit, comparison: Comparison, entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """The entries of which nobody has asked yet, each with the probability that it is there at all and what may be
    behind it; without those that are likelier not there. A wave so far above the noise that no colour would make it is
    there: where a fit finds nothing at its order, columns without a cause hold it."""
    found = zip(entries, causes(search, comparison, entries), strict=True)
    told = (
        one
        if posterior is None or (posterior.nothing > UNCLAIMED_PROBABILITY and sharp(one))
        else replace(one, probability=1.0 - posterior.nothing, could_be=causes_of(search, posterior))
        for one, posterior in found
    )
    return tuple(one for one in told if one.probability is None or one.probability >= UNCLAIMED_PROBABILITY)


def causes_of(search: Fit, found: Posterior) -> tuple[Cause, ...]:
    """The physics that may be behind a place, each with its probability: as far as the pair file is right. It is
    doubted too where a place would have its name by its chance alone, and has none: unseen data, time or number spoke
    against it. No cause that did not earn its name is told as likelier than such causes are."""
    model, right = search.model, FILE_RIGHT if doubted(search) or found.named else 1.0
    right = min(right, UNEARNED / max((chance for _, chance in found.causes), default=1.0))
    return tuple(
        Cause(
            physics=claim.physics.name,
            gear=None if claim.place.gear is None else GEARS[claim.place.gear],
            probability=right * chance,
            parameters=tuple(
                (name, value)
                for name, (value, _) in parameters(model, claim, np.zeros((len(claim.values),) * 2)).items()
            ),
            says=claim.says,
        ) for claim, chance in found.causes
    )  # fmt: skip


def parameters(model: Model, claim: Claim, covariance: FloatArray) -> Reported:
    """The contract's parameters of a claim, each with its standard error."""
    a = claim.physics.amplitudes
    covariance = covariance.copy()
    # What laws differ by is no noise: it does not shrink with more data.
    by_laws = claim.physics.law_doubt * np.array(claim.values)
    if claim.physics.mean_tooth and _bends_alone(model):
        by_laws[:a] *= ONE_TORQUE
    else:
        by_laws[a:] = 0.0
    by_shape = np.array(
        [SHAPE_DOUBT_STEPS * one.step if k >= a else 0.0 for k, one in enumerate(claim.physics.coordinates)]
    )
    covariance += np.diag(by_laws**2 + by_shape**2)
    found = claim.physics.report(claim.place, np.array(claim.values), covariance)
    scale = found.pop("compliance_scale", None)
    if scale is not None:
        scale = model.ratio * scale[0], model.ratio * scale[1]
        unit = pitch_point_compliance(model)
        found = {"compliance_um_per_n": (scale[0] * unit, scale[1] * unit), "compliance_scale": scale, **found}
    return found


def _bends_alone(model: Model) -> bool:
    """Whether teeth were found to bend, of which the file says nothing, by recordings under one load only."""
    return len(set(model.scope.torques)) == 1 and model.bending is not None


def numbered(comparison: Comparison, claim: Claim) -> int | None:
    """The number of a claimed tooth, None where the numbering of its gear is open."""
    return claim.place.tooth if comparison.alignment.numbered[claim.place.gear or 0] else None


def encoder_deg(comparison: Comparison, claim: Claim) -> float | None:
    """Reading of its shaft's encoder at which a claimed tooth's pitch point passes the line of centres."""
    if claim.place.tooth is None or claim.place.gear is None:
        return None
    return comparison.gears[claim.place.gear].encoder_deg(claim.place.tooth)


def flank_curves(search: Fit) -> list[Curve]:
    """The flanks' own deviations that stand in the fit without a name, each with its error band."""
    out = []
    for k, claim in enumerate(search.model.claims):
        if claim.physics is FREE_FORM:
            covariance = search.linear.system.covariance[search.linear.layout.claims[k], search.linear.layout.claims[k]]
            out.append(
                Curve(
                    gear=claim.place.gear or 0,
                    tooth=claim.place.tooth,
                    flank=claim.place.flank or "drive",
                    roll_length_mm=claim.place.shape,
                    deviation_um=claim.values,
                    std_um=tuple(np.sqrt(np.maximum(np.diag(covariance), 0.0)).tolist()),
                )
            )
    return out
