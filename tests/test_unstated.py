"""How far teeth deviate of which nobody says anything."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import scipy.stats

from gearpoly.compare.compare import compare
from gearpoly.diagnose.as_built import IDEAL_TEETH_STD_UM, GearPrior, chain, make_as_built
from gearpoly.diagnose.begin import before_claims
from gearpoly.diagnose.budget import Budget
from gearpoly.diagnose.fit import Fit
from gearpoly.diagnose.method import Method
from gearpoly.diagnose.prepare import base_prior, graded_prior
from gearpoly.diagnose.sparse import full
from gearpoly.diagnose.system import System
from gearpoly.diagnose.teeth_scale import (
    COARSEST,
    beside_finer,
    beyond_scale,
    counted,
    gain_beside_any,
    of_pitches,
    spread_of,
    wider,
)
from gearpoly.diagnose.trial import amplitude_std
from gearpoly.diagnose.unstated import (
    TEETH_SEEN_OVER_DOUBT,
    _step,
    as_fitted,
    between,
    grade_of,
    like_its_mate,
    limited,
    without_waves,
)
from gearpoly.files.models import GearSection, PairFile
from gearpoly.gear.chain import closed_chain
from gearpoly.gear.nominal import nominal_gears
from gearpoly.infer.unknown import plainest_first
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from tests.physics_cases import Condition, recorded, rough

Z = 40
KNOWN = 0.1


def seen(pitch: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
    return _step(pitch, KNOWN**2 * np.eye(Z))


def test_independent_teeth_step_by_the_root_of_two_of_what_they_deviate() -> None:
    """The variance of a difference is the sum of both, less what every tooth is known to; the median of 40 steps is
    known to a sixth (1.25 / sqrt(2 z) of a normal one, times the correlation of neighbours)."""
    rng = np.random.default_rng(3)
    found = [seen(rng.normal(0.0, 5.0, Z)) for _ in range(50)]
    assert np.mean(found) == pytest.approx(5.0 * math.sqrt(2.0), rel=0.05)


def test_an_eccentricity_or_one_tooth_off_its_place_says_nothing_of_the_others() -> None:
    rng = np.random.default_rng(4)
    angle = 2.0 * np.pi / Z * np.arange(Z)
    fine = rng.normal(0.0, KNOWN, Z)
    off = fine.copy()
    off[7] += 30.0
    assert seen(fine + 40.0 * np.cos(angle + 0.3)) == 0.0
    assert seen(off) == 0.0


def test_teeth_of_six_times_their_doubt_are_seen_and_what_wanders_is_not() -> None:
    """Printed teeth beneath coarse noise stood out by 4.7 and 5.9 times their doubt; a telescope's wander by 3.0."""
    rng = np.random.default_rng(5)
    found = [seen(rng.normal(0.0, 6.0 * KNOWN, Z)) for _ in range(50)]
    assert np.mean(np.array(found) > 0.0) > 0.9
    assert np.median(found) == pytest.approx(6.0 * math.sqrt(2.0) * KNOWN, rel=0.1)
    assert max(seen(rng.normal(0.0, 2.0 * KNOWN, Z)) for _ in range(50)) == 0.0


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("z", [18, 36])
def test_a_pitch_wave_says_nothing_of_the_other_teeth(order: int, z: int) -> None:
    """40 um of one order beside teeth that deviate by 3 um: the median step is that of the teeth alone, to what half of
    so few tell of it."""
    rng = np.random.default_rng(order)
    own = rng.normal(0.0, 3.0, z)
    wave = 40.0 * np.cos(2.0 * np.pi * order * np.arange(z) / z + 0.4)
    known = 1e-6 * np.eye(z)
    assert _step(own + wave, known) == pytest.approx(_step(own, known), rel=0.35)


@pytest.mark.long
def test_random_teeth_have_no_wave_that_stands_out() -> None:
    """By Fisher's test 1 in 1000 gears has one. Steps of drawn gears are not quite white, and 5 in 1000 were counted:
    of 200 more than 4 come in 1 of 250 such trials."""
    rng = np.random.default_rng(1)
    steps = between(36)
    drawn = [steps @ closed_chain(36, f=6.0, F=20.0, rng=rng) for _ in range(200)]
    assert sum(not np.allclose(without_waves(one), one, atol=1e-9) for one in drawn) <= 4


