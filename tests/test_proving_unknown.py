"""The unknown as a rival: closed forms of what it leaves of an effect, and of the odds of a physics over it."""

from __future__ import annotations

from dataclasses import replace
from math import log, pi, sqrt
from typing import Any

import numpy as np
import pytest

from gearpoly.proving.chain import Chain, RecordedCondition, motion
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.effects import Effect
from gearpoly.proving.grounds import GROUNDS
from gearpoly.proving.limit import DetectionLimit, sights
from gearpoly.proving.physics import CATALOGUE, PHYSICS_BY_NAME
from gearpoly.proving.rig import Rig, ideal
from gearpoly.proving.unknown import FREE_MESH_HARMONICS, PLACES_OF_UNKNOWN, free_columns, freedoms, nearest, unknown

PAIR = make_pair("18/25 m2")
DRIVE = RecordedCondition(torque=0.0, turns=25.0)
COAST = replace(DRIVE, flank="coast")


def crowned() -> Rig:
    """Ideal gears but for 0.5 um of crowning, by which pairs hand over half way between their pitch points."""
    rig = ideal(PAIR, -60.0)
    return replace(rig, teeth_1=replace(rig.teeth_1, crowning=np.full(PAIR.driving.z, 0.5)))


def limit_of(rig: Rig, *conditions: RecordedCondition, noise_um: float = 0.3) -> DetectionLimit:
    """All teeth known to 0.1 nm, so that only the noise hides anything."""
    chain, rng = Chain(noise_um=noise_um), np.random.default_rng(1)
    paths = tuple(motion(rig, one, rng) for one in conditions)
    known = (1e-8 * np.eye(PAIR.driving.z), 1e-8 * np.eye(PAIR.driven.z))
    return DetectionLimit(
        rig, sights(conditions, paths, chain), chain, index=known, slope=known, thickness=0.1, compliance=0.0,
        zero=1e-3,
    )  # fmt: skip


LINE = Effect(physics="encoder_interpolation", gear=2, size=20.0, more={"order": 64, "phase": 0.3})
OFF = Effect(physics="encoder_eccentricity", gear=1, size=50.0, more={"angle_deg": 30.0})


@pytest.mark.parametrize("effect", [LINE, OFF], ids=lambda one: one.physics)
@pytest.mark.parametrize("conditions", [(DRIVE,), (DRIVE, COAST)], ids=len)
def test_a_pure_wave_is_not_told_from_a_free_one(effect: Effect, conditions: tuple[RecordedCondition, ...]) -> None:
    """Two numbers against two, that make the same: log odds of 0, on one flank and, as an encoder is one for both, on
    both. Cosine and sine are orthogonal to one part in the root of 4000 samples."""
    found = unknown(crowned(), limit_of(crowned(), *conditions), effect)
    assert found["place"] == "wave"
    assert found["left"] < 1e-6
    assert abs(found["log_odds"]) < 0.05
    assert found["separability"] < 0.01


def test_an_eccentric_gear_is_told_from_a_free_wave_by_the_other_flank_only() -> None:
    """On the coast flank its wave is the drive's, turned by twice the working pressure angle: a free wave needs two
    numbers more for that, each worth half a logarithm of what it says."""
    off = Effect(physics="eccentricity", gear=1, size=1.0, more={"angle_deg": 30.0})
    rig = crowned()
    assert unknown(rig, limit_of(rig, DRIVE), off)["log_odds"] < 0.5  # its second order is 1 um / 17 mm of the first
    limit = limit_of(rig, DRIVE, COAST)
    both = unknown(rig, limit, off)
    from gearpoly.proving.rivals import whitened

    q = limit.size_of(whitened(rig, limit, off)) ** 2

    def price(k: int) -> float:
        """Half of the log determinant, and what the prior takes of the gain."""
        return 0.5 * k * log(1.0 + q / k) + 0.5 * q - 0.5 * q * q / (k + q)

    assert both["form"] in ("flank", "load")
    assert both["log_odds"] == pytest.approx(price(4) - price(2), abs=0.3)


def test_a_slope_keeps_the_harmonics_that_a_free_mesh_curve_has_not() -> None:
    """Handed over half way, a slope of all teeth is a saw: its harmonics fall as 1 / n, so beyond the fourth are left
    1 - 6 / pi^2 (1 + 1/4 + 1/9 + 1/16) of the energy."""
    rig = crowned()
    slope = Effect(physics="profile_slope", gear=1, size=0.001)  # pairs hand over where they do without
    left = nearest(rig, limit_of(rig, DRIVE), slope).left
    assert FREE_MESH_HARMONICS == 4
    # 4000 samples at random phases; steps of a saw between them are good to a sample in fourteen per mesh.
    assert left == pytest.approx(sqrt(1.0 - 6.0 / pi**2 * sum(1.0 / n**2 for n in range(1, 5))), rel=0.03)


