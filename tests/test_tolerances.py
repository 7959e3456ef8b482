"""Grades: published table values of both editions of ISO 1328-1, ranges, and how limits are
merged."""

from __future__ import annotations

import math

import pytest

from gearpoly.errors import OutOfRangeError
from gearpoly.gear.gear import Gear
from gearpoly.gear.tolerances import (
    RANGES,
    Limits,
    default_thickness,
    limits_for,
    round_tolerance,
    tolerances,
)
from gearpoly.units import DEG, UM

# um: decimals survive the way through mm to 1e-12; the smallest step of a table is 0.1.
EXACT = 1e-9

# ISO 1328-1:1995, Tables 1 to 3 (GB/T 10095.1-2001 and JIS B 1702-1:1998 print the same): d 5 to
# 20 mm and m 0.5 to 2 mm, grades 0 to 12.
ROWS_1995 = {
    "f_pT": (0.8, 1.2, 1.7, 2.3, 3.3, 4.7, 6.5, 9.5, 13, 19, 26, 37, 53),
    "F_pT": (2.0, 2.8, 4.0, 5.5, 8.0, 11, 16, 23, 32, 45, 64, 90, 127),
    "F_alphaT": (0.8, 1.1, 1.6, 2.3, 3.2, 4.6, 6.5, 9.0, 13, 18, 26, 37, 52),
}

# The same tables as design handbooks reprint them: d, m inside the band; grades 6, 7, 8.
TABLES_1995 = [
    (36.0, 2.0, (7.0, 10, 14), (20, 29, 41), (7.5, 10, 15)),
    (50.0, 2.5, (7.5, 11, 15), (21, 30, 42), (10, 14, 20)),
    (100.0, 3.0, (8.5, 12, 17), (27, 38, 53), (11, 16, 22)),
    (200.0, 2.5, (9.0, 13, 18), (35, 50, 70), (13, 18, 25)),
    (200.0, 5.0, (10, 14, 20), (36, 51, 72), (15, 21, 30)),
]


@pytest.mark.parametrize("name", ROWS_1995)
@pytest.mark.parametrize(("d", "m"), [(5.0, 0.5), (12.0, 1.0), (20.0, 2.0)])
def test_1995_row_of_the_first_band(name: str, d: float, m: float) -> None:
    for grade, value in enumerate(ROWS_1995[name]):
        t = tolerances(d=d, m=m, grade=grade, edition=1995)
        assert getattr(t, name) / UM == pytest.approx(value, abs=EXACT)


@pytest.mark.parametrize(("d", "m", "f_pt", "F_p", "F_alpha"), TABLES_1995)
def test_1995_tables(d: float, m: float, f_pt: tuple[float], F_p: tuple[float], F_alpha: tuple[float]) -> None:
    for i, grade in enumerate((6, 7, 8)):
        t = tolerances(d=d, m=m, grade=grade, edition=1995)
        assert t.f_pT / UM == pytest.approx(f_pt[i], abs=EXACT)
        assert t.F_pT / UM == pytest.approx(F_p[i], abs=EXACT)
        assert t.F_alphaT / UM == pytest.approx(F_alpha[i], abs=EXACT)


def test_1995_knows_only_bands() -> None:
    inside = tolerances(d=51.0, m=2.1, grade=5, edition=1995)
    assert inside == tolerances(d=125.0, m=3.5, grade=5, edition=1995)
    assert inside != tolerances(d=126.0, m=3.5, grade=5, edition=1995)
    assert inside != tolerances(d=51.0, m=2.0, grade=5, edition=1995)


def test_1995_slope_and_form_of_the_annex() -> None:
    # B.2.1 and B.2.2 by hand: means sqrt(20 * 50) = 31.623 mm and sqrt(0.5 * 2) = 1 mm, grade 5.
    t = tolerances(d=36.0, m=2.0, grade=5, edition=1995)
    assert t.f_falphaT / UM == pytest.approx(4.0, abs=EXACT)  # 2.5 + 0.956 + 0.5 = 3.956
    assert t.f_HalphaT / UM == pytest.approx(3.3, abs=EXACT)  # 2.0 + 0.787 + 0.5 = 3.287


def test_2013_class_6_of_m_3_d_120() -> None:
    # By hand from Formulas (5) to (9): 6.32, 20.365, 5.32, 6.65 um in class 5, times sqrt(2).
    t = tolerances(d=120.0, m=3.0, grade=6, b=30.0)
    assert t.f_pT / UM == pytest.approx(9.0, abs=EXACT)  # 8.94
    assert t.F_pT / UM == pytest.approx(29.0, abs=EXACT)  # 28.80
    assert t.f_HalphaT / UM == pytest.approx(7.5, abs=EXACT)  # 7.52
    assert t.f_falphaT / UM == pytest.approx(9.5, abs=EXACT)  # 9.40
    assert t.F_alphaT / UM == pytest.approx(12.0, abs=EXACT)  # 12.04; from rounded parts 12.10


