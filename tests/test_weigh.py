"""The scales on which candidates are weighed: steps beside slow changes, and what teeth as built cannot be."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.slow import slow_curves
from gearpoly.diagnose.fidelity import FAINT_EFFECT_MM
from gearpoly.diagnose.fit import measured
from gearpoly.diagnose.floors import changes_along, faint_floor, law_floor, part_recorded, size_of
from gearpoly.diagnose.scan import Candidate, Looked
from gearpoly.diagnose.sparse import full
from gearpoly.diagnose.system import Sums, System, gain_of
from gearpoly.diagnose.weigh import (
    as_sudden,
    by_chance_once_per_turn,
    by_coincidence,
    matters,
    pays,
    step_gain,
    within_grade,
)
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.units import UM, FloatArray
from tests.made_fits import MadeFit

N = 4000


@dataclass
class White:
    """A recording in white noise of unit level, all known but its mean."""

    system: System

    def sums(self, k: int, columns: FloatArray) -> Sums:
        left, white = self.system.left[k], self.system.white[k]
        return Sums(score=columns.T @ left, own=columns.T @ columns, cross=white.T @ columns)


def scales(recorded: FloatArray) -> Any:
    system = System(white=[full(np.ones((N, 1)))], target=[recorded], precision=np.zeros((1, 1)), prior=np.zeros(1))
    return MadeFit(
        linear=White(system), model=SimpleNamespace(observed=[SimpleNamespace(samples=SimpleNamespace(size=N))])
    )


def several(recorded: list[FloatArray]) -> Any:
    """The scales of some recordings, each with a mean of its own."""
    white = [np.zeros((N, len(recorded))) for _ in recorded]
    for k, one in enumerate(white):
        one[:, k] = 1.0
    weigh = scales(recorded[0])
    unknown = np.zeros((len(recorded), len(recorded)))
    wide = [full(one) for one in white]
    weigh.linear = White(System(white=wide, target=recorded, precision=unknown, prior=np.zeros(len(recorded))))
    weigh.model.observed = [SimpleNamespace(samples=SimpleNamespace(size=N))] * len(recorded)
    return weigh


def gain_of_slope(recorded: FloatArray) -> float:
    """What a straight line explains beside the mean."""
    along = np.linspace(-1.0, 1.0, N)
    return float((along @ (recorded - recorded.mean())) ** 2 / (along @ along))


@pytest.mark.parametrize(
    ("physics", "values", "stated", "left_open"),
    [
        ("profile_crowning", (0.3,), True, True),
        ("profile_crowning", (1.5,), True, False),
        ("tip_relief", (0.3, 0.5), True, False),
        ("tip_relief", (0.3, 0.5), False, True),
        ("tip_relief", (0.6, 0.5), False, False),
    ],
)
def test_a_grade_leaves_a_bulge_open_but_no_relief(
    physics: str, values: tuple[float, ...], stated: bool, left_open: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 1 um of form: a bulge of 0.3 um may be how the gear was made. A relief only sets in on the way up the flank;
    that is ground on purpose, and seven spalls were claimed where one of 1.2 um was taken for the gear as built. Where
    nobody stated a grade, up to half of the form may be how the teeth were printed."""
    monkeypatch.setattr("gearpoly.diagnose.weigh.is_unstated", lambda model, gear: not stated)
    weigh: Any = MadeFit(model=SimpleNamespace(scope=SimpleNamespace(form=(1.0, 1.0))))
    claim = Claim(physics=catalogue()[physics], place=Place(gear=1), values=values)
    assert within_grade(weigh, Candidate(claim=claim, gain=100.0, freedoms=1)) is left_open


