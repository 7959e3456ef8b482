"""Whether a gear keeps its limits as far as its recordings tell: single pitch, cumulative pitch, slope, thickness.

What an inspector calls a deviation is the worst of many figures, and the worst of many noisy figures lies beyond the
worst of the true ones. So a limit counts as broken where one figure exceeds it by more than its own standard error
times what the worst of so many errors reaches by chance as rarely as a single one reaches two: 3.0 times for 17 teeth,
3.6 times for the differences between any two of 12 (Bonferroni's bound). No gear within its limits is then accused of a
kind more often than once in 44 looks, whatever its teeth are. Pitches are told to about half a micron, so little is
lost by it; slopes of graded teeth to some 3 um on account of their form, so there only gross ones count.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from gearpoly.diagnose.running import Running
from gearpoly.errors import GearpolyError
from gearpoly.files.models import GearSection
from gearpoly.gear.nominal import nominal_gear
from gearpoly.gear.tolerances import tolerances
from gearpoly.mesh.pair import Flank
from gearpoly.units import UM, FloatArray, IntArray

GRADES_OF_EDITION = {1995: range(13), 2013: range(1, 12)}

BROKEN_LIMIT_CHANCE = float(ndtr(-2.0))
"""Chance with which a limit that holds may be called broken: that of one figure beyond two standard errors."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Figures:
    """All figures of one kind on one flank (None: of both): ``values`` (n,) in um, ``std`` (n,), and ``teeth`` (n, k)
    between which or of which each is."""

    kind: str
    flank: Flank | None
    values: FloatArray
    std: FloatArray
    teeth: IntArray


@dataclass(frozen=True, kw_only=True)
class Limit:
    """``kind`` of figure between ``low`` and ``high`` um, by what the file calls it (``key``), or by a ``grade``."""

    kind: str
    low: float
    high: float
    key: str = ""
    grade: int | None = None


@dataclass(frozen=True, kw_only=True)
class Exceeded:
    """A broken ``limit``: figure ``value`` with its ``std`` in um, ``by`` how much it is beyond, of which ``teeth`` on
    which ``flank``."""

    limit: Limit
    value: float
    std: float
    by: float
    teeth: tuple[int, ...]
    flank: Flank | None

    def says(self, gear: str) -> str:
        """The same in words."""
        numbers = " and ".join(str(k) for k in self.teeth)
        where = f"between teeth {numbers}" if len(self.teeth) > 1 else f"of tooth {numbers}"
        flank = "" if self.flank is None else f" ({self.flank} flank)"
        bound = self.limit.high if self.value > self.limit.high else self.limit.low
        side = "above" if self.value > self.limit.high else "below"
        source = f"grade {self.limit.grade}" if self.limit.grade is not None else f"the stated {self.limit.key}"
        return (
            f"the {gear} gear's {self.limit.kind} {where}{flank} is {self.value:.1f} +- {self.std:.1f} um, "
            f"{self.by:.1f} um {side} the {bound:g} um of {source}"
        )


def figures_of(
    flanks: Sequence[Running], cosine: float, thickness: tuple[FloatArray, FloatArray] | None
) -> list[Figures]:
    """What an inspector would look at, pitches along the reference circle (``cosine`` of the pressure angle)."""
    out = []
    for one in flanks:
        z = one.pitch.size
        first = np.arange(z)
        nxt = np.column_stack((first, (first + 1) % z))
        pairs = np.array([(i, j) for i in range(z) for j in range(z) if i != j])
        for kind, teeth in (("single pitch", nxt), ("cumulative pitch", pairs)):
            i, j = teeth.T
            c = one.pitch_covariance
            std = np.sqrt(np.maximum(c[i, i] + c[j, j] - 2.0 * c[i, j], 0.0)) / cosine
            values = (one.pitch[j] - one.pitch[i]) / cosine
            out.append(Figures(kind=kind, flank=one.flank, values=values, std=std, teeth=teeth))
        std = np.sqrt(np.diag(one.slope_covariance))
        out.append(Figures(kind="profile slope", flank=one.flank, values=one.slope, std=std, teeth=first[:, None]))
    if thickness is not None:
        values, covariance = thickness
        teeth = np.arange(values.size)[:, None]
        std = np.sqrt(np.diag(covariance))
        out.append(Figures(kind="tooth thickness", flank=None, values=values, std=std, teeth=teeth))
    return out


