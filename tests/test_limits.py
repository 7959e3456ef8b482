"""Limits and grades against teeth that are known with errors: nobody is accused by chance, what is plain is told."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.diagnose.as_built import GearPrior, make_as_built, on_its_own
from gearpoly.diagnose.built import built_gears
from gearpoly.diagnose.limits import (
    Exceeded,
    allowance,
    exceeded,
    figures_of,
    grade_kept,
    grade_needed,
    graded_by_iso,
    limits_of,
)
from gearpoly.diagnose.linear import Layout
from gearpoly.diagnose.running import Running, running
from gearpoly.diagnose.unearned import Unearned
from gearpoly.files.models import GearSection, PairFile
from gearpoly.gear.chain import closed_chain
from gearpoly.gear.tolerances import tolerances
from gearpoly.infer.posterior import Posterior
from gearpoly.mesh.pair import Flank
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.report.diagnosis_report import _built_json
from gearpoly.units import UM, FloatArray

Z, MATE = 17, 12
ALPHA = math.radians(20.0)


def section(z: int = Z, **keys: Any) -> GearSection:
    return GearSection.model_validate({"teeth": z, "module_mm": 2.0, "face_width_mm": 20.0} | keys)


def flank(pitch: FloatArray, slope: FloatArray, error: float, *, side: Flank = "drive") -> Running:
    """Teeth whose every pitch and slope is known to ``error`` um."""
    z = pitch.size
    cov = error**2 * np.eye(z)
    return Running(flank=side, pitch=pitch, pitch_covariance=cov, slope=slope, slope_covariance=cov, noise=np.eye(z))


def judged(section: GearSection, pitch: FloatArray, slope: FloatArray, error: float) -> list[Exceeded]:
    figures = figures_of([flank(pitch, slope, error)], math.cos(ALPHA), None)
    return [found for limit in limits_of(section) if (found := exceeded(figures, limit)) is not None]


def test_one_figure_needs_two_standard_errors_and_the_worst_of_many_more() -> None:
    assert allowance(1) == pytest.approx(2.0)
    # One in 44 among 34 errors is one in 1495 each: 3.2 standard deviations of a normal distribution.
    assert allowance(2 * Z) == pytest.approx(3.2, abs=0.02)


@pytest.mark.parametrize("error", [0.1, 2.0, 20.0])
def test_a_gear_at_its_limits_is_not_accused_by_chance(error: float) -> None:
    """Every other step is the whole single pitch limit, every slope its limit: the worst case. In 400 gears a rate of
    1 in 44 per kind makes 9 +- 3; three kinds, half of them by a bound that overcounts, stay below 27 + 3 x 5."""
    rng = np.random.default_rng(3)
    made = section(limits={"f_pt_um": 7.0, "F_p_um": 7.0, "f_Halpha_um": 5.0})
    pitch = np.where(np.arange(Z) % 2 == 0, 0.0, 7.0) * math.cos(ALPHA)
    slope = np.where(np.arange(Z) % 3 == 0, -5.0, 5.0)
    accused = sum(
        bool(judged(made, pitch + error * rng.normal(size=Z), slope + error * rng.normal(size=Z), error))
        for _ in range(400)
    )
    assert accused < 42


def test_what_is_plainly_beyond_a_stated_limit_is_told_with_its_tooth() -> None:
    """A tooth 12 um ahead: 12 / cos(alpha) = 12.8 um between it and its neighbour, 5.8 um over 7 um. The limits hold
    without any grade, and the one that was not stated accuses nobody."""
    made = section(limits={"f_pt_um": 7.0})
    pitch = 12.0 * (np.arange(Z) == 5)
    (found,) = judged(made, pitch, 40.0 * np.ones(Z), 0.1)
    assert found.teeth in ((4, 5), (5, 6))
    assert found.by == pytest.approx(12.0 / math.cos(ALPHA) - 7.0)
    # Two independent errors of 0.1 um, along the reference circle.
    assert found.std == pytest.approx(0.1 * math.sqrt(2.0) / math.cos(ALPHA))
    says = found.says("driving")
    assert "the driving gear's single pitch between teeth" in says
    assert "12.8 +- 0.2 um, 5.8 um above the 7 um of the stated f_pt_um" in says


@pytest.mark.parametrize(
    ("limits", "slope_um", "key"),
    [
        ({"F_alpha_um": 6.0}, 8.0, "F_alpha_um"),
        ({"F_alpha_um": 6.0}, 5.5, None),
        ({"F_alpha_um": 9.0, "f_Halpha_um": 6.0}, 8.0, "f_Halpha_um"),
        ({"F_alpha_um": 9.0}, -9.9, "F_alpha_um"),
    ],
)
def test_a_slope_is_held_to_its_own_limit_or_to_that_of_the_whole_profile(
    limits: dict[str, float], slope_um: float, key: str | None
) -> None:
    """A profile that leans by s ranges over at least about s, so a slope beyond F_alpha breaks it."""
    found = judged(section(limits=limits), np.zeros(Z), slope_um * (np.arange(Z) == 3), 0.1)
    assert [one.limit.key for one in found] == ([] if key is None else [key])
    assert all(one.teeth == (3,) for one in found)


def test_stated_limits_go_over_the_grade_s() -> None:
    """A step of 9.6 um is beyond the 7.5 um of grade 5 and within a stated 11 um; the other way round it is beyond."""
    pitch = 9.0 * (np.arange(Z) == 5)
    loose = judged(section(grade=5, limits={"f_pt_um": 11.0}), pitch, np.zeros(Z), 0.1)
    assert loose == []
    (tight,) = judged(section(grade=8, limits={"f_pt_um": 5.0}), pitch, np.zeros(Z), 0.1)
    assert tight.limit.key == "f_pt_um"
    graded = judged(section(grade=5), pitch, np.zeros(Z), 0.1)
    assert [one.limit.grade for one in graded] == [5]
    assert "of grade 5" in graded[0].says("driven")


def test_an_inspected_gear_is_held_to_no_grade() -> None:
    assert limits_of(section(grade=5, inspection={"pitch_um": 0.0})) == []


@pytest.mark.parametrize(("offset", "key", "side"), [(6.0, "E_sns_um", "above"), (-6.0, "E_sni_um", "below")])
def test_teeth_too_thick_or_too_thin_are_told(offset: float, key: str, side: str) -> None:
    made = section(limits={"f_pt_um": 90.0, "F_p_um": 90.0, "E_sns_um": -40.0, "E_sni_um": -70.0})
    edge = -40.0 if offset > 0.0 else -70.0
    for by, told in ((offset, True), (-offset, False)):
        thick = np.full(Z, -55.0)
        thick[7] = edge + by
        figures = figures_of([flank(np.zeros(Z), np.zeros(Z), 0.1)], 1.0, (thick, 0.3**2 * np.eye(Z)))
        found = [one for limit in limits_of(made) if (one := exceeded(figures, limit)) is not None]
        assert [(one.limit.key, one.teeth) for one in found] == ([(key, (7,))] if told else [])
        assert all(f"6.0 um {side} the {edge:g} um" in one.says("driven") for one in found)


@pytest.mark.long
def test_a_healthy_gear_needs_no_coarser_grade_than_its_own() -> None:
    """200 gears drawn within grade 6, known as well as recordings tell such teeth (0.6 um of pitch, 2.8 um of slope on
    account of their form): hardly one in 44 is called coarser; taken at face value, most would be."""
    rng = np.random.default_rng(11)
    limit = tolerances(d=2.0 * Z, m=2.0, b=20.0, grade=6)
    coarser, at_face_value = 0, 0
    for _ in range(200):
        pitch = closed_chain(Z, f=limit.f_pT / UM, F=limit.F_pT / UM, rng=rng) * math.cos(ALPHA)
        slope = rng.uniform(-1.0, 1.0, Z) * limit.f_HalphaT / UM
        one = flank(pitch + 0.6 * rng.normal(size=Z), slope + 2.8 * rng.normal(size=Z), 1.0)
        for doubted in (True, False):
            known = Running(
                flank="drive", pitch=one.pitch, slope=one.slope, noise=one.noise,
                pitch_covariance=(0.6 * doubted) ** 2 * np.eye(Z), slope_covariance=(2.8 * doubted) ** 2 * np.eye(Z),
            )  # fmt: skip
            needed = grade_needed(section(), figures_of([known], math.cos(ALPHA), None))
            worse = needed is None or needed > 6
            coarser, at_face_value = coarser + (doubted and worse), at_face_value + (not doubted and worse)
    assert coarser <= 10
    assert at_face_value > 100


@pytest.mark.long
def test_a_grade_that_is_surely_kept_is_never_finer_than_the_gear() -> None:
    """The same gears, whose own figures need a grade that is known: what is surely kept is that or coarser in all but
    one of 44 of each kind, and with errors of nothing both are one."""
    rng = np.random.default_rng(12)
    limit = tolerances(d=2.0 * Z, m=2.0, b=20.0, grade=6)
    finer, apart = 0, []
    for _ in range(200):
        pitch = closed_chain(Z, f=limit.f_pT / UM, F=limit.F_pT / UM, rng=rng) * math.cos(ALPHA)
        slope = rng.uniform(-1.0, 1.0, Z) * limit.f_HalphaT / UM
        exact, read = (
            Running(
                flank="drive", pitch=pitch + error * 0.6 * rng.normal(size=Z),
                slope=slope + error * 0.5 * rng.normal(size=Z), noise=1.0,
                pitch_covariance=(0.6 * error) ** 2 * np.eye(Z), slope_covariance=(0.5 * error) ** 2 * np.eye(Z),
            ) for error in (0.0, 1.0)
        )  # fmt: skip
        true, kept = (grade_kept(section(), figures_of([one], math.cos(ALPHA), None)) for one in (exact, read))
        assert true == grade_needed(section(), figures_of([exact], math.cos(ALPHA), None))
        assert true is not None and kept is not None
        finer += kept < true
        apart.append(kept - true)
    assert finer <= 3 * 200 / 44
    assert 0.0 < float(np.mean(apart)) < 2.0


def prior(z: int) -> GearPrior:
    return GearPrior(
        z=z, pitch=on_its_own(z, 3.0), slope=3.0, mean_slope=0.0, crowning=0.01, thickness=3.0, shared=(0.5, 0.5),
        own=(0.0, 0.0), graded=True,
    )  # fmt: skip


def searched(*claims: Claim, thickness_um: float = 0.0) -> tuple[Any, PairFile]:
    """A search that ended with perfect teeth, all parameters known to 0.1 um, and these claims."""
    gears = {name: section(z, grade=5).model_dump() for name, z in (("driving", Z), ("driven", MATE))}
    file = PairFile.model_validate(gears)
    known = {
        name: one | {"grade": None, "inspection": {"tooth_thickness_um": thickness_um}} for name, one in gears.items()
    }
    as_built = make_as_built((prior(Z), prior(MATE)), ["drive", "coast"])
    at, places = as_built.size, []
    for claim in claims:
        places.append(slice(at, at + len(claim.values)))
        at += len(claim.values)
    model = SimpleNamespace(
        declared=PairFile.model_validate(known), as_built=as_built, built=np.zeros(as_built.size), claims=list(claims),
        scope=SimpleNamespace(gears=(SimpleNamespace(alpha=ALPHA),) * 2, others_at=lambda gear, order: ()),
    )  # fmt: skip
    none = slice(as_built.size, as_built.size)
    layout = Layout(built=slice(0, as_built.size), nuisance=none, foreign=none, forms=none, claims=places)
    system = SimpleNamespace(size=at, covariance=0.01 * np.eye(at))
    turn = np.linspace(0.0, 2.0 * math.pi, 500)
    whole = SimpleNamespace(samples=SimpleNamespace(theta_1=turn, theta_2=turn))
    return SimpleNamespace(model=model, linear=SimpleNamespace(system=system, layout=layout), scenes=[whole]), file


def claim(name: str, values: tuple[float, ...], **place: Any) -> Claim:
    return Claim(physics=catalogue()[name], place=Place(gear=0, **place), values=values)


@pytest.mark.parametrize(
    "one",
    [
        claim("tooth_pitch", (20.0,), tooth=4, flank="drive"),
        claim("tooth_pitch", (-20.0,), tooth=4, flank="coast"),
        claim("tooth_pitch", (20.0,), tooth=4),
        claim("cumulative_pitch", (18.0, -9.0), order=2),
        claim("profile_slope", (-15.0,)),
    ],
    ids=["drive", "coast", "both", "wave", "slope"],
)
def test_a_gear_runs_as_coarse_as_what_is_claimed_of_it(one: Claim) -> None:
    """20 um over a declared grade 5 of 7.5 um a step, or 15 um of slope over 5 um, is at least grade 8 (three steps of
    sqrt(2) are 2.8). Its other teeth are as they were; the mate keeps the finest grade; a claim is not as built."""
    search, file = searched(one)
    driving, driven = built_gears(search, file, left=1.0)
    assert driving.grade_needed is not None and driving.grade_needed >= 8
    assert driven.grade_needed == 1
    assert driving.exceeded and {found.limit.grade for found in driving.exceeded} == {5}
    assert all(np.allclose(built.pitch, 0.0) and np.allclose(built.slope, 0.0) for built in driving.flanks)
    assert driven.exceeded == ()
    if one.place.tooth is not None:
        assert all(4 in found.teeth for found in driving.exceeded)
    told = _built_json(driving)
    assert told["grade_needed"] == driving.grade_needed
    assert {found["grade"] for found in told["exceeds"]} == {5}


def test_no_gear_is_accused_of_what_is_not_understood() -> None:
    """A tooth 20 um off breaks grade 5 where the fit is at rest, and nothing is said where unseen data are left at 1.3
    times what is expected, where something at every mesh has no sure cause, and where another part turns with it."""
    search, file = searched(claim("tooth_pitch", (20.0,), tooth=4))
    assert built_gears(search, file, left=1.19)[0].exceeded
    of_all = Unearned(claim=claim("profile_slope", (150.0,)), rms=0.02, posterior=None)
    gone = Unearned(claim=of_all.claim, rms=0.02, posterior=Posterior(claims=(), unknown=0.4, nothing=0.6))
    one = Unearned(claim=claim("tooth_pitch", (3.0,), tooth=2), rms=0.002, posterior=None)
    assert built_gears(search, file, left=1.0, unearned=[one, gone])[0].exceeded
    doubted = [
        built_gears(search, file, left=1.3),
        built_gears(search, file, left=1.0, unearned=[one, of_all]),
    ]
    for gears, words in zip(doubted, ("1.3 times what is expected", "every mesh"), strict=True):
        for gear in gears:
            assert words in gear.ungraded and gear.ungraded.endswith("no grade is told")
            assert gear.exceeded == () and gear.grade_needed is None and gear.grade_kept is None
            assert _built_json(gear)["exceeds"] == []
    search.model.scope.others_at = lambda gear, order: ("the motor's turn",) if (gear, order) == (0, 1) else ()
    driving, driven = built_gears(search, file, left=1.0)
    assert "the motor's turn" in driving.ungraded and driving.exceeded == ()
    assert driven.ungraded == "" and driven.grade_needed == 1


def test_a_tooth_of_both_flanks_moves_its_flanks_apart_in_material_only() -> None:
    """A tooth 20 um ahead has as much more on its drive flank as less on its coast flank: its thickness stays."""
    search, file = searched(claim("tooth_pitch", (20.0,), tooth=4), thickness_um=-55.0)
    stated = {"limits": {"E_sns_um": -50.0, "E_sni_um": -60.0}, "grade": None}
    file = file.model_copy(update={"driving": section(**stated)})
    driving, _ = built_gears(search, file, left=1.0)
    assert driving.exceeded == ()
    assert driving.thickness is not None
    assert driving.thickness[0] == pytest.approx(-55.0)


def test_what_else_is_claimed_is_no_matter_of_the_grade() -> None:
    """An eccentric gear is as well cut as before; its mounting is at fault."""
    search, file = searched(claim("eccentricity", (40.0, 0.0)))
    assert built_gears(search, file, left=1.0)[0].grade_needed == 1


def test_both_flanks_stand_in_the_verdict() -> None:
    """The coast flank has errors of its own, and the grade is broken by one that the drive flank does not have."""
    search, file = searched()
    model = search.model
    model.as_built.pitch(model.built, "coast", 0)[6] = 15.0
    model.as_built.slope(model.built, "drive", 0)[2] = 3.0
    driving, _ = built_gears(search, file, left=1.0)
    told = _built_json(driving)
    assert told["flanks"] == ["drive", "coast"]
    for key in ("pitch", "pitch_coast", "profile_slope", "profile_slope_coast"):
        assert len(told[f"{key}_um"]) == len(told[f"{key}_std_um"]) == Z
    # About their mean, of which one tooth in 17 has a seventeenth.
    assert told["pitch_coast_um"][6] == pytest.approx(15.0 * (1.0 - 1.0 / Z), abs=1e-4)
    assert told["pitch_um"] == pytest.approx([0.0] * Z)
    assert told["profile_slope_um"][2] == 3.0
    # Pitch errors of 0.1 um about the mean of 17: sqrt(16/17) of them.
    assert told["pitch_coast_std_um"][0] == pytest.approx(0.1 * math.sqrt(1.0 - 1.0 / Z), abs=1e-4)
    assert told["tooth_thickness_std_um"] == pytest.approx(0.1 * math.sqrt(2.0 / Z) / math.cos(ALPHA), rel=1e-3)
    assert {one.flank for one in driving.exceeded} == {"coast"}


def test_what_two_graded_gears_lean_alike_accuses_neither() -> None:
    """Flanks that lean alike touch as upright ones do; what they lean apart shows, and each has half of it."""
    search, file = searched()
    model = search.model
    for gear, lean in ((0, 40.0), (1, 40.0)):
        model.as_built.slope(model.built, "drive", gear)[:] = lean
    for gear, lean in ((0, 24.0), (1, 0.0)):
        model.as_built.slope(model.built, "coast", gear)[:] = lean
    for one, apart in zip(built_gears(search, file, left=1.0), (12.0, -12.0), strict=True):
        assert one.first.slope == pytest.approx(np.zeros(one.first.slope.size))
        assert one.coast is not None
        assert one.coast.slope == pytest.approx(np.full(one.coast.slope.size, apart))
        assert {found.flank for found in one.exceeded} == {"coast"}


def test_a_limit_holds_as_far_as_two_graded_gears_may_lean_alike() -> None:
    """The half of either's own mean slope that does not show is doubt, whether something is claimed or not."""
    search, _ = searched()
    mean = 6.0
    known = search.model.as_built
    first, second = (replace(one, mean_slope=mean) for one in known.gears)
    search.model.as_built = replace(known, gears=(first, second))
    for claimed in (False, True):
        one = running(search, 0, "drive", claimed=claimed)
        alike = one.slope_covariance[0, 1]
        assert alike == pytest.approx(0.5 * mean**2, rel=1e-6)


def test_iso_grades_gears_of_half_a_module_and_five_millimetres_on() -> None:
    """ISO 1328-1:2013, clause 1: modules from 0.5 mm and reference diameters from 5 mm on."""
    assert not graded_by_iso(section(60, module_mm=0.3))
    assert not graded_by_iso(section(9, module_mm=0.5))
    assert graded_by_iso(section(17, module_mm=0.5))