@pytest.mark.parametrize("at", [0.2, 0.36, 0.5])
def test_a_step_explains_more_than_a_line_where_there_is_one(at: float) -> None:
    """A line takes 3 p (1 - p) of a step at part p, at most three quarters; 48 moments, and 48 more about the best,
    miss its place by 0.0005 of the recording at most, which costs 0.05 % / (p (1 - p)) of its gain."""
    rng = np.random.default_rng(1)
    recorded = 0.5 * (np.arange(N) > at * N) + rng.normal(0.0, 1.0, N)
    assert step_gain(scales(recorded)) > gain_of_slope(recorded)
    clean = 0.5 * (np.arange(N) > at * N)
    whole = float(np.sum((clean - clean.mean()) ** 2))
    assert (1.0 - 0.0006 / (at * (1.0 - at))) * whole < step_gain(scales(clean)) <= whole * (1.0 + 1e-9)


def test_a_line_explains_more_than_any_step_where_there_is_one() -> None:
    rng = np.random.default_rng(2)
    recorded = np.linspace(-0.5, 0.5, N) + rng.normal(0.0, 1.0, N)
    assert step_gain(scales(recorded)) < gain_of_slope(recorded)


def test_what_drifts_in_several_recordings_is_weighed_against_a_step_in_each() -> None:
    """A further step costs its freedom and one of 48 moments, 9.7 of its gain; a recording that does not drift is not
    asked."""
    rng = np.random.default_rng(3)
    steps = [0.5 * (np.arange(N) > at * N) + rng.normal(0.0, 1.0, N) for at in (0.2, 0.5, 0.8)]
    alone = [step_gain(scales(one)) for one in steps]
    weigh = several(steps)
    cost = 2.0 * (1.0 + math.log(48))
    assert step_gain(weigh) == pytest.approx(sum(alone) - 2.0 * cost)
    assert step_gain(weigh, (0, 2)) == pytest.approx(alone[0] + alone[2] - cost)
    assert step_gain(weigh, (1,)) == pytest.approx(alone[1])


def test_recordings_that_drift_alike_may_jump_alike() -> None:
    """One step of all at one moment is then worth all that each is, and costs nothing further."""
    rng = np.random.default_rng(3)
    steps = [0.5 * (np.arange(N) > 0.5 * N) + rng.normal(0.0, 1.0, N) for _ in range(2)]
    alone = [step_gain(scales(one)) for one in steps]
    # The best moment of both is that of neither.
    assert sum(alone) - 20.0 < step_gain(several(steps)) <= sum(alone)


@pytest.mark.long
def test_what_is_slow_is_told_from_a_step_where_hardly_any_step_would_look_as_slow() -> None:
    """Three slow terms gain more than the best step by what is asked in 1 of 100 steps of 6 standard deviations: of 400
    in 4, and in 12 in less than 1 of 1000 trials."""
    rng = np.random.default_rng(4)
    slow, _ = np.linalg.qr(slow_curves(np.linspace(-1.0, 1.0, N)))
    outdone = 0
    for _ in range(400):
        step = (np.arange(N) > rng.uniform(0.25, 0.75) * N).astype(np.float64)
        step *= 6.0 / float(np.linalg.norm(step - step.mean()))
        recorded = step + rng.normal(0.0, 1.0, N)
        gain = float(np.sum((slow[:, 1:].T @ recorded) ** 2))
        one = Candidate(claim=drift_claim(), gain=gain, freedoms=3)
        outdone += not as_sudden(scales(recorded), one)
    assert outdone < 12
    ramp = np.linspace(-1.0, 1.0, N)
    recorded = 12.0 * ramp / float(np.linalg.norm(ramp)) + rng.normal(0.0, 1.0, N)
    gain = float(np.sum((slow[:, 1:].T @ recorded) ** 2))
    assert not as_sudden(scales(recorded), Candidate(claim=drift_claim(), gain=gain, freedoms=3))


def test_a_straight_ramp_is_a_wrong_count_and_no_drift_that_happens_to_be_straight() -> None:
    """Of 100 um at 0.01 um of doubt a drift would have shown its bow. Of 7 standard deviations it would not."""
    looked = Looked()
    scale = Claim(physics=catalogue()["encoder_scale"], place=Place(gear=1), values=(1.0,))

    def ahead(size: float, bow: float) -> float:
        """Of the drift, whose bow and S say ``bow`` beyond the ramp."""
        drift = Candidate(claim=drift_claim(), gain=size**2 + bow, freedoms=3)
        return looked.worth(drift) - looked.worth(Candidate(claim=scale, gain=size**2, freedoms=1))

    assert ahead(1e4, 9.0) < 0.0
    assert ahead(1e4, 40.0) > 0.0
    assert ahead(7.0, 9.0) > 0.0


