"""Jumps: when and by how much, none where something else is, and nothing claimed in their place."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearpoly.compare.compare import compare
from gearpoly.compare.entries import Entry, says
from gearpoly.compare.jump_search import next_jump
from gearpoly.compare.jumps import Jump, Left, rise, size_of, weigh_steps
from gearpoly.compare.locate import locate
from gearpoly.compare.model import JointModel
from gearpoly.compare.noise import Noise
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.diagnose.diagnose import diagnose
from gearpoly.diagnose.heldout import beside_jumps
from gearpoly.diagnose.prepare import prepare
from gearpoly.files.models import PairFile
from gearpoly.recording.recording import Recording
from gearpoly.units import FloatArray
from tests.made_recordings import Rig, inspected, off_deg, record
from tests.residuals import healthy, noise, residual, samples

UM = 1e-3


def known(z_1: int = 18, z_2: int = 25) -> tuple[GearKnown, GearKnown]:
    return GearKnown(z=z_1, uncertainty=0.2 * UM), GearKnown(z=z_2, uncertainty=0.2 * UM)


def graded() -> tuple[GearKnown, GearKnown]:
    one, two = (GearKnown(z=z, f_pT=8 * UM, F_pT=30 * UM, f_HalphaT=7 * UM) for z in (18, 25))
    return one, two


def made(seed: int, kind: str = "white", *, cycles: float = 1.0) -> AlignedResidual:
    """A healthy 18/25 pair in noise of 1 um; one hunting cycle lasts 50 s, at 180 samples a second."""
    return healthy(np.random.default_rng(seed), z_1=18, z_2=25, cycles=cycles, kind=kind)


def plus(data: AlignedResidual, values_um: FloatArray) -> AlignedResidual:
    return replace(data, residual=data.residual + UM * values_um)


def along(data: AlignedResidual) -> FloatArray:
    """Time as a part of the record, (n,)."""
    assert data.time_s is not None
    return (data.time_s - data.time_s[0]) / np.ptp(data.time_s)


def jumped(data: AlignedResidual, *jumps: tuple[float, float]) -> AlignedResidual:
    """With jumps of so many um at parts of the record."""
    for at, size in jumps:
        data = plus(data, np.where(along(data) > at, size, 0.0))
    return data


def found(*data: AlignedResidual, gears: tuple[GearKnown, GearKnown] | None = None) -> tuple[Entry, ...]:
    return locate(list(data), gears=known() if gears is None else gears).entries


def only_jumps(entries: tuple[Entry, ...]) -> list[Entry]:
    return sorted((e for e in entries if e.label == "jump"), key=lambda e: e.time_s or 0.0)


def matches(entry: Entry, data: AlignedResidual, at: float, size: float) -> bool:
    """Whether an entry says this jump, within three stated errors; the place has no normal law, so five there."""
    assert data.time_s is not None and entry.time_s is not None and entry.time_s_std is not None
    assert entry.amplitude_um is not None and entry.std_um is not None
    off = entry.time_s - (data.time_s[0] + at * np.ptp(data.time_s))
    return abs(off) < 5.0 * entry.time_s_std and abs(entry.amplitude_um - size) < 3.0 * entry.std_um


def some_left(n: int = 400, *, burst: float = 0.0) -> tuple[Left, FloatArray, FloatArray]:
    """A small fit with priors, made by hand: what is left, its columns before whitening, and the prior's precision; ten
    whitened samples are ``burst`` too large."""
    rng = np.random.default_rng(1)
    lines = np.linspace(0.0, 0.5, 50)
    noise = Noise(
        level=1.0, level_std=0.0, ar=np.array([0.5, 0.1]), innovation=0.7, frequency=lines, density=np.ones(50),
        rest=np.ones(50), count=np.full(50, 12.0), cycles=0, basis="", repeatable=None,
    )  # fmt: skip
    x = np.linspace(-1.0, 1.0, n)
    columns = np.column_stack([np.ones(n), x, x**2, np.cos(40.0 * x), (np.arange(n) // 20 % 5 == 0).astype(float)])
    precision = np.array([0.0, 0.0, 0.0, 0.0, 3.0])
    white, values = noise.whitened(columns), rng.normal(size=n) + noise.whitened(0.4 * (x > 0.2))
    values[100:110] += burst
    normal = white.T @ white + np.diag(precision)
    beta = np.linalg.solve(normal, white.T @ values)
    left = Left(
        whites=(white,), beta=beta, covariance=np.linalg.inv(normal),
        rest=values - white @ beta, noise=noise,
    )  # fmt: skip
    return left, columns, precision


def misfit(left: Left, columns: FloatArray, precision: FloatArray) -> float:
    """Least of the square misfit plus prior, by a solver that knows nothing of scores."""
    values = left.rest + left.apply(left.beta)
    stacked = np.concatenate([columns, np.diag(np.sqrt(precision))])
    target = np.concatenate([values, np.zeros(precision.size)])
    return float(np.sum((target - stacked @ np.linalg.lstsq(stacked, target, rcond=None)[0]) ** 2))


def test_steps_weighed_in_one_pass_are_those_fitted_one_by_one() -> None:
    left, columns, precision = some_left()
    n = left.rest.size
    steps = weigh_steps(left, low=20, high=n - 20, barred=np.zeros(n, dtype=np.bool_))
    white = left.noise.whitened(columns)
    before = misfit(left, white, precision)
    for j in (20, 57, 240, 241, n - 21):
        step = left.noise.whitened((np.arange(n) >= j).astype(np.float64))
        with_step = misfit(left, np.column_stack([white, step]), np.append(precision, 0.0))
        # Both are exact but for rounding of a few hundred sums.
        assert steps.gain[j - 20] == pytest.approx(before - with_step, rel=1e-8)
        assert float(left.gains(step[:, None])[0]) == pytest.approx(before - with_step, rel=1e-8)


def test_parameters_left_out_and_put_in_are_those_of_another_fit() -> None:
    left, columns, precision = some_left()
    white = left.noise.whitened(columns)
    few = left.without(np.array([1, 2]))
    kept = [0, 3, 4]
    normal = white[:, kept].T @ white[:, kept] + np.diag(precision[kept])
    values = left.rest + white @ left.beta
    np.testing.assert_allclose(few.beta[kept], np.linalg.solve(normal, white[:, kept].T @ values), rtol=1e-9)
    np.testing.assert_allclose(few.covariance[np.ix_(kept, kept)], np.linalg.inv(normal), rtol=1e-9)
    np.testing.assert_allclose(few.rest, values - white[:, kept] @ few.beta[kept], atol=1e-12)
    # And back again: the same parameters put in as further columns.
    rest = left.without(np.array([1, 2])).beside(white[:, [1, 2]])
    np.testing.assert_allclose(rest.beta[5:], left.beta[[1, 2]], rtol=1e-8)
    np.testing.assert_allclose(rest.rest, left.rest, atol=1e-10)
    gain = misfit(left, white[:, kept], precision[kept]) - misfit(left, white, precision)
    assert left.explained(np.array([1, 2])) == pytest.approx(gain, rel=1e-8)


def test_a_burst_is_cut_and_what_follows_it_is_fitted_again() -> None:
    """Ten samples of 30 sigma weigh like ten of a few."""
    none = np.zeros(4000, dtype=np.bool_)
    quiet, loud = (some_left(4000, burst=burst)[0] for burst in (0.0, 30.0))
    plain, cut = (weigh_steps(one, low=20, high=3980, barred=none) for one in (quiet, loud))
    # 4.5 sigma each are 45, of which the step after the burst, with 110 samples before it, takes 45/sqrt(110) = 4.3;
    # uncut it were 29.
    assert np.max(np.abs(np.sqrt(cut.gain) - np.sqrt(plain.gain))) < 5.0
    assert float(loud.gains(rise(4000, 110, width=1, noise=loud.noise)[:, None])[0]) > 400.0


def test_a_rise_of_one_sample_is_a_step() -> None:
    left, _, _ = some_left()
    step = left.noise.whitened((np.arange(50) >= 30).astype(np.float64))
    np.testing.assert_array_equal(rise(50, 30, width=1, noise=left.noise), step)


@pytest.mark.parametrize(
    ("kind", "size", "gears"),
    [
        ("white", 0.4, known),
        pytest.param("white", -3.0, known, marks=pytest.mark.slow),
        pytest.param("ar", 0.8, known, marks=pytest.mark.slow),
        pytest.param("white", 0.4, graded, marks=pytest.mark.slow),
        pytest.param("white", -3.0, graded, marks=pytest.mark.slow),
        ("ar", 0.8, graded),
    ],
)
def test_a_jump_is_found(kind: str, size: float, gears: Callable[[], tuple[GearKnown, GearKnown]]) -> None:
    data = made(2, kind)
    entries = found(jumped(data, (0.37, size)), gears=gears())
    assert len(entries) == 1
    assert (entries[0].kind, entries[0].hz, entries[0].recordings) == ("step", None, (0,))
    assert matches(entries[0], data, 0.37, size)
    # Of a step in white noise the place is known to a few (sigma/size)^2 samples; coloured noise of 0.6 has
    # (1 + 0.6)/(1 - 0.6) = 4 times the power where a step lives.
    assert (entries[0].time_s_std or 0.0) < 12.0 * (2.0 if kind == "ar" else 1.0) ** 2 / size**2 / 180.0 + 0.005


@pytest.mark.long
def test_a_large_jump_is_placed_between_two_samples() -> None:
    data = made(2)
    entry = only_jumps(found(jumped(data, (0.6, 20.0))))[0]
    assert data.time_s is not None and entry.time_s is not None
    at = int(np.searchsorted(along(data), 0.6, side="right"))
    assert data.time_s[at - 1] < entry.time_s < data.time_s[at]


def test_it_is_said_like_an_engineer_would() -> None:
    entry = Entry(
        kind="step", p_value=1e-9, recordings=(1,), amplitude_um=-3.12, std_um=0.104, time_s=41.332,
        time_s_std=0.04, label="jump",
    )  # fmt: skip
    assert says(entry) == "a jump by -3.12 +- 0.10 um at 41.33 s of recording 1"
    written = entry.to_json()
    assert written["time_s"] == 41.332 and "hz" not in written
    assert (written["kind"], written["label"]) == ("step", "jump")
    assert "driving_turn" not in written
    turned = replace(entry, time_s=None, time_s_std=None, driving_turn=12.34, driving_turn_std=0.3)
    assert says(turned) == "a jump by -3.12 +- 0.10 um at turn 12.3 of the driving shaft of recording 1"


@pytest.mark.long
def test_without_time_the_turn_tells_the_moment() -> None:
    data = made(3)
    entries = found(replace(jumped(data, (0.6, 1.0)), time_s=None))
    assert [e.label for e in entries] == ["jump"]
    assert entries[0].time_s is None and entries[0].driving_turn is not None
    # 25 turns in all.
    assert entries[0].driving_turn == pytest.approx(0.6 * 25.0, abs=5.0 * (entries[0].driving_turn_std or 0.0))


@pytest.mark.long
@pytest.mark.parametrize(
    "jumps",
    [
        pytest.param(((0.3, 1.0), (0.7, -1.0)), marks=pytest.mark.slow),
        pytest.param(((0.3, 1.0), (0.7, 1.0)), marks=pytest.mark.slow),
        pytest.param(((0.25, 0.6), (0.6, 5.0)), marks=pytest.mark.slow),
        ((0.2, 2.0), (0.5, -1.0), (0.8, 3.0)),
    ],
)
def test_several_jumps(jumps: tuple[tuple[float, float], ...]) -> None:
    data = made(4)
    entries = found(jumped(data, *jumps))
    assert [e.label for e in entries] == ["jump"] * len(jumps)
    for entry, (at, size) in zip(only_jumps(entries), jumps, strict=True):
        assert matches(entry, data, at, size)


@pytest.mark.long
def test_a_jump_in_one_of_three_recordings() -> None:
    data = []
    for seed in range(3):
        rng = np.random.default_rng(seed)
        u, t = samples(rng, z_1=18, z_2=25, cycles=1)
        data.append(residual(u, t, noise(rng, u.size, "white"), z_1=18, z_2=25))
    entries = found(data[0], jumped(data[1], (0.4, 1.0)), data[2])
    assert [(e.label, e.recordings) for e in entries] == [("jump", (1,))]


@pytest.mark.long
def test_a_jump_beside_a_wave_and_a_tooth() -> None:
    data = made(6, cycles=1.0)
    values = 3.0 * np.cos(2.0 * np.pi * data.u / 18) - 3.0 * (np.rint(data.u).astype(int) % 25 == 7)
    entries = found(jumped(plus(data, values), (0.4, 2.0)))
    assert matches(only_jumps(entries)[0], data, 0.4, 2.0)
    assert {(e.kind, e.gear, e.order, e.tooth) for e in entries if e.label != "jump" and e.companion_of is None} == {
        ("shaft_order", "driving", 1.0, None), ("tooth", "driven", None, 7)
    }  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize(
    ("tau", "size"),
    [
        pytest.param(1.0, 2.0, marks=pytest.mark.slow),
        pytest.param(0.4, 2.0, marks=pytest.mark.slow),
        (0.4, 20.0),
        pytest.param(0.2, 2.0, marks=pytest.mark.slow),
        (0.1, 3.0),
    ],
)
def test_warming_up_is_no_jump(tau: float, size: float) -> None:
    """A drift that settles with a time constant of ``tau`` of the record, whose steep beginning no cubic follows."""
    data = made(7, cycles=1.0)
    assert not only_jumps(found(plus(data, size * (1.0 - np.exp(-along(data) / tau)))))


@pytest.mark.long
@pytest.mark.parametrize("tau", [pytest.param(1.0, marks=pytest.mark.slow), 0.4])
def test_a_jump_while_it_warms_up(tau: float) -> None:
    data = made(9, cycles=1.0)
    entries = found(jumped(plus(data, 5.0 * (1.0 - np.exp(-along(data) / tau))), (0.6, 1.5)))
    assert sorted(e.label for e in entries) == ["drift", "jump"]
    assert matches(only_jumps(entries)[0], data, 0.6, 1.5)


@pytest.mark.long
def test_a_rise_over_several_turns_is_no_jump_and_one_over_a_few_teeth_is() -> None:
    data = made(9)
    slow, quick = (np.clip((data.u - data.u[0] - 225.0) / width + 0.5, 0.0, 1.0) for width in (100.0, 4.0))
    assert not only_jumps(found(plus(data, 2.0 * slow)))
    assert matches(only_jumps(found(plus(data, 2.0 * quick)))[0], data, 0.5, 2.0)


@pytest.mark.long
@pytest.mark.parametrize(
    ("length", "size", "at"),
    [
        (1, 40.0, 0.5),
        pytest.param(20, 10.0, 0.5, marks=pytest.mark.slow),
        pytest.param(20, -30.0, 0.5, marks=pytest.mark.slow),
        pytest.param(200, 5.0, 0.5, marks=pytest.mark.slow),
        pytest.param(1, 40.0, 0.93, marks=pytest.mark.slow),
        pytest.param(20, 10.0, 0.93, marks=pytest.mark.slow),
        (20, -30.0, 0.93),
        pytest.param(200, 5.0, 0.93, marks=pytest.mark.slow),
    ],
)
def test_a_burst_is_no_jump(length: int, size: float, at: float) -> None:
    """Something that is over within a turn (360 samples of the driving shaft) has not stayed."""
    data = made(10)
    values = np.zeros(data.u.size)
    begin = int(at * data.u.size)
    values[begin : begin + length] = size
    assert not only_jumps(found(plus(data, values)))


@pytest.mark.long
def test_noise_that_wanders_does_not_jump() -> None:
    assert not only_jumps(found(made(0, "wandering")))  # test_healthy_pairs_do_not_jump_at_length has 400


@pytest.mark.long
def test_healthy_pairs_do_not_jump() -> None:
    # The share is 0.2 %; one of 4 would come in one of 120 such tests. The next test has hundreds.
    assert not any(only_jumps(found(made(seed, kind))) for seed in range(2) for kind in ("white", "ar"))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["white", "ar", "wandering"])
@pytest.mark.parametrize("cycles", [0.6, 2.0])
def test_healthy_pairs_do_not_jump_at_length(kind: str, cycles: float) -> None:
    # At the share of 0.2 % more than 3 of 200 come in one of 1200 such tests.
    raised = [bool(only_jumps(found(made(seed, kind, cycles=cycles)))) for seed in range(2000, 2200)]
    assert sum(raised) <= 3


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "size"), [("white", 0.3), ("ar", 0.6)])
def test_stated_errors_cover(kind: str, size: float) -> None:
    sizes, moments = [], []
    for seed in range(40):
        data = made(seed, kind)
        assert data.time_s is not None
        at = float(np.random.default_rng(seed).uniform(0.2, 0.8))
        entry = only_jumps(found(jumped(data, (at, size))))[0]
        sizes.append(((entry.amplitude_um or 0.0) - size) / (entry.std_um or 1.0))
        true = data.time_s[0] + at * np.ptp(data.time_s)
        moments.append(((entry.time_s or 0.0) - true) / (entry.time_s_std or 1.0))
    # 40 pulls: spread 1 +- 0.34 (3 sigma). The noise is never said to be less than its model has, so less is as likely.
    assert 0.6 < np.std(sizes) < 1.34 and abs(np.mean(sizes)) < 0.5
    # A place is as likely as it fits, which has wider tails than a normal law: 36 of 40 within two.
    assert np.sum(np.abs(moments) < 2.0) >= 36


@pytest.mark.slow
def test_a_late_jump_in_a_record_too_long_to_be_searched_whole() -> None:
    data = made(11, "ar", cycles=10.0)
    result = locate([jumped(data, (0.15, -0.7), (0.85, 1.0))], gears=known())
    assert [e.label for e in result.entries] == ["jump", "jump"]
    for entry, (at, size) in zip(only_jumps(result.entries), ((0.15, -0.7), (0.85, 1.0)), strict=True):
        assert matches(entry, data, at, size)
    # The level is that of the noise, not of what jumps add: 1.3 % is three standard errors of 90 000 such samples.
    assert result.noise_level == pytest.approx(UM, rel=0.02)
    assert not found(made(11, "ar", cycles=10.0))


def test_what_did_not_stand_leaves_no_trace() -> None:
    """A search that tries a jump and takes it back ends where one without any jump ends."""
    data = made(12)
    bump = np.where(np.abs(along(data) - 0.5) < 0.01, 4.0, 0.0)
    search = JointModel([plus(data, bump)], known(), 0.0)
    before = search.fit(passes=3)
    noise = search.states[0].noise
    after, jumped_ = next_jump(search, before, least=0.0)
    assert not jumped_ and not search.states[0].jumps and search.refused
    assert search.states[0].noise is noise
    np.testing.assert_allclose(after.left[0], before.left[0], atol=1e-9)


def knocked(folder: Path, *, size_um: float, at: float = 0.4) -> tuple[PairFile, Path, Recording, int]:
    """A recording of a healthy pair whose driving reader is knocked: its reading steps, the teeth do not."""
    rng = np.random.default_rng(1)
    file, path, truth = inspected(folder, rng, z_1=11, z_2=13, gauge=0.2, points=120)
    made_ = record(truth, Rig(zero_1=1.0, zero_2=2.0, noise=0.3), rng, cycles=3.0, stated=(1.0, 2.0))
    assert made_.driving_angle_rad is not None
    place = int(at * made_.driving_angle_rad.size)
    step = np.where(np.arange(made_.driving_angle_rad.size) >= place, size_um * UM / truth.pair.r_b2, 0.0)
    # TE = theta_2 - z_1/z_2 theta_1: it rises where the driving reading falls.
    reading = made_.driving_angle_rad - step / truth.pair.ratio
    return file, path, replace(made_, driving_angle_rad=reading), place


def test_jumps_that_moved_to_the_same_sample_stay_two() -> None:
    """Each moves to where it fits best, and two may meet; the one that is given up is then the one that was meant."""
    here, there = Jump(at=6650), Jump(at=6650)
    held = [here, there]
    held.remove(there)
    assert held[0] is here
    assert there not in held


@pytest.mark.long
@pytest.mark.parametrize("size", [2.0, pytest.param(30.0, marks=pytest.mark.slow)])
def test_a_knocked_reader_is_left_unexplained(tmp_path: Path, size: float) -> None:
    file, path, recording, place = knocked(tmp_path, size_um=size)
    verdict = diagnose(file, [recording], path=path)
    assert not verdict.findings
    assert verdict.status == "unexplained"
    assert [e.label for e in verdict.unexplained] == ["jump"]
    entry = verdict.unexplained[0]
    assert recording.time_s is not None and entry.time_s is not None
    assert recording.time_s[place - 2] < entry.time_s < recording.time_s[place + 1]
    assert entry.amplitude_um == pytest.approx(size, abs=3.0 * (entry.std_um or 0.0))
    # Held out are parts of every stretch between jumps, which the others foretell to the noise; as-built teeth cost
    # their share of the samples, 48 of 7000.
    assert verdict.after.unseen == pytest.approx(verdict.noise, rel=0.03)
    assert "jump" in verdict.held_out_by


@pytest.mark.long
def test_the_zeros_survive_a_jump(tmp_path: Path) -> None:
    file, path, recording, _ = knocked(tmp_path, size_um=30.0)
    result = compare(file, [recording], path=path)
    # A hundred times the noise; the jump leaves a saw of 15 um, so the doubt grows, and covers.
    assert abs(off_deg(result.alignment.zeros.driving, 1.0)) < 3.0 * math.degrees(result.alignment.std)
    assert json.dumps([e.to_json() for e in result.located.entries])


@pytest.mark.long
def test_both_parts_of_a_fit_see_every_stretch_between_jumps(tmp_path: Path) -> None:
    file, path, recording, _ = knocked(tmp_path, size_um=3.0)
    model = prepare(file, compare(file, [recording], path=path), path=path)
    n = model.observed[0].fit.size
    jumps = [n // 5, n - n // 10]
    parted = beside_jumps(model.observed, [jumps])[0].fit
    for low, high in zip([0, *jumps], [*jumps, n], strict=True):
        assert 0.4 < np.mean(parted[low:high]) < 0.6  # halves, but for a block's odd sample
    assert beside_jumps(model.observed, [[]])[0] is model.observed[0]


@pytest.mark.slow
def test_what_jumps_up_and_down_is_so_many_jumps() -> None:
    """A loose contact: 3 um up and down again, six times. Each is told once; those that would move to the place of
    another leave it there. One of a hundred is missed in 1 um of noise at 180 samples a second, so five of six do."""
    places = (0.12, 0.31, 0.44, 0.58, 0.71, 0.9)
    data = jumped(made(2, cycles=2.0), *((at, 3.0 if k % 2 == 0 else -3.0) for k, at in enumerate(places)))
    ones = only_jumps(found(data))
    times = np.array([one.time_s for one in ones])
    assert len(ones) <= len(places)
    assert times.size < 2 or np.min(np.diff(times)) > 1.0
    told = [at for k, at in enumerate(places) if any(matches(one, data, at, 3.0 * (-1.0) ** k) for one in ones)]
    assert len(told) >= 5


@pytest.mark.parametrize("size", [0.5, 4.0, 12.0, 300.0])
def test_a_sharp_step_has_its_size_however_its_first_innovation_was_cut(size: float) -> None:
    """In slow noise (0.95 of a sample goes on into the next) a step is told by its first sample alone: 4 um and more in
    innovations of 0.7 um are cut at 4.5 of those while steps are looked for."""
    left, _, _ = some_left(2000)
    slow = replace(left.noise, ar=np.array([0.95]), innovation=0.7)
    values = np.random.default_rng(2).normal(size=2000) + rise(2000, 900, width=1, noise=slow) * size
    one = Left(
        whites=(np.zeros((2000, 0)),), beta=np.zeros(0), covariance=np.zeros((0, 0)), rest=values, noise=slow,
    )  # fmt: skip
    steps = weigh_steps(one, low=20, high=1980, barred=np.zeros(2000, dtype=np.bool_))
    _, cut, _ = steps.at(900)
    amplitude, std = size_of(one, 900)
    assert abs(amplitude - size) < 3.0 * std
    if size > 1.0:
        assert cut < 0.9 * size
