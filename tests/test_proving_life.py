"""Each class of the real-life ground against a closed form or a second calculation, and what its truths promise."""

from __future__ import annotations

import json
import tomllib
from collections import Counter
from dataclasses import replace
from functools import lru_cache
from math import pi, radians, sqrt
from typing import Any

import numpy as np
import pytest

from gearpoly.proving.chain import Chain, RecordedCondition, motion, te
from gearpoly.proving.drawn import make_pair
from gearpoly.proving.effects import Effect, apply
from gearpoly.proving.entry import CaseEntry
from gearpoly.proving.gears import MM_PER_UM, RAD_PER_DEG
from gearpoly.proving.grounds import GROUNDS
from gearpoly.proving.life import coarse, ground
from gearpoly.proving.life.base import LifeCase
from gearpoly.proving.life.even import even_angles
from gearpoly.proving.life.outside import LATER
from gearpoly.proving.life.wander import covariance, folded
from gearpoly.proving.life.wrong_file import SAYS
from gearpoly.proving.physics import CATALOGUE, PHYSICS_BY_NAME
from gearpoly.proving.rig import Rig, ideal, mesh
from gearpoly.proving.unknown import log_evidence

PAIR = make_pair("18/25 m2")


@lru_cache(maxsize=64)
def case(klass: str, variant: int, cycles: float = 0.0, over: float = 20.0) -> LifeCase:
    entry = CaseEntry(index=3, klass=klass, physics=(), over=over, variant=variant, cycles=cycles)
    return ground.make(5, entry)


def table(made: LifeCase, k: int = 0) -> dict[str, Any]:
    lines = dict(made.files())[f"rec_{k}.csv"].splitlines()
    at = sum(line.startswith("#") for line in lines)
    return dict(zip(lines[at].split(","), np.loadtxt(lines[at + 1 :], delimiter=",").T, strict=True))


# What the ground holds


def test_the_ground_has_256_cases_of_eight_classes_and_a_third_of_them_short() -> None:
    entries = GROUNDS["real-life"].plan(7)
    assert len(entries) >= 250
    assert min(Counter(e.klass for e in entries).values()) >= 25
    assert set(ground.CLASSES) == set(ground.LIFE_CONCEALED_BY) == {e.klass for e in entries}
    short = [e for e in entries if e.cycles]
    assert len(short) >= len(entries) / 3
    assert all(0.5 <= e.cycles <= 2.0 for e in short)
    assert Counter(e.klass for e in GROUNDS["real-life"].plan(7, quick=True)) == Counter(list(ground.CLASSES))


def test_the_short_ground_has_120_cases_of_half_a_hunting_cycle_to_two() -> None:
    entries = GROUNDS["short"].plan(7)
    assert len(entries) == 120
    assert all(0.5 <= e.cycles <= 2.0 for e in entries)
    assert 0.2 <= sum(not e.physics for e in entries) / 120 <= 0.3
    made: Any = GROUNDS["short"].make(3, next(e for e in entries if e.klass == "healthy" and e.cycles == 0.7))
    assert made.truth["hunting_cycles"] == pytest.approx(0.7, abs=0.01)


def test_a_case_depends_on_seed_and_index_alone() -> None:
    entry = CaseEntry(index=9, klass="train", physics=(), over=20.0, variant=0, cycles=0.5)
    one, two = ground.make(5, entry), ground.make(5, entry)
    assert one == two
    assert ground.make(6, entry) != one


@pytest.mark.long
@pytest.mark.parametrize(("klass", "variant"), [(klass, 1 if klass != "even" else 3) for klass in ground.CLASSES])
def test_truths_and_files_are_whole(klass: str, variant: int) -> None:
    """Every truth says what may be named, what must be located and what can be known, and every file reads."""
    made = case(klass, variant, 0.5 if klass in ground.CLASSES_WITH_SHORT_CASES else 0.0)
    told = json.loads(made.truth_text())
    assert {"kind", "truth", "background", "may_name", "noise_um"} <= set(told)
    for item in told["truth"]:
        if "physics" in item:
            assert {"over_limit", "rivals", "unknown"} <= set(item)
            assert item["physics"] in CATALOGUE
            assert item["physics"] in [one["physics"] for one in told["may_name"]]
            assert item["unknown"]["separability"] <= 1.0 and item["unknown"]["left"] <= 1.0
    tomllib.loads(made.pair_text)
    assert "truth" not in dict(made.files())
    for k in range(told["recordings"]):
        assert all(np.all(np.isfinite(values)) for values in table(made, k).values())