def drift_claim() -> Claim:
    return Claim(physics=catalogue()["thermal_drift"], place=Place(recordings=(0,)), values=(1.0, 0.0, 0.0))


def claim_of(name: str, place: Place) -> Claim:
    return Claim(physics=catalogue()[name], place=place, values=(1.0,))


def test_every_physics_has_its_part_of_the_family() -> None:
    """Thousands of orders do not outvote the teeth, nor spalls the cracks, nor teeth a few gears: waves, teeth and
    whole gears have a third each, and the physics of the latter two equal parts of it. All chances add up to the
    family's."""
    looked = Looked(
        waves={"encoder_interpolation": 16000, "undulation": 500},
        teeth={"tooth_pitch": 43, "tooth_spall": 86, "tooth_crack": 43},
        whole={"cumulative_pitch": 20, "friction": 1},
    )
    crack = claim_of("tooth_crack", Place(gear=0, tooth=3))
    assert looked.tests(claim_of("undulation", Place(gear=0, order=61))) == 3 * 16500
    assert looked.tests(crack) == 3 * 3 * 43
    assert looked.tests(claim_of("friction", Place())) == 3 * 2
    shares = 0.0
    for kind, place in ((looked.waves, Place(order=61)), (looked.teeth, Place(tooth=1)), (looked.whole, Place(gear=1))):
        shares += sum(count / looked.tests(claim_of(name, place)) for name, count in kind.items())
    assert shares == pytest.approx(1.0)


def test_only_one_sign_of_noise_looks_like_a_crack() -> None:
    """A normal number squared exceeds 9 in 0.0027 of all cases, and from above in half of them."""
    crack = Candidate(claim=claim_of("tooth_crack", Place(gear=0, tooth=3)), gain=9.0, freedoms=1)
    pitch = Candidate(claim=claim_of("tooth_pitch", Place(gear=0, tooth=3)), gain=9.0, freedoms=1)
    assert math.exp(pitch.log_chance(tests=1)) == pytest.approx(0.0026998, rel=1e-4)
    assert crack.log_chance(tests=2) == pytest.approx(pitch.log_chance(tests=1))


@pytest.mark.parametrize("moving", [0.0, 1.0])
def test_what_only_sets_recordings_apart_does_not_look_like_chords(moving: float) -> None:
    """Below what chords leave along a recording nothing is claimed; wind-up moves nothing along it, and what chords
    leave is the same in every hunting cycle, so that nothing slow is like it. In noise of a micron a gain of 30 is
    worth 0.09 um, which a wave of 0.2 um may have left."""
    effect = UM * (5.0 + 0.2 * moving * np.sin(np.arange(N)))
    weigh = scales(np.zeros(N))
    weigh.noises = [SimpleNamespace(innovation=UM)]
    weigh.scenes, weigh.model.claims = [], []
    weigh.model.change = lambda *given, **more: [effect]
    assert changes_along(weigh, Candidate(claim=claim_of("shaft_windup", Place()), gain=30.0, freedoms=1)) is bool(
        moving
    )
    ramp = Candidate(claim=claim_of("encoder_scale", Place(gear=0)), gain=30.0, freedoms=1)
    weigh.model.observed[0].whole = True
    assert not changes_along(weigh, ramp)
    weigh.model.observed[0].whole = False
    assert changes_along(weigh, ramp) is bool(moving)


