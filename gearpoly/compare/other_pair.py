"""Recordings of another pair of teeth, where one shaft alone was read: the orders of the other shaft then stand
elsewhere than the pair file's teeth put them.

Derived here. A transmission error that the rig computed fits any pair, and whole orders of the shaft that was read are
the same of all. The other shaft turns ``p / q`` times with it, and so do its lines: of wrong teeth none stands where
that shaft has an order, and all stand at multiples of one other number of turns.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import product

import numpy as np

from gearpoly.compare.ratio import LINE_SHOWS, ORDERS_PER_TOOTH, SEEN_LOG_ODDS, TAKEN_LOG_ODDS, OrderPower
from gearpoly.keys.also_turns import Part
from gearpoly.units import BoolArray, FloatArray, IntArray

USUAL_TEETH = (5, 200)
"""Teeth of gears that another pair may have. Nearly every spur gear has so few, and more fractions only cost certainty:
each has to be as unlikely by chance."""

MOST_LOG_EVIDENCE = 8.0
"""Log evidence of a single line at most: a wave of another stage of the drive that stands a thousand times above the
background is no surer a line than one that stands eight times above it, and one line is no comb."""

SAME_ORDER_LINES = 1.5
"""Lines of a recording's own width within which two orders are the same: a tapered line is two wide."""

COMB = 4
"""Lines of another shaft that have to show, whole orders of the read one apart: a wheel beside the pair showed up to
three in 60 made recordings, another pair 6 to 50 in 14."""

AS_GOOD, MULTIPLES = SEEN_LOG_ODDS, 4
"""Log evidence within which the pair of fewest teeth stands for all, and times that its shaft may turn as often as
another's: neighbouring fractions, and a shaft that turns half as often, have the same lines, and chance one more."""

UNLIKE_ORDERS_PART = 0.5
"""Part of the orders of the declared pair's shaft that must stand apart from those of the other one, and from whole
orders of the read one, or nothing tells them apart: a belt that turns half as often has all of them. A judgement:
recordings of three other pairs, 0.2 to 0.4 % off in ratio, had 0.66 to 0.82."""


@dataclass(frozen=True, kw_only=True)
class OtherPair:
    """The lines of a shaft that turns ``turns`` times per turn of the ``read`` one (0 driving, 1 driven), as that of
    ``teeth`` (driving, driven) does, where those of the ``declared`` teeth should be; ``log_odds`` over chance."""

    read: int
    turns: float
    teeth: tuple[int, int]
    declared: tuple[int, int]
    log_odds: float

    @property
    def says(self) -> str:
        """What the engineer should know."""
        names = ("driving", "driven")
        other, read = names[1 - self.read], names[self.read]
        return (
            f"no order of the {other} shaft shows where {self.declared[0]} on {self.declared[1]} teeth put it, but "
            f"orders of a shaft that turns {self.turns:.6g} times per {read} turn do, as of {self.teeth[0]} on "
            f"{self.teeth[1]} teeth or a multiple: correct teeth in the pair file if that is the pair, or state the "
            "shaft under [[also_turns]] if it is of another stage of the drive; no physics is named of such a recording"
        )


def other_pair(
    every: Sequence[OrderPower], *, read: int, z: tuple[int, int], parts: Sequence[Part] = ()
) -> OtherPair | None:
    """Whether recordings of ``z`` declared teeth are of other ones, by their lines at orders of the ``read`` shaft (0
    driving, 1 driven); None where the declared pair shows, or nothing does. ``parts`` turn beside the pair, and are
    none of it."""
    own, turn = z[read] / z[1 - read], np.arange(1.0, ORDERS_PER_TOOTH * max(z) + 1.0)
    if all(float(np.mean(_apart(one, own * turn, np.rint(own * turn)))) < UNLIKE_ORDERS_PART for one in every):
        return None  # the declared shaft turns a whole number of times: its orders are those of the one that was read
    known = [one.turns * (1.0 if read else z[0] / z[1]) for one in parts]
    teeth = _teeth()
    ratios = teeth[:, 0] / teeth[:, 1]
    found = [_comb(every, ratio * turn, beside=known) for ratio in ratios.tolist()]
    odds = np.array([one if many >= COMB else -math.inf for one, many in found])
    most = float(np.max(odds))
    log_odds = most - _comb(every, own * turn, beside=known)[0] - math.log(ratios.size)
    if log_odds <= TAKEN_LOG_ODDS:
        return None
    p, q = _plainest(teeth[odds > most - AS_GOOD])
    ratio = p / q
    if (
        _shared(every, own * turn, ratio) > 1.0 - UNLIKE_ORDERS_PART
        or _comb(every, own * turn, beside=(*known, ratio))[0] > SEEN_LOG_ODDS
    ):
        return None
    return OtherPair(read=read, turns=ratio, teeth=(q, p) if read else (p, q), declared=z, log_odds=log_odds)


def _plainest(teeth: IntArray) -> tuple[int, int]:
    """Of pairs of teeth (m, 2) with the same lines the one of fewest, but for shafts that turn a part as often as
    another of them: these have all its lines too."""
    ratios = {Fraction(p, q) for p, q in teeth.tolist()}
    first = [one for one in ratios if not any(times * one in ratios for times in range(2, MULTIPLES + 1))]
    best = min(first, key=lambda one: one.numerator + one.denominator)
    return best.numerator, best.denominator


@lru_cache(maxsize=1)
def _teeth() -> IntArray:
    """Teeth (m, 2) of the read gear and of its mate, without a common divisor; but ratios that are whole, whose orders
    the read gear has too."""
    low, high = USUAL_TEETH
    whole = range(low, high + 1)
    least = (Fraction(p, q) for p, q in product(whole, whole) if p % q)
    return np.array(sorted({(one.numerator, one.denominator) for one in least}))


def _comb(every: Sequence[OrderPower], orders: FloatArray, *, beside: Sequence[float]) -> tuple[float, int]:
    """Log evidence of lines at ``orders`` (k,) that are no whole ones, nor multiples of those ``beside``, and how many
    show."""
    each = []
    for lines in every:
        apart = _apart(lines, orders, np.rint(orders))
        for first in beside:
            apart = apart & _apart(lines, orders, _nearest(orders, first))
        each.append(lines.each(orders[apart], LINE_SHOWS, most=MOST_LOG_EVIDENCE))
    return float(sum(np.sum(one) for one in each)), max(int(np.count_nonzero(one > 0.0)) for one in each)


def _apart(lines: OrderPower, orders: FloatArray, others: FloatArray) -> BoolArray:
    return np.asarray(np.abs(orders - others) * lines.length > SAME_ORDER_LINES)


def _nearest(orders: FloatArray, first: float) -> FloatArray:
    """The multiple of a ``first`` order that is nearest to each of ``orders``."""
    return np.asarray(np.maximum(1.0, np.rint(orders / first)) * first)


def _shared(every: Sequence[OrderPower], orders: FloatArray, ratio: float) -> float:
    """Part of ``orders`` that no recording tells from the multiples of ``ratio``."""
    return min(1.0 - float(np.mean(_apart(one, orders, _nearest(orders, ratio)))) for one in every)
