"""Slopes beyond the grade of gears that run without load: the fit is not caught where both gears bulge, and teeth as
built give way to a claim."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.diagnose.contest import _elsewhere, _likenesses, contest
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.fit import Fit, joined
from gearpoly.diagnose.placing import PHASES_TRIED, anywhere
from gearpoly.diagnose.prepare import prepare
from gearpoly.diagnose.relaxed import from_declared
from gearpoly.diagnose.scan import Candidate, scan
from gearpoly.diagnose.search import withdrawn
from gearpoly.errors import GeometryError
from gearpoly.files.models import PairFile
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.recording.recording import Recording
from tests.made_fits import MadeFit
from tests.physics_cases import Condition, recorded, rough, scope_of
from tests.test_fit_places import UNLOADED, made_gears

SLOPE = -30.0
"""um. Grade 6 leaves 7.5 um to every tooth of these gears."""


def leaning() -> tuple[PairFile, list[Recording]]:
    """What is declared of a pair of grade 6, and its recording without load while all driven teeth lean by 30 um."""
    true, known = made_gears(np.random.default_rng(7), off_um=30.0)
    sheet = true.driven.inspection
    assert sheet is not None and isinstance(sheet.profile_slope_um, tuple)
    leant = sheet.model_copy(update={"profile_slope_um": tuple(SLOPE + one for one in sheet.profile_slope_um)})
    true = true.model_copy(update={"driven": true.driven.model_copy(update={"inspection": leant})})
    return known, recorded(true, (UNLOADED,), np.random.default_rng(3), cycles=4.0)


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """The fit of the declared pair before anything is claimed."""
    known, recordings = leaning()
    path = tmp_path_factory.mktemp("leaning") / "pair.toml"
    model = prepare(known, compare(known, recordings, path=path), path=path)
    return from_declared(model, [np.zeros((model.observed[0].samples.size, 0))], lambda _: None)


@pytest.mark.slow
def test_gears_do_not_bulge_where_they_lean(begun: Fit) -> None:
    """True gears of this pair have no crowning; three standard deviations of it hardly any gear of the grade has."""
    built, values = begun.model.as_built, begun.model.built
    for gear in (0, 1):
        assert abs(built.crowning(values, "drive", gear)) < 3.0 * built.gears[gear].crowning


@pytest.mark.slow
def test_a_claim_takes_over_from_the_teeth(begun: Fit) -> None:
    """Teeth as built lean already as far as they may: with a slope claimed on top of that the pair would run otherwise
    than it was recorded, while a claim that they give way to changes little."""
    found, _ = scan(begun.model, begun.scenes, begun.linear)
    slope = next(c for c in found if c.claim.physics.name == "profile_slope" and c.claim.place.gear == 1)
    assert slope.claim.values[0] == pytest.approx(SLOPE, rel=0.5)
    claimed = (*begun.model.claims, slope.claim)
    ways = {"joined": joined(begun, [slope.claim]), "on top": begun.believing(claims=claimed)}
    misfits = {}
    for way, one in ways.items():
        there = replace(one, scenes=one.model.scenes()).linearised()
        misfits[way] = there.linear.system.misfit_at(there.present())
    assert misfits["joined"] < begun.linear.system.misfit + 100.0
    assert misfits["on top"] > misfits["joined"] + 1000.0


@pytest.mark.slow
def test_places_are_counted_whatever_is_claimed_already(begun: Fit) -> None:
    """Or a claim would have to beat fewer of its like when it is asked for again."""
    found, before = scan(begun.model, begun.scenes, begun.linear)
    there = joined(begun, [next(c.claim for c in found if c.claim.physics.name == "profile_slope")]).linearised()
    _, after = scan(there.model, there.scenes, there.linear)
    assert after == before
    teeth = sum(gear.z for gear in begun.model.scope.gears)
    assert before.own["tooth_spall"] == teeth < before.teeth["tooth_spall"]
    assert before.whole["profile_slope"] == 2


@pytest.mark.slow
def test_a_slope_beyond_the_grade_is_the_first_cause_of_its_place(tmp_path: Path) -> None:
    """What shows to first order is how much both gears lean apart; a shorter centre distance explains less of it. On
    one flank a wrong pressure angle of the pair file does the same, so it earns no name."""
    known, recordings = leaning()
    diagnosis = diagnose(known, recordings, path=tmp_path / "pair.toml")
    assert not diagnosis.findings
    (place,) = (one for one in diagnosis.unexplained if one.kind == "mesh_phase")
    first = place.could_be[0]
    assert (first.physics, first.gear) == ("profile_slope", "driven")
    # Its standard error holds how much the teeth of both gears may lean by their grade, some 5 um.
    assert dict(first.parameters)["slope_um"] == pytest.approx(SLOPE, abs=15.0)
    assert "centre_distance" not in {one.physics for one in place.could_be}


@dataclass(kw_only=True, eq=False)
class Ends(MadeFit):
    """A fit whose claim fits with the misfit ``ends`` says, fitted again or not, "nothing" without any."""

    ends: dict[str, float]

    @property
    def misfit(self) -> float:
        return self.ends.get(self.model.claims[0].key if self.model.claims else "nothing", math.inf)

    def __post_init__(self) -> None:
        system = SimpleNamespace(misfit=self.misfit)
        self.linear = SimpleNamespace(system=system, under=lambda noises: SimpleNamespace(system=system))


def ended(ends: dict[str, float], *claims: Any, graded: bool = False) -> Any:
    gears = (SimpleNamespace(graded=graded), SimpleNamespace(graded=False))
    model = SimpleNamespace(
        phased=True, stated=True, claims=claims or (named("first"),), as_built=SimpleNamespace(gears=gears)
    )
    return Ends(model=model, ends=ends, scenes=(SimpleNamespace(bends=True),))


def exchanged(fit: Any, claims: Any, *, instead: Any) -> Any:
    (k,) = instead
    return fit.believing(claims=(*fit.model.claims[:k], *claims, *fit.model.claims[k + 1 :]))


def gained_since(fit: Any, before: Any) -> float:
    """Misfit, and 2 for each claim."""
    return float(before.misfit - fit.misfit + 2.0 * (len(before.model.claims) - len(fit.model.claims)))


@pytest.fixture
def broken(request: pytest.FixtureRequest) -> str:
    """The claim, or "nothing", with which a pair cannot turn; none unless a test says so."""
    return str(getattr(request, "param", ""))


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, broken: str) -> list[str]:
    """What the made fits below were asked for: they rest wherever they are, unless ``broken``, and gains of more than
    20 are significant."""
    asked: list[str] = []

    def settled(fit: Any) -> Any:
        if broken in [claim.key for claim in fit.model.claims] or (broken == "nothing" and not fit.model.claims):
            raise GeometryError("tip below base")
        return fit

    def told(name: str) -> Any:
        return lambda fit: asked.append(name) or fit

    for module in ("search", "contest"):
        monkeypatch.setattr(f"gearpoly.diagnose.{module}.joined", exchanged)
        monkeypatch.setattr(f"gearpoly.diagnose.{module}.settled", settled)
        monkeypatch.setattr(f"gearpoly.diagnose.{module}.relaxed", lambda fit: fit)
        monkeypatch.setattr(f"gearpoly.diagnose.{module}.gained_since", gained_since)
    monkeypatch.setattr("gearpoly.diagnose.search.significant", lambda fit, one: one.gain > 20.0)
    for name in ("with_declared_law", "with_best_law", "shared", "without_idle"):
        monkeypatch.setattr(f"gearpoly.diagnose.search.{name}", told(name))
    return asked


def named(key: str) -> Any:
    physics = SimpleNamespace(name=key, mean_tooth=True, shaped=False)
    return SimpleNamespace(key=key, physics=physics, place=SimpleNamespace(gear=0), values=(1.0,))


@pytest.mark.parametrize(
    ("ends", "stands", "behind"),
    [
        ({"first": 100.0, "other": 90.0, "third": 95.0}, "other", {"first": 10.0, "third": 5.0}),
        ({"first": 100.0, "other": 104.0, "third": 130.0}, "first", {"other": 4.0, "third": 30.0}),
    ],
)
@pytest.mark.parametrize("broken", ["broken"], indirect=True)
@pytest.mark.usefixtures("asked")
def test_what_fits_best_stands(
    ends: dict[str, float], stands: str, behind: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    likenesses = [SimpleNamespace(claim=named(key)) for key in ("other", "broken", "third")]
    monkeypatch.setattr("gearpoly.diagnose.contest._likenesses", lambda search, k: iter(likenesses))
    search, found = contest(ended(ends))
    assert [one.key for one in search.model.claims] == [stands]
    assert {one.claim.key: one.behind for one in found[stands]} == behind


@pytest.mark.usefixtures("asked")
def test_the_claim_that_was_there_is_fitted_as_long_as_its_likenesses(monkeypatch: pytest.MonkeyPatch) -> None:
    """Or whoever comes later wins by the rounds it was given, and is told from its twin by them: the first claim was
    left before it rested, and fits better by 12 fitted again."""
    twin = SimpleNamespace(claim=named("twin"))
    monkeypatch.setattr("gearpoly.diagnose.contest._likenesses", lambda *_: iter([twin]))
    monkeypatch.setattr("gearpoly.diagnose.contest.settled", lambda fit: replace(fit, ends={**fit.ends, "first": 88.0}))
    search, found = contest(ended({"first": 100.0, "twin": 88.5}))
    assert [one.key for one in search.model.claims] == ["first"]
    assert [one.behind for one in found["first"]] == [0.5]


@pytest.mark.parametrize(
    ("nothing", "graded", "broken", "stands"),
    [(119.0, True, "", False), (121.0, True, "", True), (119.0, False, "", True), (119.0, True, "nothing", True)],
    indirect=["broken"],
)
def test_a_claim_goes_where_teeth_of_a_grade_fit_without_it(
    nothing: float, graded: bool, stands: bool, asked: list[str]
) -> None:
    """What counts is by how much the fit is worse that settled without it, a gain of 19 or of 21. Teeth that were
    inspected do not wander off, and a pair that cannot turn without the claim needs it."""
    search = withdrawn(ended({"first": 100.0, "nothing": nothing}, graded=graded))
    assert [one.key for one in search.model.claims] == (["first"] if stands else [])
    # What was believed beside it only is asked for again.
    assert asked == ([] if stands else ["with_declared_law", "with_best_law", "shared", "without_idle"])


@pytest.mark.usefixtures("asked")
@pytest.mark.parametrize(("shaped", "stands"), [(True, False), (False, True)])
def test_beside_a_relief_each_claim_of_all_teeth_is_fitted_without(shaped: bool, stands: bool) -> None:
    """Teeth that were inspected do not wander off, but a relief's length does, and with it where pairs hand over."""
    second, first = named("second"), named("first")
    second.physics.shaped = shaped
    search = withdrawn(ended({"first": 100.0, "second": 100.0, "nothing": 130.0}, second, first))
    assert [one.key for one in search.model.claims] == (["second", "first"] if stands else ["second"])