@pytest.mark.long
def test_the_error_of_a_tooth_is_a_curve_of_its_flank_and_is_told_by_its_one_number_alone() -> None:
    """A constant is a spline: nothing is left. What tells it grows with the logarithm of its size."""
    rig = crowned()
    limit = limit_of(rig, DRIVE)
    odds = []
    for size in (1.0, 10.0):
        found = unknown(rig, limit, Effect(physics="tooth_pitch", gear=2, size=size, more={"tooth": 7}))
        assert found["place"] == "tooth_flank"
        assert found["left"] < 1e-3
        odds.append(found["log_odds"])
    # Splines that are told apart cost log(10) each, the pitch itself one such; some of nine lie where nothing touches.
    assert 3 * log(10.0) < odds[1] - odds[0] <= 8 * log(10.0)


def test_an_edge_tells_a_pit_from_any_smooth_curve() -> None:
    """A bump as smooth as the splines leaves a tenth of itself at most; the edges of a box a quarter and more."""
    rig = crowned()
    gear, middle = PAIR.driven, 0.5 * (PAIR.l_start(2) + PAIR.driven.l_tip)
    ends = [sqrt(gear.r_b**2 + (middle + side) ** 2) for side in (-0.7, 0.7)]
    more = {"tooth": 7, "from_mm": ends[0], "to_mm": ends[1]}
    found = unknown(rig, limit_of(rig, DRIVE), Effect(physics="tooth_spall", gear=2, size=6.0, more=more))
    assert found["left"] > 0.25


def test_the_unknown_has_the_rms_of_the_effect() -> None:
    """The odds do not change with the unit of its columns: they are scaled to what is seen of the effect."""
    rig = crowned()
    limit = limit_of(rig, DRIVE)
    one = unknown(rig, limit, LINE)
    columns = free_columns(rig, limit, LINE, "wave", "all")
    assert columns.shape[1] == 2
    louder = replace(LINE, size=2.0 * LINE.size)
    assert unknown(rig, limit, louder)["log_odds"] == pytest.approx(one["log_odds"], abs=0.05)


def test_forms_are_free_where_they_say() -> None:
    """Recordings of one torque share a wave; those of another torque, and of the other flank, have their own."""
    rig = crowned()
    limit = limit_of(rig, DRIVE, replace(DRIVE, speed=60.0), COAST)
    count = {form: free_columns(rig, limit, LINE, "wave", form).shape[1] for form in PLACES_OF_UNKNOWN["wave"].forms}
    assert count == {"all": 2, "flank": 4, "load": 4}
    slope = Effect(physics="profile_slope", gear=1, size=1.0)
    count = {form: free_columns(rig, limit, slope, "mesh", form).shape[1] for form in PLACES_OF_UNKNOWN["mesh"].forms}
    assert count == {"flank": 16, "condition": 24}


SHADED = 7
NOTHING = {"physics": "unknown", "place": "tooth", "form": "flank", "log_odds": 0.0, "separability": 0.0, "left": 0.0}


def shaded(noise_um: float = 0.3) -> tuple[Rig, DetectionLimit]:
    """One driven tooth 5 um behind the others, read only where a neighbour touches as well, or where it is a base
    pitch off its path of contact: never where it would carry alone."""
    rig, gear = crowned(), PAIR.driven
    rig = rig.with_teeth(2, rig.teeth(2).index_plus(SHADED, -5.0))
    limit = limit_of(rig, DRIVE, noise_um=noise_um)
    (sight,) = limit.look
    turn = 2.0 * pi * gear.r_b
    # Along an involute the contact runs as far as the base circle does, from the tip of the driven tooth downwards.
    roll = PAIR.l_work(2) - gear.r_b * sight.path.angle(sight.time) + SHADED * PAIR.p_b
    roll = (roll - PAIR.l_start(2) + PAIR.p_b) % turn - PAIR.p_b
    span = gear.l_tip - PAIR.l_start(2)
    two = ((roll > 0.01) & (roll < span - PAIR.p_b - 0.01)) | ((roll > PAIR.p_b + 0.01) & (roll < span - 0.01))
    at = two | (roll < -0.9 * PAIR.p_b) | (roll > span + 0.9 * PAIR.p_b)
    assert two.sum() > 50
    return rig, limit.seen_with((replace(sight, time=sight.time[at]),), limit.whiten)