def test_what_is_hardly_more_than_its_doubt_counts_as_nothing() -> None:
    rng = np.random.default_rng(5)
    pitch = rng.normal(0.0, 1.0, Z)
    scale = TEETH_SEEN_OVER_DOUBT * KNOWN
    assert seen(0.3 * scale * pitch) == 0.0
    assert seen(3.0 * scale * pitch) > 0.0


def test_a_gear_smaller_than_the_standard_holds_has_a_prior_where_nobody_stated_a_grade() -> None:
    """9 teeth of module 0.5 are 4.5 mm across, and ISO 1328-1 begins at 5 mm: a mount's pair file could not be
    diagnosed. Single pitches of grade 5 are 5 + 0.4 m + 0.001 d um = 5.2 um there, rounded to 5.0 or 5.5 um."""
    small = PairFile(driving=GearSection(teeth=9, module_mm=0.5), driven=GearSection(teeth=47, module_mm=0.5))
    one = base_prior(small.driving, nominal_gears(small), 0)
    assert one.z == 9
    assert one.single == pytest.approx(5.0 * math.cos(math.radians(20.0)), abs=0.5)


def test_grades_are_a_root_of_two_apart() -> None:
    """ISO 1328-1:2013, 5.2."""
    assert [grade_of(2.0 ** (k / 2.0)) for k in (-4, -1, 0, 1, 2, 14)] == [1, 4, 5, 6, 7, 19]
    assert grade_of(1.01) == 6


def test_forms_of_one_cause_share_its_weight() -> None:
    assert plainest_first(1) == [1.0]
    assert sum(plainest_first(7)) == pytest.approx(1.0, abs=1e-15)
    assert plainest_first(7)[0] == 0.5


def test_a_gear_whose_teeth_say_nothing_is_made_like_its_mate() -> None:
    """One that is inspected or graded is not among those that nobody stated, and stays as it is."""
    assert like_its_mate({1: 4.0}, (0, 1)) == {0: 4.0, 1: 4.0}
    assert like_its_mate({0: 2.0, 1: 4.0}, (0, 1)) == {0: 2.0, 1: 4.0}
    assert like_its_mate({1: 4.0}, (1,)) == {1: 4.0}
    assert like_its_mate({}, (0, 1)) == {}


@pytest.mark.slow
def test_teeth_that_turn_out_coarser_beside_all_that_is_fitted_have_wider_limits(tmp_path: Path) -> None:
    """Teeth of 8 um rms, of which the first look told a third. What whole recordings tell of steps (8 um times the root
    of two) is what the limits are made of; a second look finds them so and leaves them."""
    rng = np.random.default_rng(6)
    off = {name: rng.normal(0.0, 8.0, z).round(3).tolist() for name, z in (("driving", 13), ("driven", 22))}
    section = {"module_mm": 2.0, "face_width_mm": 20.0, "points_per_flank": 200}
    made = {
        name: section | {"teeth": len(pitch), "inspection": {"pitch_um": pitch, "uncertainty_um": 0.2}}
        for name, pitch in off.items()
    }
    true = PairFile.model_validate({"model": {"tooth_deflection": False}, **made})
    (one,) = recorded(true, (Condition(torque_nm=0.0),), rng, cycles=2.0, per_mesh=12)
    bare = {name: section | {"teeth": len(pitch)} for name, pitch in off.items()}
    file = PairFile.model_validate({"model": {"tooth_deflection": False}, **bare})
    path = tmp_path / "pair.toml"
    comparison = compare(file, [one], path=path)
    model, waves = before_claims(file, comparison, path=path, method=Method(), budget=Budget())
    fine = limited(model, {0: 1.0, 1: 1.0})
    fit = Fit.begun(fine, waves, lambda _: None, trial=4)
    coarser = as_fitted(fit)
    assert coarser is not None
    wide, says = coarser
    again = Fit.begun(wide, waves, lambda _: None, trial=4)
    assert as_fitted(again) is None
    for gear, name in enumerate(off):
        steps = between(len(off[name])) @ np.array(off[name])
        single = math.sqrt(3.0) * float(np.std(steps))
        assert wide.as_built.gears[gear].single == pytest.approx(single, rel=0.5)
        assert "its teeth deviate as those of grade" in says[gear]


