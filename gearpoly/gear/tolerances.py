"""What a grade allows: ISO 1328-1 flank tolerances of both editions, default backlash, and the
limits of one gear.

Both editions give micrometres; everything here is in mm. The two count their grades alike but
compute other values, so an edition is part of every grade.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from itertools import pairwise

from gearpoly.errors import OutOfRangeError
from gearpoly.gear.gear import Gear
from gearpoly.units import UM

MODULE_BANDS_1995 = (0.5, 2.0, 3.5, 6.0, 10.0, 16.0, 25.0, 40.0, 70.0)
"""mm. Limits of the module bands of ISO 1328-1:1995, clause 5; a band holds its upper limit, the
first one also its lower."""
DIAMETER_BANDS_1995 = (
    5.0,
    20.0,
    50.0,
    125.0,
    280.0,
    560.0,
    1000.0,
    1600.0,
    2500.0,
    4000.0,
    6000.0,
    8000.0,
    10000.0,
)
"""mm. Limits of the reference diameter bands of ISO 1328-1:1995, clause 5."""

RANGES: dict[int, dict[str, tuple[float, float]]] = {
    2013: {
        "grade": (1, 11),
        "d": (5.0, 15000.0),
        "m": (0.5, 70.0),
        "b": (4.0, 1200.0),
        "z": (5, 1000),
    },
    1995: {"grade": (0, 12), "d": (5.0, 10000.0), "m": (0.5, 70.0), "b": (4.0, 1000.0)},
}
"""Ranges of validity by edition (ISO 1328-1:2013, clause 1 and 5.2.1; ISO 1328-1:1995, clause 1);
lengths in mm."""

LIMIT_KEYS = ("f_pt", "F_p", "F_alpha", "f_Halpha", "f_falpha", "E_sns", "E_sni", "W_kns", "W_kni")
"""The limits that a user can state; a pair file adds ``_um`` to each."""


@dataclass(frozen=True, kw_only=True)
class Tolerances:
    """Flank tolerances of one gear in mm (ISO 1328-1): single pitch, total cumulative pitch,
    profile slope, form and total.

    ``rounded`` says whether the edition's rounding rules were applied; a slope or single pitch
    deviation may have either sign.
    """

    edition: int
    grade: int
    rounded: bool
    f_pT: float
    F_pT: float
    f_HalphaT: float
    f_falphaT: float
    F_alphaT: float


def round_tolerance(value_um: float) -> float:
    """A tolerance in um as the standard states it: above 10 um to 1 um, from 5 um to 0.5 um, below
    to 0.1 um, halves upward.

    ISO 1328-1:2013, 5.2.3, and the same rule in ISO 1328-1:1995, clause 5.
    """
    step = 1.0 if value_um > 10.0 else 0.5 if value_um >= 5.0 else 0.1
    # 1e-9 of a step keeps a half in decimal from falling below it in binary.
    return step * math.floor(value_um / step + 0.5 + 1e-9)


def tolerances(
    *,
    d: float,
    m: float,
    grade: int,
    edition: int = 2013,
    b: float | None = None,
    rounded: bool = True,
    nearest: bool = False,
) -> Tolerances:
    """Flank tolerances of a spur gear of reference diameter ``d``, module ``m`` and face width
    ``b`` (mm; None: not checked).

    ``grade`` is the flank tolerance class A of the 2013 edition or the accuracy grade of 1995. With
    ``rounded`` the values are those that the standard states, without it those of the bare
    formulas. Raises ``OutOfRangeError`` outside the edition's ranges, since neither edition may be
    extrapolated; with ``nearest`` a gear of another size has the values of the nearest in range:
    what is likely of a gear is no statement that it keeps a grade. ISO 1328-1:2013, 5.3.1 to 5.3.3,
    Formulas (5) to (9); ISO 1328-1:1995, 6.1, 6.3, 6.4, B.2.1 and B.2.2. The total F_alphaT of 2013
    comes from unrounded parts.
    """
    if edition not in RANGES:
        raise OutOfRangeError(f"edition {edition} of ISO 1328-1 is not known; 2013 or 1995 would do")
    z: int | None = round(d / m)
    if nearest:
        (d_low, d_high), (m_low, m_high) = RANGES[edition]["d"], RANGES[edition]["m"]
        d, m, b, z = min(max(d, d_low), d_high), min(max(m, m_low), m_high), None, None
    _check_ranges(edition, grade=grade, z=z, d=d, m=m, b=b)
    # 5.2.2 in 2013, clause 5 in 1995: both step by sqrt(2) from grade 5.
    step = math.sqrt(2.0) ** (grade - 5)
    values = _grade_5_2013(d, m) if edition == 2013 else _grade_5_1995(d, m)
    f_pT, F_pT, f_HalphaT, f_falphaT, F_alphaT = (
        UM * (round_tolerance(v * step) if rounded else v * step) for v in values
    )
    return Tolerances(
        edition=edition,
        grade=grade,
        rounded=rounded,
        f_pT=f_pT,
        F_pT=F_pT,
        f_HalphaT=f_HalphaT,
        f_falphaT=f_falphaT,
        F_alphaT=F_alphaT,
    )


def _grade_5_2013(d: float, m: float) -> tuple[float, float, float, float, float]:
    """Class 5 values in um, in the order of ``Tolerances`` (ISO 1328-1:2013, Formulas (5) to
    (9))."""
    slope = 0.4 * m + 0.001 * d + 4.0
    form = 0.55 * m + 5.0
    return (
        0.001 * d + 0.4 * m + 5.0,
        0.002 * d + 0.55 * math.sqrt(d) + 0.7 * m + 12.0,
        slope,
        form,
        math.hypot(slope, form),
    )


def _grade_5_1995(d: float, m: float) -> tuple[float, float, float, float, float]:
    """Grade 5 values in um, in the order of ``Tolerances`` (ISO 1328-1:1995, 6.1, 6.3, B.2.2,
    B.2.1, 6.4)."""
    d_m = _band_mean(DIAMETER_BANDS_1995, d)
    m_m = _band_mean(MODULE_BANDS_1995, m)
    return (
        0.3 * (m_m + 0.4 * math.sqrt(d_m)) + 4.0,
        0.3 * m_m + 1.25 * math.sqrt(d_m) + 7.0,
        2.0 * math.sqrt(m_m) + 0.14 * math.sqrt(d_m) + 0.5,
        2.5 * math.sqrt(m_m) + 0.17 * math.sqrt(d_m) + 0.5,
        3.2 * math.sqrt(m_m) + 0.22 * math.sqrt(d_m) + 0.7,
    )


def _band_mean(bands: tuple[float, ...], value: float) -> float:
    """Geometric mean of the limits of the band that holds ``value``."""
    for low, high in pairwise(bands):
        if value <= high:
            return math.sqrt(low * high)
    raise OutOfRangeError(f"{value:g} mm lies above the last size band, {bands[-1]:g} mm")


def _check_ranges(edition: int, **quantities: float | None) -> None:
    for name, (low, high) in RANGES[edition].items():
        value = quantities[name]
        if value is not None and not low <= value <= high:
            unit = " mm" if name in ("d", "m", "b") else ""
            raise OutOfRangeError(
                f"{name} = {value:g}{unit} is outside ISO 1328-1:{edition}, which holds from "
                f"{low:g} to "
                f"{high:g}{unit} and may not be extrapolated; state limits instead of a grade"
            )


def default_thickness(*, a: float, m: float, alpha: float, F_pT: float) -> tuple[float, float]:
    """Upper and lower tooth thickness deviation E_sns, E_sni in mm of either gear of a pair when
    nobody stated them.

    ``a`` centre distance and ``m`` module in mm, ``alpha`` pressure angle in rad, ``F_pT`` in mm.
    The least recommended backlash j_bn = 2/3 (0.06 + 0.0005 a + 0.03 m) of ISO/TR 10064-2 is shared
    equally: E_sns = -j_bn / (2 cos alpha). E_sni = E_sns - 2 F_pT is our choice: pitch within F_pT
    on both flanks varies thickness by at most that, so thickness alone never rules out a gear whose
    pitch is in grade.
    """
    j_bn = 2.0 / 3.0 * (0.06 + 0.0005 * a + 0.03 * m)
    E_sns = -j_bn / (2.0 * math.cos(alpha))
    return E_sns, E_sns - 2.0 * F_pT


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What an error gear must keep, mm: the flank tolerances of ISO 1328-1, and thickness E_s and
    base tangent length W_k.

    Pitch limits are arcs on the reference circle, as in ISO 1328-1; profile limits and W_k lie
    along the normal; E_s is an arc. E_sns and W_kns are upper, E_sni and W_kni lower deviations.
    Raises ``OutOfRangeError`` for a negative or infinite tolerance and for a lower deviation above
    its upper one.
    """

    f_pT: float = 0.0
    F_pT: float = 0.0
    f_HalphaT: float = 0.0
    f_falphaT: float = 0.0
    F_alphaT: float = 0.0
    E_sns: float = 0.0
    E_sni: float = 0.0
    W_kns: float = 0.0
    W_kni: float = 0.0

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not math.isfinite(value) or (item.name.endswith("T") and value < 0.0):
                raise OutOfRangeError(
                    f"{item.name} = {value / UM:g} um is no tolerance; 0 or more would do"
                    if item.name.endswith("T")
                    else f"{item.name} = {value / UM:g} um is no deviation; a finite one would do"
                )
        for upper, lower in (("E_sns", "E_sni"), ("W_kns", "W_kni")):
            high, low = getattr(self, upper), getattr(self, lower)
            if low > high:
                raise OutOfRangeError(
                    f"{lower} = {low / UM:g} um lies above {upper} = {high / UM:g} um; the lower "
                    f"deviation must not be "
                    "the larger one (both are negative where backlash is wanted)"
                )