@pytest.mark.usefixtures("asked")
def test_of_several_claims_each_is_fitted_without() -> None:
    """The last first, so that the places of the others stay."""
    both = named("first"), named("second")
    search = withdrawn(ended({"first": 100.0, "second": 100.0, "nothing": 100.0}, *both, graded=True))
    assert not search.model.claims
    pair = withdrawn(ended({"first": 100.0, "second": 100.0, "nothing": 130.0}, *both, graded=True))
    assert [one.key for one in pair.model.claims] == ["first"]


@pytest.mark.slow
@pytest.mark.parametrize("gear", [0, 1])
def test_thin_teeth_are_told_by_where_their_coast_flanks_meet(gear: int) -> None:
    """Both gears' make the same lost motion, but where one has it the coast flanks hand over a thousandth of a radian
    off where they do with the other, and rough teeth place that to a hundredth of it; 40 um between the axes move the
    ends of the path. Sizes to five standard errors."""
    known, thinner, apart = rough(), -25.0, 40.0
    place = Place(gear=gear)
    true = Claim(physics=catalogue()["tooth_thickness"], place=place, values=(thinner,)).written(known)
    true = Claim(physics=catalogue()["centre_distance"], place=Place(), values=(apart,)).written(true)
    both = (Condition(torque_nm=0.0), Condition(torque_nm=0.0, flank="coast"))
    found = diagnose(known, recorded(true, both, np.random.default_rng(4), cycles=4.0), path=Path("pair.toml")).findings
    told = {one.claim.physics.name: one for one in found}
    assert set(told) == {"centre_distance", "tooth_thickness"}
    assert told["tooth_thickness"].claim.place.gear == gear
    for name, key, value in (("centre_distance", "offset_um", apart), ("tooth_thickness", "deviation_um", thinner)):
        size, std = told[name].parameters[key]
        assert abs(size - value) < 5.0 * std < 0.1 * abs(value)


