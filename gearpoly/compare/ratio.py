"""Which reading is wrong where both shafts' travels do not fit the tooth ratio, by the orders at which teeth show.

Derived here. Travels tell a ratio, and nothing else: an encoder whose counts per turn are set wrong on either shaft, a
coupling that slips, or another pair of teeth make the same one. What turns with the gears tells them apart. Under a
driving reading that is ``s`` times the truth the driving gear's orders stand at 1/s of whole orders of that reading,
and those of the driven gear at whole orders of its own; the mesh is an order of both. So every explanation says where
the lines stand, and the one under whose orders most of them stand is taken.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d, median_filter

from gearpoly.compare.clock import STRENGTH
from gearpoly.compare.spectrum import FrequencyGrid
from gearpoly.recording.clean import Cleaned
from gearpoly.units import TURN, FloatArray

OTHER_TEETH = (5, 400)
"""Teeth of gears that another pair may have."""

EXACT = 1e-5
"""Relative error of a ratio of travels at least: what encoders off their axes leave of a few turns once their first two
orders are fitted along."""

SAME_RATIO_SIGMAS = 5.0
"""Standard errors within which a tooth ratio is the one that was measured."""

MESHES = 4
"""Mesh harmonics that are looked for; higher ones are smaller than the second in nearly every pair."""

ORDERS_PER_TOOTH = 2.0
"""Whole orders of a shaft that are looked for, times its teeth: eccentricity, pitch errors and their images."""

LINE_SHOWS, MESH_PRESENT = 0.1, 0.5
"""Prior probability that an order of a shaft, or a harmonic of the mesh, shows a line at all."""

LINE_SWAYS = 0.25
"""Part of itself by which a line sways along a recording, and leaks into its neighbours, so that no single line tells:
of 540 made recordings of 4 to 30 turns, scaled or of other pairs, a tenth blamed the wrong reading 14 times of 484;
with this none of 160 that were told in 600 was wrong."""

BACKGROUND_LINES, LEAK_LINES, RATIO_PLACES_PER_LINE = 8, 2, 4
"""Lines of the recording's own width on either side from which the background is taken, from which a strong line leaks,
and places per line."""

DRIFT_DEGREE = 4
"""Degree of the polynomial over the recording that is no line."""

TAKEN_LOG_ODDS = math.log(1000.0)
"""Log odds of an explanation over each other one from which it is taken: orders of a gear come together, and each
counts as if it came alone."""

SEEN_LOG_ODDS = math.log(1000.0)
"""Log odds of the lines under it over noise alone: fifteen orders of either shaft and some harmonics are looked at."""


@dataclass(frozen=True, kw_only=True)
class Explained:
    """One explanation of a ratio: the ``shaft`` whose reading is ``scale`` times the truth, or the ``teeth`` of another
    pair and the ``mesh``, how strong its first two harmonics are (log); ``log_odds`` of its lines over noise alone."""

    log_odds: float
    shaft: str = ""
    scale: float = 1.0
    teeth: tuple[int, int] | None = None
    mesh: float = 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Travelled:
    """A recording by its readings: ``cleaned`` with a driving angle that is ``factor`` times its reading, and the
    ``ratio`` of driven to driving travel as read, with its standard error ``std``."""

    cleaned: Cleaned
    factor: float
    ratio: float
    std: float


def explanations(these: Sequence[Travelled], *, z_1: int, z_2: int) -> list[Explained]:
    """Every explanation of recordings with one wrong ratio, the likeliest first: the driving reading, the driven one,
    and other pairs of teeth of that ratio."""
    ratio = float(np.average([one.ratio for one in these], weights=[one.std**-2 for one in these]))
    std = 1.0 / math.sqrt(sum(one.std**-2 for one in these))
    lines = [_lines_of(one) for one in these]
    stated, highest = z_1 / z_2, int(ORDERS_PER_TOOTH * max(z_1, z_2))

    def odds(mesh: float, driving: float, driven: float) -> float:
        return sum(one.odds(mesh, driving, driven, highest) for one in lines)

    own = z_2 * ratio / z_1
    out = [
        Explained(shaft="driving", scale=stated / ratio, log_odds=odds(z_2 * ratio, own, ratio)),
        Explained(shaft="driven", scale=ratio / stated, log_odds=odds(z_1, 1.0, stated)),
    ]
    others = other_teeth(ratio, max(EXACT, SAME_RATIO_SIGMAS * std / ratio))
    # All other pairs together are as likely beforehand as either reading.
    price = math.log(max(len(others), 1))
    out += [
        Explained(teeth=z, log_odds=odds(z[0], 1.0, ratio) - price, mesh=sum(one.mesh(z[0]) for one in lines))
        for z in others
    ]
    return sorted(out, key=lambda one: -one.log_odds)


def decided(found: Sequence[Explained]) -> Explained | None:
    """The explanation that the lines tell; None where they do not, or show nothing. Of pairs of one ratio the first of
    several is as good as any to say that it is another pair."""
    best = found[0]
    others = [one for one in found[1:] if best.teeth is None or one.teeth is None]
    sure = all(best.log_odds - one.log_odds > TAKEN_LOG_ODDS for one in others)
    return best if sure and best.log_odds > SEEN_LOG_ODDS else None


def other_teeth(ratio: float, tolerance: float) -> list[tuple[int, int]]:
    """All pairs of teeth whose ratio is ``ratio`` within a relative ``tolerance``, the fewest teeth first."""
    low, high = OTHER_TEETH
    found = [(z, round(z / ratio)) for z in range(low, high + 1)]
    return [(a, b) for a, b in found if low <= b <= high and abs(a / b / ratio - 1.0) <= tolerance]


def _lines_of(one: Travelled) -> OrderPower:
    """The lines of a recording, at orders of the driving shaft's reading."""
    turns = one.cleaned.theta_1 / (one.factor * TURN)
    return OrderPower(turns, one.cleaned.theta_2 - one.ratio * TURN * turns)