def test_2013_total_profile_comes_from_unrounded_parts() -> None:
    # Formula (9): class 5, m 1, d 20 has slope 4.42 and form 5.55 um.
    bare = tolerances(d=20.0, m=1.0, grade=5, rounded=False)
    assert bare.F_alphaT == pytest.approx(math.hypot(bare.f_HalphaT, bare.f_falphaT), rel=1e-15)
    assert bare.F_alphaT / UM == pytest.approx(7.0950, abs=5e-5)  # four decimals by hand
    # m 6, d 600, class 6: 15.36 um; from the rounded parts 10 and 12 um it would be 15.62.
    assert tolerances(d=600.0, m=6.0, grade=6).F_alphaT / UM == pytest.approx(15.0, abs=EXACT)


@pytest.mark.parametrize("edition", [2013, 1995])
def test_grades_step_by_the_root_of_two(edition: int) -> None:
    low, high = RANGES[edition]["grade"]
    for grade in range(int(low), int(high)):
        fine = tolerances(d=50.0, m=2.0, grade=grade, edition=edition, rounded=False)
        coarse = tolerances(d=50.0, m=2.0, grade=grade + 1, edition=edition, rounded=False)
        for name in ("f_pT", "F_pT", "f_HalphaT", "f_falphaT", "F_alphaT"):
            ratio = getattr(coarse, name) / getattr(fine, name)
            assert ratio == pytest.approx(math.sqrt(2.0), rel=1e-14)  # float64


@pytest.mark.parametrize(
    ("value", "stated"),
    [
        (12.49, 12),
        (12.5, 13),
        (10.01, 10),
        (10.0, 10),
        (9.76, 10),
        (9.74, 9.5),
        (7.25, 7.5),
        (5.0, 5),
        (4.96, 5),
        (4.94, 4.9),
        (0.05, 0.1),
        (0.0, 0),
    ],
)
def test_rounding_rules(value: float, stated: float) -> None:
    assert round_tolerance(value) == pytest.approx(stated, abs=EXACT)


@pytest.mark.parametrize("edition", [2013, 1995])
@pytest.mark.parametrize("quantity", ["d", "m", "b", "grade"])
def test_no_extrapolation(edition: int, quantity: str) -> None:
    inside: dict[str, float] = {"d": 300.0, "m": 2.0, "b": 20.0, "grade": 6}
    for limit, step in zip(RANGES[edition][quantity], (-1, 1), strict=True):
        found = limit + step if quantity == "grade" else limit * (1.0 + 1e-6 * step)
        for value in (found, limit):
            values = inside | {quantity: value}
            # The other size follows, so that the number of teeth stays ordinary.
            if quantity == "m":
                values["d"] = 100.0 * value
            if quantity == "d":
                values["m"] = min(max(value / 100.0, 0.5), 70.0)
            if value == limit:
                tolerances(edition=edition, **values)  # type: ignore[arg-type]
                continue
            with pytest.raises(OutOfRangeError, match=rf"^{quantity} = .*{limit:g}"):
                tolerances(edition=edition, **values)  # type: ignore[arg-type]


@pytest.mark.parametrize("edition", [2013, 1995])
def test_the_nearest_size_in_range_says_what_is_likely_of_a_gear_beyond_it(edition: int) -> None:
    """A transfer gear of a telescope mount, 9 teeth of module 0.5, and a watch wheel of module 0.2."""
    least = tolerances(d=5.0, m=0.5, grade=5, edition=edition)
    for d, m in ((4.5, 0.5), (3.0, 0.2)):
        assert tolerances(d=d, m=m, b=1.0, grade=5, edition=edition, nearest=True) == least
    inside = tolerances(d=50.0, m=2.0, b=20.0, grade=5, edition=edition)
    assert tolerances(d=50.0, m=2.0, b=20.0, grade=5, edition=edition, nearest=True) == inside


def test_tooth_numbers_are_limited_in_2013_only() -> None:
    with pytest.raises(OutOfRangeError, match="z = 4 "):
        tolerances(d=8.0, m=2.0, grade=5)
    assert tolerances(d=8.0, m=2.0, grade=5, edition=1995).f_pT > 0.0
    with pytest.raises(OutOfRangeError, match="2013 or 1995"):
        tolerances(d=40.0, m=2.0, grade=5, edition=1975)