@pytest.mark.parametrize("size", [-20.0, -2.0, 2.0])
def test_a_tooth_that_its_neighbours_keep_off_the_mate_is_nothing_and_so_is_its_unknown(size: float) -> None:
    """Rigid teeth: 5 um behind crownings of 0.5 um, and 3 um as well, the flank reaches no reading. So no curve of it
    moves any, and two that make nothing are told by nothing."""
    rig, limit = shaded()
    hidden = Effect(physics="tooth_pitch", gear=2, size=size, more={"tooth": SHADED})
    for form in PLACES_OF_UNKNOWN["tooth_flank"].forms:
        assert free_columns(rig, limit, hidden, "tooth_flank", form).shape == (limit.base.size, 0)
    assert unknown(rig, limit, hidden) == NOTHING


def test_a_tooth_that_a_part_of_a_turn_leaves_out_has_no_unknown_either() -> None:
    rig = crowned()
    limit = limit_of(rig, replace(DRIVE, turns=0.6))  # 10.8 of 25 driven teeth
    first, last = limit.look[0].path.angles
    away = round(0.5 * (first + last) / PAIR.driven.tau + 0.5 * PAIR.driven.z) % PAIR.driven.z
    hidden = Effect(physics="tooth_pitch", gear=2, size=20.0, more={"tooth": away})
    assert unknown(rig, limit, hidden) == NOTHING


def test_a_place_at_which_nothing_is_free_is_no_rival(monkeypatch: pytest.MonkeyPatch) -> None:
    """A bump of 8 um shows 3 um before the neighbours. Of a size near its limit splines cost more than they say; that
    no deviation of the flank reaches a reading makes nothing likelier."""
    rig, limit = shaded(noise_um=20.0)
    radii = [sqrt(PAIR.driven.r_b**2 + roll**2) for roll in (4.5, 7.0)]
    bump = Effect(
        physics="tooth_spall", gear=2, size=-8.0, more={"tooth": SHADED, "from_mm": radii[0], "to_mm": radii[1]}
    )
    found = nearest(rig, limit, bump)
    assert free_columns(rig, limit, bump, "tooth_flank", "flank").shape[1] == 0
    assert found.place == "tooth"
    assert found.log_evidence < 0.0
    monkeypatch.setitem(PHYSICS_BY_NAME, "tooth_spall", replace(PHYSICS_BY_NAME["tooth_spall"], nearby=()))
    assert nearest(rig, limit, bump) == found


def test_what_is_seen_at_no_place_of_an_unknown_is_told_from_nothing_by_its_own_price(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Then all of it is left, and of its odds is taken what its two numbers cost. A wave of amplitude a in n samples
    of noise s has n a^2 / (2 s^2) of squared size over the limit."""
    nil = replace(PLACES_OF_UNKNOWN["wave"], columns=lambda rig, one, effect: np.zeros((one.time.size, 2)))
    monkeypatch.setitem(PLACES_OF_UNKNOWN, "wave", nil)
    found = unknown(crowned(), limit_of(crowned(), DRIVE), LINE)
    samples = DRIVE.turns * PAIR.driving.z * DRIVE.per_mesh
    q = 0.5 * samples * (1e-3 * LINE.size * PAIR.driven.r_b / 0.3) ** 2
    odds = 0.5 * q * q / (2.0 + q) - log(1.0 + 0.5 * q)
    assert (found["place"], found["form"], found["left"]) == ("wave", "all", 1.0)
    assert found["log_odds"] == pytest.approx(odds, rel=0.03)  # cosines at the readings, and what the zero takes
    assert found["separability"] == pytest.approx(sqrt(2.0 * odds / q), rel=0.01)


def test_every_physics_has_a_place_and_its_numbers_are_counted() -> None:
    assert all(PHYSICS_BY_NAME[name].place in PLACES_OF_UNKNOWN for name in CATALOGUE)
    assert all(place in PLACES_OF_UNKNOWN for name in CATALOGUE for place in PHYSICS_BY_NAME[name].nearby)
    rig = crowned()
    limit = limit_of(rig, DRIVE)
    assert freedoms(rig, limit, LINE) == 2  # amplitude and phase
    assert freedoms(rig, limit, Effect(physics="wear", gear=1, size=1.0)) == 1
    relief = Effect(physics="tip_relief", gear=1, size=5.0, more={"length_mm": 0.5, "power": 1.0})
    assert freedoms(rig, limit, relief) == 2  # amount and length


@pytest.mark.slow
def test_truths_of_the_bench_tell_how_near_an_unknown_comes() -> None:
    entry = replace(
        GROUNDS["short"].plan(3)[0],
        klass="single",
        physics=("encoder_interpolation",),
        over=10.0,
        quick=True,
        cycles=0.5,
    )
    made: Any = GROUNDS["short"].make(3, entry)
    (item,) = made.truth["truth"]
    assert {"place", "form", "separability", "left", "log_odds"} <= set(item["unknown"])
    assert 0.0 <= item["unknown"]["separability"] <= 1.0