class OrderPower:
    """Power of a transmission error ``te`` (n,) over that of the background, at any order of the shaft whose ``turns``
    (n,) were read."""

    def __init__(self, turns: FloatArray, te: FloatArray) -> None:
        self.length = float(np.ptp(turns))
        x = (turns - turns[0]) / self.length * 2.0 - 1.0
        slow = np.polynomial.legendre.legvander(x, DRIFT_DEGREE)
        te = te - slow @ np.linalg.lstsq(slow, te, rcond=None)[0]
        taper = np.cos(0.5 * math.pi * np.linspace(-1.0, 1.0, turns.size)) ** 2
        self.highest = 0.5 * turns.size / self.length
        self.step = 1.0 / (RATIO_PLACES_PER_LINE * self.length)
        power = FrequencyGrid(turns, step=self.step, count=int(self.highest / self.step)).power(taper * te)
        self.plain = power / turns.size**2
        # The power of noise is exponential: its median is log 2 of its mean.
        background = median_filter(
            power, size=2 * RATIO_PLACES_PER_LINE * BACKGROUND_LINES + 1, mode="nearest"
        ) / math.log(2.0)
        leaked = LINE_SWAYS**2 * maximum_filter1d(power, 2 * RATIO_PLACES_PER_LINE * LEAK_LINES + 1, mode="nearest")
        self.power = power / (background + leaked)

    def evidence(self, orders: FloatArray, present: float) -> float:
        """Log evidence of lines at ``orders`` (k,), against none at any."""
        return float(np.sum(self.each(orders, present)))

    def each(self, orders: FloatArray, present: float, *, most: float = math.inf) -> FloatArray:
        """Log evidence (m,) of a line at each of ``orders`` (k,) that the recording can show, against none there: it is
        there with probability ``present``, its power then exponential about ``STRENGTH``; ``most``: its log evidence
        at most."""
        place = np.rint(orders / self.step).astype(np.int64)
        place = place[(orders > 1.5 / self.length) & (place < self.power.size)]
        there = np.minimum(self.power[place] * STRENGTH / (1.0 + STRENGTH) - math.log1p(STRENGTH), most)
        return np.asarray(np.logaddexp(math.log1p(-present), math.log(present) + there))

    def at(self, orders: FloatArray) -> FloatArray:
        """Power (k,) at ``orders`` (k,) itself, of a wave as its amplitude squared; 0 beyond what was recorded."""
        place = np.rint(orders / self.step).astype(np.int64)
        there = place < self.plain.size
        return np.where(there, self.plain[np.minimum(place, self.plain.size - 1)], 0.0)

    def odds(self, mesh: float, driving: float, driven: float, highest: int) -> float:
        """Log odds of lines at multiples of the orders ``mesh``, of a ``driving`` and of a ``driven`` turn, of these as
        many as ``highest``, over noise alone; the harmonics of the mesh are orders of a turn too, but likelier."""
        turn, harmonics = np.arange(1.0, highest + 1.0), mesh * np.arange(1.0, MESHES + 1.0)
        more = self.evidence(harmonics, MESH_PRESENT) - self.evidence(harmonics, LINE_SHOWS)
        return more + self.evidence(driving * turn, LINE_SHOWS) + self.evidence(driven * turn, LINE_SHOWS)

    def mesh(self, order: float) -> float:
        """How strong the first two harmonics of a mesh are, as the mean log of their powers."""
        place = np.rint(order * np.array([1.0, 2.0]) / self.step).astype(np.int64)
        place = place[place < self.power.size]
        return float(np.mean(np.log(self.power[place] + 1e-12))) if place.size else -math.inf
