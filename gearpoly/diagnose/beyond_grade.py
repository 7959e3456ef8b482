"""What as-built teeth hold and no gear of their grade has: it fits, so nothing of it is left over, and was located all
the same."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtr

from gearpoly.compare.beside import Comparison
from gearpoly.compare.entries import Entry
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.teeth_scale import is_unstated
from gearpoly.infer.prior import order_of
from gearpoly.mesh.pair import Flank
from gearpoly.units import FloatArray

BEYOND_GRADE_CHANCE = 1e-3
"""Chance that any order or any tooth of a gear within its grade holds so much. Of 1000 gears one is then told of, which
is as many as leave a workshop beyond their grade. A judgement."""

KNOWN_BY = 3
"""Teeth whose freedom is spent where their scale is read off them: on their mean, and on what is once per turn."""


@dataclass(frozen=True, kw_only=True)
class _Held:
    """Index deviations ``pitch`` (z,) in um of a gear's flank and what is known of them beforehand, their inverse
    covariance ``known`` (z, z); ``freedom``: of the scale that the teeth themselves told, inf of a stated grade."""

    pitch: FloatArray
    known: FloatArray
    freedom: float

    def chance_of_wave(self, order: int) -> float:
        """How often teeth within their limits hold a wave of an ``order`` as large as these, at any of all orders."""
        z = self.pitch.size
        angle = 2.0 * math.pi * order / z * np.arange(z)
        rows = np.stack((np.cos(angle), np.sin(angle))) * (2.0 / z)
        wave, prior = rows @ self.pitch, rows @ np.linalg.solve(self.known, rows.T)
        return min(1.0, 0.5 * z * self._tail(float(wave @ np.linalg.solve(prior, wave)), 2))

    def chance_of_tooth(self, tooth: int) -> float:
        """The same of a tooth so far off where the others say that it is, wherever all of them stand together: on the
        coast flank that is how thick they are. Known to be 0, their mean told nearly all of one tooth, and three of a
        sound gear 49 um thinner in the sum of 22 were told."""
        all_teeth = np.sum(self.known, axis=0)
        known = self.known - np.outer(all_teeth, all_teeth) / float(np.sum(all_teeth))
        pull = float(known[tooth] @ self.pitch)
        return min(1.0, self.pitch.size * self._tail(pull**2 / float(known[tooth, tooth]), 1))

    def _tail(self, square: float, count: int) -> float:
        """Chance that one or two (``count``) normal values of deviation 1 have more than this ``square`` together, or
        as many of Student's density, whose scale is known with ``freedom`` (Fisher's and Student's distributions)."""
        if math.isinf(self.freedom):
            return math.exp(-0.5 * square) if count == 2 else math.erfc(math.sqrt(0.5 * square))
        if count == 2:
            return math.exp(-0.5 * self.freedom * math.log1p(square / self.freedom))
        return 2.0 * float(stdtr(self.freedom, -math.sqrt(square)))


def beyond_grade(search: Fit, before: Comparison, now: Comparison) -> tuple[Entry, ...]:
    """What ``before``, the comparison with the declared pair alone, located at whole orders and single teeth and that
    as-built teeth hold by ``now``, where no gear within its limits has so much; but what has a name, and what other
    parts of the drive make.

    Of two telescope gears that were never graded one ran 30 um off its axis, every 122 s; it was located, the teeth
    took it up, and nothing was told.
    """
    places: dict[tuple[object, ...], Entry] = {}
    for one in _told(search, before, now):
        places.setdefault((one.gear, one.order, one.tooth, one.encoder_deg), one)
    return tuple(sorted(places.values(), key=lambda one: -one.mean_square(*(gear.z for gear in before.gears))))


def _told(search: Fit, before: Comparison, now: Comparison) -> Iterator[Entry]:
    claimed = {(one.place.gear, order_of(one), one.place.tooth) for one in search.model.claims}
    # Orders as large as the whole mismatch has them: beside teeth a fit gives a part to these and another to a wave.
    for one in (*before.located.where, *(one for one in before.located.entries if one.kind == "tooth")):
        if one.gear is None or one.parts or one.companion_of is not None:
            continue
        gear = ("driving", "driven").index(one.gear)
        held = list(_held(search, gear, one))
        if one.kind == "shaft_order" and one.order is not None and float(one.order).is_integer():
            order = int(one.order)
            z = search.model.as_built.gears[gear].z
            if not 1 <= order < 0.5 * z or (gear, order, None) in claimed or search.model.scope.others_at(gear, order):
                continue
            chance = min((flank.chance_of_wave(order) for flank in held), default=1.0)
        # Teeth may have been moved by whole pitches since, and the reading at which one passes has not.
        elif one.kind == "tooth" and (tooth := now.gears[gear].tooth_at(one.encoder_deg)) is not None:
            if any((gear, tooth) == (other, its) for other, _, its in claimed):
                continue
            chance = min((flank.chance_of_tooth(tooth) for flank in held), default=1.0)
            one = replace(one, encoder_deg=now.gears[gear].encoder_deg(tooth))
        else:
            continue
        if chance < BEYOND_GRADE_CHANCE:
            yield replace(one, as_built=False)


def _held(search: Fit, gear: int, entry: Entry) -> Iterator[_Held]:
    """What each flank of a gear holds in the recordings of an ``entry``."""
    model = search.model
    built, teeth = search.linear.system.solution[search.linear.layout.built], model.as_built
    one = teeth.gears[gear]
    flanks: Sequence[Flank] = sorted({model.observed[k].samples.flank for k in entry.recordings})
    for flank in flanks:
        start = teeth.start(flank, gear)
        known = np.asarray(np.linalg.inv(one.pitch))
        freedom = float(one.z - KNOWN_BY) if is_unstated(model, gear) else math.inf
        yield _Held(pitch=built[start : start + one.z], known=known, freedom=freedom)