@pytest.mark.slow
def test_a_pit_of_teeth_that_always_meet_has_the_mate_s_as_its_rival() -> None:
    """At 20/20 teeth tooth 4 meets tooth 4 and no other, so a pit of either leaves the same but for how flanks roll in
    its walls. Of 8400 the mate's gains 15 less, but a third only by the coarse shapes that are tried first."""
    known = rough((20, 20), bends=False)
    place = Place(gear=0, tooth=4)
    true = Claim(physics=catalogue()["tooth_spall"], place=place, values=(4.0, 19.75, 20.35, 0.01)).written(known)
    one = recorded(true, (Condition(torque_nm=0.0),), np.random.default_rng(2), cycles=7.0, per_mesh=120)
    (found,) = diagnose(known, one, path=Path("pair.toml")).findings
    both = [found.claim, *(rival.claim for rival in found.rivals)]
    assert {(c.physics.name, c.place.gear, c.place.tooth) for c in both} >= {("tooth_spall", k, 4) for k in (0, 1)}


@pytest.mark.slow
def test_teeth_far_thinner_than_their_limits_are_told_however_little_noise_there_is(tmp_path: Path) -> None:
    """What is known of thickness are its limits, and in 0.04 um of noise that is a millionth of what recordings of both
    flanks tells of the sum of both gears': no rounding, but 40 um beyond limits that leave 3. A wrong key of the file
    may be it, too."""
    true, known = made_gears(np.random.default_rng(7))
    sheet = true.driven.inspection
    assert sheet is not None
    thin = sheet.model_copy(update={"tooth_thickness_um": -100.0})
    true = true.model_copy(update={"driven": true.driven.model_copy(update={"inspection": thin})})
    both = (UNLOADED, Condition(torque_nm=0.0, flank="coast"))
    made = recorded(true, both, np.random.default_rng(3), cycles=2.0, per_mesh=40, noise_um=0.04)
    found = diagnose(known, made, path=tmp_path / "pair.toml")
    named = {(one.claim.physics.name, one.claim.place.gear_name) for one in found.findings}
    told = {(one.physics, one.gear) for entry in found.unexplained for one in entry.could_be}
    assert ("tooth_thickness", "driven") in named | told
    assert any("tooth thickness off by" in one for one in found.remarks)


