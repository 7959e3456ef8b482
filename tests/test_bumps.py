"""Trains of bumps: found by their shape where no line and no sum of powers shows them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearpoly.compare.bumps import _filtered, find_bumps, followed
from gearpoly.compare.entries import Entry
from gearpoly.compare.faint import _both_ways, _heard, find_train
from gearpoly.compare.locate import locate
from gearpoly.compare.noise import estimate_noise
from gearpoly.compare.noise_spectrum import windows
from gearpoly.compare.sampling import FOOT_OF_PEAK_LINES, sampling_of
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.compare.trains import Lines, Train, lines_of
from tests.residuals import healthy

UM = 1e-3
GEARS = (GearKnown(z=18, uncertainty=0.2 * UM), GearKnown(z=25, uncertainty=0.2 * UM))
ORDER = 0.83
"""Strikes per driving turn, whose harmonics are near no order of either shaft."""


def made(seed: int) -> AlignedResidual:
    return healthy(np.random.default_rng(seed), z_1=18, z_2=25, cycles=2, kind="white")


def bumps(turns: np.ndarray, width: float) -> np.ndarray:
    """A bump of ``width`` rad (standard deviation) at one moment of every round (n,), of mean 0."""
    off = (turns + 0.5) % 1.0 - 0.5
    shape = np.exp(-0.5 * (2.0 * np.pi * off / width) ** 2)
    return np.asarray(shape - np.mean(shape))


def struck(data: AlignedResidual, turns: np.ndarray, *, gain: float, width: float = 0.25) -> AlignedResidual:
    """The residual with bumps that take ``gain`` of the misfit at a noise of 1 um."""
    shape = bumps(turns, width)
    size = math.copysign(math.sqrt(abs(gain) / float(shape @ shape)), gain) * UM
    return replace(data, residual=data.residual + size * shape)


def entries(*data: AlignedResidual) -> tuple[Entry, ...]:
    return locate(list(data), gears=GEARS).entries


@pytest.mark.parametrize(
    ("seed", "gain"),
    [
        (4, 60.0),
        pytest.param(5, 60.0, marks=pytest.mark.slow),
        pytest.param(6, 60.0, marks=pytest.mark.slow),
        (4, -60.0),
    ],
)
def test_bumps_and_dips_are_found_that_sums_of_powers_do_not_show(seed: int, gain: float) -> None:
    """Half of a gain of 60 is the chance's logarithm at one place, width and moment, of which there are 10^5; as the
    power of ten lines it shares the chance with 20 numbers."""
    data = made(seed)
    there = struck(data, data.theta_1 / (2.0 * math.pi) * ORDER + 0.3, gain=gain)
    search = sampling_of(u=there.u, time=None, z_1=18, z_2=25)
    noise = estimate_noise(there.u, there.residual, z_1=18, z_2=25)
    step = search.order_grid.step
    lines = lines_of(search, "order", noise.whitened(there.residual), noise, step=step)
    found = find_bumps([lines], step=step, share=0.002)
    assert found is not None
    assert found.frequency * 18 == pytest.approx(ORDER, abs=0.005)
    assert find_train([lines.chances], step=step, repeats=[lines.repeats], share=0.002) is None


@pytest.mark.long
@pytest.mark.parametrize("seed", [4, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (5, 6))])
def test_a_train_is_placed_to_within_its_stated_error(seed: int) -> None:
    data = made(seed)
    found = entries(struck(data, data.theta_1 / (2.0 * math.pi) * ORDER + 0.3, gain=65.0))
    assert found
    for e in found:
        assert e.kind == "shaft_order"
        assert e.order is not None
        assert e.order_std is not None
        assert "of pulses at 0.8" in e.label
        assert abs(e.order - round(e.order / ORDER) * ORDER) < 3.0 * e.order_std


@pytest.mark.slow
def test_what_strikes_in_time_is_told_from_what_turns() -> None:
    """The speed wanders by a few parts in a hundred, so a train over time is none over angle."""
    data = made(7)
    assert data.time_s is not None
    hz = 0.83 * float(np.ptp(data.theta_1) / np.ptp(data.time_s)) / (2.0 * math.pi)
    wandering = data.time_s + 0.8 / hz * np.sin(2.0 * math.pi * data.time_s / float(np.ptp(data.time_s)))
    uneven = replace(data, time_s=wandering)
    (kind,) = {e.kind for e in entries(struck(uneven, wandering * hz, gain=150.0))}
    assert kind == "time"
    (kind,) = {e.kind for e in entries(struck(uneven, data.theta_1 / (2.0 * math.pi) * ORDER, gain=150.0))}
    assert kind == "shaft_order"


@pytest.mark.long
def test_a_train_is_weighed_over_angle_and_time_by_the_same_lines() -> None:
    """At an even speed both explain it alike, also where a harmonic lies just beside an order of a shaft: placed a
    little off it would fall to that order, and over angle the train would have a line less than over time."""
    data = made(8)
    even = replace(data, time_s=0.01 * data.u)
    assert even.time_s is not None
    search = sampling_of(u=even.u, time=even.time_s, z_1=18, z_2=25)
    harmonics, edge = np.arange(1.0, 11.0), FOOT_OF_PEAK_LINES / search.span  # in cycles per mesh
    # The fourth harmonic lies hardly beside what may be an order of the driving shaft, and a little off within it.
    true, off = ((3.0 / 18.0 + beside * edge) / 4.0 for beside in (1.25, 0.97))
    assert np.array_equal(np.flatnonzero(search.own(off * harmonics) & ~search.own(true * harmonics)), [3])
    there = struck(even, even.u * true, gain=150.0)
    noise = estimate_noise(there.u, there.residual, z_1=18, z_2=25)
    white = noise.whitened(there.residual)
    train = Train(frequency=off, count=10, recordings=(0,), log_false=-30.0)
    train = followed(train, _heard(train, "order", [search], [white], [noise])) or train
    both = _both_ways(train, "order", [search], [white], [noise])
    assert both["order"].gain == pytest.approx(both["time"].gain, rel=1e-3)  # frequencies are tried on two grids
    assert both["order"].gain > 1.02 * train.gain  # it had a line less


@pytest.mark.long
@pytest.mark.parametrize("seed", [5, pytest.param(6, marks=pytest.mark.slow)])
def test_a_train_at_a_difference_of_both_shafts_is_one(seed: int) -> None:
    """0.2865 of the driving shaft is 1 - 18/25 to a third of a line, and further harmonics are as near to such sums,
    where the pair itself puts next to nothing."""
    data = made(seed)
    found = entries(struck(data, data.theta_1 / (2.0 * math.pi) * 0.2865 + 0.3, gain=85.0, width=0.2))
    assert found
    for e in found:
        assert "of pulses at 0.28" in e.label
        assert e.order is not None
        assert abs(e.order - round(e.order / 0.2865) * 0.2865) < 3.0 * (e.order_std or 0.0)


@pytest.mark.long
def test_one_bump_is_no_train() -> None:
    """It has a line at every frequency, all in step; but trains come all along the record."""
    data = made(8)
    once = np.exp(-0.5 * ((data.u - np.mean(data.u) - 200.0) / 0.8) ** 2)
    size = 40.0 / math.sqrt(float(once @ once))
    assert not any("pulses" in e.label for e in entries(replace(data, residual=data.residual + size * UM * once)))


def spectrum(rng: np.random.Generator, lines: int) -> Lines:
    """White noise of twice as many samples, at two places a line, its level estimated from the neighbours."""
    n, fine = 2 * lines, 2
    sums = np.fft.rfft(rng.standard_normal(n), n * fine)[: lines * fine] / math.sqrt(n)
    sums *= np.exp(1j * np.pi * (n - 1) / (n * fine) * np.arange(lines * fine))
    low, high = windows(lines)
    total = np.concatenate([[0.0], np.cumsum(np.abs(sums[::fine]) ** 2)])
    at = np.arange(lines * fine) / fine
    rest = np.interp(at, np.arange(lines), (total[high] - total[low]) / (high - low))
    count = np.interp(at, np.arange(lines), high - low)
    sums /= np.sqrt(rest)
    sums[: 6 * fine] = 0.0
    return Lines(amplitude=sums, rest=rest, count=count, repeats=np.zeros(at.size, dtype=np.bool_))


@pytest.mark.long
@pytest.mark.parametrize("recordings", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_bumps_in_noise_are_rarer_than_stated(recordings: int) -> None:
    """The bound counts neighbouring places as many tests, and a bump has to show in two lines at least. At a true rate
    of 20 % more than 35 of 100 come in 0.02 % of such tests."""
    rng = np.random.default_rng(5)
    spectra = [[spectrum(rng, 1500) for _ in range(recordings)] for _ in range(100)]
    assert sum(find_bumps(one, step=0.5, share=0.2) is not None for one in spectra) <= 35


@pytest.mark.long
def test_the_chance_of_the_best_moment_is_what_it_is_stated_to_be() -> None:
    """Of 40 000 rounds of noise of which each line has its own level, estimated from twelve others, as many exceed it
    as the chance says: the bound by crossings is good to a third down to one in a thousand."""
    rng = np.random.default_rng(7)
    harmonics = np.arange(1, 11)
    shape = np.exp(-0.5 * (0.2 * harmonics) ** 2)
    sums = (rng.standard_normal((40_000, 10)) + 1j * rng.standard_normal((40_000, 10))) / math.sqrt(2.0)
    level = rng.gamma(12.0, 1.0 / 12.0, (40_000, 10))
    lines = Lines(
        amplitude=np.ravel(sums / np.sqrt(level)), rest=np.ravel(level), count=np.full(400_000, 12.0),
        repeats=np.zeros(400_000, dtype=np.bool_),
    )  # fmt: skip
    chance, _, _ = _filtered(lines, np.arange(400_000).reshape(40_000, 10), harmonics, shape)
    for stated in (0.1, 0.01, 0.001):
        assert 0.6 * stated < np.mean(chance < math.log(stated)) < 1.4 * stated


def test_a_train_of_the_pair_itself_and_its_feet_are_left_to_its_own_searches() -> None:
    rng = np.random.default_rng(6)
    lines = spectrum(rng, 1500)
    sums = lines.amplitude.copy()
    for h in range(1, 11):
        for foot in (-1, 0, 1):
            sums[200 * h + foot] += (1.0 if foot == 0 else 0.6) * 6.0 * math.exp(-0.5 * (0.2 * h) ** 2)
    there = replace(lines, amplitude=sums)
    found = find_bumps([there], step=0.5, share=0.002)
    assert found is not None
    assert found.frequency == pytest.approx(100.0, abs=0.2)
    repeats = lines.repeats.copy()
    repeats[::200] = True
    assert find_bumps([replace(there, repeats=repeats)], step=0.5, share=0.002) is None
