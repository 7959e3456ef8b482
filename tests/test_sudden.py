"""Jumps so large that they pass for noise are found before any noise is known, with how long they take."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearpoly.compare.locate import locate
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.compare.sudden import sudden, took
from gearpoly.units import FloatArray
from tests.residuals import healthy

UM = 1e-3
Z_1, Z_2 = 20, 30


def made(seed: int, kind: str = "white", *, cycles: float = 6.0) -> AlignedResidual:
    return healthy(np.random.default_rng(seed), z_1=Z_1, z_2=Z_2, cycles=cycles, kind=kind)


def slipped(data: AlignedResidual, *slips: tuple[float, float, int]) -> AlignedResidual:
    """With slips by so many um at this part of the record, straight over so many samples."""
    out: FloatArray = data.residual.copy()
    for part, size_um, samples in slips:
        at = int(part * out.size)
        out += UM * size_um * np.clip((np.arange(out.size) - at) / samples + 0.5, 0.0, 1.0)
    return replace(data, residual=out)


def found_in(data: AlignedResidual) -> dict[int, float]:
    return sudden(data.u, data.residual, turn=float(Z_2), period=float(math.lcm(Z_1, Z_2)))


@pytest.mark.parametrize("kind", ["white", "ar", "wandering"])
def test_healthy_recordings_have_none(kind: str) -> None:
    assert not any(found_in(made(seed, kind)) for seed in range(6))


def test_slips_are_found_with_their_size_largest_first() -> None:
    data = slipped(made(1), (0.2, -40.0, 40), (0.5, -25.0, 40), (0.8, -60.0, 40))
    found = found_in(data)
    n = data.residual.size
    for at, (part, size) in zip(found, ((0.8, -60.0), (0.2, -40.0), (0.5, -25.0)), strict=True):
        assert at == pytest.approx(part * n, abs=30)
        # Means over a turn before and after, of which the slip takes 40 of 600 samples.
        assert found[at] / UM == pytest.approx(size, rel=0.06)


def test_what_does_not_stay_or_comes_at_every_turn_is_none() -> None:
    data = made(2)
    bump = slipped(data, (0.5, 30.0, 1), (0.503, -30.0, 1))
    # What a long window sees of its end is a place to look at, no step of that size.
    assert all(abs(size) < 0.1 * 30.0 * UM for size in found_in(bump).values())
    many = slipped(data, *((0.05 * k, 30.0 * (-1) ** k, 1) for k in range(1, 20)))
    assert all(abs(size) < 0.25 * 30.0 * UM for size in found_in(many).values())


@pytest.mark.parametrize("samples", [1, 8, 32])
def test_how_long_a_slip_takes_is_told_to_a_third(samples: int) -> None:
    data = slipped(made(3), (0.4, 30.0, samples))
    at = int(0.4 * data.residual.size)
    middle, width = took(data.residual, at + 5)
    assert middle == pytest.approx(at, abs=max(2, samples // 4))
    assert 0.75 * samples <= width <= max(2, 1.4 * samples)


def test_near_the_ends_of_a_record_a_slip_stays_where_it_is() -> None:
    data = slipped(made(3, cycles=0.2), (0.05, 30.0, 1))
    at = int(0.05 * data.residual.size)
    assert at < 20
    middle, width = took(data.residual, at)
    assert middle == pytest.approx(at, abs=2)
    assert width <= 2


@pytest.mark.long
def test_three_slips_leave_the_noise_what_it_is() -> None:
    """They were noise of 17 um before, and one of them a jump by 4 um."""
    slips = ((0.2, -40.0, 40), (0.5, -25.0, 40), (0.8, -60.0, 40))
    data = slipped(made(4), *slips)
    assert data.time_s is not None
    gears = GearKnown(z=Z_1, uncertainty=0.2 * UM), GearKnown(z=Z_2, uncertainty=0.2 * UM)
    located = locate([data], gears=gears)
    jumps = sorted((e for e in located.entries if e.moment), key=lambda e: e.time_s or 0.0)
    assert [e.amplitude_um for e in jumps] == pytest.approx([size for _, size, _ in slips], abs=0.5)
    when = [float(data.time_s[int(part * data.time_s.size)]) for part, _, _ in slips]
    assert [e.time_s for e in jumps] == pytest.approx(when, abs=0.03)
    assert located.noise_level / UM == pytest.approx(1.0, rel=0.1)
