"""How much the two flanks of teeth that nobody inspected err together, as the recordings of both flanks tell it.

A cutter that divides wrongly moves whole teeth, a grinder that dresses one side of its wheel only one flank. Which it
was decides whether a gear's eccentricity can be told from its pitch: on teeth that move as a whole the one shows on
both flanks out of phase by twice the pressure angle, the other in step (derived here).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearpoly.diagnose.as_built import AsBuilt, make_as_built
from gearpoly.diagnose.linear import Linear
from gearpoly.diagnose.model import Model
from gearpoly.diagnose.system import System
from gearpoly.mesh.pair import Flank
from gearpoly.physics.base import Claim
from gearpoly.physics.eccentricity import PHYSICS as ECCENTRICITY
from gearpoly.physics.place import Place
from gearpoly.scene import Scene

SHARED = (0.5, 0.8, 0.95, 0.99, 0.999, 0.9999)
"""Parts of its variance that a flank may share with the other: from half, which is what nothing is known of, to nearly
all, where its own errors are 1.4 % of the other's."""

ALLOWED = 1.0
"""Rise of the same that is allowed for sharing less, one standard deviation: too little costs sight of small effects,
too much makes them out of nothing."""

TOLD_BY = 0.95
"""The part by which turns that no encoder counted are told: less than what ground teeth share, more than chance."""

FREE_COAST_VARIANCE_RATIO = 1e4
"""Variance over that of a reading up to which a coast flank is let be what it is, to see what that is."""

INDEPENDENT_COAST_RATIO = 4.0
"""Times that the square of what half of the teeth do must be what it is where a coast flank follows, for it not to:
half of twenty teeth that share neighbours tell a variance to a half only."""

WITHIN_HALF = 0.6745
"""Standard deviations within which half of a normal distribution lies."""

NEIGHBOURS = (1.0 / 6.0, -4.0 / 6.0, 1.0, -4.0 / 6.0, 1.0 / 6.0)
"""Weights of a tooth against what its neighbours on both sides go on to: of an order-1 wave on 18 teeth a four
hundredth is left."""

SHARED_PART_EVIDENCE = 10.0
"""Fall of twice the negative log of the evidence for a part to be believed: likelier by a factor of 150."""


def told(model: Model, scenes: Sequence[Scene], linear: Linear) -> AsBuilt:
    """The as-built teeth with both flanks of graded gears sharing as little as the recordings allow, one part after the
    other, and coast flanks that nobody measured scattering as they do; as they were where nothing is told, or one flank
    only was recorded."""
    best = model.as_built
    if len(best.flanks) < 2:
        return best
    best = scattered(best, linear.system)
    graded = [gear for gear, one in enumerate(best.gears) if one.graded]
    if not graded:
        return best
    system = _beside_eccentricities(model, scenes, linear, graded)
    for gear in graded:
        for part in (0, 1):
            ways = [_sharing(best, gear, part, value) for value in SHARED]
            found = [surprise(one, system) for one in ways]
            if min(found) < surprise(best, system) - SHARED_PART_EVIDENCE:
                best = next(way for way, one in zip(ways, found, strict=True) if one < min(found) + ALLOWED)
    return best