@pytest.mark.parametrize("placed", [{"phased": True}, {"stated": True}, {}])
def test_of_a_pair_that_nothing_places_other_forms_are_tried_in_any_place(
    placed: dict[str, bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wear of one gear is that of the other mirrored about the pitch point; where zeros or curves say where that is,
    nothing is asked, nor is it of what both gears share or of one tooth."""
    asked: list[list[tuple[str, str | None]]] = []

    def found(model: Any, foreign: Any, starts: list[list[Claim]]) -> list[float]:
        asked.extend([(one.physics.name, one.place.gear_name) for one in start] for start in starts)
        return [(100.0, 0.0), *((86.0, 0.1) for _ in starts[1:])]

    monkeypatch.setattr("gearpoly.diagnose.contest.anywhere", found)
    claims = [
        Claim(physics=catalogue()["wear"], place=Place(gear=1), values=(11.0,)),
        Claim(physics=catalogue()["friction"], place=Place(), values=(0.1,)),
        Claim(physics=catalogue()["tooth_pitch"], place=Place(gear=1, tooth=3), values=(5.0,)),
    ]
    physics = [catalogue()[name] for name in ("wear", "friction", "tooth_pitch", "profile_slope")]
    model = SimpleNamespace(
        **({"phased": False, "stated": False} | placed), claims=claims, scope=scope_of(rough((12, 16))),
        method=SimpleNamespace(physics=physics),
    )  # fmt: skip
    search: Any = SimpleNamespace(model=model, over=False, step=lambda says: None, foreign=[])
    others = [one for k in range(3) for one in _elsewhere(search, k)]
    if placed:
        assert others == [] and asked == []
        return
    told = [(one.claim.physics.name, one.claim.place.gear_name) for one in others]
    assert told == [("wear", "driving"), ("profile_slope", "driving"), ("profile_slope", "driven")]
    assert all(one.elsewhere and (one.behind, one.way) == (-14.0, 0.1) for one in others)
    assert [one[0] for one in asked] == [("wear", "driven"), *told]
    assert {tuple(one[1:]) for one in asked} == {(("friction", None), ("tooth_pitch", "driven"))}


@pytest.mark.slow
def test_the_least_misfit_at_any_place_does_not_depend_on_where_teeth_were_taken_to_stand(tmp_path: Path) -> None:
    """Three steps further on every place is tried all the same; the right one leaves one per sample."""
    known = rough((12, 16))
    made = recorded(known, (Condition(torque_nm=20.0),), np.random.default_rng(5), per_mesh=14)
    path = tmp_path / "pair.toml"
    model = prepare(known, compare(known, made, path=path), path=path)
    foreign = [np.zeros((one.samples.size, 0)) for one in model.observed]
    ((here, way),) = anywhere(model, foreign, [[]])
    step = model.scope.gears[1].tau / PHASES_TRIED
    ((again, back),) = anywhere(model.moved(3.0 * step), foreign, [[]])
    assert again == pytest.approx(here, rel=0.01)
    assert (way - back) / step == pytest.approx(3.0)
    assert here == pytest.approx(sum(one.samples.size for one in model.observed), rel=0.1)


def test_a_pitch_is_fitted_in_the_stead_of_a_pit_whatever_first_order_tells(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 300 that a pit gains a pitch of the same tooth gains 1.3 to first order, where neighbours carry over it; a
    missing tip needs a third."""
    known, tooth = catalogue(), Place(gear=1, tooth=12)
    pit = Claim(physics=known["tooth_spall"], place=tooth, values=(33.0, 34.0, 37.8, 0.15))
    pitch = Claim(physics=known["tooth_pitch"], place=tooth, values=(-1.0,))
    tip = Claim(physics=known["tooth_chip"], place=Place(gear=1, tooth=12, shape=(3.0,)), values=(1.0, 3.0))
    neighbour = Claim(physics=known["tooth_pitch"], place=Place(gear=1, tooth=11), values=(-1.0,))
    gains = ((tip, 80.0), (pitch, 1.3), (neighbour, 90.0))
    found = [Candidate(claim=one, gain=gain, freedoms=1) for one, gain in gains]
    model = SimpleNamespace(claims=[pit], but=lambda claim: None, drawn_without=lambda claim, scenes: scenes)
    bare = SimpleNamespace(
        system=SimpleNamespace(misfit=400.0, with_columns=lambda white: SimpleNamespace(misfit=100.0))
    )
    linear = SimpleNamespace(
        without=lambda places: bare, layout=SimpleNamespace(places=lambda k: []), white_of=lambda k: None
    )
    search: Any = SimpleNamespace(model=model, linear=linear, scenes=[])
    module = "gearpoly.diagnose.contest"
    places = [(one.physics, one.place) for one in (tip, pitch, neighbour)]
    monkeypatch.setattr(f"{module}.all_places", lambda model: places)
    monkeypatch.setattr(
        f"{module}.scan",
        lambda others, scenes, linear, only: (
            [one for one in found if (one.claim.physics, one.claim.place) in only],
            0,
        ),
    )
    monkeypatch.setattr(f"{module}.polished", lambda others, scenes, linear, one: one)
    assert [one.claim for one in _likenesses(search, 0)] == [pitch]
