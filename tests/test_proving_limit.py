"""The theoretical limit of an effect: what teeth, zeros, means and waves of a background leave of its signal."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

from gearpoly.proving.case import whitened
from gearpoly.proving.chain import Chain, RecordedCondition, motion
from gearpoly.proving.disturbance import Disturbance
from gearpoly.proving.drawn import draw, make_pair
from gearpoly.proving.effects import Effect, apply, instance
from gearpoly.proving.limit import DetectionLimit, sights
from gearpoly.proving.rig import Rig, ideal

PAIR = make_pair("18/25 m2")


def limit_of(
    rig: Rig, n_noise: float, colour: float = 0.0, prior: float = 1e-4, zero: float = 1e-3
) -> tuple[DetectionLimit, int]:
    condition = RecordedCondition(torque=0.0, turns=25.0)
    chain = Chain(noise_um=n_noise, colour=colour)
    path = motion(rig, condition, np.random.default_rng(1))
    known_1, known_2 = (prior**2 * np.eye(gear.z) for gear in (rig.pair.driving, rig.pair.driven))
    look = sights((condition,), (path,), chain)
    limit = DetectionLimit(
        rig, look, chain, index=(known_1, known_2), slope=(known_1, known_2), thickness=0.1, compliance=0.0, zero=zero
    )  # fmt: skip
    return limit, path.time.size


def test_limit_of_a_wave_in_white_noise() -> None:
    """With all teeth known the limit of a sine's amplitude is sigma sqrt(2 / N)."""
    limit, n = limit_of(ideal(PAIR), 1.0)
    wave = Effect(physics="eccentricity", gear=1, size=1.0, more={"angle_deg": 20.0})
    assert limit.over(apply(ideal(PAIR), wave)) == pytest.approx(
        sqrt(n / 2), rel=0.02
    )  # 4000 of 9000 samples looked at
    assert limit.rms_um(apply(ideal(PAIR), wave)) == pytest.approx(sqrt(0.5), rel=0.01)


def test_limit_in_coloured_noise_follows_its_spectrum() -> None:
    """A slow wave in AR(1) noise: the spectrum at its frequency is (1 + phi) / (1 - phi) times the white one."""
    phi = 0.6
    wave = Effect(physics="eccentricity", gear=1, size=1.0, more={"angle_deg": 20.0})
    rig = apply(ideal(PAIR), wave)
    white, _ = limit_of(ideal(PAIR), 1.0)
    coloured, _ = limit_of(ideal(PAIR), 1.0, colour=phi)
    ratio = coloured.over(rig) / white.over(rig)
    assert ratio == pytest.approx(sqrt((1 - phi) / (1 + phi)), rel=0.02)  # 360 samples per turn: nearly zero frequency


def test_unknown_teeth_hide_a_pitch_error_and_gauges_bound_it() -> None:
    rng = np.random.default_rng(2)
    base = replace(
        ideal(PAIR), teeth_1=draw(PAIR.driving, 5, -60.0, rng), teeth_2=draw(PAIR.driven, 5, -60.0, rng)
    )  # fmt: skip
    moved = np.zeros(18)
    moved[5] = 1.0
    free, _ = limit_of(base, 0.3, prior=100.0)
    gauge, _ = limit_of(base, 0.3, prior=0.2)
    assert free.size_of(free.index_signal(1, moved)) < 0.02  # 1 um against 100 um of freedom, and as much of the mean
    assert 3.0 < gauge.size_of(gauge.index_signal(1, moved)) <= 5.0  # 1 um against a gauge of 0.2 um


