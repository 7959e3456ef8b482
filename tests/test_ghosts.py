"""A claim that makes a small part of a ghost order is not what is there, and teeth are placed beside all of it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from gearpoly.compare.entries import Entry
from gearpoly.diagnose.ghosts import _remnant_of, ghost_waves, slow_ghosts
from gearpoly.physics import catalogue
from gearpoly.physics.base import Claim
from gearpoly.physics.place import Place
from gearpoly.units import UM

Z = (18, 25)


@pytest.mark.parametrize(
    ("order", "made", "label", "remnant"),
    [
        (55, 0.03, "ghost order: no mesh harmonic", True),  # an image of 55 is 30
        (55, 0.20, "ghost order: no mesh harmonic", False),  # most of it
        (57, 0.03, "ghost order: no mesh harmonic", False),  # 57 has images at 7 and 32
        (55, 0.03, "side band +5 of mesh order 1", False),  # a pitch may make it
    ],
)
def test_a_tenth_of_a_ghost_order_is_no_name(order: int, made: float, label: str, remnant: bool) -> None:
    """0.29 um located at order 30 of 25 teeth."""
    theta = np.linspace(0.0, 40.0, 5000)
    claim = Claim(
        physics=catalogue()["undulation"], place=Place(gear=1, order=order, flank="drive"), values=(0.03, 0.0)
    )
    effect = made * UM * np.cos(30 * theta + 0.4) + 0.5 * UM * np.cos(5 * theta)
    scene = SimpleNamespace(samples=SimpleNamespace(theta_2=theta))
    scope = SimpleNamespace(gears=[SimpleNamespace(z=z) for z in Z])
    model = SimpleNamespace(scope=scope, change=lambda scenes, one, values, but: [effect])
    search: Any = SimpleNamespace(model=model, scenes=[scene])
    entry = Entry(
        kind="shaft_order", p_value=0.0, recordings=(0,), gear="driven", order=30.0, amplitude_um=0.29, label=label
    )
    assert bool(list(_remnant_of(search, claim, [entry]))) == remnant


def test_waves_at_ghost_orders_are_free_on_each_flank() -> None:
    """Of what was located those of no pitch alone: of the driven shaft's 84 a wave on the drive flank, the same in both
    of its recordings, and another on the coast flank."""
    entries = [
        ghost(84.0, gear="driven"),
        ghost(120.0, gear="driven", companion_of=0),
        replace(ghost(39.0, gear="driven"), label="side band +1 of mesh order 1"),
        ghost(30.0, gear="driving"),
        ghost(15.0, gear="driving"),  # an image of 3, where 18 teeth have a larger wave
    ]
    pitches = replace(ghost(3.0, gear="driving"), amplitude_um=5.0)
    turned = np.random.default_rng(5).uniform(0.0, 9.0, 18)
    observed: Any = [
        SimpleNamespace(samples=SimpleNamespace(flank=flank, size=9, theta_1=turned[:9], theta_2=turned[9:]))
        for flank in ("drive", "coast", "drive")
    ]
    teeth = [SimpleNamespace(z=z) for z in Z]
    located: Any = SimpleNamespace(located=SimpleNamespace(entries=entries, where=(pitches,)), gears=teeth)
    found = ghost_waves(located, observed)
    for one, columns in zip(observed, found, strict=True):
        mine = slice(0, 4) if one.samples.flank == "drive" else slice(4, 8)
        first, second = 84.0 * one.samples.theta_2, 30.0 * one.samples.theta_1
        waves = np.column_stack((np.cos(first), np.sin(first), np.cos(second), np.sin(second)))
        np.testing.assert_array_equal(columns[:, mine], waves)
        assert np.count_nonzero(columns) == waves.size
    teeth_too = Entry(kind="tooth", p_value=0.0, recordings=(0,), gear="driving", tooth=3, amplitude_um=-4.0)
    located.located.where = (pitches, teeth_too)  # a pit of 4 um makes dozens of orders
    assert [one.shape for one in ghost_waves(located, observed)] == [(9, 0)] * 3
    located.located.where = ()
    located.located.entries = entries[1:3]
    assert [one.shape for one in ghost_waves(located, observed)] == [(9, 0)] * 3


def test_a_drift_is_free_in_its_recording_until_something_is_looked_for() -> None:
    """Of three recordings the second drifts, and the third wanders, where a slow course is free anyway: ramp, bow and S
    of the second alone."""
    drift = Entry(kind="drift", p_value=0.0, recordings=(1, 2), amplitude_um=3.0, label="drift")
    hum = Entry(kind="time", p_value=0.0, recordings=(0,), hz=50.0, amplitude_um=1.0)
    along = np.linspace(-1.0, 1.0, 9)
    observed = [SimpleNamespace(samples=SimpleNamespace(size=9, along=along))] * 3
    model: Any = SimpleNamespace(scope=SimpleNamespace(wanders=(False, False, True)), observed=observed)
    located: Any = SimpleNamespace(located=SimpleNamespace(entries=[drift, hum]))
    first, second, third = slow_ghosts(located, model)
    curves = (along, 1.5 * along**2 - 0.5, 2.5 * along**3 - 1.5 * along)
    np.testing.assert_allclose(second, np.column_stack(curves), atol=1e-12)
    assert not np.any(first) and not np.any(third)


def ghost(order: float, *, gear: Any, companion_of: int | None = None) -> Entry:
    return Entry(
        kind="shaft_order", p_value=0.0, recordings=(0,), gear=gear, order=order, amplitude_um=2.0,
        label="ghost order: no mesh harmonic", companion_of=companion_of,
    )  # fmt: skip