def limits_for(
    gear: Gear,
    *,
    grade: Tolerances | None = None,
    stated: Mapping[str, float | None] | None = None,
    thickness: tuple[float, float] | None = None,
) -> Limits:
    """The limits of ``gear``: what is ``stated`` (mm, keys ``LIMIT_KEYS``, None: absent) goes
    before its ``grade``.

    ``thickness`` is the default (E_sns, E_sni) in mm, as from ``default_thickness``; None: 0 upper
    deviation. What neither says is 0, with these dependences (derived here): F_alpha alone scales
    the grade's slope and form, or splits in equal parts (Formula (9) of ISO 1328-1:2013) where
    there is no grade; slope or form alone give F_alpha as their root sum of squares. Of f_pt and
    F_p without a grade the absent one does not bind. E_sni absent is E_sns - 2 F_pT. E_s limits
    times cos(alpha) are the W_k limits (ISO/TR 10064-2), and the other way round where only W_k is
    stated. Raises ``OutOfRangeError`` for an unknown key and for what ``Limits`` refuses.
    """
    given = {key: value for key, value in (stated or {}).items() if value is not None}
    if unknown := sorted(set(given) - set(LIMIT_KEYS)):
        raise OutOfRangeError(f"{unknown[0]} is no limit; one of {', '.join(LIMIT_KEYS)} would do")
    f_pT, F_pT = _pitch_limits(gear, grade, given)
    f_HalphaT, f_falphaT, F_alphaT = _profile_limits(grade, given)
    cosine = math.cos(gear.alpha)
    E = {
        key: given[key] if key in given else given[w] / cosine
        for key, w in (("E_sns", "W_kns"), ("E_sni", "W_kni"))
        if key in given or w in given
    }
    if "E_sns" not in E:
        upper, lower = thickness or (0.0, -2.0 * F_pT)
        # A default above which the stated lower deviation already lies cannot have been meant.
        E_sni = E.get("E_sni", lower)
        E["E_sns"] = upper if E_sni <= upper else max(0.0, E_sni)
    if "E_sni" not in E:
        upper, lower = thickness or (E["E_sns"], E["E_sns"] - 2.0 * F_pT)
        # The default's width, at the stated upper deviation.
        E["E_sni"] = E["E_sns"] - (upper - lower)
    return Limits(
        f_pT=f_pT,
        F_pT=F_pT,
        f_HalphaT=f_HalphaT,
        f_falphaT=f_falphaT,
        F_alphaT=F_alphaT,
        E_sns=E["E_sns"],
        E_sni=E["E_sni"],
        W_kns=given.get("W_kns", E["E_sns"] * cosine),
        W_kni=given.get("W_kni", E["E_sni"] * cosine),
    )