def test_slopes_count_as_a_fit_of_the_teeth_takes_them() -> None:
    """A small slope of all teeth is what its columns say; a large one bends the curve, which is no evidence."""
    rng = np.random.default_rng(2)
    base = replace(
        ideal(PAIR), teeth_1=draw(PAIR.driving, 5, -60.0, rng), teeth_2=draw(PAIR.driven, 5, -60.0, rng)
    )  # fmt: skip
    limit, _ = limit_of(base, 0.3, prior=0.2)
    teeth = base.teeth_1
    small = limit.difference(replace(base, teeth_1=replace(teeth, slope=teeth.slope + 1e-3)))
    taken = limit.slope_signal(1, np.full(18, 1e-3))
    # Hand-overs move by a part of a sample's spacing: a few samples in a hundred see the step there.
    assert np.linalg.norm(small - taken) < 0.2 * np.linalg.norm(taken)


def test_form_that_a_grade_leaves_open_hides_a_crowning() -> None:
    """With a prior as large as it no recording makes a crowning more than one standard deviation. Its column is that of
    a small one to 2 %; a large one hands over elsewhere."""
    rng = np.random.default_rng(2)
    base = replace(
        ideal(PAIR), teeth_1=draw(PAIR.driving, 5, -60.0, rng), teeth_2=draw(PAIR.driven, 5, -60.0, rng)
    )  # fmt: skip
    condition, chain = RecordedCondition(torque=0.0, turns=25.0), Chain(noise_um=0.003)
    path = motion(base, condition, rng)
    known = (1e-8 * np.eye(18), 1e-8 * np.eye(25))
    look = sights((condition,), (path,), chain)
    shut, left_open = (
        DetectionLimit(base, look, chain, index=known, slope=known, thickness=0.1, compliance=0.0, zero=1e-3, form=form)
        for form in ((0.0, 0.0), (1.0, 0.0))
    )  # fmt: skip
    small = shut.difference(replace(base, teeth_1=replace(base.teeth_1, crowning=np.full(18, 0.01))))
    taken = shut.form_signal(1, 0.01)
    assert np.linalg.norm(small - taken) < 0.02 * np.linalg.norm(taken)
    assert shut.size_of(100.0 * taken) > 20.0
    assert left_open.size_of(100.0 * taken) == pytest.approx(1.0, abs=0.01)


@pytest.mark.long
@pytest.mark.parametrize("physics", ["tooth_pitch", "cumulative_pitch", "profile_slope", "profile_crowning"])
def test_what_teeth_as_built_may_be_counts_no_more_than_to_first_order(physics: str) -> None:
    """Which pairs lead bends with the size of a deviation; that bend is no evidence, for a fit of the teeth follows it.
    Nor is it any that a line drawn from nothing goes on where the curve does not."""
    rng = np.random.default_rng(2)
    base = replace(
        ideal(PAIR), teeth_1=draw(PAIR.driving, 5, -60.0, rng), teeth_2=draw(PAIR.driven, 5, -60.0, rng)
    )  # fmt: skip
    limit, _ = limit_of(base, 0.3, prior=0.2)
    effect = instance(physics, PAIR, (RecordedCondition(torque=0.0, turns=25.0),), rng)
    small = 1e-3 * limit.size_of(whitened(base, limit, effect.scaled(1e-3))) / 1e-6
    for size in (2.0, 8.0):
        over = limit.size_of(whitened(base, limit, effect.scaled(size)))
        assert 0.0 < over <= 1.001 * size * small
        assert over <= limit.over(apply(base, effect.scaled(size))) * 1.001


def test_a_tooth_that_has_left_the_mesh_shows_no_more_for_standing_farther_back() -> None:
    """Of small gears that are unloaded: where a tooth lags by more than its neighbours carry over (8 um here), the
    gears turn as if it were not there, so a deviation that just does so explains as much, and is likelier."""
    rng = np.random.default_rng(2)
    pair = make_pair("30/45 m0.5")
    base = Rig(pair=pair, teeth_1=draw(pair.driving, 5, -60.0, rng), teeth_2=draw(pair.driven, 5, -60.0, rng))
    limit, _ = limit_of(base, 0.3, prior=1.0)
    sizes = []
    for lag in (-24.0, -48.0):
        effect = Effect(physics="tooth_pitch", gear=1, size=lag, more={"tooth": 7})
        first = limit.size_of(limit.index_signal(1, apply(base, effect).teeth_1.p - base.teeth_1.p))
        sizes.append(limit.size_of(whitened(base, limit, effect)))
        assert sizes[-1] < 0.7 * first
    # Parts are tried in steps that double at most, and the least of all lies between two of them.
    assert sizes[1] < 1.5 * sizes[0]