def test_twice_the_limits_are_twice_the_deviations() -> None:
    """As ``graded_prior`` draws a gear of twice the limits, but for the chain's own shape."""
    section = GearSection(teeth=20, module_mm=2.0, face_width_mm=20.0, grade=5)
    file = PairFile(driving=section, driven=section)
    fine, coarse = (graded_prior(section, nominal_gears(file), 0, by=by) for by in (1.0, 2.0))
    twice = wider(fine, 2.0)
    for name in ("slope", "mean_slope", "crowning", "thickness", "single", "wave"):
        assert getattr(twice, name) == pytest.approx(getattr(coarse, name), rel=1e-12)
    assert np.allclose(twice.pitch, coarse.pitch, atol=3.1 * IDEAL_TEETH_STD_UM**2)  # the doubt that any gear has


@pytest.mark.parametrize("freedom", [13.0, 40.0])
def test_teeth_of_unknown_scale_make_outliers_common(freedom: float) -> None:
    """Against quadrature over the scale s under 1/s: so many values with this sum of squares, and with the gain on top.
    With many teeth of just the spread that was thought it is the normal one, and nothing gains nothing."""

    scale = np.linspace(-5.0, 15.0, 200_001)

    def evidence(squares: float) -> float:
        return float(np.sum(np.exp(-freedom * scale - 0.5 * squares * np.exp(-2.0 * scale))))

    for spread in (8.0, freedom, 60.0):
        for gain in (0.0, 4.0, 29.0, 100.0):
            apart = 2.0 * math.log(evidence(spread) / evidence(spread + gain))
            assert beyond_scale(gain, spread=spread, freedom=freedom) == pytest.approx(apart, rel=1e-6, abs=1e-6)
    assert beyond_scale(29.0, spread=1e7, freedom=1e7) == pytest.approx(29.0, rel=1e-4)
    # Teeth that scatter more than was thought make it worth less, and the other way round.
    assert beyond_scale(29.0, spread=80.0, freedom=40.0) < 29.0 < beyond_scale(29.0, spread=20.0, freedom=40.0)


@pytest.mark.parametrize("freedom", [13.0, 40.0])
def test_teeth_that_keep_a_grade_are_as_fine_as_they_are_and_no_coarser(freedom: float) -> None:
    """Against quadrature over scales up to that of the grade; no gain counts for less than it is, and one of teeth at
    the grade hardly for more."""
    scale = np.linspace(-8.0, 0.0, 400_001)

    def evidence(squares: float) -> float:
        logs = -freedom * scale - 0.5 * squares * np.exp(-2.0 * scale)
        return float(np.max(logs) + np.log(np.sum(np.exp(logs - np.max(logs)))))

    for spread in (0.2 * freedom, freedom, 2.0 * freedom):
        for gain in (0.5, 4.0, 29.0, 400.0):
            apart = 2.0 * (evidence(spread) - evidence(spread + gain))
            found = beyond_scale(gain, spread=spread, freedom=freedom, stated=True)
            assert found == pytest.approx(apart, rel=2e-4)  # the last step of the quadrature counts by half
            assert found >= gain
    assert beyond_scale(29.0, spread=2.0 * freedom, freedom=freedom, stated=True) < 1.1 * 29.0
    # Where the tail comes near the end of doubles no ratio of it may be none.
    for gain in range(1000, 2200, 2):
        found = beyond_scale(float(gain), spread=0.5 * freedom, freedom=freedom, stated=True)
        assert gain <= found < 1.1 * gain


@pytest.mark.long
def test_the_likelihood_of_teeth_of_their_own_scale_is_that_of_their_mean_square(tmp_path: Path) -> None:
    """n log(S / n) + n is the least of n log s^2 + S / s^2 over s, here searched on a grid up to the grade."""
    file = rough((12, 16))
    graded = {"driving": file.driving.model_copy(update={"inspection": None, "grade": 6})}
    path = tmp_path / "pair.toml"
    (one,) = recorded(file, (Condition(torque_nm=0.0),), np.random.default_rng(4), cycles=2.0)
    known = file.model_copy(update=graded)
    comparison = compare(known, [one], path=path)
    model, waves = before_claims(known, comparison, path=path, method=Method(), budget=Budget(seconds=math.inf))
    fit = Fit.begun(model, waves, lambda _: None)
    claim = Claim(physics=catalogue()["tooth_pitch"], place=Place(gear=0, tooth=3, flank="drive"), values=(5.0,))
    spread, n = spread_of(fit.linear, model, 0, beside=claim)
    scale = np.exp(np.linspace(-6.0, 0.0, 60_001))

    def least(squares: float) -> float:
        return float(np.min(n * np.log(scale**2) + squares / scale**2))

    for gain in (9.0, 25.0, 120.0):
        assert beside_finer(fit.linear, model, claim, gain) == pytest.approx(
            least(spread + gain) - least(spread), rel=1e-4
        )
        assert beside_finer(fit.linear, model, claim, gain) >= gain
    assert of_pitches(model, claim)
    crack = Claim(physics=catalogue()["tooth_crack"], place=Place(gear=0, tooth=3, flank="drive"), values=(1.0,))
    assert not of_pitches(model, crack)  # teeth of no scale give more under load


