"""What is believed of a place before any recording: how often a cause there is one that the catalogue holds, and how
far sizes may be from ordinary ones.

These are judgements. They are stated here once, so that everybody can see and doubt them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Literal

import numpy as np
from scipy.special import logsumexp

from gearpoly.keys.also_turns import SIDE_BANDS
from gearpoly.physics.base import Claim, Scope

SCALES = 2.0 ** np.arange(-3, 7)
"""Factors on an ordinary size over which the prior of every size is averaged: a fine gear errs by an eighth of what is
ordinary in a ground one of grade 5, and a printed one by sixty times as much."""

_SPREAD = 2.0
"""Octaves. Standard deviation of the factor about 1, log-normal."""

SCALE_WEIGHTS = np.exp(-0.5 * (np.log2(SCALES) / _SPREAD) ** 2)
SCALE_WEIGHTS /= np.sum(SCALE_WEIGHTS)

PRESENT = 0.1
"""Chance that an ordinary pair on an ordinary rig has one cause or another at a kind of place that the simulation left
out; shared among all places of that kind."""

FORM = 0.08
"""Part of its own largest effect by which a physics with a shape may be of another form, one standard deviation: no
spall is cut by a formula. With nothing a smooth curve of no cause wins at every large size, with 0.2 everything is a
spall (trial on a linear model)."""

ONCE_PER_TURN = 0.02
"""Share of causes that the catalogue does not hold, once per turn of a shaft that carries a gear and an encoder: one of
the two is off its axis nearly always. What else sits on that shaft (a coupling out of line, a bearing) seldom shows."""

TURNS_WITH_IT = 0.5
"""The same at high whole orders of a shaft, and once per turn of one that something else is known to turn with: the
worm or the motor of a telescope mount, a part of the drive that the pair file states, or what makes a whole order that
no tooth of the pair makes, as another wheel does."""

TWISTS_WITH_PULSES, TWIST_OVER_TEETH = 0.9, 5.0
"""The same at the order of a torque that pulses with that shaft, since whatever carries it twists; and by how much more
shafts, couplings and belts give than teeth, one standard deviation. A judgement: of a torque that pulsed by a third an
eccentricity of 2.0 um was named beside 0.9 um of what teeth gave."""

UNKNOWN_AT_LOW_ORDERS, LOW_ORDERS_PER_TOOTH = 0.8, 2
"""The same at other orders up to so many per tooth: meshes of other gears, worms, couplings, bearings, belts and poles
of a motor make all of them; waves of a cutting machine, whose index wheel has more teeth, come oftener."""

SIDE_BAND = 0.95
"""The same of a flank's wave that lies a whole number of teeth from a wave of unknown cause on its shaft: what one
tooth after another does to that stands there, and a flank's own wave would have explained both. A judgement, set by one
case and held against no other: beside an encoder's 1024 lines, which even samples showed as order 56 of 15 teeth, an
undulation of order 49 was named (0.996; with 0.8 it still would be, 0.986)."""

LINES = 0.03
"""The same at a number of waves per turn that encoders have as lines: nothing else on a shaft comes so often."""

ONE_TOOTH = 0.1
"""The same at a single tooth. Pitch, spalls, cracks and chips are nearly all that befalls one; dirt, burrs and dents
are the rest."""

UNKNOWN_AT_EVERY_MESH = 0.5
"""The same at every mesh: profiles, loads, lubricants and mounts all show there, and the catalogue holds some."""

BETWEEN_RECORDINGS = 0.04
"""The same in what sets the means of recordings apart: the backlash by thickness or centre distance, and wind-up."""

UNKNOWN_IN_SLOW_COURSE = 0.5
"""The same in a slow course of a recording: what warms up, creeps, slips, or belongs to what is driven."""

LINE_COUNTS = frozenset(
    by * count
    for count in (
        180, 192, 200, 240, 250, 256, 300, 360, 400, 480, 500,
        512, 600, 625, 720, 768, 800, 900, 1000, 1024, 1200, 1250, 1270, 1440, 1500, 1536, 1800, 2000, 2048, 2160,
        2400, 2500, 2540, 2700, 3000, 3600, 4000, 4096, 4500, 4800, 5000, 5400, 6000, 7200, 8192, 9000,
    )
    for by in (1, 2, 4)
)  # fmt: skip
"""Lines per turn of encoders on sale, and twice and four times as many, at which interpolation errs. A judgement from
common series: powers of two, parts of a degree, decimal counts. Fewer there are as well, but as many teeth have wheels
and pulleys and poles have motors: 72 waves of a motor's cogging were named an encoder's."""

MULTIPLES_OF_UNKNOWN = (2, 3, 4)
"""How many times the order of a wave of unknown cause a wave may be of that cause too: whatever recurs is seldom a pure
wave."""


NOT_IN_RECORDINGS = 0.1
"""Share of the unknown causes at every mesh that what the simulation foretells there is not in the recordings at all:
they are of another pair or column, or no load was on the teeth."""

AS_WRONG_KEYS = frozenset({"centre_distance", "tooth_thickness"})
"""Physics that do what a wrong ``profile_shift``, ``pressure_angle_deg``, ``addendum`` or ``centre_distance_mm`` of the
pair file does: backlash, and where pairs hand over."""

SHAPED_BY_KEYS = AS_WRONG_KEYS | {"profile_slope"}
"""The same with what a wrong pressure angle does to all flanks: 2.5 deg over 4 mm of a flank of module 2 are 175 um. Of
a file with 22.5 deg for 20, slopes of 158 and 156 um of gears of grade 7 were named, each beside the other."""

WRONG_UM, WRONG_KEY = 320.0, 0.05
"""Size in um that a wrong key makes of these, and how often it is that, of all that looks so: judgements. 0.1 of
profile shift at module 2 thickens teeth by 146 um (2 x m tan alpha). A pair of 18 on 25 teeth whose file said 22.5 deg
came out as one whose axes stand 177 um nearer, 9 times what mounting leaves."""

TIPS = 1.0
"""How often tips that nobody measured stand off by as much, over how often axes or thicknesses do. On one flank either
shows only in where pairs take over from each other, and so do tip diameters: h11 allows 0.11 mm at 15 mm (ISO 286-2),
axes are bored to 0.02 mm. All four centre distances that were named of uninspected pairs on one flank were wrong; the
five right ones were of inspected pairs and both flanks."""

AT_THE_EDGE = 0.2
"""Modules. A relief that is shorter shows where pairs take over and hardly elsewhere, as tips do that stand off;
designed ones are 0.25 to 0.7 long. Of a 15/28 of grade 7 whose file lacked profile shifts of 0.35 and -0.1, 10 um over
0.14 modules were named."""

FILE_RIGHT = 1.0 / 3.0
"""Chance that a pair file is right of recordings of which as much repeats and is left unexplained as is noise. Beside
so much, 7 of 8 causes of bench cases were told rightly, whose files are right; of rigs with files of other gears and
with faults of their own none of 13. So it is of places that would have a name by their chance alone and have none: 9 of
9 and 3 of 40 such causes, stated at 0.93 and more, were right."""

UNEARNED = 0.4
"""Most that a cause is told with at a place that did not earn a name: of 20 that stood above a half (0.74 in the mean)
in two grounds of real life 8 were right, and of those below as many as was said."""


def log_size(value: float, std: float) -> float:
    """Log of the density of a size, normal about 0 with a standard deviation that is ``std`` times each of the scales;
    per unit of the size."""
    each = SCALES * std
    return float(logsumexp(-0.5 * (value / each) ** 2 - np.log(each * math.sqrt(2.0 * math.pi)), b=SCALE_WEIGHTS))


Kind = Literal["slow", "tooth", "wave", "means", "mesh"]
"""Kinds of places: a slow course, a single tooth, a wave of a shaft, means of recordings, every mesh."""


def kind_of(claim: Claim) -> Kind:
    """The kind of place that a claim is about."""
    physics = claim.physics
    if physics.slow:
        return "slow"
    if claim.place.tooth is not None:
        return "tooth"
    if order_of(claim) is not None:
        return "wave"
    return "means" if physics.whole_gear or not physics.mean_tooth else "mesh"


def kinds_of(claim: Claim) -> set[Kind]:
    """The kinds of places at which a claim shows: axes that stand apart show at every mesh, and in the backlash, which
    sets the means of recordings apart, as well."""
    return {kind_of(claim), "means"} if claim.physics.name in AS_WRONG_KEYS else {kind_of(claim)}


def same_place(one: Claim, other: Claim) -> bool:
    """Whether two claims are explanations of one place: of one tooth, of one wave, of every mesh."""
    if not kinds_of(one) & kinds_of(other):
        return False
    if kind_of(one) not in ("tooth", "wave"):
        return True
    return (one.place.gear, one.place.tooth, order_of(one)) == (other.place.gear, other.place.tooth, order_of(other))


LEAST_SHARE = 0.01
"""Share of a physics that is of another kind of place and fits as well all the same."""


def share_of_causes(claim: Claim, possible: Iterable[Claim]) -> dict[tuple[str, int | None], float]:
    """Shares, by physics and gear, of the causes at the place of a ``claim`` that the catalogue holds; they add up to
    1, ``possible`` claims in whatever form or shape counted once."""
    found = {(one.physics.name, one.place.gear): one.physics.common for one in possible if same_place(one, claim)}
    return {key: common / sum(found.values()) for key, common in found.items()}


def unknown_share(claim: Claim, scope: Scope) -> float:
    """Share of the causes at the place of a ``claim`` that the catalogue does not hold."""
    place, kind, order = claim.place, kind_of(claim), order_of(claim)
    if twist(claim, scope) > 0.0:
        return TWISTS_WITH_PULSES
    if kind == "wave" and order == 1:
        gear = place.gear or 0
        stated = scope.file.worm is not None or scope.others_at(gear, 1)
        return TURNS_WITH_IT if stated or scope.others_turn[gear] else ONCE_PER_TURN
    if kind == "wave":
        unknown = {(gear, by * low) for gear, low in scope.unknown_waves for by in MULTIPLES_OF_UNKNOWN}
        if (place.gear or 0, order) in unknown:
            return UNKNOWN_AT_LOW_ORDERS
        if order is not None and _is_side_band(order, place.gear or 0, scope):
            return SIDE_BAND
        read = scope.encoders[place.gear or 0] and not scope.from_time[place.gear or 0]
        if read and order in LINE_COUNTS:
            return LINES
        return (
            UNKNOWN_AT_LOW_ORDERS
            if order is not None and order <= LOW_ORDERS_PER_TOOTH * scope.gears[place.gear or 0].z
            else TURNS_WITH_IT
        )
    return {
        "slow": UNKNOWN_IN_SLOW_COURSE,
        "tooth": ONE_TOOTH,
        "means": BETWEEN_RECORDINGS,
        "mesh": UNKNOWN_AT_EVERY_MESH,
    }[kind]


def _is_side_band(order: int, gear: int, scope: Scope) -> bool:
    """Whether a flank's wave of an ``order`` lies a whole number of teeth from one of the same shaft whose cause is
    unknown. Slower ones are teeth off their places, which have such waves themselves."""
    z = scope.gears[gear].z
    if order < 0.5 * z:
        return False
    others = [low for at, low in scope.unknown_waves if at == gear and low != order and low % z]
    return any((order - low) % z == 0 or (order + low) % z == 0 for low in others)


def twist(claim: Claim, scope: Scope) -> float:
    """The rms in mm, one standard deviation, of what shafts give at the order of a ``claim`` to a torque that pulses
    there; 0 where none is known to."""
    if kind_of(claim) != "wave":
        return 0.0
    here = (claim.place.gear or 0, order_of(claim))
    return TWIST_OVER_TEETH * max((rms for gear, order, rms in scope.pulses if (gear, order) == here), default=0.0)


def of_another_part(claim: Claim, scope: Scope) -> bool:
    """Whether a wave of which the cause is unknown shows that something else turns with its shaft: a whole order above
    half a wave per tooth that is no mesh harmonic, nor a side band of one, and so low that other wheels make it."""
    order, gear = order_of(claim), claim.place.gear or 0
    z = scope.gears[gear].z
    if order is None or kind_of(claim) != "wave" or order in LINE_COUNTS:
        return False
    return 0.5 * z < order <= LOW_ORDERS_PER_TOOTH * z and abs(math.remainder(order, z)) > SIDE_BANDS


def order_of(claim: Claim) -> int | None:
    """Waves per turn of its shaft that a claim makes, mostly; None where it is no wave."""
    if claim.place.order is not None:
        return claim.place.order
    return 1 if claim.physics.once_per_turn else None
