"""What several recordings show at one place of the pair comes with its shafts, and what one shows with its moment."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearpoly.compare.entries import Entry, says
from gearpoly.compare.locate import locate
from gearpoly.compare.orders import known_orders
from gearpoly.compare.set_up import AlignedResidual, GearKnown
from gearpoly.units import FloatArray
from tests.residuals import noise, residual

UM = 1e-3
Z_1, Z_2 = 20, 101
ARC = (3.0, 37.0)
"""Meshes of a joint that swings over a third of a turn: 1.7 turns of the pinion, none of the wheel."""

GEARS = GearKnown(z=Z_1, uncertainty=0.2 * UM), GearKnown(z=Z_2, uncertainty=0.2 * UM)


def swung(seed: int, *, begins: float = 0.0, flank: str = "drive") -> AlignedResidual:
    """One swing over the arc, ``begins`` meshes later than ARC, in white noise of 0.5 um."""
    rng = np.random.default_rng(seed)
    u = np.arange(ARC[0] + begins, ARC[1], 0.02)
    t = 100.0 * seed + u / 10.0
    data = residual(u, t, noise(rng, u.size, "white", 0.5 * UM), z_1=Z_1, z_2=Z_2)
    return replace(data, flank="coast") if flank == "coast" else data


def shaken(data: AlignedResidual, *meshes: float, size_um: float = 4.0) -> AlignedResidual:
    """With a ring of 9 waves per mesh over nearly a mesh about each of ``meshes``."""
    out: FloatArray = data.residual.copy()
    for at in meshes:
        near = np.abs(data.u - at) < 0.4
        out += UM * size_um * near * np.cos(2.0 * math.pi * 9.0 * (data.u - at) + at)
    return replace(data, residual=out)


def places(*data: AlignedResidual) -> list[Entry]:
    found = locate(data, gears=GEARS, numbered=(True, True)).entries
    # What a ring leaves beside itself is a tenth of it.
    return [e for e in found if (e.kind == "tooth" or e.burst is not None) and (e.rms_um or 0.0) > 1.0]


@pytest.mark.long
def test_a_place_of_every_swing_is_a_tooth_of_the_gear_that_meets_once() -> None:
    """Mesh 27 meets driven tooth 27 and driving tooth 7, which meets mesh 7 too, and there nothing shakes."""
    (one,) = places(*(shaken(swung(k, begins=0.01 * k), 27.1) for k in range(3)))
    assert (one.gear, one.tooth, one.recordings) == ("driven", 27, (0, 1, 2))
    # The rms of 4 um of a cosine over 0.8 meshes, which the stretches of 64 samples, 1.28 meshes, hold.
    assert one.rms_um == pytest.approx(4.0 / math.sqrt(2.0) * math.sqrt(0.8 / 1.28), rel=0.15)
    assert one.rivals == ("its encoder there",)
    assert "the same in 3 recordings" in says(one)


@pytest.mark.slow
def test_it_is_the_driving_tooth_where_that_shakes_each_time() -> None:
    one = places(*(shaken(swung(k), 8.0, 28.0) for k in range(3)))[0]
    assert (one.gear, one.tooth) == ("driving", 8)
    assert one.rivals == ("its encoder there",)


@pytest.mark.long
def test_it_may_be_either_where_both_teeth_meet_once() -> None:
    """Mesh 20 is the only one of driving tooth 0 and of driven tooth 20 in this arc."""
    one = places(*(shaken(swung(k), 20.0) for k in range(2)))[0]
    assert (one.gear, one.tooth) == ("driven", 20)
    assert one.rivals == ("driving tooth 0, which meets it there", "its encoder there")


@pytest.mark.long
def test_on_the_coast_flank_the_driven_tooth_is_the_next() -> None:
    """There driving tooth n meets driven tooth n + 1."""
    (one,) = places(*(shaken(swung(k, flank="coast"), 27.0) for k in range(2)))
    assert (one.gear, one.tooth) == ("driven", 28)


@pytest.mark.slow
def test_what_shakes_at_other_places_or_once_stays_a_burst() -> None:
    apart = places(shaken(swung(0), 12.0), shaken(swung(1), 16.0), shaken(swung(2), 25.0))
    assert [e.recordings for e in sorted(apart, key=lambda e: e.recordings)] == [(0,), (1,), (2,)]
    assert all(e.burst is not None for e in apart)
    (once,) = places(shaken(swung(0), 12.0), swung(1), swung(2))
    assert once.burst is not None


def bowed(data: AlignedResidual, *, over: FloatArray, size_um: float) -> AlignedResidual:
    x = 2.0 * (over - over[0]) / (over[-1] - over[0]) - 1.0
    return replace(data, residual=data.residual + UM * size_um * (1.5 * x**2 - 0.5))


def drifts(*data: AlignedResidual) -> list[Entry]:
    return [e for e in locate(data, gears=GEARS).entries if e.drift]


@pytest.mark.long
def test_a_slow_course_that_every_swing_repeats_is_one() -> None:
    (one,) = drifts(*(bowed(s, over=s.u, size_um=12.0) for s in map(swung, range(3))))
    assert one.recordings == (0, 1, 2)
    # Half of what it ranges over: from -6 to 12 um.
    assert one.amplitude_um == pytest.approx(9.0, rel=0.1)
    assert "over the arc of recordings 0 and 1 and 2" in says(one)


@pytest.mark.long
def test_slow_courses_that_differ_are_drifts_of_their_own() -> None:
    """The third swing bows the other way."""
    bows = zip(map(swung, range(3)), (12.0, 11.0, -12.0), strict=True)
    found = drifts(*(bowed(s, over=s.u, size_um=size) for s, size in bows))
    assert sorted(e.recordings for e in found) == [(0, 1), (2,)]


@pytest.mark.parametrize(("meshes", "told"), [(34.0, False), (70.0, False), (80.0, True), (200.0, True)])
def test_orders_of_a_shaft_are_told_once_three_quarters_of_its_turn_were_recorded(meshes: float, told: bool) -> None:
    u = np.arange(0.0, meshes, 0.05)
    orders = known_orders(Z_1, Z_2, nyquist=10.0, slowest=0.001)
    known = dict(zip((orders.place / orders.period).round(9).tolist(), orders.told_by(u).tolist(), strict=True))
    assert known[round(100.0 / Z_2, 9)] is told
    assert known[1.0]
    assert known[round(3.0 / Z_1, 9)]
