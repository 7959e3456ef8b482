"""A wrong scale of one reading that was taken out before anything was fitted, as a finding and in the fitted file."""

from __future__ import annotations

import math

import numpy as np

from gearpoly.arguments import GEARS
from gearpoly.compare.beside import Comparison
from gearpoly.diagnose.heldout import Rms
from gearpoly.diagnose.verdict import Finding
from gearpoly.files.models import PairFile
from gearpoly.physics.base import Claim
from gearpoly.physics.encoder_scale import PHYSICS, PPM
from gearpoly.physics.place import Place


def scale_claim(comparison: Comparison) -> Claim | None:
    """The claim that an encoder's reading is a constant times the truth, where ``compare`` took such a one out."""
    scale = comparison.scale
    if scale is None:
        return None
    return Claim(physics=PHYSICS, place=Place(gear=GEARS.index(scale.shaft)), values=((scale.value - 1.0) / PPM,))


def scale_finding(comparison: Comparison, after: Rms) -> Finding | None:
    """The same as a finding: ``after`` in mm is what is left with it, and without it the ramp besides, which holds for
    samples that no fit saw too. Its probability is that of its lines against the next best explanation's."""
    scale, claim = comparison.scale, scale_claim(comparison)
    if scale is None or claim is None:
        return None
    chance = 1.0 / (1.0 + math.exp(-min(scale.log_odds, 700.0)))
    ramps = []
    for k in scale.of:
        one = comparison.aligned[min(k, len(comparison.aligned) - 1)]
        turned = one.cleaned.ratio * one.theta_1 if scale.shaft == "driving" else one.theta_2
        ramps.append(float(np.std(turned)) * abs(scale.value - 1.0) * one.r_b2)
    ramp = math.sqrt(sum(x**2 for x in ramps) / len(ramps))
    return Finding(
        claim=claim,
        parameters={"ratio": (scale.value, scale.std)},
        tooth=None,
        encoder_deg=None,
        gain=2.0 * scale.log_odds,
        probability=chance,
        unknown_probability=1.0 - chance,
        without=Rms(seen=math.hypot(after.seen, ramp), unseen=math.hypot(after.unseen, ramp)),
        with_=after,
        rivals=(),  # any other is a thousand times less likely, or nothing would have been taken out
        separation=None,
    )


def with_scale(file: PairFile, comparison: Comparison) -> PairFile:
    """The fitted file with the scale in it."""
    claim = scale_claim(comparison)
    return file if claim is None else claim.written(file)