@pytest.mark.parametrize(("size", "paid"), [(0.3, True), (0.0, False)])
def test_a_slow_change_pays_between_the_blocks_that_were_seen(
    size: float, paid: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A bow of eight standard errors whose first half says nothing of the second: from it a line and a bow would be
    drawn on to anywhere. Without any the columns fit noise, and the unseen blocks show it."""
    along = np.linspace(-1.0, 1.0, N)
    columns = np.stack([along, 1.5 * along**2 - 0.5, 2.5 * along**3 - 1.5 * along], axis=1)
    weigh = scales(size * columns[:, 1] + np.random.default_rng(4).normal(0.0, 1.0, N))
    monkeypatch.setattr("gearpoly.diagnose.weigh.columns_of", lambda *given: [columns])
    weigh.scenes = []
    weigh.model.observed[0].fit, weigh.model.observed[0].jumps = np.arange(N) < N // 2, ()
    candidate = SimpleNamespace(claim=SimpleNamespace(physics=catalogue()["thermal_drift"]))
    assert pays(weigh, candidate) is paid


def test_teeth_are_not_claimed_one_by_one_for_what_a_grade_leaves_open_to_all() -> None:
    """Of a misfit that is mostly such a form of all teeth, a tooth's pit has to explain a tenth, not 3 %."""
    weigh = scales(1.5 * np.random.default_rng(6).normal(0.0, 1.0, N))
    weigh.model.claims = []
    beyond = weigh.linear.system.beyond
    pit = Candidate(claim=claim_of("tooth_spall", Place(gear=0, tooth=4)), gain=0.05 * beyond, freedoms=4)
    wave = Candidate(claim=claim_of("undulation", Place(gear=0, order=61)), gain=0.05 * beyond, freedoms=2)
    weigh.formed = 0.0
    assert matters(weigh, pit)
    weigh.formed = 0.8 * beyond
    assert not matters(weigh, pit)
    assert matters(weigh, wave)
    assert matters(weigh, Candidate(claim=pit.claim, gain=0.2 * beyond, freedoms=4))


def test_a_tooth_has_to_beat_what_chords_leave_where_it_shows() -> None:
    """An effect in a hundredth of the samples is as large there as one of ten times its rms is everywhere."""
    weigh = scales(np.zeros(N))
    weigh.noises, weigh.scenes, weigh.model.claims = [SimpleNamespace(innovation=UM)], [], []
    effect = np.where(np.arange(N) < N // 100, 0.1 * UM, 0.0)
    weigh.model.change = lambda *given, **more: [effect]
    few = 0.3 * N * (FAINT_EFFECT_MM / UM) ** 2
    tooth = Candidate(claim=claim_of("tooth_crack", Place(gear=0, tooth=3)), gain=few, freedoms=1)
    assert faint_floor(weigh, tooth) == pytest.approx(0.1 * FAINT_EFFECT_MM)
    assert faint_floor(weigh, replace(tooth, claim=claim_of("friction", Place()))) == FAINT_EFFECT_MM
    weigh.model.change = lambda *given, **more: [np.full(N, UM)]
    assert faint_floor(weigh, tooth) == pytest.approx(FAINT_EFFECT_MM)


@pytest.mark.parametrize("data", [0.01, 1.0, 100.0])
def test_what_laws_leave_reaches_an_effect_of_teeth_by_what_is_recorded_only(
    data: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Teeth that could have the same effect, known beforehand with precision P, told by data with S: of what is known
    of the effect, S P / (S + P), the part P / (S + P) lies in what is recorded."""
    rng = np.random.default_rng(8)
    column = rng.normal(0.0, 1.0, N)
    column *= math.sqrt(data) / np.linalg.norm(column)
    system = System(white=[full(column[:, None])], target=[np.zeros(N)], precision=np.eye(1), prior=np.zeros(1))
    weigh = scales(np.zeros(N))
    monkeypatch.setattr("gearpoly.diagnose.floors.columns_beside", lambda fit, one: ([column[:, None]], system))
    one = Candidate(claim=claim_of("profile_slope", Place(gear=0)), gain=1.0, freedoms=1)
    assert part_recorded(weigh, one) == pytest.approx(math.sqrt(1.0 / (1.0 + data)), rel=1e-6)


def test_a_faint_crack_does_not_hide_a_friction(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the law leaves of a crack is a part of the crack, and of a large one no more than of a physics of all
    teeth: with 4 um of deflection, friction has to beat 6 nm beside nothing, 9 beside a crack of 60 nm rms."""
    crack = claim_of("tooth_crack", Place(gear=0, tooth=3))
    weigh = scales(np.zeros(N))
    weigh.noises, weigh.scenes, weigh.nuisance = [SimpleNamespace(innovation=UM)], [], None
    weigh.model.claims = [crack]
    monkeypatch.setattr("gearpoly.diagnose.floors.part_recorded", lambda fit, one: 1.0)
    friction = Candidate(claim=claim_of("friction", Place()), gain=1.0, freedoms=1)
    floors = []
    for crack_um in (0.0, 0.06, 10.0):
        weigh.model.change = lambda *given, size=crack_um, **more: [size * UM * np.tile([1.0, -1.0], N // 2)]
        weigh = measured(weigh)
        weigh.deflections = (4.0 * UM,)
        floors.append(law_floor(weigh, friction) / UM)
    assert floors == pytest.approx([0.006, 0.15 * 0.06, 0.016])
    weigh.model.claims = [claim_of("profile_crowning", Place(gear=0))]
    weigh = measured(weigh)
    weigh.deflections = (4.0 * UM,)
    assert law_floor(weigh, friction) / UM == pytest.approx(0.016)


@pytest.mark.parametrize(("strangers", "named"), [(0, True), (6, True), (8, False)])
def test_where_many_waves_are_foreign_one_at_an_order_may_be_another(strangers: int, named: bool) -> None:
    """50 turns of one shaft and 36 of the other have orders within 0.15 lines of 1.4 % of all places."""
    weigh = scales(np.zeros(N))
    turns = 2.0 * math.pi * np.linspace(0.0, 1.0, N)
    weigh.scenes = [SimpleNamespace(samples=SimpleNamespace(theta_1=50.0 * turns, theta_2=36.0 * turns))]
    weigh.model.strangers = tuple((2 * k, 2 * k + 1) for k in range(strangers))
    sizes = np.tile([0.6 * UM, 0.8 * UM], strangers)
    weigh.linear = SimpleNamespace(
        system=SimpleNamespace(solution=sizes), layout=SimpleNamespace(foreign=slice(0, sizes.size))
    )
    wave = Candidate(claim=claim_of("undulation", Place(gear=0, order=61)), gain=100.0, freedoms=2)
    crack = Candidate(claim=claim_of("tooth_crack", Place(gear=0, tooth=3)), gain=100.0, freedoms=1)
    # Strangers of 1 um beside a wave of 1.9 um, and beside one that is more than twice as large as they are.
    weigh.model.changed = lambda *given: [1.9 * UM * np.cos(61.0 * turns)]
    assert by_coincidence(weigh, wave) is not named
    weigh.model.changed = lambda *given: [2.1 * UM * np.cos(61.0 * turns)]
    assert not by_coincidence(weigh, wave)
    assert not by_coincidence(weigh, crack)


@pytest.mark.parametrize(("turns", "strangers", "size", "expected"), [
    (4.4, 2, 1.9, 0.136), (4.4, 2, 2.1, 0.0), (4.4, 0, 1.9, 0.0), (40.0, 2, 1.9, 0.015),
])  # fmt: skip
def test_in_few_turns_a_wave_of_another_part_may_come_once_per_turn(
    turns: float, strangers: int, size: float, expected: float
) -> None:
    """0.3 lines, of which there is one per order in a turn: in 4.4 turns two waves of 1 um are there 0.136 times, and
    are too small for what is more than twice as large."""
    weigh = scales(np.zeros(N))
    angle = 2.0 * math.pi * np.linspace(0.0, 1.0, N)
    weigh.scenes = [SimpleNamespace(samples=SimpleNamespace(theta_1=90.0 * angle, theta_2=turns * angle))]
    weigh.model.strangers = tuple((2 * k, 2 * k + 1) for k in range(strangers))
    sizes = math.sqrt(2.0) * np.tile([0.6 * UM, 0.8 * UM], strangers)
    weigh.linear = SimpleNamespace(
        system=SimpleNamespace(solution=sizes), layout=SimpleNamespace(foreign=slice(0, sizes.size))
    )
    weigh.model.rms_of = lambda *given: size * UM
    off = claim_of("eccentricity", Place(gear=1))
    assert by_chance_once_per_turn(weigh, off) == pytest.approx(expected, abs=1e-3)
    for other in (claim_of("undulation", Place(gear=1, order=61)), claim_of("wear", Place(gear=1))):
        assert by_chance_once_per_turn(weigh, other) == 0.0


def test_a_tooth_under_load_has_to_beat_what_laws_leave_where_it_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two recordings one bends by 10 um; a pit in 4 % of the samples of both may be 6 parts in a thousand of that,
    there."""
    weigh = scales(np.zeros(N))
    weigh.noises, weigh.scenes, weigh.model.claims, weigh.of_teeth = [SimpleNamespace(innovation=UM)], [], [], 0.0
    monkeypatch.setattr("gearpoly.diagnose.floors.part_recorded", lambda fit, one: 1.0)
    half = N // 2
    effect = np.where(np.arange(half) < 0.04 * half, 0.1 * UM, 0.0)
    weigh.model.change = lambda *given, **more: [effect, effect]
    pit = Candidate(claim=claim_of("tooth_spall", Place(gear=0, tooth=3)), gain=1e-3, freedoms=1)
    weigh.deflections = (0.0, 10.0 * UM)
    laws = 0.006 * 10.0 * UM * math.sqrt(0.5 * 0.04)
    # Teeth as built stand 8 um out there and as much back elsewhere, in the recording that bends: three in a hundred.
    there = np.where(effect > 0.0, 8.0, -8.0)[:, None]
    built = there - np.mean(there)
    weigh.scenes = [SimpleNamespace(bends=False), SimpleNamespace(bends=True)]
    system = SimpleNamespace(solution=np.array([UM]), samples=N)
    weigh.linear = SimpleNamespace(
        layout=SimpleNamespace(built=slice(0, 1)), columns=[full(there), full(there)], system=system
    )
    own = 0.03 * float(built[0, 0]) * UM * math.sqrt(0.5 * 0.04)
    assert law_floor(weigh, pit) == pytest.approx(laws + own)
    weigh.scenes = [SimpleNamespace(bends=False)] * 2
    assert law_floor(weigh, pit) == pytest.approx(laws)
    weigh.deflections = (0.0, 0.0)
    assert law_floor(weigh, pit) == 0.0


def test_a_thickness_under_load_has_to_beat_what_laws_leave_of_the_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where both flanks have a mean of their own, thickness moves eccentric teeth along their turns and no more: 36.9
    um of it were made of 12 nm that a law had left beside 11.5 um of deflection, on a pair within its limits."""
    weigh = scales(np.zeros(N))
    weigh.noises, weigh.scenes, weigh.model.claims, weigh.of_teeth = [SimpleNamespace(innovation=UM)], [], [], 0.0
    thickness = claim_of("tooth_thickness", Place(gear=1))
    faint, plain = (Candidate(claim=thickness, gain=N * size**2, freedoms=1) for size in (0.012, 20.0))
    weigh.deflections = (11.5 * UM,)
    monkeypatch.setattr("gearpoly.diagnose.floors.part_recorded", lambda fit, one: 0.4)
    assert law_floor(weigh, faint) / UM == pytest.approx(0.006 * 11.5 * 0.4)
    assert law_floor(weigh, plain) < size_of(weigh, plain)
    weigh.deflections = (0.0,)
    assert law_floor(weigh, faint) == 0.0


def test_columns_of_which_others_took_all_gain_nothing() -> None:
    """Of two columns 3 and 4 are told, each by itself: 9 + 16 in misfit. Of two more nothing is left but rounding."""
    information = np.diag([1.0, 1.0, 0.0, 0.0, -1e-17, 0.0])
    gains, amplitudes = gain_of(np.array([3.0, 4.0, 0.0, 0.0, 1e-12, 0.0]), information, np.arange(6).reshape(3, 2))
    assert gains == pytest.approx([25.0, 0.0, 0.0], abs=1e-6)
    assert amplitudes[0] == pytest.approx([3.0, 4.0], rel=1e-6)
