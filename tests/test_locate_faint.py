"""Waves that stand out together only, and waves faster than half the sampling rate."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearpoly.compare.entries import Entry
from gearpoly.compare.faint import Train, faint_waves, find_train
from gearpoly.compare.lines import TIE
from gearpoly.compare.locate import locate
from gearpoly.compare.noise import estimate_noise
from gearpoly.compare.sampling import sampling_of
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from tests.residuals import healthy, noise, residual, samples

UM = 1e-3
GEARS = (GearKnown(z=18, uncertainty=0.2 * UM), GearKnown(z=25, uncertainty=0.2 * UM))


def plus(data: AlignedResidual, values: np.ndarray) -> AlignedResidual:
    return replace(data, residual=data.residual + values)


def entries(*data: AlignedResidual) -> tuple[Entry, ...]:
    return locate(list(data), gears=GEARS).entries


def made(seed: int, kind: str = "white") -> AlignedResidual:
    return healthy(np.random.default_rng(seed), z_1=18, z_2=25, cycles=1, kind=kind)


def with_power(data: AlignedResidual, x: np.ndarray, frequency: float, power: float, phase: float) -> AlignedResidual:
    """The residual with a wave over ``x`` (n,), so large that with the noise there it has ``power`` times what white
    noise of 1 um has on average."""
    wave = np.exp(2j * np.pi * frequency * x)
    there = np.mean(data.residual * np.conj(wave))
    more = UM * math.sqrt(power / data.u.size) * np.exp(1j * phase) - there
    return plus(data, 2.0 * (more * wave).real)


@pytest.mark.long
def test_pulses_of_which_no_line_stands_out_are_found_together() -> None:
    # No harmonic of 0.83 is near an order of either shaft. Of 9000 samples' lines one of 17 stands out; five of 8 have
    # a chance of 1e-13 in noise.
    data = made(1)
    for k in range(1, 6):
        data = with_power(data, data.u, k * 0.83 / 18, 8.5, 0.4 * k)
    found = entries(data)
    assert found
    for e in found:
        assert e.kind == "shaft_order"
        assert "of pulses at 0.8" in e.label
        assert e.order is not None
        assert e.order / 0.83 == pytest.approx(round(e.order / 0.83), abs=0.01)
    assert not entries(with_power(made(1), data.u, 0.83 / 18, 8.5, 0.4))


@pytest.mark.slow
def test_hum_too_faint_for_one_recording_is_found_in_two() -> None:
    def hum(seed: int, phase: float) -> AlignedResidual:
        rng = np.random.default_rng(seed)
        u, t = samples(rng, z_1=18, z_2=25, cycles=2)
        data = residual(u, t, noise(rng, u.size, "white"), z_1=18, z_2=25)
        return with_power(data, t, 47.77, 14.0, phase)

    # 17 stand out alone, and the 28 of both together, less what falls between the places that are looked at.
    one, two = hum(2, 0.3), hum(3, 2.0)
    assert not entries(one)
    assert not entries(two)
    found = entries(one, two)
    assert found
    for e in found:
        assert e.kind == "time"
        assert e.hz == pytest.approx(47.77, abs=0.02)


@pytest.mark.long
def test_a_wave_above_half_the_sampling_rate_keeps_its_frequency() -> None:
    data = made(4)
    assert data.time_s is not None
    rate = 1.0 / float(np.mean(np.diff(data.time_s)))
    hz = 0.7 * rate
    found = entries(plus(data, 0.4 * UM * np.cos(2 * np.pi * hz * data.time_s)))
    assert len(found) == 1  # not its image at 0.3 of the rate as well
    assert found[0].hz == pytest.approx(hz, abs=0.01)
    assert not found[0].rivals  # 20 % of jitter tell the two apart


@pytest.mark.long
def test_a_wave_below_half_the_sampling_rate_is_not_taken_for_one_above() -> None:
    data = made(5)
    assert data.time_s is not None
    found = entries(plus(data, 0.4 * UM * np.cos(2 * np.pi * 11.3 * data.time_s)))
    assert len(found) == 1
    assert found[0].hz == pytest.approx(11.3, abs=0.01)


@pytest.mark.long
def test_even_sampling_names_the_image() -> None:
    data = made(6)
    assert data.time_s is not None
    even = np.linspace(data.time_s[0], data.time_s[-1], data.time_s.size)
    values = data.residual + 0.4 * UM * np.cos(2 * np.pi * 53.0 * even)
    found = entries(replace(data, residual=values, time_s=even))
    assert len(found) == 1
    image = 1.0 / (even[1] - even[0]) - 53.0
    assert found[0].hz == pytest.approx(53.0, abs=0.01)
    assert found[0].aliases[0] == pytest.approx(image, abs=0.01)


@pytest.mark.parametrize("frequency", [43.6, *(pytest.param(one, marks=pytest.mark.slow) for one in (50.0, 53.0))])
def test_of_a_wave_and_its_aliases_the_lowest_is_named(frequency: float) -> None:
    """Even samples show all alike: whatever is likelier, none at or above half their rate is named."""
    data = made(9)
    even = np.linspace(0.0, 1.0, data.theta_2.size) * (data.theta_2.size - 1) / 93.6
    values = data.residual + 0.9 * UM * np.cos(2.0 * np.pi * frequency * even)
    found = entries(replace(data, residual=values, time_s=even))
    assert len(found) == 1
    lowest = min(frequency, 93.6 - frequency)
    assert found[0].hz == pytest.approx(lowest, abs=0.01)
    assert found[0].aliases == pytest.approx((93.6 - lowest, 93.6 + lowest), abs=0.01)


@pytest.mark.long
@pytest.mark.parametrize(("runs", "most"), [(50, 20), pytest.param(200, 57, marks=pytest.mark.slow)])
def test_trains_in_noise_are_as_rare_as_stated(runs: int, most: int) -> None:
    """In exponential noise a train comes with its share of chance; the union bound makes it rarer, not more often."""
    rng = np.random.default_rng(7)
    share = 0.2
    none = np.zeros(3000, dtype=bool)
    hits = sum(
        find_train([-rng.exponential(size=3000) for _ in range(2)], step=0.5, repeats=[none, none], share=share)
        is not None
        for _ in range(runs)
    )
    # At a true rate of 20 % more than 20 of 50, or 57 of 200, come in 0.03 and 0.15 % of such tests; a bound that were
    # idle would give none.
    assert 2 <= hits <= most


def test_trains_of_the_pair_itself_are_left_to_its_own_searches() -> None:
    rng = np.random.default_rng(8)
    chance = -rng.exponential(size=3000)
    chance[200:1200:200] = -12.0
    repeats = np.zeros(3000, dtype=bool)
    found = find_train([chance], step=0.5, repeats=[repeats], share=0.002)
    assert found is not None
    assert found.frequency * round(100.0 / found.frequency) == pytest.approx(100.0)
    repeats[::100] = True
    assert find_train([chance], step=0.5, repeats=[repeats], share=0.002) is None


@pytest.mark.parametrize(
    ("angle", "time", "named"),
    [(-1.0, 0.5, "order"), (0.5, -1.0, "order"), (2.5, -1.0, "time"), (0.5, 0.1, None)],
)
def test_a_train_that_chance_might_make_still_decides_with_one_that_it_would_not(
    angle: float, time: float, named: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where a train over time is no chance find, and one over angle at the same place nearly none, what turns is the
    likelier; where it is 3.5 in log chance behind, odds of 33, it is not."""
    log_false, places = iter((angle, time)), list[float]()

    def found(*given: object, **more: object) -> Train | None:
        # The threshold is loosened by as much as may be made up for.
        later = next(log_false) - 0.5 * TIE
        places.append(0.0831 if not places else 0.0831 / search.pace)
        train = Train(frequency=places[-1], count=3, recordings=(0,), log_false=later)
        return train if later < 0.0 else None

    monkeypatch.setattr("gearpoly.compare.faint.find_train", found)
    data = made(1)
    search = sampling_of(u=data.u, time=data.time_s, z_1=18, z_2=25)
    noise = estimate_noise(data.u, data.residual, z_1=18, z_2=25)
    (peaks,) = faint_waves([search], [noise.whitened(data.residual)], [noise])
    assert {peak.domain for peak in peaks} == ({named} if named else set())
    assert all(peak.log_false == min(angle, time) for peak in peaks)


