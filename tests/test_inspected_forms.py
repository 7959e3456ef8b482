"""What an inspection does not hold is as gears of its grade have it, and no fault."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gearpoly.diagnose.as_built import GRADE_LIMIT_SIGMAS, IDEAL_TEETH_STD_UM
from gearpoly.diagnose.prepare import BASE, MEAN_SLOPE_PART, form_of, gear_priors
from gearpoly.files.models import GearSection, Inspection
from gearpoly.gear.tolerances import tolerances
from gearpoly.keys.edit import changed
from gearpoly.units import UM
from tests.physics_cases import rough

Z = 12
PITCH = tuple(np.round(3.0 * np.cos(2.0 * np.arange(Z)), 2).tolist())


def driving(*, grade: int | None = None, **sheet: Any) -> GearSection:
    """The driving gear with such an inspection, and the grade stated beside it."""
    section = changed(rough(z=(Z, 16)).driving, grade=grade, limits=None)
    return changed(section, inspection=Inspection(pitch_um=PITCH, uncertainty_um=0.5, **sheet))


def prior(section: GearSection) -> Any:
    return gear_priors(changed(rough(z=(Z, 16)), driving=section))[1][0]


def form_limit(section: GearSection, grade: int) -> float:
    """f_falpha of a grade in um, by ISO 1328-1 itself."""
    found = tolerances(d=section.teeth * section.module_mm, m=section.module_mm, grade=grade, edition=2013)
    return float(found.f_falphaT) / UM


def test_a_sheet_of_pitch_and_slope_leaves_forms_to_the_grade() -> None:
    """Half of the variance of a form that ranges over the limit at two standard deviations is common to all teeth."""
    section = driving(grade=6, profile_slope_um=(0.0,) * Z)
    one = prior(section)
    assert not one.graded
    assert one.slope == 0.5 and one.slope_measured
    assert one.bulge == pytest.approx(form_limit(section, 6) / 2.0 / np.sqrt(2.0), rel=1e-6)
    assert one.crowning == IDEAL_TEETH_STD_UM  # no parameter
    assert form_of(one) == 0.5 * one.bulge
    assert one.wave == pytest.approx(0.113 * form_limit(section, 6), rel=1e-6)


def test_slopes_that_nobody_measured_are_not_taken_for_none() -> None:
    one = prior(driving(grade=6))
    assert not one.slope_measured
    assert one.slope > 4.0 * 0.5
    assert one.mean_slope == pytest.approx(MEAN_SLOPE_PART * GRADE_LIMIT_SIGMAS * np.sqrt(2.0) * one.slope)


def test_what_a_sheet_holds_it_holds() -> None:
    crowned = prior(driving(grade=6, profile_slope_um=(0.0,) * Z, profile_crowning_um=2.0))
    assert crowned.bulge == 0.0
    assert crowned.wave > 0.0
    traced = prior(driving(grade=6, profile_slope_um=(0.0,) * Z, profile_form_um=((0.1, 0.0),) * Z))
    assert traced.wave == 0.0


def test_without_a_grade_the_measured_slopes_tell_it() -> None:
    """Slopes that scatter by sqrt(0.5^2 + 2^2) um read to 0.5 um scatter by 2 um. So do teeth whose slopes, of which
    half the variance is their own, reach 4 sqrt(2) um of f_Halpha at two standard deviations. Forms are as much finer
    or coarser than those of grade 5."""
    slopes = tuple(np.sqrt(0.25 + 4.0) * np.array([1.0, -1.0] * (Z // 2)))
    section = driving(profile_slope_um=slopes)
    limits = tolerances(d=Z * section.module_mm, m=section.module_mm, grade=BASE, edition=2013)
    by = 4.0 * np.sqrt(2.0) / (float(limits.f_HalphaT) / UM)
    assert prior(section).wave == pytest.approx(by * 0.113 * form_limit(section, BASE), rel=1e-6)


def test_without_slopes_the_steps_of_the_pitches_tell_it() -> None:
    """Steps of +-4 um in turn: a variance of 16 um^2, of which the two readings make 0.5; even within +-f_p that is
    f_p = sqrt(3 * 15.5) um normal to the flank."""
    sheet = Inspection(pitch_um=tuple([2.0, -2.0] * (Z // 2)), uncertainty_um=0.5)
    section = changed(driving(), inspection=sheet)
    limits = tolerances(d=Z * section.module_mm, m=section.module_mm, grade=BASE, edition=2013)
    by = np.sqrt(3.0 * 15.5) / (float(limits.f_pT) / UM * np.cos(np.radians(20.0)))
    one = prior(section)
    assert one.wave == pytest.approx(by * 0.113 * form_limit(section, BASE), rel=1e-6)
    assert not one.slope_measured


def test_a_sheet_of_teeth_that_do_not_differ_tells_no_grade() -> None:
    section = changed(driving(), inspection=Inspection(profile_slope_um=(1.0,) * Z))
    assert prior(section).wave == 0.0