# wander


@pytest.mark.long
def test_the_wander_has_the_spectrum_of_an_exponential_and_of_a_smooth_memory() -> None:
    """2 s^2 T / (1 + (w T)^2), and 4 s^2 a^3 / (a^2 + w^2)^2 with a = sqrt(3) / T: the Fourier transforms of both."""
    n, step = 2001, 0.5
    time = np.arange(n) * step
    lags = time - time[n // 2]
    for rough, smooth in ((3.0, 0.0), (0.0, 3.0)):
        row = covariance(time, rough=rough, rough_s=20.0, smooth=smooth, smooth_s=40.0)[n // 2]
        for hz in (0.002, 0.01, 0.05):
            w, a = 2 * pi * hz, sqrt(3.0) / 40.0
            law = 2 * rough**2 * 20.0 / (1 + (w * 20.0) ** 2) + 4 * smooth**2 * a**3 / (a * a + w * w) ** 2
            found = float(np.trapezoid(row * np.cos(w * lags), dx=step))
            assert found == pytest.approx(law, rel=0.02)  # steps of 1/40 of the memory, half of 500 s beyond either end


def test_the_wander_in_the_file_is_as_large_as_the_truth_says_and_the_clock_errs() -> None:
    made = case("wander", 0)
    told, read = made.truth, table(made)
    turns = np.ptp(read["driven_angle_deg"]) / 360.0 * 47 / 12
    assert 2.9 < turns < 12.1
    x = read["te_um"]
    # One draw of a course that remembers a turn or more: within a factor of three of its rms about its own mean.
    rms = sqrt(told["wander"]["rough"] ** 2 + told["wander"]["smooth"] ** 2)
    assert 0.1 * rms < x.std() < 3.0 * rms
    assert abs(told["rate_error"]) <= 2e-3
    rate = np.polyfit(read["time_s"], read["driven_angle_deg"], 1)[0]
    assert rate == pytest.approx(360.0 * 0.5 / 60.0 * 12 / 47 * (1 + told["rate_error"]), rel=1e-6)


def test_a_line_beneath_the_wander_has_the_limit_of_its_spectrum() -> None:
    """An amplitude's standard deviation is sqrt(2 S / T), S the two-sided spectrum at its frequency."""
    n, step = 1200, 0.5
    time = np.arange(n) * step
    V = covariance(time, rough=2.0, rough_s=5.0, smooth=0.0, smooth_s=1.0) + 0.01 * np.eye(n)
    w = 2 * pi * 0.1
    wave = np.cos(w * time)
    gls = 1 / sqrt(float(wave @ np.linalg.solve(V, wave)))
    S = 2 * 4.0 * 5.0 / (1 + (w * 5.0) ** 2) + 0.01 * step
    assert gls == pytest.approx(sqrt(2 * S / (n * step)), rel=0.1)  # the sampled spectrum folds some per cent in


# coarse


@pytest.mark.long
def test_readings_are_a_staircase_of_the_encoders_counts_and_repeat() -> None:
    for variant in (1, 3):
        made = case("coarse", variant, 0.5)
        told, read = made.truth, table(made)
        step = 360.0 / 2 ** told["bits"]
        for name in ("driving_angle_deg", "driven_angle_deg"):
            counts = read[name] / step
            assert np.abs(counts - np.round(counts)).max() < 1e-5  # eight digits of a degree
        held = read["driven_angle_deg"][: len(read["driven_angle_deg"]) // told["repeat"] * told["repeat"]]
        assert np.ptp(held.reshape(-1, told["repeat"]), axis=1).max() == 0.0


def test_counting_makes_the_noise_of_a_rectangle() -> None:
    """A step over the root of 12, of both encoders at their base circles."""
    rng = np.random.default_rng(1)
    chain = Chain(steps_deg=(0.09, 0.08))
    angles = rng.uniform(0, 360, (2, 200_000))
    x = np.zeros(200_000)
    for k, (step, reading) in enumerate(zip(chain.steps_deg, angles, strict=True), start=1):
        x += PAIR.gear(k).r_b * RAD_PER_DEG * (np.round(reading / step) * step - reading) / MM_PER_UM
    assert coarse.counting_noise_um(ideal(PAIR), chain) == pytest.approx(x.std(), rel=0.01)  # 200 000 draws


def test_by_hand_starts_stops_and_goes_on() -> None:
    path = coarse.by_hand(ideal(PAIR), RecordedCondition(torque=0.0, turns=4.0, per_mesh=14), np.random.default_rng(2))
    speed = np.diff(path.theta_2) / np.diff(path.time)
    still = speed < 1e-9
    assert still[0] and still[-1] and still[len(still) // 4 : -len(still) // 4].any()
    assert speed.min() > -1e-9
    assert speed.max() / np.median(speed[~still]) > 1.2  # uneven by hand
    assert np.ptp(path.theta_2) == pytest.approx(2 * pi * 4.0 * 18 / 25)


# train


@pytest.mark.long
def test_the_waves_of_a_train_are_at_the_orders_that_the_wheels_give() -> None:
    for variant in (0, 1, 2):
        made = case("train", variant, 0.5)
        told = made.truth
        q, z = told["other_wheel_teeth"], told["next_wheel_teeth"]
        allowed = [float(q), q / z, 2 * q / z, 2.0, 3.0, 4.0, 5.0]
        for wave in told["background"]:
            assert min(abs(wave["order"] - one) for one in allowed) < 1e-3
            assert wave["gear"] == (1 if told["turns_with"] == "driving" else 2)
        assert not [one for one in told["may_name"] if one["physics"] == "cumulative_pitch"] or any(
            item["physics"] == "cumulative_pitch" or item.get("rivals") for item in told["truth"]
        )
        stated = tomllib.loads(made.pair_text)
        assert ("also_turns" in stated) == told["stated"]


# even


def test_samples_are_even_in_the_angle() -> None:
    condition = RecordedCondition(torque=0.0, turns=5.0, per_mesh=8, uneven=0.0, wobble=0.008)
    path = even_angles(ideal(PAIR), condition, np.random.default_rng(3))
    steps = np.diff(path.theta_2)
    assert np.ptp(steps) / steps.mean() < 1e-8  # rounding of angles of ten radians
    assert np.ptp(np.diff(path.time)) / np.diff(path.time).mean() > 1e-3  # the speed wobbles, so times are not


def test_a_wave_and_its_aliases_are_the_same_at_even_samples() -> None:
    """cos(k t) and cos(|k - m N| t) agree at t = 2 pi n / N, on either shaft; the lowest comes first."""
    per_turn = 150.0
    t = 2 * pi * np.arange(400) / per_turn
    for gear, order in ((1, 504.0), (2, 361.0)):
        ratio = 25 / 18 if gear == 1 else 1.0
        places = folded({"order": order, "gear": gear}, 18, 25, per_turn)
        assert places[0] * ratio <= per_turn / 2 + 1e-6
        for one in places:  # orders are rounded to four digits, and there are 17 radians
            assert np.abs(np.cos(order * ratio * t) - np.cos(one * ratio * t)).max() < 2e-3


@pytest.mark.long
def test_a_gear_that_no_encoder_reads_has_no_tooth_numbers() -> None:
    """The rig states the transmission error and the driven angle: of a tooth of the driving gear neither number nor
    reading can be told, of one of the driven gear both."""
    found = {}
    for seed in range(8):
        entry = CaseEntry(index=5, klass="even", physics=(), over=20.0, variant=5, cycles=0.5)
        (item,) = ground.make(seed, entry).truth["truth"]
        assert item["physics"] == "tooth_pitch"
        found[item["gear"]] = item
    assert found[1]["tooth"] is None and found[1]["encoder_deg"] is None
    assert found[2]["tooth"] is not None and found[2]["encoder_deg"] is not None


# large


def test_plastic_bends_by_the_modulus() -> None:
    """Teeth of a hundredth of the modulus bend a hundred times as far, contact included (linear Hertz of Sainsot)."""
    theta_2 = np.linspace(0.0, 1.0, 300)
    steel = replace(ideal(PAIR, E_s=-200.0), deflect=True)
    plastic = replace(steel, youngs_mpa=2060.0)
    bent = [mesh(rig, theta_2, torque=t).x.mean() for rig, t in ((steel, 20.0), (plastic, 0.2))]
    assert bent[1] == pytest.approx(bent[0], rel=1e-6)  # the same compliance times load; the law is linear


@pytest.mark.long
def test_large_cases_have_no_grade_and_large_errors() -> None:
    for variant in (0, 3):
        made = case("large", variant, 0.5)
        stated = tomllib.loads(made.pair_text)
        assert "grade" not in stated["driving"] and "limits" not in stated["driven"]
        assert stated["material"]["youngs_modulus_gpa"] == made.truth["youngs_modulus_gpa"]
        assert made.truth["within"] == 0.10
    sizes = [case("large", v, 0.5).truth["truth"][0] for v in (0, 3)]
    assert 30.0 <= abs(sizes[0]["amplitude_um"]) <= 100.0
    assert 30.0 <= abs(sizes[1]["deviation_um"]) <= 100.0


# wrong file


@pytest.mark.long
def test_every_wrong_file_says_what_its_truth_says() -> None:
    for variant, what in enumerate(SAYS):
        made = case("wrong_file", variant, 0.5)
        told = made.truth
        assert (told["kind"], told["file"]["wrong"]) == ("wrong_file", what)
        assert not told["may_name"] and not told["truth"]
        read, stated = table(made), tomllib.loads(made.pair_text)
        if what == "profile_shift":
            assert stated["driving"]["profile_shift"] == 0 != make_pair(told["pair"]).driving.x
            assert told["file"]["over_limit"] > 0.0
        if what == "pressure_angle":
            assert stated["driving"]["pressure_angle_deg"] != make_pair(told["pair"]).driving.alpha_deg
        if what == "radians":
            assert np.ptp(read["driven_angle_deg"]) < 2 * pi * 25
        if what == "milliseconds":
            turns = np.ptp(read["driving_angle_deg"]) / 360.0
            assert np.ptp(read["time_s"]) / 1000.0 * 60.0 / 60.0 == pytest.approx(turns, rel=2.5)
        if what == "columns_swapped":
            pair = make_pair(told["pair"])
            ratio = np.ptp(read["driving_angle_deg"]) / np.ptp(read["driven_angle_deg"])
            assert ratio == pytest.approx(pair.driving.z / pair.driven.z, rel=1e-3)


def test_another_gears_sheet_is_seen_by_the_limit_of_its_differences() -> None:
    """Unloaded, with every tooth declared to 0.5 um: grade 7 sheets differ by some um, so by many times the limit."""
    made = case("wrong_file", 2, 0.5)
    assert made.truth["file"]["over_limit"] > 7.0


# outside


def test_a_new_physics_is_in_the_ground_by_itself() -> None:
    assert set(LATER) == set(PHYSICS_BY_NAME) - set(GROUNDS["bench"].plan(1)[0].physics) - {
        e.physics[0] for e in GROUNDS["bench"].plan(1) if e.klass == "single"
    } - {"disturbance"}
    assert {"tooth_chip", "support_compliance", "torque_pulse", "softness_drift", "bearing"} <= set(LATER)


def chipped(height: float, gear: int = 1) -> Rig:
    return apply(ideal(PAIR), Effect(physics="tooth_chip", gear=gear, size=height, more={"tooth": 4}))


@pytest.mark.parametrize("gear", [1, 2])
def test_a_chipped_tooth_leaves_the_mesh_where_its_tip_is_gone(gear: int) -> None:
    """The path of contact of that tooth is shorter by the roll length from the broken end to the tip circle. Neighbours
    bridge what is shorter than the overlap of eps - 1 base pitches; beyond, only a corner carries."""
    g = PAIR.gear(gear)
    theta_2 = np.linspace(3.0, 6.0, 6000, endpoint=False) * PAIR.driven.tau  # 2000 to a pitch
    bridged, gap = 0.9, 1.7
    for height in (bridged, gap):
        lost = g.l_tip - g.roll(g.r_a - height)
        x = mesh(chipped(height, gear), theta_2, torque=0.0).x / MM_PER_UM
        missing = lost - (PAIR.eps - 1) * PAIR.p_b
        if height == bridged:
            assert missing < 0 and np.abs(x).max() < 1e-6
        else:
            # Corners of both neighbours reach on into the gap: where TE falls is what is missing, in parts of a pitch.
            fallen = (np.abs(x) > 1e-3).mean() * 3 * PAIR.p_b
            assert fallen == pytest.approx(missing, rel=0.03)  # 100 positions and more


@pytest.mark.parametrize("flank", ["drive", "coast"])
def test_a_chip_is_on_both_flanks(flank: str) -> None:
    theta_2 = np.linspace(0.0, 2 * pi * 18 / 25, 2500, endpoint=False)
    assert (
        np.ptp(mesh(chipped(1.7), theta_2, torque=0.0, flank=flank).x) > 0.5 * MM_PER_UM
    )  # seven positions of 1.15 um


def test_supports_open_the_mesh_in_step_with_torque() -> None:
    """To first order the flanks open by da sin(alpha) each way: the mean of the drive flank falls by that."""
    rig = apply(ideal(PAIR), Effect(physics="support_compliance", size=0.5))
    theta_2 = np.linspace(0.0, 1.0, 200)
    for torque in (10.0, 40.0):
        fall = mesh(rig, theta_2, torque=0.0).x.mean() - mesh(rig, theta_2, torque=torque).x.mean()
        # (r_b1 + r_b2)(inv alpha' - inv alpha): second order is 20 um in 43 mm.
        assert fall / MM_PER_UM == pytest.approx(0.5 * torque * np.sin(radians(20)), rel=2e-3)


def test_a_torque_that_pulses_bends_teeth_once_a_turn() -> None:
    """Away from the changes between one pair and two, TE is linear in the torque: 5 % of the deflection, order 1."""
    rig = replace(ideal(PAIR), deflect=True)
    pulsing = apply(rig, Effect(physics="torque_pulse", size=0.05, more={"phase": 0.3}))
    theta_2 = np.linspace(0.0, 2 * pi, 5000, endpoint=False)
    still, moved = (mesh(one, theta_2, torque=40.0).x for one in (rig, pulsing))
    first = 2 * np.mean((moved - still) * np.exp(-1j * (theta_2 + 0.3)))
    assert first.real == pytest.approx(0.05 * still.mean(), rel=0.02)  # Sainsot is linear but for corners
    assert abs(first.imag) < 0.02 * abs(first.real)


def test_softness_grows_from_start_to_end() -> None:
    """At the end teeth bend by the part more that the law gives at a compliance so much larger, contact left out."""
    rig = replace(ideal(PAIR), deflect=True)
    softening = apply(rig, Effect(physics="softness_drift", size=0.2))
    theta_2 = np.linspace(0.0, 2 * pi, 2000)
    x = mesh(softening, theta_2, torque=40.0, span=(0.0, 2 * pi)).x
    last = mesh(replace(rig, scale=1.2), theta_2, torque=40.0).x
    plain = mesh(rig, theta_2, torque=40.0).x
    assert x[0] == pytest.approx(plain[0], abs=1e-7)
    assert x[-1] == pytest.approx(last[-1], abs=1e-7)  # the solver's 0.1 nm


def test_a_bearing_is_a_line_at_no_whole_order() -> None:
    made = case("outside", LATER.index("bearing"))
    (item,) = made.truth["truth"]
    assert abs(item["order"] - round(item["order"])) > 0.05
    assert made.truth["kind"] == "unknown" and not made.truth["may_name"]
    assert item["over_limit"] >= 7.0


# controls


@pytest.mark.long
def test_controls_are_of_another_pair_of_nearly_the_same_ratio() -> None:
    for variant in (1, 2, 4):
        told = case("controls", variant).truth
        z_1, z_2 = told["file"]["true_teeth"]
        assert 1e-3 < abs(z_1 / z_2 / (18 / 25) - 1) < 1e-2
        assert make_pair(told["pair"]).a == pytest.approx(43.0, abs=0.35)  # shifted teeth: to a hundredth
        assert told["control"] and not told["may_name"] and not told["truth"]
        read = table(case("controls", variant))
        if told["file"]["by"] == "angles":
            ratio = np.ptp(read["driven_angle_deg"]) / np.ptp(read["driving_angle_deg"])
            assert ratio == pytest.approx(z_1 / z_2, rel=1e-4)


# The unknown as a rival


def test_the_evidence_of_columns_is_that_of_an_integral() -> None:
    """One column, by quadrature over its amplitude."""
    rng = np.random.default_rng(4)
    s, c = rng.standard_normal(30), 0.7 * rng.standard_normal(30)
    a = np.linspace(-12.0, 12.0, 40_001)
    weights = np.exp(-0.5 * ((s[:, None] - c[:, None] * a) ** 2).sum(0) + 0.5 * s @ s - 0.5 * a * a) / sqrt(2 * pi)
    by_quadrature = np.log(np.trapezoid(weights, a))
    assert log_evidence(s, s, c[:, None], c[:, None]) == pytest.approx(by_quadrature, abs=1e-6)


def test_an_eccentricity_is_hardly_told_from_a_wave_and_a_pitch_wave_is() -> None:
    """As on a linear toy that shares nothing with this: the stairs of a pitch wave tell it, 1 um of eccentricity has
    nothing of its own but its second order."""
    chain = Chain(noise_um=0.3)
    condition = RecordedCondition(torque=0.0, turns=25.0, per_mesh=12)
    from gearpoly.proving.limit import DetectionLimit, sights
    from gearpoly.proving.unknown import unknown

    rig = ideal(PAIR, E_s=-60.0)
    path = motion(rig, condition, np.random.default_rng(1))
    known = (0.04 * np.eye(18), 0.04 * np.eye(25))
    limit = DetectionLimit(rig, sights((condition,), (path,), chain), chain, index=known, slope=known, thickness=1.0,
                  compliance=0.0, zero=1.0)  # fmt: skip
    off = Effect(physics="eccentricity", gear=1, size=1.0, more={"angle_deg": 30.0})
    wave = Effect(physics="cumulative_pitch", gear=1, size=1.0, more={"order": 5, "phase": 0.3})
    assert unknown(rig, limit, off)["log_odds"] < 6.0
    assert unknown(rig, limit, wave)["log_odds"] > 8.0
    assert te(rig, condition, path).size == path.time.size


def test_a_tooth_that_no_sample_meets_leading_is_written_with_an_unknown_of_nothing() -> None:
    """At 1.8 samples per mesh every tooth is met in few places. Of this driven tooth a neighbour leads at all of them,
    so to first order its pitch shows nothing, and nothing is what any unknown of its flank makes of it."""
    plan = GROUNDS["real-life"].plan(602214076)
    made = GROUNDS["real-life"].make(602214076, plan[60])
    assert plan[60].klass == "wander"
    (item,) = made.truth["truth"]
    assert (item["physics"], item["over_limit"]) == ("tooth_pitch", 0.0)
    assert {key: item["unknown"][key] for key in ("log_odds", "separability", "left")} == dict.fromkeys(
        ("log_odds", "separability", "left"), 0.0
    )
    assert item["unknown"]["place"] == "tooth"


@pytest.mark.long
def test_a_wave_of_the_background_is_as_large_over_its_limit_as_it_is() -> None:
    """The largest waves are cut at 10 um. Those then lie less above the limit than asked for, and as far above as their
    power over the wander's says."""
    cut = 0
    for variant in range(12):
        made = case("wander", variant)
        told = made.truth
        for wave in told["background"]:
            assert wave["amplitude_um"] <= 10.0 + 1e-9
            cut += wave["amplitude_um"] == 10.0
            if wave["amplitude_um"] < 10.0:
                continue
            columns = table(made)
            time, angle = columns["time_s"], np.radians(columns["driven_angle_deg"])
            known = {key: told["wander"][key] for key in ("rough", "rough_s", "smooth", "smooth_s")}
            root = np.linalg.cholesky(covariance(time, **known) + told["noise_um"] ** 2 * np.eye(time.size))
            free = np.column_stack((np.ones_like(time), time, *(f(wave["order"] * angle) for f in (np.cos, np.sin))))
            white = np.linalg.solve(root, free)
            both = np.linalg.svd(white[:, 2:] - white[:, :2] @ np.linalg.lstsq(white[:, :2], white[:, 2:])[0])[1]
            # Its phase is drawn; times and the rate are told to four figures.
            low, high = 10.0 * both[1], 10.0 * both[0]
            assert 0.7 * low <= wave["over_limit"] <= 1.3 * high
    assert cut > 3