def test_trains_of_different_waves_decide_each_for_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    data = made(1)
    search = sampling_of(u=data.u, time=data.time_s, z_1=18, z_2=25)
    noise = estimate_noise(data.u, data.residual, z_1=18, z_2=25)
    found = ((0.0831, 0.5), (0.1173 / search.pace, -1.0))
    trains = (Train(frequency=f, count=3, recordings=(0,), log_false=p - 0.5 * TIE) for f, p in found)
    monkeypatch.setattr("gearpoly.compare.faint.find_train", lambda *given, **more: next(trains))
    (peaks,) = faint_waves([search], [noise.whitened(data.residual)], [noise])
    assert {peak.domain for peak in peaks} == {"time"}


def test_lines_at_orders_of_the_shafts_are_no_lines_of_a_train() -> None:
    """Of eight harmonics in two recordings six lines lie at orders. Ten of 4.4 times noise's mean have a chance of
    1e-10 (Gamma of 10), of sixteen that hold no more 1e-6, which 36 000 sums over 0.002 make likely."""
    rng = np.random.default_rng(11)
    none = np.zeros(2000, dtype=bool)
    chances = [-rng.exponential(size=2000) for _ in range(2)]
    for chance in chances:
        chance[120:961:120] = -4.4
        chance[[480, 600, 960]] = 0.0
    found = find_train(chances, step=0.5, repeats=[none, none], share=0.002)
    assert found is not None
    assert found.frequency * 2.0 == pytest.approx(120.0)
    for chance in chances:
        chance[[480, 600, 960]] = -1e-3
    assert find_train(chances, step=0.5, repeats=[none, none], share=0.002) is None


def test_one_line_is_no_train_though_all_others_lie_at_orders() -> None:
    chance = np.zeros(2000)
    chance[500] = -40.0
    assert find_train([chance], step=0.5, repeats=[np.zeros(2000, dtype=bool)], share=0.002) is None