def test_a_zero_that_nobody_stated_hides_what_only_moves_the_mesh() -> None:
    """Teeth that all stand one um ahead do what a zero does that is off by as much, to the second order of 1 um."""
    rng = np.random.default_rng(2)
    base = replace(
        ideal(PAIR), teeth_1=draw(PAIR.driving, 5, -60.0, rng), teeth_2=draw(PAIR.driven, 5, -60.0, rng)
    )  # fmt: skip
    aside = [replace(one, p=one.p + sense) for one, sense in ((base.teeth_1, 1.0), (base.teeth_2, -1.0))]
    there = replace(base, teeth_1=aside[0], teeth_2=aside[1])
    known, _ = limit_of(base, 0.003, zero=1e-3)
    unknown, _ = limit_of(base, 0.003, zero=1e3)
    assert known.over(there) > 20.0
    assert unknown.over(there) < 0.1 * known.over(there)


def test_mean_offset_says_nothing() -> None:
    limit, _ = limit_of(ideal(PAIR), 0.3)
    assert limit.over(replace(ideal(PAIR), pair=replace(PAIR, offset=0.01))) < 0.05  # one recording, unknown zero


def test_an_open_wave_costs_an_effect_only_what_they_have_in_common() -> None:
    """A wave at 3.6 turns leaves an eccentricity as it was; at its own order it takes all of it but for the phase."""
    still = ideal(PAIR)
    condition, chain = RecordedCondition(torque=0.0, turns=25.0, wobble=0.0), Chain(noise_um=1.0)
    path = motion(still, condition, np.random.default_rng(1))
    look = sights((condition,), (path,), chain)
    known = (1e-8 * np.eye(18), 1e-8 * np.eye(25))
    over = []
    for order in (None, 3.6, 1.0):
        waves = () if order is None else (Disturbance(kind="line", amplitude=0.0, gear=1, order=order),)
        limit = DetectionLimit(
            still, look, chain, index=known, slope=known, thickness=0.1, compliance=0.0, zero=1e-3, waves=waves
        )  # fmt: skip
        wave = Effect(physics="eccentricity", gear=1, size=1.0, more={"angle_deg": 20.0})
        over.append(limit.over(apply(still, wave)))
    # 4000 looks scattered over 25 turns have a chance sine of 1/sqrt(4000) with a wave that is none of theirs.
    assert over[1] == pytest.approx(over[0], rel=0.01)
    # What is left of 1 um is its second order: the line of action tilts.
    assert over[2] < 0.02 * over[0]


@pytest.mark.parametrize("colour", [0.0, 0.6])
def test_the_limit_looks_at_every_phase_of_the_mesh(colour: float) -> None:
    """52 360 samples, 14 a mesh, of which 4000 are looked at: every fourteenth would show one phase only."""
    pair = make_pair("17/22 m4 22.5deg")
    condition = RecordedCondition(torque=0.0, flank="drive", turns=220.0, per_mesh=14, wobble=0.0)
    path = motion(ideal(pair), condition, np.random.default_rng(1))
    assert path.time.size == 52360
    (look,) = sights((condition,), (path,), Chain(noise_um=1.0, colour=colour))
    phase = path.angle(look.time) * pair.driving.z / (2 * pi) % 1.0
    count = np.histogram(phase, bins=14, range=(0.0, 1.0))[0]
    # Of 4000 looks 286 fall on each phase, give or take 17; four times that comes in one of 1100 such tests.
    assert np.all(np.abs(count - look.time.size / 14) < 4.0 * sqrt(look.time.size / 14))
    assert look.share * look.time.size == pytest.approx(path.time.size * look.run / max(look.run - 1, 1), rel=0.01)