def scattered(as_built: AsBuilt, system: System) -> AsBuilt:
    """The same where the coast flanks of inspected gears, which follow from their drive flanks if nobody measured them,
    scatter about that by more than a reading does.

    What most teeth do against their neighbours is scatter, of pitch and of form each by itself: flanks that lean each
    their own way need not stand off their place. One tooth, a wave of a low order and what all have in common are not,
    and stay to be found.
    """
    gears = list(as_built.gears)
    derived = [gear for gear, one in enumerate(gears) if not one.graded and min(one.own) > 0.0]
    if not derived:
        return as_built
    for gear in derived:
        gears[gear] = replace(gears[gear], own=(FREE_COAST_VARIANCE_RATIO, FREE_COAST_VARIANCE_RATIO))
    free = make_as_built((gears[0], gears[1]), as_built.flanks)
    under = system.believing(slice(0, as_built.size), free.precision)
    for gear in derived:
        one = as_built.gears[gear]
        own, seen = list(one.own), False
        for part, sign in ((0, 1.0), (1, -1.0)):
            against = np.zeros((one.z, under.size))
            ways: tuple[tuple[Flank, float], ...] = (("coast", 1.0), ("drive", sign))
            for flank, way in ways:
                start = as_built.start(flank, gear) + part * one.z
                for shift, weight in enumerate(NEIGHBOURS, start=-(len(NEIGHBOURS) // 2)):
                    against[np.arange(one.z), start + (np.arange(one.z) + shift) % one.z] += way * weight
            off = float(np.median(np.abs(against @ under.solution))) / WITHIN_HALF
            known = float(np.median(np.einsum("ij,jk,ik->i", against, under.covariance, against)))
            alone = sum(weight**2 for weight in NEIGHBOURS) * one.slope**2
            seen = seen or off**2 > INDEPENDENT_COAST_RATIO * (known + one.own[part] * alone)
            own[part] = max(own[part], (off**2 - known) / alone)
        # Where either is seen not to follow, the other is taken as it looks.
        gears[gear] = replace(one, own=(own[0], own[1])) if seen else one
    return make_as_built((gears[0], gears[1]), as_built.flanks)


def turns_told(model: Model, scenes: Sequence[Scene], linear: Linear) -> int:
    """Whole turns of the shaft that was read by which the recordings of the coast flank lie further on than they are
    taken to, so that the same teeth err on both flanks; 0 where that is not clear.

    After whole turns of one shaft its own teeth are the same, and the mate's are not.
    """
    as_built = model.as_built
    mate = 0 if model.turns_of == "driven" else 1
    z, turn = as_built.gears[mate].z, as_built.gears[1 - mate].z
    places = z // math.gcd(turn, z)
    if places == 1:
        return 0  # after a turn of the one shaft the same teeth of both meet again: nothing tells, and nothing need
    system = _beside_eccentricities(model, scenes, linear, (0, 1), apart=True)
    alike = _sharing(as_built, mate, 0, TOLD_BY)
    start = as_built.start("coast", mate)
    found = []
    for n in range(places):
        index = np.arange(as_built.size)
        for first in (start, start + z):
            # Parameters stand by the tooth that they were taken to be of.
            index[first : first + z] = first + (np.arange(z) + n * turn) % z
        precision = alike.precision[np.ix_(index, index)]
        found.append(surprise(replace(alike, precision=precision), system))
    best, *others = np.argsort(found, kind="stable").tolist()
    # Flanks that have nothing in common look alike somewhere by chance.
    least = min(surprise(as_built, system), *(found[one] for one in others))
    return int(best) if found[best] < least - SHARED_PART_EVIDENCE else 0


def _beside_eccentricities(
    model: Model, scenes: Sequence[Scene], linear: Linear, gears: Sequence[int], *, apart: bool = False
) -> System:
    """The system with the eccentricities of these ``gears`` open that nobody claims, on top of declared ones: they are
    what whole teeth on both flanks would contradict, and not what is asked here; ``apart``: on each flank by itself, as
    a declared one looks at a wrong turn."""
    claimed = {one.key for one in model.claims}
    columns = []
    for gear in gears:
        for unit in ((1.0, 0.0), (0.0, 1.0)):
            claim = Claim(physics=ECCENTRICITY, place=Place(gear=gear), values=unit)
            if claim.key in claimed:
                continue
            change = model.change(list(scenes), claim, unit)
            for flanks in (("drive",), ("coast",)) if apart else (("drive", "coast"),):
                columns.append([(s.samples.flank in flanks) * c for s, c in zip(scenes, change, strict=True)])
    if not columns:
        return linear.system
    each = [noise.whitened(np.column_stack(parts)) for noise, *parts in zip(linear.noises, *columns, strict=True)]
    return linear.system.with_columns(each)


def surprise(as_built: AsBuilt, system: System) -> float:
    """Twice the negative log of the evidence (no dimension) of a linear system, its as-built parameters first, under
    the prior of ``as_built`` instead of its own, but for a constant: what parameters could have been is averaged over,
    so that a prior which leaves more open has to earn it (MacKay 1992, Neural Computation 4, 415)."""
    under = system.believing(slice(0, as_built.size), as_built.precision)
    # Teeth count from what was declared, so what is known beforehand is no part of the right-hand side.
    explained = float(system.right @ under.solved(system.right))
    return under.log_determinant - float(np.linalg.slogdet(as_built.precision)[1]) - explained


def _sharing(as_built: AsBuilt, gear: int, part: int, value: float) -> AsBuilt:
    """The same with another part shared by the flanks of one gear."""
    gears = list(as_built.gears)
    shared = list(gears[gear].shared)
    shared[part] = value
    gears[gear] = replace(gears[gear], shared=(shared[0], shared[1]))
    return make_as_built((gears[0], gears[1]), as_built.flanks)