@pytest.mark.parametrize("wider_by", [1.0, 2.0])
def test_the_spread_of_teeth_is_that_of_their_prior(wider_by: float) -> None:
    """Teeth drawn from a prior have a chi-square of as many freedoms about it, those of half that scale a quarter of
    it; all teeth as one have no scale. What the recordings do not tell of a tooth is expected to be as the prior has
    it. A tooth's claim takes one freedom, a wave's two. To four standard errors of a mean of 200 chi-squares."""
    z, rng = 25, np.random.default_rng(5)
    covariance = chain(z, single=10.0, cumulative=35.0)
    gears = tuple(
        GearPrior(z=n, pitch=chain(n, single=10.0 * wider_by, cumulative=35.0 * wider_by), slope=1.0, mean_slope=1.0,
                  crowning=1.0, thickness=1.0, shared=(0.5, 0.5), own=(0.0, 0.0), graded=True)
        for n in (18, z)
    )  # fmt: skip
    teeth = make_as_built((gears[0], gears[1]), ["drive"])
    at, draws = teeth.start("drive", 1), []
    tooth, wave = (SimpleNamespace(place=Place(gear=1, tooth=k), physics=SimpleNamespace(mean_tooth=False),
                                   values=(1.0, 1.0)) for k in (3, None))  # fmt: skip
    mate = SimpleNamespace(place=Place(gear=0, tooth=3), physics=SimpleNamespace(mean_tooth=False), values=(1.0,))
    for _ in range(200):
        solution = np.zeros(teeth.size)
        solution[at : at + z] = rng.multivariate_normal(np.zeros(z), covariance)
        system = SimpleNamespace(
            precision=teeth.precision, solution=solution, covariance=np.zeros_like(teeth.precision)
        )
        linear: Any = SimpleNamespace(layout=SimpleNamespace(built=slice(0, teeth.size)), system=system)
        model: Any = SimpleNamespace(as_built=teeth, claims=[tooth, wave, mate])
        draws.append(spread_of(linear, model, 1))
    assert np.mean([spread for spread, _ in draws]) == pytest.approx(
        1.0 + (z - 1.0) / wider_by**2, rel=4.0 * math.sqrt(2.0 / z / 200)
    )
    assert {freedom for _, freedom in draws} == {z - 3.0}
    linear.system.solution[:] = 0.0
    linear.system.covariance = np.linalg.inv(teeth.precision)
    assert spread_of(linear, model, 1)[0] == pytest.approx(z, rel=1e-9)


@pytest.mark.parametrize("z", [13, 24])
def test_one_of_teeth_of_unknown_scale_counts_as_student_has_it(z: int) -> None:
    """Index deviations that are read exactly, of which one stands out: its density beside the others is Student's, of
    one freedom fewer than there are teeth (Student 1908), here as scipy has it. Of a stated grade they are no coarser,
    and it counts for no less than it gained."""
    rng = np.random.default_rng(6)
    plain = GearSection(teeth=z, module_mm=1.0)
    gears = tuple(
        GearPrior(z=n, pitch=np.eye(n), slope=1.0, mean_slope=1.0, crowning=1.0, thickness=1.0, shared=(0.5, 0.5),
                  own=(0.0, 0.0), graded=True, single=1.0)
        for n in (z, 40)
    )  # fmt: skip
    teeth = make_as_built((gears[0], gears[1]), ["drive"])
    at, other = teeth.start("drive", 0), rng.normal(0.0, 1.0, z - 1)
    solution = np.zeros(teeth.size)
    solution[at + 1 : at + z] = other  # the claim has taken tooth 0
    system = SimpleNamespace(precision=teeth.precision, solution=solution, covariance=np.zeros_like(teeth.precision))
    linear: Any = SimpleNamespace(layout=SimpleNamespace(built=slice(0, teeth.size)), system=system)
    claim = Claim(physics=catalogue()["tooth_pitch"], place=Place(gear=0, tooth=0, flank="drive"), values=(5.0,))
    spread = float(other @ other)
    scatter = math.sqrt(spread / (z - 1))
    for off in (3.0, 8.0, 20.0):
        for grade in (None, 6):
            file = PairFile(driving=plain.model_copy(update={"grade": grade}), driven=plain)
            model: Any = SimpleNamespace(as_built=teeth, claims=[claim], declared=file)
            found = counted(linear, model, claim, off**2)
            if grade is None:
                density = scipy.stats.t(df=z - 1).logpdf([0.0, off / scatter])
                assert found == pytest.approx(2.0 * float(density[0] - density[1]), rel=1e-9)
            else:
                assert found >= off**2