def test_default_thickness_gives_the_recommended_backlash() -> None:
    # ISO/TR 10064-2, a 100 mm and m 5 mm: 2/3 (0.06 + 0.05 + 0.15) = 0.1733 mm.
    E_sns, E_sni = default_thickness(a=100.0, m=5.0, alpha=20.0 * DEG, F_pT=0.02)
    assert -2.0 * E_sns * math.cos(20.0 * DEG) == pytest.approx(0.52 / 3.0, rel=1e-14)
    assert E_sns - E_sni == pytest.approx(0.04, rel=1e-14)


GEAR = Gear(z=18, m=2.0)
GRADE = tolerances(d=36.0, m=2.0, grade=5)
THICKNESS = (-0.05, -0.084)
COS = math.cos(GEAR.alpha)


def test_limits_of_a_grade() -> None:
    limits = limits_for(GEAR, grade=GRADE, thickness=THICKNESS)
    assert (limits.f_pT, limits.F_pT) == (GRADE.f_pT, GRADE.F_pT)
    assert (limits.f_HalphaT, limits.f_falphaT) == (GRADE.f_HalphaT, GRADE.f_falphaT)
    assert (limits.E_sns, limits.E_sni) == pytest.approx(THICKNESS, rel=1e-14)
    assert (limits.W_kns, limits.W_kni) == pytest.approx((-0.05 * COS, -0.084 * COS), rel=1e-14)


def test_nothing_known_is_an_ideal_gear() -> None:
    assert limits_for(GEAR) == Limits()


def test_stated_limits_go_before_the_grade() -> None:
    stated = {"f_pt": 0.0076, "F_alpha": 2 * GRADE.F_alphaT, "f_falpha": 0.001, "E_sni": -0.07}
    limits = limits_for(GEAR, grade=GRADE, stated=stated, thickness=THICKNESS)
    assert (limits.f_pT, limits.F_pT) == (0.0076, GRADE.F_pT)
    assert limits.f_HalphaT == pytest.approx(2 * GRADE.f_HalphaT, rel=1e-14)
    assert (limits.f_falphaT, limits.F_alphaT) == (0.001, 2 * GRADE.F_alphaT)
    assert (limits.E_sns, limits.E_sni) == (-0.05, -0.07)


def test_stated_limits_without_a_grade() -> None:
    # Ottewill's gears: measured maxima and nothing else. F_p must not bind, not vanish.
    limits = limits_for(GEAR, stated={"f_pt": 0.0076, "E_sni": -0.07, "F_alpha": 0.0051})
    assert limits.F_pT == pytest.approx(0.0076 * 9, rel=1e-14)
    assert limits.f_HalphaT == limits.f_falphaT == pytest.approx(0.0051 / math.sqrt(2.0), rel=1e-14)
    assert (limits.E_sns, limits.E_sni) == (0.0, -0.07)
    both = limits_for(GEAR, stated={"F_p": 0.03, "f_Halpha": 0.003, "f_falpha": 0.004})
    assert (both.f_pT, both.F_pT) == (0.03, 0.03)
    assert both.F_alphaT == pytest.approx(0.005, rel=1e-14)
    assert both.E_sni == pytest.approx(-0.06, rel=1e-14)


def test_default_thickness_gives_way_to_a_stated_lower_deviation() -> None:
    limits = limits_for(GEAR, grade=GRADE, stated={"E_sni": -0.02}, thickness=THICKNESS)
    assert (limits.E_sns, limits.E_sni) == (0.0, -0.02)


def test_base_tangent_limits_alone_set_the_thickness() -> None:
    limits = limits_for(GEAR, grade=GRADE, stated={"W_kns": -0.03, "W_kni": -0.06})
    assert (limits.E_sns, limits.E_sni) == pytest.approx((-0.03 / COS, -0.06 / COS), rel=1e-14)
    assert (limits.W_kns, limits.W_kni) == (-0.03, -0.06)


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ({"f_pt": -0.001}, "f_pT = -1 um"),
        ({"F_alpha": math.nan}, "is no tolerance"),
        ({"E_sns": math.inf}, "no deviation"),
        ({"E_sns": -0.07, "E_sni": -0.04}, "E_sni = -40 um lies above E_sns = -70 um"),
        ({"W_kns": -0.07, "W_kni": -0.04}, "lies above"),
        ({"f_pi": 0.001}, "f_pi is no limit; one of f_pt, F_p"),
    ],
)
def test_impossible_limits(stated: dict[str, float], message: str) -> None:
    with pytest.raises(OutOfRangeError, match=message):
        limits_for(GEAR, stated=stated)