def allowance(count: int) -> float:
    """Standard errors that the worst of ``count`` figures must be beyond its limit: 2 for one figure."""
    return -float(ndtri(BROKEN_LIMIT_CHANCE / count))


def exceeded(figures: Sequence[Figures], limit: Limit) -> Exceeded | None:
    """The figure that breaks ``limit`` most surely, None where what is beyond it may be error."""
    mine = [one for one in figures if one.kind == limit.kind]
    sure = allowance(max(1, sum(one.values.size for one in mine)))
    worst: Exceeded | None = None
    most = 0.0
    for one in mine:
        beyond = np.maximum(one.values - limit.high, limit.low - one.values)
        margin = beyond - sure * one.std
        k = int(np.argmax(margin))
        if margin[k] > most:
            most = float(margin[k])
            worst = Exceeded(
                limit=limit,
                value=float(one.values[k]),
                std=float(one.std[k]),
                by=float(beyond[k]),
                teeth=tuple(one.teeth[k].tolist()),
                flank=one.flank,
            )
    return worst


def limits_of(section: GearSection) -> list[Limit]:
    """What the pair file holds an uninspected gear to: the stated limits, and those of its grade that none replaces."""
    if section.inspection is not None:
        return []
    out = _graded(section, section.grade) if section.grade is not None else []
    stated = section.limits
    if stated is None:
        return out
    slope = "f_Halpha_um" if stated.f_Halpha_um is not None else "F_alpha_um"
    for kind, key in (("single pitch", "f_pt_um"), ("cumulative pitch", "F_p_um"), ("profile slope", slope)):
        value = getattr(stated, key)
        if value is not None:
            out = [one for one in out if one.kind != kind]
            out.append(Limit(kind=kind, low=-value, high=value, key=key))
    for key, value in (("E_sns_um", stated.E_sns_um), ("E_sni_um", stated.E_sni_um)):
        if value is not None:
            low, high = (-math.inf, value) if key == "E_sns_um" else (value, math.inf)
            out.append(Limit(kind="tooth thickness", low=low, high=high, key=key))
    return out


def _graded(section: GearSection, grade: int) -> list[Limit]:
    """The limits of a grade; none where the standard has none for such a gear."""
    ideal = nominal_gear(section)
    try:
        limit = tolerances(d=2.0 * ideal.r, m=ideal.m, b=ideal.b, grade=grade, edition=section.grade_edition)
    except GearpolyError:
        return []
    kinds = (("single pitch", limit.f_pT), ("cumulative pitch", limit.F_pT), ("profile slope", limit.f_HalphaT))
    return [Limit(kind=kind, low=-bound / UM, high=bound / UM, grade=grade) for kind, bound in kinds]


def graded_by_iso(section: GearSection) -> bool:
    """Whether the stated edition of ISO 1328-1 has tolerances for a gear of this size."""
    return any(_graded(section, grade) for grade in GRADES_OF_EDITION[section.grade_edition])


def grade_needed(section: GearSection, figures: Sequence[Figures]) -> int | None:
    """The finest ISO 1328-1 grade of which no limit of single pitch, cumulative pitch and profile slope is broken;
    None where none is so coarse, or none is defined for such a gear."""
    for grade in GRADES_OF_EDITION[section.grade_edition]:
        bounds = _graded(section, grade)
        if bounds and not any(exceeded(figures, bound) for bound in bounds):
            return grade
    return None


def grade_kept(section: GearSection, figures: Sequence[Figures]) -> int | None:
    """The finest ISO 1328-1 grade of which every limit of single pitch, cumulative pitch and profile slope is kept,
    whatever the errors of the figures are; None where there is none, or none is defined for such a gear."""
    for grade in GRADES_OF_EDITION[section.grade_edition]:
        bounds = _graded(section, grade)
        if bounds and all(_surely_within(figures, bound) for bound in bounds):
            return grade
    return None


def _surely_within(figures: Sequence[Figures], limit: Limit) -> bool:
    mine = [one for one in figures if one.kind == limit.kind]
    sure = allowance(max(1, sum(one.values.size for one in mine)))
    return all(bool(np.all(np.abs(one.values) + sure * one.std <= limit.high)) for one in mine)