def test_a_fault_of_pitch_is_at_least_what_its_gear_allows_a_single_one() -> None:
    """Of a gear whose single pitches may be 25 um off a fault is ordinarily as large; of a fine or an inspected one 4
    um, as of all else than pitches."""
    pitch, pit = (catalogue()[name] for name in ("tooth_pitch", "tooth_spall"))
    for single, graded, ordinary in ((25.0, True, 25.0), (2.0, True, 4.0), (25.0, False, 4.0)):
        gear = SimpleNamespace(graded=graded, single=single)
        model: Any = SimpleNamespace(as_built=SimpleNamespace(gears=(gear, gear)))
        off = Claim(physics=pitch, place=Place(gear=0, tooth=0), values=(1.0,))
        assert amplitude_std(model, off) == [ordinary]
        deep = Claim(physics=pit, place=Place(gear=0, tooth=0), values=(1.0, 8.0, 9.0, 0.1))
        assert amplitude_std(model, deep) == [pit.ordinary[0]]


def test_a_pit_gains_as_much_beside_teeth_of_any_scale_and_a_pitch_does_not() -> None:
    """24 teeth whose index deviations are known to 1 um beforehand and read to 0.1 um: 10 um of one tooth are unlikely
    by 50 standard deviations squared, and may be had by teeth of 16 times the scale. What no index deviation makes
    gains the same whatever the scale."""
    z, read = 24, 0.1
    gears = SimpleNamespace(z=z)
    base = GearPrior(
        z=z, pitch=np.eye(z), slope=1.0, mean_slope=1.0, crowning=1.0, thickness=1.0, shared=(0.5, 0.5), own=(0.0, 0.0),
        graded=True, single=1.0,
    )  # fmt: skip
    other = replace(base, z=3, pitch=np.eye(3))
    built = make_as_built((base, other), ["drive"])
    m = built.precision.shape[0]
    columns = np.zeros((z + 5, m + 1))
    columns[:z, :z] = np.eye(z)
    for effect, kept in (("pitch", False), ("pit", True)):
        mine = np.zeros(z + 5)
        mine[7 if effect == "pitch" else z + 2] = 1.0
        columns[:, m] = mine
        precision = np.zeros((m + 1, m + 1))
        precision[:m, :m] = built.precision
        system = System(
            white=[full(columns / read)], target=[10.0 * mine / read], precision=precision, prior=np.zeros(m + 1)
        )
        layout = SimpleNamespace(built=slice(0, m), places=lambda k: [m], form_places=lambda model, k: [])
        linear: Any = SimpleNamespace(
            system=system, layout=layout, white_of=lambda k, white=columns: [white[:, m:] / read]
        )
        one = SimpleNamespace(key="one")
        model: Any = SimpleNamespace(claims=[one], as_built=built, scope=SimpleNamespace(gears=[gears]))
        bare = system.without([m])
        gain = bare.misfit - bare.with_columns(linear.white_of(0)).misfit
        left = gain_beside_any(linear, model, 0, cast(Any, one))
        if kept:
            assert left == pytest.approx(gain, rel=1e-9) == pytest.approx((10.0 / read) ** 2)
        else:
            # 10^2 / (1 + 0.1^2), and 16^2 times less.
            assert gain == pytest.approx(100.0 / 1.01, rel=1e-6)
            assert left == pytest.approx(100.0 / (COARSEST**2 + 0.01), rel=1e-3)
