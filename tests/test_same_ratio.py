"""Another pair of the same ratio, by where its mesh stands among what was located."""

from __future__ import annotations

from dataclasses import replace

import pytest

from gearpoly.compare.entries import Entry
from gearpoly.compare.same_ratio import same_ratio


def order(at: float, um: float, *, gear: str = "driving") -> Entry:
    return Entry(kind="shaft_order", p_value=1e-9, recordings=(0,), gear=gear, order=at, amplitude_um=um)  # type: ignore[arg-type]


def mesh(at: float, um: float) -> Entry:
    return Entry(kind="mesh_order", p_value=1e-9, recordings=(0,), order=at, amplitude_um=um)


MESH = [order(21.0, 4.7), order(42.0, 0.6), order(63.0, 0.2)]
"""A mesh of 21 teeth and its multiples, recorded beside a file of 20 on 40."""

SLOW = [order(1.0, 30.0), order(2.0, 8.0), order(1.0, 12.0, gear="driven")]
"""What any gear has of its own, far larger."""


def test_the_mesh_of_other_teeth_is_told_with_them() -> None:
    found = same_ratio([*SLOW, *MESH], z=(20, 40))
    assert found is not None
    assert (found.teeth, found.orders) == ((21, 42), (21, 42, 63))
    assert "21 on 42" in found.says


def test_orders_of_the_driven_shaft_count_as_those_of_the_driving_one() -> None:
    """42 per driven turn are 21 per driving turn of a pair that halves the speed."""
    at_driven = [order(2.0 * (one.order or 0.0), one.amplitude_um or 0.0, gear="driven") for one in MESH]
    found = same_ratio([*SLOW, *at_driven], z=(20, 40))
    assert found is not None
    assert found.teeth == (21, 42)


@pytest.mark.parametrize(
    ("entries", "z"),
    [
        ([*SLOW, *MESH[:2]], (20, 40)),  # a wheel on the shaft leaves two
        ([*SLOW, *MESH, mesh(1.0, 5.0)], (20, 40)),  # the declared mesh is larger
        ([*SLOW, *MESH], (20, 41)),  # no other teeth near have that ratio
        ([*SLOW, *MESH], (22, 33)),  # nor 21 on any
        ([*SLOW, order(30.0, 4.7), order(60.0, 0.6), order(90.0, 0.2)], (20, 40)),  # nobody counts wrong by half
        ([*SLOW, order(21.0, 4.7), order(41.0, 0.6), order(19.0, 4.0)], (20, 40)),  # side bands of an eccentricity
        ([*SLOW, mesh(1.0, 5.0), mesh(2.0, 1.0), mesh(3.0, 0.5)], (20, 40)),  # its own mesh
        ([replace(one, parts=("mesh of the first stage",)) for one in MESH], (20, 40)),  # the file states that wheel
    ],
)
def test_what_no_other_pair_makes_is_none(entries: list[Entry], z: tuple[int, int]) -> None:
    assert same_ratio(entries, z=z) is None