def _pitch_limits(gear: Gear, grade: Tolerances | None, given: Mapping[str, float]) -> tuple[float, float]:
    f_pt, F_p = given.get("f_pt"), given.get("F_p")
    if f_pt is None:
        # No step can exceed the range of all index deviations.
        f_pt = grade.f_pT if grade else (F_p or 0.0)
    if F_p is None:
        # A closed chain of z steps comes back from at most z/2 of them.
        F_p = grade.F_pT if grade else f_pt * (gear.z // 2)
    return f_pt, F_p


def _profile_limits(grade: Tolerances | None, given: Mapping[str, float]) -> tuple[float, float, float]:
    F, slope, form = given.get("F_alpha"), given.get("f_Halpha"), given.get("f_falpha")
    if F is None:
        if slope is None and form is None:
            return (grade.f_HalphaT, grade.f_falphaT, grade.F_alphaT) if grade else (0.0, 0.0, 0.0)
        slope = slope if slope is not None else (grade.f_HalphaT if grade else 0.0)
        form = form if form is not None else (grade.f_falphaT if grade else 0.0)
        return slope, form, math.hypot(slope, form)
    if grade and grade.F_alphaT > 0.0:
        scale = F / grade.F_alphaT
        slope = slope if slope is not None else grade.f_HalphaT * scale
        form = form if form is not None else grade.f_falphaT * scale
    elif slope is None and form is None:
        slope = form = F / math.sqrt(2.0)
    else:
        rest = math.sqrt(max(0.0, F**2 - (slope or 0.0) ** 2 - (form or 0.0) ** 2))
        slope = slope if slope is not None else rest
        form = form if form is not None else rest
    return slope, form, F
